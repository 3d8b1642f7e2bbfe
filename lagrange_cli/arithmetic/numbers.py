"""The operations that formulas may use of an arithmetic and of its numbers.

A formula is written once and takes the arithmetic as its first argument: balls, doubles, arrays of
doubles, or arrays of pairs of doubles.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from fractions import Fraction
from functools import lru_cache, wraps
from operator import index
from typing import Any, Protocol, Self, TypeVar, cast

Number = float | Fraction
"""An input: a double, or the exact value of a decimal."""

_NOT_REAL = (bool, str, bytes, bytearray, complex)


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
F = TypeVar("F", bound=Callable[..., Any])
"""A formula f(ar, ...)."""
T = TypeVar("T")


class Arithmetic(Protocol[R]):
    """The operations that the formulas of the record use."""

    def __hash__(self) -> int: ...

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


def is_real(value: object) -> bool:
    """Return whether a value is a real number: no truth value, text, complex, masked or array."""
    dtype = getattr(value, "dtype", None)
    if dtype is None:
        return not isinstance(value, _NOT_REAL)
    is_scalar = not hasattr(value, "__len__") and not hasattr(value, "mask")
    return is_scalar and getattr(dtype, "kind", None) in {"i", "u", "f"}


def unrounded(value: Any, nearest: float) -> Number:
    """Return a finite real number as its nearest double if that is exact, else as a fraction.

    Numbers of a type without a ratio of integers are rounded.
    """
    exact = index(value) if hasattr(value, "__index__") else value
    if exact == nearest or not hasattr(exact, "as_integer_ratio"):
        return nearest
    return Fraction(*exact.as_integer_ratio())


def angle_unit(*, radians: bool) -> tuple[float, str]:
    """Return the size of one radian in the unit of angles in use, and the name of this unit."""
    return (1.0, "rad") if radians else (180 / math.pi, "deg")


def unit_in_radians(*, radians: bool) -> float:
    """Return the size in radians of the unit of angles in use, a radian or a degree."""
    return 1.0 if radians else math.pi / 180


def absolute(x: R) -> R:
    """Return |x|, with the type of x."""
    return x.__abs__()


def power(x: R, exponent: int) -> R:
    """Return x to a power of at least 1, by squaring."""
    if exponent == 1:
        return x
    half = power(x, exponent // 2)
    return half * half * x if exponent % 2 else half * half


@lru_cache(maxsize=256)
def root_of_epsilon(ar: Any, over: int, degree: int) -> Any:
    """Return (eps/over)^(1/degree), below which a series up to order `degree` is exact.

    Three digits are enough, because the number decides when to stop and not whether a bound holds.
    """
    exponent, part = divmod((ar.magnitude - math.log10(over)) / degree, 1)
    return ar.convert(Fraction(10) ** int(exponent) * Fraction(10.0**part))


def polynomial(coefficients: Sequence[Any], x: Any) -> Any:
    """Return the value of a polynomial at a number or an array x, lowest power first."""
    constant, *others = coefficients
    if not others:
        return constant
    value = others.pop() * x
    while others:
        value += others.pop()
        value *= x
    value += constant
    return value


def in_arithmetic(function: F) -> F:
    """Return the formula f(ar, ...), evaluated inside `ar.working()`.

    The result then does not depend on the caller's decimal context or `numpy.errstate`.
    """

    @wraps(function)
    def evaluate(ar: Any, *arguments: Any, **named: Any) -> Any:
        with ar.working():
            return function(ar, *arguments, **named)

    return cast(F, evaluate)


class Scalars:
    """An arithmetic of single numbers, in which a condition is true or false."""

    convert: Callable[[Any], Any]

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that does nothing, because the numbers know their precision."""
        return nullcontext()

    def where(self, condition: Any, yes: Any, no: Any) -> Any:
        """Return one of two numbers, each a number of this arithmetic or an integer."""
        chosen = yes if condition else no
        return self.convert(chosen) if isinstance(chosen, int) else chosen

    def anywhere(self, condition: Any) -> bool:
        """Return whether a condition holds; a condition on balls may raise TooFewDigitsError."""
        return bool(condition)

    everywhere = anywhere

    @staticmethod
    def either(condition: Any) -> Any:
        """Return a condition that chooses between two valid methods; for balls it may be open."""
        return condition


class Doubles(Scalars):
    """The arithmetic of floats."""

    eps, magnitude = 2.0**-52, -15.65
    pi, nan = math.pi, math.nan
    convert = staticmethod(float)
    sqrt = staticmethod(math.sqrt)
    sin = staticmethod(math.sin)
    cos = staticmethod(math.cos)
    atan2 = staticmethod(math.atan2)


DOUBLES = Doubles()
