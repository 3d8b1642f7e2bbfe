"""Sections 6 and 7 of the paper: mean rates of spin and precession, rates at 0 and T/2.

Both rates are split into partial fractions at the poles.  By psi' = (beta - b u)/(1 - u^2) (4,7),

    south = (beta - b u)/(2 (1 + u)),   north = (beta - b u)/(2 (1 - u)),
    psi' = south + north,               phi' = r0 + south - north.

Equation numbers in parentheses are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import partial
from typing import Any

from ..arithmetic.ball import TooFewDigitsError
from ..arithmetic.numbers import Arithmetic, R, absolute
from ..elliptic.complete import period_mean
from .nutation import Nutation, period_key
from .quantity import key, quantity
from .regime import Facts

_Known = float | Decimal

mean_rate_key = partial(key, "Mean rates", unit="rad/time")
rate_key = partial(key, "Rates", unit="rad/time")

_UPPER = "(momentum_constant - b)*ellint_Pi((u1 - u2)/(1 - u2), k)/(1 - u2)"
_LOWER = "(momentum_constant + b)*ellint_Pi((u2 - u1)/(1 + u2), k)/(1 + u2)"
_POLES = f"where P = {_UPPER}, Q = {_LOWER}"
"""The means of (beta - b)/(1 - u) and (beta + b)/(1 + u), times K."""
_HALF = "where U = u2 + (u1 - cos(theta0))*(u3 - u2)/(u3 - cos(theta0))"
"""Definition of the cosine of the tilt half a period after the start."""
_NOT_FROM_POLE = "if the axis does not leave the vertical at the start"
HALF_OFF_POLE = "if the axis is not vertical half a period after the start"


def _turn_key(symbol: str, angle: str) -> Callable[..., Any]:
    """Declare the time of one turn at the mean rate of an angle (section 8)."""
    size, only = f"abs(mean_{angle}_rate)", f"if the mean {angle} rate is not 0"
    return period_key(symbol, f"mean {angle} period", "§8", f"2*pi/{size}", only=only)


class SpinPrecession(Nutation[R]):
    """The numbers of sections 6 and 7 by key; None if the motion has no such number."""

    lacks: frozenset[str] = frozenset()
    """The keys that a kind of motion does not have."""

    def remark(self, *, radians: bool = False) -> str | None:
        """Return a line on special properties, with angles in degrees or `radians`, or None."""
        return None

    @quantity
    def half_turn_rate(self) -> R:
        """Half a turn per nutation period."""
        return self.ar.pi / self.T_nutation

    @quantity
    def mean_parts(self) -> tuple[R, R, R]:
        """The constant part of the mean spin rate, and the means of south and north.

        Without torque, and over a pole, b/2 is taken out of south and of north.  Each of them then
        is half a turn per period if the axis passes over its pole.
        """
        facts, gaps = self.facts, self.gaps
        below, above = (gaps.below_u1, gaps.below_u2), (gaps.above_u1, gaps.above_u2)
        momenta = gaps.momentum_u1, gaps.momentum_u2
        if not (facts.free or facts.meets_a_pole):
            return self.r0, self._mean(below, momenta), self._mean(above, momenta)
        south: R = facts.sign_plus * self.half_turn_rate
        north: R = facts.sign_minus * self.half_turn_rate
        if not (facts.free or facts.over_bottom):
            south = self._mean(below, (gaps.beta_plus_b, gaps.beta_plus_b))
        if not (facts.free or facts.upper_root == 1):
            north = self._mean(above, (gaps.beta_minus_b, gaps.beta_minus_b))
        return self.state.pole_drift, south, north

    def _mean(self, distances: Sequence[R], values: Sequence[R]) -> R:
        return mean_over(self.ar, self.k_prime, distances, values)

    @mean_rate_key("φ' mean", "mean spin rate", "(6,3)", f"r0 - b - (P - Q)/(2*K) {_POLES}")
    def mean_spin_rate(self) -> R:
        """The mean spin rate; after release from rest (6,3), a drift plus one turn per nutation.

        If beta = b u3, the integral (6,1) holds with u3 in place of u1, and its arccot returns to
        its initial value.
        """
        if self.facts.at_rest:
            half_turn = self.half_turn_rate
            return self.state.spin_drift + self.ar.where(self.r0 < 0, -half_turn, half_turn)
        if self.facts.drifts:
            return self.state.spin_drift
        constant, south, north = self.mean_parts
        return constant + south - north

    @mean_rate_key("ψ' mean", "mean precession rate", "(7,3)", f"(P + Q)/(2*K) {_POLES}")
    def mean_precession_rate(self) -> R:
        """The mean precession rate (7,3)."""
        _, south, north = self.mean_parts
        return south + north

    @_turn_key("Tφ", "spin")
    def T_spin(self) -> R | None:
        """The time of one turn at the mean spin rate (section 8)."""
        return turn_time(self.ar, self.mean_spin_rate)

    @_turn_key("Tψ", "precession")
    def T_precession(self) -> R | None:
        """The time of one turn at the mean precession rate (section 8)."""
        return turn_time(self.ar, self.mean_precession_rate)

    @rate_key(
        "φ'(0)", "spin rate at start", "(6,2)", "r0 - psidot0*cos(theta0)", only=_NOT_FROM_POLE
    )
    def spin_rate_start(self) -> R | None:
        """The spin rate at the start (4,8); None on the vertical."""
        return None if self.facts.pole else self.r0 - self.state.psi_rate * self.state.cos

    @rate_key(
        "φ'(T/2)",
        "spin rate at T/2",
        "(6,2)",
        f"r0 - U*precession_rate_half {_HALF}",
        only=HALF_OFF_POLE,
    )
    def spin_rate_half(self) -> R | None:
        """The spin rate (4,8) half a period after the start; None on a pole."""
        if self.precession_rate_half is None:
            return None
        below, above = self._half
        return self.r0 - (below - above) / 2 * self.precession_rate_half

    @rate_key("ψ'(0)", "precession rate at start", "(4,7)", "psidot0", only=_NOT_FROM_POLE)
    def precession_rate_start(self) -> R | None:
        """The precession rate at the start, as given; None on the vertical."""
        return None if self.facts.pole else self.state.psi_rate

    @rate_key(
        "ψ'(T/2)",
        "precession rate at T/2",
        "(4,7)",
        f"(momentum_constant - b*U)/(1 - U**2) {_HALF}",
        only=HALF_OFF_POLE,
    )
    def precession_rate_half(self) -> R | None:
        """The precession rate (4,7) half a period after the start; None on a pole."""
        if self._half_over_pole:
            return None
        momentum = self.gaps.momentum_u2 - self.b * self._half_above_u2
        return momentum / self._half[0] / self._half[1]

    @property
    def _half_over_pole(self) -> bool:
        """Whether the axis is on a pole half a period after a start at u1 or u2."""
        below = self.facts.over_bottom and self.ar.everywhere(self.gaps.u1_u <= 0)
        above = self.facts.upper_root == 1 and self.ar.everywhere(self.gaps.u_u2 <= 0)
        return below or above

    @quantity
    def _half_above_u2(self) -> R:
        """The height of the cosine of the tilt above u2 half a period after the start."""
        return self.gaps.u1_u * (self.gaps.a_u3_u2 / self.gaps.a_u3_u)

    @quantity
    def _half(self) -> tuple[R, R]:
        """1 + u and 1 - u half a period after the start."""
        gaps = self.gaps
        below = gaps.below_u2 + self._half_above_u2
        above = gaps.above_u1 + gaps.u_u2 * (gaps.a_u3_u1 / gaps.a_u3_u)
        return below, above

    @quantity
    def path(self) -> str | None:
        """Path of the axis: `cusped` or `looping` if the precession stops up to u1, else `wavy`."""
        facts, gaps = self.facts, self.gaps
        if facts.plane or facts.steady:
            return None
        if facts.cusp:
            return "cusped"
        return "looping" if self.b * gaps.momentum_u1 < 0 < self.b * gaps.momentum_u2 else "wavy"


def with_limits(formula: str, facts: Facts) -> str:
    """Return a formula with the limits of 0/0 or 0 infinity on a pole that the axis passes over.

    It turns by half a turn there, so that the mean over a period is half a turn per period.
    """
    limit = "2*pi*K/T_nutation (limit over the {} pole)"
    if facts.upper_root == 1:
        formula = formula.replace(_UPPER, limit.format("upper"))
    return formula.replace(_LOWER, limit.format("lower")) if facts.over_bottom else formula


class Nutating(SpinPrecession[R]):
    """A top whose tilt oscillates between u1 and u2."""

    def remark(self, *, radians: bool = False) -> str | None:
        """Return a line on a fast top, with its nutation in degrees or `radians`; else None.

        Raises TooFewDigitsError if the ends of an enclosure would be printed differently.
        """
        if not self.facts.fast:
            return None
        nodding: Any = self.nodding if radians else self.nodding / self.degree
        numbers: Any = nodding, self.T_nutation, self.elementary_rate, self.excess
        lines = {
            fast_remark(*ends, radians=radians)
            for ends in zip(*(number.ends() for number in numbers), strict=True)
        }
        if len(lines) > 1:
            raise TooFewDigitsError
        return lines.pop()

    @quantity
    def nodding(self) -> R:
        """The amplitude theta_max - theta_min in radians, computed without a subtraction."""
        ar, gaps = self.ar, self.gaps
        across = ar.sqrt(gaps.above_u2 * gaps.below_u1) + ar.sqrt(gaps.below_u2 * gaps.above_u1)
        along = ar.sqrt(gaps.below_u1 * gaps.below_u2) + ar.sqrt(gaps.above_u1 * gaps.above_u2)
        return 2 * ar.atan2(2 * gaps.u1_u2 / across, along)

    @quantity
    def elementary_rate(self) -> R:
        """The precession rate mgs/(C r0) = a/2b of the elementary theory of fast tops."""
        return self.state.a / (2 * self.state.b)

    @quantity
    def excess(self) -> R:
        """The relative excess of the mean precession rate (7,3) over the elementary rate."""
        return self.mean_precession_rate / self.elementary_rate - 1


def mean_over(ar: Arithmetic[R], k_prime: R, distances: Sequence[R], values: Sequence[R]) -> R:
    """Return half the mean of a quotient of linear functions of u, from their values at u1 and u2.

    `distances` are the values of the denominator, the distance from a pole, and `values` those of
    the numerator.
    """
    mc, from_u1 = k_prime * k_prime, distances[0]
    p = distances[1] * mc / from_u1
    return period_mean(ar, k_prime, p, values[0], values[1] * mc) / from_u1 / 2


def turn_time(ar: Arithmetic[R], rate: R) -> R | None:
    """Return 2 pi over a mean rate; None, or NaN in an array, if the rate is 0."""
    stands = abs(rate) <= 0
    if ar.everywhere(stands):
        return None
    return 2 * ar.pi / ar.where(stands, ar.nan, absolute(rate))


def fast_remark(
    nodding: _Known, period: _Known, elementary: _Known, excess: _Known, *, radians: bool
) -> str:
    """Return the remark on a pseudo-regular precession.

    `nodding` is the amplitude theta_max - theta_min in degrees or radians, `excess` the relative
    excess of the mean precession rate over the elementary rate.
    """
    parts = round(Fraction(excess) * 10**6)
    where = f"{abs(parts)} ppm {'below' if parts < 0 else 'above'}" if parts else "within 1 ppm of"
    angle = "rad" if radians else "deg"
    tilt, time, rate = (f"{float(f'{x:.3g}'):.3g}" for x in (nodding, period, elementary))
    return (
        f"pseudo-regular precession: nutates by {tilt} {angle} in {time} time; "
        f"its mean is {where} mgs/(C r0) = {rate} rad/time"
    )
