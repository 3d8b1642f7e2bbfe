"""The curves that the pictures of one motion show, as numbers: nothing here draws.

Curves are sampled evenly in the amplitude am(w), w counted from the lowest point, and not in time,
so that cusps and fast passes are smooth; the turning points themselves are among the samples.
Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..arithmetic.generic import Number, many_digits
from ..arithmetic.types import Array
from ..elliptic import carlson_rf, complete_k
from ..errors import LagtopError, NothingToDrawError
from ..motion.columns import Sample, column_constants
from ..motion.general import periods_since_top, separatrix_swing
from ..motion.make_sampler import solution_of
from ..motion.record import Regime
from ..motion.solve import Motion

PHASES = 48
"""Samples per half period, before `refined` adds where a curve is steep."""

_STRAIGHT, _VISIBLE = math.cos(math.radians(10)), 5e-4
"""Where `refined` lets a polygon pass for a curve: its corners, and its steps over the range."""

MOST_PERIODS = 1000
"""More nods are a blot, not a curve."""


def sample(motion: Motion, t: Array) -> Sample:
    """The motion at the times t, with everything a column can be computed from."""
    sampler = motion.sampler()
    sampler.check(t)
    constants = column_constants(motion.top, solution_of(motion.top).start)
    return Sample(t, sampler.attitude(t, True), constants, wrap=False)


def period(motion: Motion) -> float | None:
    """The nutation period of a top that nods."""
    return motion.T_nutation if solution_of(motion.top).nutates else None


def span(motion: Motion, periods: float) -> float:
    """The time of so many nutation periods; without nutation, of the precession or the spin."""
    if motion.regime is Regime.SEPARATRIX:
        return max(6.0 / float(solution_of(motion.top).speed), _time_of_start(motion) * 2.0)
    if nutation := period(motion):
        return periods * nutation
    return motion.T_precession or motion.T_spin or 1.0


def turn_span(motion: Motion) -> float:
    """The time of one turn of the precession, but of 3 nods at least and of 40 at most."""
    nutation, turn = period(motion), motion.T_precession
    if not nutation:
        return span(motion, 1)
    return min(max(turn / nutation if turn else 3.0, 3.0), 40.0) * nutation


def checked_span(motion: Motion, t_max: Number | None) -> float | None:
    """The last time as it was given.  Raises LagtopError where a curve over it would be a blot."""
    if t_max is None:
        return None
    if not t_max > 0:
        raise LagtopError(f"--t-max must be > 0, got {float(t_max):g}")
    nutation = period(motion)
    if nutation and t_max > MOST_PERIODS * nutation:
        most = f"{MOST_PERIODS} nutation periods = {MOST_PERIODS * nutation:.6g}"
        raise LagtopError(f"--t-max must be at most {most}, got {float(t_max):g}")
    return float(t_max)


def _periods_before(motion: Motion) -> float:
    """Nutation periods from the last highest point to t = 0."""
    return float(periods_since_top(many_digits(), solution_of(motion.top)))


def _time_of_start(motion: Motion) -> float:
    """On the separatrix: how long before t = 0, if at all, the axis was lowest."""
    solution = solution_of(motion.top)
    swing = separatrix_swing(many_digits(), solution)
    return -float(swing.offset / solution.speed)


def highest_times(motion: Motion, t_max: float) -> Array:
    """The times in [0, t_max] at which the axis is highest: where the cusps are, if it has any."""
    T = period(motion)
    if not T:
        return np.empty(0)
    before = _periods_before(motion)
    whole = np.arange(math.ceil(before - 1e-9), math.floor(t_max / T + before + 1e-9) + 1)
    times: Array = np.clip((whole - before) * T, 0.0, t_max)
    return times


def phase_times(motion: Motion, t_max: float) -> Array:
    """Times from 0 to t_max, even in am(w) where there is a nutation, turning points included."""
    T = period(motion)
    if motion.regime is Regime.SEPARATRIX:
        return _separatrix_times(motion, t_max)
    if not T:
        return np.linspace(0.0, t_max, 4 * PHASES + 1)
    before = _periods_before(motion)
    half = _half_period(float(solution_of(motion.top).k_prime))
    whole = np.concatenate([half[:-1], 1.0 - half[:0:-1]])
    first, last = math.floor(before), math.ceil(t_max / T + before) + 1
    t = ((np.arange(first, last)[:, None] + whole).ravel() - before) * T
    return _between(t, t_max)


def _half_period(k_prime: float) -> Array:
    """t/T from 0 to 1/2 at even steps of the amplitude: F(am, k)/2K before the lowest point, where
    u - u2 = (u1 - u2) sin^2(am)."""
    amplitude = np.linspace(0.0, math.pi / 2, PHASES + 1)
    sin, cos2 = np.sin(amplitude), np.cos(amplitude) ** 2
    F = sin * carlson_rf(np, cos2, cos2 + (k_prime * sin) ** 2, np.ones_like(sin))
    fraction: Array = F / (2 * complete_k(math, k_prime))
    fraction[-1] = 0.5
    return 0.5 - fraction[::-1]


def _separatrix_times(motion: Motion, t_max: float) -> Array:
    """The amplitude is the Gudermannian here: even steps of gd(w) about the lowest point."""
    amplitude = np.linspace(-1.0, 1.0, 8 * PHASES + 1)[1:-1] * math.pi / 2
    speed = float(solution_of(motion.top).speed)
    return _between(np.arcsinh(np.tan(amplitude)) / speed + _time_of_start(motion), t_max)


def _between(t: Array, t_max: float) -> Array:
    return np.concatenate([[0.0], t[(t > 0.0) & (t < t_max)], [t_max]])


def refined(t: Array, curve: Callable[[Array], Array], most: float = 0.02) -> Array:
    """More times where a curve (a row a time) jumps by more than that part of its range, or turns
    by more than 10 degrees in a step that can be seen.

    No more once they are eight times as many: where an angle leaps, or all is rounding, there is no
    end to it.
    """
    enough = 8 * t.size
    while t.size < enough:
        points = curve(t)
        extent = np.ptp(points, axis=0)
        steps = np.diff(points, axis=0) / np.where(extent > 0.0, extent, np.inf)
        wide = abs(steps).max(axis=1) > most
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


class AxisPath(NamedTuple):
    """The path of the figure axis on the unit sphere."""

    t: Array
    axis: Array
    """Unit vectors, shape (n, 3); z is up."""
    least: float
    """Least and greatest tilt (radians), the two circles that the path touches."""
    greatest: float
    kind: str | None
    """`cusped`, `looping`, `wavy`, or None where the tilt does not swing."""
    tops: Array
    """The axis where it is highest, shape (m, 3): the cusps of a cusped path."""


def axis_path(motion: Motion, t_max: float) -> AxisPath:
    """The path from 0 to t_max."""

    def axis(t: Array) -> Array:
        return np.stack(sample(motion, t).axis(), axis=1)

    t = refined(phase_times(motion, t_max), axis)
    least, greatest = motion.theta_min_deg, motion.theta_max_deg
    assert least is not None
    assert greatest is not None
    tops = axis(highest_times(motion, t_max))
    return AxisPath(t, axis(t), math.radians(least), math.radians(greatest), motion.path, tops)


class AngleCurves(NamedTuple):
    """Tilt, spin and precession over time (radians), and the rates that spin and precession have
    in the mean (None where the precession is not defined or has no mean)."""

    t: Array
    theta: Array
    phi: Array
    psi: Array
    spin_rate: float | None
    precession_rate: float | None

    def remainders(self) -> tuple[Array, Array]:
        """What is left of spin (6,4) and precession (7,4) when the mean rates are taken off."""
        assert self.spin_rate is not None
        assert self.precession_rate is not None
        return self.phi - self.spin_rate * self.t, self.psi - self.precession_rate * self.t


def _angles_at(motion: Motion, t: Array) -> AngleCurves:
    rates = motion.mean_spin_rate, motion.mean_precession_rate
    return AngleCurves(t, *motion.angles(t), *rates)


def angle_curves(motion: Motion, t_max: float) -> AngleCurves:
    """The three angles from 0 to t_max."""

    def angles(t: Array) -> Array:
        return np.stack(motion.angles(t), axis=1)

    return _angles_at(motion, refined(phase_times(motion, t_max), angles))


def remainder_curves(motion: Motion, t_max: float) -> AngleCurves:
    """Return the curves of `remainders`.; NothingToDrawError where both vanish."""
    if not period(motion):
        raise NothingToDrawError(f"no remainders: {motion.regime.value} has no nutation period")

    def remainders(t: Array) -> Array:
        return np.stack(_angles_at(motion, t).remainders(), axis=1)

    return _angles_at(motion, refined(phase_times(motion, t_max), remainders))
