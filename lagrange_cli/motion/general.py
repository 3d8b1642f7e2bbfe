"""Any start: tilt, spin and both rates given; the paper's case included.

The roots come from the cubic (4,9) in enough digits to take the gaps between them as differences;
everything later needs the gaps only, in any arithmetic.  Equation numbers in parentheses are
Chrapan's; what is without number continues him to starts that are not at rest.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import NamedTuple

from ..arithmetic.generic import Arithmetic, Number, Real, everywhere, many_digits, where
from ..elliptic import carlson_rf, complete_k, period_mean
from ..errors import LagtopError
from ..inputs.top import Top
from .cubic import Place, Start, roots_from_start, start
from .record import Regime
from .released import complement, modulus, phase_rate
from .roots import Roots
from .theta_series import Swing, ThetaConstants


class Solution(NamedTuple):
    """Regime, start and roots, and what follows from the roots alone."""

    regime: Regime
    start: Start
    roots: Roots
    place: Place
    k: Real
    k_prime: Real
    speed: Real
    """dw/dt of (4,30)."""
    period: Real | None
    """Of the nutation, or of a small one about a steady precession; None on the separatrix."""

    @property
    def nutates(self) -> bool:
        """Whether the tilt changes, periodically."""
        return self.period is not None and self.roots.u1_u2 > 0


def analyse(ar: Arithmetic, top: Top) -> Solution:
    """Roots, regime and moduli.  Raises LagtopError for a start that describes no motion."""
    if top.pole and top.psidot0 != 0:
        raise LagtopError(
            f"psidot0 must be 0 where the axis is vertical, got {float(top.psidot0)} "
            "(nothing precesses there; count it as spin)",
            "psidot0",
        )
    high = many_digits(_digits_for_roots(top, ar.dps))
    precise = start(high, top)
    roots, place = roots_from_start(high, precise)
    roots, place = Roots(*_converted(ar, roots)), Place(*_converted(ar, place))
    begin = Start(*_converted(ar, precise))
    regime, free = _classify(top, roots), roots.u3 is None
    still = free or not roots.u3_u2  # without torque; upright at the sleeping threshold
    k = ar.mpf(0) if still else modulus(ar, roots)
    k_prime = ar.mpf(1) if still else complement(ar, roots)
    speed = ar.sqrt(begin.alpha + begin.b**2) / 2 if free else phase_rate(ar, begin.a, roots)
    period = 2 * complete_k(ar, k_prime) / speed if speed and k_prime else None
    return Solution(regime, begin, roots, place, k, k_prime, speed, period)


def _digits_for_roots(top: Top, digits: int) -> int:
    """Three times the digits wanted, and more for what may lie next to a boundary."""
    longest = max(len(str(Fraction(size))) for size in _sizes(top))
    return 3 * digits + 60 + 6 * _spread(top) + 4 * longest


def digits_for_record(top: Top) -> int:
    """Digits that leave a double right, however its scene cancels."""
    return 40 + 2 * _spread(top)


def _spread(top: Top) -> int:
    """Powers of ten in the numbers of the scene."""
    sizes = (*_sizes(top), *top.tilt(math))
    return int(sum(abs(math.log10(abs(x))) for x in map(float, sizes) if x))


def _sizes(top: Top) -> tuple[Number, ...]:
    return (top.r0, top.thetadot0, top.psidot0, top.m, top.A, top.C, top.s, top.g)


def _converted(ar: Arithmetic, values: tuple[Real | None, ...]) -> list[Real | None]:
    return [None if value is None else +ar.convert(value) for value in values]


def _classify(top: Top, roots: Roots) -> Regime:
    if top.pole and top.thetadot0 == 0:
        return Regime.SLEEPING if top.pole > 0 else Regime.HANGING
    if roots.u3 is None:
        return Regime.TORQUE_FREE
    if not roots.u3_u1:
        return Regime.SEPARATRIX
    if not roots.u1_u2:
        return Regime.STEADY
    return Regime.NO_SPIN if top.r0 == 0 else Regime.REGULAR


def eta_plus(ar: Arithmetic, roots: Roots) -> Real:
    """F of sn^2 = (1 + u2)/(1 + u1), modulus k': the distance of X from its zero at the bottom."""
    middle = roots.u1_u2 * (roots.below_u3 / roots.u3_u2)
    return ar.sqrt(roots.below_u2) * carlson_rf(ar, roots.u1_u2, middle, roots.below_u1)


def eta_minus(ar: Arithmetic, roots: Roots) -> Real:
    """The distance of Y from its zero at the top; alpha (1,6) where the top starts at rest."""
    size = ar.sqrt(roots.above_u1 * roots.u3_u2)
    return size * carlson_rf(
        ar, roots.u3_above * roots.u1_u2, roots.u1_u2 * roots.u3_u1, roots.u3_u1 * roots.above_u2
    )


def advances(
    ar: Arithmetic, begin: Start, roots: Roots, k_prime: Real, T: Real
) -> tuple[Real, Real]:
    """Growth of spin and precession over a period: a drift, and what the two poles add."""

    def pole(momentum: Real, from_u1: Real, from_u2: Real) -> Real:
        """T/2 times the mean of (beta +- b)/(1 +- u).

        Half a turn where the axis meets the pole, and where there is no torque (k = 0).
        """
        if roots.u3 is None or not everywhere((from_u1 > 0) & (from_u2 > 0)):
            return sign_of(momentum) * ar.pi
        mc = k_prime * k_prime
        mean = period_mean(ar, k_prime, mc * from_u2 / from_u1, 1, mc) / from_u1
        return momentum * mean * T / 2

    south = pole(begin.beta_plus_b, roots.below_u1, roots.below_u2)
    north = pole(begin.beta_minus_b, roots.above_u1, roots.above_u2)
    return begin.drift * T + south - north, south + north


def sign_of(value: Real) -> Real:
    """The sign, and 1 for 0 (the limit is the same from both sides)."""
    return where(value < 0, -1, 1)


def periods_since_top(ar: Arithmetic, solution: Solution) -> Real:
    """w/2K for the argument w of (4,22)-(4,24) at t = 0; its sign is that of the nutation rate."""
    begin, roots, place = solution.start, solution.roots, solution.place
    if not (place.u1_u and place.u_u2):  # on a turning point, exactly
        return ar.mpf(0) if _starts_at_u1(solution) else ar.mpf(1) / 2
    sn2 = place.u1_u * roots.u3_u2 / (place.u3_u * roots.u1_u2)
    cn2 = roots.u3_u1 * place.u_u2 / (place.u3_u * roots.u1_u2)
    w = ar.sqrt(sn2) * carlson_rf(ar, cn2, roots.u3_u1 / place.u3_u, ar.mpf(1))
    return sign_of(begin.theta_rate) * w / (2 * complete_k(ar, solution.k_prime))


def _starts_at_u1(solution: Solution) -> bool:
    return bool(solution.place.u1_u < solution.place.u_u2)


def steady_rates(begin: Start) -> tuple[Real, Real]:
    """Rates of spin and precession as they are given; on the vertical, all counts as spin."""
    return begin.r0 - begin.psi_rate * begin.u, begin.psi_rate


def separatrix_swing(ar: Arithmetic, solution: Solution) -> Swing:
    """Its constants, with u1 = u3 = 1."""
    begin, roots = solution.start, solution.roots
    falls, sign = sign_of(begin.theta_rate), sign_of(begin.b)
    offset = -falls * ar.asinh(ar.sqrt(solution.place.u_u2 / solution.place.u1_u))
    x, y = ar.sqrt(roots.below_u2 / 2), ar.sqrt(roots.above_u2 / 2)
    side = ar.tanh(offset) if offset or x else -falls  # on the lower pole: see `evaluate`
    return Swing(offset, x, y, sign, start=ar.atan2(sign * y * side, x))


def theta_constants(ar: Arithmetic, solution: Solution) -> ThetaConstants:
    """What the theta series need."""
    begin, roots, T = solution.start, solution.roots, solution.period
    K = complete_k(ar, solution.k_prime)
    spin, precession = advances(ar, begin, roots, solution.k_prime, T)
    return ThetaConstants(
        period=T,
        quarter=K,
        quarter_prime=complete_k(ar, solution.k) if solution.k else None,
        eta_plus=eta_plus(ar, roots),
        eta_minus=eta_minus(ar, roots),
        x_size=ar.sqrt(roots.below_u1 / 2),
        y_size=ar.sqrt(solution.k_prime * roots.above_u2 / 2),
        spin=spin,
        precession=precession,
        sign_plus=sign_of(begin.beta_plus_b),
        sign_minus=sign_of(begin.beta_minus_b),
        offset=periods_since_top(ar, solution),
        rises=sign_of(begin.theta_rate),
        nutation=8 * K**2 * roots.u1_u2 * solution.k_prime**2 / (ar.pi * T),
    )
