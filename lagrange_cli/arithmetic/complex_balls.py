"""Complex balls: pairs of balls that enclose the real and the imaginary part."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from ..errors import OutOfRangeError
from .ball import Ball, Truth
from .ball_functions import BallFunctions
from .balls import Balls
from .numbers import Number
from .points import ExactComplex

_HIGHEST = 23 * 10**17
"""Exponent above which a power of e may overflow in decimals."""


class ComplexBall:
    """A complex number whose parts are enclosed by balls.

    A part that is exactly 0 stays exactly 0 in products.  A ball must be the second operand.
    """

    __slots__ = ("imag", "real")

    def __init__(self, real: Ball, imag: Ball) -> None:
        self.real, self.imag = real, imag

    def __repr__(self) -> str:
        return f"ComplexBall({self.real}, {self.imag})"

    def __add__(self, other: ComplexBall | Ball | float) -> ComplexBall:
        if isinstance(other, ComplexBall):
            return ComplexBall(self.real + other.real, self.imag + other.imag)
        return ComplexBall(self.real + other, self.imag)

    def __neg__(self) -> ComplexBall:
        return ComplexBall(-self.real, -self.imag)

    def __sub__(self, other: ComplexBall | Ball | float) -> ComplexBall:
        return self + -other

    def __mul__(self, other: ComplexBall | Ball | float) -> ComplexBall:
        if not isinstance(other, ComplexBall):
            return ComplexBall(self.real * other, self.imag * other)
        (a, b), (c, d) = (self.real, self.imag), (other.real, other.imag)
        return ComplexBall(a * c - b * d, a * d + b * c)

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: ComplexBall | Ball | float) -> ComplexBall:
        if not isinstance(other, ComplexBall):
            return ComplexBall(self.real / other, self.imag / other)
        c, d = other.real, other.imag
        return self * ComplexBall(c, -d) / (c * c + d * d)

    def __abs__(self) -> Ball:
        size: Ball = self.real.ar.sqrt(self.real * self.real + self.imag * self.imag)
        return size

    def __complex__(self) -> complex:
        """Return the nearest complex double; raise TooFewDigitsError if it is not determined."""
        return complex(float(self.real), float(self.imag))


class ComplexBalls(BallFunctions, Balls):
    """The arithmetic of complex balls, and of balls that are parts of complex numbers."""

    def convert(self, value: Any) -> Any:
        """Return a ball or a complex ball that holds an exact value, or a ball unchanged."""
        if isinstance(value, ExactComplex):
            return self.mpc(value.real, value.imag)
        return value if isinstance(value, ComplexBall) else super().convert(value)

    def mpc(self, real: Ball | Number, imag: Ball | Number) -> ComplexBall:
        """Return the complex number with the given parts."""
        return ComplexBall(self.convert(real), self.convert(imag))

    @staticmethod
    def re(x: Ball | ComplexBall) -> Ball:
        """Return the real part."""
        return x if isinstance(x, Ball) else x.real

    def im(self, x: Ball | ComplexBall) -> Ball:
        """Return the imaginary part."""
        return self.exact(0) if isinstance(x, Ball) else x.imag

    @staticmethod
    def conj(x: ComplexBall) -> ComplexBall:
        """Return the conjugate number."""
        return ComplexBall(x.real, -x.imag)

    def where(self, condition: Truth, yes: Any, no: Any) -> Any:
        """Return one of two numbers, or balls that hold both if the condition is undecided."""
        if not isinstance(yes, ComplexBall):
            return super().where(condition, yes, no)
        real = super().where(condition, yes.real, no.real)
        return ComplexBall(real, super().where(condition, yes.imag, no.imag))

    def sqrt(self, x: Any) -> Any:
        """Return the square root of a real number, or of a complex one with real part above 0."""
        if not isinstance(x, ComplexBall):
            return super().sqrt(x)
        real = super().sqrt((abs(x) + x.real) / 2)
        return ComplexBall(real, x.imag / (2 * real))

    def exp(self, x: Ball) -> Ball:
        """Return e to the power x; raise OutOfRangeError if decimals cannot hold it."""
        return super().exp(_in_range(x))

    def sech(self, x: Ball) -> Ball:
        """Return 1/cosh x; raise OutOfRangeError if decimals cannot hold cosh x."""
        return super().sech(_in_range(abs(x)))

    def nint(self, x: Ball) -> int:
        """Return the integer nearest to x; raise TooFewDigitsError if x does not determine it.

        The branch of a logarithm may depend on it.
        """
        return self.ceiling(x - 0.5)


def _in_range(x: Ball) -> Ball:
    """Return x, or raise OutOfRangeError if e to the power x may overflow."""
    if (x > _HIGHEST) is True:
        raise OutOfRangeError(
            "the size of a value is not within 1e-990000000000000000 and 1e+990000000000000000, "
            "the limits of --digits: take a smaller argument"
        )
    return x


@lru_cache(maxsize=64)
def complex_balls(digits: int) -> ComplexBalls:
    """Return the arithmetic of complex balls with `digits` digits, always the same object."""
    return ComplexBalls(digits)
