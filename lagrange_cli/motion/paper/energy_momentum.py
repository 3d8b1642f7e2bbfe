"""Section 4 d and 4 e: constants of the motion and of its cubic, computed on request.

A quantity here is a key like those of the record, of any start, but is not part of the record.
Equation numbers in parentheses are Chrapan's; the start of the text is at rest, where
c1 = mgs u1, c2 = C r0 u1 and D = b^4 - 4 a b^2 u1 + 4 a^2.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Generic

from ...arithmetic.numbers import R
from ..quantity import key

if TYPE_CHECKING:
    from ..kinds import Kind
    from ..regime import Exact


constant_key = partial(key, "Constants of section 4")


class EnergyMomentum(Generic[R]):
    """Constants of one motion, from its kind; None where the motion has none."""

    def __init__(self, kind: Kind[R], exact: Exact) -> None:
        self.kind, self.exact, self.ar = kind, exact, kind.ar
        self.facts, self.state, self.gaps = kind.facts, kind.state, kind.gaps

    @constant_key("c1", "energy but for that of the spin", "energy", "(4,2)")
    def energy_without_spin(self) -> R:
        """The energy c1 = A (theta'^2 + psi'^2 sin^2 theta)/2 + mgs cos theta (4,2)."""
        return self.ar.convert(Fraction(self.exact.top.A)) * self.energy_constant / 2

    @constant_key("c2", "vertical angular momentum", "momentum", "(4,3)")
    def Lz(self) -> R:
        """The momentum c2 = A psi' sin^2 theta + C r0 cos theta (4,3)."""
        return self.ar.convert(Fraction(self.exact.top.A)) * self.momentum_constant

    @constant_key("α (4,4)", "energy constant over A/2", "1/time²", "(4,4)")
    def energy_constant(self) -> R:
        """The constant alpha = 2 c1/A (4,4), which is not the parameter alpha of (1,6)."""
        return self.state.energy + self.state.a * self.state.cos

    @constant_key("β (4,5)", "momentum over A", "1/time", "(4,5)")
    def momentum_constant(self) -> R:
        """The constant beta = c2/A (4,5)."""
        return self.state.momentum + self.state.b * self.state.cos

    @constant_key("D", "discriminant, (a (u3 - u2))²", "1/time⁴", "(4,10)")
    def discriminant(self) -> R:
        """The discriminant of f(u)/(u1 - u) (4,10), at least (b^2 - 2a)^2 after rest."""
        return self.gaps.a_u3_u2 * self.gaps.a_u3_u2

    @constant_key("f(1)", "u'² of (4,9) upright", "1/time²", "(4,9)")
    def f_upright(self) -> R:
        """The cubic (4,9) at u = 1, -(beta - b)^2: negative, or 0 where 1 is a root."""
        return 0 - self.gaps.beta_minus_b * self.gaps.beta_minus_b

    @constant_key("f(-1)", "u'² of (4,9) hanging", "1/time²", "(4,9)")
    def f_hanging(self) -> R:
        """The cubic (4,9) at u = -1, -(beta + b)^2: negative, or 0 where -1 is a root."""
        return 0 - self.gaps.beta_plus_b * self.gaps.beta_plus_b

    @constant_key("f'(u1)", "slope of (4,9) at u1", "1/time²", "(4,9)")
    def f_slope_u1(self) -> R:
        """The slope of (4,9) at u1, -a (u1 - u2)(u3 - u1): after rest -a sin^2 theta0."""
        return 0 - self.gaps.a_u3_u1 * self.gaps.u1_u2

    @constant_key("a u2 u3", "has the sign of u2", "1/time²", "(4,12)")
    def u2_criterion(self) -> R | None:
        """The number a u2 u3, after rest b^2 u1 - a (4,12); None where there is no u3."""
        if "u3" in self.kind.lacks:
            return None
        return self.kind.u2 * (self.state.a + self.gaps.a_u3_above)
