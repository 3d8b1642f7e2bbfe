"""The arithmetic of balls over decimals: roots, angles and truncation errors.

A middle has the digits of its arithmetic, rounded to nearest.  A radius has six digits, rounded up.
`widened` adds the truncation error of an iteration to a radius, from the bound that is proved
beside the iteration.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal, DecimalException, Inexact
from fractions import Fraction
from functools import cached_property, lru_cache, partial
from typing import Any

from .ball import (
    CEILING,
    DOWN,
    INFINITE,
    OPEN,
    UP,
    ZERO,
    Ball,
    Ring,
    Truth,
    add_up,
    divide_up,
    fma_up,
    multiply_up,
)
from .decimals import Decimals, decimals, pi_to
from .numbers import Scalars


class Balls(Ring, Scalars):
    """The arithmetic of balls whose middles have `digits` digits.

    Iterations stop when their truncation error is below 10^-`stop`, by default the last digit.
    Wherever they stop, the ball holds the exact value; only its radius depends on `stop`.
    """

    def __init__(self, digits: int, stop: int | None = None) -> None:
        super().__init__(digits)
        self.magnitude = 1 - (stop or digits)
        self.eps = self.exact(Decimal((0, (1,), self.magnitude)))

    @property
    def middles(self) -> Decimals:
        """The arithmetic of the middles, without radii."""
        return decimals(self.digits)

    def within(self, size: Decimal) -> Ball:
        """Return the ball around 0 of all numbers up to a size."""
        return Ball(self, ZERO, size)

    @cached_property
    def pi(self) -> Ball:
        """The number pi."""
        return self.about(self._context.plus(pi_to(self.digits + 2)), 2)

    def convert(self, value: Ball | float | Fraction) -> Ball:
        """Return a ball that holds an exact value, or a ball unchanged."""
        if isinstance(value, Ball):
            return value
        exact = Fraction(value)
        return self.exactly("divide", Decimal(exact.numerator), Decimal(exact.denominator))

    def sqrt(self, x: Ball | int) -> Ball:
        """Return the square root of x >= 0; for a ball that reaches below 0, from its upper end."""
        if isinstance(x, int):
            x = self.exact(x)
        middle, r = x.middle, x.radius
        try:
            if not r:
                return self._exact_root(middle)
            if not middle > r:
                return self._root_from_0(x)
            root = self._context.sqrt(middle)
            # |sqrt x' - sqrt x| = |x' - x|/(sqrt x' + sqrt x)
            share = Decimal("1.9") if middle > multiply_up(10, r) else Decimal("0.99")
            away = divide_up(r, DOWN.multiply(root, share))
            return Ball(self, root, fma_up(root, self.unit, away))
        except DecimalException:
            return self.nan if middle.is_nan() else self.unbounded

    def _exact_root(self, x: Decimal) -> Ball:
        try:
            return Ball(self, self._tight.sqrt(x), ZERO)
        except Inexact:
            return self.about(self._context.sqrt(x))

    def _root_from_0(self, x: Ball) -> Ball:
        """Return a ball that holds all roots from 0 to the root of the upper end."""
        upper = CEILING.add(x.middle, x.radius)
        if not 0 <= upper < INFINITE:
            return self.unbounded
        half = multiply_up(UP.sqrt(upper), Decimal("0.50001"))  # sqrt rounds to nearest
        return Ball(self, half, half)

    def sin(self, x: Ball) -> Ball:
        """Return the sine of x."""
        return self._turned(x, 0)

    def cos(self, x: Ball) -> Ball:
        """Return the cosine of x."""
        return self._turned(x, 1)

    def _turned(self, x: Ball, quarters: int) -> Ball:
        """Return the sine of x plus a number of quarter turns; its slope is at most 1."""
        turns = 0
        if x.radius < 1:
            turns = self.plain.nint(self.divide(self.multiply(x.middle, 2), self.pi.middle))
            x = x - self.pi * turns / 2 if turns else x
        if not x.radius < 1:  # the angle is not known to within a turn
            return self.within(Decimal(1))
        which = (quarters + turns) % 4
        function = self.plain.cos if which % 2 else self.plain.sin
        value = self.function(function, x.middle).enlarged(x.radius)
        return -value if which > 1 else value

    def atan2(self, y: Ball, x: Ball) -> Ball:
        """Return the angle of the point (x, y); all angles if it may lie on the cut or at 0.

        Between two points the angle changes by at most (|x| |dy| + |y| |dx|)/(x^2 + y^2).
        """
        r, s = x.radius, y.radius
        if not (r or s):
            return self.function(self.plain.atan2, y.middle, x.middle)
        across, along = y.least, x.least
        on_the_cut = not across and s and not x.middle > r
        if on_the_cut or not (across or along) or not (r < INFINITE and s < INFINITE):
            return self.within(Decimal(4))
        square = DOWN.fma(along, along, DOWN.multiply(across, across))
        moved = fma_up(x.greatest, s, multiply_up(y.greatest, r))
        value = self.function(self.plain.atan2, y.middle, x.middle)
        return value.enlarged(divide_up(moved, square))

    def where(self, condition: Truth, yes: Ball | float, no: Ball | float) -> Ball:
        """Return one of two numbers, or a ball that holds both if the condition is open."""
        both = [x if isinstance(x, Ball) else self.exact(x) for x in (yes, no)]
        if condition is not OPEN:
            return both[0] if condition else both[1]
        (a, r), (b, s) = ((x.middle, x.radius) for x in both)
        if not add_up(r, s) < INFINITE:
            return self.unbounded
        middle = self.divide(self.add(a, b), 2)
        reach = (add_up(UP.subtract(x, middle).copy_abs(), y) for x, y in ((a, r), (b, s)))
        return Ball(self, middle, max(reach))

    @staticmethod
    def either(condition: Truth) -> bool:
        """Return whether a condition is proved, if both answers lead to the right result."""
        return condition is True

    def widened(
        self,
        x: Ball,
        small: Callable[[], tuple[Ball, ...]],
        bound: Callable[..., Ball],
        *,
        values_only: bool = False,
    ) -> Ball:
        """Return a ball that holds all numbers whose distance from x is within a bound.

        A negative bound means that its series diverges.
        """
        away = bound(*(self.exact(number.greatest) for number in small()))
        return x.enlarged(away.greatest) if (away >= 0) is True else self.unbounded

    @staticmethod
    def fixed(x: Ball) -> Ball:
        """Return x as a constant."""
        return x

    def __getattr__(self, name: str) -> Any:
        """Return a method of `BallFunctions`."""
        from .ball_functions import BallFunctions  # start-up: not for a record

        return partial(getattr(BallFunctions, name), self)


@lru_cache(maxsize=64)
def balls(digits: int) -> Balls:
    """Return the arithmetic of balls with `digits` digits, always the same object."""
    return Balls(digits)
