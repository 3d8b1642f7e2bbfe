"""Tilt, spin and precession at arrays of times: about one ulp at any time.

The attitude is a pair of complex numbers, the Cayley-Klein parameters.  Each is a theta function
times a uniform rotation, and the Pi functions of Chrapan's sections 3 and 4 are their logarithms:

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

One arctangent each gives the tilt, and the half sum and half difference of the other two angles.
All constants are computed in many digits and rounded once.  `theta_sampler` computes the angles of
a nutating top.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arithmetic.arrays import ARRAYS, BLOCK, blocks, doubles_of, workspace
from ...arithmetic.ball import Ball
from ...arithmetic.points import MAX_PERIODS, MAX_TIME
from ...arithmetic.types import Array
from ...errors import LagtopError
from ..kinds import Constant, Separatrix
from .attitude import Attitude, Growths, Times, growths
from .columns import TILT, TURN, Needs
from .series_constants import SeparatrixConstants, separatrix_constants


class Angles(NamedTuple):
    """Euler angles in radians, each a float64 array in the shape of the times."""

    theta: Array
    """Tilt of the figure axis (nutation), 0 to pi."""
    phi: Array
    """Spin."""
    psi: Array
    """Precession."""


@dataclass(frozen=True)
class Sampler:
    """The angles of one motion as functions of time, with precomputed constants."""

    tilt: float
    """The tilt at t = 0."""
    growths: Growths
    max_time: float

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Return tilt, spin and precession at the times t; see `Motion.angles`."""
        times = doubles_of("t", t)
        flat = np.ascontiguousarray(times).reshape(-1)
        angles = Angles(*np.empty((3, flat.size)))
        with ARRAYS.working(), workspace(min(flat.size, BLOCK)) as space:
            for part in blocks(flat.size):
                at = self.attitude(flat[part], TILT | TURN, self.check(flat[part]), space)
                angles.theta[part] = at.theta()
                at.phi(wrap=wrap, out=angles.phi[part])
                at.psi(wrap=wrap, out=angles.psi[part])
        at_start = flat == 0.0
        for angle, value in zip(angles, (self.tilt, 0.0, 0.0), strict=True):
            angle[at_start] = value
        return Angles(*(angle.reshape(times.shape) for angle in angles))

    def attitude(self, t: Array, needs: Needs, farthest: float, space: Array) -> Attitude:
        """Return the needed parts of the attitude at a block of times, none beyond `farthest`.

        The result may share memory with `space`.
        """
        raise NotImplementedError

    def check(self, t: ArrayLike, name: str = "t") -> float:
        """Return the greatest |t|.

        Raises LagtopError, with the `name` of the argument, if a time is not finite or too large.
        """
        return check_times(doubles_of("t", t), self.max_time, name)


@dataclass(frozen=True)
class ConstantSampler(Sampler):
    """A constant tilt and constant rates of spin and precession."""

    x: float
    y: float

    def attitude(self, t: Array, needs: Needs, farthest: float, space: Array) -> Attitude:
        """Return the attitude at a block of times; there is no phase."""
        tilt, x2, y2 = (np.full_like(t, x) for x in (self.tilt, self.x**2, self.y**2))
        zero = np.zeros_like(t)
        times = Times(t, farthest, space[12:, : t.size])
        return Attitude(self.growths, times, tilt, x2, y2, zero, zero, zero)


@dataclass(frozen=True)
class SeparatrixSampler(Sampler):
    """The single swing from the upright position down and up again: k = 1, T infinite."""

    speed: float
    swing: SeparatrixConstants[float]

    def attitude(self, t: Array, needs: Needs, farthest: float, space: Array) -> Attitude:
        """Return the attitude: 1 - u = (1 - u2)/cosh^2 h, with h = 0 at the lowest point."""
        swing, h = self.swing, t * self.speed + self.swing.offset
        shrink = np.exp(-np.abs(h))
        sech, tanh = 2.0 * shrink / (1.0 + shrink * shrink), np.tanh(h)
        real, imag = np.full_like(h, swing.x), swing.y * swing.sign * tanh
        x2, y = real * real + imag * imag, swing.y * sech
        arg_x, zero = np.arctan2(imag, real), np.zeros_like(h)
        falling = -4.0 * self.speed * y * y * tanh
        times, y2 = Times(t, farthest, space[12:, : t.size]), y * y
        return Attitude(self.growths, times, tilt_of(x2, y2), x2, y2, arg_x, zero, falling)


def check_times(times: Array, most: float, name: str = "t") -> float:
    """Return the greatest |t|.

    Raises LagtopError, with the `name` of the argument, if a time is not finite, or so large that
    its phase is lost.
    """
    if not times.size:
        return 0.0
    limit, low, high = min(most, MAX_TIME), float(times.min()), float(times.max())
    if low >= -limit and high <= limit:
        return max(-low, high)
    bad = times[~(abs(times) <= limit)]
    raise LagtopError(
        f"{name} must be finite and within 2^50 periods = {limit:.3g}, got {bad.flat[0]}", name
    )


def constant_sampler(motion: Constant[Ball]) -> ConstantSampler:
    """Return the sampler of a constant tilt and constant rates."""
    ar: Any = motion.ar
    with ar.working():
        rates = motion.mean_spin_rate, motion.state.psi_rate
        return ConstantSampler(
            tilt=start_tilt(motion),
            x=near(motion.state.cos_half),
            y=near(motion.state.sin_half),
            growths=growths(ar, rates),
            max_time=_reach(rates),
        )


def separatrix_sampler(motion: Separatrix[Ball]) -> SeparatrixSampler:
    """Return the sampler of the separatrix."""
    ar: Any = motion.ar
    with ar.working():
        swing, speed = separatrix_constants(motion), motion.argument_rate
        rates = motion.r0 - motion.b / 2, motion.b / 2
        return SeparatrixSampler(
            tilt=start_tilt(motion),
            speed=near(speed),
            swing=SeparatrixConstants(*(near(x) if isinstance(x, Ball) else x for x in swing)),
            growths=growths(ar, rates, (swing.start, 0 * swing.start)),
            max_time=_reach((*rates, speed)),
        )


def start_tilt(motion: Any) -> float:
    """Return the tilt at the start."""
    state = motion.state
    return near(2 * motion.ar.atan2(state.sin_half, state.cos_half))


def near(x: Ball) -> float:
    """Return the double nearest to the midpoint of a ball of many digits."""
    return float(x.middle)


def _reach(rates: Sequence[Ball]) -> float:
    rate = max(abs(near(rate)) for rate in rates)
    return int(MAX_PERIODS) / rate if rate else float("inf")


def tilt_of(x2: Array, y2: Array, out: Array | None = None) -> Array:
    """Return 2 arctan(|Y|/|X|)."""
    tilt: Array = np.divide(y2, x2, out=out)
    np.sqrt(tilt, out=tilt)
    np.arctan(tilt, out=tilt)
    tilt *= 2.0
    return tilt
