"""Rows over time: the time grid or the file of times, and blocks of rows for the writer."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from .motion import Motion
from .top import LagtopError, parse_number

if TYPE_CHECKING:
    from .angles import Array, Sampler

MAX_ROWS = 10**9
BLOCK_ROWS = 1 << 16
DEFAULT_ROWS = 101


@dataclass(frozen=True)
class Grid:
    """The times start + i step, i = 0 ... count - 1, each formed from its own i."""

    start: float
    step: float
    count: int

    def blocks(self) -> Iterator[Array]:
        """The times, a block at a time."""
        import numpy as np

        for first in range(0, self.count, BLOCK_ROWS):
            i = np.arange(first, min(first + BLOCK_ROWS, self.count), dtype=np.float64)
            yield self.start + i * self.step

    def bounds(self) -> list[float]:
        """The first and the last time."""
        return [self.start, self.start + (self.count - 1) * self.step]


@dataclass(frozen=True)
class TimeList:
    """Times that were given one by one."""

    times: list[float]

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.times)

    def blocks(self) -> Iterator[Array]:
        """The times, a block at a time."""
        import numpy as np

        for first in range(0, self.count, BLOCK_ROWS):
            yield np.array(self.times[first : first + BLOCK_ROWS])

    def bounds(self) -> list[float]:
        """The earliest and the latest time."""
        return [min(self.times), max(self.times)]


Times = Grid | TimeList


def grid(
    motion: Motion,
    t_min: Fraction | None = None,
    t_max: Fraction | None = None,
    *,
    n: int | None = None,
    dt: Fraction | None = None,
) -> Grid:
    """n times from t_min to t_max, or as many steps dt as fit, counted in exact arithmetic.

    By default one nutation period (or a unit of time where there is none) from 0, 101 times.
    Raises LagtopError for an interval, a number or a step that makes no grid of 1 to 1e9 rows.
    """
    t_min = Fraction(0) if t_min is None else t_min
    t_max = t_min + Fraction(motion.T_nutation or 1) if t_max is None else t_max
    if not t_max >= t_min:
        raise LagtopError(f"--t-max must be >= --t-min = {float(t_min)}, got {float(t_max)}")
    if n is not None and n < 1:
        raise LagtopError(f"--n must be >= 1, got {n}")
    if dt is not None:
        if not dt > 0:
            raise LagtopError(f"--dt must be > 0, got {float(dt)}")
        count, step = int((t_max - t_min) / dt) + 1, float(dt)
    else:
        count = n or (DEFAULT_ROWS if t_max > t_min else 1)
        step = float((t_max - t_min) / (count - 1)) if count > 1 else 0.0
    if count > MAX_ROWS:
        raise LagtopError(
            f"a grid has at most 1e9 rows, this one would have {count:.4g} "
            "(take a larger --dt, a smaller --n, or --times)"
        )
    return Grid(float(t_min), step, count)


def read_times(path: str) -> TimeList:
    """One time a line, from a file or from standard input for `-`; # starts a comment line.

    Raises LagtopError, with the line's number.
    """
    name = "standard input" if path == "-" else path
    try:
        if path == "-":
            return TimeList(_parse_times(sys.stdin, name))
        with open(path, encoding="utf-8-sig") as lines:
            return TimeList(_parse_times(lines, name))
    except OSError as error:
        raise LagtopError(f"--times {name}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise LagtopError(f"--times {name} must be UTF-8 text, a time a line") from None


def _parse_times(lines: Iterable[str], name: str) -> list[float]:
    times = []
    for i, line in enumerate(lines, 1):
        text = line.strip()
        if text and not text.startswith("#"):
            try:
                times.append(float(parse_number(text)))
            except LagtopError as error:
                raise LagtopError(f"{name}, line {i}: the time {error}") from None
    if not times:
        raise LagtopError(f"{name} must hold at least one time, got none")
    return times


def column_names(*, radians: bool) -> list[str]:
    """The header of the rows."""
    unit = "rad" if radians else "deg"
    return ["t", f"theta_{unit}", f"phi_{unit}", f"psi_{unit}"]


def rows(
    motion: Motion, times: Times, *, radians: bool = False, wrap: bool = False
) -> Iterator[Array]:
    """Blocks of rows (n, 4): t and the three angles, unwrapped unless `wrap`.

    Raises LagtopError, before the first block, where any of the times is out of reach.
    """
    sampler = motion.sampler()
    sampler.check(times.bounds())
    return _rows(sampler, times, radians, wrap)


def _rows(sampler: Sampler, times: Times, radians: bool, wrap: bool) -> Iterator[Array]:
    import numpy as np

    for t in times.blocks():
        block = np.stack([t, *sampler.angles(t, wrap=wrap)], axis=1)
        if not radians:
            np.degrees(block[:, 1:], out=block[:, 1:])
        yield block
