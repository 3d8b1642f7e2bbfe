"""Arithmetic on arrays of unevaluated sums of two doubles, about 104 bits (Dekker 1971)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SPLITTER = 2.0**27 + 1


class Twofold:
    """The numbers high + low, where high is the double nearest to the sum."""

    __slots__ = ("high", "low")

    def __init__(self, high: Array, low: Array | float = 0.0) -> None:
        self.high = high
        self.low: Array | float = low

    def scaled(self, power: float) -> Twofold:
        """Times a power of two, exactly."""
        return Twofold(self.high * power, self.low * power)

    def __mul__(self, other: Twofold) -> Twofold:
        """The product, to a few units of 2^-104."""
        high, low = two_product(self.high, other.high)
        low += self.high * other.low + self.low * other.high
        return _renormalised(high, low)

    def __truediv__(self, other: Twofold) -> Twofold:
        """The quotient, to a few units of 2^-104."""
        high = self.high / other.high
        product, error = two_product(high, other.high)
        rest = (self.high - product) - error + self.low - high * other.low
        return _renormalised(high, rest / other.high)


def _renormalised(high: Array, low: Array) -> Twofold:
    total = high + low
    return Twofold(total, low - (total - high))


def two_sum(x: Array | float, y: Array) -> Twofold:
    """x + y, exactly (Knuth)."""
    total = x + y
    rest = total - x
    return Twofold(total, (x - (total - rest)) + (y - rest))


def two_product(x: Array, factor: Array | float) -> tuple[Array, Array]:
    """x * factor and its rounding error, exactly (Dekker)."""
    scaled = factor * _SPLITTER
    factor_high = scaled - (scaled - factor)
    factor_low = factor - factor_high
    high = x * _SPLITTER
    high -= high - x
    low = x - high
    product = x * factor
    error = high * factor_high
    error -= product
    high *= factor_low
    error += high
    error += low * factor_high
    low *= factor_low
    error += low
    return product, error
