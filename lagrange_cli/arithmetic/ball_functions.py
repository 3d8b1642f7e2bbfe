"""Balls with the functions that Jacobi's, the theta and Omega functions need besides."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from .ball import Ball
from .balls import Balls


class BallFunctions(Balls):
    """The arithmetic of real balls under the names of a `FunctionArithmetic`."""

    @property
    def inf(self) -> Ball:
        """What stands for infinity: a ball that says nothing."""
        return self.unbounded

    def convert(self, value: Any) -> Ball:
        """Return a ball that holds an exact value, or a ball as it is."""
        return value if isinstance(value, Ball) else super().convert(value)

    def log(self, x: Ball) -> Ball:
        """Return the natural logarithm of x > 0."""
        return self.chained(self.plain.log, x, x)

    def log1p(self, x: Ball) -> Ball:
        """Return the natural logarithm of 1 + x, for x > -1."""
        return self.chained(self.plain.log1p, x, 1 + x)

    def expm1(self, x: Ball) -> Ball:
        """Return e to the power x, less 1."""
        return 2 * self.sinh(x / 2) * self.exp(x / 2)

    def tanh(self, x: Ball) -> Ball:
        """Return the hyperbolic tangent of x."""
        twice = self.expm1(2 * x)
        return twice / (twice + 2)

    def atanh(self, x: Ball) -> Ball:
        """Return the number whose hyperbolic tangent is x."""
        return self.log1p(2 * x / (1 - x)) / 2

    def atan(self, x: Ball) -> Ball:
        """Return the arc whose tangent is x."""
        return self.atan2(x, self.exact(1))

    @staticmethod
    def sign(x: Ball) -> int:
        """Return 1, 0 or -1 with the sign of x.  Raises TooFewDigitsError if it is open."""
        return 0 if not x else 1 if x > 0 else -1

    @staticmethod
    def re(x: Ball) -> Ball:
        """Return the real part, the number itself."""
        return x

    def im(self, x: Ball) -> Ball:
        """Return the imaginary part, 0."""
        return self.exact(0)


@lru_cache(maxsize=16)
def ball_functions(digits: int) -> BallFunctions:
    """Return the functions of balls with so many digits, always the same object."""
    return BallFunctions(digits)
