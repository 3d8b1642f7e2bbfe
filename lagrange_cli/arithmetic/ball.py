"""A ball: a middle and a radius that provably enclose the exact value.

Each operation adds a bound on its own rounding error to the radius.  A comparison that the balls do
not settle is `OPEN`.  It raises TooFewDigitsError when a decision depends on it, and the caller
repeats the computation with more digits.  A ball of radius 0 is exact, and stays exact through
exact sums and products.
"""

from __future__ import annotations

import decimal
from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal, DecimalException, Inexact
from functools import cached_property
from typing import Any

from .arb_ball import OPEN, TooFewDigitsError, UndefinedError
from .decimals import TRAPS, Decimals, decimals
from .numbers import power
from .text import own_context

__all__ = ["OPEN", "Ball", "TooFewDigitsError", "UndefinedError"]

Truth = Any
"""True, False or OPEN."""

ZERO, INFINITE = Decimal(0), Decimal("Infinity")
SHORT = 6
"""Digits of a radius."""
SMALLEST = Decimal("1e-300000000000000000")
"""A size far above every value below the exponents of decimals; products of it can be formed."""
_MARGIN = 6
"""Extra digits of elementary functions, besides the digits of the number of digits itself."""


UP, DOWN, FLOOR, CEILING = (
    own_context(SHORT, TRAPS, rounding)
    for rounding in (decimal.ROUND_UP, decimal.ROUND_DOWN, ROUND_FLOOR, ROUND_CEILING)
)
add_up, multiply_up, fma_up, divide_up = UP.add, UP.multiply, UP.fma, UP.divide


class TooSmallError(TooFewDigitsError):
    """A number too close to 0 for the exponents of decimals: no number of digits decides it."""


def _sum_by(operation: str) -> Callable[[Ball, Ball | float], Ball]:
    """Return the method that adds or subtracts; the radii of both balls add up."""

    def total(self: Ball, other: Ball | float) -> Ball:
        ar: Ring = self.ar
        if isinstance(other, Ball):
            term, radius = other.middle, add_up(self.radius, other.radius)
        else:
            term, radius = Decimal(other), self.radius
        if not radius:
            return ar.exactly(operation, self.middle, term)
        middle = getattr(ar, operation)(self.middle, term)
        return Ball(ar, middle, fma_up(middle.copy_abs(), ar.unit, radius))

    return total


class Ball:
    """All numbers at most `radius` away from `middle`; comparisons are True, False or OPEN.

    An infinite radius means that nothing is known of the number; NaN, that it does not exist, as
    x/0.
    """

    __slots__ = ("ar", "middle", "radius")

    def __init__(self, ar: Ring, middle: Decimal, radius: Decimal) -> None:
        self.ar: Any = ar  # a Balls
        self.middle, self.radius = middle, radius

    def __repr__(self) -> str:
        return f"Ball({self.middle} +- {self.radius})"

    __add__, __sub__ = _sum_by("add"), _sum_by("subtract")

    def __rsub__(self, other: float) -> Ball:
        return -self + other

    def __mul__(self, other: Ball | float) -> Ball:
        ar: Ring = self.ar
        x, r = self.middle, self.radius
        try:
            if not isinstance(other, Ball):
                y = Decimal(other)
                if not (r and y):
                    return ar.exactly("multiply", x, y) if r.is_finite() else ar.exact(0)
                middle = ar.multiply(x, y)
                rounding = multiply_up(middle.copy_abs(), ar.unit)
                return Ball(ar, middle, fma_up(r, y.copy_abs(), rounding))
            y, s = other.middle, other.radius
            if not (r or s):
                return ar.exactly("multiply", x, y)
            middle = ar.multiply(x, y)
            # |x| s + (|y| + s) r + the rounding
            radius = fma_up(x.copy_abs(), s, multiply_up(middle.copy_abs(), ar.unit))
            return Ball(ar, middle, fma_up(add_up(y.copy_abs(), s), r, radius))
        except DecimalException:
            return ar.unbounded

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: Ball | float) -> Ball:
        ar: Ring = self.ar
        x, r = self.middle, self.radius
        y, s = (other.middle, other.radius) if isinstance(other, Ball) else (Decimal(other), ZERO)
        try:
            if not s:
                if not y:
                    return ar.nan
                if not r:
                    return ar.exactly("divide", x, y)
            least = DOWN.subtract(y.copy_abs(), s)
            if not least > 0:
                return ar.unbounded
            middle = ar.divide(x, y)
            size = middle.copy_abs()
            # |x' - q y'| <= |x - q y| + r + |q| s, and |x - q y| is the rounding of q times |y|
            away = fma_up(multiply_up(size, ar.unit), y.copy_abs(), fma_up(size, s, r))
            return Ball(ar, middle, divide_up(away, least))
        except DecimalException:
            return ar.nan if x.is_nan() or y.is_nan() else ar.unbounded

    def __rtruediv__(self, other: float) -> Ball:
        return Ball(self.ar, Decimal(other), ZERO) / self

    def __pow__(self, exponent: int) -> Ball:
        return power(self, exponent) if exponent else self.ar.exact(1)

    def __neg__(self) -> Ball:
        return Ball(self.ar, self.middle.copy_negate(), self.radius)

    def __abs__(self) -> Ball:
        return Ball(self.ar, self.middle.copy_abs(), self.radius)

    def __bool__(self) -> bool:
        if self.middle.copy_abs() > self.radius:
            return True
        if self.middle or self.radius:
            raise TooFewDigitsError
        return False

    def __eq__(self, other: object) -> Truth:
        if not isinstance(other, Ball | int | float):
            return False
        low, high = self._less(other)
        return True if low == high == 0 else False if low > 0 or high < 0 else OPEN

    __hash__ = None  # type: ignore[assignment]

    def __lt__(self, other: Ball | float) -> Truth:
        low, high = self._less(other)
        return True if high < 0 else False if low >= 0 else OPEN

    def __le__(self, other: Ball | float) -> Truth:
        low, high = self._less(other)
        return True if high <= 0 else False if low > 0 else OPEN

    def __gt__(self, other: Ball | float) -> Truth:
        low, high = self._less(other)
        return True if low > 0 else False if high <= 0 else OPEN

    def __ge__(self, other: Ball | float) -> Truth:
        low, high = self._less(other)
        return True if low >= 0 else False if high < 0 else OPEN

    def _less(self, other: Ball | float) -> tuple[Decimal, Decimal]:
        """Return lower and upper bounds on the difference from another ball."""
        if isinstance(other, Ball):
            term, radius = other.middle, add_up(self.radius, other.radius)
        else:
            term, radius = Decimal(other), self.radius
        if not radius.is_finite():
            if radius.is_nan():
                raise UndefinedError
            return -INFINITE, INFINITE
        x = self.middle
        low = FLOOR.subtract(FLOOR.subtract(x, term), radius)
        return low, CEILING.add(CEILING.subtract(x, term), radius)

    def __float__(self) -> float:
        """Return the double nearest to every number in the ball.

        Raises TooFewDigitsError if the numbers round to different doubles.
        """
        low, high = map(float, self.ends())
        if low != high:
            raise TooFewDigitsError
        return low

    @property
    def is_nan(self) -> bool:
        """Whether the number does not exist."""
        return self.middle.is_nan()

    @property
    def greatest(self) -> Decimal:
        """An upper bound on the size of all numbers in the ball, to six digits."""
        return add_up(self.middle.copy_abs(), self.radius)

    @property
    def least(self) -> Decimal:
        """A lower bound on the size of all numbers in the ball, to six digits."""
        return max(DOWN.subtract(self.middle.copy_abs(), self.radius), ZERO)

    def enlarged(self, away: Decimal) -> Ball:
        """Return the ball with `away` added to its radius."""
        return Ball(self.ar, self.middle, add_up(self.radius, away))

    @property
    def is_sharp(self) -> bool:
        """Whether the sign of the number is known, and its size to a factor of 2."""
        return self.greatest <= multiply_up(2, self.least)

    def is_known_to(self, digits: int) -> bool:
        """Return whether the radius is at most 10^-digits of every number in the ball."""
        return self.radius <= DOWN.scaleb(self.least, -digits)

    def ends(self) -> tuple[Decimal, Decimal]:
        """Return decimals below and above all numbers in the ball.

        Raises TooFewDigitsError for a ball without bounds.
        """
        if not self.radius.is_finite():
            raise TooFewDigitsError
        floor, ceiling = self.ar.outwards
        return floor.subtract(self.middle, self.radius), ceiling.add(self.middle, self.radius)


class Ring:
    """Sums, products, quotients and functions of balls whose middles have `digits` digits."""

    def __init__(self, digits: int) -> None:
        self.digits = digits
        context = own_context(digits, TRAPS)
        self.add, self.subtract = context.add, context.subtract
        self.multiply, self.divide = context.multiply, context.divide
        self._context, self._tight = context, own_context(digits, [*TRAPS, Inexact])
        self.unit = Decimal((0, (5,), -digits))
        """Half a unit in the last digit, relative to the largest number with this exponent."""
        self.unbounded = self.inf = Ball(self, ZERO, INFINITE)
        self.nan = Ball(self, Decimal("NaN"), Decimal("NaN"))

    @cached_property
    def outwards(self) -> tuple[decimal.Context, decimal.Context]:
        """Contexts that round down and up, with enough digits for both ends of a ball."""
        digits = self.digits + SHORT
        return own_context(digits, [], ROUND_FLOOR), own_context(digits, [], ROUND_CEILING)

    def exactly(self, operation: str, x: Decimal, y: Decimal | int) -> Ball:
        """Return an operation on exact numbers; the result is exact if it has few digits."""
        try:
            return Ball(self, getattr(self._tight, operation)(x, y), ZERO)
        except Inexact:
            return self.about(getattr(self._context, operation)(x, y))
        except DecimalException:  # division by 0
            return self.unbounded

    def about(self, middle: Decimal, units: int = 1) -> Ball:
        """Return a ball around a rounded number, in error by at most `units` in the last digit."""
        return Ball(self, middle, multiply_up(middle.copy_abs(), multiply_up(units, self.unit)))

    def exact(self, value: Decimal | float) -> Ball:
        """Return the ball of radius 0 around a decimal, which may have more digits."""
        return Ball(self, Decimal(value), ZERO)

    @cached_property
    def plain(self) -> Decimals:
        """Decimals whose elementary functions are correct to `digits` digits (see `Decimals`)."""
        return decimals(self.digits + _MARGIN + len(str(self.digits)))

    def function(self, function: Callable[..., Decimal], *at: Decimal) -> Ball:
        """Return the value of a function of exact numbers, in `plain`, as a ball."""
        try:
            with self.plain.working():
                value = function(*at)
            return self.about(self._context.plus(value), 2)
        except DecimalException:  # beyond all exponents
            return self.unbounded
