"""Arrays of numbers with bounds of their errors, in doubles or in pairs of doubles.

A result is in error by at most what the errors of its operands make of it, and its rounding.
Bounds are rounded too: each rounding counts a millionth more, which covers this for any formula of
less than a million steps.  A bound that is infinite or NaN says that nothing is known.

As long as nothing cancels, one number bounds the relative errors of a whole array, and its bound
costs no time.  It is at most 2^-37, so that the millionth covers products of such errors, too.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from .pairs import DoubleDouble
from .types import Array, Mask

EPS = 2.0**-53 * (1 + 2.0**-20)
"""The relative error of a rounding to a double, and a millionth of it."""
PAIR_EPS = 2.0**-102
"""Twice that of an operation on pairs; of a sum, relative to the sizes of its terms."""
LOST = 2.0**-60
"""Relative error of a pair of doubles above which another form of it is tried."""
Operand = Any
"""Bounded numbers, or an exact number."""


def size_of(value: Any) -> Any:
    """Return the size of a value, as a double."""
    return abs(value.high) if isinstance(value, DoubleDouble) else abs(value)


def unit_of(value: Any) -> float:
    """Return the relative error of a rounding."""
    return PAIR_EPS if isinstance(value, DoubleDouble) else EPS


class Bounded:
    """Numbers, each within `error` of `value`.

    `relative` bounds the relative errors of all, or is None if they differ.  No number that is
    known as `positive` is negative.
    """

    __array_ufunc__ = None  # a product of an array and bounded numbers is one of these
    __slots__ = ("_error", "_size", "positive", "relative", "value")

    def __init__(
        self, value: Any, error: Any = None, relative: Any = 0.0, *, positive: bool = False
    ) -> None:
        """Take values with bounds of their errors or, if these are None, of all relative errors."""
        self.value, self._error = value, error
        self._size: Any = None
        self.relative, self.positive = relative if error is None else None, positive

    def __getitem__(self, rows: Any) -> Bounded:
        value = self.value if np.ndim(self.size) == 0 else self.value[rows]
        error = self._error if np.ndim(self._error) == 0 else self._error[rows]
        return Bounded(value, error, self.relative, positive=self.positive)

    @property
    def size(self) -> Any:
        """The sizes of the values, as doubles."""
        if self._size is None:
            doubles = self.doubles
            self._size = doubles if self.positive and self.relative is not None else abs(doubles)
        return self._size

    @property
    def error(self) -> Any:
        """Bounds of the errors."""
        if self._error is None:
            self._error = self.relative * self.size if self.relative else 0.0
        return self._error

    @property
    def doubles(self) -> Array:
        """The values as doubles."""
        return self.value.high if isinstance(self.value, DoubleDouble) else self.value

    def rounded(self) -> Bounded:
        """Return the numbers as doubles."""
        if not isinstance(self.value, DoubleDouble):
            return self
        high = self.value.high
        if self.relative is None:
            return Bounded(high, self.error + EPS * abs(high), positive=self.positive)
        return Bounded(high, None, self.relative + EPS, positive=self.positive)

    def surely(self, sign: int) -> Mask:
        """Return which numbers surely have a sign."""
        mask: Mask = sign * self.doubles > (self.error if self.relative is None else 0.0)
        return mask

    def is_not_0(self) -> Mask:
        """Return which numbers are surely not 0."""
        mask: Mask = self.size > self.error
        return mask

    def __add__(self, other: Operand) -> Bounded:
        y = _lifted(other)
        total = self.value + y.value
        unit, positive = unit_of(total), self.positive and y.positive
        if positive and self.relative is not None and y.relative is not None:
            return Bounded(total, None, max(self.relative, y.relative) + unit, positive=True)
        terms = self.size + y.size if isinstance(total, DoubleDouble) else abs(total)
        error = unit * terms
        for x in (self, y):
            if x.relative != 0:
                error = error + x.error
        return Bounded(total, error, positive=positive)

    def __mul__(self, other: Operand) -> Bounded:
        x, y = self, _lifted(other)
        product = x.value * y.value
        is_exact = isinstance(other, float | int) and math.frexp(other)[0] == 0.5
        unit, positive = unit_of(product) * (not is_exact), x is y or (x.positive and y.positive)
        if x.relative is None and y.relative is not None:
            x, y = y, x
        if x.relative is None:
            error = x.size * y.error + (y.size + y.error) * x.error + unit * size_of(product)
        elif y.relative is None:
            error = (1 + x.relative) * (x.size * y.error) + (x.relative + unit) * size_of(product)
        else:
            return Bounded(product, None, x.relative + y.relative + unit, positive=positive)
        return Bounded(product, error, positive=positive)

    def __truediv__(self, other: Operand) -> Bounded:
        y = _lifted(other)
        quotient = self.value / y.value
        unit, positive = unit_of(quotient), self.positive and y.positive
        size = size_of(quotient)
        if self.relative is not None and y.relative is not None:
            found = Bounded(quotient, None, self.relative + y.relative + unit, positive=positive)
            finite = size < np.inf
            return (
                found if np.all(finite) else choose(finite, found, Bounded(np.nan, positive=True))
            )
        divisor = np.maximum(y.size - y.error, 0.0)
        error = (self.error + size * y.error) / divisor + unit * size
        return Bounded(quotient, error, positive=positive)

    def __neg__(self) -> Bounded:
        return Bounded(-self.value, self._error, self.relative)

    def __abs__(self) -> Bounded:
        return Bounded(abs(self.value), self._error, self.relative, positive=True)

    def __sub__(self, other: Operand) -> Bounded:
        found: Bounded = self + -other
        return found

    def __rsub__(self, other: float) -> Bounded:
        return -self + other

    def __rtruediv__(self, other: float) -> Bounded:
        return _lifted(np.float64(other)) / self

    __radd__, __rmul__ = __add__, __mul__


def _lifted(x: Operand) -> Bounded:
    return x if isinstance(x, Bounded) else Bounded(x, positive=np.ndim(x) == 0 and x >= 0)


def relative_errors(x: Bounded) -> Any:
    """Return bounds of relative errors: one number, or an array."""
    if x.relative is not None:
        return x.relative
    return np.where(x.error == 0, 0.0, x.error / x.size)


def known(x: Bounded, relative: float, *, positive: bool = True) -> Bounded:
    """Return numbers with one bound of their relative errors, NaN where theirs is larger.

    By default, none is negative.
    """
    x.positive = positive
    fine = x.error <= relative * x.size
    value = x.value if fine.all() else choose(fine, x, Bounded(np.nan)).value
    return Bounded(value, None, relative, positive=positive)


def sqrt(x: Bounded) -> Bounded:
    """Return square roots; a number that may be negative, but is not, counts as 0."""
    if x.positive and x.relative is not None:
        root: Any = root_of(x.value)
        return Bounded(root, None, 0.5 * x.relative + unit_of(root), positive=True)
    size = np.maximum(x.doubles, 0.0)
    least = np.sqrt(np.maximum(size - x.error, 0.0))
    if isinstance(x.value, DoubleDouble):
        root = DoubleDouble.choose(x.value.high > 0, x.value, 0.0).sqrt()
    else:
        root = np.sqrt(size)
    slope = size_of(root) + least
    error = np.where(slope > 0, x.error / slope, np.sqrt(x.error)) + unit_of(root) * size_of(root)
    return Bounded(root, error, positive=True)


def root_of(x: Any) -> Any:
    """Return the square root of a value."""
    return x.sqrt() if isinstance(x, DoubleDouble) else np.sqrt(x)


def choose(condition: Mask, yes: Bounded, no: Bounded) -> Bounded:
    """Choose between two numbers, element by element."""
    pairs = isinstance(yes.value, DoubleDouble) or isinstance(no.value, DoubleDouble)
    pick: Any = DoubleDouble.choose if pairs else np.where
    value, positive = pick(condition, yes.value, no.value), yes.positive and no.positive
    if yes.relative is not None and no.relative is not None:
        return Bounded(value, None, max(yes.relative, no.relative), positive=positive)
    return Bounded(value, np.where(condition, yes.error, no.error), positive=positive)


def best(x: Bounded, other: Callable[[], Bounded]) -> Bounded:
    """Return numbers, and the lost ones from another form of them if its error is smaller."""
    lost = ~(x.error <= LOST * x.size)
    if not lost.any():
        return x
    y = other()
    return choose(lost & ~(y.error >= x.error), y, x)


def atan2(y: Bounded, x: Bounded) -> Bounded:
    """Return the angles of points with y >= 0; NumPy is in error by at most 8 roundings.

    A relative error of y/x is one of the angle, too, because |sin cos| is less than the angle.
    """
    y, x = y.rounded(), x.rounded()
    found = np.arctan2(y.value, x.value)
    if y.positive and y.relative is not None and x.relative is not None:
        return Bounded(found, None, y.relative + x.relative + 8 * EPS, positive=True)
    least = np.maximum(np.hypot(x.value, y.value) - x.error - y.error, 0.0)
    error = (abs(x.value) * y.error + abs(y.value) * x.error) / least**2
    return Bounded(found, error + 8 * EPS * abs(found))
