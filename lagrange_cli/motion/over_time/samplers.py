"""Tilt, spin and precession at given times: about one ulp at any time.

The attitude is a pair of complex numbers (Klein's Cayley-Klein parameters; the Pi functions of
Chrapan's sections 3 and 4 are their logarithms), each a theta function times a uniform rotation:

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

One arctangent each gives the tilt and the half sum and half difference of the other two angles.
Of the half-period representations `theta_series` takes the ones whose zeros are the passes over the
poles: there real and imaginary part vanish each by itself, and nothing cancels.

A time is first reduced, exactly, to whole steps and a phase; then a few multiplications per sample
evaluate the polynomials, however far the time.  All constants come from the many-digit arithmetic
of the caller.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arithmetic.arrays import ARRAYS, BLOCK, blocks, order_by_parity, placed, taken, workspace
from ...arithmetic.double_double import Period, whole_periods
from ...arithmetic.types import Array
from .attitude import Attitude, Growths, Spinor, Times
from .columns import NOTHING, TILT, TURN, Needs
from .theta_series import Component, Frame
from .times import check_times, times_of

_GREATEST = 340.0
"""The square of its hyperbolic sine leaves room for what is multiplied with it."""
_LEAST = 5e-324
"""An argument of the functions that is next to 0, but not 0."""
ARGUMENTS = ("arg_x", "arg_y")


class Angles(NamedTuple):
    """Euler angles in radians, each a float64 array in the shape of the times."""

    theta: Array
    """Tilt of the figure axis (nutation), 0 to pi."""
    phi: Array
    """Spin."""
    psi: Array
    """Precession."""


class Sampler:
    """The constants of one motion that its angles need, ready to be evaluated."""

    tilt: float
    """The tilt at t = 0."""
    growths: Growths
    max_time: float

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Return tilt, spin and precession at the times t; see `Motion.angles`."""
        times = times_of(t)
        flat = np.ascontiguousarray(times).reshape(-1)
        angles = Angles(*np.empty((3, flat.size)))
        with ARRAYS.working(), workspace(min(flat.size, BLOCK)) as space:
            for part in blocks(flat.size):
                at = self.attitude(flat[part], TILT | TURN, self.check(flat[part]), space)
                angles.theta[part] = at.theta()
                at.phi(wrap=wrap, out=angles.phi[part])
                at.psi(wrap=wrap, out=angles.psi[part])
        angles.theta[flat == 0.0] = self.tilt
        return Angles(*(angle.reshape(times.shape) for angle in angles))

    def attitude(self, t: Array, needs: Needs, farthest: float, space: Array) -> Attitude:
        """Return what is needed of the attitude at a block of times, none beyond `farthest`.

        It may be kept in a `workspace`.
        """
        raise NotImplementedError

    def check(self, t: ArrayLike, name: str = "t") -> float:
        """Return the greatest |t|.

        Raises LagtopError, by the `name` of the argument, where a time names no phase.
        """
        return check_times(times_of(t), self.max_time, name)


@dataclass(frozen=True)
class ThetaSampler(Sampler):
    """A nutating top, by its theta series."""

    tilt: float
    step: Period
    """Half a period of the nutation."""
    offset: float
    """The phase at t = 0, in steps."""
    max_time: float
    scale: float
    """Argument of the functions per step."""
    speed: float
    """Argument per unit of time."""
    first: float
    """Argument at t = 0."""
    hyperbolic: bool
    frames: Sequence[Frame]
    """About the turning points of the even and of the odd steps."""
    slopes: Sequence[float]
    """What the mean growth of arg X and arg Y has more than these, per unit of the argument."""
    growths: Growths

    @cached_property
    def over_a_pole(self) -> bool:
        """Whether the axis passes over a pole: the real part of X or Y is 0 all about it."""
        return not all(part.real[0] for frame in self.frames for part in frame[:2])

    def attitude(self, t: Array, needs: Needs, farthest: float, space: Array) -> Attitude:
        """Return the attitude at a block of times, by the series about the nearer turning point."""
        space = space[:, : t.size]
        times = Times(t, farthest, space[12:])
        if needs == NOTHING:
            return Attitude(self.growths, times, Spinor())
        step, argument, lost = whole_periods(t, self.step, farthest, space[:3], self.offset or None)
        argument -= lost
        argument *= self.speed
        if self.first:
            argument += self.first
        elif self.over_a_pole:  # on a pole at t = 0, and on one side of it however soon after
            np.copyto(argument, np.copysign(_LEAST, t), where=(argument == 0.0) & (t != 0.0))
        even, order = order_by_parity(step)
        if order is not None:
            argument = taken(argument, order, step)
        found = self._evaluated(argument, even, needs, space[2:13])
        if order is not None:
            free = (space[i] for i in (0, 1, 2, 3, 4, 8))
            found = {name: placed(values, order, next(free)) for name, values in found.items()}
        return Attitude(self.growths, times, Spinor(**found))

    def _evaluated(
        self, argument: Array, even: int, needs: Needs, space: Array
    ) -> dict[str, Array]:
        """Return the parts of a spinor that are needed.

        The first arguments, as many as are `even`, are about the first turning point.
        """
        functions, parts = space[:3], space[3:7]
        found: dict[str, Array] = {}
        self._write_functions(argument, functions)
        pieces = list(zip((slice(even), slice(even, None)), self.frames, strict=True))
        for rows, frame in pieces:
            self._write_parts(frame, functions[:, rows], parts[:, rows])
        if needs.arguments:
            arguments = arguments_of(parts, space[7:9])
            if self.over_a_pole:
                for rows, frame in pieces:
                    for side, part in zip(arguments[:, rows], frame[:2], strict=True):
                        _settle_on_the_pole(side, part, argument[rows])
            found |= zip(
                ARGUMENTS, unwound(arguments, self.slopes, argument, space[10]), strict=True
            )
        if needs.tilt or needs.moduli:
            x2, y2 = moduli_of(parts)
            if needs.tilt:
                found["tilt"] = tilt_of(x2, y2, out=parts[1])
            if needs.moduli:
                found |= {"x2": x2, "y2": y2}
        if needs.rate:
            found["rate"] = rate = space[9]
            for rows, frame in pieces:
                _write_polynomial(frame.rate, functions[2][rows], rate[rows])
            rate *= functions[0]
            rate *= functions[1]
        return found

    def _write_functions(self, x: Array, functions: Array) -> None:
        """Write S, C and s of the series; in circular ones tan, 1/cos^2 and sin^2.

        All parts of circular series have the factor cos x, which is divided out.
        """
        S, C, s = functions
        if not self.hyperbolic:
            np.tan(x, out=S)
        elif self.scale > 2 * _GREATEST:  # beyond, the tilt is below 1e-140
            np.sinh(np.clip(x, -_GREATEST, _GREATEST, out=S), out=S)
        else:
            np.sinh(x, out=S)
        np.multiply(S, S, out=s)
        np.add(s, 1.0, out=C)
        if self.hyperbolic:
            np.sqrt(C, out=C)
        else:
            s /= C

    def _write_parts(self, frame: Frame, functions: Array, parts: Array) -> None:
        """Write Re X, Im X, Re Y and Im Y about a turning point."""
        S, C, s = functions
        (*x, even), (*y, _) = frame.x, frame.y
        for coefficients, part in zip((*x, *y), parts, strict=True):
            _write_polynomial(coefficients, s, part)
        parts[1::2] *= S
        if self.hyperbolic:
            parts[slice(1, 3) if even else slice(0, 4, 3)] *= C


def _settle_on_the_pole(arguments: Array, part: Component, x: Array) -> None:
    """Write the argument of X or Y where real and imaginary part are 0, or too small for doubles.

    It is 0 on the pole, and next to it a quarter turn to the side of x, because the real part goes
    with s = S^2 and the imaginary part with S.
    """
    vanish = np.isnan(arguments)
    arguments[vanish] = np.sign(part.imag[0]) * np.sign(x[vanish]) * (np.pi / 2)


def arguments_of(parts: Array, out: Array) -> Array:
    """Return the arguments of X and Y, whose real parts are not negative, from their parts."""
    arguments: Array = np.divide(parts[1::2], parts[::2], out=out)
    np.arctan(arguments, out=arguments)
    return arguments


def unwound(arguments: Array, slopes: Sequence[Any], argument: Array, spare: Array) -> Array:
    """Return the periodic parts of arg X and arg Y, in place: less their mean growth."""
    for i, slope in enumerate(slopes):
        arguments[i] += np.multiply(argument, slope, out=spare)
    return arguments


def moduli_of(parts: Array) -> Array:
    """Return |X|^2 and |Y|^2 from the parts of X and Y, which are overwritten."""
    parts *= parts
    parts[::2] += parts[1::2]
    return parts[::2]


def tilt_of(x2: Array, y2: Array, out: Array | None = None) -> Array:
    """Return 2 arctan(|Y|/|X|)."""
    tilt: Array = np.divide(y2, x2, out=out)
    np.sqrt(tilt, out=tilt)
    np.arctan(tilt, out=tilt)
    tilt *= 2.0
    return tilt


@dataclass(frozen=True)
class ConstantSampler(Sampler):
    """A constant tilt and constant rates of spin and precession."""

    tilt: float
    x: float
    y: float
    growths: Growths
    max_time: float

    def attitude(self, t: Array, needs: Needs, farthest: float, space: Array) -> Attitude:
        """Return the attitude at a block of times: there is no phase."""
        tilt, x2, y2 = (np.full_like(t, x) for x in (self.tilt, self.x**2, self.y**2))
        zero = np.zeros_like(t)
        spinor = Spinor(tilt, x2, y2, zero, zero, zero)
        return Attitude(self.growths, Times(t, farthest, space[12:, : t.size]), spinor)


@dataclass(frozen=True)
class SeparatrixSampler(Sampler):
    """The one swing from the upright position down and up again, k = 1 and T infinite."""

    tilt: float
    speed: float
    offset: float
    x: float
    """cos(theta_max/2)."""
    y: float
    """sin(theta_max/2)."""
    sign: int
    growths: Growths
    max_time: float

    def attitude(self, t: Array, needs: Needs, farthest: float, space: Array) -> Attitude:
        """Return the attitude: 1 - u = (1 - u2)/cosh^2 h, with h = 0 at the lowest point."""
        h = t * self.speed + self.offset
        shrink = np.exp(-np.abs(h))
        sech, tanh = 2.0 * shrink / (1.0 + shrink * shrink), np.tanh(h)
        real, imag = np.full_like(h, self.x), self.y * self.sign * tanh
        x2, y = real * real + imag * imag, self.y * sech
        arg_x, zero = np.arctan2(imag, real), np.zeros_like(h)
        falling = -4.0 * self.speed * y * y * tanh
        spinor = Spinor(tilt_of(x2, y * y), x2, y * y, arg_x, zero, falling)
        return Attitude(self.growths, Times(t, farthest, space[12:, : t.size]), spinor)


def _write_polynomial(coefficients: Sequence[float], x: Array, value: Array) -> None:
    """Write the value of two coefficients at least, the lowest power first."""
    np.multiply(x, coefficients[-1], out=value)
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]
