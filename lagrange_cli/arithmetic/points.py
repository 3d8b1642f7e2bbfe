"""Where to sample: even grids and lists of decimals, kept exact, handed out in blocks."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from ..errors import LagtopError
from .text import parse_number

if TYPE_CHECKING:
    from .types import Array

BLOCK_ROWS = 1 << 14
MAX_ROWS = 10**9

MAX_PERIODS = 2.0**50
"""Beyond, neighbouring doubles lie so far apart that a time no longer names a phase."""

MAX_TIME = 1e290
"""Room for the exact product of a time and a rate."""


@dataclass(frozen=True)
class Grid:
    """The times start + i step, i = 0 ... count - 1, each from its own i, rounded once."""

    count: int
    exact: tuple[Fraction, Fraction]
    """Start and step, as the decimals they were given as."""

    def decimals(self) -> Iterator[Fraction]:
        """The times in exact arithmetic."""
        start, step = self.exact
        return (start + i * step for i in range(self.count))

    def blocks(self) -> Iterator[Array]:
        """The times, a block at a time."""
        import numpy as np

        from .double_double import pair, two_product, two_sum

        start, step = map(pair, self.exact)
        for first in range(0, self.count, BLOCK_ROWS):
            i = np.arange(first, min(first + BLOCK_ROWS, self.count), dtype=np.float64)
            product, rest = two_product(i, step.high)
            total, error = two_sum(product, start.high)
            yield total + (error + rest + i * step.low + start.low)

    def bounds(self) -> list[float]:
        """The first and the last time."""
        start, step = self.exact
        return [float(start), float(start + (self.count - 1) * step)]


@dataclass(frozen=True)
class TimeList:
    """Times that were given one by one."""

    exact: list[Fraction]

    @cached_property
    def times(self) -> list[float]:
        """The doubles nearest to them."""
        return [float(time) for time in self.exact]

    def decimals(self) -> Iterator[Fraction]:
        """The times in exact arithmetic."""
        return iter(self.exact)

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.exact)

    def blocks(self) -> Iterator[Array]:
        """The times, a block at a time."""
        import numpy as np

        for first in range(0, self.count, BLOCK_ROWS):
            yield np.array(self.times[first : first + BLOCK_ROWS])

    def bounds(self) -> list[float]:
        """The earliest and the latest time."""
        return [min(self.times), max(self.times)]


Times = Grid | TimeList


def check_reach(name: str, times: Times, limit: float) -> None:
    """Raise LagtopError where a time is farther from 0 than the limit."""
    farthest = max(times.bounds(), key=abs)
    if abs(farthest) > limit:
        raise LagtopError(
            f"{name} must be within 2^50 periods = {limit:.3g} of 0, got {farthest} "
            "(or give --digits)"
        )


def even_grid(start: Fraction, step: Fraction, count: int) -> Grid:
    """The grid, if it is not too long: raises LagtopError beyond 1e9 rows."""
    if count > MAX_ROWS:
        raise LagtopError(
            f"must have at most 1e9 rows, got {Decimal(count):.4g} "
            "(take a larger step or a smaller count)"
        )
    return Grid(count, (start, step))


def parse_range(text: str) -> Grid:
    """The N numbers from A to B of a text `A:B:N`.  Raises LagtopError for anything else."""
    parts = text.split(":")
    if len(parts) != 3:
        raise LagtopError(f"must be A:B:N, first and last number and how many, got {text!r}")
    first, last, count = map(parse_number, parts)
    if count.denominator != 1 or count < 1:
        raise LagtopError(f"must have a whole number N >= 1 in A:B:N, got {text!r}")
    steps = int(count) - 1
    return even_grid(first, (last - first) / steps if steps else Fraction(0), int(count))


def read_times(path: str) -> TimeList:
    """One time a line, from a file or from standard input for `-`; # starts a comment line.

    Raises LagtopError, with the line's number.
    """
    name = "standard input" if path == "-" else path
    try:
        if path == "-":
            return TimeList(_parse_times(sys.stdin or (), name))
        with open(path, encoding="utf-8-sig") as lines:
            return TimeList(_parse_times(lines, name))
    except OSError as error:
        raise LagtopError(f"--times {name}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise LagtopError(f"--times {name} must be UTF-8 text, a time a line") from None


def _parse_times(lines: Iterable[str], name: str) -> list[Fraction]:
    times = []
    for i, line in enumerate(lines, 1):
        text = line.strip()
        if text and not text.startswith("#"):
            try:
                times.append(parse_number(text))
            except LagtopError as error:
                raise LagtopError(f"{name}, line {i}: the time {error}") from None
    if not times:
        raise LagtopError(f"{name} must hold at least one time, got none")
    return times
