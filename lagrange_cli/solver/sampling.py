"""Tilt, spin and precession at arrays of times: about one ulp at any time.

The attitude is a pair of complex numbers, the Cayley-Klein parameters.  Each is a theta function
times a uniform rotation, and the Pi functions of Chrapan's sections 3 and 4 are their logarithms:

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

One arctangent each gives the tilt, and the half sum and half difference of the other two angles.
These are mean rates times t plus periodic parts.  The periodic parts are small, except next to a
pole, so that sums and differences lose little accuracy.  The real and the imaginary part of X or Y
vanish separately where the axis passes over a pole, so that no digits cancel.

All constants are computed in many digits and rounded once.  A time is first reduced, exactly, to
whole steps of half a period and a phase.  Blocks of times share their work arrays, because new
memory would cost more than most operations.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import ARRAYS, BLOCK, blocks, doubles_of, order_by_parity, placed, taken
from ..arithmetic.numbers import power
from ..arithmetic.pairs import (
    MANY,
    PI,
    Pair,
    Period,
    Triple,
    fraction_of_product,
    pair,
    period_of,
    triple,
    two_product,
    two_sum,
    whole_periods,
)
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..top.ranges import MAX_PERIODS, MAX_TIME
from .kinds import Constant, Kind, Separatrix
from .series import Coefficients, Frame, direction, evaluate, separatrix_constants, theta_series
from .spin_precession import Nutating

_ROWS = 26
"""Work arrays of a block: three for a reduced time, four for growing angles, others for series."""
_GREATEST = 340.0
"""Greatest argument: the square of its hyperbolic sine does not overflow in later products."""
_LEAST = 5e-324
"""The smallest argument of the functions that is not 0."""
_NEGLIGIBLE = 2.0**-60
_SIZE = 2**16
"""The size of the largest coefficient of a frame, within a factor of 2."""


class Angles(NamedTuple):
    """Tilt, spin and precession in radians, each a float64 array in the shape of the times."""

    theta: Array
    phi: Array
    psi: Array


class Growth(NamedTuple):
    """Growth of an angle from 0 at t = 0: a mean rate times t, and a periodic part.

    `start` is the periodic part at t = 0, `turn` the time of one turn, and `turns` the rate in
    turns, as three doubles so that the fraction of a turn is accurate at any time.
    """

    start: Pair
    rate: Pair
    turn: Period
    turns: Triple

    def since_start(self, periodic: Array) -> Array:
        """Subtract from a periodic part its value at t = 0, in place."""
        if self.start.high:
            periodic -= self.start.high
            periodic -= self.start.low
        return periodic

    def unwrapped(self, periodic: Array, at: Attitude) -> Array:
        """Return the angle from its periodic part, which is overwritten."""
        angle, spare = self.since_start(periodic), at.space[3]
        angle += np.multiply(at.t, self.rate.low, out=spare)
        angle += np.multiply(at.t, self.rate.high, out=spare)
        return angle

    def wrapped(self, periodic: Array, at: Attitude) -> Array:
        """Return the angle in (-pi, pi], as accurate at late times as at early ones.

        Whole turns are subtracted from the time until the sum of both parts is in this interval.
        """
        angle = self.since_start(periodic)
        turns = np.multiply(angle, 0.5 / PI.high, out=at.space[6])
        grown, lost = self._within_a_turn(at, turns)
        angle += grown
        angle += lost
        outside = np.abs(angle, out=lost) >= np.pi
        if outside.any():  # because the turns were rounded
            rest = angle[outside]
            rest[rest > np.pi] -= 2.0 * PI.high
            rest[rest <= -np.pi] += 2.0 * PI.high
            angle[outside] = rest
        return angle

    def within_a_quarter(self, periodic: Array, at: Attitude) -> tuple[Array, Array]:
        """Return the angle minus n half turns, in [-pi/2, pi/2], and (-1)^n."""
        grown, lost = self._within_a_turn(at)
        angle, more = two_sum(self.since_start(periodic), grown)
        halves = np.rint(angle / PI.high)
        angle = (angle - halves * PI.high) + (lost + more - halves * PI.middle)
        return angle, 1.0 - 2.0 * (halves % 2.0)

    def _within_a_turn(self, at: Attitude, more: float | Array = 0.0) -> tuple[Array, Array]:
        """Return the mean rate times t in two parts, reduced by turns to about -`more` turns."""
        whole, grown, lost = whole_periods(at.t, self.turn, 0.0, at.space[3:6], more)
        lost *= -self.rate.high
        lost += grown * self.rate.low
        grown *= self.rate.high
        if at.farthest > self.turn.reach:  # the fraction of a turn stays accurate
            far, turns = np.abs(whole) >= MANY, fraction_of_product(at.t, self.turns)
            turns -= np.rint(turns + more)
            product, error = two_product(turns, 2.0 * PI.high)
            np.copyto(grown, product, where=far)
            np.copyto(lost, error + turns * (2.0 * PI.middle), where=far)
        return grown, lost


def growth_of(ar: Any, rate: Any, start: Any = 0) -> Growth:
    """Return the growth of an angle from its mean rate and its periodic part at t = 0."""
    rate, start = ar.convert(rate), ar.convert(start).middle
    if not rate.is_known_to(10):  # the digits in use do not distinguish it from 0
        rate = ar.convert(0)
    turns = triple((rate / (2 * ar.pi)).middle)
    turn = pair((2 * ar.pi / rate).middle) if rate else Pair(0.0, 0.0)
    rate_pair, start_pair = pair(rate.middle), pair(start) if start else Pair(0.0, 0.0)
    return Growth(start_pair, rate_pair, period_of(turn, float(turns.high)), turns)


def near(x: Any) -> float:
    """Return the double nearest to the midpoint of a ball of many digits."""
    return float(x.middle) + 0.0  # no -0


class Attitude:
    """X and Y at a block of times, up to a common factor; parts are computed on first use.

    By the series of a nutating top, about the nearer turning point.  Times are ordered by that
    point while the series are evaluated.
    """

    def __init__(self, sampler: Any, t: Array, farthest: float, space: Array, **parts: Any) -> None:
        """Take a sampler, times with a bound of |t|, work arrays, and the parts that are known."""
        self.sampler, self.t, self.farthest, self.space = sampler, t, farthest, space
        vars(self).update(parts)

    def phi(self, *, wrap: bool = False, out: Any = None) -> Array:
        """Return the spin, arg X - arg Y; if `wrap`, in (-pi, pi]."""
        return self._grown(self.sampler.phi, np.subtract(self.args[0], self.args[1], out=out), wrap)

    def psi(self, *, wrap: bool = False, out: Any = None) -> Array:
        """Return the precession, arg X + arg Y; if `wrap`, in (-pi, pi]."""
        return self._grown(self.sampler.psi, np.add(self.args[0], self.args[1], out=out), wrap)

    def waves(self) -> tuple[Array, Array]:
        """Return the periodic parts of spin and precession, (6,4) and (7,4)."""
        x, y = self.args
        return self.sampler.phi.since_start(x - y), self.sampler.psi.since_start(x + y)

    def _grown(self, growth: Growth, periodic: Array, wrap: bool) -> Array:
        return (growth.wrapped if wrap else growth.unwrapped)(periodic, self)

    @cached_property
    def functions(self) -> tuple[Array, Array, Array, Array]:
        """The argument, S, C and s; of circular series C is 1/cos^2."""
        sampler, t, space = self.sampler, self.t, self.space
        step, argument, lost = whole_periods(
            t, sampler.step, self.farthest, space[:3], sampler.offset or None
        )
        argument -= lost
        argument *= sampler.speed
        if sampler.first:
            argument += sampler.first
        elif sampler.over_a_pole:  # on a pole at t = 0, and beside it at any other time
            np.copyto(argument, np.copysign(_LEAST, t), where=(argument == 0.0) & (t != 0.0))
        self.even, self.order = order_by_parity(step)
        if self.order is not None:
            argument = taken(argument, self.order, step)
        S, C, s = space[7:10]
        if not sampler.hyperbolic:
            np.tan(argument, out=S)
        elif sampler.scale > 2 * _GREATEST:  # beyond it the tilt is below 1e-140
            np.sinh(np.clip(argument, -_GREATEST, _GREATEST, out=S), out=S)
        else:
            np.sinh(argument, out=S)
        np.multiply(S, S, out=s)
        np.add(s, 1.0, out=C)
        if sampler.hyperbolic:
            np.sqrt(C, out=C)
        else:
            s /= C
        return argument, S, C, s

    @property
    def _pieces(self) -> Iterator[tuple[int, slice, Frame]]:
        """The rows of both turning points, with their series; 0 is u1 and 1 is u2."""
        rows = slice(self.even), slice(self.even, None)
        for i, frame in enumerate(self.sampler.frames):
            if i == 0 < self.even or (i == 1 and self.even < self.t.size):
                yield (i + self.sampler.first_point) % 2, rows[i], frame

    def _placed(self, values: Array, row: int) -> Array:
        """Return ordered values in the order of the times, in a work array."""
        if self.order is None:
            return values
        return placed(values, self.order, self.space[row])

    @cached_property
    def parts(self) -> Array:
        """Re X, Im X, Re Y and Im Y, ordered."""
        _, S, C, s = self.functions
        parts = self.space[10:14]
        for _, rows, frame in self._pieces:
            for coefficients, part in zip(frame.parts, parts, strict=True):
                _write_polynomial(coefficients, s[rows], part[rows])
        parts[1::2] *= S
        if self.sampler.hyperbolic:
            for point, rows, _ in self._pieces:
                parts[(slice(1, 3), slice(0, 4, 3))[point], rows] *= C[rows]
        return parts

    @cached_property
    def args(self) -> tuple[Array, Array]:
        """The periodic parts of arg X and arg Y, whose real parts are not negative."""
        argument = self.functions[0]
        args = np.divide(self.parts[1::2], self.parts[::2], out=self.space[14:16])
        np.arctan(args, out=args)
        if self.sampler.over_a_pole and np.isnan(args).any():
            # 0/0 next to a pole: the real part is proportional to s, the imaginary part to S
            for _, rows, frame in self._pieces:
                for side, (slope, *_) in zip(args[:, rows], frame.parts[1::2], strict=True):
                    quarter = np.sign(slope) * np.sign(argument[rows]) * (np.pi / 2)
                    np.copyto(side, quarter, where=np.isnan(side))
        for i, slope in enumerate(self.sampler.slopes):
            args[i] += np.multiply(argument, slope, out=self.space[3])
        return self._placed(args[0], 20), self._placed(args[1], 21)

    @cached_property
    def squares(self) -> Array:
        """|X|^2 and |Y|^2, ordered."""
        squares = np.multiply(self.parts, self.parts, out=self.space[16:20])
        squares[::2] += squares[1::2]
        return squares[::2]

    @cached_property
    def moduli(self) -> tuple[Array, Array]:
        """|X|^2 and |Y|^2."""
        return self._placed(self.squares[0], 22), self._placed(self.squares[1], 23)

    @cached_property
    def tilt(self) -> Array:
        """The tilt."""
        x2, y2 = self.squares
        return self._placed(tilt_of(x2, y2, self.space[17]), 24)

    @cached_property
    def rate(self) -> Array:
        """2 (|X|^2 + |Y|^2) |X| |Y| times the nutation rate."""
        _, S, C, s = self.functions
        rate = self.space[19]
        for _, rows, frame in self._pieces:
            _write_polynomial(frame.rate, s[rows], rate[rows])
        rate *= S
        rate *= C
        return self._placed(rate, 25)


class Sampler:
    """The angles of one motion as functions of time, with constants that are computed once."""

    max_time: float

    def __init__(
        self, motion: Kind[Any], rates: tuple[Any, Any], starts: tuple[Any, Any] = (0, 0)
    ) -> None:
        """Take a motion, the mean rates of spin and precession, and arg X and arg Y at t = 0.

        The rates are separate, because sums and differences lose a much smaller rate.
        """
        self.ar, self._rates, self._starts = motion.ar, rates, starts
        (phi, psi), (x, y) = rates, starts
        self.phi, self.psi = growth_of(self.ar, phi, x - y), growth_of(self.ar, psi, x + y)
        self.tilt = near(2 * self.ar.atan2(motion.state.sin_half, motion.state.cos_half))

    @cached_property
    def halves(self) -> tuple[Growth, Growth]:
        """The growths of arg X and arg Y, which few columns need."""
        (phi, psi), (x, y) = self._rates, self._starts
        with self.ar.working():
            return growth_of(self.ar, (psi + phi) / 2, x), growth_of(self.ar, (psi - phi) / 2, y)

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Return tilt, spin and precession at the times t; see `Motion.angles`."""
        times = doubles_of("t", t)
        flat = np.ascontiguousarray(times).reshape(-1)
        angles = np.empty((3, flat.size))
        with ARRAYS.working():
            for part, at in self.attitudes(flat):
                angles[0, part] = at.tilt
                at.phi(wrap=wrap, out=angles[1, part])
                at.psi(wrap=wrap, out=angles[2, part])
        angles[:, np.flatnonzero(flat == 0.0)] = [[self.tilt], [0.0], [0.0]]
        return Angles(*(angle.reshape(times.shape) for angle in angles))

    def waves(self, t: Array) -> Array:
        """Return the tilt and the periodic parts of spin and precession, of shape (3, times)."""
        found = np.empty((3, t.size))
        with ARRAYS.working():
            for part, at in self.attitudes(t):
                found[:, part] = at.tilt, *at.waves()
        return found

    def attitudes(self, t: Array) -> Iterator[tuple[slice, Attitude]]:
        """Yield the attitude at blocks of times; each overwrites the one before.

        Raises LagtopError for a time that is out of range.
        """
        farthest, space = self.check(t), np.empty((_ROWS, min(t.size, BLOCK)))
        for part in blocks(t.size):
            block = t[part]
            with ARRAYS.working():
                attitude = self.attitude(block, farthest, space[:, : block.size])
            yield part, attitude

    def attitude(self, t: Array, farthest: float, space: Array) -> Attitude:
        """Return the attitude at a block of times, none beyond `farthest`."""
        return Attitude(self, t, farthest, space)

    def check(self, t: ArrayLike, name: str = "t") -> float:
        """Return the greatest |t|.

        Raises LagtopError, with the `name` of the argument, if a time is not finite or too large.
        """
        times, limit = doubles_of("t", t), min(self.max_time, MAX_TIME)
        if not times.size:
            return 0.0
        low, high = float(times.min()), float(times.max())
        if low >= -limit and high <= limit:
            return max(-low, high)
        bad = times[~(abs(times) <= limit)]
        raise LagtopError(
            f"{name} must be finite and within 2^50 periods = {limit:.3g}, got {bad.flat[0]}", name
        )


class ConstantSampler(Sampler):
    """A constant tilt and constant rates of spin and precession."""

    def __init__(self, motion: Constant[Any]) -> None:
        rates = motion.mean_spin_rate, motion.state.psi_rate
        super().__init__(motion, rates)
        self.x, self.y = near(motion.state.cos_half), near(motion.state.sin_half)
        self.max_time = _reach(rates)

    def attitude(self, t: Array, farthest: float, space: Array) -> Attitude:
        """Return the attitude, which has no phase."""
        tilt, *moduli = (np.full_like(t, x) for x in (self.tilt, self.x**2, self.y**2))
        zero = np.zeros_like(t)
        parts = {"tilt": tilt, "moduli": moduli, "args": (zero, zero), "rate": zero}
        return Attitude(self, t, farthest, space, **parts)


class SeparatrixSampler(Sampler):
    """The single swing from the upright position down and up again: k = 1, T infinite."""

    def __init__(self, motion: Separatrix[Any]) -> None:
        offset, x, y, start = separatrix_constants(motion)
        speed = motion.argument_rate
        rates = motion.r0 - motion.b / 2, motion.b / 2
        super().__init__(motion, rates, (start, 0))
        self.speed, self.offset, self.x, self.y = map(near, (speed, offset, x, y))
        self.max_time = _reach((*rates, speed))

    def attitude(self, t: Array, farthest: float, space: Array) -> Attitude:
        """Return the attitude: 1 - u = (1 - u2)/cosh^2 h, with h = 0 at the lowest point."""
        h = t * self.speed + self.offset
        shrink = np.exp(-np.abs(h))
        sech, tanh = 2.0 * shrink / (1.0 + shrink * shrink), np.tanh(h)
        real, imag, y = np.full_like(h, self.x), self.y * tanh, self.y * sech
        x2, y2 = real * real + imag * imag, y * y
        args, rate = (np.arctan2(imag, real), np.zeros_like(h)), -4.0 * self.speed * y2 * tanh
        parts = {"tilt": tilt_of(x2, y2, h), "moduli": (x2, y2), "args": args, "rate": rate}
        return Attitude(self, t, farthest, space, **parts)


class ThetaSampler(Sampler):
    """Sampler of a nutating top, by its theta series."""

    def __init__(self, motion: Nutating[Any]) -> None:
        ar: Any = motion.ar
        series, period = theta_series(motion), motion.T_nutation
        _, x, _, y = evaluate(ar, series, 0, series.offset, direction(motion))
        starts = x + series.slopes[0] * series.offset, y + series.slopes[1] * series.offset
        super().__init__(motion, (motion.mean_spin_rate, motion.mean_precession_rate), starts)
        self.max_time = near(int(MAX_PERIODS) * period)
        self.step = period_of(pair((period / 2).middle), near(2 / period))
        """Half the period of the nutation."""
        self.offset, self.scale = near(series.offset), near(series.scale)
        self.speed = near(series.scale * 2 / period)
        """Argument per unit of time."""
        self.first = near(series.scale * series.offset)
        """Argument at t = 0."""
        self.hyperbolic, self.first_point = series.hyperbolic, series.first
        self.slopes = [near(slope / series.scale) for slope in series.slopes]
        """Slopes per unit of the argument that are added to arg X and arg Y."""
        # the greatest s, sin^2 or sinh^2, is at the end of a step, half of `scale` from 0
        greatest = ar.exp(series.scale) / 4 if series.hyperbolic else ar.convert(0.5)
        self.frames = [_kept(ar, frame, greatest.middle) for frame in series.frames]
        """The series about the turning points of the even and of the odd steps."""
        self.over_a_pole = not all(part[0] for frame in self.frames for part in frame.parts[::2])
        """Whether the axis passes over a pole: a first real coefficient of X or Y is then 0."""


def sampler_of(motion: Kind[Any]) -> Sampler:
    """Return the sampler of a motion in balls of many digits."""
    with motion.ar.working():
        if isinstance(motion, Nutating):
            return ThetaSampler(motion)
        if isinstance(motion, Separatrix):
            return SeparatrixSampler(motion)
        return ConstantSampler(motion)


def _kept(ar: Any, frame: Frame, greatest: Any) -> Frame:
    """Return a frame in doubles without negligible coefficients; the largest is about `_SIZE`.

    X and Y may have any common factor.  This factor keeps all coefficients in the range of doubles.
    `greatest` is the largest value of s.
    """
    exponent = math.frexp(max(abs(near(part[0])) for part in frame.parts))[1]
    factor = ar.convert(_SIZE / Fraction(2) ** exponent)

    def kept(coefficients: Coefficients, factor: Any) -> list[float]:
        middles = [x.middle for x in coefficients]
        least, count = abs(middles[0]) * _NEGLIGIBLE, len(middles)
        while count > 2 and abs(middles[count - 1]) * power(greatest, count - 1) <= least:
            count -= 1
        return [near(x * factor) for x in middles[:count]]

    parts = tuple(kept(part, factor) for part in frame.parts)
    return Frame(parts, kept(frame.rate, power(factor, 4)))


def _write_polynomial(coefficients: Sequence[float], x: Array, value: Array) -> None:
    """Write the value of a polynomial with at least two coefficients, the lowest power first."""
    np.multiply(x, coefficients[-1], out=value)
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]


def _reach(rates: Sequence[Any]) -> float:
    """Return the time of 2^50 radians at the largest rate."""
    rate = max(abs(near(rate)) for rate in rates)
    return MAX_PERIODS / rate if rate else math.inf


def tilt_of(x2: Array, y2: Array, out: Array) -> Array:
    """Return 2 arctan(|Y|/|X|)."""
    np.divide(y2, x2, out=out)
    np.sqrt(out, out=out)
    np.arctan(out, out=out)
    out *= 2.0
    return out
