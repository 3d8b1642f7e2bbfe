"""Points on a line, kept exact and rounded once."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Iterator
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from typing import TYPE_CHECKING

from ..arithmetic.text import own_context
from ..errors import LagtopError, arg

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..arithmetic.types import Array

    Index = NDArray[np.intp]

POINTS_AT_ONCE = 1 << 14
MOST_POINTS = 10**9

MAX_PERIODS = 2.0**50
"""Number of periods beyond which neighbouring doubles are too far apart to determine a phase."""

MAX_TIME = 1e290
"""Largest time: the product of a time and a rate can still be computed exactly."""


class Points:
    """Points on a line; subclasses define their places."""

    count: int
    """The number of points; 0 if it is unknown until the end of a file."""
    at: Callable[[Index], Array]
    """Returns the doubles nearest to the points with some indices."""

    def decimals(self) -> Iterator[Fraction]:
        """Yield every point exactly, or as a double if it is not a fraction."""
        return (Fraction(x) for block in self.blocks() for x in block.tolist())

    def bounds(self) -> list[float]:
        """Return the two outermost points, or an empty list if they are not known yet."""
        import numpy as np

        first, last = self.at(np.array([0, self.count - 1]))
        return [float(first), float(last)]

    def blocks(self) -> Iterator[Array]:
        """Yield all points as arrays of at most `POINTS_AT_ONCE`."""
        import numpy as np

        for first in range(0, self.count, POINTS_AT_ONCE):
            yield self.at(np.arange(first, min(first + POINTS_AT_ONCE, self.count)))


class EvenPoints(Points):
    """The points start + i step for i from 0 to count - 1."""

    def __init__(self, start: Fraction, step: Fraction, count: int) -> None:
        """Raise LagtopError for more than 1e9 points."""
        if count > MOST_POINTS:
            size = Context(prec=4, traps=[]).create_decimal(count)
            remedy = "take a larger step or a smaller count"
            raise LagtopError(f"must have at most 1e9 rows, got {size:.4g} ({remedy})")
        self.start, self.step, self.count = start, step, count

    def __str__(self) -> str:
        return f"{self.start}:{self.start + (self.count - 1) * self.step}:{self.count}"

    def at(self, index: Index) -> Array:
        """Return start + i step for every i of `index`, each rounded once.

        Pairs of doubles decide, and exact fractions next to a tie: fractions alone would take half
        as long again as all else of a table in CSV.
        """
        import numpy as np

        from ..arithmetic.pairs import pair, two_product, two_sum  # start-up

        start, step, i = pair(self.start), pair(self.step), index.astype(np.float64)
        margin = 2.0**-100 * max(map(abs, self.bounds())) + 1e-300
        with np.errstate(all="ignore"):
            product, rest = two_product(i, step.high)
            total, error = two_sum(product, start.high)
            rest = rest + (error + i * step.low + start.low)
            values: Array = total + (rest + margin)
            sure = np.isfinite(values) & (values == total + (rest - margin))
        unsure = np.flatnonzero(~sure)
        values[unsure] = [float(self.start + int(i) * self.step) for i in index[unsure]]
        return values + 0.0  # no negative zero

    def decimals(self) -> Iterator[Fraction]:
        """Yield every point exactly."""
        return (self.start + i * self.step for i in range(self.count))

    def bounds(self) -> list[float]:
        """Return the first and the last point."""
        return [float(self.start), float(self.start + (self.count - 1) * self.step)]


class LogPoints(Points):
    """Points with a constant ratio between neighbours; neither end is 0."""

    def __init__(self, first: Fraction, last: Fraction, count: int) -> None:
        self.first, self.last, self.count = first, last, count

    def __str__(self) -> str:
        return f"log:{self.first}:{self.last}:{self.count}"

    def at(self, index: Index) -> Array:
        """Return first (last/first)^(i/(count - 1)) for every i, computed in 30 digits."""
        import numpy as np

        distinct, where = np.unique(index, return_inverse=True)
        with localcontext(own_context(30)):
            first, last = (x.numerator / Decimal(x.denominator) for x in (self.first, self.last))
            growth = (last / first).ln() / max(self.count - 1, 1)
            values = [float(first * (growth * i).exp()) for i in distinct.tolist()]
        return np.array(values)[where]


class ListedPoints(Points):
    """Points that are listed one by one."""

    def __init__(self, exact: Iterable[Fraction]) -> None:
        """Take points that can be read again, such as a list."""
        self.exact, self.values = exact, array("d", map(float, exact))
        self.count = len(self.values)

    def __str__(self) -> str:
        return ",".join(map(str, self.exact))

    def at(self, index: Index) -> Array:
        """Return the doubles nearest to the points with these indices."""
        import numpy as np

        return np.frombuffer(self.values)[index]

    def decimals(self) -> Iterator[Fraction]:
        """Yield every point exactly."""
        return iter(self.exact)

    def bounds(self) -> list[float]:
        """Return the least and the greatest point."""
        return [min(self.values), max(self.values)]


def check_reach(name: str, points: Points, limit: float) -> None:
    """Raise LagtopError if a point is farther from 0 than the limit."""
    farthest = max(points.bounds(), key=abs)
    if abs(farthest) > limit:
        wanted, remedy = f"within 2^50 periods = {limit:.3g} of 0", f"or use {arg('digits', 'N')}"
        if not limit:
            wanted = "0, because a period is too small for a double"
            remedy = f"with {arg('digits', 'N')}, give it in units of K: {farthest:g}K"
        raise LagtopError(f"{name} must be {wanted}, got {farthest} ({remedy})", name)
