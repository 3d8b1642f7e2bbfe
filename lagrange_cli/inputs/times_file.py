"""Times from a file or from standard input, one per row, read as they are needed."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import chain, islice
from typing import TYPE_CHECKING

from ..arithmetic.points import POINTS_AT_ONCE, ListedPoints, Points
from ..arithmetic.text import NumberText, shortened
from ..errors import DataError, LagtopError
from .files import decoded_file, shown_path
from .text_lines import UNDECIDED, Dialect, at_line, decoded_row, json_object
from .text_tables import TextTable, read_table
from .trajectory_columns import in_known_unit, known_quantities, numeric_columns, quantities_in

if TYPE_CHECKING:
    from ..arithmetic.types import Array


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
            self.count = sum(1 for _ in _read(path, dialect))
        times = _read(path, dialect)
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


def _read(path: str, dialect: Dialect) -> Iterator[Fraction]:
    """Yield the times of a file, from its column `t` or its only column."""
    name = shown_path(path)
    with decoded_file(path) as stream:
        table = read_table(stream, name, dialect, known_quantities)
        with at_line(name, table.place):
            time_of = _reader(table)
        for number, row in table.rows():
            with at_line(name, number):
                time = time_of(row)
            yield time


def _reader(table: TextTable) -> Callable[[bytes], Fraction]:
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
        return factor * _parsed(dialect.row(row, width)[place].strip(), dialect)

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
    return _parsed(value if isinstance(value, NumberText) else repr(value), Dialect())


def _parsed(text: str, dialect: Dialect) -> Fraction:
    try:
        return dialect.number(text)
    except LagtopError as error:
        raise LagtopError(f"the time {error}") from None
