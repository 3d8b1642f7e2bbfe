"""Times from a file or from standard input, one per line, read as they are needed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from fractions import Fraction
from itertools import chain, islice
from typing import TYPE_CHECKING

from ..arithmetic.points import POINTS_AT_ONCE, ListedPoints, Points
from ..arithmetic.text import parse_number
from ..errors import DataError, LagtopError

if TYPE_CHECKING:
    from ..arithmetic.types import Array


class TimesFile(Points):
    """The times of a file, which can be gone through once and need no memory."""

    count = 0

    def __init__(self, path: str, *, counted: bool = False) -> None:
        """Open the file (standard input for `-`) and read its first block of lines.

        Where the times are to be `counted`, the file is read twice; otherwise their count is 0.

        Blank lines and lines that begin with # are left out.  Raises LagtopError for a file that
        cannot be read, DataError for a line that is no time, here or while the rest is read.
        """
        if counted:
            self.count = sum(1 for _ in _read(path))
        times = _read(path)
        first = list(islice(times, POINTS_AT_ONCE))
        if not first:
            raise DataError(f"{_name(path)} must hold at least one time, got none")
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
    try:
        if path == "-":
            yield from _parse_times(sys.stdin.buffer if sys.stdin else iter(()), path)
            return
        with open(path, "rb") as lines:
            yield from _parse_times(lines, path)
    except OSError as error:
        raise LagtopError(f"times {_name(path)}: {error.strerror}", "times") from None


def _parse_times(lines: Iterator[bytes], path: str) -> Iterator[Fraction]:
    for number, line in enumerate(lines, 1):
        try:
            text = line.decode("utf-8-sig" if number == 1 else "utf-8").strip()
            if text and not text.startswith("#"):
                yield parse_number(text)
        except UnicodeDecodeError:
            raise DataError(f"{_name(path)}, line {number}: a time must be UTF-8 text") from None
        except LagtopError as error:
            raise DataError(f"{_name(path)}, line {number}: the time {error}") from None


def _name(path: str) -> str:
    return "standard input" if path == "-" else path
