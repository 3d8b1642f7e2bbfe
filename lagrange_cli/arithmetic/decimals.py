"""Decimals of any precision, from the standard library alone.

A record that is computed in decimals and rounded once is correct to the last bit.  It needs no
import heavier than the `decimal` module, which `fractions` loads anyway.
"""

from __future__ import annotations

import decimal
from contextlib import AbstractContextManager
from decimal import Decimal
from fractions import Fraction
from functools import cached_property, lru_cache

from .numbers import Scalars, Unenclosed
from .text import own_context

_PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")
TRAPS: list[type[decimal.DecimalException]] = [
    decimal.InvalidOperation,
    decimal.DivisionByZero,
    decimal.Overflow,
    decimal.Underflow,
]
"""Conditions that raise an exception, because numbers beyond the exponents would lose digits."""
_GUARD = 5


class Decimals(Scalars, Unenclosed):
    """The arithmetic of decimals with `digits` digits and practically unbounded exponents.

    Every function adds numbers that cancel at most half of each other.  Its relative error is
    therefore below 10 units in the last digit per term of its series.  For sin and cos this holds
    up to a quarter of pi.  A series to N digits has fewer than N terms.
    """

    nan, inf = Decimal("NaN"), Decimal("Infinity")

    def __init__(self, digits: int = 40) -> None:
        self.digits, self.magnitude = digits, 1 - digits
        self.eps = Decimal((0, (1,), 1 - digits))
        """Distance from 1 to the next number."""
        self._context = own_context(digits, TRAPS)

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that sets the precision of this thread."""
        return decimal.localcontext(self._context)

    @cached_property
    def pi(self) -> Decimal:
        """The number pi."""
        return pi_to(self.digits)

    @staticmethod
    def convert(value: float | Fraction) -> Decimal:
        """Return the number nearest to an exact value."""
        exact = Fraction(value)
        return Decimal(exact.numerator) / Decimal(exact.denominator)

    @staticmethod
    def sqrt(x: Decimal | int) -> Decimal:
        """Return the square root of x >= 0."""
        return Decimal(x).sqrt()

    def sin(self, x: Decimal) -> Decimal:
        """Return the sine of x by its Taylor series, for x of a few units."""
        return self._alternating(x, -x * x, 1)

    def cos(self, x: Decimal) -> Decimal:
        """Return the cosine of x by its Taylor series, for x of a few units."""
        return self._alternating(Decimal(1), -x * x, 0)

    def atan2(self, y: Decimal, x: Decimal) -> Decimal:
        """Return the angle of the point (x, y), in (-pi, pi]; its tangent is halved four times."""
        if x < 0:
            upper = self.atan2(abs(y), -x)
            return self.pi - upper if y >= 0 else upper - self.pi
        for _ in range(4):
            x = x + (x * x + y * y).sqrt()
        tangent = y / x if y else y
        return 16 * self._odd_powers(tangent, -tangent * tangent)

    exp, log = staticmethod(Decimal.exp), staticmethod(Decimal.ln)

    def log1p(self, x: Decimal) -> Decimal:
        """Return the natural logarithm of 1 + x; near 0 it is 2 artanh x/(2 + x)."""
        if abs(x) > Decimal("0.1"):
            return (1 + x).ln()
        y = x / (2 + x)
        return 2 * self._odd_powers(y, y * y)

    def sinh(self, x: Decimal) -> Decimal:
        """Return the hyperbolic sine of x, near 0 by its Taylor series."""
        if abs(x) < 1:
            return self._alternating(x, x * x, 1)
        return (x.exp() - (-x).exp()) / 2

    @staticmethod
    def cosh(x: Decimal) -> Decimal:
        """Return the hyperbolic cosine of x."""
        return (x.exp() + (-x).exp()) / 2

    @staticmethod
    def asinh(x: Decimal) -> Decimal:
        """Return the inverse hyperbolic sine of x, to a fixed number of digits after the point."""
        logarithm = (abs(x) + (x * x + 1).sqrt()).ln()
        return logarithm if x >= 0 else -logarithm

    @staticmethod
    def nint(x: Decimal) -> int:
        """Return the integer nearest to x, however many digits it has."""
        return int(x.to_integral_value(decimal.ROUND_HALF_EVEN))

    def _odd_powers(self, x: Decimal, ratio: Decimal) -> Decimal:
        """Return x (1 + r/3 + r^2/5 + ...) of the ratio r."""
        power, total, n, least = x, x, 1, self.eps * abs(x) / 200
        while abs(power) > least:
            power, n = power * ratio, n + 2
            total += power / n
        return total

    def _alternating(self, term: Decimal, ratio: Decimal, n: int) -> Decimal:
        """Return a sum of terms, each ratio/((n + 1)(n + 2)) times the previous one."""
        total, least = term, self.eps * abs(term) / 200
        while abs(term) > least:
            term, n = term * ratio / ((n + 1) * (n + 2)), n + 2
            total += term
        return total


@lru_cache(maxsize=64)
def decimals(digits: int) -> Decimals:
    """Return the arithmetic of decimals with `digits` digits, always the same object."""
    return Decimals(digits)


@lru_cache(maxsize=64)
def pi_to(digits: int) -> Decimal:
    """Return pi to `digits` digits, beyond sixty by the arithmetic-geometric mean (Brent 1976)."""
    with decimal.localcontext(Decimals(digits + _GUARD)._context):
        if digits + _GUARD <= 60:
            return +_PI
        a, b, t, power = Decimal(1), 1 / Decimal(2).sqrt(), Decimal("0.25"), 1
        while abs(a - b) > Decimal(10) ** (-(digits + _GUARD) // 2 - 1):
            mean = (a + b) / 2
            t -= power * (a - mean) * (a - mean)
            a, b, power = mean, (a * b).sqrt(), 2 * power
        mean = (a + b) / 2
        t -= power * (a - mean) * (a - mean)
        return mean * mean / t
