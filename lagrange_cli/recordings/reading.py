"""The reading of a recording from a file or from standard input, held in memory as whole columns.

The first bytes of a file determine its format, not its name: a binary table, or else text.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from itertools import chain
from typing import Any

import numpy as np

from ..arithmetic.types import Array, Mask
from ..errors import DataError, LagtopError, arg
from ..file_bytes import decoded, read_bytes, shown_path, utf8_path
from ..files.binary_tables import BinaryTable, binary_table
from ..files.text_tables import Table, read_table
from .doubts import are_radians
from .options import OPTION_OF, Reading
from .quantities import (
    NAMING,
    QUANTITIES,
    SKIPPED,
    FoundQuantity,
    converted,
    expanded,
    found_in,
    known_quantities,
    with_units_of,
)
from .recording import Recording, Source, used_in

_FINE = 1e-7
"""Largest rounding of a time, over the time between two rows, that does not matter."""
_UNITS = {"time": "units of the recording", "rad/time": "rad per unit of time"}
"""The units of quantities without one in their headings."""
_MOST_NAMES = 4
_NO_TIME = FoundQuantity(())


def read_recording(path: str, reading: Reading) -> Recording:
    """Return the recording in a file, or in standard input for `-`.

    Rows that are empty in all columns that are read are left out.  Raises DataError for a bad file,
    or LagtopError for wrong `columns`.
    """
    file = _File(path, reading)
    try:
        return file.recording()
    except LagtopError as error:
        if isinstance(error, DataError) or error.key == "columns":
            raise
        raise DataError.at(file.name, error) from None


class _File:
    """The columns of a file, and the quantities that are found in them."""

    def __init__(self, path: str, reading: Reading) -> None:
        names = None if reading.columns is None else expanded(reading.columns)
        self.path, self.name, self.reading = path, shown_path(path), reading
        self.table = _table_of(path, reading.decimal, len(names or ()) or None)
        self.names = self._names(names)
        self.quantities = self._quantities(is_named=names is not None)
        used = sorted(i for x in self.quantities.values() for i in x.columns)
        self.numbers = self.table.numbers(used, self.names)
        if not len(self.numbers.lines):
            raise DataError(f"{self.name} must have at least one row of numbers")
        self.places = {key: [*map(used.index, x.columns)] for key, x in self.quantities.items()}

    def _names(self, names: Sequence[str] | None) -> Sequence[str]:
        """Return the names of all columns: those given, with the units of the headings."""
        width, headings = self.table.width, self.table.headings
        if names is None and headings is None:
            wanted = f"name its {width} columns, {NAMING}"
            raise DataError(f"{self.name} has no header: {wanted}")
        if names is None:
            return headings or ()
        if len(names) != width:
            wanted = f"all {width} columns of {self.name} (_ skips one)"
            raise LagtopError(f"columns must name {wanted}, got {len(names)} names", "columns")
        is_same = headings and len(headings) == len(names)
        return with_units_of(headings, names) if is_same and headings else names

    def _quantities(self, *, is_named: bool) -> dict[str, FoundQuantity]:
        try:
            found = found_in(self.names, needs_time=self.reading.dt is None)
        except LagtopError as error:
            if is_named and error.key == "columns":
                raise
            raise DataError.at(self.name, error) from None
        if found.get("t", _NO_TIME).says == "frames" and self.reading.dt is None:
            shown = self.names[found["t"].columns[0]]
            raise DataError(f"{self.name}: {shown} counts frames: give {arg('fps')}")
        return found

    def recording(self) -> Recording:
        """Return the recording, with the conventions that names imply."""
        raw = {key: self.numbers.values[:, x] for key, x in self.places.items()}
        empty = self._empty()
        radians = self._radians(raw)
        rows = {
            key: converted(key, self.quantities[key], x, radians=key in radians)
            for key, x in raw.items()
        }
        begins, rows["t"] = self._times(raw)
        reading = self._implied()
        Recording(rows, reading).observed(slice(1))  # raises errors of the alignment
        used = used_in(rows, reading)
        given = {key: rows[key] for key in used}
        given["missing"] = np.any([empty[x] for x in used & empty.keys()], axis=0).reshape(-1, 1)
        read = {i for key in used & self.places.keys() for i in self.quantities[key].columns}
        source = Source(
            utf8_path(self.path),
            [x for i, x in enumerate(self.names) if i in read],
            [x for i, x in enumerate(self.names) if i not in read and x != SKIPPED],
            [*self._lines(rows, used, radians)],
            "s" if self.quantities.get("t", _NO_TIME).unit else "units of the recording",
        )
        return Recording(given, reading, begins, source).within()

    def _empty(self) -> dict[str, Mask]:
        """Return for every quantity whether a part of it is an empty cell, by row."""
        found: dict[str, Mask] = {}
        for key, places in self.places.items():
            empty = self.numbers.empty[:, places]
            if empty.all():
                shown = ", ".join(self._named(key))
                remedy = f"remove its columns, or skip them with _, as in {arg('columns', 't,_')}"
                raise DataError(f"{self.name}: {key} is empty ({shown}): {remedy}")
            found[key] = np.asarray(empty.any(axis=1))
        return found

    def _named(self, key: str) -> list[str]:
        return [self.names[i] for i in self.quantities[key].columns]

    def _radians(self, raw: Mapping[str, Array]) -> set[str]:
        """Return the angles without a unit that are in radians."""
        bare = {
            key: x
            for key, x in raw.items()
            if QUANTITIES[key].unit == "angle" and self.quantities[key].unit is None
        }
        return {*bare} if self.reading.units.radians or are_radians(bare.values()) else set()

    def _times(self, raw: Mapping[str, Array]) -> tuple[float, Array]:
        """Return the time of the first row, and times since then, each rounded once.

        Raises DataError for a time that is not finite or turns back; it may repeat.
        """
        dt = self.reading.dt
        t = raw["t"][:, 0] if "t" in raw else np.arange(float(len(self.numbers.lines)))
        for i in np.flatnonzero(~np.isfinite(t))[:1]:
            raise DataError(f"{self._where(i)}: t must be a finite number, got {t[i]}")
        if dt is not None:
            if (parts := np.flatnonzero(t != np.rint(t))).size:
                wrong = f"t must count frames if {arg('dt')} or {arg('fps')} is given, got"
                raise DataError(f"{self._where(parts[0])}: {wrong} {t[parts[0]]:g}")
            return float(t[0] * dt), ((t - t[0]) * dt).reshape(-1, 1)
        found = self.quantities["t"]
        begins = converted("t", found, t[:1], radians=True)
        elapsed = converted("t", found, self._elapsed(t), radians=True)
        ways = np.sign(np.diff(elapsed))
        forth = ways[ways != 0][:1]
        for i in np.flatnonzero(np.r_[False, ways == -forth])[:1] if forth.size else ():
            after, before = (float(begins[0] + x) for x in (elapsed[i], elapsed[i - 1]))
            remedy = "put each recording into its own file"
            wrong = f"t must not turn back, got {after:.10g} after {before:.10g}: {remedy}"
            raise DataError(f"{self._where(i)}: {wrong}")
        return float(begins[0]), elapsed.reshape(-1, 1)

    def _where(self, row: int) -> str:
        """Return the name of the file and the place of a row."""
        return f"{self.name}, {self.table.place} {self.numbers.lines[row]}"

    def _elapsed(self, t: Array) -> Array:
        """Return the times since the first row, from exact numbers if doubles are too coarse.

        Unix times are such numbers: neighbouring doubles are 2e-7 s apart.
        """
        steps = np.abs(np.diff(t))
        steps = steps[steps > 0]
        if not steps.size or np.abs(t).max() * 2.0**-53 <= _FINE * np.median(steps):
            return np.asarray(t - t[0])
        column = self.table.column(self.quantities["t"].columns[0])
        cells = (self.table.plain(x) for _, x in column)
        exact = (Decimal(x) for x in cells if x)
        first = next(exact)
        return np.fromiter((x - first for x in chain([first], exact)), np.float64)

    def _implied(self) -> Reading:
        """Return the options, overridden by names of columns unless they are not the usual."""
        given, says = self.reading, {key: x.says for key, x in self.quantities.items()}
        usual = Reading()._replace(quaternion_order=given.quaternion_order)  # names are surer
        implied: dict[str, Any] = {
            option: says[key]
            for key, option in OPTION_OF.items()
            if says.get(key) and getattr(given, option) == getattr(usual, option)
        }
        return given._replace(**implied)

    def _lines(self, rows: Mapping[str, Array], used: set[str], radians: set[str]) -> Iterator[str]:
        """Yield what the columns were read as, a line for each quantity."""
        if "t" not in self.places:
            yield f"time: rows {self.reading.dt:g} apart"
        for key, found in self.quantities.items():
            if key not in used:
                continue
            quantity, names = QUANTITIES[key], self._named(key)
            shown = ", ".join(names if len(names) < _MOST_NAMES else [names[0], "...", names[-1]])
            details = [found.unit or _UNITS.get(quantity.unit, "")]
            if quantity.unit == "angle":
                details = [found.unit or "radians" if key in radians else "degrees"]
                is_guess = key in radians and not self.reading.units.radians
                details += ["they jump by 6.28"] * is_guess
            if key == "position":
                distance = float(np.nanmedian(np.linalg.norm(rows[key], axis=1)))
                details.append(f"{distance:.4g} from the origin")
            more = ", ".join(filter(None, [found.says, *details]))
            yield f"{shown}: {quantity.meaning.partition(';')[0]}" + f" ({more})" * bool(more)


def _table_of(path: str, decimal: str, width: int | None) -> Table | BinaryTable:
    """Return the table in a file.  Raises DataError."""
    name, content = shown_path(path), read_bytes(path)
    table: Table | BinaryTable | None = binary_table(content, name)
    if table is None:
        text = decoded(content, name)
        del content  # one copy of a large file is enough
        table = read_table(text, name, known_quantities, decimal, width)
    if not table.width:
        raise DataError(f"{name} must hold a recording, got no cells")
    return table
