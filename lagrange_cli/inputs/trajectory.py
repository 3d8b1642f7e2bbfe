"""Trajectories from files or from standard input, a block of rows at a time.

The first bytes of a file determine its format, not its name: Parquet, npy, npz, JSON lines, or else
text with a row per line.  Times alone are read exactly, from text only.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from fractions import Fraction
from itertools import chain, islice
from typing import TYPE_CHECKING

from ..arithmetic.points import POINTS_AT_ONCE, ListedPoints, Points
from ..arithmetic.text import NumberText, shortened
from ..errors import DataError, LagtopError
from .files import decoded_file, shown_path, temporary_copy
from .names import ANGLES
from .text_lines import UNDECIDED, Dialect, at_line, decoded_row, json_object
from .text_tables import TextTable, read_table
from .trajectory_columns import (
    QUANTITIES,
    FoundQuantity,
    expanded,
    in_known_unit,
    known_quantities,
    named_twice,
    numeric_columns,
    plain_name,
    quantities_in,
)

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from .trajectory_text import Table

_MAGIC = {b"PAR1": "parquet", b"\x93NUM": "npy", b"PK\x03\x04": "npz", b"PK\x05\x06": "npz"}


class Trajectory:
    """An open trajectory: its quantities and its rows."""

    def __init__(self, path: str, table: Table, columns: Sequence[str] | None) -> None:
        """Find the quantities.  Raises DataError without a time, or with nothing but times."""
        self.name, self._table = shown_path(path), table
        self.description = table.description
        self.names = self._column_names(columns)
        found = quantities_in(self.names)
        if "t" not in found or len(found) < 2:
            wanted = f"the time ({QUANTITIES['t'].shown}) and {', '.join([*QUANTITIES][1:])}"
            shown = shortened(", ".join(map(repr, self.names)), 120)
            raise DataError(
                f"{self.name} must have columns among {wanted}, got {shown}: "
                "name them with --columns"
            )
        if twice := named_twice(self.names, found):
            raise DataError(
                f"{self.name} must name each quantity once, got {twice[0]!r} and {twice[1]!r}: "
                "name the columns with --columns, and one of them _"
            )
        try:
            self.quantities = {key: self._in_known_unit(key, x) for key, x in found.items()}
        except LagtopError as error:
            raise DataError(f"{self.name}: {error}") from None

    def _column_names(self, columns: Sequence[str] | None) -> list[str]:
        if columns is not None:
            if len(columns) != self._table.width:
                raise LagtopError(
                    f"columns must name all {self._table.width} columns of {self.name} "
                    f"(_ leaves one out), got {len(columns)} names",
                    "columns",
                )
            return list(columns)
        if self._table.names is None:
            raise DataError(
                f"{self.name} has no header: name its {self._table.width} columns with --columns, "
                "such as t,quaternion"
            )
        return list(self._table.names)

    def _in_known_unit(self, key: str, quantity: FoundQuantity) -> FoundQuantity:
        """Return a quantity in radians, degrees or no unit, with the factor that converts it.

        Times are then in seconds, and rates in radians per second.  Raises LagtopError for a unit
        that the quantity cannot have, and for parts in different units.
        """
        parts = [self.names[i] for i in quantity.columns]
        if len({plain_name(part)[1] for part in parts}) > 1:
            shown = " and ".join(map(repr, parts[:2]))
            raise LagtopError(f"the parts of {key} must have one unit, got {shown}")
        unit, factor = in_known_unit(key, quantity.unit)
        return quantity._replace(unit=unit, factor=factor)

    def add_angle(self, key: str, column: str, unit: str | None) -> str | None:
        """Read one more column of angles, as a quantity named `key`, and return their unit."""
        try:
            known, factor = in_known_unit(ANGLES[0], unit)
        except LagtopError as error:
            raise DataError(f"{self.name}, heading {column}: {error}") from None
        self.quantities[key] = FoundQuantity([self.names.index(column)], "", None, factor)
        return known

    def add_words(self, key: str, column: str) -> Callable[[float], str]:
        """Read one more column, of words, as numbers; return the word of a number."""
        index = self.names.index(column)
        self.quantities[key] = FoundQuantity([index])
        return self._table.word_of(index)

    def blocks(self, *, repeats: bool = False) -> Iterator[tuple[dict[str, Array], Sequence[int]]]:
        """Yield the quantities, once, as arrays of shape (rows, parts), and the places of rows.

        Raises DataError for a cell that is not a number, and for a time that is missing or turns
        back.  A repeated time is an error too, unless `repeats` is true.
        """
        clock = Clock(self, repeats=repeats)
        for found, places in self.rows():
            clock.advance(found["t"][:, 0], places)
            yield found, places

    def rows(self) -> Iterator[tuple[dict[str, Array], Sequence[int]]]:
        """Yield blocks without checking the times (for files that hold several recordings)."""
        wanted = sorted(i for found in self.quantities.values() for i in found.columns)
        for values, places in self._table.blocks(wanted, [self.names[i] for i in wanted]):
            block = {
                key: found.scaled(values[:, [*map(wanted.index, found.columns)]])
                for key, found in self.quantities.items()
            }
            yield block, places

    def where(self, place: int) -> str:
        """Return the name of the file and the place of a row."""
        return f"{self.name}, {self._table.place} {place}"


class Clock:
    """The check that times proceed in one direction, with or without repetitions."""

    def __init__(self, trajectory: Trajectory, *, repeats: bool) -> None:
        self.trajectory, self.repeats, self.direction = trajectory, repeats, 0.0
        self.last: float | None = None

    def advance(self, t: Array, places: Sequence[int]) -> None:
        """Raise DataError for a time that is not finite, turns back, or repeats."""
        import numpy as np

        if bad := np.flatnonzero(~np.isfinite(t)).tolist():
            raise self._error(places[bad[0]], f"t must be a finite number, got {t[bad[0]]}")
        before = np.concatenate([t[:1] if self.last is None else [self.last], t[:-1]])
        ways = (t > before) * 1.0 - (t < before)  # a difference may be beyond all doubles
        moving = ways[ways != 0]
        if not self.direction and moving.size:
            self.direction = float(moving[0])
        if bad := np.flatnonzero(ways * self.direction < 0).tolist():
            i = bad[0]
            wrong = f"t must not turn back, got {float(t[i])} after {float(before[i])}"
            raise self._error(places[i], wrong)
        still = np.flatnonzero(ways == 0)[self.last is None :]  # the first row has no step
        if still.size and not self.repeats:
            wrong = f"t must not repeat, got {float(t[still[0]])} twice"
            raise self._error(places[int(still[0])], wrong)
        self.last = float(t[-1])

    def _error(self, place: int, wrong: str) -> DataError:
        return DataError(f"{self.trajectory.where(place)}: {wrong}")


@contextmanager
def open_trajectory(
    path: str, columns: Sequence[str] | None = None, dialect: Dialect = UNDECIDED
) -> Iterator[Trajectory]:
    """Open the trajectory of a file, or of standard input for `-`.

    `columns` names all columns from the left and overrides the names in the file.  Raises DataError
    for a file that cannot be read or holds no trajectory.
    """
    names, name = None if columns is None else expanded(columns), shown_path(path)
    with decoded_file(path) as stream:
        kind = _MAGIC.get(stream.peek(4)[:4])
        if kind is None:
            from .trajectory_text import read_text  # start-up

            width = None if names is None else len(names)
            yield Trajectory(path, read_text(stream, name, dialect, width), names)
            return
        from .trajectory_arrays import read_arrays  # start-up

        with nullcontext(stream) if stream.seekable() else temporary_copy(stream) as content:
            yield Trajectory(path, read_arrays(content, name, kind), names)


class TimesFile(Points):
    """The times of a file, which can be iterated once and are not held in memory."""

    count = 0

    def __init__(self, path: str, *, counted: bool = False, dialect: Dialect = UNDECIDED) -> None:
        """Open the file (standard input for `-`) and read its first block of lines.

        `counted` reads the file twice to count the times; otherwise their count is 0.  Raises
        DataError for a file that cannot be read and for a row without a time, here or during
        iteration.
        """
        if counted:
            self.count = sum(1 for _ in _times_in(path, dialect))
        times = _times_in(path, dialect)
        first = list(islice(times, POINTS_AT_ONCE))
        if not first:
            raise DataError(f"{shown_path(path)} must hold at least one time, got none")
        self._times = chain(first, times)

    def decimals(self) -> Iterator[Fraction]:
        """Yield the times exactly, once."""
        return self._times

    def bounds(self) -> list[float]:
        """Return an empty list: the bounds are not known before the end of the file."""
        return []

    def blocks(self) -> Iterator[Array]:
        """Yield the times, once, as arrays of at most `POINTS_AT_ONCE`."""
        import numpy as np

        while block := [float(time) for time in islice(self._times, POINTS_AT_ONCE)]:
            yield np.array(block)

    def listed(self, most: int | None = None) -> ListedPoints:
        """Return at most `most` times as a list (default: all)."""
        return ListedPoints(list(islice(self._times, most)))


def _times_in(path: str, dialect: Dialect) -> Iterator[Fraction]:
    """Yield the times of a file, from its column `t` or its only column."""
    name = shown_path(path)
    with decoded_file(path) as stream:
        table = read_table(stream, name, dialect, known_quantities)
        with at_line(name, table.place):
            time_of = _time_reader(table)
        for number, row in table.rows():
            with at_line(name, number):
                time = time_of(row)
            yield time


def _time_reader(table: TextTable) -> Callable[[bytes], Fraction]:
    """Return the function that reads the time in a row.  Raises LagtopError if there is none."""
    if not table.first and table.headings is None:
        return lambda _: Fraction()
    if table.around is not None:
        key, factor = _time_among(list(json_object(table.first[0][1])))
        return lambda row: factor * _time_in_object(row, key)
    headings, place, factor = table.headings, 0, Fraction(1)
    if headings is not None:
        name, factor = _time_among(headings)
        place = list(headings).index(name)
    width = len(headings or table.dialect.cells(decoded_row(table.first[0][1])))
    if width > 1 and headings is None:
        raise LagtopError(f"{width} columns must have headings, t among them, got none")
    dialect = table.decided(numeric_columns(headings or ["t"]))

    def time_of(row: bytes) -> Fraction:
        return factor * _time_of(dialect.row(row, width)[place].strip(), dialect)

    return time_of


def _time_among(names: Sequence[str]) -> tuple[str, Fraction]:
    """Return the name of the column of times, and the size of its unit in seconds."""
    found = quantities_in(names)
    if "t" not in found:
        shown = shortened(", ".join(map(repr, names)))
        raise LagtopError(f"the time must be a number below the heading t or time, got {shown}")
    _, factor = in_known_unit("t", found["t"].unit)
    return names[found["t"].columns[0]], factor or Fraction(1)


def _time_in_object(row: bytes, key: str) -> Fraction:
    json_object(row)  # for its errors
    value = json.loads(row, parse_float=NumberText, parse_int=NumberText).get(key)
    return _time_of(value if isinstance(value, NumberText) else repr(value), Dialect())


def _time_of(text: str, dialect: Dialect) -> Fraction:
    try:
        return dialect.number(text)
    except LagtopError as error:
        raise LagtopError(f"the time {error}") from None
