"""Requests for a table: its columns, and its times, which may form a grid."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

from ...arithmetic.points import EvenPoints, Points
from ...errors import LagtopError
from ..numbers import Numbers
from .columns import headings

if TYPE_CHECKING:
    from ...arithmetic.types import Array

DEFAULT_ROWS = 101


class TableRequest(NamedTuple):
    """The times and columns to tabulate for every top."""

    times: Callable[[Any], Points]
    """Returns the times for a motion."""
    columns: Sequence[str]
    radians: bool
    wrap: bool
    rows_per_top: int | None
    """The number of times, if it is known from the options."""

    def headings(self) -> list[str]:
        """Return the names of the columns, with the units of angles."""
        return headings(self.columns, radians=self.radians)

    def rows(
        self, motion: Numbers, times: Points, stds: Callable[[Array], Array] | None = None
    ) -> tuple[list[str], Iterator[Array]]:
        """Return the header and blocks of rows of one motion, as `rows` does."""
        from .table import rows  # start-up: loads NumPy

        return rows(motion, times, self.columns, radians=self.radians, wrap=self.wrap, stds=stds)


def grid(
    motion: Numbers,
    t_min: Fraction | None = None,
    t_max: Fraction | None = None,
    *,
    n: int | None = None,
    dt: Fraction | None = None,
) -> EvenPoints:
    """Return n times from t_min to t_max, or as many steps dt as fit, counted exactly.

    The default is 101 times over one nutation period from 0, or over a unit of time if the motion
    has no period.  Raises LagtopError unless the interval, n and dt give a grid of 1 to 1e9 rows.
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
