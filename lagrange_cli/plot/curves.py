"""Spans and sample times from which pictures of a motion are drawn; nothing is drawn here."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..arithmetic.numbers import Number
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..motion.regime import Regime
from ..motion.solve import Motion

MOST_PERIODS = 1000
"""Most nutation periods in one picture; more would be a blot and not a curve."""
SAMPLES = 64
"""Samples per nutation period, before `sampled` adds more where a curve is steep."""
LONGEST, STRAIGHT, VISIBLE = 0.02, math.cos(math.radians(10)), 5e-4
"""Limits of a polygon: longest step, sharpest corner, least step that shows (shares of a range)."""


def tilt_period(motion: Motion) -> float | None:
    """Return the period of the tilt, or None for a tilt that is constant or never returns."""
    same = motion.regime is Regime.TORQUE_FREE and motion.theta_min_deg == motion.theta_max_deg
    return None if same or motion.regime is Regime.STEADY else motion.T_nutation


def span(motion: Motion, periods: float) -> float:
    """Return the duration of a number of nutation periods.

    On the separatrix it is the time of the swing.  For a constant tilt it is one turn of the
    precession or of the spin.
    """
    if swing := motion.swing:
        return max(6.0 / swing.rate, 2.0 * swing.lowest)
    if nutation := tilt_period(motion):
        return periods * nutation
    return motion.T_precession or motion.T_spin or 1.0


def turn_span(motion: Motion) -> float:
    """Return the time of one turn of the precession, limited to 1 to 40 nutation periods."""
    nutation, turn = tilt_period(motion), motion.T_precession
    if not nutation:
        return span(motion, 1)
    if motion.exact.facts.plane:
        return nutation  # the axis returns along the same arc
    return min(max(turn / nutation if turn else 3.0, 3.0), 40.0) * nutation


def checked_span(motion: Motion, t_max: Number | None) -> float | None:
    """Return the last time as a double.

    Raises LagtopError unless it is above 0 and the curve up to it is legible.
    """
    if t_max is None:
        return None
    if not t_max > 0:
        raise LagtopError(f"t_max must be > 0, got {float(t_max):g}", "t_max")
    nutation = tilt_period(motion)
    if nutation and t_max > MOST_PERIODS * nutation:
        most = f"{MOST_PERIODS} nutation periods = {MOST_PERIODS * nutation:.6g}"
        raise LagtopError(f"t_max must be at most {most}, got {float(t_max):g}", "t_max")
    return float(t_max)


def sampled(motion: Motion, t_max: float, names: Sequence[str]) -> dict[str, Array]:
    """Return columns of `lagtop table` from 0 to t_max, in radians, and their times under `t`.

    A step is halved if it exceeds 2 % of the range of a column, or turns by more than 10 degrees
    and is visible.  This stops at eight times the samples, because a jump would go on for ever.
    """
    count = round(SAMPLES * t_max / (tilt_period(motion) or t_max / 6)) + 1
    t = np.linspace(0.0, t_max, max(count, 2 * SAMPLES))
    enough = 8 * t.size
    while t.size < enough:
        points = np.stack([*motion.table(t, names).values()], axis=1)
        extent = np.ptp(points, axis=0)
        steps = np.diff(points, axis=0) / np.where(extent > 0.0, extent, np.inf)
        wide = abs(steps).max(axis=1) > LONGEST
        size = np.linalg.norm(steps, axis=1)
        sharp = np.sum(steps[1:] * steps[:-1], axis=1) < STRAIGHT * size[1:] * size[:-1]
        sharp &= np.minimum(size[1:], size[:-1]) > VISIBLE
        wide[1:] |= sharp
        wide[:-1] |= sharp
        middle = (t[1:] + t[:-1]) / 2
        wide &= (middle > t[:-1]) & (middle < t[1:])
        if not wide.any():
            break
        t = np.sort(np.append(t, middle[wide]))
    return motion.table(t, ["t", *names])
