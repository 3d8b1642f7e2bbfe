"""One scene of the battery, checked by enclosures: every error is a proved upper bound.

The enclosures of `solve` and of `table --certify` are balls that contain the exact numbers, angles
and rates.  They include all errors of rounding and truncation.  Each error is bounded from above,
and its unit from below.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from functools import partial

import mpmath

from ..arithmetic.ball import Ball, TooFewDigitsError
from ..arithmetic.balls import balls
from ..arithmetic.rounding import decided
from ..inputs.top import Top
from ..motion.over_time.proved_table import BallSample, ProvedTable
from ..motion.solve import Motion, solve
from .battery import JUDGED_COLUMNS, Case, HardScene, case_of

_NARROW = 2**10
"""Inverse of the radius of a ball, in units, that gives an error to three digits."""
_SHARP = Decimal("1e-12")
"""Radius of the distance of a key, in gaps between doubles; half a gap is the promise."""
_DIGITS = 40
"""Digits of the period, the unit of the times of a scene."""


def prove(scene: HardScene) -> Case:
    """Return proved upper bounds of the errors of a scene."""
    motion = solve(Top(**scene.inputs))
    proofs = ProvedTable(motion, JUDGED_COLUMNS[:4])
    period = motion.number("T_nutation", _DIGITS)
    assert period is not None
    with mpmath.workdps(_DIGITS):
        times = scene.times(mpmath.mpf(period.value))

    def units(t: float, row: Sequence[float]) -> Sequence[float]:
        *angles, w, x, y, z = bounds_at(proofs, t, row[:7])
        return *angles, max(w, x, y, z)

    return case_of(motion, times, units, partial(key_bound, motion))


def key_bound(motion: Motion, key: str, value: float | None) -> float:
    """Return a bound of the error of a key, in gaps between doubles, from fresh enclosures.

    It is infinite if only one of record and motion has the key.
    """

    def bound(digits: int) -> float:
        try:
            exact = motion.enclosure(key, digits)
            if value is None or exact is None:
                return 0.0 if value is None and exact is None else math.inf
            return ulps(value, exact)
        except TooFewDigitsError:
            known = motion.fraction(key)
            if known is None or value is None:
                raise
            return ulps(value, balls(digits).convert(known))

    return decided(key, bound)


def ulps(value: float, exact: Ball) -> float:
    """Return a bound of the distance of a double from all in a ball, in gaps between doubles.

    The gap is the one on the side of the ball.  Raises TooFewDigitsError if the bound is not sharp.
    """
    above, below = (abs(math.nextafter(value, x) - value) for x in (math.inf, -math.inf))
    ar = exact.ar
    away = exact - ar.convert(value)
    gap = above if (away > 0) is True else below if (away < 0) is True else min(above, below)
    ratio = away / ar.convert(gap)
    if not ratio.radius < _SHARP:
        raise TooFewDigitsError
    return math.nextafter(float(abs(ratio.middle) + ratio.radius), math.inf)


def bounds_at(proofs: ProvedTable, t: float, computed: Sequence[float]) -> list[float]:
    """Return upper bounds of the errors of the angles and of the quaternion at a time, in units.

    Raises LagtopError if no precision makes an enclosure small compared with its unit.
    """
    sample = partial(proofs.sample, Fraction(t))
    return decided(f"the error at t = {t}", lambda digits: _bounds(sample(digits), computed))


def _bounds(sample: BallSample, computed: Sequence[float]) -> list[float]:
    if not all(map(math.isfinite, computed)):
        return [math.inf] * len(computed)
    angles = [sample.theta, sample.phi, sample.psi]
    exact = [*angles, *(getattr(sample, f"quaternion_{part}") for part in "wxyz")]
    return [
        _bound(ball - sample.t.ar.convert(value), size / 2**52)
        for ball, value, size in zip(exact, computed, _sizes(sample, angles), strict=True)
    ]


def _sizes(sample: BallSample, angles: Sequence[Ball]) -> list[Ball]:
    """Return lower bounds of the units of the angles and of the quaternion's parts, over 2^-52."""
    ar, period = sample.t.ar, sample.kind.T_nutation
    assert period is not None
    tau = sample.t - period * ar.nint(sample.t / period)
    square, across, r0 = sample.theta_square, sample.across, sample.kind.r0
    theta_rate = ar.sqrt(square) if (square > 0) is True else 0 * square
    turning = ar.sqrt(theta_rate * theta_rate + across * across + r0 * r0) / 2
    rates = theta_rate, sample.phidot, sample.psidot
    sizes = [
        ar.exact(max(angle.least, Decimal(1))) + ar.exact((tau * rate).least)
        for angle, rate in zip(angles, rates, strict=True)
    ]
    return [*sizes, *[1 + ar.exact((tau * turning).least)] * 4]


def _bound(error: Ball, unit: Ball) -> float:
    """Return a bound of an error in units.  Raises TooFewDigitsError if it is not sharp."""
    if not error.radius * _NARROW < unit.least:
        raise TooFewDigitsError
    return float((error / unit).greatest)  # its few digits are printed as they are
