"""Rows over time: the grid of times that suits a motion, and blocks of rows for the writer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

from ...arithmetic.points import EvenPoints, Points
from ...errors import LagtopError
from ...inputs.names import ANGLES
from ..numbers import Numbers
from .columns import chosen_columns, headings, name_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ...arithmetic.types import Array

DEFAULT_ROWS = 101
DEFAULT_COLUMNS = ("t", *ANGLES)


def grid(
    motion: Numbers,
    t_min: Fraction | None = None,
    t_max: Fraction | None = None,
    *,
    n: int | None = None,
    dt: Fraction | None = None,
) -> EvenPoints:
    """Return n times from t_min to t_max, or as many steps dt as fit, counted exactly.

    By default one nutation period (or a unit of time where there is none) from 0, 101 times.
    Raises LagtopError for an interval, a number or a step that makes no grid of 1 to 1e9 rows.
    """
    t_min = Fraction(0) if t_min is None else t_min
    t_max = t_min + Fraction(motion.T_nutation or 1) if t_max is None else t_max
    if not t_max >= t_min:
        raise LagtopError(f"t_max must be >= t_min = {float(t_min)}, got {float(t_max)}", "t_max")
    if n is not None and n < 1:
        raise LagtopError(f"n must be >= 1, got {n}", "n")
    if dt is not None:
        if not dt > 0:
            raise LagtopError(f"dt must be > 0, got {float(dt)}", "dt")
        count, step = int((t_max - t_min) / dt) + 1, dt
    else:
        count = n or (DEFAULT_ROWS if t_max > t_min else 1)
        step = (t_max - t_min) / (count - 1) if count > 1 else Fraction(0)
    try:
        return EvenPoints(t_min, step, count)
    except LagtopError as error:
        raise LagtopError(f"the grid of times {error}") from None


def rows(
    motion: Numbers,
    times: Points,
    columns: Sequence[str] = DEFAULT_COLUMNS,
    *,
    radians: bool = False,
    wrap: bool = False,
    stds: Callable[[Array], Array] | None = None,
) -> tuple[list[str], Iterator[Array]]:
    """Return the header and blocks of rows; angles in degrees or radians, wrapped or not.

    `stds` gives the uncertainties of the three angles at some times, shape (3, times); those of
    the angles among the columns are the last columns.  Raises LagtopError for an unknown column
    and, before the first block, for a time out of reach.
    """
    import numpy as np

    from .sample import samples

    chosen, header = chosen_columns(columns), headings(columns, radians=radians)
    ends = ("t_min", "t_max") if isinstance(times, EvenPoints) else ("t", "t")
    for name, end in zip(ends, times.bounds(), strict=False):  # none where times are read later
        motion.sampler().check(end, name)
    angles = [i for i, name in enumerate(ANGLES) if stds is not None and name in columns]
    names = [f"{heading}_std" for i in angles for heading in headings([ANGLES[i]], radians=radians)]

    start = _start(motion, columns, radians=radians, wrap=wrap)

    def blocks() -> Iterator[Array]:
        for t in times.blocks():
            for _, sample in samples(motion, t, chosen, wrap=wrap):
                block = np.empty((sample.t.size, len(chosen) + len(angles)))
                for column, heading, target in zip(chosen, header, block.T, strict=False):
                    sample.write(column, target)
                    if heading.endswith("_deg"):
                        np.degrees(target, out=target)
                if (first := sample.t == 0).any():
                    block[first, : len(chosen)] = start()
                if stds is not None:
                    spread = stds(sample.t)[angles]
                    block.T[len(chosen) :] = spread if radians else np.degrees(spread)
                yield block

    return [*header, *names], blocks()


class TableRequest(NamedTuple):
    """What to tabulate of every top."""

    times: Callable[[Any], Points]
    """Returns the times for a motion."""
    columns: Sequence[str]
    radians: bool
    wrap: bool
    rows_per_top: int | None
    """Their number, where the options tell it."""
    same: bool
    """Whether all tops have the same times."""

    def headings(self) -> list[str]:
        """Return the names of the columns, with the units of angles."""
        return headings(self.columns, radians=self.radians)

    def rows(
        self, motion: Numbers, times: Points, stds: Callable[[Array], Array] | None = None
    ) -> tuple[list[str], Iterator[Array]]:
        """Return the header and blocks of rows of one motion, as `rows` does."""
        return rows(motion, times, self.columns, radians=self.radians, wrap=self.wrap, stds=stds)


def table(
    motion: Numbers, t: ArrayLike, columns: Sequence[str], *, wrap: bool = False
) -> dict[str, Array]:
    """Return columns by name, each a float64 array in the shape of t; see `Motion.table`."""
    import numpy as np

    from ...arithmetic.arrays import ARRAYS
    from .sample import samples
    from .times import times_of

    chosen, times = chosen_columns(columns), times_of(t)
    motion.sampler().check(times)
    flat = np.ascontiguousarray(times).reshape(-1)
    found = {name_of(column): np.empty_like(flat) for column in chosen}
    with ARRAYS.working():
        for part, sample in samples(motion, flat, chosen, wrap=wrap):
            for column in chosen:
                sample.write(column, found[name_of(column)][part])
    if (first := flat == 0).any():
        row = _start(motion, columns, radians=True, wrap=wrap)()
        for values, value in zip(found.values(), row, strict=True):
            values[first] = value
    return {name: values.reshape(times.shape) for name, values in found.items()}


def _start(
    motion: Numbers, columns: Sequence[str], *, radians: bool, wrap: bool
) -> Callable[[], list[float]]:
    """Return what gives the columns at t = 0 as the nearest doubles, computed once, if at all."""

    @cache
    def row() -> list[float]:
        from .proved_table import ProvedTable

        table = ProvedTable(motion, columns, radians=radians, wrap=wrap)
        return [number.value for number in table.row(Fraction(0))]

    return row
