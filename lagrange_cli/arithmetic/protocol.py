"""The operations that formulas may use of an arithmetic and of its numbers.

A formula is written once and takes the arithmetic as its first argument.  Examples are decimals of
any precision, arrays of doubles, and arrays of pairs of doubles.
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


class Arithmetic(Protocol[R]):
    """The operations that the formulas of the record use."""

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
        """Not a number; it marks undefined elements of an array."""

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that sets this precision for the thread during a computation."""

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
        """Return whether a condition holds, for an array whether it holds for any element."""

    def everywhere(self, condition: Any, /) -> bool:
        """Return whether a condition holds for every element of an array."""

    def either(self, condition: Any, /) -> Any:
        """Return a condition that chooses between two valid methods; for balls it may be open."""


Numeric = Any
"""A real or complex number, or an array of them, of a `FunctionArithmetic`; mpmath has no types."""


FunctionArithmetic = Any
"""The arithmetic of Jacobi's, the theta and Omega functions: balls, arrays of doubles, or mpmath.

It is an `Arithmetic` with inf, exp, expm1, log, log1p, sinh, cosh, tanh, sech, asinh, atanh, sign,
nint (the nearest integer), re and im.  Its numbers may be complex and mix with floats.  It has no
static type, because mpmath has none.
"""

ComplexArithmetic = Any
"""A `FunctionArithmetic` with conj, and with mpc, which makes a number from two parts."""
