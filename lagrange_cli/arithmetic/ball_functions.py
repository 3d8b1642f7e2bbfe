"""The functions of balls that no record needs.

`Balls` takes them from here when they are used, because `lagtop solve` should not load them.
"""

from __future__ import annotations

import decimal
from collections.abc import Callable
from decimal import Decimal, DecimalException

from .ball import Ball, Ring, TooFewDigitsError, add_up, divide_up, multiply_up

_LOWEST, _TINY = -23 * 10**17, Decimal("1e-310000000000000000")
"""Exponent below which a power of e may underflow in decimals, and half a bound on that power."""


class BallFunctions(Ring):
    """Exponentials, logarithms, hyperbolic functions, integers and parts of balls."""

    def exp(self, x: Ball) -> Ball:
        """Return e to the power x; e^r - 1 <= 2 r for r <= 1."""
        if (x < _LOWEST) is True:
            return Ball(self, _TINY, _TINY)
        return _growing(self, self.plain.exp, x, 2)

    def sinh(self, x: Ball) -> Ball:
        """Return the hyperbolic sine of x; its slope is cosh x <= 1 + |sinh x|."""
        return _growing(self, self.plain.sinh, x, 3, more=1)

    def cosh(self, x: Ball) -> Ball:
        """Return the hyperbolic cosine of x; its slope is less than itself."""
        return _growing(self, self.plain.cosh, x, 3)

    def expm1(self, x: Ball) -> Ball:
        """Return e to the power x, less 1."""
        if (x < -1) is True:
            return self.exp(x) - 1
        return 2 * self.sinh(x / 2) * self.exp(x / 2)

    def tanh(self, x: Ball) -> Ball:
        """Return the hyperbolic tangent of x, from exp -2|x|."""
        if x.middle > 0:
            return -self.tanh(-x)
        twice = self.expm1(2 * x)
        return twice / (twice + 2)

    def sech(self, x: Ball) -> Ball:
        """Return 1/cosh x, from exp -|x|."""
        return 2 * self.exp(-abs(x)) / (1 + self.exp(-2 * abs(x)))

    def log(self, x: Ball) -> Ball:
        """Return the natural logarithm of x > 0."""
        return _logarithm(self, self.plain.log, x, x)

    def log1p(self, x: Ball) -> Ball:
        """Return the natural logarithm of 1 + x, for x > -1."""
        return _logarithm(self, self.plain.log1p, x, 1 + x)

    def atanh(self, x: Ball) -> Ball:
        """Return the number whose hyperbolic tangent is x."""
        if x.middle < 0:
            return -self.atanh(-x)
        return self.log1p(2 * x / (1 - x)) / 2

    def asinh(self, x: Ball) -> Ball:
        """Return the inverse hyperbolic sine of x, to a fixed number of digits after the point.

        Its slope is less than 1, and less than 1/|x|.
        """
        value = self.function(self.plain.asinh, x.middle)
        return value.enlarged(add_up(divide_up(x.radius, max(x.least, Decimal(1))), self.unit))

    def nint(self, x: Ball) -> int:
        """Return an integer within 3/4 of all numbers in x.

        Raises TooFewDigitsError for a ball wider than half a unit.
        """
        if not x.radius <= Decimal("0.25"):
            raise TooFewDigitsError
        return self.plain.nint(x.middle)

    def ceiling(self, x: Ball) -> int:
        """Return the least integer >= x; raise TooFewDigitsError if x leaves it open."""
        low, high = (int(end.to_integral_value(decimal.ROUND_CEILING)) for end in x.ends())
        if low != high:
            raise TooFewDigitsError
        return low

    def sign(self, x: Ball) -> int:
        """Return 1, 0 or -1 with the sign of x; raise TooFewDigitsError if the sign is open."""
        return 0 if not x else 1 if x > 0 else -1

    def re(self, x: Ball) -> Ball:
        """Return the real part, x itself."""
        return x

    def im(self, x: Ball) -> Ball:
        """Return the imaginary part, 0."""
        return self.exact(0)


def _growing(
    ar: Ring, function: Callable[[Decimal], Decimal], x: Ball, factor: int, more: int = 0
) -> Ball:
    """Return a function whose slope within 1 of x is at most factor (its size + `more`)."""
    if not x.radius <= 1:
        return ar.unbounded
    value = ar.function(function, x.middle)
    try:
        slope = multiply_up(factor, add_up(more, value.greatest))
        return value.enlarged(multiply_up(slope, x.radius))
    except DecimalException:
        return ar.unbounded


def _logarithm(ar: Ring, function: Callable[[Decimal], Decimal], x: Ball, of: Ball) -> Ball:
    """Return a function of x whose slope is 1/`of`."""
    if not of.least > 0:
        return ar.unbounded
    return ar.function(function, x.middle).enlarged(divide_up(x.radius, of.least))
