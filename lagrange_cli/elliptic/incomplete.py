"""Legendre's incomplete integrals F and E of any real amplitude, for k in [0, 1]; their table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction

from flint import acb, arb

from ..top.ranges import MAX_PERIODS, Points, check_reach
from .enclosures import Value, exact
from .functions import nearest as nearest_integer
from .modulus import Modulus, ModulusInput, quarter_period, second_kind
from .tables import TableOfFunctions, nearest


def incomplete_f(sine: arb, cosine: arb, modulus: Modulus) -> arb:
    """Return F(phi, k) = sin phi R_F(cos^2 phi, 1 - k^2 sin^2 phi, 1) (3.1.2), |phi| <= pi/2.

    It is not finite if k = 1 and |phi| = pi/2.
    """
    squares = _squares(sine, cosine, modulus)
    return sine * acb.elliptic_rf(*squares, acb(1)).real


def incomplete_e(sine: arb, cosine: arb, modulus: Modulus) -> arb:
    """Return E(phi, k) for |phi| <= pi/2 (DLMF 19.25.9)."""
    if modulus.k_prime == 0:
        return sine
    squares = _squares(sine, cosine, modulus)
    second = acb.elliptic_rd(*squares, acb(1)).real
    return incomplete_f(sine, cosine, modulus) - modulus.k**2 * sine**3 * second / 3


def _squares(sine: arb, cosine: arb, modulus: Modulus) -> tuple[acb, acb]:
    """Return cos^2 phi and 1 - k^2 sin^2 phi, as sums of squares."""
    return acb(cosine**2), acb(cosine**2 + (modulus.k_prime * sine) ** 2)


class AmplitudeTable(TableOfFunctions):
    """Tables of F and E over amplitudes phi, in radians if the modulus is, else in degrees.

    F(phi + pi) = F(phi) + 2K, and E(phi + pi) = E(phi) + 2E.  For k = 1, F is infinite from a
    quarter turn on.  Raises LagtopError for a modulus out of range and, in doubles, for amplitudes
    beyond 2^50 half turns.
    """

    def __init__(self, points: Points, modulus_input: ModulusInput) -> None:
        super().__init__()
        self.points, self.count, self.modulus = points, points.count, modulus_input

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError for a modulus out of range; see the class for doubles."""
        self.modulus.check()
        if doubles:
            half_turn = math.pi if self.modulus.radians else 180.0
            check_reach("phi", self.points, MAX_PERIODS * half_turn)

    def arguments(self, *, doubles: bool) -> Iterator[Fraction]:
        """Yield the amplitudes."""
        angles = self.points.decimals()
        return map(nearest, angles) if doubles else angles

    def inputs(self, x: Fraction) -> Iterable[Fraction]:
        """Return the amplitude and the modulus."""
        return [x, self.modulus.value]

    def constants(self) -> Modulus:
        """Return the modulus."""
        return self.modulus.ball()

    def columns(self, x: Fraction, constants: Modulus) -> dict[str, Value]:
        """Return the amplitude, F and E; an infinite F is not finite in balls of any precision."""
        angle = exact(x)
        if self.modulus.radians:
            half_turns = nearest_integer(angle / arb.pi())
            sine, cosine = (angle - half_turns * arb.pi()).sin_cos()
        else:
            half_turns = round(x / 180)
            sine, cosine = exact((x - 180 * half_turns) / 180).sin_cos_pi()
        F, E = (within(sine, cosine, constants) for within in (incomplete_f, incomplete_e))
        if half_turns:
            F += 2 * half_turns * quarter_period(constants.k_prime)
            E += 2 * half_turns * second_kind(constants.k_prime)
        return {"phi_rad" if self.modulus.radians else "phi_deg": x, "F": F, "E": E}
