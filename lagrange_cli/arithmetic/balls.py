"""Arb's balls as an arithmetic: every result is proved to hold the exact value.

Roundings are Arb's own business; what an iteration leaves out is added by `widened`, with the bound
that stands beside the iteration.  A question that the balls leave open is no answer: `Open` raises
TooFewDigitsError where a decision hangs on it, and the next precision is tried.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import AbstractContextManager
from decimal import Decimal
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

from ..errors import UnavailableError
from .correct_rounding import TooFewDigitsError
from .decimals import own_context

try:
    from flint import arb, ctx, fmpq
except ImportError:
    raise UnavailableError(
        "proved digits need python-flint: pip install 'lagtop[certify]'"
    ) from None

if TYPE_CHECKING:
    Truth = Any


class Open:
    """What no precision so far decides: neither true nor false."""

    def __bool__(self) -> bool:
        raise TooFewDigitsError


OPEN = Open()


class Ball:
    """A ball; its comparisons are True, False or OPEN."""

    __slots__ = ("arb",)

    def __init__(self, value: arb) -> None:
        self.arb = value

    def __repr__(self) -> str:
        return f"Ball({self.arb})"

    def __add__(self, other: Ball | int) -> Ball:
        return Ball(self.arb + (other.arb if isinstance(other, Ball) else other))

    def __mul__(self, other: Ball | int) -> Ball:
        return Ball(self.arb * (other.arb if isinstance(other, Ball) else other))

    __radd__, __rmul__ = __add__, __mul__

    def __sub__(self, other: Ball | int) -> Ball:
        return Ball(self.arb - (other.arb if isinstance(other, Ball) else other))

    def __rsub__(self, other: int) -> Ball:
        return Ball(other - self.arb)

    def __truediv__(self, other: Ball | int) -> Ball:
        return Ball(self.arb / (other.arb if isinstance(other, Ball) else other))

    def __rtruediv__(self, other: int) -> Ball:
        return Ball(other / self.arb)

    def __pow__(self, power: Ball | int) -> Ball:
        return Ball(self.arb ** _plain(power))

    def __neg__(self) -> Ball:
        return Ball(-self.arb)

    def __abs__(self) -> Ball:
        return Ball(abs(self.arb))

    def __bool__(self) -> bool:
        if self.arb.is_zero():
            return False
        if self.arb != 0:
            return True
        raise TooFewDigitsError

    def __lt__(self, other: Ball | int) -> Truth:
        right = _plain(other)
        return True if self.arb < right else False if self.arb >= right else OPEN

    def __le__(self, other: Ball | int) -> Truth:
        right = _plain(other)
        return True if self.arb <= right else False if self.arb > right else OPEN

    def __gt__(self, other: Ball | int) -> Truth:
        right = _plain(other)
        return True if self.arb > right else False if self.arb <= right else OPEN

    def __ge__(self, other: Ball | int) -> Truth:
        right = _plain(other)
        return True if self.arb >= right else False if self.arb < right else OPEN

    def radius(self) -> Ball:
        """Return the radius of the ball, which is exact."""
        return Ball(self.arb.rad())

    def least_size(self) -> Ball:
        """Return a number, exact, that all in the ball are at least in size."""
        return Ball(self.arb.abs_lower())

    def greatest_size(self) -> float:
        """Return a double that all in the ball are at most in size."""
        return math.nextafter(float(self.arb.abs_upper()), math.inf)

    def holds(self, other: Ball) -> bool:
        """Return whether all of another ball is within this one."""
        return self.arb.is_finite() and self.arb.contains(other.arb)

    def ends(self, digits: int) -> tuple[Decimal, Decimal]:
        """Return decimals below and above all of the ball, which know so many digits of it.

        Raises TooFewDigitsError for a ball without bounds.
        """
        if not self.arb.is_finite():
            raise TooFewDigitsError
        middle, radius, exponent = map(int, self.arb.mid_rad_10exp(digits))
        wide = own_context(digits + 50, [])
        low, high = (
            wide.scaleb(Decimal(end), exponent) for end in (middle - radius, middle + radius)
        )
        return low, high


def _plain(other: Ball | int) -> arb | int:
    return other.arb if isinstance(other, Ball) else other


class Balls:
    """The arithmetic of balls with so many bits, in which iterations stop at 2^-`stop`.

    Wherever they stop, the ball that they give is right: only its radius hangs on that.
    """

    is_array = False
    nan = Ball(arb("nan"))

    def __init__(self, bits: int, stop: int | None = None) -> None:
        self.bits = bits
        self.stop = bits if stop is None else stop
        self.digits = int(self.stop * 0.30103)

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that sets the precision of Arb in this thread."""
        return _Precision(self.bits)

    @cached_property
    def eps(self) -> Ball:
        """What iterations may leave out."""
        return Ball(arb(fmpq(1, 1 << self.stop)))

    @property
    def pi(self) -> Ball:
        """The number pi."""
        return Ball(arb.pi())

    @staticmethod
    def convert(value: float | Fraction) -> Ball:
        """Return a ball that holds an exact value."""
        if isinstance(value, Fraction):
            return Ball(arb(fmpq(value.numerator, value.denominator)))
        return Ball(arb(value))

    @staticmethod
    def sqrt(x: Ball | int) -> Ball:
        """Return the square root of x >= 0."""
        return Ball(arb(_plain(x)).sqrt())

    @staticmethod
    def sin(x: Ball) -> Ball:
        """Return the sine of x."""
        return Ball(x.arb.sin())

    @staticmethod
    def cos(x: Ball) -> Ball:
        """Return the cosine of x."""
        return Ball(x.arb.cos())

    @staticmethod
    def exp(x: Ball) -> Ball:
        """Return e to the power x."""
        return Ball(x.arb.exp())

    @staticmethod
    def sinh(x: Ball) -> Ball:
        """Return the hyperbolic sine of x."""
        return Ball(x.arb.sinh())

    @staticmethod
    def cosh(x: Ball) -> Ball:
        """Return the hyperbolic cosine of x."""
        return Ball(x.arb.cosh())

    @staticmethod
    def asinh(x: Ball) -> Ball:
        """Return the inverse hyperbolic sine of x."""
        return Ball(x.arb.asinh())

    @staticmethod
    def atan2(y: Ball, x: Ball) -> Ball:
        """Return the angle of the point (x, y); all of [-pi, pi] where it may lie on the cut."""
        return Ball(arb.atan2(y.arb, x.arb))

    @staticmethod
    def nint(x: Ball) -> int:
        """Return an integer within 3/4 of all of x.

        Raises TooFewDigitsError for a ball that is wider than half a unit.
        """
        if not (x.arb.is_finite() and x.arb.rad() <= 0.25):
            raise TooFewDigitsError
        mantissa, exponent = (int(part) for part in x.arb.mid().man_exp())
        if exponent >= 0:
            return mantissa << exponent
        return (2 * mantissa + (1 << -exponent)) >> (1 - exponent)

    @staticmethod
    def ceiling(x: Ball) -> int:
        """Return the least integer that is at least x; TooFewDigitsError where x is about one."""
        integer = x.arb.ceil().unique_fmpz() if x.arb.is_finite() else None
        if integer is None:
            raise TooFewDigitsError
        return int(integer)

    @staticmethod
    def where(condition: Truth, yes: Ball | int, no: Ball | int) -> Ball:
        """Return one of two numbers, or a ball about both where the condition is open."""
        if condition is OPEN:
            return Ball(arb(_plain(yes)).union(arb(_plain(no))))
        return Ball(arb(_plain(yes if condition else no)))

    @staticmethod
    def anywhere(condition: Truth) -> bool:
        """Return whether a condition holds.  Raises TooFewDigitsError where it is open."""
        return bool(condition)

    everywhere = anywhere

    @staticmethod
    def widened(x: Ball, remainder: Callable[[], Ball]) -> Ball:
        """Return a ball that holds all numbers at most a remainder away from x."""
        return Ball(x.arb + arb(0, remainder().arb.abs_upper()))


def near_largest_root(c2: arb, c1: arb, c0: arb, bound: arb) -> arb:
    """Return a point next to the largest root of x^3 + c2 x^2 + c1 x + c0, all of them real.

    Laguerre's method falls to it from a bound above, three times as many digits at each step, but
    for a double root.  The point is exact, and proves nothing.
    """
    x, least = bound, arb(2) ** (4 - ctx.prec)
    for _ in range(4 * ctx.prec):
        value, slope = ((x + c2) * x + c1) * x + c0, (3 * x + 2 * c2) * x + c1
        curved = 4 * slope * slope - 12 * value * (3 * x + c2)
        step = (3 * value / (slope + arb(curved.mid()).nonnegative_part().sqrt())).mid()
        x = (x - step).mid()
        if not step > least * abs(x):
            break
    return x


@lru_cache(maxsize=16)
def balls(bits: int) -> Balls:
    """Return the balls of so many bits, always the same object."""
    return Balls(bits)


class _Precision:
    """A context manager that sets the precision of Arb, quicker than one made of a generator."""

    __slots__ = ("before", "bits")

    def __init__(self, bits: int) -> None:
        self.bits = bits

    def __enter__(self) -> None:
        self.before, ctx.prec = ctx.prec, self.bits

    def __exit__(self, *raised: object) -> None:
        ctx.prec = self.before
