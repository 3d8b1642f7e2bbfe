"""Numbers held as two doubles, the nearest one and the rest: the exact arithmetic of phases."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .arithmetic import Real

Array = NDArray[np.float64]

_SPLITTER = 2.0**27 + 1
_INVERSE_PI = 0.3183098861837907, -1.9678676675182486e-17


class Pair(NamedTuple):
    """A number, or an array of numbers, to twice the precision."""

    high: float | Array
    low: float | Array


def pair(value: Real) -> Pair:
    """A many-digit number as two doubles."""
    high = float(value)
    return Pair(high, float(value - high))


def two_product(x: Array, factor: float | Array) -> tuple[Array, Array]:
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


def reduce_phase(t: Array, rate: Pair, offset: float = 0.0) -> tuple[Array, Array]:
    """The integer nearest to t * rate + offset, and t * rate less it, free of cancellation."""
    since, rest = two_product(t, rate.high)
    rest += t * rate.low
    step = np.rint(since + offset) if offset else np.rint(since)
    since -= step
    since += rest
    return step, since


def two_sum(x: Array, y: float | Array) -> tuple[Array, Array]:
    """x + y and its rounding error, exactly (Knuth)."""
    total = x + y
    part = total - x
    return total, (x - (total - part)) + (y - part)


def sqrt_pair(high: Array, low: Array) -> tuple[Array, Array]:
    """The square root of high + low > 0."""
    root = np.sqrt(high)
    square, error = two_product(root, root)
    return root, ((high - square) - error + low) / (2 * root)


def agm_over_pi(k_prime: Pair) -> Pair:
    """agm(1, k')/pi = 1/(2K), the rate of half periods, for k' > 0 in (0, 1], to 25 digits."""
    a, a_low = two_sum(np.asarray(k_prime.high) / 2, 0.5)
    a_low += k_prime.low / 2
    b, b_low = sqrt_pair(np.asarray(k_prime.high), np.asarray(k_prime.low))
    while not (abs(a - b) <= 2.0**-13 * a).all():
        total, total_error = two_sum(a, b)
        product, product_error = two_product(a, b)
        product_error += a * b_low + b * a_low
        a, a_low = total / 2, (total_error + a_low + b_low) / 2
        b, b_low = sqrt_pair(product, product_error)
    mean, mean_low = two_sum(a / 2, b / 2)
    x2 = ((a - b + (a_low - b_low)) / (2 * mean)) ** 2
    mean_low += (a_low + b_low) / 2 - mean * (x2 * (0.25 + x2 * (5 / 64)))  # agm(1 + x, 1 - x)
    high, low = two_product(mean, _INVERSE_PI[0])
    low += mean_low * _INVERSE_PI[0] + mean * _INVERSE_PI[1]
    return Pair(*two_sum(high, low))
