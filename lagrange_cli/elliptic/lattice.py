"""Complex numbers counted in the periods 2K and 2iK': whole ones, and rests that keep their digits.

A number u is 2K (x + y tau) with real x and y, each an integer and a rest within 1/2; tau = i K'/K.
Rests of arrays are pairs of doubles, so that sums and differences of two places are as good as the
places.
"""

from __future__ import annotations

from typing import NamedTuple

from ..arithmetic.double_double import DoubleDouble
from ..arithmetic.protocol import FunctionArithmetic, Value
from ..arithmetic.rounding import Triple, triple
from ..errors import LagtopError
from .any_modulus import AnyModulus, ModulusKind
from .complete import complete_k
from .many_digits import ManyDigits
from .periods import Complex, reduced

Fine = Value
"""A real number of a context, or an array of pairs of doubles."""


class Coordinate(NamedTuple):
    """An integer and a rest, whose sum counts periods."""

    whole: Value
    rest: Fine

    def exactly(self) -> Fine:
        """Return the sum to all its digits."""
        return fine_whole(self) + self.rest

    def total(self) -> Value:
        """Return the sum, rounded once."""
        return self.whole + coarse(self.rest)


class Place(NamedTuple):
    """A complex number as its coordinates along 2K and along 2iK'."""

    x: Coordinate
    y: Coordinate

    def within(self) -> Place:
        """Return the place less its whole periods."""
        none = 0 * self.x.whole
        return Place(Coordinate(none, self.x.rest), Coordinate(none, self.y.rest))

    def shifted(self, ar: FunctionArithmetic, by: Place, sign: int) -> Place:
        """Return the place of the sum or the difference of the rests of two places.

        Its rest along 2K may be a little more than 1/2, so that two places next to each other are
        seldom in different cells.
        """
        x, y = (a.rest + sign * b.rest for a, b in zip(self, by, strict=True))
        across = coordinate_of(ar, x)
        inside = abs(coarse(x)) < _WIDE
        whole = ar.where(inside, 0 * across.whole, across.whole)
        return Place(Coordinate(whole, x - fine_whole(Coordinate(whole, x))), coordinate_of(ar, y))


_WIDE = 0.52
"""Half the width of a cell."""


class Lattice(NamedTuple):
    """The periods of a modulus, k strictly between 0 and 1 after its reduction."""

    kind: ModulusKind
    circular: bool
    """Whether the series run in the nome of k <= k', rather than in that of k'."""
    steepness: Value
    """pi K'/K or pi K/K', whichever is at least pi."""
    ratio: Value
    """K'/K."""
    scale: Value
    """Half periods along 2K for each unit of the argument, stretch/(2K)."""
    along: Triple
    """What a real part is multiplied by."""
    up: Triple
    """What an imaginary part is multiplied by."""
    across: Value
    """stretch/(2K') in many digits."""
    steep: Fine
    """The steepness, to go with rests."""
    bend: Fine
    """1/(1 + (K'/K)^2)."""
    lift: Fine
    """pi K'/K."""

    def rounded(self, ar: FunctionArithmetic) -> Lattice:
        """Return the lattice with its constants in doubles, and those that go with rests in pairs.

        `ar` is the arithmetic of arrays.
        """
        return self._replace(
            steepness=float(self.steepness),
            ratio=float(self.ratio),
            scale=float(self.scale),
            across=float(self.across),
            steep=fine(ar, self.steep),
            bend=fine(ar, self.bend),
            lift=fine(ar, self.lift),
        )


def lattice(ar: ManyDigits, given: AnyModulus) -> Lattice:
    """Return the periods of a modulus.  Raises LagtopError where k is 0 or 1: there is but one."""
    k, k_prime, _ = given.modulus
    if not (k and k_prime):
        raise LagtopError("k must not be 0 or 1 for theta functions of complex arguments", "k")
    K, K_prime = complete_k(ar, k_prime), complete_k(ar, k)
    circular = bool(K <= K_prime)
    ratio = K_prime / K
    steepness = ar.pi * (ratio if circular else 1 / ratio)
    return Lattice(
        given.kind,
        circular,
        steepness,
        ratio,
        given.stretch / (2 * K),
        triple(given.stretch / (2 * K)),
        triple(given.stretch / (2 * K_prime)),
        given.stretch / (2 * K_prime),
        steepness,
        1 / (1 + ratio * ratio),
        ar.pi * ratio,
    )


def place_of(ar: FunctionArithmetic, u: Complex, periods: Lattice) -> Place:
    """Return the place of complex numbers; arrays keep their digits far away."""
    if not ar.is_array:
        return Place(
            coordinate_of(ar, ar.re(u) * periods.scale),
            coordinate_of(ar, ar.im(u) * periods.across),
        )
    parts = (reduced(ar.re(u), periods.along), reduced(ar.im(u), periods.up))
    return Place(*(Coordinate(turns, DoubleDouble(rest, low)) for turns, rest, low in parts))


def coordinate_of(ar: FunctionArithmetic, x: Fine) -> Coordinate:
    """Return a number of periods as whole ones and a rest."""
    whole = ar.nint(coarse(x))
    return Coordinate(whole, x - (DoubleDouble(whole) if ar.is_array else whole))


def fine(ar: FunctionArithmetic, value: Value) -> Fine:
    """Return a many-digit number as one that goes with the rests of places."""
    if not ar.is_array:
        return value
    import numpy as np

    high = float(value)
    return DoubleDouble(np.array([high]), np.array([float(value - high)]))


def fine_whole(coordinate: Coordinate) -> Fine:
    """Return the whole periods of a coordinate as a number that goes with rests."""
    whole = coordinate.whole
    return DoubleDouble(whole) if isinstance(coordinate.rest, DoubleDouble) else whole


def coarse(x: Fine) -> Value:
    """Return the nearest doubles, or a number of a context as it is."""
    return x.high if isinstance(x, DoubleDouble) else x
