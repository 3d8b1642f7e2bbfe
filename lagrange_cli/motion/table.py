"""Rows over time: the grid of times that suits a motion, and blocks of rows for the writer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING

from ..arithmetic.points import EvenPoints, Points
from ..errors import LagtopError
from ..inputs.names import check_names
from .solve import Motion

if TYPE_CHECKING:
    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array
    from .columns import Column, Sample
    from .samplers import Sampler

DEFAULT_ROWS = 101
DIGIT_ROWS = 256
"""Rows that settle together under --digits."""
DEFAULT_COLUMNS = ("t", "theta", "phi", "psi")


def grid(
    motion: Motion,
    t_min: Fraction | None = None,
    t_max: Fraction | None = None,
    *,
    n: int | None = None,
    dt: Fraction | None = None,
) -> EvenPoints:
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
    try:
        return EvenPoints(t_min, step, count)
    except LagtopError as error:
        raise LagtopError(f"the grid of times {error}") from None


def rows(
    motion: Motion,
    times: Points,
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
    sampler.check(times.bounds())  # none where times are read as they are needed
    samples = _samples(motion, sampler, times, any(column.needs_rate for column in chosen), wrap)
    return header, (_block(sample, chosen, header) for sample in samples)


def headings(columns: Sequence[str], *, radians: bool = False) -> list[str]:
    """The header of some columns.  Raises LagtopError for an unknown one."""
    from .columns import COLUMNS

    check_names("columns", columns, COLUMNS)
    unit = "rad" if radians else "deg"
    return [text.replace("*", unit) for name in columns for text in COLUMNS[name].headings]


def _samples(
    motion: Motion, sampler: Sampler, times: Points, rate: bool, wrap: bool
) -> Iterator[Sample]:
    from .columns import Sample, column_constants

    constants = column_constants(motion)
    for t in times.blocks():
        sampler.check(t)
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
    motion: Motion, times: Points, digits: int, *, radians: bool = False, wrap: bool = False
) -> Iterator[list[list[NumberText]]]:
    """Lists of rows, t and the three angles to so many digits; times read as decimals."""
    from .digits import rows_in_digits

    waiting = times.decimals()
    while some := list(islice(waiting, DIGIT_ROWS)):
        yield rows_in_digits(motion, some, digits, radians=radians, wrap=wrap)
