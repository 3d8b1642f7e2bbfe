"""Arithmetic on unevaluated sums of two doubles, about 104 bits (Dekker 1971).

The product of a double and a constant held as two doubles gives the whole periods that have passed.
It also gives the remaining time exactly, however large the time is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from .types import Array, Mask

_ZERO = np.zeros(())
MANY = 2.0**26
_LESS_THAN_1 = 1 - 2.0**-20


class Pair(NamedTuple):
    """A number, or an array of numbers, as the sum of two doubles."""

    high: float | Array
    low: float | Array


class Triple(NamedTuple):
    """A number as the sum of three doubles."""

    high: float | Array
    middle: float | Array
    low: float | Array


PI = Triple(3.141592653589793, 1.2246467991473532e-16, -2.9947698097183397e-33)


def pair(value: Any) -> Pair:
    """Return a fraction or a ball as the sum of two doubles."""
    high = float(value)
    return Pair(high, float(_less(value, high)))


def triple(value: Any) -> Triple:
    """Return a fraction or a ball as the sum of three doubles."""
    high = float(value)
    return Triple(high, *pair(_less(value, high)))


def _less(value: Any, part: float) -> Any:
    return value - (Fraction(part) if isinstance(value, Fraction) else part)


def two_product(x: float | Array, y: float | Array) -> tuple[Array, Array]:
    """Return x * y and its rounding error, exactly (Dekker)."""
    product: Array = np.multiply(x, y)
    (x_high, x_low), (y_high, y_low) = _halves(x), _halves(y)
    error = x_high * y_high
    error = error - product
    error += x_high * y_low
    error += x_low * y_high
    error += x_low * y_low
    return product, error


def _halves(x: float | Array) -> tuple[Array, Array]:
    """Return numbers as sums of two numbers with 26 bits."""
    bits = np.asarray(x, dtype=np.float64).view(np.int64)
    high: Array = ((bits + (1 << 26)) & -(1 << 27)).view(np.float64)
    return high, x - high


def reduce_phase(t: Array, rate: Pair) -> tuple[Array, Array]:
    """Return the integer nearest to t * rate, and t * rate less it, with all digits."""
    since, rest = two_product(t, rate.high)
    rest += t * rate.low
    step: Array = np.rint(since)
    return step, (since - step) + rest


def fraction_of_product(t: Array, rate: Triple) -> Array:
    """Return t * rate minus the nearest whole number, without cancellation."""
    total, lost = t * rate.low, np.zeros_like(t)
    for part in (rate.middle, rate.high):
        for term in two_product(t, part):
            total, more = two_sum(total, term - np.rint(term))
            lost += more
    return (total - np.rint(total)) + lost


class Period(NamedTuple):
    """The length of a period as the sum of three doubles, or of three arrays.

    Products of the first two parts with whole numbers below 2^26 are exact, because the parts have
    26 and 27 bits.
    """

    rate: float | Array
    """Periods per unit of time."""
    high: float | Array
    middle: float | Array
    low: float | Array
    reach: float
    """Time up to which the number of periods is below 2^26."""


def period_of(length: Pair, rate: float | Array) -> Period:
    """Return a period, or one per top, from its length and rate = 1/length.

    The period is infinite if the rate is 0.
    """
    long, low = (np.where(np.isfinite(length.high), part, 0.0)[()] for part in length)
    mantissa, exponent = np.frexp(long)
    high = np.ldexp(np.trunc(mantissa * MANY), exponent - 26)
    fastest = float(np.max(np.abs(rate)))
    return Period(rate, high, long - high, low, MANY / fastest if fastest else math.inf)


def whole_periods(
    t: Array,
    period: Period,
    farthest: float,
    space: Array,
    offset: float | Array | None = None,
) -> tuple[Array, Array, Array]:
    """Return the integer n nearest to t/period + offset, and t - n period as a difference.

    The first part of the difference is exact, and the second is tiny.  All results are in the three
    arrays of `space`.  |t| must not exceed `farthest`, nor n exceed 2^51.
    """
    whole, rest, lost = space
    np.multiply(t, period.rate, out=whole)
    if offset is not None:
        whole += offset
    np.rint(whole, out=whole)
    if farthest > period.reach:
        return _many_periods(t, period, whole, 0.0 if offset is None else offset)
    np.subtract(t, np.multiply(whole, period.high, out=lost), out=rest)
    rest -= np.multiply(whole, period.middle, out=lost)
    return whole, rest, np.multiply(whole, period.low, out=lost)


def _many_periods(
    t: Array, period: Period, whole: Array, offset: float | Array
) -> tuple[Array, Array, Array]:
    """Return the results of `whole_periods` for n with more than 26 bits; identical for fewer."""
    many = np.rint(whole / MANY) * MANY
    few, rest = whole - many, t
    for length in (period.high, period.middle):
        rest = rest - many * length
        rest = rest - few * length
    lost = whole * period.low
    # rounding t/period may have led to a neighbour of the nearest integer
    more = np.rint(((rest - lost) * period.rate + offset) * _LESS_THAN_1)
    rest = rest - more * period.high
    rest = rest - more * period.middle
    return whole + more, rest, lost + more * period.low


def two_sum(x: float | Array, y: float | Array) -> tuple[Array, Array]:
    """Return x + y and its rounding error, exactly (Knuth)."""
    total: Array = np.add(x, y)
    part = total - x
    return total, (x - (total - part)) + (y - part)


def sqrt_pair(high: Array, low: Array) -> tuple[Array, Array]:
    """Return the square root of high + low >= 0."""
    root = np.sqrt(high)
    square, error = two_product(root, root)
    return root, ((high - square) - error + low) / np.where(root > 0, 2 * root, 1.0)


def _compared(high: Any, low: Any) -> Callable[[DoubleDouble, DoubleDouble | float], Mask]:
    """Return a comparison of the high parts or, if they are equal, of the low parts."""

    def holds(x: DoubleDouble, other: DoubleDouble | float) -> Mask:
        other = DoubleDouble._like(other)
        mask: Mask = high(x.high, other.high) | (x.high == other.high) & low(x.low, other.low)
        return mask

    return holds


class DoubleDouble:
    """The numbers high + low, where high is the double nearest to the sum.

    Sums, products, quotients and square roots are good to a few units of 2^-104 (relative to the
    larger term of a sum).  `arrays.Pairs` is the arithmetic of these numbers.
    """

    def __init__(self, high: Array, low: Array | None = None) -> None:
        self.high = high
        self.low = np.broadcast_to(_ZERO, high.shape) if low is None else low

    def scaled(self, power: float) -> DoubleDouble:
        """Return the numbers times a power of two, exactly."""
        return DoubleDouble(self.high * power, self.low * power)

    @classmethod
    def stacked(cls, rows: Sequence[DoubleDouble]) -> DoubleDouble:
        """Return several arrays stacked as the rows of one."""
        return cls(np.stack([x.high for x in rows]), np.stack([x.low for x in rows]))

    @staticmethod
    def _like(x: DoubleDouble | float) -> DoubleDouble:
        return x if isinstance(x, DoubleDouble) else DoubleDouble(np.asarray(x, dtype=np.float64))

    def __getitem__(self, index: Any) -> DoubleDouble:
        return DoubleDouble(self.high[index], self.low[index])

    def __add__(self, other: DoubleDouble | float) -> DoubleDouble:
        other = self._like(other)
        high, low = two_sum(self.high, other.high)
        low = low + (self.low + other.low)
        return _renormalised(high, low)

    def __neg__(self) -> DoubleDouble:
        return DoubleDouble(-self.high, -self.low)

    def __abs__(self) -> DoubleDouble:
        sign = np.where(self.high < 0, -1.0, 1.0)
        return DoubleDouble(self.high * sign, self.low * sign)

    def __sub__(self, other: DoubleDouble | float) -> DoubleDouble:
        return self + -self._like(other)

    def __rsub__(self, other: float) -> DoubleDouble:
        return self._like(other) - self

    def __mul__(self, other: DoubleDouble | float) -> DoubleDouble:
        if not isinstance(other, DoubleDouble) and math.frexp(other)[0] == 0.5:
            return self.scaled(other)
        other = self._like(other)
        if self.high.size < other.high.size:  # a constant
            return other * self
        high, low = two_product(self.high, other.high)
        low += self.high * other.low
        low += self.low * other.high
        return _renormalised(high, low)

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: DoubleDouble | float) -> DoubleDouble:
        if not isinstance(other, DoubleDouble) and math.frexp(other)[0] == 0.5:
            return self.scaled(1 / other)
        other = self._like(other)
        high = self.high / other.high
        product, rest = two_product(high, other.high)
        rest = (self.high - product) - rest
        rest += self.low
        rest -= high * other.low
        rest /= other.high
        return _renormalised(high, rest)

    def __rtruediv__(self, other: float) -> DoubleDouble:
        return self._like(other) / self

    __gt__, __ge__ = _compared(np.greater, np.greater), _compared(np.greater, np.greater_equal)
    __lt__, __le__ = _compared(np.less, np.less), _compared(np.less, np.less_equal)

    def sqrt(self) -> DoubleDouble:
        """Return the square root of numbers >= 0."""
        return _renormalised(*sqrt_pair(self.high, self.low))

    @classmethod
    def choose(
        cls, condition: Mask, yes: DoubleDouble | float, no: DoubleDouble | float
    ) -> DoubleDouble:
        """Choose between two numbers, element by element."""
        one, other = (
            x if isinstance(x, DoubleDouble) else cls(np.full(np.shape(condition), float(x)))
            for x in (yes, no)
        )
        return cls(
            np.where(condition, one.high, other.high), np.where(condition, one.low, other.low)
        )


def _renormalised(high: Array, low: Array) -> DoubleDouble:
    total = high + low
    return DoubleDouble(total, low - (total - high))
