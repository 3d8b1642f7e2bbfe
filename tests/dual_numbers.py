"""Dual numbers over decimals: a value and its derivative, carried along by any formula."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from decimal import Decimal
from fractions import Fraction
from typing import Any

from lagrange_cli.arithmetic.decimals import Decimals, decimals


class Dual:
    """A number x + e dx, where e^2 = 0."""

    __slots__ = ("rate", "value")

    def __init__(self, value: Decimal, rate: Decimal | int = 0) -> None:
        self.value, self.rate = value, Decimal(rate)

    @staticmethod
    def of(other: Dual | Decimal | int) -> Dual:
        """Return a number as a dual number that does not move."""
        return other if isinstance(other, Dual) else Dual(Decimal(other))

    def __add__(self, other: Dual | int) -> Dual:
        other = self.of(other)
        return Dual(self.value + other.value, self.rate + other.rate)

    def __mul__(self, other: Dual | int) -> Dual:
        other = self.of(other)
        return Dual(self.value * other.value, self.rate * other.value + self.value * other.rate)

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.rate)

    def __abs__(self) -> Dual:
        return -self if self.value < 0 else self

    def __sub__(self, other: Dual | int) -> Dual:
        return self + -self.of(other)

    def __rsub__(self, other: int) -> Dual:
        return self.of(other) - self

    def __truediv__(self, other: Dual | int) -> Dual:
        other = self.of(other)
        value = self.value / other.value
        return Dual(value, (self.rate - value * other.rate) / other.value)

    def __rtruediv__(self, other: int) -> Dual:
        return self.of(other) / self

    def __pow__(self, power: Dual | int) -> Dual:
        """Return a power with a constant exponent."""
        exponent = self.of(power).value
        value = self.value**exponent
        return Dual(value, self.rate * exponent * value / self.value if self.rate else 0)

    def __hash__(self) -> int:
        return hash((self.value, self.rate))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Dual) and (self.value, self.rate) == (other.value, other.rate)

    def __lt__(self, other: Dual | int) -> bool:
        return self.value < self.of(other).value

    def __le__(self, other: Dual | int) -> bool:
        return self.value <= self.of(other).value

    def __gt__(self, other: Dual | int) -> bool:
        return self.value > self.of(other).value

    def __ge__(self, other: Dual | int) -> bool:
        return self.value >= self.of(other).value


class Duals:
    """The arithmetic of dual numbers with so many digits."""

    is_array = False
    nan = Dual(Decimal("NaN"))

    def __init__(self, digits: int) -> None:
        self.plain: Decimals = decimals(digits)
        self.eps, self.pi = Dual(self.plain.eps), Dual(self.plain.pi)

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that sets the precision of this thread."""
        return self.plain.working()

    def convert(self, value: float | Fraction) -> Dual:
        """Return the number nearest to an exact value, which does not move."""
        return Dual(self.plain.convert(value))

    def sqrt(self, x: Dual | int) -> Dual:
        """Return the square root."""
        x = Dual.of(x)
        root = x.value.sqrt()
        return Dual(root, x.rate / (2 * root) if root else 0)

    def sin(self, x: Dual) -> Dual:
        """Return the sine."""
        return Dual(self.plain.sin(x.value), self.plain.cos(x.value) * x.rate)

    def cos(self, x: Dual) -> Dual:
        """Return the cosine."""
        return Dual(self.plain.cos(x.value), -self.plain.sin(x.value) * x.rate)

    def atan2(self, y: Dual, x: Dual) -> Dual:
        """Return the angle of the point (x, y)."""
        square = x.value * x.value + y.value * y.value
        rate = (x.value * y.rate - y.value * x.rate) / square
        return Dual(self.plain.atan2(y.value, x.value), rate)

    @staticmethod
    def where(condition: bool, yes: Dual | int, no: Dual | int) -> Dual:
        """Return one of two numbers."""
        return Dual.of(yes if condition else no)

    @staticmethod
    def anywhere(condition: Any) -> bool:
        """Return whether the condition holds."""
        return bool(condition)

    everywhere = anywhere

    @staticmethod
    def widened(x: Dual, remainder: Callable[[], Dual]) -> Dual:
        """Return x: what an iteration leaves out is below the last digit."""
        return x
