"""Balls of Arb (python-flint): real numbers with proved error bounds.

A ball holds the exact value of a number.  A comparison that the balls do not settle is `OPEN`.  It
raises TooFewDigitsError when a decision depends on it, and the caller repeats the computation with
more digits (see `rounding.decided`).

The precision of Arb is global.  `with balls(digits):` sets it, for one thread at a time, and
restores the precision of the host program.  Operations at another precision give valid but wider
balls.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal
from fractions import Fraction
from functools import lru_cache
from threading import RLock
from typing import Any, Self

from flint import acb, arb, ctx, fmpq

from ..errors import OutOfRangeError
from .enclosures import TooFewDigitsError as TooFewDigitsError  # noqa: PLC0414
from .numbers import Scalars

BITS = 3.3219280948873626
"""Bits per decimal digit."""
LARGEST_EXPONENT = 990_000_000_000_000_000
"""The greatest size of an exponent of a number that is printed in decimal."""

Truth = Any
"""True, False or OPEN."""


class UndefinedError(ArithmeticError):
    """A question about a number that does not exist."""


class Open:
    """The result of a comparison that is neither proved nor disproved."""

    def __bool__(self) -> bool:
        raise TooFewDigitsError


OPEN = Open()


def _operation(of: Callable[[Any, Any], Any]) -> Callable[[Ball, Ball | float], Ball]:
    """Return the method for an operation of Arb on a ball and a ball or an exact number."""
    return lambda x, y: Ball(of(x.x, y.x if isinstance(y, Ball) else y))


def _comparison(
    holds: Callable[[Any, Any], bool], fails: Callable[[Any, Any], bool]
) -> Callable[[Ball, Ball | float], Truth]:
    """Return a comparison from the relation that proves it and the relation that disproves it."""

    def compare(x: Ball, y: Ball | float) -> Truth:
        left, right = x.x, y.x if isinstance(y, Ball) else y
        if holds(left, right):
            return True
        if fails(left, right):
            return False
        if x.is_nan or (isinstance(y, Ball) and y.is_nan):
            raise UndefinedError
        return OPEN

    return compare


_UNBOUNDED = arb(0, float("inf"))


def _result(value: arb, *of: Any) -> Ball:
    """Return a function of numbers; Arb returns NaN if they may be outside of its domain.

    If they exist it is unbounded instead, because more digits may show that they are inside.
    """
    if value.is_finite() or not value.is_nan():
        return Ball(value)
    return Ball(value if any(isinstance(x, arb) and x.is_nan() for x in of) else _UNBOUNDED)


class Ball:
    """A ball of Arb `x`, whose comparisons are True, False or OPEN.

    A number that does not exist, such as x/0, is NaN.  A ball without bounds says nothing of its
    number: more digits are needed.
    """

    __slots__ = ("x",)
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, x: arb) -> None:
        self.x = x

    def __repr__(self) -> str:
        return f"Ball({self.x})"

    __add__, __sub__, __mul__ = map(_operation, (operator.add, operator.sub, operator.mul))
    __radd__, __rmul__ = __add__, __mul__
    __rsub__ = _operation(lambda x, y: y - x)
    __pow__ = _operation(operator.pow)
    __lt__ = _comparison(operator.lt, operator.ge)
    __le__ = _comparison(operator.le, operator.gt)
    __gt__ = _comparison(operator.gt, operator.le)
    __ge__ = _comparison(operator.ge, operator.lt)
    __eq__ = _comparison(operator.eq, operator.ne)  # type: ignore[assignment]

    def __truediv__(self, other: Ball | float) -> Ball:
        divisor = other.x if isinstance(other, Ball) else other
        quotient = self.x / divisor
        return Ball(quotient) if divisor == 0 else _result(quotient, self.x, divisor)

    def __rtruediv__(self, other: float) -> Ball:
        return Ball(arb(other)) / self

    def __neg__(self) -> Ball:
        return Ball(-self.x)

    def __abs__(self) -> Ball:
        return Ball(abs(self.x))

    def __bool__(self) -> bool:
        if self.x == 0:
            return False
        if self.x != 0:
            return True
        raise TooFewDigitsError

    def __float__(self) -> float:
        """Return the double nearest to every number in the ball.

        Raises TooFewDigitsError if the numbers round to different doubles.
        """
        if self.x.is_exact():
            return float(self.x)
        low, high = float(self.x.lower()), float(self.x.upper())
        if low != high:
            raise TooFewDigitsError
        return low

    @property
    def is_nan(self) -> bool:
        """Whether the number does not exist."""
        return self.x.is_nan()

    @property
    def middle(self) -> Ball:
        """The midpoint, an exact number."""
        return Ball(self.x.mid())

    @property
    def radius(self) -> Ball:
        """The radius, an exact number."""
        return Ball(self.x.rad())

    @property
    def greatest(self) -> Ball:
        """An upper bound of the sizes of all numbers in the ball, an exact number."""
        return Ball(self.x.abs_upper())

    @property
    def least(self) -> Ball:
        """A lower bound of the sizes of all numbers in the ball, an exact number."""
        return Ball(self.x.abs_lower())

    def is_known_to(self, digits: int) -> bool:
        """Return whether the ball is 0, or its radius at most about 10^-digits of its numbers."""
        return bool(self.x == 0 or self.x.rel_accuracy_bits() > digits * BITS)

    def ends(self) -> tuple[Decimal, Decimal]:
        """Return decimals below and above all numbers in the ball.

        Raises TooFewDigitsError for a ball without bounds, and OutOfRangeError for a number whose
        size is not within 1e-990000000000000000 and 1e+990000000000000000.
        """
        if not self.x.is_finite():
            raise TooFewDigitsError
        digits = int(max(ctx.prec, self.x.bits()) / BITS) + 8
        middle, radius, exponent = map(int, self.x.mid_rad_10exp(digits))
        if abs(exponent) > LARGEST_EXPONENT and (middle or radius):
            raise OutOfRangeError(
                "the size of a value is not within 1e-990000000000000000 and "
                "1e+990000000000000000, the limits of digits: take a smaller argument"
            )
        low, high = Decimal(middle - radius), Decimal(middle + radius)
        return _EXACT.scaleb(low, exponent), _EXACT.scaleb(high, exponent)

    def simplest(self) -> Fraction:
        """Return the fraction with the smallest denominator in the ball.

        Raises TooFewDigitsError for a ball without bounds.
        """
        if not self.x.is_finite():
            raise TooFewDigitsError
        return simplest_between(exact_fraction(self.x.lower()), exact_fraction(self.x.upper()))


_EXACT = Context(1_000_000, Emin=MIN_EMIN, Emax=MAX_EMAX, traps=[])
"""More digits than any ball has."""
_LOCK, _NOTHING = RLock(), nullcontext()


def _function(name: str) -> staticmethod[[Ball], Ball]:
    """Return the method for an elementary function."""
    function = operator.methodcaller(name)
    return staticmethod(lambda x: _result(function(x.x), x.x))


class Balls(Scalars):
    """The arithmetic of balls with `digits` digits, and the context that sets this precision."""

    nan, inf, unbounded = Ball(arb("nan")), Ball(arb("inf")), Ball(_UNBOUNDED)
    exp, sin, cos, sinh, cosh = map(_function, "exp sin cos sinh cosh".split())
    tanh, sech, asinh = map(_function, "tanh sech asinh".split())

    def __init__(self, digits: int) -> None:
        self.digits, self.bits, self.magnitude = digits, int(digits * BITS) + 2, 1 - digits
        self._before: list[int] = []

    def __enter__(self) -> Self:
        _LOCK.acquire()
        self._before.append(ctx.prec)
        ctx.prec = self.bits
        return self

    def __exit__(self, *_: object) -> None:
        ctx.prec = self._before.pop()
        _LOCK.release()

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that sets this precision unless it is in use."""
        return _NOTHING if ctx.prec == self.bits else self

    @property
    def pi(self) -> Ball:
        """The number pi."""
        return Ball(arb.pi())

    @property
    def eps(self) -> Ball:
        """The distance from 1 to the next number, about 10^(1 - digits)."""
        return Ball(arb(2) ** -int((self.digits - 1) * BITS))

    def convert(self, value: Ball | float | Fraction) -> Ball:
        """Return a ball that holds an exact value, or a ball unchanged."""
        if isinstance(value, Ball):
            return value
        if isinstance(value, int | float):
            return Ball(arb(value))
        exact = Fraction(value)
        return Ball(arb(fmpq(exact.numerator, exact.denominator)))

    def sqrt(self, x: Ball | int) -> Ball:
        """Return the square root, that of the part of the ball that is not negative."""
        square = self.convert(x).x
        root = square.sqrt()
        if not root.is_finite() and square.is_finite() and not square < 0:
            root = square.nonnegative_part().sqrt()
        return _result(root, square)

    def atan2(self, y: Ball, x: Ball) -> Ball:
        """Return the angle of the point (x, y); all angles if it may lie on the cut or at 0."""
        return Ball(arb.atan2(y.x, x.x))

    def where(self, condition: Truth, yes: Ball | float, no: Ball | float) -> Ball:
        """Return one of two numbers, or a ball that holds both if the condition is open."""
        yes, no = self.convert(yes), self.convert(no)
        if condition is OPEN:
            return self.between(yes, no)
        return yes if condition else no

    @staticmethod
    def between(x: Ball, y: Ball) -> Ball:
        """Return a ball that holds both numbers and all numbers between them."""
        return Ball(x.x.union(y.x))

    @staticmethod
    def either(condition: Truth) -> bool:
        """Return whether a condition is proved; both answers must lead to the right result."""
        return condition is True

    @staticmethod
    def nint(x: Ball) -> int:
        """Return an integer within 3/4 of all numbers in x.

        Raises TooFewDigitsError for a ball wider than half a unit.
        """
        if not x.x.rad() <= 0.25:
            raise TooFewDigitsError
        return round(exact_fraction(x.x.mid()))

    @staticmethod
    def ceiling(x: Ball) -> int:
        """Return the least integer >= x; raise TooFewDigitsError if x leaves it open."""
        whole = x.x.ceil().unique_fmpz()
        if whole is None:
            raise TooFewDigitsError
        return int(whole)

    @staticmethod
    def agm(a: Ball | int, b: Ball) -> Ball:
        """Return the arithmetic-geometric mean of numbers that are not negative."""
        return Ball(b.x.agm(a.x if isinstance(a, Ball) else arb(a)))

    @staticmethod
    def carlson_rf(x: Ball, y: Ball, z: Ball) -> Ball:
        """Return Carlson's R_F of real numbers that are not negative."""
        return Ball(acb.elliptic_rf(acb(x.x), acb(y.x), acb(z.x)).real)

    @staticmethod
    def carlson_rd(x: Ball, y: Ball, z: Ball) -> Ball:
        """Return Carlson's R_D of real numbers that are not negative."""
        return Ball(acb.elliptic_rd(acb(x.x), acb(y.x), acb(z.x)).real)


@lru_cache(maxsize=64)
def balls(digits: int) -> Balls:
    """Return the arithmetic of balls with `digits` digits, always the same object."""
    return Balls(digits)


def pi_to(digits: int) -> Fraction:
    """Return pi to `digits` significant digits or a few more."""
    with balls(digits + 4):
        return exact_fraction(arb.pi().mid())


def exact_fraction(x: arb) -> Fraction:
    """Return the value of an exact number of Arb."""
    ratio = x.fmpq()
    return Fraction(int(ratio.p), int(ratio.q))


def simplest_between(low: Fraction, high: Fraction) -> Fraction:
    """Return the fraction with the smallest denominator in an interval, by continued fractions."""
    if low <= 0 <= high:
        return Fraction(0)
    if high < 0:
        return -simplest_between(-high, -low)
    terms = []
    while math.ceil(low) > high:
        terms.append(math.floor(low))
        low, high = 1 / (high - terms[-1]), 1 / (low - terms[-1])
    value = Fraction(math.ceil(low))
    for term in reversed(terms):
        value = term + 1 / value
    return value
