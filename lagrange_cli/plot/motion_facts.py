"""Questions that pictures ask about a motion, answered from what every user of a motion can see.

Nothing here reaches behind the record of the motion and the columns of `lagtop table`.
Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..motion.regime import Regime
from ..motion.solve import Motion

_CELLS = 64
"""Cells into which one round of `_time_of_highest` divides the interval that is left."""
_ROUNDS = 9
"""Rounds after which the interval is as narrow as a double can tell: 64^9 = 2^54."""


def columns_at(motion: Motion, t: Array, names: Sequence[str]) -> list[Array]:
    """Return columns of `lagtop table` at the times t, in radians, in the order of their headings.

    Raises LagtopError for a time out of reach.
    """
    return list(motion.table(t, names).values())


def axis_at(motion: Motion, t: Array) -> Array:
    """Return the unit vectors of the figure axis in space at the times t, in shape (n, 3)."""
    return np.stack(columns_at(motion, t, ["axis"]), axis=1)


class Start(NamedTuple):
    """Numbers of the start of a motion, as doubles."""

    u: float
    a: float
    """Twice the torque over A (4,4)."""
    b: float
    """C r0/A (4,5)."""
    alpha: float
    """Energy constant of (4,9)."""


def start_of(motion: Motion) -> Start:
    """Return the numbers of the start from the inputs of the top."""
    top, theta = motion.top, float(motion.top.inputs(radians=True)["theta0_rad"])
    a, u = float(motion.a), math.cos(theta)
    across = float(top.psidot0) * math.sin(theta)
    alpha = float(top.thetadot0) ** 2 + across**2 + a * u
    return Start(u, a, float(motion.b), alpha)


def nutation_period(motion: Motion) -> float | None:
    """Return the period of the tilt, or None for a tilt that stays or never comes back.

    The record of a steady precession also has a period: that of a small nutation about it.
    """
    same = motion.regime is Regime.TORQUE_FREE and motion.theta_min_deg == motion.theta_max_deg
    return None if same or motion.regime is Regime.STEADY else motion.T_nutation


def periods_since_highest(motion: Motion) -> float:
    """Return the nutation periods from a highest point of the axis to t = 0, in [-1/2, 1/2].

    The sign is that of the tilt rate at the start.  Raises ValueError where the tilt has no period.
    """
    T = nutation_period(motion)
    if T is None:
        raise ValueError("a tilt without a period has no phase")
    rate = float(motion.top.thetadot0)
    if rate == 0:
        (falling,) = columns_at(motion, np.array([T / 4]), ["thetadot"])
        return 0.0 if falling[0] > 0 else 0.5
    return -_time_of_highest(motion, T, falls=rate > 0) / T


def _time_of_highest(motion: Motion, T: float, *, falls: bool) -> float:
    """Return the time within half a period of 0 at which the tilt rate turns positive.

    A top that falls at the start was highest before; one that rises will be highest after.  The
    interval is narrowed from the side of the start, since at its other end the rate may be noise.
    """
    first, last = (-T / 2, 0.0) if falls else (0.0, T / 2)
    for _ in range(_ROUNDS):
        t = np.linspace(first, last, _CELLS + 1)
        (rate,) = columns_at(motion, t, ["thetadot"])
        rising, falling = np.flatnonzero(rate < 0), np.flatnonzero(rate >= 0)
        if falls:
            i = int(rising[-1]) if rising.size else 0
        else:
            i = int(falling[0]) - 1 if falling.size else _CELLS - 1
        i = min(max(i, 0), _CELLS - 1)
        first, last = float(t[i]), float(t[i + 1])
    return last


def swings_in_a_plane(motion: Motion) -> bool:
    """Return whether the top is a plane pendulum, whose axis comes back along the same arc."""
    top = motion.top
    return not top.r0 and not (top.psidot0 and start_of(motion).u ** 2 < 1)


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


class SeparatrixSwing(NamedTuple):
    """The one swing of a top on the separatrix: u = u2 + (1 - u2) tanh^2(speed (t - lowest))."""

    speed: float
    lowest: float
    """Time at which the axis is lowest."""


def separatrix_swing(motion: Motion) -> SeparatrixSwing:
    """Return the swing of a motion whose regime is the separatrix (u1 = u3 = 1)."""
    assert motion.u2 is not None
    band = 1.0 - float(motion.u2)
    speed = math.sqrt(float(motion.a) * band) / 2
    part = min(max(start_of(motion).u - float(motion.u2), 0.0) / band, 1.0)
    to_lowest = math.atanh(math.sqrt(part)) / speed
    return SeparatrixSwing(speed, math.copysign(to_lowest, float(motion.top.thetadot0)))
