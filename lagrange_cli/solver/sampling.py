"""Tilt, spin and precession at arrays of times: about one ulp at any time.

The attitude is the pair of complex numbers X and Y that `attitude` defines.

1. A time is reduced, exactly, to whole half periods of the nutation and a phase (`whole_periods`).
2. The times nearer to u1 and those nearer to u2 are evaluated apart (`ThetaParts.at`).
3. Real and imaginary part of X and of Y are polynomials (`series`); they vanish separately where
   the axis passes over a pole, so that no digits cancel (`ThetaParts.about`).
4. One arctangent each gives the tilt and the periodic parts of arg X and arg Y (`_FORMULAS`).
5. A mean rate times t is added to each angle (`Growth`).

All constants are computed in many digits and rounded once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from flint import arb
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.arrays import BLOCK, doubles_of
from ..arithmetic.enclosures import TooFewDigitsError, nearest
from ..arithmetic.pairs import pair
from ..arithmetic.types import Array
from ..errors import LagtopError, OutOfRangeError
from ..names import ANGLES
from ..top.ranges import MAX_PERIODS, MAX_TIME
from .attitude import Course, Nutation
from .columns import FORMULAS, REDUCED, WITHIN_A_TURN, WITHOUT_ATTITUDE, Columns
from .series import Frame, near, theta_series

MOST_TURNS = 2.0**51
"""Number of turns beyond which no double holds an angle within a turn."""
FIRST_DIGITS = 24
"""Digits of mean rates and periods: 2^50 periods use 16 of them, and a double 16 more."""
_SHARP = 2.0**-106
"""Largest error of a constant in two doubles, relative to its size."""
_EXACT = 2.0**26
"""Whole numbers below it have exact products with the parts of a period."""
_STEEPEST = 340.0
"""Greatest argument of sinh: its square does not overflow in later products."""
_TINY = 5e-324
"""The smallest argument that is not 0."""
_LEAST, _MOST = 2.0**-900, 2.0**900
"""Sizes of constants between which no product or part of a constant is a subnormal double."""
Index = slice | NDArray[np.intp]
ItemsAt = Callable[[Array, float], Iterator[tuple[Index, dict[str, Any]]]]
"""A function of times and of max |t| that yields the items of formulas at some times, by index.

Among them are the parts of X and Y, up to a common positive factor.  No real part is negative.
"""


def is_ordinary(*numbers: arb) -> bool:
    """Return whether doubles can compute with some numbers: each is 0 or neither tiny nor huge."""
    return all(x.contains(0) or _LEAST < abs(float(x.mid())) < _MOST for x in numbers)


class Angles(NamedTuple):
    """Tilt, spin and precession in radians, each a float64 array in the shape of the times."""

    theta: Array
    phi: Array
    psi: Array


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
    long, low = pair(length)
    mantissa, exponent = math.frexp(long)
    high = math.ldexp(math.trunc(mantissa * _EXACT), exponent - 26)
    return Period(near(1 / length), high, long - high, low)


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


class Growth:
    """The growth of an angle from 0 at t = 0: a mean rate times t, and a periodic part."""

    def __init__(self, rate: arb, start: arb, unit: arb, turns: float = 1.0) -> None:
        """Take the mean rate, the periodic part at t = 0, a unit of time, and the turns of a cycle.

        Raises TooFewDigitsError if one of them is not known to twice the precision of doubles.
        """
        cycle = 2 * turns * arb.pi()
        for x in (rate * unit, start, cycle):
            if not (x.is_finite() and float(x.rad()) <= _SHARP * (1 + abs(float(x.mid())))):
                raise TooFewDigitsError
        self.start, self.rate, self.cycle = map(pair, (start, rate, cycle))
        self.time = period_of(cycle / rate if not rate.contains(0) else arb("inf"))
        """The time of a cycle at the mean rate."""

    def wave(self, periodic: Array) -> Array:
        """Return the periodic part of an angle less its value at t = 0."""
        return (periodic - self.start[0]) - self.start[1] if self.start[0] else periodic

    def angle(self, periodic: Array, t: Array) -> Array:
        """Return the angle from its periodic part."""
        return (self.wave(periodic) + t * self.rate[1]) + t * self.rate[0]

    def reduced(self, periodic: Array, t: Array) -> tuple[Array, Array]:
        """Return the angle less n cycles, in (-cycle/2, cycle/2], and n."""
        wave, farthest = self.wave(periodic), float(np.abs(t).max(initial=0.0))
        more = wave / self.cycle[0] if self.time.rate else 0.0
        n, rest, lost = whole_periods(t, self.time, farthest, more)
        angle = wave + rest * self.rate[0]
        angle += rest * self.rate[1] - lost * self.rate[0]
        more = np.rint(angle / self.cycle[0])
        angle = (angle - more * self.cycle[0]) - more * self.cycle[1]
        half = self.cycle[0] / 2
        low = angle <= -half
        return np.where(low, half, np.minimum(angle, half)), n + more - low


def polynomial(coefficients: Sequence[float], x: Array) -> Array:
    """Return the value of a polynomial with at least two coefficients, the lowest power first."""
    value = coefficients[-1] * x
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]
    return value


def _argument(real: Array, imag: Array) -> Array:
    """Return the argument of X or Y, whose real part is not negative.

    If the real part is 0 at all times, the sign of the imaginary part decides, even if it is 0.
    """
    return np.arctan(imag / real) if real.any() else np.copysign(np.pi / 2, imag)


_FUNCTIONS: dict[str, Any] = {
    **{"cos": np.cos, "sin": np.sin, "sqrt": np.sqrt, "square": np.square, "arctan": np.arctan},
    **{"polynomial": polynomial, "argument": _argument, "maximum": np.maximum},
    "copysign": np.copysign,
    "ratio": lambda x, y, otherwise=0.0: np.where(y != 0.0, x / y, otherwise),
}
_FORMULAS = FORMULAS | {
    "XX": "square(re_X) + square(im_X)",
    "YY": "square(re_Y) + square(im_Y)",
    "X": "sqrt(XX)",
    "Y": "sqrt(YY)",
    "tilt": "2*arctan(sqrt(YY/XX))",
    # the periodic parts of arg X and of arg Y
    "arg_X": "argument(re_X, im_X) + x*slope_X",
    "arg_Y": "argument(re_Y, im_Y) + x*slope_Y",
    "spin": "of_spin.angle(arg_X - arg_Y, t)",
    "spin_wave": "of_spin.wave(arg_X - arg_Y)",
    "spin_turn": "of_spin.reduced(arg_X - arg_Y, t)[0]",
    "precession": "of_precession.angle(arg_X + arg_Y, t)",
    "precession_wave": "of_precession.wave(arg_X + arg_Y)",
    "precession_turn": "of_precession.reduced(arg_X + arg_Y, t)[0]",
    "reduced_X": "of_X.reduced(arg_X, t)",
    "angle_X": "reduced_X[0]",
    "signed_X": "X*(1 - 2*(reduced_X[1] % 2))",
    "reduced_Y": "of_Y.reduced(arg_Y, t)",
    "angle_Y": "reduced_Y[0]",
    "signed_Y": "Y*(1 - 2*(reduced_Y[1] % 2))",
    # the nutation rate times 2 N X Y
    "scaled_rate": "polynomial(rate_series, s_x)*S_x*C_x",
    "nutation_rate": "ratio(scaled_rate, 2*N*X*Y, copysign(rate_on_pole, scaled_rate))",
    "rate_on_pole": "sqrt(maximum(energy_constant - a*u, 0))",  # (4,2)
}


class ThetaParts:
    """The parts of X and Y of a top that nutates, by its theta series."""

    def __init__(self, of: Nutation) -> None:
        (frames, scale, slopes), step = theta_series(of), nearest(2 * of.since)
        offset = 2 * of.since - step
        self.frames = frames[:: -1 if step % 2 else 1]
        """The series about the turning points of the even and of the odd steps."""
        self.half = period_of(of.period / 2)
        self.offset = near(offset)
        """Half periods from the turning point of step 0 to t = 0, from -1/2 to 1/2."""
        self.speed = near(2 * scale / of.period)
        """Argument of the series per unit of time."""
        self.first = near(scale * offset)
        """Argument at t = 0."""
        self.slopes = {f"slope_{x}": near(y / scale) for x, y in zip("XY", slopes, strict=True)}
        """Rates, per unit of the argument, that make arg X and arg Y periodic when added."""
        self.over_pole = not all(part[0] for frame in self.frames for part in frame.parts[::2])
        self.hyperbolic, self.steep = of.hyperbolic, near(scale) > 2 * _STEEPEST

    def at(self, t: Array, farthest: float) -> Iterator[tuple[Index, dict[str, Any]]]:
        """Yield the parts about even and about odd turning points."""
        step, rest, lost = whole_periods(t, self.half, farthest, self.offset)
        x = (rest - lost) * self.speed + self.first
        if self.over_pole:  # just before or after a passage, or a start
            x = np.where(x == 0.0, np.copysign(_TINY, t), x)
        half = 0.5 * step
        even = half == np.rint(half)
        for frame, chosen in zip(self.frames, (even, ~even), strict=True):
            index = np.flatnonzero(chosen)
            if index.size == t.size:
                yield slice(None), self.about(frame, x)
            elif index.size:
                yield index, self.about(frame, x[index])

    def about(self, frame: Frame, x: Array) -> dict[str, Any]:
        """Return the parts at arguments x of the series about one turning point."""
        if self.hyperbolic:
            S = np.sinh(np.clip(x, -_STEEPEST, _STEEPEST) if self.steep else x)
            s = S * S
            C = np.sqrt(s + 1.0)
        else:
            S = np.tan(x)
            s = S * S
            C = s + 1.0  # 1/cos^2
            s /= C
        a, b, c, d = (polynomial(part, s) for part in frame.parts)
        b *= S
        d *= S
        if self.hyperbolic:
            one, other = (b, c) if frame.at_u1 else (a, d)
            one *= C
            other *= C
        named = {"re_X": a, "im_X": b, "re_Y": c, "im_Y": d, "rate_series": frame.rate}
        return named | {"x": x, "S_x": S, "C_x": C, "s_x": s} | self.slopes


def swing_parts(
    constants: Sequence[float], tilt: float, t: Array, farthest: float
) -> Iterator[tuple[Index, dict[str, Any]]]:
    """Yield the parts of X and Y on the separatrix at all times.

    1 - u = (1 - u2)/cosh^2 h, h = rate t + h0.  The constants are those of `SingleSwing`: x, y,
    rate and h0.  A constant tilt is a swing at the rate 0; only then `tilt` is used.
    """
    x, y, rate, h0 = constants
    h = t * rate + h0
    shrink = np.exp(-np.abs(h))
    Y, tanh = y * (2.0 * shrink / (1.0 + shrink * shrink)), np.tanh(h)
    real, imag, zero = np.full_like(h, x), y * tanh, np.zeros_like(h)
    found = {"re_X": real, "im_X": imag, "re_Y": Y, "im_Y": zero}
    found |= {"arg_X": np.arctan2(imag, real), "arg_Y": zero}
    found["scaled_rate"] = -4.0 * rate * Y * Y * tanh
    yield slice(None), found if rate else found | {"tilt": np.full_like(h, tilt)}


class Sampler:
    """The angles and columns of one motion over time, in doubles.

    If `is_ordinary` is false, a constant is too large or too small for doubles: only `check` works.
    """

    def __init__(self, of: Course, tilt: arb) -> None:
        """Take the constants of a motion and its tilt at t = 0.

        Raises TooFewDigitsError if a constant is not known to the digits that are needed.
        """
        unit, (x, y), spin, precession = of.unit, of.start, of.spin, of.precession
        self.tilt = float(tilt.mid())
        self.max_time = min(float((int(MAX_PERIODS) * unit).mid()), MAX_TIME)
        fastest = max(abs(float(x.mid())) for x in (spin, precession))
        self.max_wrapped = MOST_TURNS * 2 * math.pi / fastest if fastest else math.inf
        sizes = [x.size for x in of.sides] if isinstance(of, Nutation) else [of.x, of.y]
        rates = [spin, precession, precession + spin, precession - spin]
        rates += [] if isinstance(of, Nutation) else [of.rate]
        constants = [unit, *rates, *(x * unit for x in rates), *(x * x for x in sizes)]
        self.is_ordinary = is_ordinary(*constants)
        if not self.is_ordinary:
            return
        self.spin, self.precession = Growth(spin, x - y, unit), Growth(precession, x + y, unit)
        of_X = Growth((precession + spin) / 2, x, unit, 0.5)
        of_Y = Growth((precession - spin) / 2, y, unit, 0.5)
        self.known = _FUNCTIONS | {"of_spin": self.spin, "of_precession": self.precession}
        self.known |= {"of_X": of_X, "of_Y": of_Y}
        """The items of formulas that do not depend on time."""
        if isinstance(of, Nutation):
            self.parts: ItemsAt = ThetaParts(of).at
        else:
            constants = [near(x) for x in (of.x, of.y, of.rate, of.h0)]
            self.parts = partial(swing_parts, constants, self.tilt)

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

    def evaluate(
        self, t: Array, names: Sequence[str], *, wrap: bool = False, **known: Any
    ) -> Array:
        """Return columns at times, of shape (names, times), from the constants that they need.

        Raises LagtopError for a time out of range.
        """
        names = [REDUCED.get(name, name) for name in names] if wrap else names
        farthest = self.check(t, wrap=not WITHIN_A_TURN.isdisjoint(names))
        moves, found = not WITHOUT_ATTITUDE.issuperset(names), np.empty((len(names), t.size))
        known |= self.known
        with np.errstate(all="ignore"):
            for first in range(0, t.size, BLOCK):  # short arrays stay in the cache
                block, rows = t[first : first + BLOCK], found[:, first : first + BLOCK]
                for index, items in self.parts(block, farthest) if moves else [(slice(None), {})]:
                    columns = Columns(_FORMULAS, known | items | {"t": block[index]})
                    for row, name in zip(rows, names, strict=True):
                        row[index] = columns[name]
        return found

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Return tilt, spin and precession at the times t; see `Motion.angles`."""
        times = doubles_of("t", t)
        flat = times.reshape(-1)
        angles = self.evaluate(flat, ANGLES, wrap=wrap)
        angles[:, np.flatnonzero(flat == 0.0)] = [[self.tilt], [0.0], [0.0]]
        return Angles(*angles.reshape(3, *times.shape))
