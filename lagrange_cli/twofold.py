"""Arithmetic on arrays of unevaluated sums of two doubles, about 104 bits (Dekker 1971)."""

from __future__ import annotations

import numpy as np

from .phase import Array, two_product


class Twofold:
    """The numbers high + low, where high is the double nearest to the sum."""

    def __init__(self, high: Array, low: Array | None = None) -> None:
        self.high = high
        self.low = np.zeros_like(high) if low is None else low

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
