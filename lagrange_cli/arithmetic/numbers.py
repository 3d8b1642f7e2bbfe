"""Numbers of any arithmetic: what formulas need of them, and how formulas are evaluated.

What their arithmetic offers is said in `protocol`, which a record is computed without.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
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
    """Return the value at an array x of two coefficients at least, the lowest power first."""
    value = coefficients[-1] * x
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]
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
