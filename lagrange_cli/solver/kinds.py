"""The kinds of motion that do not nutate: constant tilt, the vertical, and the separatrix.

`lacks` names the keys that a kind does not have.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from typing import Any, TypeAlias

from ..arithmetic.numbers import R
from .facts import Regime
from .quantity import quantity
from .spin_precession import Nutating, SpinPrecession


class Constant(SpinPrecession[R]):
    """A motion at constant tilt, with constant rates: a steady precession, or no torque."""

    lacks = frozenset("amplitude_deg alpha u_quarter spin_rate_half precession_rate_half".split())

    @quantity
    def T_nutation(self) -> Any:
        """The period (5,1) of a small nutation; None if nothing moves."""
        moves = self.argument_rate > 0
        if not self.ar.anywhere(moves):
            return None
        return 2 * self.K / self.ar.where(moves, self.argument_rate, self.ar.nan)

    @quantity
    def theta_min_deg(self) -> R:
        """The tilt, in degrees."""
        return 2 * self.ar.atan2(self.state.sin_half, self.state.cos_half) / self.degree

    @quantity
    def theta_max_deg(self) -> R:
        """The tilt, in degrees."""
        return self.theta_min_deg

    @quantity
    def mean_spin_rate(self) -> R:
        """The constant spin rate (4,8); on the vertical all rotation counts as spin."""
        return self.r0 if self.facts.pole else self.r0 - self.state.psi_rate * self.state.cos

    @quantity
    def spin_rate_start(self) -> R | None:
        """The spin rate, which is constant."""
        return self.mean_spin_rate

    @quantity
    def mean_precession_rate(self) -> R:
        """The precession rate, which is constant."""
        return self.state.psi_rate


class Vertical(Constant[R]):
    """An upright or hanging top: only phi + psi or phi - psi is defined."""

    lacks = Constant.lacks | set(
        "u3 k k_prime modular_angle_deg nome K K_prime E T_nutation "
        "mean_precession_rate precession_rate_start T_precession".split()
    )

    def remark(self, *, radians: bool = False) -> str | None:
        """Return a line on the defined combination of angles and on stability."""
        return vertical_remark(self.facts.regime, bool(self.facts.stable))


def vertical_remark(regime: Regime, stable: bool) -> str:
    """Return the remark on an upright or hanging top."""
    if regime is Regime.HANGING:
        return "only phi - psi is defined; stable"
    word, sign = ("stable", ">=") if stable else ("unstable", "<")
    return f"only phi + psi is defined; {word} (lambda = b^2/2a {sign} 1)"


class Separatrix(SpinPrecession[R]):
    """The swing up to the vertical in infinite time: u1 = u3 = 1, k = 1."""

    lacks = frozenset(
        "amplitude_deg alpha K T_nutation T_spin T_precession u_quarter mean_spin_rate "
        "mean_precession_rate spin_rate_half precession_rate_half".split()
    )

    def remark(self, *, radians: bool = False) -> str | None:
        """Return a line on the motion at late times."""
        return "rises to the vertical in infinite time"

    @quantity
    def m(self) -> R:
        """The parameter k^2, which is 1."""
        return 0 * self.a + 1

    @quantity
    def nome(self) -> R:
        """The nome, which is 1."""
        return self.m

    @quantity
    def E(self) -> R:
        """The complete integral of the second kind, which is 1."""
        return self.m


Kind: TypeAlias = Nutating[R] | Constant[R] | Separatrix[R]
"""Any kind of motion."""
