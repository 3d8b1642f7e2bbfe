"""The angles of a nutating top at arrays of times, by its theta series in doubles.

The zeros of the representations used in `theta_series` are the passages over the poles.  The real
and the imaginary part vanish there separately, so that no digits cancel.

A time is first reduced, exactly, to whole steps and a phase.  A few multiplications per sample then
evaluate the polynomials, at any time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from ...arithmetic.arrays import order_by_parity, placed, taken
from ...arithmetic.ball import Ball
from ...arithmetic.double_double import Period, period_of, whole_periods
from ...arithmetic.numbers import power
from ...arithmetic.points import MAX_PERIODS
from ...arithmetic.rounding import pair
from ...arithmetic.types import Array
from ..kinds import Kind, Separatrix
from ..spin_precession import Nutating
from .attitude import Attitude, Times, growths
from .columns import MODULI, TILT, TURN, Needs
from .samplers import Sampler, constant_sampler, near, separatrix_sampler, start_tilt, tilt_of
from .series_constants import series_from_start
from .theta_series import Coefficients, Component, Frame, Series

_GREATEST = 340.0
"""Greatest argument: the square of its hyperbolic sine does not overflow in later products."""
_LEAST = 5e-324
"""The smallest argument of the functions that is not 0."""
_NEGLIGIBLE = Fraction(1, 2**60)
_SIZE = 2**16
"""The size of the largest coefficient of a frame, within a factor of 2."""


@dataclass(frozen=True)
class ThetaSampler(Sampler):
    """Sampler of a nutating top, by its theta series."""

    step: Period
    """Half the period of the nutation."""
    offset: float
    """The phase at t = 0, in steps."""
    scale: float
    """Argument of the functions per step."""
    speed: float
    """Argument per unit of time."""
    first: float
    """Argument at t = 0."""
    hyperbolic: bool
    frames: Sequence[Frame]
    """The series about the turning points of the even and of the odd steps."""
    slopes: Sequence[float]
    """Slopes per unit of the argument that are added to arg X and arg Y to make them periodic."""

    @cached_property
    def over_a_pole(self) -> bool:
        """Whether the axis passes over a pole: a first real coefficient of X or Y is then 0."""
        return not all(part.real[0] for frame in self.frames for part in frame[:2])

    def attitude(self, t: Array, needs: Needs, farthest: float, space: Array) -> Attitude:
        """Return the attitude at a block of times, by the series about the nearer turning point."""
        space = space[:, : t.size]
        times = Times(t, farthest, space[12:])
        if not needs:
            return Attitude(self.growths, times)
        step, argument, lost = whole_periods(t, self.step, farthest, space[:3], self.offset or None)
        argument -= lost
        argument *= self.speed
        if self.first:
            argument += self.first
        elif self.over_a_pole:  # on a pole at t = 0, and beside it at any other time
            np.copyto(argument, np.copysign(_LEAST, t), where=(argument == 0.0) & (t != 0.0))
        even, order = order_by_parity(step)
        if order is not None:
            argument = taken(argument, order, step)
        found = self._evaluated(argument, even, needs, space[2:13])
        if order is not None:
            free = (space[i] for i in (0, 1, 2, 3, 4, 8))
            found = {name: placed(values, order, next(free)) for name, values in found.items()}
        return Attitude(self.growths, times, **found)

    def _evaluated(
        self, argument: Array, even: int, needs: Needs, space: Array
    ) -> dict[str, Array]:
        """Return the needed parts of an attitude.

        The first `even` arguments belong to the first turning point, the others to the second.
        """
        functions, parts = space[:3], space[3:7]
        found: dict[str, Array] = {}
        self._write_functions(argument, functions)
        pieces = list(zip((slice(even), slice(even, None)), self.frames, strict=True))
        for rows, frame in pieces:
            self._write_parts(frame, functions[:, rows], parts[:, rows])
        if TURN in needs:
            arguments = arguments_of(parts, space[7:9])
            if self.over_a_pole:
                for rows, frame in pieces:
                    for side, part in zip(arguments[:, rows], frame[:2], strict=True):
                        _settle_on_the_pole(side, part, argument[rows])
            unwound(arguments, self.slopes, argument, space[10])
            found |= {"arg_x": arguments[0], "arg_y": arguments[1]}
        if needs & (TILT | MODULI):
            x2, y2 = moduli_of(parts)
            if TILT in needs:
                found["tilt"] = tilt_of(x2, y2, out=parts[1])
            if MODULI in needs:
                found |= {"x2": x2, "y2": y2}
        if Needs.RATE in needs:
            found["rate"] = rate = space[9]
            for rows, frame in pieces:
                _write_polynomial(frame.rate, functions[2][rows], rate[rows])
            rate *= functions[0]
            rate *= functions[1]
        return found

    def _write_functions(self, x: Array, functions: Array) -> None:
        """Write S, C and s of hyperbolic series, or tan, 1/cos^2 and sin^2 of circular ones.

        All parts of circular series have the factor cos x, which is divided out.
        """
        S, C, s = functions
        if not self.hyperbolic:
            np.tan(x, out=S)
        elif self.scale > 2 * _GREATEST:  # beyond it the tilt is below 1e-140
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
    """Write the argument of X or Y if both parts are 0, or too small for doubles.

    The argument is 0 on the pole.  Next to the pole it is a quarter turn with the sign of x.  The
    real part is there proportional to s = S^2, the imaginary part to S.
    """
    vanish = np.isnan(arguments)
    arguments[vanish] = np.sign(part.imag[0]) * np.sign(x[vanish]) * (np.pi / 2)


def arguments_of(parts: Array, out: Array) -> Array:
    """Return the arguments of X and Y, whose real parts are not negative, from their parts."""
    arguments: Array = np.divide(parts[1::2], parts[::2], out=out)
    np.arctan(arguments, out=arguments)
    return arguments


def unwound(arguments: Array, slopes: Sequence[Any], argument: Array, spare: Array) -> Array:
    """Add the slopes to arg X and arg Y in place, and return them: their periodic parts."""
    for i, slope in enumerate(slopes):
        arguments[i] += np.multiply(argument, slope, out=spare)
    return arguments


def moduli_of(parts: Array) -> Array:
    """Return |X|^2 and |Y|^2 from the parts of X and Y, which are overwritten."""
    parts *= parts
    parts[::2] += parts[1::2]
    return parts[::2]


def _write_polynomial(coefficients: Sequence[float], x: Array, value: Array) -> None:
    """Write the value of a polynomial with at least two coefficients, the lowest power first."""
    np.multiply(x, coefficients[-1], out=value)
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]


def sampler_of(motion: Kind[Ball]) -> Sampler:
    """Return the attitude of a motion as a function of arrays of doubles."""
    if isinstance(motion, Nutating):
        return nutating_sampler(motion)
    if isinstance(motion, Separatrix):
        return separatrix_sampler(motion)
    return constant_sampler(motion)


def nutating_sampler(motion: Nutating[Ball]) -> ThetaSampler:
    """Return the sampler of a nutating top."""
    ar: Any = motion.ar
    with ar.working():
        found = series_from_start(motion, rates=True)
        series, period = found.series, motion.T_nutation
        steps, slopes = 2 / period, series.slopes
        x, y = (
            start + slope * found.offset for start, slope in zip(found.starts, slopes, strict=True)
        )
        return ThetaSampler(
            tilt=start_tilt(motion),
            step=period_of(pair((period / 2).middle), near(steps)),
            offset=near(found.offset),
            max_time=near(int(MAX_PERIODS) * period),
            scale=near(series.scale),
            speed=near(series.scale * steps),
            first=near(series.scale * found.offset),
            hyperbolic=series.hyperbolic,
            frames=[
                kept_frame(frame.mapped(_middles, _middles), ar, series, _NEGLIGIBLE).mapped(
                    _doubles, _doubles
                )
                for frame in found.frames
            ],
            slopes=[near(slope / series.scale) for slope in slopes],
            growths=growths(ar, (motion.mean_spin_rate, motion.mean_precession_rate), (x, y)),
        )


def kept_frame(frame: Frame, ar: Any, series: Series, negligible: Fraction) -> Frame:
    """Return a frame without negligible coefficients, the largest of which is about `_SIZE`.

    X and Y may have any common factor.  This factor keeps all coefficients in the range of doubles.
    """
    # the greatest s, sin^2 or sinh^2, is at the end of a step, half of `scale` from 0
    greatest = ar.exp(series.scale) / 4 if series.hyperbolic else ar.convert(0.5)
    least = ar.convert(negligible)
    parts = (frame.x.real, frame.x.imag, frame.y.real, frame.y.imag)
    exponent = math.frexp(max(abs(near(part[0])) for part in parts))[1]
    size = ar.convert(Fraction(2) ** exponent / _SIZE)

    def kept(coefficients: Coefficients, size: Any) -> Coefficients:
        sizes, count = [abs(x) for x in coefficients], len(coefficients)
        while count > 2 and sizes[count - 1] * power(greatest, count - 1) <= least * sizes[0]:
            count -= 1
        return [x / size for x in coefficients[:count]]

    return frame.mapped(lambda x: kept(x, size), lambda x: kept(x, power(size, 4)))


def _middles(coefficients: Coefficients) -> Coefficients:
    return [x.middle for x in coefficients]


def _doubles(coefficients: Coefficients) -> list[float]:
    return [near(x) + 0.0 for x in coefficients]  # no -0
