"""Arb's balls as an arithmetic: every result holds the exact value, roundings included.

A comparison that the balls do not decide raises `Undecided`: more bits are needed then.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, contextmanager
from fractions import Fraction
from typing import Any

from balls.scene import Undecided
from flint import arb, ctx, fmpq


class Ball:
    """A ball whose comparisons are decided, or raise Undecided."""

    __slots__ = ("ball",)

    def __init__(self, ball: arb) -> None:
        self.ball = ball

    @staticmethod
    def arb_of(other: Ball | int) -> arb:
        """Return a number of either kind as a ball of Arb."""
        return other.ball if isinstance(other, Ball) else arb(other)

    def __add__(self, other: Ball | int) -> Ball:
        return Ball(self.ball + self.arb_of(other))

    def __mul__(self, other: Ball | int) -> Ball:
        return Ball(self.ball * self.arb_of(other))

    __radd__, __rmul__ = __add__, __mul__

    def __sub__(self, other: Ball | int) -> Ball:
        return Ball(self.ball - self.arb_of(other))

    def __rsub__(self, other: int) -> Ball:
        return Ball(arb(other) - self.ball)

    def __truediv__(self, other: Ball | int) -> Ball:
        return Ball(self.ball / self.arb_of(other))

    def __rtruediv__(self, other: int) -> Ball:
        return Ball(arb(other) / self.ball)

    def __pow__(self, power: Ball | int) -> Ball:
        return Ball(self.ball ** self.arb_of(power))

    def __neg__(self) -> Ball:
        return Ball(-self.ball)

    def __abs__(self) -> Ball:
        return Ball(abs(self.ball))

    def __hash__(self) -> int:
        return hash(str(self.ball))

    def __eq__(self, other: object) -> bool:
        return self is other

    def __lt__(self, other: Ball | int) -> bool:
        right = self.arb_of(other)
        if self.ball < right:
            return True
        if self.ball >= right:
            return False
        raise Undecided("a comparison")

    def __le__(self, other: Ball | int) -> bool:
        return not self > other

    def __gt__(self, other: Ball | int) -> bool:
        right = self.arb_of(other)
        if self.ball > right:
            return True
        if self.ball <= right:
            return False
        raise Undecided("a comparison")

    def __ge__(self, other: Ball | int) -> bool:
        return not self < other


class Balls:
    """The arithmetic of balls with so many bits, which stops its loops at 2^-tolerance_bits."""

    is_array = False
    nan = Ball(arb("nan"))

    def __init__(self, bits: int, tolerance_bits: int) -> None:
        self.bits = bits
        self.eps = Ball(arb(2) ** -tolerance_bits)

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that sets the precision of Arb."""
        return _bits(self.bits)

    @property
    def pi(self) -> Ball:
        """The number pi."""
        return Ball(arb.pi())

    @staticmethod
    def convert(value: float | Fraction) -> Ball:
        """Return a ball that holds an exact value."""
        exact = Fraction(value)
        return Ball(arb(fmpq(exact.numerator, exact.denominator)))

    @staticmethod
    def sqrt(x: Ball | int) -> Ball:
        """Return the square root."""
        return Ball(Ball.arb_of(x).sqrt())

    @staticmethod
    def sin(x: Ball) -> Ball:
        """Return the sine."""
        return Ball(x.ball.sin())

    @staticmethod
    def cos(x: Ball) -> Ball:
        """Return the cosine."""
        return Ball(x.ball.cos())

    @staticmethod
    def atan2(y: Ball, x: Ball) -> Ball:
        """Return the angle of the point (x, y)."""
        return Ball(arb.atan2(y.ball, x.ball))

    @staticmethod
    def where(condition: bool, yes: Ball | int, no: Ball | int) -> Ball:
        """Return one of two numbers."""
        return Ball(Ball.arb_of(yes if condition else no))

    @staticmethod
    def anywhere(condition: Any) -> bool:
        """Return whether the condition holds."""
        return bool(condition)

    everywhere = anywhere


@contextmanager
def _bits(bits: int) -> Any:
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before
