"""Points on a line, evenly or logarithmically spaced or listed, kept exact and rounded once."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import ROUND_HALF_EVEN, Context, Decimal, localcontext
from fractions import Fraction
from typing import TYPE_CHECKING

from ..errors import LagtopError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from .types import Array

    Index = NDArray[np.intp]

POINTS_AT_ONCE = 1 << 14
MOST_POINTS = 10**9

MAX_PERIODS = 2.0**50
"""Beyond, neighbouring doubles lie so far apart that a time no longer names a phase."""

MAX_TIME = 1e290
"""Room for the exact product of a time and a rate."""


_DIGITS_OF_LOG_POINTS = Context(
    prec=30, rounding=ROUND_HALF_EVEN, Emin=-9999, Emax=9999, capitals=1, clamp=0, traps=[]
)


class Points:
    """Points on a line; the subclasses say where they lie."""

    count: int
    """The number of points; 0 where only the end of a file can tell."""

    def at(self, index: Index) -> Array:
        """Return the doubles nearest to the points with these indices."""
        raise NotImplementedError

    def decimals(self) -> Iterator[Fraction]:
        """Yield every point exactly."""
        raise NotImplementedError

    def bounds(self) -> list[float]:
        """Return the two outermost points, or nothing where they are not known yet."""
        import numpy as np

        first, last = self.at(np.array([0, self.count - 1]))
        return [float(first), float(last)]

    def scaled(self, factor: Fraction) -> Points:
        """Return the points times a factor > 0."""
        raise NotImplementedError

    def blocks(self) -> Iterator[Array]:
        """Yield all points as arrays of at most `POINTS_AT_ONCE`."""
        import numpy as np

        for first in range(0, self.count, POINTS_AT_ONCE):
            yield self.at(np.arange(first, min(first + POINTS_AT_ONCE, self.count)))


class EvenPoints(Points):
    """The points start + i step for i from 0 to count - 1."""

    def __str__(self) -> str:
        return f"{self.start}:{self.start + (self.count - 1) * self.step}:{self.count}"

    def scaled(self, factor: Fraction) -> Points:
        """Return the points times a factor."""
        return EvenPoints(self.start * factor, self.step * factor, self.count)

    def __init__(self, start: Fraction, step: Fraction, count: int) -> None:
        """Raise LagtopError where there would be more than 1e9 points."""
        if count > MOST_POINTS:
            size = Context(prec=4, traps=[]).create_decimal(count)
            raise LagtopError(
                f"must have at most 1e9 rows, got {size:.4g} "
                "(take a larger step or a smaller count)"
            )
        self.start, self.step, self.count = start, step, count

    def at(self, index: Index) -> Array:
        """Return start + i step for every i of `index`, each rounded once.

        Pairs of doubles give them to 2^-100 of the largest; where that leaves two doubles to choose
        from, exact fractions decide.
        """
        import numpy as np

        from .double_double import two_product, two_sum
        from .sums_of_doubles import pair

        start, step = pair(self.start), pair(self.step)
        i = index.astype(np.float64)
        with np.errstate(all="ignore"):
            product, rest = two_product(i, step.high)
            total, error = two_sum(product, start.high)
            rest += error + i * step.low + start.low
            margin = 2.0**-100 * max(map(abs, self.bounds())) + 1e-300
            values: Array = total + (rest + margin)
            unsure = np.flatnonzero(values != total + (rest - margin))
        values[unsure] = [float(self.start + int(i) * self.step) for i in index[unsure]]
        return values

    def decimals(self) -> Iterator[Fraction]:
        """Yield every point exactly."""
        return (self.start + i * self.step for i in range(self.count))

    def bounds(self) -> list[float]:
        """Return the first and the last point."""
        return [float(self.start), float(self.start + (self.count - 1) * self.step)]


class LogPoints(Points):
    """Points from one end to the other, neither of them 0, with equal ratios between neighbours."""

    def __str__(self) -> str:
        return f"log:{self.first}:{self.last}:{self.count}"

    def scaled(self, factor: Fraction) -> Points:
        """Return the points times a factor > 0."""
        return LogPoints(self.first * factor, self.last * factor, self.count)

    def __init__(self, first: Fraction, last: Fraction, count: int) -> None:
        self.first, self.last, self.count = first, last, count

    def at(self, index: Index) -> Array:
        """Return first (last/first)^(i/(count - 1)) for every i, computed in 30 digits."""
        import numpy as np

        distinct, where = np.unique(index, return_inverse=True)
        with localcontext(_DIGITS_OF_LOG_POINTS):
            first, last = _decimal(self.first), _decimal(self.last)
            growth = (last / first).ln() / max(self.count - 1, 1)
            values = [float(first * (growth * i).exp()) for i in distinct.tolist()]
        return np.array(values)[where]

    def decimals(self) -> Iterator[Fraction]:
        """Yield every point as the double that stands for it: the exact ones are no fractions."""
        return (Fraction(x) for block in self.blocks() for x in block.tolist())


class ListedPoints(Points):
    """Points that are listed one by one."""

    def __str__(self) -> str:
        return ",".join(map(str, self.exact))

    def scaled(self, factor: Fraction) -> Points:
        """Return the points times a factor."""
        return ListedPoints([point * factor for point in self.exact])

    def __init__(self, exact: list[Fraction]) -> None:
        self.exact, self.count = exact, len(exact)
        self.values = [float(point) for point in exact]

    def at(self, index: Index) -> Array:
        """Return the doubles nearest to the points with these indices."""
        import numpy as np

        return np.array(self.values)[index]

    def decimals(self) -> Iterator[Fraction]:
        """Yield every point exactly."""
        return iter(self.exact)

    def bounds(self) -> list[float]:
        """Return the least and the greatest point."""
        return [min(self.values), max(self.values)]


def check_reach(name: str, points: Points, limit: float) -> None:
    """Raise LagtopError where a point is farther from 0 than the limit."""
    farthest = max(points.bounds(), key=abs)
    if abs(farthest) > limit:
        raise LagtopError(
            f"{name} must be within 2^50 periods = {limit:.3g} of 0, got {farthest} "
            "(or give --digits)",
            name,
        )


def _decimal(value: Fraction) -> Decimal:
    return value.numerator / Decimal(value.denominator)
