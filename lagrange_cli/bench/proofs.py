"""One scene of the battery, judged by enclosures: every error is an upper bound that is proved.

The enclosures are those of `solve --certify` and `table --certify`: balls that hold the exact
numbers, angles and rates, whatever was rounded or left out on the way.  A unit is bounded from
below, and what it divides from above.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction

import mpmath

from ..arithmetic.balls import Ball
from ..arithmetic.correct_rounding import TooFewDigitsError
from ..arithmetic.points import ListedPoints
from ..arithmetic.proved_rounding import decided, distance
from ..inputs.top import Top
from ..motion.certified import Certified
from ..motion.certified_table import BallSample, CertifiedTable
from ..motion.record import NUMBER_KEYS
from ..motion.solve import Motion, solve
from ..motion.table import rows
from .battery import Case, conserved_changes
from .hard_scenes import HardScene
from .reference import Many

COLUMNS = ("theta", "phi", "psi", "quaternion")
_NARROW = 2**10
"""One over the radius of a ball, in units, that tells an error to three digits."""
_DIGITS = 50
"""Digits of the period that times are counted in."""


def prove(scene: HardScene) -> Case:
    """Return what is proved of a scene: upper bounds of its errors."""
    import numpy as np

    top = Top(**scene.inputs)
    motion = solve(top)
    proofs = Certified(motion.exact)
    with mpmath.workdps(_DIGITS):
        times = scene.times(_period(proofs))
    _, blocks = rows(motion, ListedPoints([Fraction(t) for t in times]), COLUMNS, radians=True)
    table = CertifiedTable(proofs, COLUMNS, radians=True)
    bounds = [
        bounds_at(table, t, values)
        for t, values in zip(times, np.concatenate(list(blocks)).tolist(), strict=True)
    ]
    theta, phi, psi, *parts = (max(errors) for errors in zip(*bounds, strict=True))
    worst = [max(errors[:3]) for errors in bounds], [max(errors[3:]) for errors in bounds]
    ulps, key = worst_key(motion, proofs)
    energy_eps, Lz_eps = conserved_changes(motion, np.array(times))
    return Case(
        theta_units=theta,
        phi_units=phi,
        psi_units=psi,
        quaternion_units=max(parts),
        key_ulps=ulps,
        worst_key=key,
        energy_eps=energy_eps,
        Lz_eps=Lz_eps,
        top=top,
        worst_time=times[int(np.argmax(worst[0]))],
        worst_attitude_time=times[int(np.argmax(worst[1]))],
        scipy=None,
        integrated=None,
        agreement=0.0,
    )


def _period(proofs: Certified) -> Many:
    """Return the nutation period in many digits."""
    found = proofs.with_ends("T_nutation", _DIGITS)
    assert found is not None
    return mpmath.mpf(found[0])


def worst_key(motion: Motion, proofs: Certified) -> tuple[float, str]:
    """Return the worst bound of a key, in gaps between doubles, and the key.

    One where the motion has none, or the other way round, is infinitely wrong.
    """
    bounds = []
    for key in NUMBER_KEYS:
        value, found = getattr(motion, key), proofs.with_ends(key)
        if value is None or found is None:
            bounds.append((0.0 if value is found else math.inf, key))
        else:
            bounds.append((ulps(value, *found[1:]), key))
    return max(bounds)


def ulps(value: float, low: Decimal | Fraction, high: Decimal | Fraction) -> float:
    """Return a bound of the distance of a double from all between two ends, in gaps there.

    The gap is the one on the side of each end.
    """
    bounds = []
    for end in (low, high):
        beyond = math.nextafter(value, math.inf if end > value else -math.inf)
        share = float(distance(end, value)) / abs(beyond - value)
        bounds.append(share * (1 + 2.0**-50))  # two roundings
    return max(bounds)


def bounds_at(table: CertifiedTable, t: float, computed: Sequence[float]) -> list[float]:
    """Return upper bounds of the errors of the angles and of the quaternion at a time, in units.

    Raises LagtopError where no precision makes an enclosure small beside its unit.
    """
    time = Fraction(t)

    def bounds(bits: int) -> list[float]:
        sample = table.sample(time, bits)
        with sample.ar.working():
            return _bounds(sample, computed, sample.ar.convert(time))

    return decided(f"the error at t = {t}", bounds)


def _bounds(sample: BallSample, computed: Sequence[float], time: Ball) -> list[float]:
    if not all(map(math.isfinite, computed)):
        return [math.inf] * len(computed)
    period = sample.kind.T_nutation
    assert period is not None
    tau = time - period * sample.ar.nint(time / period)
    across, r0 = sample.psi_rate() * sample.sine(), sample.kind.r0
    theta_rate = _theta_rate(sample)
    turning = sample.ar.sqrt(theta_rate * theta_rate + across * across + r0 * r0) / 2
    angles = sample.theta(), sample.phi(), sample.psi()
    pairs = [
        (exact, _larger(exact.least_size(), 1) + (tau * rate).least_size())
        for exact, rate in zip(
            angles, (theta_rate, sample.phi_rate(), sample.psi_rate()), strict=True
        )
    ]
    spread = 1 + (tau * turning).least_size()
    pairs += [(getattr(sample, f"quaternion_{part}")(), spread) for part in "wxyz"]
    return [
        _bound(exact - sample.ar.convert(value), size / 2**52)
        for value, (exact, size) in zip(computed, pairs, strict=True)
    ]


def _larger(size: Ball, least: int) -> Ball:
    """Return a size that is known exactly, or one that is larger."""
    return size if size > least else 0 * size + least


def _bound(error: Ball, unit: Ball) -> float:
    """Return a bound of an error in units.  Raises TooFewDigitsError where it is not sharp."""
    if not error.radius() * _NARROW < unit:
        raise TooFewDigitsError
    return (error / unit).greatest_size()


def _theta_rate(sample: BallSample) -> Ball:
    """Return the least size that the rate of the tilt can have, by the energy (4,2)."""
    state, across = sample.kind.state, sample.psi_rate() * sample.sine()
    around = state.psi_rate * state.sin
    energy = state.theta_rate * state.theta_rate + around * around
    square = energy + state.a * (state.cos - sample.cosine()) - across * across
    return sample.ar.sqrt(square).least_size() if (square > 0) is True else 0 * square
