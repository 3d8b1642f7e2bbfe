"""What a formula may ask of the arithmetic that it is computed in, and of its numbers.

A formula is written once and takes the arithmetic as its first argument: decimals of any precision,
arrays of doubles, arrays of pairs of doubles, or whatever else behaves like these.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from fractions import Fraction
from typing import Any, Protocol, Self, TypeVar


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


R = TypeVar("R", bound=Real)
"""The numbers of the arithmetic in use."""


def absolute(x: R) -> R:
    """Return |x|, with the type of x."""
    return x.__abs__()


class Arithmetic(Protocol[R]):
    """What the formulas of the record need."""

    @property
    def pi(self) -> R:
        """The number pi."""

    @property
    def eps(self) -> float | R:
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
