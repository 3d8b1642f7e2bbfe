"""Numbers of any arithmetic: what formulas need of them, and the arithmetic of plain floats.

What an arithmetic offers is said in `protocol`, which a record is computed without.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from fractions import Fraction
from functools import lru_cache, wraps
from operator import index
from typing import TYPE_CHECKING, Any, TypeVar, cast

if TYPE_CHECKING:
    from typing import Protocol, Self

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


Number = float | Fraction
"""An input: a double, or the exact value of a decimal."""

_NOT_REAL = (bool, str, bytes, bytearray, complex)

R = TypeVar("R", bound="Real")
"""The numbers of the arithmetic in use."""
F = TypeVar("F", bound=Callable[..., Any])
"""A formula f(ar, ...)."""
T = TypeVar("T")


def is_real(value: object) -> bool:
    """Return whether a value is neither a truth value, a text, complex, masked, nor an array."""
    dtype = getattr(value, "dtype", None)
    if dtype is None:
        return not isinstance(value, _NOT_REAL)
    is_scalar = not hasattr(value, "__len__") and not hasattr(value, "mask")
    return is_scalar and getattr(dtype, "kind", None) in {"i", "u", "f"}


def unrounded(value: Any, nearest: float) -> Number:
    """Return a finite real number as the double nearest to it, if it is that, or as a fraction.

    A number of a kind that tells no ratio of integers is rounded.
    """
    exact = index(value) if hasattr(value, "__index__") else value
    if exact == nearest or not hasattr(exact, "as_integer_ratio"):
        return nearest
    return Fraction(*exact.as_integer_ratio())


def per_radian(*, radians: bool) -> float:
    """Return how many of the unit of angles in use, radians or degrees, a radian is."""
    return 1.0 if radians else 180 / math.pi


def unit_in_radians(*, radians: bool) -> float:
    """Return how many radians the unit of angles in use, a radian or a degree, is."""
    return 1.0 if radians else math.pi / 180


def absolute(x: R) -> R:
    """Return |x|, with the type of x."""
    return x.__abs__()


def power(x: R, exponent: int) -> R:
    """Return x to a power of 1 at least, by squaring."""
    if exponent == 1:
        return x
    half = power(x, exponent // 2)
    return half * half * x if exponent % 2 else half * half


@lru_cache(maxsize=256)
def root_of_epsilon(ar: Any, over: int, degree: int) -> Any:
    """Return (eps/over)^(1/degree): where a series with so many orders is exact.

    Three digits are enough: it says when to stop, not what is true.
    """
    exponent, part = divmod((ar.magnitude - math.log10(over)) / degree, 1)
    return ar.convert(Fraction(10) ** int(exponent) * Fraction(10.0**part))


def polynomial(coefficients: Sequence[Any], x: Any) -> Any:
    """Return the value of a polynomial at a number or an array x, the lowest power first."""
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
    """Return a formula f(ar, ...) that is evaluated inside `ar.working()`.

    So nothing depends on the decimal context or the `numpy.errstate` of the caller.
    """

    @wraps(function)
    def evaluate(ar: Any, *arguments: Any, **named: Any) -> Any:
        with ar.working():
            return function(ar, *arguments, **named)

    return cast(F, evaluate)


class Unenclosed:
    """An arithmetic whose numbers have no radii, so that what iterations leave out is ignored."""

    def widened(
        self,
        x: T,
        small: Callable[[], tuple[Any, ...]],
        bound: Callable[..., Any],
        *,
        values_only: bool = False,
    ) -> T:
        """Return x: what an iteration leaves out is below the last digit."""
        return x

    def either(self, condition: Any) -> Any:
        """Return a condition on which only the way to the result depends."""
        return condition

    def fixed(self, x: T) -> T:
        """Return x as a constant."""
        return x


class Scalars:
    """An arithmetic of single numbers, in which a condition is true or false."""

    is_array = False

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that has nothing to do: the numbers know their precision."""
        return nullcontext()

    def where(self, condition: Any, yes: Any, no: Any) -> Any:
        """Return one of two numbers."""
        return yes if condition else no

    def anywhere(self, condition: Any) -> bool:
        """Return whether a condition holds; that of balls may raise TooFewDigitsError."""
        return bool(condition)

    everywhere = anywhere


class Doubles(Scalars, Unenclosed):
    """The arithmetic of floats."""

    eps, magnitude = 2.0**-52, -15.65
    pi, nan = math.pi, math.nan
    convert = staticmethod(float)
    sqrt = staticmethod(math.sqrt)
    sin = staticmethod(math.sin)
    cos = staticmethod(math.cos)
    atan2 = staticmethod(math.atan2)


DOUBLES = Doubles()
