"""Trajectories and times from files or from standard input, held in memory as whole columns.

The first bytes of a file determine its format, not its name: Parquet, or else text.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from io import BytesIO
from itertools import chain
from typing import Any

import numpy as np

from ..arithmetic.text import shortened
from ..arithmetic.types import Array, Mask
from ..errors import DataError, LagtopError, UnavailableError, arg
from ..file_bytes import LARGEST_FILE, decoded, read_bytes, read_text, shown_path
from ..top.ranges import ListedPoints
from .columns import (
    NAMING,
    SKIPPED,
    converted,
    expanded,
    found_in,
    in_known_unit,
    known_quantities,
    quantities_in,
    with_units_of,
)
from .observed import Conventions
from .text_tables import Table, read_table

_BYTES_OF_A_NUMBER = 24
"""Most characters of a number in CSV."""
_FINE = 1e-7
"""Largest rounding of a time, over the time between two rows, that does not matter."""


class Trajectory:
    """The times and quantities of a motion in a file."""

    def __init__(self, table: Table, columns: Sequence[str] | None = None) -> None:
        """Find the quantities and read their numbers; `columns` names all columns from the left.

        Rows that are empty in these columns are left out.  Raises DataError, or LagtopError for
        wrong `columns`.
        """
        self.name, self._place = table.name, table.place
        if columns is not None and len(columns) != table.width:
            wanted = f"all {table.width} columns of {table.name} (_ skips one)"
            raise LagtopError(f"columns must name {wanted}, got {len(columns)} names", "columns")
        names = table.headings if columns is None else columns
        if names is None:
            raise DataError(f"{table.name} has no header: name its {table.width} columns, {NAMING}")
        self.names = names
        try:
            self.quantities = found_in(names)
        except LagtopError as error:
            if columns is not None and error.key == "columns":
                raise
            raise DataError.at(table.name, error) from None
        used = sorted(i for found in self.quantities.values() for i in found.columns)
        self.used = [names[i] for i in used]
        """The names of the columns that are read."""
        self.unused = [x for i, x in enumerate(names) if i not in used and x != SKIPPED]
        """The names of the other columns, except those that `columns` leaves out."""
        self._numbers = table.numbers(used, names)
        self._places = {key: [*map(used.index, x.columns)] for key, x in self.quantities.items()}
        for key, places in self._places.items():
            if len(self._numbers.lines) and self._numbers.empty[:, places].all():
                shown = ", ".join(self.used[i] for i in places)
                remedy = f"remove its columns, or skip them with _, as in {arg('columns', 't,_')}"
                raise DataError(f"{self.name}: {key} is empty ({shown}): {remedy}")
        t = self._numbers.values[:, self._places["t"][0]]
        for i in np.flatnonzero(~np.isfinite(t))[:1]:
            raise DataError(f"{self.where(i)}: t must be a finite number, got {t[i]}")
        self.elapsed = self._elapsed(table, t)
        """Times since the first row, each rounded once."""

    def _elapsed(self, table: Table, t: Array) -> Array:
        """Return the times since the first row, from exact numbers if doubles are too coarse.

        Unix times are such numbers: neighbouring doubles are 2e-7 s apart.
        """
        found, steps = self.quantities["t"], np.abs(np.diff(t))
        steps = steps[steps > 0]
        if steps.size and np.abs(t).max() * 2.0**-53 > _FINE * np.median(steps):
            cells = (table.plain(x) for _, x in table.column(found.columns[0]))
            exact = (Decimal(x) for x in cells if x)
            first = next(exact)
            t = np.fromiter((x - first for x in chain([first], exact)), np.float64)
        return converted("t", found, t - t[:1], radians=True)

    def where(self, row: int) -> str:
        """Return the name of the file and the place of a row."""
        return f"{self.name}, {self._place} {self._numbers.lines[row]}"

    def values(self, *, radians: bool) -> dict[str, Array]:
        """Return every quantity as an array of shape (rows, parts), with NaN for missing numbers.

        Angles are returned in radians; those without a unit are in degrees, or else in `radians`.
        """
        return {
            key: converted(key, found, self._numbers.values[:, self._places[key]], radians=radians)
            for key, found in self.quantities.items()
        }

    def missing(self) -> dict[str, Mask]:
        """Return for every quantity whether a part of it is an empty cell, by row."""
        empty = self._numbers.empty
        return {key: np.any(empty[:, x], axis=1) for key, x in self._places.items()}

    def conventions(self, given: Conventions) -> Conventions:
        """Return conventions, overridden by the names of columns unless they are not the usual."""
        found = {x: self.quantities[x].says for x in given._fields if x in self.quantities}
        usual = type(given)()
        for key in ("rates", "euler"):
            if getattr(given, key) != getattr(usual, key):
                found.pop(key, None)
        implied: dict[str, Any] = {key: says for key, says in found.items() if says}
        return given._replace(**implied)

    def check_times(self, t: Array) -> None:
        """Raise DataError for a time that turns back; it may repeat."""
        ways = np.sign(np.diff(t))
        forth = ways[ways != 0][:1]
        for i in np.flatnonzero(np.r_[False, ways == -forth])[:1] if forth.size else ():
            turned = f"t must not turn back, got {float(t[i])} after {float(t[i - 1])}"
            raise DataError(f"{self.where(i)}: {turned}")


def read_trajectory(
    path: str, columns: Sequence[str] | None = None, decimal: str = ""
) -> Trajectory:
    """Return the trajectory in a file, or in standard input for `-`.

    `columns` names all columns from the left and overrides the names in the file, but a heading's
    unit stays unless the name has one.  `decimal` is as in `read_tops`.  Raises DataError.
    """
    names, name = None if columns is None else expanded(columns), shown_path(path)
    content = read_bytes(path)
    if content.startswith(b"PAR1"):
        content, decimal = _csv_of_parquet(content, name), "."
    text = decoded(content, name)
    del content  # one copy of a large file is enough
    table = read_table(text, name, known_quantities, decimal, len(names or ()) or None)
    if not table.width:
        raise DataError(f"{name} must hold a trajectory, got no cells")
    if names and table.headings and len(table.headings) == len(names):
        names = with_units_of(table.headings, names)
    return Trajectory(table, names)


def _csv_of_parquet(content: bytes, name: str) -> bytes:
    """Return the columns of numbers of a Parquet file as CSV."""
    try:
        from pyarrow import BufferReader, csv, parquet, types
    except ImportError:
        raise UnavailableError(f"{name}: Parquet needs pyarrow: pip install pyarrow") from None
    try:
        file = parquet.ParquetFile(BufferReader(content))
        is_number = types.is_floating, types.is_integer
        names = [x.name for x in file.schema_arrow if any(y(x.type) for y in is_number)]
        time = quantities_in(file.schema_arrow.names).get("t")
        if time is not None and not known_quantities(names):
            got = file.schema_arrow.types[time.columns[0]]
            raise ValueError(f"t must be numbers, got {got}: convert it to doubles")
        size = file.metadata.num_rows * len(names)
        if size > (most := LARGEST_FILE // _BYTES_OF_A_NUMBER):
            raise ValueError(f"it must have at most {most} numbers, has {size}")
        numbers = file.read(columns=names, use_threads=False)  # threads may abort at the exit
        csv.write_csv(numbers, stream := BytesIO())
    except Exception as error:  # no library lists its exceptions
        why = shortened(" ".join(str(error).split()), 100) or type(error).__name__
        raise DataError(f"{name}: bad Parquet file: {why}") from None
    return stream.getvalue()


def read_times(path: str, decimal: str = "") -> ListedPoints:
    """Return the times in a file exactly, from its column `t` or its only column.

    `decimal` is as in `read_tops`.  Raises DataError, also for a row without a time.
    """
    table = read_table(read_text(path), shown_path(path), known_quantities, decimal)
    names = ["t"] * (table.width < 2) if table.headings is None else table.headings
    found = quantities_in(names).get("t")
    if found is None:
        shown = shortened(", ".join(map(repr, names))) or f"{table.width} columns without headings"
        wanted = "the time must be a number below the heading t or time"
        raise DataError(f"{table.name}: {wanted}, got {shown}")
    try:
        factor = in_known_unit("t", found, names).factor or Fraction(1)
    except LagtopError as error:
        raise DataError.at(table.name, error) from None
    times = ListedPoints(_Times(table, found.columns[0], factor))
    if not times.count:
        raise DataError(f"{table.name} must hold at least one time, got none")
    return times


@dataclass
class _Times:
    """The exact numbers in a column of a file, which are read again and again."""

    table: Table
    column: int
    factor: Fraction

    def __iter__(self) -> Iterator[Fraction]:
        for number, cell in self.table.column(self.column):
            try:
                yield self.factor * self.table.number(cell)
            except LagtopError as error:
                raise self.table.wrong(number, f"the time {error.marked}") from None
