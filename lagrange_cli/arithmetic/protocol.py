"""What a formula may ask of the arithmetic that it is computed in, and of its numbers.

A formula is written once and takes the arithmetic as its first argument: decimals of any precision,
arrays of doubles, arrays of pairs of doubles, or whatever else behaves like these.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from fractions import Fraction
from typing import Any, Protocol, Self

from .numbers import R


class Real(Protocol):
    """A number of some arithmetic, or an array of such numbers."""

    def __add__(self, other: Self | int, /) -> Self: ...
    def __radd__(self, other: int, /) -> Self: ...
    def __sub__(self, other: Self | int, /) -> Self: ...
    def __rsub__(self, other: int, /) -> Self: ...
    def __mul__(self, other: Self | int, /) -> Self: ...
    def __rmul__(self, other: int, /) -> Self: ...
    def __truediv__(self, other: Self | int, /) -> Self: ...
    def __rtruediv__(self, other: int, /) -> Self: ...
    def __neg__(self, /) -> Self: ...
    def __abs__(self, /) -> Self: ...
    def __lt__(self, other: Self | int, /) -> Any: ...
    def __le__(self, other: Self | int, /) -> Any: ...
    def __gt__(self, other: Self | int, /) -> Any: ...
    def __ge__(self, other: Self | int, /) -> Any: ...


class Arithmetic(Protocol[R]):
    """What the formulas of the record need."""

    @property
    def is_array(self) -> bool:
        """Whether its numbers are arrays, so that a condition on them is a mask."""

    @property
    def pi(self) -> R:
        """The number pi."""

    @property
    def eps(self) -> R:
        """Distance from 1 to the next number."""

    @property
    def nan(self) -> R:
        """Not a number: what an array holds where a top has no number."""

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager inside which every operation has the precision of this object.

        It belongs around each computation, not around the program: the precision of decimals is a
        property of the thread.
        """

    def convert(self, value: float | Fraction, /) -> R:
        """Return the number nearest to an exact value."""

    def sqrt(self, x: R | int, /) -> R:
        """Return the square root of x >= 0."""

    def sin(self, x: R, /) -> R:
        """Return the sine of x."""

    def cos(self, x: R, /) -> R:
        """Return the cosine of x."""

    def atan2(self, y: R, x: R, /) -> R:
        """Return the angle of the point (x, y), in (-pi, pi]."""

    def where(self, condition: Any, yes: R | int, no: R | int, /) -> R:
        """Return one of two numbers, or choose element by element between two arrays."""

    def anywhere(self, condition: Any, /) -> bool:
        """Return whether a condition holds at all, for some element of an array."""

    def everywhere(self, condition: Any, /) -> bool:
        """Return whether a condition holds for every element of an array."""

    def widened(self, x: R, remainder: Callable[[], R], /) -> R:
        """Return x with all that is at most a remainder away from it, in an arithmetic of balls.

        In any other it is x, and the remainder, which an iteration left out, is not computed.
        """


class SeriesArithmetic(Arithmetic[R], Protocol[R]):
    """What the theta series and the separatrix need besides."""

    def exp(self, x: R, /) -> R:
        """Return e to the power x."""

    def sinh(self, x: R, /) -> R:
        """Return the hyperbolic sine of x."""

    def cosh(self, x: R, /) -> R:
        """Return the hyperbolic cosine of x."""

    def asinh(self, x: R, /) -> R:
        """Return the inverse hyperbolic sine of x."""

    def nint(self, x: R, /) -> int:
        """Return the integer nearest to x."""


Value = Any
"""A real or complex number, or an array of them, of a `FunctionArithmetic`: mpmath has no types."""


class FunctionArithmetic(Protocol):
    """What Jacobi's, the theta and Omega functions need: arrays of doubles, or mpmath.

    Their numbers are real or complex and mix with floats, so they have no narrower type than Any:
    float64 and complex128 arrays, or mpf and mpc.  `SeriesArithmetic` names most of these methods;
    those that are here besides are the functions that decimals do not have.
    """

    pi: Any
    eps: Any
    nan: Any
    inf: Any

    @property
    def is_array(self) -> bool:
        """Whether its numbers are arrays, so that a condition on them is a mask."""

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager inside which the host's settings do not matter."""

    def convert(self, value: Any, /) -> Any:
        """Return a number or an array as one of this arithmetic."""

    def sqrt(self, x: Any, /) -> Any:
        """Return the square root of x."""

    def exp(self, x: Any, /) -> Any:
        """Return e to the power x."""

    def expm1(self, x: Any, /) -> Any:
        """Return e to the power x, less 1."""

    def log(self, x: Any, /) -> Any:
        """Return the natural logarithm of x."""

    def log1p(self, x: Any, /) -> Any:
        """Return the natural logarithm of 1 + x."""

    def sin(self, x: Any, /) -> Any:
        """Return the sine of x."""

    def cos(self, x: Any, /) -> Any:
        """Return the cosine of x."""

    def sinh(self, x: Any, /) -> Any:
        """Return the hyperbolic sine of x."""

    def cosh(self, x: Any, /) -> Any:
        """Return the hyperbolic cosine of x."""

    def asinh(self, x: Any, /) -> Any:
        """Return the inverse hyperbolic sine of x."""

    def tanh(self, x: Any, /) -> Any:
        """Return the hyperbolic tangent of x."""

    def atan(self, x: Any, /) -> Any:
        """Return the arc whose tangent is x."""

    def atanh(self, x: Any, /) -> Any:
        """Return the number whose hyperbolic tangent is x."""

    def atan2(self, y: Any, x: Any, /) -> Any:
        """Return the angle of the point (x, y), in (-pi, pi]."""

    def sign(self, x: Any, /) -> Any:
        """Return 1, 0 or -1 with the sign of x."""

    def nint(self, x: Any, /) -> Any:
        """Return the integer nearest to x."""

    def re(self, x: Any, /) -> Any:
        """Return the real part of x."""

    def im(self, x: Any, /) -> Any:
        """Return the imaginary part of x."""

    def conj(self, x: Any, /) -> Any:
        """Return the complex conjugate of x."""

    def mpc(self, real: Any, imag: Any, /) -> Any:
        """Return the complex number with these parts."""

    def where(self, condition: Any, yes: Any, no: Any, /) -> Any:
        """Return one of two numbers, or choose element by element between two arrays."""

    def anywhere(self, condition: Any, /) -> bool:
        """Return whether a condition holds at all, for some element of an array."""

    def everywhere(self, condition: Any, /) -> bool:
        """Return whether a condition holds for every element of an array."""

    def widened(self, x: Any, remainder: Callable[[], Any], /) -> Any:
        """Return x, with all that is at most a remainder away from it in an arithmetic of balls."""
