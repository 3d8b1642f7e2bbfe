"""The reading of a recording from a file or from standard input, as whole columns."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from typing import Any

import numpy as np

from ..arithmetic.text import quoted
from ..arithmetic.types import Array, Mask
from ..errors import DataError, LagtopError, UnavailableError, arg
from ..file_bytes import shown_path, utf8_path
from ..files.tables import table_in
from ..files.text_tables import EXPONENT
from ..top.units import UNITS
from .clocks import seconds_of, unit_since_1970
from .doubts import why_radians
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
from .recording import Recording, Source, precess_about, used_in

_FINE = 1e-7
"""Largest rounding of a time, over the time between two rows, that does not matter."""
_FROM_0 = "from 0 in the first row"
_MOST_NAMES = 4
_NO_TIME = FoundQuantity(())
_POSE_WIDTH = 12


def read_recording(path: str, reading: Reading) -> Recording:
    """Return the recording in a file, or in standard input for `-`.

    Rows that are empty in all columns that are read are left out.  Raises DataError for a bad file,
    or LagtopError for wrong `columns`.
    """
    names = None if reading.columns is None else expanded(reading.columns)
    try:
        return _File(path, reading, names).recording()
    except LagtopError as error:
        is_of_names = names is not None and error.key == "columns"
        if is_of_names or isinstance(error, DataError | UnavailableError):
            raise
        raise DataError.at(shown_path(path), error) from None


class _File:
    """The columns of a file, and the quantities that are found in them."""

    def __init__(self, path: str, reading: Reading, names: Sequence[str] | None) -> None:
        self.path, self.name, self.reading = path, shown_path(path), reading
        self.table = table_in(path, known_quantities, reading.decimal, len(names or ()) or None)
        if not self.table.width:
            raise DataError(f"{self.name} must hold a recording, got no cells")
        self.names = self._names(names)
        self.quantities = found_in(self.names, needs_time=reading.dt is None)
        self.time = self.quantities.get("t", _NO_TIME)
        if self.time.says == "frames" and reading.dt is None:
            (shown,) = self._named("t")
            raise DataError(f"{self.name}: the column {shown} counts frames: give {arg('fps')}")
        self.clock = self._clock()
        kept = {x: y for x, y in self.quantities.items() if x != "t" or self.clock is None}
        used = sorted(i for x in kept.values() for i in x.columns)
        self.numbers = self.table.numbers(used, self.names)
        if not len(self.numbers.lines):
            raise DataError(f"{self.name} must have at least one row of numbers")
        self.raw: dict[str, Array] = {}
        """The numbers of each quantity as they are written."""
        self.empty: dict[str, Mask] = {}
        """Whether a part of each quantity is an empty cell, by row."""
        for key, found in kept.items():
            places = [*map(used.index, found.columns)]
            self.raw[key], empty = self.numbers.values[:, places], self.numbers.empty[:, places]
            if empty.all():
                shown = ", ".join(self._named(key))
                remedy = f"remove its columns, or skip them with _, as in {arg('columns', 't,_')}"
                raise DataError(f"{self.name}: {key} is empty ({shown}): {remedy}")
            self.empty[key] = np.asarray(empty.any(axis=1))

    def _names(self, names: Sequence[str] | None) -> Sequence[str]:
        """Return the names of all columns: those given, with the units of the headings."""
        width, headings = self.table.width, self.table.headings
        if names is None and headings is None:
            pose = f", or {arg('columns', 'pose')} for a matrix and a translation"
            wanted = f"name its {width} columns, {NAMING}{pose * (width == _POSE_WIDTH)}"
            raise DataError(f"{self.name} has no header: {wanted}")
        if names is None:
            return [" ".join(x.split()) for x in headings or ()]  # messages are one line
        if len(names) != width:
            wanted = f"all {width} columns of {self.name} (_ skips one)"
            raise LagtopError(f"columns must name {wanted}, got {len(names)} names", "columns")
        is_same = headings and len(headings) == len(names)
        return with_units_of(headings, names) if is_same and headings else names

    def _clock(self) -> dict[int, Any] | None:
        """Return the cells of the time by row if they are dates or have colons, else None."""
        if len(self.time.columns) != 1:
            return None
        cells = self.table.column(self.time.columns[0])
        first = next((x for _, x in cells if x), "")
        is_clock = isinstance(first, str) and seconds_of(first) is not None
        return dict(self.table.column(self.time.columns[0])) if is_clock else None

    def recording(self) -> Recording:
        """Return the recording, with the conventions that names imply."""
        reading, lines, rows = self._implied(), dict[str, str](), dict[str, Array]()
        begins, elapsed, lines["t"] = self._times()
        bare = {
            key: x
            for key, x in self.raw.items()
            if QUANTITIES[key].unit == "angle" and self.quantities[key].unit is None
        }
        usual = reading.units.angle
        why = why_radians(bare, reading) if usual == "deg" else ""
        for key, x in self.raw.items():
            if key == "t":
                continue
            found = self.quantities[key]
            unit = found.unit or ("rad" if why and key in bare else usual)
            rows[key] = converted(key, found, x, radians=unit == "rad")
            lines[key] = self._line(key, unit, why if key in bare else "")
        if "position" in rows:
            seen = rows["position"][np.isfinite(rows["position"]).all(axis=1)]
            distance = float(np.median(np.linalg.norm(seen, axis=1))) if len(seen) else 0.0
            lines["position"] += f", {distance:.4g} from the origin"
        rows["t"] = elapsed
        if (centre := precess_about(rows)) is not None:
            lines["psi"] = f"{lines['above']}, about ({centre[0]:.5g}, {centre[1]:.5g})"
            self.quantities["psi"] = self.quantities["above"]
            self.empty["psi"] = self.empty["above"]
        Recording(rows, reading).observed(slice(1))  # raises errors of the alignment
        used = used_in(rows, reading)
        given = {key: x for key, x in rows.items() if key in used}  # in one order
        missing = np.any([self.empty[x] for x in used & self.empty.keys()], axis=0)
        given["missing"] = missing.reshape(-1, 1)
        read = {i for key in used & {*self.quantities} for i in self.quantities[key].columns}
        source = Source(
            utf8_path(self.path),
            [x for i, x in enumerate(self.names) if i in read],
            [x for i, x in enumerate(self.names) if i not in read and x != SKIPPED],
            [text for key, text in lines.items() if key in used],
            "s" if self.time.unit or _FROM_0 in lines["t"] else "units of the recording",
            float(self.time.factor or 1),
        )
        return Recording(given, reading, begins, source).within()

    def _named(self, key: str) -> list[str]:
        return [self.names[i] for i in self.quantities[key].columns]

    def _line(self, key: str, unit: str, why: str) -> str:
        """Return what the columns of a quantity were read as."""
        quantity, found, names = QUANTITIES[key], self.quantities[key], self._named(key)
        shown = ", ".join(names if len(names) < _MOST_NAMES else [names[0], "...", names[-1]])
        words = {"angle": unit, "m": "", "rad": "", "": ""}.get(
            quantity.unit, "rad per unit of time"
        )
        words = found.written or {"deg": "degrees", "rad": "radians"}.get(words, words)
        option = getattr(self._implied(), OPTION_OF[key]) if key in OPTION_OF else found.says
        option += " frame" * (key == "rates")
        parts = [quantity.meaning.partition(";")[0], option, words and f"in {words}"]
        return f"{shown}: {', '.join(filter(None, parts))}" + f" ({why})" * bool(why)

    def _times(self) -> tuple[float, Array, str]:
        """Return the time of the first row, times since then, each rounded once, and a line.

        Raises DataError for a time that is not finite or turns back; it may repeat.
        """
        begins, elapsed, how = self._counted() if self.reading.dt else self._timed()
        ways = np.sign(np.diff(elapsed))
        forth = ways[ways != 0][:1]
        for i in np.flatnonzero(np.r_[False, ways == -forth])[:1] if forth.size else ():
            after, before = (float(begins + x) for x in (elapsed[i], elapsed[i - 1]))
            remedy = "put each recording into its own file"
            wrong = f"t must not turn back, got {after:.10g} after {before:.10g}: {remedy}"
            raise self._wrong(i, wrong)
        names = self._named("t") if self.time.columns else []
        shown = f"column{'s' * (len(names) > 1)} {' and '.join(names)}, " if names else ""
        return begins, elapsed.reshape(-1, 1), f"time: {shown}{how}"

    def _counted(self) -> tuple[float, Array, str]:
        """Return the first time, times since then and words for times that count frames."""
        dt = self.reading.dt or 1.0
        t = self._column() if self.time.columns else np.arange(float(len(self.numbers.lines)))
        for i in np.flatnonzero(t != np.rint(t))[:1]:
            wrong = f"t must count frames if {arg('dt')} or {arg('fps')} is given, got {t[i]:g}"
            raise self._wrong(i, wrong)
        return float(t[0] * dt), (t - t[0]) * dt, f"rows {dt:g} apart"

    def _timed(self) -> tuple[float, Array, str]:
        """Return the first time, times since then and words for times."""
        if self.clock is not None:
            exact: list[Decimal] = []
            for i, line in enumerate(self.numbers.lines):
                if (moment := seconds_of(cell := self.clock[line])) is None:
                    wanted = "13:05:00.25 or 2024-05-31T13:05:00Z"
                    raise self._wrong(i, f"the time must be like {wanted}, got {quoted(cell)}")
                exact.append(moment)
            return 0.0, np.array([float(x - exact[0]) for x in exact]), f"a clock ({_FROM_0})"
        if len(self.time.columns) > 1:
            self._column()
            parts = self.raw["t"] - self.raw["t"][0]
            return 0.0, parts @ [1.0, 1e-9], f"seconds and nanoseconds ({_FROM_0})"
        t, found = self._column(), self.time
        unit = unit_since_1970(t)
        if unit and found.factor is None:
            found = found._replace(factor=UNITS[unit].size, written=unit)
        elif unit != found.written:
            unit = ""
        begins = converted("t", found, t[:1], radians=True)
        elapsed = converted("t", found, self._elapsed(t), radians=True)
        if unit:
            return 0.0, elapsed, f"{unit} since 1970 ({_FROM_0})"
        return float(begins[0]), elapsed, f"in {found.written or 'units of the recording'}"

    def _column(self) -> Array:
        """Return the numbers of the time.  Raises DataError for one that is not finite."""
        t = self.raw["t"]
        for i in np.flatnonzero(~np.isfinite(t).all(axis=1))[:1]:
            raise self._wrong(i, f"t must be a finite number, got {t[i].sum()}")
        return t[:, 0]

    def _wrong(self, row: int, what: str) -> DataError:
        """Return an error with the name of the file and the place of a row."""
        return self.table.wrong(self.numbers.lines[row], what)

    def _elapsed(self, t: Array) -> Array:
        """Return the times since the first row, from exact numbers if doubles are too coarse.

        Unix times are such numbers: neighbouring doubles are 2e-7 s apart.
        """
        steps = np.abs(np.diff(t))
        steps = steps[steps > 0]
        if not steps.size or np.abs(t).max() * 2.0**-53 <= _FINE * np.median(steps):
            return np.asarray(t - t[0])
        lines, plain = {*map(int, self.numbers.lines)}, self.table.plain
        cells = self.table.column(self.time.columns[0])
        exact = [Decimal(plain(x).translate(EXPONENT)) for i, x in cells if i in lines]
        return np.fromiter((x - exact[0] for x in exact), np.float64)

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
