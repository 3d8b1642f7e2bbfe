"""Rows over time: the time grid or the file of times, and blocks of rows for the writer."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING

from .motion import Motion
from .top import LagtopError, parse_number

if TYPE_CHECKING:
    from .angles import Sampler
    from .columns import Column, Sample
    from .digits import NumberText
    from .phase import Array

MAX_ROWS = 10**9
BLOCK_ROWS = 1 << 14
DEFAULT_ROWS = 101
DIGIT_ROWS = 256
"""Rows that settle together under --digits."""
DEFAULT_COLUMNS = ("t", "theta", "phi", "psi")


@dataclass(frozen=True)
class Grid:
    """The times start + i step, i = 0 ... count - 1, each formed from its own i."""

    start: float
    step: float
    count: int
    exact: tuple[Fraction, Fraction]
    """Start and step as the decimals they were given as."""

    def decimals(self) -> Iterator[Fraction]:
        """The times in exact arithmetic."""
        start, step = self.exact
        return (start + i * step for i in range(self.count))

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
        count, step = int((t_max - t_min) / dt) + 1, dt
    else:
        count = n or (DEFAULT_ROWS if t_max > t_min else 1)
        step = (t_max - t_min) / (count - 1) if count > 1 else Fraction(0)
    if count > MAX_ROWS:
        raise LagtopError(
            f"a grid has at most 1e9 rows, this one would have {Decimal(count):.4g} "
            "(take a larger --dt, a smaller --n, or --times)"
        )
    return Grid(float(t_min), float(step), count, (t_min, step))


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


def rows(
    motion: Motion,
    times: Times,
    columns: Sequence[str] = DEFAULT_COLUMNS,
    *,
    radians: bool = False,
    wrap: bool = False,
) -> tuple[list[str], Iterator[Array]]:
    """The header and blocks of rows; the three angles in degrees or radians, wrapped or not.

    Raises LagtopError for an unknown column and, before the first block, for a time out of reach.
    """
    from .columns import COLUMNS

    header = headings(columns, radians=radians)
    chosen = [COLUMNS[name] for name in columns]
    sampler = motion.sampler()
    sampler.check(times.bounds())
    samples = _samples(motion, sampler, times, any(column.needs_rate for column in chosen), wrap)
    return header, (_block(sample, chosen, header) for sample in samples)


def headings(columns: Sequence[str], *, radians: bool = False) -> list[str]:
    """The header of some columns.  Raises LagtopError for an unknown one."""
    from .columns import COLUMNS

    for name in columns or [""]:
        if name not in COLUMNS:
            raise LagtopError(f"--columns must be among {' '.join(COLUMNS)}, got {name!r}")
    if len(set(columns)) < len(columns):
        raise LagtopError(f"--columns must name each column once, got {' '.join(columns)}")
    unit = "rad" if radians else "deg"
    return [text.replace("*", unit) for name in columns for text in COLUMNS[name].headings]


def _samples(
    motion: Motion, sampler: Sampler, times: Times, rate: bool, wrap: bool
) -> Iterator[Sample]:
    from .columns import Sample, column_constants
    from .samplers import solution_of

    constants = column_constants(motion.top, solution_of(motion.top).start)
    for t in times.blocks():
        for part, attitude in sampler.attitudes(t, rate=rate):
            yield Sample(t[part], attitude, constants, wrap)


def _block(sample: Sample, columns: Sequence[Column], header: Sequence[str]) -> Array:
    import numpy as np

    block = np.stack([x for column in columns for x in column.compute(sample)], axis=1)
    for i, heading in enumerate(header):
        if heading.endswith("_deg"):
            np.degrees(block[:, i], out=block[:, i])
    return block


def digit_rows(
    motion: Motion, times: Times, digits: int, *, radians: bool = False, wrap: bool = False
) -> Iterator[list[list[NumberText]]]:
    """Lists of rows, t and the three angles to so many digits; times read as decimals."""
    from .digits import settled_rows

    waiting = times.decimals()
    while some := list(islice(waiting, DIGIT_ROWS)):
        yield settled_rows(motion.top, some, digits, radians=radians, wrap=wrap)
