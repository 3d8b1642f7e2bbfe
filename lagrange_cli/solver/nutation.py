"""Sections 4 and 5 of the paper: moduli, complete integrals, the period and the tilts.

Equation numbers in parentheses are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Generic

from ..arithmetic.numbers import Arithmetic, R
from ..elliptic.complete import complete_e, complete_k, first_kind, nome, period_mean
from .gaps import Gaps, State
from .quantity import V, key, quantity
from .regime import Facts

_STARTED = "if the top is released from rest"


constant_key = partial(key, "Constants")
modulus_key = partial(key, "Moduli and integrals")
period_key = partial(key, "Periods", unit="time")
turning_key = partial(key, "Turning points")


def root_key(
    u: str, meaning: str, equation: str, only: str = ""
) -> Callable[[Callable[[Any], V]], quantity[V]]:
    """Make a method the key of a root u of the cubic (4,9)."""
    formula = f"(energy_constant - a*{u})*(1 - {u}**2) = (momentum_constant - b*{u})**2"
    return key("Roots", u, meaning, equation, formula, only=only)


class Nutation(Generic[R]):
    """The numbers of sections 4 and 5 by key; None if the motion has no such number."""

    def __init__(self, ar: Arithmetic[R], facts: Facts, state: State[R], gaps: Gaps[R]) -> None:
        self.ar, self.facts, self.state, self.gaps = ar, facts, state, gaps
        self.r0 = state.r0

    @constant_key("a", "2mgs/A", "(4,4)", "2*m*g*s/A", unit="1/time²")
    def a(self) -> R:
        """The torque 2mgs/A (4,4)."""
        return self.state.a

    @constant_key("b", "C r0/A", "(4,5)", "C*r0/A", unit="1/time")
    def b(self) -> R:
        """The spin momentum C r0/A (4,5)."""
        return self.state.b

    @quantity
    def degree(self) -> R:
        """One degree in radians."""
        return self.ar.pi / 180

    @root_key("u1", "cos ϑ, highest", "(4,9)")
    def u1(self) -> R:
        """The upper turning point (4,9)."""
        return self.state.cos + self.gaps.u1_u

    @root_key("u2", "cos ϑ, lowest", "(4,11)")
    def u2(self) -> R:
        """The lower turning point (4,11), computed from its distance to the nearer pole."""
        below, above = self.gaps.below_u2, self.gaps.above_u2
        return self.ar.where(self.ar.either(above < below), 1 - above, below - 1)

    @root_key("u3", "third root", "(4,11)", only="if there is a torque")
    def u3(self) -> R | None:
        """The third root (4,11); None without torque, as it is then infinite."""
        return None if self.facts.free else (self.a + self.gaps.a_u3_above) / self.a

    @quantity
    def m(self) -> R:
        """The parameter k^2 (4,19); 0 if the tilt does not change."""
        return 0 * self.a if self.facts.steady else self.a * self.gaps.u1_u2 / self.gaps.a_u3_u2

    @modulus_key("k", "modulus", "(4,19)", "sqrt((u1 - u2)/(u3 - u2))")
    def k(self) -> R:
        """The modulus (4,19)."""
        return self.ar.sqrt(self.m)

    @modulus_key("k'", "complementary modulus", "(4,21)", "sqrt((u3 - u1)/(u3 - u2))")
    def k_prime(self) -> R:
        """The complementary modulus (4,21), from its own numerator."""
        if self.facts.steady:
            return 0 * self.a + 1
        return self.ar.sqrt(self.gaps.a_u3_u1 / self.gaps.a_u3_u2)

    @modulus_key("arcsin k", "modular angle", "(4,19)", "asin(k)", unit="angle")
    def modular_angle_deg(self) -> R:
        """The angle arcsin k, in degrees."""
        return self.ar.atan2(self.k, self.k_prime) / self.degree

    @modulus_key("q", "nome", "(2,4)", "exp(-pi*K_prime/K)")
    def nome(self) -> R:
        """The nome q (2,4)."""
        return nome(self.ar, m=self.m, k_prime=self.k_prime)

    @modulus_key("K", "integral, first kind, k", "(5,1)", "ellint_F(pi/2, k)")
    def K(self) -> R:
        """The quarter period: the complete integral of the first kind."""
        return complete_k(self.ar, self.k_prime)

    @modulus_key(
        "K'", "integral, first kind, k'", "(2,4)", "ellint_F(pi/2, k_prime)", only="if k > 0"
    )
    def K_prime(self) -> R | None:
        """The quarter period of the complementary modulus; None if k = 0."""
        if self.facts.free or self.facts.steady:
            return None
        return complete_k(self.ar, self.k)

    @modulus_key("E", "integral, second kind, k", "(7,3)", "ellint_E(pi/2, k)")
    def E(self) -> R:
        """The complete integral of the second kind, by Legendre's relation if k > 0.

        E = pi/2K' + K (K' - E')/K' is a sum of positive terms, which are exact at k = 1.
        """
        if self.K_prime is None:
            return complete_e(self.ar, self.k_prime)
        rest = period_mean(self.ar, self.k, 1, 0, self.k_prime * self.k_prime)
        return self.ar.pi / (2 * self.K_prime) + self.K * rest

    @quantity
    def argument_rate(self) -> R:
        """The rate dw/dt of the argument w = sqrt(a (u3 - u2)) t/2 (4,30)."""
        return self.ar.sqrt(self.gaps.a_u3_u2) / 2

    @period_key("T", "nutation period", "(5,1)", "4*K/sqrt(a*(u3 - u2))", only="if the top moves")
    def T_nutation(self) -> R:
        """The period T = 2K/(dw/dt) (5,1)."""
        return 2 * self.K / self.argument_rate

    @turning_key(
        "u(T/4)",
        "cos ϑ at T/4",
        "(5,2)",
        "u1 - (u1 - u2)*k_prime/(1 + k_prime)",
        only="if the start is at u1",
    )
    def u_quarter(self) -> R | None:
        """u(T/4) after a start at u1 (5,2), as a difference from u1: a large u3 costs no digits."""
        value = self.u1 - self.gaps.u1_u2 * (self.k_prime / (1 + self.k_prime))
        starts_at_u1 = abs(self.gaps.u1_u) <= 0
        if not self.ar.anywhere(starts_at_u1):
            return None
        return self.ar.where(starts_at_u1, value, self.ar.nan)

    @turning_key("ϑ min", "least tilt", "(4,9)", "acos(u1)", unit="angle")
    def theta_min_deg(self) -> R:
        """The tilt at u1, in degrees."""
        return self._tilt_deg(self.gaps.above_u1, self.gaps.below_u1)

    @turning_key("ϑ max", "greatest tilt", "(4,9)", "acos(u2)", unit="angle")
    def theta_max_deg(self) -> R:
        """The tilt at u2, in degrees."""
        return self._tilt_deg(self.gaps.above_u2, self.gaps.below_u2)

    def _tilt_deg(self, above: R, below: R) -> R:
        return 2 * self.ar.atan2(self.ar.sqrt(above), self.ar.sqrt(below)) / self.degree

    @modulus_key(
        "am α",
        "amplitude of α",
        "(7,2)",
        "atan(sqrt((u3 - u2)/(1 + u2)))",
        unit="angle",
        only=_STARTED,
    )
    def amplitude_deg(self) -> R | None:
        """The amplitude of alpha (7,2) in degrees, from its tangent, after release from rest."""
        if not self.facts.at_rest:
            return None
        sine, cosine = self.ar.sqrt(self.gaps.a_u3_u2), self.ar.sqrt(self.a * self.gaps.below_u2)
        return self.ar.atan2(sine, cosine) / self.degree

    @modulus_key("α", "parameter", "(1,6)", "ellint_F(amplitude, k_prime)", only=_STARTED)
    def alpha(self) -> R | None:
        """The parameter alpha = F(amplitude, k') (1,6), after release from rest only."""
        return self.eta_minus if self.facts.at_rest else None

    @quantity
    def eta_minus(self) -> R:
        """The distance of Y from its zero at the top, as an integral F with modulus k'.

        It is given by sn^2 = (1 - u1)(u3 - u2)/((u3 - u1)(1 - u2)).
        """
        gaps, ar = self.gaps, self.ar
        scale = gaps.a_u3_u1 * gaps.above_u2
        return first_kind(
            ar,
            m=self.k_prime * self.k_prime,
            k_prime=self.k,
            sn=ar.sqrt(gaps.above_u1 * gaps.a_u3_u2 / scale),
            cn2=gaps.a_u3_above * gaps.u1_u2 / scale,
        )
