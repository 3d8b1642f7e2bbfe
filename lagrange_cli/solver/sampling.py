"""Tilt, spin and precession at arrays of times: about one ulp at any time.

The attitude is a pair of complex numbers, the Cayley-Klein parameters:

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

1. A time is reduced, exactly, to whole half periods of the nutation and a phase (`whole_periods`).
2. The times nearer to u1 and those nearer to u2 are evaluated apart (`ThetaSampler.attitudes`).
3. Real and imaginary part of X and of Y are polynomials (`series`); they vanish separately where
   the axis passes over a pole, so that no digits cancel (`ThetaAttitude`).
4. One arctangent each gives the tilt and the periodic parts of arg X and arg Y (`Attitude`).
5. A mean rate times t is added to each angle (`Growth`).

All constants are computed in many digits and rounded once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from flint import arb
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.arrays import BLOCK, doubles_of
from ..arithmetic.enclosures import TooFewDigitsError, decided, nearest
from ..arithmetic.types import Array
from ..errors import LagtopError, OutOfRangeError
from ..top.ranges import MAX_PERIODS, MAX_TIME
from .attitude import ConstantTilt, Course, Nutation, SingleSwing
from .facts import Facts
from .series import Frame, near, theta_series

MOST_TURNS = 2.0**51
"""Number of turns beyond which no double holds an angle within a turn."""
_DIGITS = 24
"""Digits of mean rates and periods: 2^50 periods use 16 of them, and a double 16 more."""
_SHARP = 2.0**-106
"""Largest error of a constant in two doubles, relative to its size."""
_EXACT = 2.0**26
"""Whole numbers below it have exact products with the parts of a period."""
_STEEPEST = 340.0
"""Greatest argument of sinh: its square does not overflow in later products."""


class Angles(NamedTuple):
    """Tilt, spin and precession in radians, each a float64 array in the shape of the times."""

    theta: Array
    phi: Array
    psi: Array


class Pair(NamedTuple):
    """A number as the sum of two doubles."""

    high: float
    low: float


class Period(NamedTuple):
    """The length of a period as the sum of three doubles; the first two have 26 and 27 bits."""

    rate: float
    """Periods per unit of time; 0 if the length is infinite."""
    high: float
    middle: float
    low: float


def period_of(length: arb) -> Period:
    """Return a period from its length, which is positive, negative or infinite.

    Raises TooFewDigitsError if the length is not known to twice the precision of doubles.
    """
    if not length.is_finite():
        return Period(0.0, 0.0, 0.0, 0.0)
    if length.rel_accuracy_bits() < -math.log2(_SHARP):
        raise TooFewDigitsError
    long, low = pair_of(length)
    mantissa, exponent = math.frexp(long)
    high = math.ldexp(math.trunc(mantissa * _EXACT), exponent - 26)
    return Period(float((1 / length).mid()), high, long - high, low)


def pair_of(x: arb) -> Pair:
    """Return the middle of a ball as the sum of two doubles."""
    high = float(x.mid())
    return Pair(high, float((x.mid() - high).mid()) if math.isfinite(high) else 0.0)


def whole_periods(
    t: Array, period: Period, farthest: float, more: float | Array = 0.0
) -> tuple[Array, Array, Array]:
    """Return the integer n nearest to t/period + `more`, and t - n period as a difference.

    The first part of the difference is exact, and the second is tiny.  `farthest` is the largest
    |t|; n must not exceed 2^51.
    """
    n = np.rint(t * period.rate + more)
    if farthest * abs(period.rate) < _EXACT:
        return n, (t - n * period.high) - n * period.middle, n * period.low
    many = np.rint(n / _EXACT) * _EXACT
    few, rest = n - many, t
    for part in (period.high, period.middle):
        rest = (rest - many * part) - few * part
    lost = n * period.low
    # t/period was rounded, perhaps to a neighbour of the nearest integer
    missed = np.rint(((rest - lost) * period.rate + more) * (1 - 2.0**-20))
    rest = (rest - missed * period.high) - missed * period.middle
    return n + missed, rest, lost + missed * period.low


class Growth(NamedTuple):
    """The growth of an angle from 0 at t = 0: a mean rate times t, and a periodic part."""

    start: Pair
    """The periodic part at t = 0."""
    rate: Pair
    cycle: Pair
    """A turn or, for arg X and arg Y, half a turn."""
    time: Period
    """The time of a cycle at the mean rate."""

    def wave(self, periodic: Array, t: Array) -> Array:
        """Return the periodic part of an angle less its value at t = 0."""
        return (periodic - self.start.high) - self.start.low if self.start.high else periodic

    def angle(self, periodic: Array, t: Array) -> Array:
        """Return the angle from its periodic part."""
        return (self.wave(periodic, t) + t * self.rate.low) + t * self.rate.high

    def within_a_cycle(self, periodic: Array, t: Array) -> tuple[Array, Array]:
        """Return the angle less n cycles, at most half a cycle in size, and n."""
        wave, farthest = self.wave(periodic, t), float(np.abs(t).max(initial=0.0))
        n, rest, lost = whole_periods(t, self.time, farthest, wave / self.cycle.high)
        angle = wave + rest * self.rate.high
        angle += rest * self.rate.low - lost * self.rate.high
        more = np.rint(angle / self.cycle.high)
        return (angle - more * self.cycle.high) - more * self.cycle.low, n + more

    def within_a_turn(self, periodic: Array, t: Array) -> Array:
        """Return the angle in (-pi, pi]."""
        angle, _ = self.within_a_cycle(periodic, t)
        return np.where(angle > -np.pi, np.minimum(angle, np.pi), np.pi)


def growth_of(rate: arb, start: arb, unit: arb, turns: float = 1.0) -> Growth:
    """Return the growth of an angle from its mean rate and its periodic part at t = 0.

    Raises TooFewDigitsError if one of them, the rate times a unit of time, is not known to twice
    the precision of doubles.
    """
    cycle = 2 * turns * arb.pi()
    for x in (rate * unit, start, cycle):
        if not (x.is_finite() and float(x.rad()) <= _SHARP * (1 + abs(float(x.mid())))):
            raise TooFewDigitsError
    time = cycle / rate if not rate.contains(0) else arb("inf")
    return Growth(pair_of(start), pair_of(rate), pair_of(cycle), period_of(time))


Index = slice | NDArray[np.intp]


class Attitude:
    """X and Y at some times, up to a common positive factor; each part is computed on first use.

    Subclasses have `parts`: Re X, Im X, Re Y, Im Y, where neither real part is negative; `args`:
    the periodic parts of arg X and arg Y; and `rate`: the nutation rate times 2 (|X|^2 + |Y|^2)
    |X| |Y|.
    """

    parts: Any
    args: Any
    rate: Any

    def __init__(self, sampler: Sampler, t: Array) -> None:
        self.sampler, self.t = sampler, t

    @cached_property
    def moduli(self) -> tuple[Array, Array]:
        """|X|^2 and |Y|^2."""
        a, b, c, d = self.parts
        return a * a + b * b, c * c + d * d

    @cached_property
    def tilt(self) -> Array:
        """The tilt, 2 arctan(|Y|/|X|)."""
        x, y = self.moduli
        return 2.0 * np.arctan(np.sqrt(y / x))

    def phi(self, of: Callable[[Growth, Array, Array], Array] = Growth.angle) -> Array:
        """Return the spin, arg X - arg Y, by a method of `Growth`."""
        return of(self.sampler.phi, self.args[0] - self.args[1], self.t)

    def psi(self, of: Callable[[Growth, Array, Array], Array] = Growth.angle) -> Array:
        """Return the precession, arg X + arg Y, by a method of `Growth`."""
        return of(self.sampler.psi, self.args[0] + self.args[1], self.t)

    def halves(self) -> list[tuple[Array, Array]]:
        """Return arg X and arg Y, each less n half turns, with n."""
        pairs = zip(self.sampler.halves, self.args, strict=True)
        return [growth.within_a_cycle(arg, self.t) for growth, arg in pairs]


class Sampler:
    """The angles of one motion over time; subclasses yield the attitude at arrays of times."""

    half = Period(0.0, 0.0, 0.0, 0.0)
    """Half the period of the nutation, infinite if there is none."""

    def __init__(self, of: Course, tilt: float) -> None:
        """Take the constants of a motion and its tilt at t = 0."""
        unit, (x, y), spin, precession = of.unit, of.start, of.spin, of.precession
        self.phi = growth_of(spin, x - y, unit)
        self.psi = growth_of(precession, x + y, unit)
        plus, minus = (precession + spin) / 2, (precession - spin) / 2
        self.halves = growth_of(plus, x, unit, 0.5), growth_of(minus, y, unit, 0.5)
        self.tilt = tilt
        self.max_time = min(float((int(MAX_PERIODS) * unit).mid()), MAX_TIME)
        fastest = max(abs(self.phi.rate.high), abs(self.psi.rate.high))
        self.max_wrapped = MOST_TURNS * 2 * math.pi / fastest if fastest else math.inf

    def attitudes(self, t: Array, farthest: float) -> Iterator[tuple[Index, Attitude]]:
        """Yield the attitude at some of the times, with their index; `farthest` is max |t|."""
        raise NotImplementedError

    def evaluate(
        self, t: Array, farthest: float, count: int, compute: Callable[[Attitude], Sequence[Any]]
    ) -> Array:
        """Return `count` numbers of the attitude at times, of shape (count, times).

        Blocks of times are short, so that their arrays stay in the cache.
        """
        found = np.empty((count, t.size))
        with np.errstate(all="ignore"):
            for first in range(0, t.size, BLOCK):
                block, rows = t[first : first + BLOCK], found[:, first : first + BLOCK]
                for index, at in self.attitudes(block, farthest):
                    for row, values in zip(rows, compute(at), strict=True):
                        row[index] = values
        return found

    def check(self, t: ArrayLike, name: str = "t", *, wrap: bool = False) -> float:
        """Return the greatest |t|.

        Raises LagtopError, with the `name` of the argument, if a time is not finite or too large.
        """
        times = doubles_of("t", t)
        low, high = float(times.min(initial=0.0)), float(times.max(initial=0.0))
        limit = min(self.max_time, self.max_wrapped if wrap else math.inf)
        if low >= -limit and high <= limit:
            return max(-low, high)
        bad = float(times[~(abs(times) <= limit)].flat[0])
        bound = f"finite and within 2^50 periods = {limit:.3g}"
        if abs(bad) <= self.max_time:
            bound = f"within 2^51 turns = {limit:.3g} to have angles within a turn"
        kind = OutOfRangeError if math.isfinite(bad) else LagtopError
        raise kind(f"{name} must be {bound}, got {bad}", name)

    def angles(self, t: ArrayLike, *, wrap: bool = False, waves: bool = False) -> Angles:
        """Return tilt, spin and precession at the times t; see `Motion.angles`.

        As `waves`, spin and precession are less their mean rates times t.
        """
        times, farthest = doubles_of("t", t), self.check(t, wrap=wrap)
        how = Growth.within_a_turn if wrap else Growth.wave if waves else Growth.angle
        flat = times.reshape(-1)
        angles = self.evaluate(flat, farthest, 3, lambda at: (at.tilt, at.phi(how), at.psi(how)))
        angles[:, np.flatnonzero(flat == 0.0)] = [[self.tilt], [0.0], [0.0]]
        return Angles(*angles.reshape(3, *times.shape))


class ThetaSampler(Sampler):
    """The angles of a top that nutates, by its theta series."""

    def __init__(self, of: Nutation, tilt: float) -> None:
        super().__init__(of, tilt)
        series = theta_series(of)
        step = nearest(2 * of.since)
        offset = 2 * of.since - step
        self.frames = series.frames[:: -1 if step % 2 else 1]
        """The series about the turning points of the even and of the odd steps."""
        self.half = period_of(of.period / 2)
        self.offset = near(offset)
        """Half periods from the turning point of step 0 to t = 0, from -1/2 to 1/2."""
        self.speed = near(2 * series.scale / of.period)
        """Argument of the series per unit of time."""
        self.first = near(series.scale * offset)
        """Argument at t = 0."""
        self.slopes = [near(slope / series.scale) for slope in series.slopes]
        """What is added to arg X and arg Y per unit of the argument to make them periodic."""
        self.hyperbolic, self.steep = of.hyperbolic, near(series.scale) > 2 * _STEEPEST

    def attitudes(self, t: Array, farthest: float) -> Iterator[tuple[Index, Attitude]]:
        """Yield the attitude about even and about odd turning points."""
        step, rest, lost = whole_periods(t, self.half, farthest, self.offset)
        x = (rest - lost) * self.speed + self.first
        half = 0.5 * step
        even = half == np.rint(half)
        for frame, chosen in zip(self.frames, (even, ~even), strict=True):
            index = np.flatnonzero(chosen)
            if index.size == t.size:
                yield slice(None), ThetaAttitude(self, t, x, frame)
            elif index.size:
                yield index, ThetaAttitude(self, t[index], x[index], frame)


class ThetaAttitude(Attitude):
    """X and Y at arguments x of the series about one turning point."""

    sampler: ThetaSampler

    def __init__(self, sampler: ThetaSampler, t: Array, x: Array, frame: Frame) -> None:
        super().__init__(sampler, t)
        self.x, self.frame = x, frame

    @cached_property
    def functions(self) -> tuple[Array, Array, Array]:
        """S, C and s; of circular series C is 1/cos^2."""
        if self.sampler.hyperbolic:
            x = np.clip(self.x, -_STEEPEST, _STEEPEST) if self.sampler.steep else self.x
            S = np.sinh(x)
            s = S * S
            return S, np.sqrt(s + 1.0), s
        S = np.tan(self.x)
        s = S * S
        C = s + 1.0
        return S, C, s / C

    @cached_property
    def parts(self) -> tuple[Array, Array, Array, Array]:
        """Re X, Im X, Re Y, Im Y."""
        S, C, s = self.functions
        a, b, c, d = (polynomial(part, s) for part in self.frame.parts)
        b *= S
        d *= S
        if self.sampler.hyperbolic:
            one, other = (b, c) if self.frame.at_u1 else (a, d)
            one *= C
            other *= C
        return a, b, c, d

    @cached_property
    def args(self) -> list[Array]:
        """The periodic parts of arg X and arg Y."""
        found = []
        for side, slope in enumerate(self.sampler.slopes):
            real, imag = self.parts[2 * side : 2 * side + 2]
            if self.frame.parts[2 * side][0]:
                arg = np.arctan(imag / real)
            else:  # a passage over the pole, or a start on it
                after = np.where(self.x == 0.0, self.t, self.x)
                arg = np.copysign(np.pi / 2, after * self.frame.parts[2 * side + 1][0])
            found.append(arg + self.x * slope)
        return found

    @property
    def rate(self) -> Array:
        """2 (|X|^2 + |Y|^2) |X| |Y| times the nutation rate."""
        S, C, s = self.functions
        return polynomial(self.frame.rate, s) * S * C


def polynomial(coefficients: Sequence[float], x: Array) -> Array:
    """Return the value of a polynomial with at least two coefficients, the lowest power first."""
    value = coefficients[-1] * x
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]
    return value


class SwingSampler(Sampler):
    """The single swing on the separatrix; a constant tilt, which is one at the rate 0."""

    def __init__(self, of: SingleSwing | ConstantTilt, tilt: float) -> None:
        super().__init__(of, tilt)
        self.constants = [near(x) for x in (of.x, of.y, of.rate, of.h0)]

    def attitudes(self, t: Array, farthest: float) -> Iterator[tuple[Index, Attitude]]:
        """Yield the attitude at all times: 1 - u = (1 - u2)/cosh^2 h, lowest at h = 0."""
        x, y, rate, h0 = self.constants
        h = t * rate + h0
        shrink = np.exp(-np.abs(h))
        Y, tanh = y * (2.0 * shrink / (1.0 + shrink * shrink)), np.tanh(h)
        at, real, imag, zero = Attitude(self, t), np.full_like(h, x), y * tanh, np.zeros_like(h)
        at.parts, at.args = (real, imag, Y, zero), (np.arctan2(imag, real), zero)
        at.rate = -4.0 * rate * Y * Y * tanh
        if not rate:
            at.tilt = np.full_like(h, self.tilt)
        yield slice(None), at


def sampler_of(facts: Facts, balls: Callable[[int], Mapping[str, Any]]) -> Sampler:
    """Return the sampler of a motion, from its facts and its numbers in balls of some digits.

    Its constants are computed in as many digits as they need.
    """

    def sampler(digits: int) -> Sampler:
        course, tilt = balls(digits)["course"], near(facts.tilt.angle())
        nutates = isinstance(course, Nutation)
        return ThetaSampler(course, tilt) if nutates else SwingSampler(course, tilt)

    return decided(sampler, facts.equal, digits=_DIGITS)
