"""Dual numbers over balls or decimals: a value with its partial derivatives.

With e_i e_j = 0, a number x + x_1 e_1 + ... + x_n e_n obeys the rules of differentiation.  A
formula written for any arithmetic then gives its derivatives by n parameters at once.  Over balls,
the derivatives are enclosures.
"""

from __future__ import annotations

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
        other = _dual(other)
        return Dual(self.value + other.value, _total((self.partials, other.partials)))

    def __mul__(self, other: Dual | int) -> Dual:
        other = _dual(other)
        if self.partials is None and other.partials is not None:
            return other * self
        value = self.value * other.value
        if other.partials is None:
            return Dual(value) if is_zero(other.value) else _chained(value, (self, other.value))
        return _chained(value, (self, other.value), (other, self.value))

    __radd__, __rmul__ = __add__, __mul__

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
        other = _dual(other)
        value = self.value / other.value
        if other.partials is None:
            return Dual(value, self.partials and [x / other.value for x in self.partials])
        if self.partials is None and is_zero(value):
            return Dual(value)
        inverse = 1 / other.value
        return _chained(value, (self, inverse), (other, -value * inverse))

    def __rtruediv__(self, other: int) -> Dual:
        return Dual(other) / self

    def __bool__(self) -> bool:
        return bool(self.value)

    def __lt__(self, other: Dual | int) -> Any:
        return self.value < _dual(other).value

    def __le__(self, other: Dual | int) -> Any:
        return self.value <= _dual(other).value

    def __gt__(self, other: Dual | int) -> Any:
        return self.value > _dual(other).value

    def __ge__(self, other: Dual | int) -> Any:
        return self.value >= _dual(other).value

    def __repr__(self) -> str:
        return f"Dual({self.value}, {self.partials})"


def _dual(x: Dual | int) -> Dual:
    return x if isinstance(x, Dual) else Dual(x)


def is_zero(x: Plain) -> bool:
    """Return whether a number is exactly 0."""
    if isinstance(x, Ball):
        return not (x.middle or x.radius)
    return not x


def _total(terms: Iterable[Sequence[Plain] | None]) -> Sequence[Plain] | None:
    """Return sums of derivatives; None if all numbers are constants."""
    total = None
    for row in terms:
        if row is not None:
            total = row if total is None else [x + y for x, y in zip(total, row, strict=True)]
    return total


def _chained(value: Plain, *slopes: tuple[Dual, Plain]) -> Dual:
    """Return a function from its value, and from each of its arguments with the slope along it."""
    terms = [x.partials and [slope * dx for dx in x.partials] for x, slope in slopes]
    return Dual(value, _total(terms))


def _function(name: str, slope: Callable[[Any, Plain], Plain]) -> Callable[[Duals, Dual], Dual]:
    """Return the function `name` of dual numbers, with its slope."""

    def function(ar: Duals, x: Dual) -> Dual:
        return _chained(getattr(ar.plain, name)(x.value), (x, slope(ar.plain, x.value)))

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
        x = _dual(x)
        root = self.plain.sqrt(x.value)
        return _chained(root, (x, self.plain.nan if is_zero(root) else 1 / (2 * root)))

    sin = _function("sin", lambda ar, x: ar.cos(x))
    cos = _function("cos", lambda ar, x: -ar.sin(x))
    exp = _function("exp", lambda ar, x: ar.exp(x))
    sinh = _function("sinh", lambda ar, x: ar.cosh(x))
    cosh = _function("cosh", lambda ar, x: ar.sinh(x))

    def atan2(self, y: Dual, x: Dual) -> Dual:
        """Return the angle of the point (x, y), in (-pi, pi]."""
        angle = self.plain.atan2(y.value, x.value)
        square = x.value * x.value + y.value * y.value
        return _chained(angle, (y, x.value / square), (x, -y.value / square))

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

    def where(self, condition: bool, yes: Dual | int, no: Dual | int) -> Dual:
        """Return one of two numbers."""
        chosen = yes if condition else no
        return self.convert(chosen) if isinstance(chosen, int) else chosen


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
