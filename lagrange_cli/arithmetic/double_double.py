"""Arithmetic on unevaluated sums of two doubles, about 104 bits (Dekker 1971).

A double times a constant held as two gives the whole periods that have passed and the rest of the
time exactly, however far away it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import frexp
from typing import Any

import numpy as np

from .sums_of_doubles import Pair, Triple
from .types import Array, Mask
from .workspace import HEAP, Space

_SPLITTER = 2.0**27 + 1


def two_product(x: Array, factor: float | Array, space: Space = HEAP) -> tuple[Array, Array]:
    """Return x * factor and its rounding error, exactly (Dekker), in arrays of a workspace."""
    factor_high = factor * _SPLITTER
    factor_high -= factor_high - factor
    factor_low = factor - factor_high
    one, other = space.new(), space.new()
    high: Array = np.multiply(x, _SPLITTER, out=one)
    high -= np.subtract(high, x, out=other)
    low: Array = np.subtract(x, high, out=other)
    product: Array = np.multiply(x, factor, out=space.new())
    error: Array = np.multiply(high, factor_high, out=space.new())
    error -= product
    high *= factor_low
    error += high
    error += np.multiply(low, factor_high, out=one)
    low *= factor_low
    error += low
    space.free(one, other)
    return product, error


def reduce_phase(
    t: Array, rate: Pair, offset: float | Array = 0.0, space: Space = HEAP
) -> tuple[Array, Array]:
    """Return the integer nearest to t * rate + offset, and t * rate less it, with all digits."""
    since, rest = two_product(t, rate.high, space)
    target = space.new()
    rest += np.multiply(t, rate.low, out=target)
    shifted = np.add(since, offset, out=target) if np.any(offset) else since
    step: Array = np.rint(shifted, out=target)
    since -= step
    since += rest
    space.free(rest)
    return step, since


def fraction_of_product(t: Array, rate: Triple, space: Space = HEAP) -> Array:
    """Return t * rate less whole numbers, free of cancellation, within a few halves of 0."""
    total: Array = np.multiply(t, rate.low, out=space.new())
    target = space.new()
    for part in (rate.middle, rate.high):
        product, error = two_product(t, part, space)
        error -= np.rint(error, out=target)
        product -= np.rint(product, out=target)
        total += error
        total += product
        space.free(product, error)
    space.free(target)
    return total


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


class DoubleDouble:
    """The numbers high + low, where high is the double nearest to the sum.

    Sums, products, quotients and square roots are good to a few units of 2^-104, of the larger part
    in a sum.  `arrays.Pairs` is the arithmetic of these numbers.
    """

    def __init__(self, high: Array, low: Array | None = None) -> None:
        self.high = high
        self.low = np.zeros_like(high) if low is None else low

    def scaled(self, power: float) -> DoubleDouble:
        """Return the numbers times a power of two, exactly."""
        return DoubleDouble(self.high * power, self.low * power)

    def at(self, index: Any) -> DoubleDouble:
        """Return some of the numbers, by an index of an array."""
        return DoubleDouble(self.high[index], self.low[index])

    @classmethod
    def stacked(cls, rows: Sequence[DoubleDouble]) -> DoubleDouble:
        """Return arrays as the rows of one."""
        return cls(np.stack([x.high for x in rows]), np.stack([x.low for x in rows]))

    def _like(self, other: DoubleDouble | float) -> DoubleDouble:
        return (
            other
            if isinstance(other, DoubleDouble)
            else DoubleDouble(np.asarray(other, dtype=np.float64))
        )

    def __getitem__(self, rows: Any) -> DoubleDouble:
        return DoubleDouble(self.high[rows], self.low[rows])

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
        if not isinstance(other, DoubleDouble) and frexp(other)[0] == 0.5:
            return self.scaled(other)
        other = self._like(other)
        if self.high.size < other.high.size:  # a constant
            return other * self
        high, low = two_product(self.high, other.high)
        low += self.high * other.low + self.low * other.high
        return _renormalised(high, low)

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: DoubleDouble | float) -> DoubleDouble:
        if not isinstance(other, DoubleDouble) and frexp(other)[0] == 0.5:
            return self.scaled(1 / other)
        other = self._like(other)
        high = self.high / other.high
        product, error = two_product(high, other.high)
        rest = (self.high - product) - error + self.low - high * other.low
        return _renormalised(high, rest / other.high)

    def __gt__(self, other: DoubleDouble | float) -> Mask:
        other = self._like(other)
        holds: Mask = (self.high > other.high) | (self.high == other.high) & (self.low > other.low)
        return holds

    def __le__(self, other: DoubleDouble | float) -> Mask:
        other = self._like(other)
        holds: Mask = (self.high < other.high) | (self.high == other.high) & (self.low <= other.low)
        return holds

    def __rtruediv__(self, other: float) -> DoubleDouble:
        return self._like(other) / self

    def __lt__(self, other: DoubleDouble | float) -> Mask:
        other = self._like(other)
        holds: Mask = (self.high < other.high) | (self.high == other.high) & (self.low < other.low)
        return holds

    def __ge__(self, other: DoubleDouble | float) -> Mask:
        other = self._like(other)
        holds: Mask = (self.high > other.high) | (self.high == other.high) & (self.low >= other.low)
        return holds

    def sqrt(self) -> DoubleDouble:
        """Return the square root of numbers >= 0."""
        return _renormalised(*sqrt_pair(self.high, self.low))

    @classmethod
    def choose(
        cls, condition: Mask, yes: DoubleDouble | float, no: DoubleDouble | float
    ) -> DoubleDouble:
        """Return one of two numbers, element by element."""
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
