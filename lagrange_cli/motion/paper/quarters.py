"""Sections 4 to 7 on request: constants of the motion, angles after half a period, and quarters.

The constants of the motion and of its cubic (4 d, 4 e) exist for any start.  The paper starts at
rest.  Then `c1 = mgs u1`, `c2 = C r0 u1` and `D = b^4 - 4 a b^2 u1 + 4 a^2`.  Only a nutating top
has angles and mean rates of parts of a period.  Quarters are counted from a passage of u1: the
first and the last are next to u1, the other two next to u2.  By symmetry, both quarters of a pair
have the same mean rates, except for the sign of the nutation.  Equation numbers in parentheses are
Chrapan's.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Generic, NamedTuple

from ...arithmetic.numbers import R
from ..kinds import Kind
from ..quantity import key, quantity
from ..spin_precession import HALF_OVER_POLE, Nutating

if TYPE_CHECKING:
    from ..regime import Exact

constant_key = partial(key, "Constants of section 4")
STILL = "unless the top nutates"
angle_key = partial(key, "Angles after half a period and a whole one", unit="angle", absent=STILL)
half_key = partial(angle_key, absent=f"{STILL}, and {HALF_OVER_POLE}")
quarter_key = partial(key, "Mean rates of the quarters", unit="rad/time", absent=STILL)
rate_key = partial(quarter_key, absent=f"{STILL}, and if it passes over a pole")
_MIDDLE = "where U = u1 - (u1 - u2)*k_prime/(1 + k_prime)"
"""Definition of the cosine of the tilt between two quarters (5,2)."""


class EnergyMomentum(Generic[R]):
    """Constants of one motion, from its kind; None if the motion has no such constant."""

    def __init__(self, kind: Kind[R], exact: Exact) -> None:
        self.kind, self.exact, self.ar = kind, exact, kind.ar
        self.facts, self.state, self.gaps = kind.facts, kind.state, kind.gaps

    @constant_key(
        "c1",
        "energy without the spin part",
        "(4,2)",
        "A*(thetadot0**2 + psidot0**2*sin(theta0)**2)/2 + m*g*s*cos(theta0)",
        unit="mass len²/time²",
    )
    def energy_without_spin(self) -> R:
        """The energy c1 = A (theta'^2 + psi'^2 sin^2 theta)/2 + mgs cos theta (4,2)."""
        return self.ar.convert(Fraction(self.exact.top.A)) * self.energy_constant / 2

    @constant_key(
        "c2",
        "vertical angular momentum",
        "(4,3)",
        "A*psidot0*sin(theta0)**2 + C*r0*cos(theta0)",
        unit="mass len²/time",
    )
    def Lz(self) -> R:
        """The momentum c2 = A psi' sin^2 theta + C r0 cos theta (4,3)."""
        return self.ar.convert(Fraction(self.exact.top.A)) * self.momentum_constant

    @constant_key(
        "α₄", "energy constant over A/2", "(4,4)", "2*energy_without_spin/A", unit="1/time²"
    )
    def energy_constant(self) -> R:
        """The constant alpha = 2 c1/A (4,4), distinct from the parameter alpha of (1,6)."""
        return self.state.energy + self.state.a * self.state.cos

    @constant_key("β", "momentum over A", "(4,5)", "Lz/A", unit="1/time")
    def momentum_constant(self) -> R:
        """The constant beta = c2/A (4,5)."""
        return self.state.momentum + self.state.b * self.state.cos

    @constant_key("D", "discriminant, (a (u3 - u2))²", "(4,10)", "(a*(u3 - u2))**2", unit="1/time⁴")
    def discriminant(self) -> R:
        """The discriminant of f(u)/(u1 - u) (4,10); at least (b^2 - 2a)^2 after rest."""
        return self.gaps.a_u3_u2 * self.gaps.a_u3_u2

    @constant_key(
        "f(1)", "u'² of (4,9) upright", "(4,9)", "-(momentum_constant - b)**2", unit="1/time²"
    )
    def f_upright(self) -> R:
        """The cubic (4,9) at u = 1, -(beta - b)^2: negative, or 0 if 1 is a root."""
        return 0 - self.gaps.beta_minus_b * self.gaps.beta_minus_b

    @constant_key(
        "f(-1)", "u'² of (4,9) hanging", "(4,9)", "-(momentum_constant + b)**2", unit="1/time²"
    )
    def f_hanging(self) -> R:
        """The cubic (4,9) at u = -1, -(beta + b)^2: negative, or 0 if -1 is a root."""
        return 0 - self.gaps.beta_plus_b * self.gaps.beta_plus_b

    @constant_key(
        "f'(u1)", "slope of (4,9) at u1", "(4,9)", "-a*(u1 - u2)*(u3 - u1)", unit="1/time²"
    )
    def f_slope_u1(self) -> R:
        """The slope of (4,9) at u1, -a (u1 - u2)(u3 - u1); -a sin^2 theta0 after rest."""
        return 0 - self.gaps.a_u3_u1 * self.gaps.u1_u2

    @constant_key("a u2 u3", "criterion for the sign of u2", "(4,12)", "a*u2*u3", unit="1/time²")
    def u2_criterion(self) -> R | None:
        """The number a u2 u3, which is b^2 u1 - a (4,12) after rest; None without a u3."""
        if "u3" in self.kind.lacks:
            return None
        return self.kind.u2 * (self.state.a + self.gaps.a_u3_above)


class Turned(NamedTuple, Generic[R]):
    """Increments, or mean rates, of spin and precession; None if the motion has no such numbers."""

    phi: R | None = None
    psi: R | None = None


class Quarters(EnergyMomentum[R]):
    """Angles and mean rates of parts of a period; None without a period, or on a pole."""

    @quantity
    def nutating(self) -> Nutating[R] | None:
        """The motion if it nutates, else None."""
        return self.kind if isinstance(self.kind, Nutating) else None

    @quantity
    def over_half(self) -> Turned[R]:
        """The increments in half a period; from a turning point, the mean rates times T/2."""
        kind = self.nutating
        if kind is None or kind.precession_rate_half is None:
            return Turned()
        half, gaps = kind.T_nutation / 2, self.gaps
        turning = not (gaps.u1_u > 0 and gaps.u_u2 > 0)
        if turning and not self.facts.meets_a_pole:
            return Turned(kind.mean_spin_rate * half, kind.mean_precession_rate * half)
        from ..over_time.series_constants import pose_of  # start-up: not for a record

        at = pose_of(kind)(half)
        return Turned(at.phi, at.psi)

    @quantity
    def next_to_u1(self) -> Turned[R]:
        """The mean rates in the quarter after a passage of u1; None over a pole."""
        kind = self.nutating
        if kind is None or self.facts.meets_a_pole:
            return Turned()
        from ..over_time import series_constants as series  # start-up: not for a record

        pose, since_top = series.pose_of(kind), -series.periods_since_top(kind)
        first, last = (
            pose(kind.T_nutation * passed) for passed in (since_top, (4 * since_top + 1) / 4)
        )
        increments = last.phi - first.phi, last.psi - first.psi
        return Turned(*(4 * increment / kind.T_nutation for increment in increments))

    @quantity
    def next_to_u2(self) -> Turned[R]:
        """The mean rates in the quarter before a passage of u2; None over a pole."""
        kind, upper = self.nutating, self.next_to_u1
        if kind is None or upper.phi is None or upper.psi is None:
            return Turned()
        spin, precession = 2 * kind.mean_spin_rate, 2 * kind.mean_precession_rate
        return Turned(spin - upper.phi, precession - upper.psi)

    @half_key("φ(T/2)", "spin after half a period", "§6", "integral(phidot, 0, T_nutation/2)")
    def phi_half_deg(self) -> R | None:
        """The spin after half a period, in degrees."""
        return self._in_degrees(self.over_half.phi)

    @angle_key("φ(T)", "spin after a period", "§6", "mean_spin_rate*T_nutation")
    def phi_period_deg(self) -> R | None:
        """The spin after a period, in degrees."""
        kind = self.nutating
        return None if kind is None else kind.mean_spin_rate * kind.T_nutation / kind.degree

    @half_key("ψ(T/2)", "precession after half a period", "§7", "integral(psidot, 0, T_nutation/2)")
    def psi_half_deg(self) -> R | None:
        """The precession after half a period, in degrees."""
        return self._in_degrees(self.over_half.psi)

    @angle_key("ψ(T)", "precession after a period", "§7", "mean_precession_rate*T_nutation")
    def psi_period_deg(self) -> R | None:
        """The precession after a period, in degrees."""
        kind = self.nutating
        return None if kind is None else kind.mean_precession_rate * kind.T_nutation / kind.degree

    def _in_degrees(self, angle: R | None) -> R | None:
        return None if angle is None else angle / self.kind.degree

    @quantity
    def nutation_rates(self) -> tuple[R, R] | tuple[None, None]:
        """The mean nutation rates from u1 to T/4, where u is (5,2), and from T/4 to u2."""
        kind, ar, gaps = self.nutating, self.ar, self.gaps
        if kind is None:
            return None, None
        fall, rise = (gaps.u1_u2 * part / (1 + kind.k_prime) for part in (kind.k_prime, 1))
        places = (
            (gaps.above_u1, gaps.below_u1),
            (gaps.above_u1 + fall, gaps.below_u2 + rise),
            (gaps.above_u2, gaps.below_u2),
        )
        first, middle, last = (2 * ar.atan2(ar.sqrt(x), ar.sqrt(y)) for x, y in places)
        return 4 * (middle - first) / kind.T_nutation, 4 * (last - middle) / kind.T_nutation

    @quarter_key(
        "ϑ' 1st",
        "mean rate, quarter after u1",
        "§5",
        f"4*(acos(U) - theta_min)/T_nutation {_MIDDLE}",
    )
    def nutation_rate_upper(self) -> R | None:
        """The mean nutation rate from u1 to T/4; in the last quarter it is the opposite."""
        return self.nutation_rates[0]

    @quarter_key(
        "ϑ' 2nd",
        "mean rate, quarter before u2",
        "§5",
        f"4*(theta_max - acos(U))/T_nutation {_MIDDLE}",
    )
    def nutation_rate_lower(self) -> R | None:
        """The mean nutation rate from T/4 to u2; in the third quarter it is the opposite."""
        return self.nutation_rates[1]

    @rate_key(
        "φ' 1st",
        "mean rate, quarters at u1",
        "§6",
        "4*integral(phidot, t1, t1 + T_nutation/4)/T_nutation",
    )
    def spin_rate_upper(self) -> R | None:
        """The mean spin rate of the first and of the last quarter."""
        return self.next_to_u1.phi

    @rate_key("φ' 2nd", "mean rate, quarters at u2", "§6", "2*mean_spin_rate - spin_rate_upper")
    def spin_rate_lower(self) -> R | None:
        """The mean spin rate of the second and of the third quarter."""
        return self.next_to_u2.phi

    @rate_key(
        "ψ' 1st",
        "mean rate, quarters at u1",
        "§7",
        "4*integral(psidot, t1, t1 + T_nutation/4)/T_nutation",
    )
    def precession_rate_upper(self) -> R | None:
        """The mean precession rate of the first and of the last quarter."""
        return self.next_to_u1.psi

    @rate_key(
        "ψ' 2nd",
        "mean rate, quarters at u2",
        "§7",
        "2*mean_precession_rate - precession_rate_upper",
    )
    def precession_rate_lower(self) -> R | None:
        """The mean precession rate of the second and of the third quarter."""
        return self.next_to_u2.psi
