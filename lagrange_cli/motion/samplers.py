"""Tilt, spin and precession at given times: about one ulp at any time.

The attitude is a pair of complex numbers (Klein's Cayley-Klein parameters; the Pi functions of
Chrapan's sections 3 and 4 are their logarithms), each a theta function times a uniform rotation:

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

One arctangent each gives the tilt and the half sum and half difference of the other two angles.
Of the half-period representations `series` takes the ones whose zeros are the passes over the
poles: there real and imaginary part vanish each by itself, and nothing cancels.

A time is first reduced, exactly, to whole steps and a phase; then a few multiplications per sample
evaluate the polynomials, however far the time.  All constants come from the many-digit arithmetic
of the caller.  A block is computed in the order of its phases: those about one turning point come
before those about the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.blocks import blocks
from ..arithmetic.double_double import reduce_phase
from ..arithmetic.sums_of_doubles import Pair
from ..arithmetic.types import Array
from ..arithmetic.workspace import Workspace
from .attitude import Attitude, Growths, Spinor
from .columns import ATTITUDE, NOTHING, Needs
from .multiple_angles import Coefficients
from .theta_series import Component, Frame
from .times import check_times, times_of

_IN_ORDER = slice(None)
_GREATEST = 340.0
"""The square of its hyperbolic sine leaves room for what is multiplied with it."""


class Angles(NamedTuple):
    """Euler angles in radians, each a float64 array in the shape of the times."""

    theta: Array
    """Tilt of the figure axis (nutation), 0 to pi."""
    phi: Array
    """Spin."""
    psi: Array
    """Precession."""


class Functions(NamedTuple):
    """The functions of the phase that the series are made of, see `theta_series`."""

    S: Array
    C: Array | None
    """None where it is a factor of all of X and Y."""
    s: Array

    def part(self, rows: slice) -> Functions:
        """Return them at some phases."""
        return Functions(*(x if x is None else x[rows] for x in self))  # type: ignore[arg-type]


class Sampler:
    """The constants of one motion that its angles need, ready to be evaluated."""

    growths: Growths
    max_time: float

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Return tilt, spin and precession at the times t; see `Motion.angles`."""
        times = times_of(t)
        self.check(times)
        flat = np.ascontiguousarray(times).reshape(-1)
        angles = Angles(*(np.empty_like(flat) for _ in range(3)))
        with ARRAYS.working():
            for part in blocks(flat.size):
                some = flat[part]
                with Workspace(some.size) as space:
                    at = self.attitude(some, ATTITUDE, space)
                    angles.theta[part][at.order] = at.theta()
                    angles.phi[part][at.order] = at.phi(wrap=wrap)
                    angles.psi[part][at.order] = at.psi(wrap=wrap)
        return Angles(*(angle.reshape(times.shape) for angle in angles))

    def attitude(self, t: Array, needs: Needs, space: Workspace) -> Attitude:
        """Return what is needed of the attitude at a block of times, in arrays of a workspace."""
        raise NotImplementedError

    def check(self, t: ArrayLike, name: str = "t") -> None:
        """Raise LagtopError, by the `name` of the argument, where a time names no phase."""
        check_times(times_of(t), self.max_time, name)


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

    def attitude(self, t: Array, needs: Needs, space: Workspace) -> Attitude:
        """Return the attitude at a block of times, by the series about the nearer turning point."""
        if needs == NOTHING:
            return Attitude(self.growths, space, _IN_ORDER, t, t, Spinor())
        step, since = reduce_phase(t, self.steps_per_time, self.offset, space)
        order, even = _by_parity(step, space)
        space.free(step)
        if order is not _IN_ORDER:
            since = _taken(since, order, space)
            t = _taken(t, order, space) if needs.arguments else t
        argument = np.add(since, self.offset, out=space.new())
        argument *= self.scale
        spinor = self._spinor(argument, even, needs, space)
        return Attitude(self.growths, space, order, t, since, spinor)

    def _spinor(self, argument: Array, even: int, needs: Needs, space: Workspace) -> Spinor:
        """Return X and Y; the first arguments, so many, are about the first turning point."""
        if self.hyperbolic and self.scale > 2 * _GREATEST:  # beyond, the tilt is below 1e-140
            np.clip(argument, -_GREATEST, _GREATEST, out=argument)
        functions = (_hyperbolic if self.hyperbolic else _circular)(argument, space)
        rows = slice(even), slice(even, None)
        frames = [
            (some, functions.part(some), x) for some, x in zip(rows, self.frames, strict=True)
        ]

        def polar(name: str) -> tuple[Array | None, Array | None]:
            """Return squared modulus and argument of X or Y."""
            real, imag = space.new(), space.new()
            for some, there, frame in frames:
                _write_component(getattr(frame, name), there, real[some], imag[some])
            leading = [getattr(frame, name).real[0] for frame in self.frames]
            argument = _argument(real, imag, all(leading), space) if needs.arguments else None
            real *= real
            imag *= imag
            real += imag
            space.free(imag)
            return real, argument

        (x2, arg_x), (y2, arg_y) = polar("x"), polar("y")
        rate = space.new() if needs.rate else None
        if rate is not None:
            for some, there, frame in frames:
                _write_rate(frame.rate, there, rate[some])
        space.free(*functions)
        return Spinor(x2, y2, arg_x, arg_y, rate)


@dataclass(frozen=True)
class ConstantSampler(Sampler):
    """A constant tilt and constant rates of spin and precession."""

    x: float
    y: float
    growths: Growths
    max_time: float

    def attitude(self, t: Array, needs: Needs, space: Workspace) -> Attitude:
        """Return the attitude at a block of times: there is no phase."""
        zero, x, y = np.zeros_like(t), np.full_like(t, self.x), np.full_like(t, self.y)
        spinor = Spinor(x * x, y * y, zero, zero, zero, tilt=2.0 * np.arctan2(y, x))
        return Attitude(self.growths, space, _IN_ORDER, t, zero, spinor)


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

    def attitude(self, t: Array, needs: Needs, space: Workspace) -> Attitude:
        """Return the attitude: 1 - u = (1 - u2)/cosh^2 h, with h = 0 at the lowest point."""
        h = t * self.speed + self.offset
        shrink = np.exp(-np.abs(h))
        sech, tanh = 2.0 * shrink / (1.0 + shrink * shrink), np.tanh(h)
        real, imag = np.full_like(h, self.x), self.y * self.sign * tanh
        x2, y = real * real + imag * imag, self.y * sech
        arg_x = np.arctan2(imag, real)
        falling = -4.0 * self.speed * y * y * tanh if needs.rate else None
        zero = np.zeros_like(h)
        spinor = Spinor(x2, y * y, arg_x, zero, falling)
        return Attitude(self.growths, space, _IN_ORDER, t, zero, spinor)


def _by_parity(step: Array, space: Workspace) -> tuple[Any, int]:
    """Return where the even steps stand and after them the odd ones, and how many are even."""
    half = np.multiply(step, 0.5, out=space.new())
    whole = np.rint(half, out=step)
    even = half == whole
    count = int(np.count_nonzero(even))
    space.free(half)
    if count in {0, step.size}:
        return _IN_ORDER, count
    order = space.new().view(np.intp)
    order[:count] = np.flatnonzero(even)
    order[count:] = np.flatnonzero(np.logical_not(even, out=even))
    return order, count


def _taken(values: Array, order: Any, space: Workspace) -> Array:
    """Return values in another order."""
    taken: Array = np.take(values, order, out=space.new(), mode="clip")  # all are in range
    space.free(values)
    return taken


def _circular(x: Array, space: Workspace) -> Functions:
    """Return the functions of angles; X and Y share the factor cos x, which is divided out."""
    tangent = np.tan(x, out=x)
    square = np.multiply(tangent, tangent, out=space.new())
    more = np.add(square, 1.0, out=space.new())
    square /= more
    space.free(more)
    return Functions(tangent, None, square)


def _hyperbolic(x: Array, space: Workspace) -> Functions:
    """Return the hyperbolic functions of arguments, which are overwritten."""
    sinh = np.sinh(x, out=x)
    square = np.multiply(sinh, sinh, out=space.new())
    cosh = np.add(square, 1.0, out=space.new())
    return Functions(sinh, np.sqrt(cosh, out=cosh), square)


def _write_component(component: Component, at: Functions, real: Array, imag: Array) -> None:
    """Write real and imaginary part of X or Y."""
    _write_polynomial(component.real, at.s, real)
    _write_polynomial(component.imag, at.s, imag)
    imag *= at.S
    if at.C is not None:
        scaled = imag if component.even else real
        scaled *= at.C


def _write_rate(coefficients: Coefficients, at: Functions, rate: Array) -> None:
    """Write what goes with the nutation rate."""
    _write_polynomial(coefficients, at.s, rate)
    rate *= at.S
    rate *= at.C if at.C is not None else 1.0 + at.S * at.S


def _write_polynomial(coefficients: Coefficients, x: Array, value: Array) -> None:
    """Write the value of two coefficients at least, the lowest power first."""
    np.multiply(x, coefficients[-1], out=value)
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]


def _argument(real: Array, imag: Array, off_the_pole: bool, space: Workspace) -> Array:
    """Return the argument, within a quarter turn of 0.

    The real part is positive; where the axis meets a pole it is 0.
    """
    if not off_the_pole:
        return np.arctan2(imag, real, out=space.new())
    tangent = np.divide(imag, real, out=space.new())
    return np.arctan(tangent, out=tangent)
