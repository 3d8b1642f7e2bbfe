"""The facts and sample times from which pictures of a motion are drawn; nothing is drawn here.

Curves are sampled evenly in the amplitude am(w), with w counted from the lowest point, and not in
time.  Cusps and fast passes are therefore smooth, and the turning points are among the samples.
Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.numbers import DOUBLES, Number
from ..arithmetic.types import Array
from ..elliptic.carlson import carlson_rf
from ..elliptic.complete import complete_k
from ..errors import LagtopError
from ..motion.regime import Regime
from ..motion.solve import Motion
from .kinds import TITLES

PHASES = 48
"""Samples per half period, before `refined` adds more where a curve is steep."""

_LONGEST = 0.02
"""The longest step on a curve, as a share of its range."""
_STRAIGHT, _VISIBLE = math.cos(math.radians(10)), 5e-4
"""Limits within which `refined` accepts a polygon as a curve: corners, and steps over the range."""

MOST_PERIODS = 1000
"""Most nutation periods in one picture; more would be a blot and not a curve."""


def tilt_period(motion: Motion) -> float | None:
    """Return the period of the tilt, or None for a tilt that is constant or never returns.

    A steady precession also has a period in its record: the period of a small nutation about it.
    """
    same = motion.regime is Regime.TORQUE_FREE and motion.theta_min_deg == motion.theta_max_deg
    return None if same or motion.regime is Regime.STEADY else motion.T_nutation


def motion_in_words(motion: Motion) -> str:
    """Return a few words on a motion, from `TITLES`."""
    regime, stable = motion.regime.value, bool(motion.exact.facts.stable)
    true = {"regime": regime, "stable": stable, "path": motion.path}.items()
    return next(text for when, text in TITLES if when.items() <= true)


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
    if not nutation:
        return span(motion, 1)
    return min(max(turn / nutation if turn else 3.0, 3.0), 40.0) * nutation


def sphere_span(motion: Motion) -> float:
    """Return the time of a path on the globe, about one turn of the precession.

    A top that swings in a plane returns along the same arc, so it is shown for one nutation period.
    A fast top hardly precesses during a nutation, so it is shown for three.
    """
    nutation, turn = tilt_period(motion), turn_span(motion)
    if nutation and motion.exact.facts.plane:
        return nutation
    if nutation and abs(motion.mean_precession_rate or 1.0) * turn < math.radians(20):
        return 3 * nutation
    return turn


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


def sampled_columns(motion: Motion, t_max: float, names: Sequence[str]) -> dict[str, Array]:
    """Return columns of `lagtop table` from 0 to t_max, in radians, by their headings.

    The times, under `t`, are chosen so that the columns make a smooth curve.
    """

    def curve(t: Array) -> Array:
        return np.stack([*motion.table(t, names).values()], axis=1)

    return motion.table(refined(phase_times(motion, t_max), curve), ["t", *names])


def phase_times(motion: Motion, t_max: float) -> Array:
    """Return times from 0 to t_max, including the turning points.

    They are even in am(w) if the tilt swings, and even in time if it is constant.
    """
    if motion.swing:
        return _separatrix_times(*motion.swing, t_max)
    T, before = tilt_period(motion), motion.phase
    if not T or before is None:
        return np.linspace(0.0, t_max, 4 * PHASES + 1)
    half = _half_period(1.0 if motion.k_prime is None else float(motion.k_prime))
    whole = np.concatenate([half[:-1], 1.0 - half[:0:-1]])
    first, last = math.floor(before), math.ceil(t_max / T + before) + 1
    t = ((np.arange(first, last)[:, None] + whole).ravel() - before) * T
    return _between(t, t_max)


def _half_period(k_prime: float) -> Array:
    """Return t/T from 0 to 1/2 at even steps of the amplitude.

    The time before the lowest point is F(am, k)/2K, where u - u2 = (u1 - u2) sin^2(am).
    """
    amplitude = np.linspace(0.0, math.pi / 2, PHASES + 1)
    sin, cos2 = np.sin(amplitude), np.cos(amplitude) ** 2
    F = sin * carlson_rf(ARRAYS, cos2, cos2 + (k_prime * sin) ** 2, np.ones_like(sin))
    fraction: Array = F / (2 * complete_k(DOUBLES, k_prime))
    fraction[-1] = 0.5
    return 0.5 - fraction[::-1]


def _separatrix_times(rate: float, lowest: float, t_max: float) -> Array:
    """Return times that are even in the amplitude, the Gudermannian of w on the separatrix."""
    amplitude = np.linspace(-1.0, 1.0, 8 * PHASES + 1)[1:-1] * math.pi / 2
    return _between(np.arcsinh(np.tan(amplitude)) / rate + lowest, t_max)


def _between(t: Array, t_max: float) -> Array:
    """Return 0, the times strictly between 0 and t_max, and t_max."""
    return np.concatenate([[0.0], t[(t > 0.0) & (t < t_max)], [t_max]])


def refined(t: Array, curve: Callable[[Array], Array]) -> Array:
    """Return the times, with more of them where a curve is steep or sharp.

    `curve` gives one row of coordinates per time.  A step is halved if it exceeds 2 % of the
    curve's range, or turns by more than 10 degrees and is visible.  Refinement stops at eight times
    the points, because a jump or rounding noise would refine for ever.
    """
    enough = 8 * t.size
    while t.size < enough:
        points = curve(t)
        extent = np.ptp(points, axis=0)
        steps = np.diff(points, axis=0) / np.where(extent > 0.0, extent, np.inf)
        wide = abs(steps).max(axis=1) > _LONGEST
        size = np.linalg.norm(steps, axis=1)
        along = np.sum(steps[1:] * steps[:-1], axis=1)
        sharp = along < _STRAIGHT * size[1:] * size[:-1]
        sharp &= np.minimum(size[1:], size[:-1]) > _VISIBLE
        wide[1:] |= sharp
        wide[:-1] |= sharp
        left = np.flatnonzero(wide)
        middle = t[left] + (t[left + 1] - t[left]) / 2
        new = (middle > t[left]) & (middle < t[left + 1])
        if not new.any():
            break
        t = np.insert(t, left[new] + 1, middle[new])
    return t
