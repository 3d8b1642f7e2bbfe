"""One scene of the battery, judged by enclosures: every error is an upper bound that is proved.

The enclosures are those of `solve --certify` and `table --certify`: balls that hold the exact
numbers, angles and rates, whatever was rounded or left out on the way.  A unit is bounded from
below, and what it divides from above.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import mpmath

from ..arithmetic.balls import Ball, Balls
from ..arithmetic.correct_rounding import TooFewDigitsError
from ..arithmetic.proved_rounding import decided
from ..inputs.top import Top
from ..motion.certified import Certified
from ..motion.certified_sample import BallSample, sample_at
from ..motion.record import NUMBER_KEYS
from ..motion.solve import Motion, solve
from .battery import CONSERVED, Case, case_of, conserved_changes, tabulated
from .hard_scenes import HardScene
from .reference import Many

COLUMNS = ("theta", "phi", "psi", "quaternion")
_NARROW = 2**10
"""One over the radius of a ball, in units, that tells an error to three digits."""
_DIGITS = 40
"""Digits of the period that times are counted in."""


def prove(scene: HardScene) -> Case:
    """Return what is proved of a scene: upper bounds of its errors."""
    top = Top(**scene.inputs)
    motion = solve(top)
    proofs = Certified(motion.exact)
    with mpmath.workdps(_DIGITS):
        times = scene.times(_period(proofs))
    values = tabulated(motion, times, (*COLUMNS, *CONSERVED))
    units = []
    for t, row in zip(times, values[1:].tolist(), strict=True):
        *angles, w, x, y, z = bounds_at(proofs, t, row[:7])
        units.append((*angles, max(w, x, y, z)))
    changes = conserved_changes(top, values[:, -2:])
    return case_of(top, times, units, worst_key(motion, proofs), changes)


def _period(proofs: Certified) -> Many:
    """Return the nutation period in many digits."""
    found = proofs.number("T_nutation", _DIGITS)
    assert found is not None
    return mpmath.mpf(found.value)


def worst_key(motion: Motion, proofs: Certified) -> tuple[float, str]:
    """Return the worst bound of a key, in gaps between doubles, and the key.

    One where the motion has none, or the other way round, is infinitely wrong.
    """
    return max((_key_bound(proofs, key, getattr(motion, key)), key) for key in NUMBER_KEYS)


def _key_bound(proofs: Certified, key: str, value: float | None) -> float:
    def bound(exact: Ball | None) -> float:
        if value is None or exact is None:
            return 0.0 if value is None and exact is None else math.inf
        return ulps(value, exact)

    return proofs.judged(key, bound)


def ulps(value: float, exact: Ball) -> float:
    """Return a bound of the distance of a double from all in a ball, in gaps between doubles.

    The gap is the one on the side of the ball.  Raises TooFewDigitsError where that is not sharp.
    """
    above, below = (abs(math.nextafter(value, x) - value) for x in (math.inf, -math.inf))
    away = exact - Balls.convert(value)
    gap = above if (away > 0) is True else below if (away < 0) is True else min(above, below)
    return _bound(away, Balls.convert(gap))


def bounds_at(proofs: Certified, t: float, computed: Sequence[float]) -> list[float]:
    """Return upper bounds of the errors of the angles and of the quaternion at a time, in units.

    Raises LagtopError where no precision makes an enclosure small beside its unit.
    """
    time = Fraction(t)

    def bounds(bits: int) -> list[float]:
        sample = sample_at(proofs, time, bits)
        with sample.ar.working():
            return _bounds(sample, computed)

    return decided(f"the error at t = {t}", bounds)


def _bounds(sample: BallSample, computed: Sequence[float]) -> list[float]:
    if not all(map(math.isfinite, computed)):
        return [math.inf] * len(computed)
    angles = [sample.theta(), sample.phi(), sample.psi()]
    exact = [*angles, *(getattr(sample, f"quaternion_{part}")() for part in "wxyz")]
    return [
        _bound(ball - Balls.convert(value), size / 2**52)
        for ball, value, size in zip(exact, computed, _sizes(sample, angles), strict=True)
    ]


def _sizes(sample: BallSample, angles: Sequence[Ball]) -> list[Ball]:
    """Return lower bounds of the units of the angles and of the quaternion's parts, over 2^-52."""
    period = sample.kind.T_nutation
    assert period is not None
    tau = sample.t - period * sample.ar.nint(sample.t / period)
    square, across, r0 = sample.nutation_square, sample.across, sample.kind.r0
    theta_rate = sample.ar.sqrt(square) if (square > 0) is True else 0 * square
    turning = sample.ar.sqrt(theta_rate * theta_rate + across * across + r0 * r0) / 2
    rates = theta_rate, sample.phi_rate(), sample.psi_rate()
    sizes = [
        _larger(angle.least_size(), 1) + (tau * rate).least_size()
        for angle, rate in zip(angles, rates, strict=True)
    ]
    return [*sizes, *[1 + (tau * turning).least_size()] * 4]


def _larger(size: Ball, least: int) -> Ball:
    """Return a size that is known exactly, or one that is larger."""
    return size if size > least else 0 * size + least


def _bound(error: Ball, unit: Ball) -> float:
    """Return a bound of an error in units.  Raises TooFewDigitsError where it is not sharp."""
    if not error.radius() * _NARROW < unit:
        raise TooFewDigitsError
    return (error / unit).greatest_size()
