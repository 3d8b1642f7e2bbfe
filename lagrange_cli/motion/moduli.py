"""Section 4 after the roots: moduli, complete integrals, nome and the rate of the argument.

Equation numbers in parentheses are Chrapan's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..arithmetic.numbers import R
from ..arithmetic.values import Over
from ..elliptic.complete import complete_e, complete_k, nome, period_mean
from .gaps import Gaps, State
from .quantity import key, quantity
from .regime import Facts

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic


class Moduli(Over[R]):
    """The numbers of section 4 of a motion, under their keys; None where it has none."""

    def __init__(self, ar: Arithmetic[R], facts: Facts, state: State[R], gaps: Gaps[R]) -> None:
        self.ar, self.facts, self.state, self.gaps = ar, facts, state, gaps
        self.r0 = state.r0

    @key("Constants", "a", "2mgs/A", "1/time²", "(4,4)")
    def a(self) -> R:
        """The torque 2mgs/A (4,4)."""
        return self.state.a

    @key("Constants", "b", "C r0/A", "1/time", "(4,5)")
    def b(self) -> R:
        """The spin momentum C r0/A (4,5)."""
        return self.state.b

    @quantity
    def degree(self) -> R:
        """One degree in radians."""
        return self.ar.pi / 180

    @key("Roots", "u1", "cos ϑ, highest", "", "(4,9)")
    def u1(self) -> R:
        """The upper turning point (4,9)."""
        return self.state.cos + self.gaps.u1_u

    @key("Roots", "u2", "cos ϑ, lowest", "", "(4,11)")
    def u2(self) -> R:
        """The lower turning point (4,11), counted from the nearer pole."""
        below, above = self.gaps.below_u2, self.gaps.above_u2
        return self.ar.where(self.ar.either(above < below), 1 - above, below - 1)

    @key("Roots", "u3", "third root", "", "(4,11)")
    def u3(self) -> R | None:
        """The third root (4,11); None without torque, where it is infinite."""
        return None if self.facts.free else (self.a + self.gaps.a_u3_above) / self.a

    @quantity
    def m(self) -> R:
        """The parameter k^2 (4,19); 0 where the tilt does not change."""
        return 0 * self.a if self.facts.steady else self.a * self.gaps.u1_u2 / self.gaps.a_u3_u2

    @key("Moduli and integrals", "k", "modulus", "", "(4,19)")
    def k(self) -> R:
        """The modulus (4,19)."""
        return self.ar.sqrt(self.m)

    @key("Moduli and integrals", "k'", "complementary modulus", "", "(4,21)")
    def k_prime(self) -> R:
        """The complement (4,21), from its own numerator."""
        if self.facts.steady:
            return 0 * self.a + 1
        return self.ar.sqrt(self.gaps.a_u3_u1 / self.gaps.a_u3_u2)

    @key("Moduli and integrals", "arcsin k", "modular angle", "angle", "(4,19)")
    def modular_angle_deg(self) -> R:
        """The angle arcsin k, in degrees."""
        return self.ar.atan2(self.k, self.k_prime) / self.degree

    @key("Moduli and integrals", "q", "nome", "", "(2,4)")
    def nome(self) -> R:
        """The nome q (2,4)."""
        return nome(self.ar, m=self.m, k_prime=self.k_prime)

    @key("Moduli and integrals", "K", "first kind, k", "", "(5,1)")
    def K(self) -> R:
        """The quarter period: the complete integral of the first kind."""
        return complete_k(self.ar, self.k_prime)

    @key("Moduli and integrals", "K'", "first kind, k'", "", "(2,4)")
    def K_prime(self) -> R | None:
        """The quarter period of the complement; None where k = 0."""
        if self.facts.free or self.facts.steady:
            return None
        return complete_k(self.ar, self.k)

    @key("Moduli and integrals", "E", "second kind, k", "", "(7,3)")
    def E(self) -> R:
        """The complete integral of the second kind, by Legendre's relation where k > 0.

        E = pi/2K' + K (K' - E')/K' is a sum of positive terms that are exact at k = 1.
        """
        if self.K_prime is None:
            return complete_e(self.ar, self.k_prime)
        rest = period_mean(self.ar, self.k, 1, 0, self.k_prime * self.k_prime)
        return self.ar.pi / (2 * self.K_prime) + self.K * rest

    @quantity
    def argument_rate(self) -> R:
        """The rate dw/dt of the argument w = sqrt(a (u3 - u2)) t/2 (4,30)."""
        return self.ar.sqrt(self.gaps.a_u3_u2) / 2
