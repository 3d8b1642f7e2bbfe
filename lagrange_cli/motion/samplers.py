"""Tilt, spin and precession at given times: about one ulp at any time.

The attitude is a pair of complex numbers (Klein's Cayley-Klein parameters; the Pi functions of
Chrapan's sections 3 and 4 are their logarithms), each a theta function times a uniform rotation:

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

One atan2 each gives the tilt and the half sum and half difference of the other two angles.  Of the
half-period representations `series` takes the ones whose zeros are the passes over the poles: there
real and imaginary part vanish each by itself, and nothing cancels.

A time is first reduced, exactly, to whole steps and a phase; then a few multiplications a sample
evaluate the polynomials, however far the time.  All constants come from the many-digit arithmetic
of the caller.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.blocks import blocks, polynomial
from ..arithmetic.double_double import Pair, reduce_phase
from ..arithmetic.points import MAX_TIME
from ..arithmetic.types import Array
from ..errors import LagtopError
from .attitude import Growths
from .theta_series import Component, Frame, Polynomial

Grow = Callable[[Array, Array, Array], Array]
"""A method of `Growth`: an angle from the times, the parts of their steps, and the series."""


class Angles(NamedTuple):
    """Euler angles in radians, each a float64 array in the shape of the times."""

    theta: Array
    """Tilt of the figure axis (nutation), 0 to pi."""
    phi: Array
    """Spin."""
    psi: Array
    """Precession."""


class Spinor(NamedTuple):
    """X and Y about their turning point, up to a common positive factor."""

    x: Array
    """|X|."""
    y: Array
    """|Y|."""
    arg_x: Array
    arg_y: Array
    rate: Array | None
    """2 (x^2 + y^2) x y times the nutation rate, where it was asked for."""


@dataclass(frozen=True)
class Attitude:
    """The attitude at a block of times; each of its angles is computed when it is asked for."""

    growths: Growths
    t: Array
    since: Array
    """The part of a step that has passed since the whole ones."""
    spinor: Spinor

    def theta(self) -> Array:
        """Return the tilt."""
        theta: Array = np.arctan2(self.spinor.y, self.spinor.x)
        theta *= 2.0
        return theta

    def phi(self, *, wrap: bool = False) -> Array:
        """Return the spin, arg X - arg Y."""
        growth = self.growths.phi
        return self._angle(growth.wrapped if wrap else growth.unwrapped, -1)

    def psi(self, *, wrap: bool = False) -> Array:
        """Return the precession, arg X + arg Y."""
        growth = self.growths.psi
        return self._angle(growth.wrapped if wrap else growth.unwrapped, 1)

    def phi_remainder(self) -> Array:
        """Return the spin less its mean growth (6,4)."""
        return self._angle(self.growths.phi.remainder, -1)

    def psi_remainder(self) -> Array:
        """Return the precession less its mean growth (7,4)."""
        return self._angle(self.growths.psi.remainder, 1)

    def args(self) -> tuple[Array, Array]:
        """Return (psi + phi)/2 and (psi - phi)/2, each in (-pi, pi]."""
        return (
            self.growths.arg_x.wrapped(self.t, self.since, self.spinor.arg_x.copy()),
            self.growths.arg_y.wrapped(self.t, self.since, self.spinor.arg_y.copy()),
        )

    def _angle(self, grow: Grow, sign: int) -> Array:
        """Return what a method of a `Growth` makes of the sum or the difference of the series."""
        x, y = self.spinor.arg_x, self.spinor.arg_y
        return grow(self.t, self.since, x + y if sign > 0 else x - y)


class Sampler:
    """The constants of one motion that its angles need, ready to be evaluated."""

    max_time: float

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Return tilt, spin and precession at the times t; see `Motion.angles`."""
        times = times_of(t)
        self.check(times)
        flat = np.ascontiguousarray(times).reshape(-1)
        angles = Angles(*(np.empty_like(flat) for _ in range(3)))
        with ARRAYS.working():
            for part, attitude in self.attitudes(flat):
                angles.theta[part] = attitude.theta()
                angles.phi[part] = attitude.phi(wrap=wrap)
                angles.psi[part] = attitude.psi(wrap=wrap)
        return Angles(*(angle.reshape(times.shape) for angle in angles))

    def attitudes(self, t: Array, *, rate: bool = False) -> Iterator[tuple[slice, Attitude]]:
        """Yield the attitude block by block, with the nutation rate where `rate` asks for it."""
        for part in blocks(t.size):
            yield part, self.attitude(t[part], rate)

    def attitude(self, t: Array, rate: bool) -> Attitude:
        """Return the attitude at a block of times."""
        raise NotImplementedError

    def check(self, t: ArrayLike) -> None:
        """Raise LagtopError where a time is not finite or names no phase."""
        times = times_of(t)
        bad = ~(np.abs(times) <= min(self.max_time, MAX_TIME))
        if bad.any():
            raise LagtopError(
                f"t must be finite and within 2^50 periods = {min(self.max_time, MAX_TIME):.3g}, "
                f"got {times[bad].flat[0]}",
                "t",
            )


@dataclass(frozen=True)
class ThetaSampler(Sampler):
    """A nutating top, by its theta series."""

    steps_per_time: Pair
    offset: float
    """The phase at t = 0."""
    max_time: float
    scale: float
    hyperbolic: bool
    frames: Sequence[Frame]
    """About the turning points of the even and of the odd steps."""
    growths: Growths

    def attitude(self, t: Array, rate: bool) -> Attitude:
        """Return the attitude at a block of times, by the series about the nearer turning point."""
        step, since = reduce_phase(t, self.steps_per_time, self.offset)
        argument = (since + self.offset if self.offset else since) * self.scale
        spinor = self._spinor_by_parity(step, argument, rate)
        return Attitude(self.growths, t, since, spinor)

    def _spinor_by_parity(self, step: Array, argument: Array, rate: bool) -> Spinor:
        half = step * 0.5
        odd = np.rint(half) != half
        x, y, arg_x, arg_y = (np.empty_like(step) for _ in range(4))
        whole = Spinor(x, y, arg_x, arg_y, np.empty_like(step) if rate else None)
        for frame, chosen in zip(self.frames, (~odd, odd), strict=True):
            index = np.flatnonzero(chosen)
            some = self._spinor(frame, argument[index], rate)
            for target, part in zip(whole, some, strict=True):
                if target is not None:
                    target[index] = part
        return whole

    def _spinor(self, frame: Frame, argument: Array, rate: bool) -> Spinor:
        S, C, s = (_hyperbolic if self.hyperbolic else _circular)(argument)
        x, arg_x = _polar(*_component(frame.x, S, C, s))
        y, arg_y = _polar(*_component(frame.y, S, C, s))
        return Spinor(x, y, arg_x, arg_y, _rate(frame.rate, S, C, s) if rate else None)


@dataclass(frozen=True)
class ConstantSampler(Sampler):
    """A constant tilt and constant rates of spin and precession."""

    x: float
    y: float
    growths: Growths
    max_time: float

    def attitude(self, t: Array, rate: bool) -> Attitude:
        """Return the attitude at a block of times: there is no phase."""
        zero = np.zeros_like(t)
        x, y = np.full_like(t, self.x), np.full_like(t, self.y)
        return Attitude(self.growths, t, zero, Spinor(x, y, zero, zero, zero if rate else None))


@dataclass(frozen=True)
class SeparatrixSampler(Sampler):
    """The one swing from the upright position down and up again, k = 1 and T infinite."""

    speed: float
    offset: float
    x: float
    """cos(theta_max/2)."""
    y: float
    """sin(theta_max/2)."""
    sign: int
    growths: Growths
    max_time: float

    def attitude(self, t: Array, rate: bool) -> Attitude:
        """Return the attitude: 1 - u = (1 - u2)/cosh^2 h, with h = 0 at the lowest point."""
        h = t * self.speed + self.offset
        shrink = np.exp(-np.abs(h))
        sech, tanh = 2.0 * shrink / (1.0 + shrink * shrink), np.tanh(h)
        x, arg_x = _polar(np.full_like(h, self.x), self.y * self.sign * tanh)
        y = self.y * sech
        falling = -4.0 * self.speed * y * y * tanh if rate else None
        zero = np.zeros_like(h)
        return Attitude(self.growths, t, zero, Spinor(x, y, arg_x, zero, falling))


def times_of(t: ArrayLike) -> Array:
    """Return times as float64.  Raises LagtopError for what is not an array of real numbers."""
    if np.ma.isMaskedArray(t) and np.ma.getmaskarray(t).any():
        raise LagtopError("t must not be masked: fill it or leave the elements out", "t")
    try:
        times = np.asarray(t)
        if times.size and times.dtype.kind not in "iufO":
            raise TypeError(times.dtype)
        return times.astype(np.float64, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise LagtopError(f"t must be real numbers, got {repr(t)[:60]}", "t") from None


def _circular(x: Array) -> tuple[Array, None, Array]:
    """Return S, C and s of angles; X and Y share the factor cos x, which is divided out."""
    tangent = np.tan(x)
    square = tangent * tangent
    square /= square + 1.0
    return tangent, None, square


def _hyperbolic(x: Array) -> tuple[Array, Array, Array]:
    sinh = np.sinh(x)
    square = sinh * sinh
    return sinh, np.sqrt(square + 1.0), square


def _component(component: Component, S: Array, C: Array | None, s: Array) -> tuple[Array, Array]:
    """Return real and imaginary part of X or Y."""
    real, imag = polynomial(component.real, s), polynomial(component.imag, s)
    imag *= S
    if C is not None:
        scaled = imag if component.even else real
        scaled *= C
    return real, imag


def _rate(coefficients: Polynomial, S: Array, C: Array | None, s: Array) -> Array:
    rate: Array = polynomial(coefficients, s)
    rate *= S
    rate *= C if C is not None else 1.0 + S * S
    return rate


def _polar(real: Array, imag: Array) -> tuple[Array, Array]:
    """Return modulus and argument."""
    square = real * real
    square += imag * imag
    modulus: Array = np.sqrt(square, out=square)
    return modulus, np.arctan2(imag, real, out=imag)
