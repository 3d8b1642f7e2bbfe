"""Arrays of numbers with bounds of their errors, in doubles or in pairs of doubles.

A result is in error by at most what the errors of its operands make of it, and its rounding.
Bounds are rounded too: each rounding counts a millionth more, which covers this for any formula of
less than a million steps.  A bound that is infinite or NaN says that nothing is known.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .pairs import DoubleDouble
from .types import Array, Mask

EPS = 2.0**-53 * (1 + 2.0**-20)
"""The relative error of a rounding to a double, and a millionth of it."""
PAIR_EPS = 2.0**-100
"""A few times that of an operation on pairs; of a sum, relative to the sizes of its terms."""
Operand = Any
"""Bounded numbers, or an exact number."""


def size_of(value: Any) -> Any:
    """Return the size of a value, as a double."""
    return abs(value.high) if isinstance(value, DoubleDouble) else abs(value)


class Bounded:
    """Numbers, each within `error` of `value`."""

    __array_ufunc__ = None  # a product of an array and bounded numbers is one of these
    __slots__ = ("_size", "error", "value")

    def __init__(self, value: Any, error: Any = 0.0) -> None:
        self.value, self.error, self._size = value, error, None

    def __getitem__(self, rows: Any) -> Bounded:
        error = self.error if np.ndim(self.error) == 0 else self.error[rows]
        return Bounded(self.value if np.ndim(self.size) == 0 else self.value[rows], error)

    @property
    def size(self) -> Any:
        """The sizes of the values, as doubles."""
        if self._size is None:
            self._size = size_of(self.value)
        return self._size

    @property
    def doubles(self) -> Array:
        """The values as doubles."""
        return self.value.high if isinstance(self.value, DoubleDouble) else self.value

    def rounded(self) -> Bounded:
        """Return the numbers as doubles."""
        if not isinstance(self.value, DoubleDouble):
            return self
        high = self.value.high
        return Bounded(high, self.error + EPS * abs(high))

    def surely(self, sign: int) -> Mask:
        """Return which numbers surely have a sign."""
        mask: Mask = sign * self.doubles > self.error
        return mask

    def __add__(self, other: Operand) -> Bounded:
        y, of_y = _parts(other)
        total = self.value + y
        error = self.error + of_y
        if isinstance(total, DoubleDouble):
            return Bounded(total, error + PAIR_EPS * (self.size + size_of(y)))
        return _rounded(total, error)

    def __mul__(self, other: Operand) -> Bounded:
        product = self.value * (other.value if isinstance(other, Bounded) else other)
        if not isinstance(other, Bounded):
            return _rounded(product, abs(other) * self.error)
        error = 0.0 if _is_exact(self) else other.size * self.error
        if not _is_exact(other):
            error = error + (self.size + self.error) * other.error
        return _rounded(product, error)

    def __truediv__(self, other: Operand) -> Bounded:
        y, of_y = _parts(other)
        quotient = self.value / y
        divisor = np.maximum(size_of(y) - of_y, 0.0)
        return _rounded(quotient, (self.error + size_of(quotient) * of_y) / divisor)

    def __neg__(self) -> Bounded:
        return Bounded(-self.value, self.error)

    def __abs__(self) -> Bounded:
        return Bounded(abs(self.value), self.error)

    def __sub__(self, other: Operand) -> Bounded:
        found: Bounded = self + -other
        return found

    def __rsub__(self, other: float) -> Bounded:
        return -self + other

    def __rtruediv__(self, other: float) -> Bounded:
        return Bounded(np.float64(other)) / self

    __radd__, __rmul__ = __add__, __mul__


def _parts(x: Operand) -> tuple[Any, Any]:
    return (x.value, x.error) if isinstance(x, Bounded) else (x, 0.0)


def _is_exact(x: Bounded) -> bool:
    """Return whether no number has an error, without a look at arrays."""
    return isinstance(x.error, float) and x.error == 0


def _rounded(value: Any, error: Any) -> Bounded:
    """Return numbers with a bound to which their rounding is added."""
    found = Bounded(value, error)
    rounding = found.size * (PAIR_EPS if isinstance(value, DoubleDouble) else EPS)
    rounding += error
    found.error = rounding
    return found


def sqrt(x: Bounded) -> Bounded:
    """Return square roots; a number that may be negative, but is not, counts as 0."""
    size = np.maximum(x.doubles, 0.0)
    least = np.sqrt(np.maximum(size - x.error, 0.0))
    if isinstance(x.value, DoubleDouble):
        root: Any = DoubleDouble.choose(x.value.high > 0, x.value, 0.0).sqrt()
    else:
        root = np.sqrt(size)
    slope = size_of(root) + least
    return _rounded(root, np.where(slope > 0, x.error / slope, np.sqrt(x.error)))


def choose(condition: Mask, yes: Bounded, no: Bounded) -> Bounded:
    """Choose between two numbers, element by element."""
    pairs = isinstance(yes.value, DoubleDouble) or isinstance(no.value, DoubleDouble)
    pick: Any = DoubleDouble.choose if pairs else np.where
    return Bounded(pick(condition, yes.value, no.value), np.where(condition, yes.error, no.error))


def best(x: Bounded, y: Bounded) -> Bounded:
    """Return that of two forms of a number whose error is smaller."""
    return choose((x.error <= y.error) | np.isnan(y.error), x, y)


def lifted(function: Callable[..., Array], *slopes: Callable[..., Any]) -> Callable[..., Bounded]:
    """Return a function of doubles as one of bounded numbers, from the sizes of its derivatives.

    The function itself is in error by at most 16 roundings.
    """

    def of_bounded(*arguments: Bounded) -> Bounded:
        near = [x.rounded() for x in arguments]
        values = [x.value for x in near]
        result = function(*values)
        error = 16 * EPS * abs(result)
        for x, slope in zip(near, slopes, strict=True):
            error = error + abs(slope(*values)) * x.error
        return Bounded(result, error)

    return of_bounded


def atan2(y: Bounded, x: Bounded) -> Bounded:
    """Return the angles of points; NumPy is in error by at most 8 roundings."""
    y, x = y.rounded(), x.rounded()
    least = np.maximum(np.hypot(x.value, y.value) - x.error - y.error, 0.0)
    error = (abs(x.value) * y.error + abs(y.value) * x.error) / least**2
    found = np.arctan2(y.value, x.value)
    return Bounded(found, error + 8 * EPS * abs(found))
