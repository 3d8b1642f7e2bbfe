"""Dual numbers over balls or decimals: a value with its partial derivatives.

With e_i e_j = 0, a number x + x_1 e_1 + ... + x_n e_n obeys the rules of differentiation.  A
formula written for any arithmetic then gives its derivatives by n parameters at once.  Over balls,
the derivatives are enclosures.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from fractions import Fraction
from typing import Any

from .ball import OPEN, Ball
from .balls import Balls
from .decimals import Decimals
from .numbers import Scalars

Plain = Any
"""A number of the arithmetic underneath."""


def _compared(holds: Callable[[Any, Any], Any]) -> Callable[[Dual, Dual | int], Any]:
    """Return a comparison of values."""
    return lambda x, other: holds(x.value, _value(other))


class Dual:
    """A number and its partial derivatives, which are None for a constant.

    A constant 0 times anything is 0, because a number that is 0 throughout a neighbourhood stays 0.
    Comparisons use the value alone.
    """

    __slots__ = ("partials", "value")

    def __init__(self, value: Plain, partials: Sequence[Plain] | None = None) -> None:
        self.value, self.partials = value, partials

    @property
    def middle(self) -> Dual:
        """The middles of balls."""
        partials = None if self.partials is None else [x.middle for x in self.partials]
        return Dual(self.value.middle, partials)

    def __add__(self, other: Dual | int) -> Dual:
        if isinstance(other, int) or other.partials is None:
            return Dual(self.value + _value(other), self.partials)
        if self.partials is None:
            return Dual(self.value + other.value, other.partials)
        sums = [x + y for x, y in zip(self.partials, other.partials, strict=True)]
        return Dual(self.value + other.value, sums)

    def __mul__(self, other: Dual | int) -> Dual:
        if isinstance(other, int) or other.partials is None:
            return self._times(_value(other))
        if self.partials is None:
            return other._times(self.value)
        v, w = self.value, other.value
        pairs = zip(self.partials, other.partials, strict=True)
        return Dual(v * w, [x * w + v * y for x, y in pairs])

    __radd__, __rmul__ = __add__, __mul__

    def _times(self, factor: Plain) -> Dual:
        """Return the product with a constant."""
        value = self.value * factor
        return Dual(value) if is_zero(factor) else _chained(self, value, factor)

    def __neg__(self) -> Dual:
        return Dual(-self.value, None if self.partials is None else [-x for x in self.partials])

    def __abs__(self) -> Dual:
        """Return |x|; at 0 its derivatives are the derivatives of x, as if x were increasing."""
        falls = self.value < 0
        if falls is not OPEN:
            return -self if falls else self
        ar = self.value.ar
        partials = self.partials and [ar.within(dx.greatest) for dx in self.partials]
        return Dual(abs(self.value), partials)

    def __sub__(self, other: Dual | int) -> Dual:
        return self + -other

    def __rsub__(self, other: int) -> Dual:
        return -self + other

    def __truediv__(self, other: Dual | int) -> Dual:
        if isinstance(other, int) or other.partials is None:
            divisor = _value(other)
            partials = None if self.partials is None else [x / divisor for x in self.partials]
            return Dual(self.value / divisor, partials)
        inverse = 1 / other.value
        value = self.value / other.value
        if self.partials is None:
            factor = -value * inverse
            return Dual(value, None if is_zero(value) else [factor * y for y in other.partials])
        pairs = zip(self.partials, other.partials, strict=True)
        return Dual(value, [(x - value * y) * inverse for x, y in pairs])

    def __rtruediv__(self, other: int) -> Dual:
        inverse = 1 / self.value
        return _chained(self, other * inverse, -other * inverse * inverse)

    def __bool__(self) -> bool:
        return bool(self.value)

    def __float__(self) -> float:
        return float(self.value)

    __lt__, __le__ = _compared(operator.lt), _compared(operator.le)
    __gt__, __ge__ = _compared(operator.gt), _compared(operator.ge)

    def __repr__(self) -> str:
        return f"Dual({self.value}, {self.partials})"


def _value(x: Dual | int) -> Plain:
    return x if isinstance(x, int) else x.value


def is_zero(x: Plain) -> bool:
    """Return whether a number is exactly 0."""
    if isinstance(x, Ball):
        return not (x.middle or x.radius)
    return not x


def _chained(x: Dual, value: Plain, slope: Plain) -> Dual:
    """Return a function of x from its value and its slope at x."""
    return Dual(value, None if x.partials is None else [slope * dx for dx in x.partials])


def _function(name: str, slope: Callable[[Any, Plain], Plain]) -> Callable[[Duals, Dual], Dual]:
    """Return the function `name` of dual numbers, with its slope."""

    def function(ar: Duals, x: Dual) -> Dual:
        return _chained(x, getattr(ar.plain, name)(x.value), slope(ar.plain, x.value))

    return function


class Duals(Scalars):
    """The arithmetic of dual numbers over the arithmetic of balls or decimals.

    The root of a 0 that is not a constant has no derivatives.  They are NaN, and so are all
    derivatives that depend on them.
    """

    def __init__(self, plain: Balls | Decimals) -> None:
        self.plain: Any = plain
        self.digits, self.magnitude = plain.digits, plain.magnitude
        self.eps, self.nan = Dual(plain.eps), Dual(plain.nan)

    @property
    def middles(self) -> Duals:
        """The arithmetic of the middles of balls."""
        return Duals(self.plain.middles)

    @property
    def pi(self) -> Dual:
        """The number pi."""
        return Dual(self.plain.pi)

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that sets the precision of this thread."""
        manager: AbstractContextManager[object] = self.plain.working()
        return manager

    def convert(self, value: float | Fraction) -> Dual:
        """Return the constant nearest to an exact value."""
        return Dual(self.plain.convert(value))

    def sqrt(self, x: Dual | int) -> Dual:
        """Return the square root of x >= 0."""
        root = self.plain.sqrt(_value(x))
        if isinstance(x, int) or x.partials is None:
            return Dual(root)
        return _chained(x, root, self.plain.nan if is_zero(root) else 1 / (2 * root))

    sin = _function("sin", lambda ar, x: ar.cos(x))
    cos = _function("cos", lambda ar, x: -ar.sin(x))
    exp = _function("exp", lambda ar, x: ar.exp(x))
    sinh = _function("sinh", lambda ar, x: ar.cosh(x))
    cosh = _function("cosh", lambda ar, x: ar.sinh(x))

    def atan2(self, y: Dual, x: Dual) -> Dual:
        """Return the angle of the point (x, y), in (-pi, pi]."""
        angle = self.plain.atan2(y.value, x.value)
        square = x.value * x.value + y.value * y.value
        along, across = x.value / square, -y.value / square
        none = self.plain.convert(0)
        return Dual(angle) + (_chained(y, none, along) + _chained(x, none, across))

    def nint(self, x: Dual) -> int:
        """Return the integer nearest to x."""
        return int(self.plain.nint(x.value))

    def widened(
        self,
        x: Dual,
        small: Callable[[], tuple[Dual, ...]],
        bound: Callable[..., Dual],
        *,
        values_only: bool = False,
    ) -> Dual:
        """Return x; over balls, add the truncation error of an iteration and its derivatives.

        Raises NotImplementedError over balls for a bound of `values_only`.
        """
        if not isinstance(self.plain, Balls):
            return x
        if values_only:
            raise NotImplementedError("this bound does not hold for derivatives")
        if x.value.is_nan:  # a number that the motion does not have
            return x
        away = bound(*(_sizes(self.plain, number) for number in small()))
        if (away.value >= 0) is not True:  # the series behind the bound diverges
            unbounded = self.plain.unbounded
            return Dual(unbounded, None if x.partials is None else [unbounded for _ in x.partials])
        return _widened(x, away)

    def either(self, condition: Any) -> bool:
        """Return a condition that affects only the path to the result."""
        return bool(self.plain.either(condition))

    @staticmethod
    def fixed(x: Dual) -> Dual:
        """Return x as a constant, without derivatives."""
        return Dual(x.value)


def _sizes(ar: Balls, x: Dual) -> Dual:
    """Return upper bounds on the sizes of a number and of its derivatives."""
    partials = None if x.partials is None else [ar.exact(dx.greatest) for dx in x.partials]
    return Dual(ar.exact(x.value.greatest), partials)


def _widened(x: Dual, away: Dual) -> Dual:
    """Return a number with the radii of its value and derivatives enlarged."""
    value = x.value.enlarged(away.value.greatest)
    if away.partials is None:
        return Dual(value, x.partials)
    partials = x.partials or [0 * dx for dx in away.partials]
    pairs = zip(partials, away.partials, strict=True)
    return Dual(value, [dx.enlarged(size.greatest) for dx, size in pairs])


def independent(values: Iterable[Plain]) -> list[Dual]:
    """Return numbers as independent parameters: derivative 1 by themselves, 0 by the others."""
    values = list(values)
    return [
        Dual(x, [0 * y + int(i == j) for j, y in enumerate(values)]) for i, x in enumerate(values)
    ]
