"""Facts of a motion that several pictures need: its period, its phase, its swing, its words.

Only this file asks how a motion is solved.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..motion.over_time.series_constants import periods_since_top, separatrix_constants
from ..motion.regime import Regime
from ..motion.solve import Motion


def axis_at(motion: Motion, t: Array) -> Array:
    """Return the unit vectors of the figure axis in space at the times t, in shape (n, 3)."""
    return np.stack([*motion.table(t, ["axis"]).values()], axis=1)


def tilt_period(motion: Motion) -> float | None:
    """Return the period of the tilt, or None for a tilt that stays or never comes back.

    The record of a steady precession also has a period: that of a small nutation about it.
    """
    same = motion.regime is Regime.TORQUE_FREE and motion.theta_min_deg == motion.theta_max_deg
    return None if same or motion.regime is Regime.STEADY else motion.T_nutation


def periods_since_highest(motion: Motion) -> float:
    """Return the nutation periods from a highest point of the axis to t = 0, in [-1/2, 1/2].

    The sign is that of the tilt rate at the start.  The tilt must have a period.
    """
    kind: Any = motion.middle()
    with kind.ar.working():
        return float(periods_since_top(kind))


class SeparatrixSwing(NamedTuple):
    """The one swing of a top on the separatrix: u = u2 + (1 - u2) tanh^2(speed (t - lowest))."""

    speed: float
    lowest: float
    """Time at which the axis is lowest."""


def separatrix_swing(motion: Motion) -> SeparatrixSwing:
    """Return the swing of a motion whose regime is the separatrix (u1 = u3 = 1)."""
    kind: Any = motion.middle()
    with kind.ar.working():
        speed = kind.argument_rate
        return SeparatrixSwing(float(speed), float(-separatrix_constants(kind).offset / speed))


def swings_in_a_plane(motion: Motion) -> bool:
    """Return whether the top is a plane pendulum, whose axis comes back along the same arc."""
    top = motion.top
    return not top.r0 and (not top.psidot0 or top.inputs()["theta0_deg"] in (0, 180))


def motion_in_words(motion: Motion) -> str:
    """Return how a top moves, in a few words: its path, and its regime where that says more.

    Upright tops and hanging ones are stable or unstable.
    """
    regime, remark = motion.regime, motion.remark or ""
    if regime in (Regime.SLEEPING, Regime.HANGING):
        return f"{regime.value}, {'unstable' if 'unstable' in remark else 'stable'}"
    if regime is Regime.SEPARATRIX:
        return "separatrix, rises to upright for ever"
    if regime is Regime.REGULAR:
        return f"{motion.path} path" if motion.path else regime.value
    return regime.value
