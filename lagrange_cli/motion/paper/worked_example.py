"""Section 8: the steps of the worked example, for any release from rest.

Each step is a key of the record or a key on request, with the symbol and the equation of the paper.
`CHAIN` lists the steps in the order of the paper.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial

from ...arithmetic.numbers import R
from ..quantity import key, quantity, unit_name
from .quarters import Quarters, constant_key

step_key = partial(
    key, "Steps of section 8", absent="unless the top nutates after release from rest"
)


class WorkedExample(Quarters[R]):
    """Steps of section 8; None unless the top nutates after release from rest."""

    @quantity
    def follows(self) -> bool:
        """Whether the equations of the paper hold: the top nutates after release from rest."""
        return self.nutating is not None and self.facts.at_rest

    @constant_key("1 - C/2A", "share of steady spin", "(6,1)", "1 - C/(2*A)")
    def spin_share(self) -> R:
        """The share 1 - C/2A of the uniform part of the spin (6,1)."""
        top = self.exact.top
        return self.ar.convert(1 - Fraction(top.C) / (2 * Fraction(top.A)))

    @step_key("u3 + u2", "b²/a", "(4,11)", "b**2/a")
    def roots_sum(self) -> R | None:
        """The sum u3 + u2 = b^2/a (4,11)."""
        if not self.follows:
            return None
        return self.state.b * self.state.b / self.state.a

    @step_key("u3 u2", "b² u1/a - 1", "(4,12)", "b**2*u1/a - 1")
    def roots_product(self) -> R | None:
        """The product u3 u2 = b^2 u1/a - 1 (4,12)."""
        if self.roots_sum is None:
            return None
        return self.roots_sum * self.state.cos - 1

    @step_key("(u3 + u2)²", "square of the roots' sum", "§8", "roots_sum**2")
    def roots_sum_squared(self) -> R | None:
        """The square of the sum of the roots."""
        return None if self.roots_sum is None else self.roots_sum * self.roots_sum

    @step_key("-4 u3 u2", "-4 times the product", "§8", "-4*roots_product")
    def roots_product_fourfold(self) -> R | None:
        """The product of the roots times -4."""
        return None if self.roots_product is None else -4 * self.roots_product

    @step_key(
        "(u3 - u2)²", "square of the distance", "§8", "roots_sum_squared + roots_product_fourfold"
    )
    def roots_gap_squared(self) -> R | None:
        """The square of the distance of the roots, D/a^2."""
        return None if self.roots_gap is None else self.roots_gap * self.roots_gap

    @step_key("u3 - u2", "distance of the roots", "§8", "sqrt(roots_gap_squared)")
    def roots_gap(self) -> R | None:
        """The distance of the roots u3 and u2."""
        return self.gaps.a_u3_u2 / self.state.a if self.follows else None

    @step_key("2 u3", "roots' sum + distance", "§8", "roots_sum + roots_gap")
    def u3_twice(self) -> R | None:
        """Twice the root u3."""
        u3 = self.kind.u3 if self.follows else None
        return None if u3 is None else 2 * u3

    @step_key("2 u2", "roots' sum - distance", "§8", "roots_sum - roots_gap")
    def u2_twice(self) -> R | None:
        """Twice the root u2."""
        return 2 * self.kind.u2 if self.follows else None

    @step_key("k²", "(u1 - u2)/(u3 - u2)", "(4,19)", "(u1 - u2)/(u3 - u2)")
    def k_squared(self) -> R | None:
        """The square of the modulus (4,19)."""
        return self.kind.m if self.follows else None

    @step_key("arcsin k'", "complementary angle", "(4,21)", "asin(k_prime)", unit="angle")
    def comodular_angle_deg(self) -> R | None:
        """The angle arcsin k' (4,21), in degrees."""
        if not self.follows:
            return None
        return self.ar.atan2(self.kind.k_prime, self.kind.k) / self.kind.degree

    @step_key("E(am, k')", "integral, second kind", "(7,1)", "ellint_E(amplitude, k_prime)")
    def E_amplitude(self) -> R | None:
        """The integral E(phi, k') of (7,1), as a sum of positive terms (DLMF 19.25.10)."""
        if not self.follows:
            return None
        from ...elliptic.incomplete import Amplitude, e_of  # for few keys
        from ...elliptic.modulus import Modulus

        ar, gaps, whole = self.ar, self.gaps, self.gaps.a_below_u3
        sine, cosine = ar.sqrt(gaps.a_u3_u2 / whole), ar.sqrt(self.state.a * gaps.below_u2 / whole)
        amplitude = Amplitude(0, sine, cosine)
        integral: R = e_of(ar, amplitude, Modulus(self.kind.k_prime, self.kind.k))
        return integral


CHAIN = {
    "Inputs": ["m", "A", "C", "s", "g", "r0", "theta0_deg"],
    "The body": ["a", "spin_share"],
    "The start": ["u1", "b", "roots_sum", "roots_product"],
    "The roots": [
        *("roots_sum_squared", "roots_product_fourfold", "roots_gap_squared", "roots_gap"),
        *("u3_twice", "u2_twice", "u3", "u2"),
    ],
    "Modulus and amplitude": [
        *("k_squared", "modular_angle_deg", "comodular_angle_deg", "amplitude_deg"),
    ],
    "Integrals": ["K", "E", "alpha", "E_amplitude"],
    "Nutation": ["T_nutation", "u_quarter"],
    "Spin and precession": [
        *("mean_spin_rate", "mean_precession_rate", "spin_rate_half", "precession_rate_half"),
        *("T_spin", "T_precession"),
    ],
}
"""Keys by step of section 8, in the order of the paper."""


def derivation_keys(*, radians: bool = False) -> list[str]:
    """Return the keys of the steps of section 8, in the order of the paper."""
    return [unit_name(name, radians=radians) for names in CHAIN.values() for name in names]
