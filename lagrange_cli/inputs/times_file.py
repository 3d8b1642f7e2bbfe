"""Times from a file or from standard input, one per line, read as they are needed."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import chain, islice
from typing import TYPE_CHECKING

from ..arithmetic.points import POINTS_AT_ONCE, ListedPoints, Points
from ..arithmetic.text import parse_number
from ..errors import DataError, LagtopError
from .files import opened, shown_path
from .text_tables import NumberedLines, has_row, text_of

if TYPE_CHECKING:
    from ..arithmetic.types import Array


HEADERS = ("t", "time")
"""First rows that name the column: `lagtop table --columns t` writes the first of them."""


class TimesFile(Points):
    """The times of a file, which can be gone through once and need no memory."""

    count = 0

    def __init__(self, path: str, *, counted: bool = False) -> None:
        """Open the file (standard input for `-`) and read its first block of lines.

        Where the times are to be `counted`, the file is read twice; otherwise their count is 0.

        Blank lines, comments and a header are left out.  Raises DataError for a file that
        cannot be read and for a line that is no time, here or while the rest is read.
        """
        if counted:
            self.count = sum(1 for _ in _read(path))
        times = _read(path)
        first = list(islice(times, POINTS_AT_ONCE))
        if not first:
            raise DataError(f"{shown_path(path)} must hold at least one time, got none")
        self._times = chain(first, times)

    def decimals(self) -> Iterator[Fraction]:
        """Yield the times exactly, once."""
        return self._times

    def bounds(self) -> list[float]:
        """Return nothing: only the end of the file can tell."""
        return []

    def blocks(self) -> Iterator[Array]:
        """Yield the times, once, as arrays of at most `POINTS_AT_ONCE`."""
        import numpy as np

        while block := [float(time) for time in islice(self._times, POINTS_AT_ONCE)]:
            yield np.array(block)

    def listed(self, most: int | None = None) -> ListedPoints:
        """Return the times as a list, of which no more than `most` are read."""
        return ListedPoints(list(islice(self._times, most)))


def _read(path: str) -> Iterator[Fraction]:
    name = shown_path(path)
    with opened(path) as file:
        rows = ((number, line) for number, line in NumberedLines(file, name) if has_row(line))
        for i, (number, line) in enumerate(rows):
            try:
                text = text_of(line, "a time").strip()
                if i or text not in HEADERS:
                    yield parse_number(text)
            except LagtopError as error:
                what = "" if str(error).startswith("a time") else "the time "
                raise DataError(f"{name}, line {number}: {what}{error}") from None
