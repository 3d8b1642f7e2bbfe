"""Sections 4 to 8 on request: constants, angles after half a period, quarters, worked example.

The constants of the motion and of its cubic (4 d, 4 e) exist for any start.  The paper starts at
rest.  Then `c1 = mgs u1`, `c2 = C r0 u1` and `D = b^4 - 4 a b^2 u1 + 4 a^2`.  Only a nutating top
has angles and mean rates of parts of a period.  Quarters are counted from a passage of u1: the
first and the last are next to u1, the other two next to u2.  By symmetry, both quarters of a pair
have the same mean rates, except for the sign of the nutation.  The steps of section 8 are those of
the worked example, for any release from rest.  Equation numbers in parentheses are Chrapan's.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, Generic, NamedTuple

from ..arithmetic.numbers import R
from .kinds import Kind
from .quantity import declared_keys, quantity
from .spin_precession import HALF_OFF_POLE, Nutating

if TYPE_CHECKING:
    from .regime import Exact

_NUTATES = "if the top nutates"
_MIDDLE = "where U = u1 - (u1 - u2)*k_prime/(1 + k_prime)"
"""Definition of the cosine of the tilt between two quarters (5,2)."""


_CONSTANTS = "Constants of section 4"
_constant = declared_keys(_CONSTANTS)
_square = declared_keys(_CONSTANTS, unit="1/time²")
_ANGLES = "Angles after half a period and a whole one"
_whole = declared_keys(_ANGLES, lambda of: of.nutating, unit="angle", only=_NUTATES)
_half = declared_keys(
    _ANGLES, lambda of: of.over_half, unit="angle", only=f"{_NUTATES}, and {HALF_OFF_POLE}"
)
_QUARTERS = "Mean rates of the quarters"
_nutation = declared_keys(_QUARTERS, lambda of: of.nutating, unit="rad/time", only=_NUTATES)
_quarter = declared_keys(
    _QUARTERS,
    lambda of: of.next_to_u1,
    unit="rad/time",
    only=f"{_NUTATES} and does not pass over a pole",
)
_step = declared_keys(
    "Steps of section 8",
    lambda of: of.follows,
    only="if the top nutates after release from rest",
)


class Turned(NamedTuple, Generic[R]):
    """Increments, or mean rates, of spin and precession."""

    phi: R
    psi: R


class Sections(Generic[R]):
    """Keys of one motion on request, from its kind; None if the motion has no such number."""

    def __init__(self, kind: Kind[R], exact: Exact) -> None:
        self.kind, self.top, self.ar = kind, exact.top, kind.ar
        self.facts, self.state, self.gaps = kind.facts, kind.state, kind.gaps

    energy_without_spin = _constant(
        *("c1", "energy without the spin part", "(4,2)"),
        "A*(thetadot0**2 + psidot0**2*sin(theta0)**2)/2 + m*g*s*cos(theta0)",
        value=lambda of: of.A * of.energy_constant / 2,
        unit="mass len²/time²",
    )
    Lz = _constant(
        *("c2", "vertical angular momentum", "(4,3)"),
        "A*psidot0*sin(theta0)**2 + C*r0*cos(theta0)",
        value=lambda of: of.A * of.momentum_constant,
        unit="mass len²/time",
    )
    energy_constant = _square(
        *("α₄", "energy constant over A/2", "(4,4)", "2*energy_without_spin/A"),
        value=lambda of: of.state.energy + of.state.a * of.state.cos,
    )
    momentum_constant = _constant(
        *("β", "momentum over A", "(4,5)", "Lz/A"),
        value=lambda of: of.state.momentum + of.state.b * of.state.cos,
        unit="1/time",
    )
    discriminant = _constant(  # of f(u)/(u1 - u); at least (b^2 - 2a)^2 after rest
        *("D", "discriminant, (a (u3 - u2))²", "(4,10)", "(a*(u3 - u2))**2"),
        value=lambda of: of.gaps.a_u3_u2 * of.gaps.a_u3_u2,
        unit="1/time⁴",
    )
    f_upright = _square(  # negative, or 0 if 1 is a root
        *("f(1)", "u'² of (4,9) upright", "(4,9)", "-(momentum_constant - b)**2"),
        value=lambda of: 0 - of.gaps.beta_minus_b * of.gaps.beta_minus_b,
    )
    f_hanging = _square(  # negative, or 0 if -1 is a root
        *("f(-1)", "u'² of (4,9) hanging", "(4,9)", "-(momentum_constant + b)**2"),
        value=lambda of: 0 - of.gaps.beta_plus_b * of.gaps.beta_plus_b,
    )
    f_slope_u1 = _square(  # -a sin^2 theta0 after rest
        *("f'(u1)", "slope of (4,9) at u1", "(4,9)", "-a*(u1 - u2)*(u3 - u1)"),
        value=lambda of: 0 - of.gaps.a_u3_u1 * of.gaps.u1_u2,
    )
    u2_criterion = _square(
        *("a u2 u3", "criterion for the sign of u2", "(4,12)", "a*u2*u3"),
        value=lambda of: of.kind.u2 * (of.state.a + of.gaps.a_u3_above),
        exists=lambda of: "u3" not in of.kind.lacks,
    )

    phi_half_deg = _half(
        *("φ(T/2)", "spin after half a period", "§6", "integral(phidot, 0, T_nutation/2)"),
        value=lambda of: of.over_half.phi / of.kind.degree,
    )
    phi_period_deg = _whole(
        *("φ(T)", "spin after a period", "§6", "mean_spin_rate*T_nutation"),
        value=lambda of: of.kind.mean_spin_rate * of.kind.T_nutation / of.kind.degree,
    )
    psi_half_deg = _half(
        *("ψ(T/2)", "precession after half a period", "§7", "integral(psidot, 0, T_nutation/2)"),
        value=lambda of: of.over_half.psi / of.kind.degree,
    )
    psi_period_deg = _whole(
        *("ψ(T)", "precession after a period", "§7", "mean_precession_rate*T_nutation"),
        value=lambda of: of.kind.mean_precession_rate * of.kind.T_nutation / of.kind.degree,
    )

    nutation_rate_upper = _nutation(  # in the last quarter it is the opposite
        *("ϑ' 1st", "mean rate, quarter after u1", "§5"),
        f"4*(acos(U) - theta_min)/T_nutation {_MIDDLE}",
        value=lambda of: of.nutation_rates[0],
    )
    nutation_rate_lower = _nutation(  # in the third quarter it is the opposite
        *("ϑ' 2nd", "mean rate, quarter before u2", "§5"),
        f"4*(theta_max - acos(U))/T_nutation {_MIDDLE}",
        value=lambda of: of.nutation_rates[1],
    )
    spin_rate_upper = _quarter(
        *("φ' 1st", "mean rate, quarters at u1", "§6"),
        "4*integral(phidot, t1, t1 + T_nutation/4)/T_nutation",
        value=lambda of: of.next_to_u1.phi,
    )
    spin_rate_lower = _quarter(
        *("φ' 2nd", "mean rate, quarters at u2", "§6", "2*mean_spin_rate - spin_rate_upper"),
        value=lambda of: 2 * of.kind.mean_spin_rate - of.next_to_u1.phi,
    )
    precession_rate_upper = _quarter(
        *("ψ' 1st", "mean rate, quarters at u1", "§7"),
        "4*integral(psidot, t1, t1 + T_nutation/4)/T_nutation",
        value=lambda of: of.next_to_u1.psi,
    )
    precession_rate_lower = _quarter(
        *("ψ' 2nd", "mean rate, quarters at u2", "§7"),
        "2*mean_precession_rate - precession_rate_upper",
        value=lambda of: 2 * of.kind.mean_precession_rate - of.next_to_u1.psi,
    )

    spin_share = _constant(
        *("1 - C/2A", "share of steady spin", "(6,1)", "1 - C/(2*A)"),
        value=lambda of: of.ar.convert(1 - Fraction(of.top.C) / (2 * Fraction(of.top.A))),
    )
    roots_sum = _step(
        *("u3 + u2", "b²/a", "(4,11)", "b**2/a"),
        value=lambda of: of.state.b * of.state.b / of.state.a,
    )
    roots_product = _step(
        *("u3 u2", "b² u1/a - 1", "(4,12)", "b**2*u1/a - 1"),
        value=lambda of: of.roots_sum * of.state.cos - 1,
    )
    roots_sum_squared = _step(
        *("(u3 + u2)²", "square of the roots' sum", "§8", "roots_sum**2"),
        value=lambda of: of.roots_sum * of.roots_sum,
    )
    roots_product_fourfold = _step(
        *("-4 u3 u2", "-4 times the product", "§8", "-4*roots_product"),
        value=lambda of: -4 * of.roots_product,
    )
    roots_gap_squared = _step(
        *("(u3 - u2)²", "square of the distance", "§8"),
        "roots_sum_squared + roots_product_fourfold",
        value=lambda of: of.roots_gap * of.roots_gap,
    )
    roots_gap = _step(
        *("u3 - u2", "distance of the roots", "§8", "sqrt(roots_gap_squared)"),
        value=lambda of: of.gaps.a_u3_u2 / of.state.a,
    )
    u3_twice = _step(
        *("2 u3", "roots' sum + distance", "§8", "roots_sum + roots_gap"),
        value=lambda of: 2 * of.kind.u3,
    )
    u2_twice = _step(
        *("2 u2", "roots' sum - distance", "§8", "roots_sum - roots_gap"),
        value=lambda of: 2 * of.kind.u2,
    )
    k_squared = _step(
        *("k²", "(u1 - u2)/(u3 - u2)", "(4,19)", "(u1 - u2)/(u3 - u2)"), value=lambda of: of.kind.m
    )
    comodular_angle_deg = _step(
        *("arcsin k'", "complementary angle", "(4,21)", "asin(k_prime)"),
        value=lambda of: of.ar.atan2(of.kind.k_prime, of.kind.k) / of.kind.degree,
        unit="angle",
    )
    E_amplitude = _step(
        *("E(am, k')", "integral, second kind", "(7,1)", "ellint_E(amplitude, k_prime)"),
        value=lambda of: of.integral_of_amplitude(),
    )

    @quantity
    def A(self) -> R:
        """The equatorial moment A."""
        return self.ar.convert(Fraction(self.top.A))

    @quantity
    def nutating(self) -> Nutating[R] | None:
        """The motion if it nutates, else None."""
        return self.kind if isinstance(self.kind, Nutating) else None

    @property
    def follows(self) -> bool:
        """Whether the equations of the paper hold: the top nutates after release from rest."""
        return self.nutating is not None and self.facts.at_rest

    @quantity
    def over_half(self) -> Turned[R] | None:
        """The increments in half a period; from a turning point, the mean rates times T/2."""
        kind = self.nutating
        if kind is None or kind.precession_rate_half is None:
            return None
        half, gaps = kind.T_nutation / 2, self.gaps
        turning = not (gaps.u1_u > 0 and gaps.u_u2 > 0)
        if turning and not self.facts.meets_a_pole:
            return Turned(kind.mean_spin_rate * half, kind.mean_precession_rate * half)
        from .series import exact_attitude  # start-up: not for a record

        at = exact_attitude(kind)(half)
        return Turned(at.phi, at.psi)

    @quantity
    def next_to_u1(self) -> Turned[R] | None:
        """The mean rates in the quarter after a passage of u1; None over a pole."""
        kind = self.nutating
        if kind is None or self.facts.meets_a_pole:
            return None
        from . import series  # start-up: not for a record

        attitude, since_top = series.exact_attitude(kind), -series.periods_since_top(kind)
        first, last = (
            attitude(kind.T_nutation * passed) for passed in (since_top, (4 * since_top + 1) / 4)
        )
        increments = last.phi - first.phi, last.psi - first.psi
        return Turned(*(4 * increment / kind.T_nutation for increment in increments))

    @quantity
    def nutation_rates(self) -> tuple[R, R]:
        """The mean nutation rates from u1 to T/4, where u is (5,2), and from T/4 to u2."""
        kind, ar, gaps = self.kind, self.ar, self.gaps
        fall, rise = (gaps.u1_u2 * part / (1 + kind.k_prime) for part in (kind.k_prime, 1))
        places = (
            (gaps.above_u1, gaps.below_u1),
            (gaps.above_u1 + fall, gaps.below_u2 + rise),
            (gaps.above_u2, gaps.below_u2),
        )
        first, middle, last = (2 * ar.atan2(ar.sqrt(x), ar.sqrt(y)) for x, y in places)
        return 4 * (middle - first) / kind.T_nutation, 4 * (last - middle) / kind.T_nutation

    def integral_of_amplitude(self) -> R:
        """Return the integral E(phi, k') of (7,1) by Carlson's R_F and R_D (DLMF 19.25.9)."""
        ar: Any = self.ar
        gaps, whole, mc = self.gaps, self.gaps.a_below_u3, self.kind.k_prime * self.kind.k_prime
        sin2, cos2 = gaps.a_u3_u2 / whole, self.state.a * gaps.below_u2 / whole
        at = cos2, cos2 + self.kind.m * sin2, 0 * cos2 + 1
        integral: R = ar.sqrt(sin2) * (ar.carlson_rf(*at) - mc * sin2 * ar.carlson_rd(*at) / 3)
        return integral
