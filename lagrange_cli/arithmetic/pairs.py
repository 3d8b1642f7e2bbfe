"""Arithmetic on unevaluated sums of two doubles, about 104 bits (Dekker 1971)."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from .types import Array, Mask


class Pair(NamedTuple):
    """A number as the sum of two doubles."""

    high: float
    low: float


PI = Pair(3.141592653589793, 1.2246467991473532e-16)


def pair(value: Any) -> Pair:
    """Return a fraction or a ball as the sum of two doubles, infinity and 0 if it overflows."""
    high = float(value)
    part = Fraction(high) if isinstance(value, Fraction) else high
    return Pair(high, float(value - part) if math.isfinite(high) else 0.0)


def two_product(x: float | Array, y: float | Array) -> tuple[Array, Array]:
    """Return x * y and its rounding error, exactly (Dekker)."""
    return _product(x, y, _halves(x), _halves(y))


def _product(x: float | Array, y: float | Array, of_x: _Halves, of_y: _Halves) -> _Halves:
    product: Array = np.multiply(x, y)
    (x_high, x_low), (y_high, y_low) = of_x, of_y
    error = x_high * y_high
    error = error - product
    error += x_high * y_low
    error += x_low * y_high
    error += x_low * y_low
    return product, error


_Halves = tuple[Array, Array]


def _halves(x: float | Array) -> _Halves:
    """Return numbers as sums of two numbers with 26 bits."""
    bits = np.asarray(x, dtype=np.float64).view(np.int64)
    high: Array = ((bits + (1 << 26)) & -(1 << 27)).view(np.float64)
    return high, x - high


def two_sum(x: float | Array, y: float | Array) -> tuple[Array, Array]:
    """Return x + y and its rounding error, exactly (Knuth)."""
    total: Array = np.add(x, y)
    part = total - x
    return total, (x - (total - part)) + (y - part)


class DoubleDouble:
    """The numbers high + low, where high is the double nearest to the sum.

    Sums, products, quotients and square roots are good to a few units of 2^-104 (relative to the
    larger term of a sum).
    """

    __array_ufunc__ = None  # a product of an array and pairs is one of pairs

    def __init__(self, high: Array, low: Array | None = None) -> None:
        self.high = high
        self.low = np.broadcast_to(0.0, high.shape) if low is None else low

    def scaled(self, power: float) -> DoubleDouble:
        """Return the numbers times a power of two, exactly."""
        return DoubleDouble(self.high * power, self.low * power)

    @cached_property
    def _high_halves(self) -> _Halves:
        return _halves(self.high)

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
        if isinstance(other, float | int) and abs(math.frexp(other)[0]) == 0.5:
            return self.scaled(other)
        other = self._like(other)
        high, low = _product(self.high, other.high, self._high_halves, other._high_halves)
        low += self.high * other.low
        low += self.low * other.high
        return _renormalised(high, low)

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: DoubleDouble | float) -> DoubleDouble:
        if isinstance(other, float | int) and abs(math.frexp(other)[0]) == 0.5:
            return self.scaled(1 / other)
        other = self._like(other)
        high = self.high / other.high
        product, rest = _product(high, other.high, _halves(high), other._high_halves)
        rest = (self.high - product) - rest
        rest += self.low
        rest -= high * other.low
        rest /= other.high
        return _renormalised(high, rest)

    def __rtruediv__(self, other: float) -> DoubleDouble:
        return self._like(other) / self

    def sqrt(self) -> DoubleDouble:
        """Return the square root of numbers >= 0."""
        root = np.sqrt(self.high)
        square, error = two_product(root, root)
        rest = (self.high - square) - error + self.low
        return _renormalised(root, rest / np.where(root > 0, 2 * root, 1.0))

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
