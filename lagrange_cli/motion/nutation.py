"""Section 5, nutation: its period, its tilts, and the parameter alpha of sections 1 and 7.

Equation numbers in parentheses are Chrapan's.
"""

from __future__ import annotations

from ..arithmetic.numbers import R
from ..elliptic.landen import first_kind
from .moduli import Moduli
from .quantity import key, quantity


class Nutation(Moduli[R]):
    """The numbers of section 5 of a motion, under their keys; None where it has none."""

    @key("Periods", "T", "of the nutation", "time", "(5,1)")
    def T_nutation(self) -> R:
        """The period T = 2K/(dw/dt) (5,1)."""
        return 2 * self.K / self.argument_rate

    @key("Turning points", "u(T/4)", "cos ϑ at T/4", "", "(5,2)")
    def u_quarter(self) -> R | None:
        """u(T/4) after a start at u1 (5,2), written from u1 downwards: a large u3 does no harm."""
        value = self.u1 - self.gaps.u1_u2 * (self.k_prime / (1 + self.k_prime))
        starts_at_u1 = abs(self.gaps.u1_u) <= 0
        if not self.ar.anywhere(starts_at_u1):
            return None
        return self.ar.where(starts_at_u1, value, self.ar.nan)

    @key("Turning points", "ϑ min", "least tilt", "angle", "(4,9)")
    def theta_min_deg(self) -> R:
        """The tilt at u1, in degrees."""
        return self._tilt_deg(self.gaps.above_u1, self.gaps.below_u1)

    @key("Turning points", "ϑ max", "greatest tilt", "angle", "(4,9)")
    def theta_max_deg(self) -> R:
        """The tilt at u2, in degrees."""
        return self._tilt_deg(self.gaps.above_u2, self.gaps.below_u2)

    def _tilt_deg(self, above: R, below: R) -> R:
        return 2 * self.ar.atan2(self.ar.sqrt(above), self.ar.sqrt(below)) / self.degree

    @key("Moduli and integrals", "am α", "amplitude of α", "angle", "(7,2)")
    def amplitude_deg(self) -> R | None:
        """The amplitude of alpha (7,2) in degrees, by its tangent; after release from rest."""
        if not self.facts.at_rest:
            return None
        a_below_u2 = self.a * self.gaps.below_u2
        return (
            self.ar.atan2(self.ar.sqrt(self.gaps.a_u3_u2), self.ar.sqrt(a_below_u2)) / self.degree
        )

    @key("Moduli and integrals", "α", "parameter", "", "(1,6)")
    def alpha(self) -> R | None:
        """The parameter alpha = F(amplitude, k') (1,6) after release from rest."""
        return self.eta_minus if self.facts.at_rest else None

    @quantity
    def eta_minus(self) -> R:
        """The distance of Y from its zero at the top, as an integral F with modulus k'.

        sn^2 = (1 - u1)(u3 - u2)/((u3 - u1)(1 - u2)).
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
