"""Dual numbers over decimals: a value with its partial derivatives, carried along by any formula.

With e_i e_j = 0 a number x + x_1 e_1 + ... + x_n e_n obeys the rules of differentiation, so that a
formula written for any arithmetic gives its derivatives by n parameters at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from decimal import Decimal
from fractions import Fraction
from typing import Any

from .decimals import decimals

_NAN = Decimal("NaN")


class Dual:
    """A number and its partial derivatives; a constant has None of them.

    A constant 0 is 0 whatever it is multiplied with: what is known to be 0 all around keeps its
    meaning.  Comparisons look at the value alone.
    """

    __slots__ = ("partials", "value")

    def __init__(self, value: Decimal, partials: Sequence[Decimal] | None = None) -> None:
        self.value, self.partials = value, partials

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

    def _times(self, factor: Decimal | int) -> Dual:
        """Return the product with a constant."""
        if self.partials is None or not factor:
            return Dual(self.value * factor)
        return Dual(self.value * factor, [x * factor for x in self.partials])

    def __neg__(self) -> Dual:
        return Dual(-self.value, None if self.partials is None else [-x for x in self.partials])

    def __abs__(self) -> Dual:
        """Return |x|; at 0 its derivatives are those of x, as if x were growing there."""
        return -self if self.value < 0 else self

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
        if self.partials is None:
            value = self.value / other.value
            factor = -value * inverse
            return Dual(value, [factor * y for y in other.partials] if value else None)
        value = self.value / other.value
        pairs = zip(self.partials, other.partials, strict=True)
        return Dual(value, [(x - value * y) * inverse for x, y in pairs])

    def __rtruediv__(self, other: int) -> Dual:
        return Dual(Decimal(other)) / self

    def __pow__(self, power: Dual) -> Dual:
        """Return a power of constants, such as a tolerance."""
        if self.partials is not None or power.partials is not None:
            raise TypeError("only constants have powers")
        return Dual(self.value**power.value)

    def __bool__(self) -> bool:
        return bool(self.value)

    def __hash__(self) -> int:
        return hash(self.value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Dual) and (self.value, self.partials) == (
            other.value,
            other.partials,
        )

    def __lt__(self, other: Dual | int) -> bool:
        return self.value < _value(other)

    def __le__(self, other: Dual | int) -> bool:
        return self.value <= _value(other)

    def __gt__(self, other: Dual | int) -> bool:
        return self.value > _value(other)

    def __ge__(self, other: Dual | int) -> bool:
        return self.value >= _value(other)

    def __repr__(self) -> str:
        return f"Dual({self.value}, {self.partials})"


def _value(x: Dual | int) -> Decimal | int:
    return x if isinstance(x, int) else x.value


class Duals:
    """The arithmetic of dual numbers over decimals with so many digits.

    Where a root is taken of a 0 that is no constant its derivatives do not exist: they are NaN, and
    so is whatever hangs on them.
    """

    is_array = False
    nan = Dual(_NAN)

    def __init__(self, digits: int) -> None:
        self.digits, self.plain = digits, decimals(digits)
        self.eps, self.pi = Dual(self.plain.eps), Dual(self.plain.pi)

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that sets the precision of this thread."""
        return self.plain.working()

    def convert(self, value: float | Fraction) -> Dual:
        """Return the constant nearest to an exact value."""
        return Dual(self.plain.convert(value))

    def sqrt(self, x: Dual | int) -> Dual:
        """Return the square root of x >= 0."""
        if isinstance(x, int) or x.partials is None:
            return Dual(Decimal(_value(x)).sqrt())
        root = x.value.sqrt()
        return _chained(x, root, 1 / (2 * root) if root else _NAN)

    def sin(self, x: Dual) -> Dual:
        """Return the sine of x."""
        return _chained(x, self.plain.sin(x.value), self.plain.cos(x.value))

    def cos(self, x: Dual) -> Dual:
        """Return the cosine of x."""
        return _chained(x, self.plain.cos(x.value), -self.plain.sin(x.value))

    def sinh(self, x: Dual) -> Dual:
        """Return the hyperbolic sine of x."""
        return _chained(x, self.plain.sinh(x.value), self.plain.cosh(x.value))

    def cosh(self, x: Dual) -> Dual:
        """Return the hyperbolic cosine of x."""
        return _chained(x, self.plain.cosh(x.value), self.plain.sinh(x.value))

    def asinh(self, x: Dual) -> Dual:
        """Return the inverse hyperbolic sine of x."""
        slope = 1 / (1 + x.value * x.value).sqrt()
        return _chained(x, self.plain.asinh(x.value), slope)

    def exp(self, x: Dual) -> Dual:
        """Return e to the power x."""
        value = x.value.exp()
        return _chained(x, value, value)

    def atan2(self, y: Dual, x: Dual) -> Dual:
        """Return the angle of the point (x, y), in (-pi, pi]."""
        angle = self.plain.atan2(y.value, x.value)
        square = x.value * x.value + y.value * y.value
        along, across = x.value / square, -y.value / square
        return Dual(angle) + (_slope(y, along) + _slope(x, across))

    def nint(self, x: Dual) -> int:
        """Return the integer nearest to x."""
        return self.plain.nint(x.value)

    @staticmethod
    def widened(x: Dual, remainder: Callable[[], Dual]) -> Dual:
        """Return x: what an iteration leaves out is below the last digit."""
        return x

    @staticmethod
    def where(condition: bool, yes: Dual | int, no: Dual | int) -> Dual:
        """Return one of two numbers."""
        chosen = yes if condition else no
        return Dual(Decimal(chosen)) if isinstance(chosen, int) else chosen

    @staticmethod
    def anywhere(condition: Any) -> bool:
        """Return whether the condition holds."""
        return bool(condition)

    everywhere: Callable[[Any], bool] = anywhere


def _chained(x: Dual, value: Decimal, slope: Decimal) -> Dual:
    """Return a function of x by its value and its slope there."""
    return Dual(value, None if x.partials is None else [slope * dx for dx in x.partials])


def _slope(x: Dual, factor: Decimal) -> Dual:
    """Return a number of value 0 with the partials of x times a factor."""
    return _chained(x, Decimal(0), factor)


def independent(values: Iterable[Decimal]) -> list[Dual]:
    """Return numbers as parameters, each with the derivative 1 by itself and 0 by the others."""
    values = list(values)
    count = range(len(values))
    return [Dual(x, [Decimal(i == j) for j in count]) for i, x in enumerate(values)]
