"""Arguments in periods 2K and 2iK': whole periods, and rests that keep their digits.

Next to a pole of a Zeta function, or far from zero, only the rest matters.  So 1/(2K) is held as a
sum of three doubles, and the rest as a sum of two.  A complex number u is 2K (x + y tau) with real
x and y and tau = i K'/K.  Each of x and y is an integer and a rest within 1/2.

NumPy is loaded for arrays only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.ball import TooFewDigitsError
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..errors import LagtopError
from .any_modulus import AnyModulus

if TYPE_CHECKING:  # NumPy is loaded for arrays only
    from ..arithmetic.rounding import Triple
    from ..arithmetic.types import Array

INDICES = ("01", "00", "11", "10")
"""The indices of the four theta functions, in the order of the sources."""


def check_index(ij: str) -> None:
    """Raise LagtopError unless ij is the index of a theta function."""
    if ij not in INDICES:
        raise LagtopError(f"ij must be 01, 00, 11 or 10, got {ij}", "ij")


Complex = Numeric
"""A real or complex number, or array, of the arithmetic in use."""


class Periods(NamedTuple):
    """A real argument in periods: whole periods, and a rest within half a period."""

    turns: Numeric
    rest: Numeric
    low: Numeric = 0.0
    """The part of the rest lost to rounding (arrays only)."""

    def half_further(self, ar: FunctionArithmetic) -> Periods:
        """Return the place half a period further on."""
        forward = ar.either(self.rest < 0)
        if not ar.is_array:
            return Periods(self.turns + (not forward), self.rest + (0.5 if forward else -0.5))
        from ..arithmetic.double_double import two_sum  # start-up

        rest, low = two_sum(self.rest, ar.where(forward, 0.5, -0.5))
        return Periods(self.turns + ar.where(forward, 0.0, 1.0), rest + (low + self.low))


def whole_and_rest(ar: FunctionArithmetic, x: Numeric) -> Periods:
    """Split a real number of periods into whole periods and the rest."""
    turns = ar.nint(x)
    return Periods(turns, x - turns)


def reduced(u: Array, rate: Triple) -> Periods:
    """Convert real arguments to periods by the rate 1/(2K), for |u| up to 1e290."""
    import numpy as np

    from ..arithmetic.double_double import two_product, two_sum  # start-up

    u, high, middle, low = np.broadcast_arrays(np.asarray(u, dtype=float), *rate)
    product, error = two_product(u, high)
    second, second_error = two_product(u, middle)
    turns = product.round()
    total, first_rest = two_sum(product - turns, error)
    total, second_rest = two_sum(total, second)
    rest, low = two_sum(total, first_rest + (second_rest + (second_error + u * low)))
    more = rest.round()
    rest, low = two_sum(rest - more, low)
    return Periods(turns + more, rest, low)


def negligible(ar: FunctionArithmetic) -> float:
    """Return -log of the largest number that is negligible beside 1."""
    magnitude: float = ar.magnitude
    return 2.0 - math.log(10) * magnitude


def is_complex(ar: FunctionArithmetic, x: Complex) -> bool:
    """Return whether a number or an array has an imaginary part."""
    return bool(ar.anywhere(ar.im(x) != 0))


def each_alone(
    ar: FunctionArithmetic, function: Callable[..., Numeric], x: Numeric, *constants: Numeric
) -> Numeric:
    """Return a function of arrays that broadcast, evaluated once for each set of constants."""
    if not ar.is_array:
        return function(x, *constants)
    import numpy as np

    x, *others = np.broadcast_arrays(x, *constants)
    values = np.zeros(x.shape, dtype=np.result_type(float, x, *others))
    for these in set(zip(*(part.ravel() for part in others), strict=True)):
        same = np.all([part == one for part, one in zip(others, these, strict=True)], axis=0)
        values[same] = function(x[same], *these)
    return values


Fine = Numeric
"""A real number of a context, or an array of pairs of doubles."""


class Coordinate(NamedTuple):
    """An integer and a rest, whose sum counts periods."""

    whole: Numeric
    rest: Fine
    number: Numeric = None
    """The coordinate in units of the argument; None for arrays, whose rests cancel exactly."""

    def rest_beside(self, ar: FunctionArithmetic, other: Coordinate, sign: int) -> Fine:
        """Return the sum or the difference of two rests, exactly 0 if the numbers cancel."""
        rest = self.rest + sign * other.rest
        if self.number is None or not ar.either(self.number + sign * other.number == 0):
            return rest
        return 0 * rest

    def exactly(self) -> Fine:
        """Return the sum with all its digits."""
        return fine_whole(self) + self.rest

    def total(self) -> Numeric:
        """Return the sum, rounded once."""
        return self.whole + coarse(self.rest)


class Place(NamedTuple):
    """A complex number as its coordinates along 2K and along 2iK'."""

    x: Coordinate
    y: Coordinate

    def coarse_rests(self) -> tuple[Numeric, Numeric]:
        """Return the rests, rounded once."""
        return coarse(self.x.rest), coarse(self.y.rest)

    def within(self) -> Place:
        """Return the place less its whole periods."""
        none = 0 * self.x.whole
        return Place(*(coordinate._replace(whole=none) for coordinate in self))

    def shifted(self, ar: FunctionArithmetic, by: Place, sign: int) -> Place:
        """Return the place of the sum or the difference of the rests of two places.

        Its rest along 2K may be slightly more than 1/2, so that neighbouring places are seldom in
        different cells.
        """
        x, y = (a.rest_beside(ar, b, sign) for a, b in zip(self, by, strict=True))
        across = coordinate_of(ar, x)
        inside = ar.either(abs(coarse(x)) < _WIDE)
        whole = ar.where(inside, 0 * across.whole, across.whole)
        return Place(Coordinate(whole, x - whole), coordinate_of(ar, y))


_WIDE = 0.52
"""Half the width of a cell."""


class Lattice(NamedTuple):
    """The periods of a modulus, reduced to k strictly between 0 and 1."""

    given: AnyModulus
    circular: bool
    """Whether the series run in the nome of k (k <= k'), not in the nome of k'."""
    steepness: Fine
    """pi K'/K or pi K/K', whichever is at least pi."""
    ratio: Numeric
    """K'/K."""
    bend: Fine
    """1/(1 + (K'/K)^2)."""
    lift: Fine
    """pi K'/K."""

    def rounded(self) -> Lattice:
        """Return the lattice in doubles, and in pairs of doubles the factors of rests."""
        from ..arithmetic.arrays import PAIRS  # start-up

        rests = {name: PAIRS.convert(getattr(self, name)) for name in ("steepness", "bend", "lift")}
        return self._replace(given=self.given.rounded(), ratio=float(self.ratio), **rests)


def lattice(ar: FunctionArithmetic, given: AnyModulus) -> Lattice:
    """Return the periods of a modulus; raise LagtopError for k = 0 and 1, which have only one."""
    if not (given.scale and given.across):
        raise LagtopError("k must not be 0 or 1 for theta functions of complex arguments", "k")
    circular = not ar.either(given.scale < given.across)  # either series serves for K = K'
    ratio = given.scale / given.across
    steepness = ar.pi * (ratio if circular else 1 / ratio)
    if not steepness > 3:
        raise TooFewDigitsError  # the bounds on the truncation errors assume it
    bend, lift = 1 / (1 + ratio * ratio), ar.pi * ratio
    return Lattice(given, circular, steepness, ratio, bend, lift)


def place_of(ar: FunctionArithmetic, u: Complex, periods: Lattice) -> Place:
    """Return the place of complex numbers; arrays keep their digits far from 0."""
    if not ar.is_array:
        ends = (ar.re(u), periods.given.scale), (ar.im(u), periods.given.across)
        return Place(*(coordinate_of(ar, x * rate)._replace(number=x) for x, rate in ends))
    from ..arithmetic.double_double import DoubleDouble  # start-up

    scale, across = periods.given.scale, periods.given.across
    parts = reduced(ar.re(u), scale), reduced(ar.im(u), across)
    return Place(*(Coordinate(turns, DoubleDouble(rest, low)) for turns, rest, low in parts))


def coordinate_of(ar: FunctionArithmetic, x: Fine) -> Coordinate:
    """Split a number of periods into whole periods and a rest."""
    whole = ar.nint(coarse(x))
    return Coordinate(whole, x - whole)


def fine_whole(coordinate: Coordinate) -> Fine:
    """Return the whole periods of a coordinate in the type of rests."""
    return coordinate.rest * 0 + coordinate.whole


def coarse(x: Fine) -> Numeric:
    """Return the nearest doubles, or a number of a context unchanged."""
    return getattr(x, "high", x)
