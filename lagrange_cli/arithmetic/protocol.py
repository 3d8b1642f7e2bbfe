"""What a formula may ask of the arithmetic that it is computed in, and of its numbers.

A formula is written once and takes the arithmetic as its first argument: decimals of any precision,
arrays of doubles, arrays of pairs of doubles, or whatever else behaves like these.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from fractions import Fraction
from typing import Any, Protocol

from .numbers import R


class Arithmetic(Protocol[R]):
    """What the formulas of the record need."""

    def __hash__(self) -> int: ...

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
    def magnitude(self) -> float:
        """The decimal logarithm of eps."""

    @property
    def nan(self) -> R:
        """Not a number: what an array holds where a top has no number."""

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that sets this precision, for the thread, in a computation."""

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

    def either(self, condition: Any, /) -> Any:
        """Return a condition that chooses between two right ways; balls may leave it open."""

    def widened(
        self,
        x: R,
        small: Callable[[], tuple[R, ...]],
        bound: Callable[..., R],
        /,
        *,
        values_only: bool = False,
    ) -> R:
        """Return x and, in an arithmetic of balls, all that an iteration may have left out.

        `bound`, at the sizes of the `small` numbers, bounds what is left out, and its derivatives
        by them bound those of what is left out, unless it is one of `values_only`.  In any other
        arithmetic this is x, and neither is computed.
        """

    def fixed(self, x: R, /) -> R:
        """Return x as a constant, without derivatives."""


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


FunctionArithmetic = Any
"""The arithmetic of Jacobi's, the theta and Omega functions: balls, arrays of doubles, or mpmath.

It is a `SeriesArithmetic` with inf, expm1, log, log1p, tanh, sech, atanh, sign, re and im.  Its
numbers may be complex and mix with floats, and mpmath has no types, so that it has none either.
"""

ComplexArithmetic = Any
"""A `FunctionArithmetic` with conj, and with mpc, which makes a number of two parts."""
