"""Spans and sample times from which pictures of a motion are drawn; nothing is drawn here."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arithmetic.numbers import Number
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..motion.regime import Regime
from ..motion.solve import Motion

MOST_PERIODS = 1000
"""Most nutation periods in one picture; more would be a blot and not a curve."""
SAMPLES = 200
"""Samples per nutation period."""


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
    """Return the time of one turn of the precession, limited to 3 to 40 nutation periods."""
    nutation, turn = tilt_period(motion), motion.T_precession
    if not nutation or motion.exact.facts.plane:  # in a plane the axis returns along the same arc
        return span(motion, 1)
    return min(max(turn or 0.0, 3 * nutation), 40 * nutation)


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

    The samples are even in the sum of time and length of the curve, each as a share of the whole:
    so they are dense where the curve is steep.
    """
    count = round(SAMPLES * max(t_max / (tilt_period(motion) or t_max), 2.0))
    t = np.linspace(0.0, t_max, count + 1)
    for _ in range(2):
        points = np.stack([*motion.table(t, names).values()])
        extent = np.ptp(points, axis=1, keepdims=True)
        steps = np.diff(points) / np.where(extent > 0, extent, np.inf)
        length = np.append(0.0, np.cumsum(np.hypot.reduce(steps)))
        even = t / t_max + length / (length[-1] or 1.0)
        t = np.interp(np.linspace(0.0, even[-1], count + 1), even, t)
    return motion.table(t, ["t", *names])
