"""Proved rounding: more digits, until both ends of an enclosure round alike (Ziv 1991).

A number is rounded to a double or to N digits.

Two numbers that agree to D digits are equal.  D is 1,200, plus ten times the digits of the longest
input or of the output, whichever has more.  Nine doubles hold less than 180 digits: numbers
computed from them that differ at all differ, for all practical purposes, within some hundreds of
digits.  A sign that D digits leave open is 0, and a number that they cannot round is a tie.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from decimal import ROUND_UP, Context, Decimal
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

from ..errors import LagtopError, OutOfRangeError
from .ball import BITS, Ball, TooFewDigitsError, balls
from .text import NumberText, own_context

S = TypeVar("S")

FIRST_DIGITS, MOST_DIGITS = 32, 4_500
"""Digits of the first enclosure of a double, and of the last before a question stays open."""
_EQUAL_DIGITS = 1_200
"""Least number of digits that equal numbers have in common."""
_GUARD = 10
"""Extra digits of an enclosure beyond the N digits requested."""
_OUTWARDS, _SHORT = own_context(20, [], ROUND_UP), own_context(2, [], ROUND_UP)
_A_HAIR_MORE = Decimal("1.000000000001")

DecimalOrFraction = Decimal | Fraction


class Rounded(NamedTuple):
    """A number as it is printed, and the ball or the fraction that it is rounded from."""

    value: Any
    exact: Ball | Fraction

    @property
    def radius(self) -> NumberText:
        """Largest possible distance of the exact value from the number, rounded up to two digits.

        It is rounded up so far that the double read from the text is not smaller.
        """
        ends = self.exact.ends() if isinstance(self.exact, Ball) else (self.exact,)
        away = max(_distance(end, self.value) for end in ends)
        return text_of(_SHORT.multiply(away, _A_HAIR_MORE), _SHORT.prec)


def equal_digits(numbers: Iterable[Fraction], digits: int = 0) -> int:
    """Return D: two numbers that are computed from some exact numbers are equal to D digits or not.

    `digits` is the number of digits of the output.
    """
    bits = max(max(x.numerator.bit_length(), x.denominator.bit_length()) for x in numbers)
    return _EQUAL_DIGITS + 10 * max(int(bits / BITS), digits)


def precisions(digits: int = 0, more: int = 0, most: int = MOST_DIGITS) -> Iterator[int]:
    """Yield the digits of enclosures to try for a number of `digits` digits, at most `most`.

    `more` is the number of digits that are lost in any case, for example to whole turns.
    """
    working, last = max(FIRST_DIGITS, digits + _GUARD) + more, most + more
    while working < last:
        yield working
        working *= 4
    yield last


def decided(
    what: str, compute: Callable[[int], S], digits: int = 0, more: int = 0, most: int = MOST_DIGITS
) -> S:
    """Return the first result that some number of digits decides, at that precision of Arb.

    Raises LagtopError if no number of digits does.
    """
    for working in precisions(digits, more, most):
        try:
            with balls(working):
                return compute(working)
        except TooFewDigitsError:
            continue
    raise LagtopError(f"{what} cannot be distinguished from 0 or a tie with {most} digits")


def sign_of(number: Callable[[int], Ball | None], most: int) -> int:
    """Return the sign of a number from its balls; 0 if `most` digits leave it open.

    The sign of a number that does not exist is 0.
    """
    for working in precisions(most=most):
        with balls(working), suppress(TooFewDigitsError):
            ball = number(working)
            return 0 if ball is None or not ball else 1 if ball > 0 else -1
    return 0


def settled(
    what: str,
    enclosure: Callable[[int], Ball | None],
    rounding: Callable[[DecimalOrFraction], Any],
    *,
    digits: int = 0,
    more: int = 0,
    most: int = MOST_DIGITS,
) -> Rounded | None:
    """Return the rounding of a number from balls with more and more digits; None for None.

    `digits` is the number of digits of the output, 0 for doubles.

    A ball of `most` digits that still cannot be rounded holds a 0 or a tie: the number is then the
    simplest fraction in it.  Raises LagtopError for a ball that is wide even then.
    """

    def attempt(working: int) -> Rounded | None:
        ball = enclosure(working)
        if ball is None:
            return None
        try:
            nearest = 0.0 if digits else float(ball)
            if nearest and math.isfinite(nearest):
                return Rounded(nearest, ball)
            return Rounded(_alike(ball, rounding), ball)
        except TooFewDigitsError:
            if working < most + more:
                raise
            value = ball.simplest()
            if not ball.x.rel_one_accuracy_bits() > most:
                raise
            return Rounded(rounding(value), value)

    return decided(what, attempt, digits, more, most)


def _alike(ball: Ball, rounding: Callable[[DecimalOrFraction], Any]) -> Any:
    """Return the number to which both ends of a ball are rounded.

    It is 0 only if the ball is exactly 0.  Raises TooFewDigitsError if the ends round differently,
    or if they are too far apart to determine the size of the number.
    """
    low, high = ball.ends()
    small, large = sorted((low.copy_abs(), high.copy_abs()))
    if low.is_signed() != high.is_signed() or large > _OUTWARDS.multiply(small, 2):
        raise TooFewDigitsError
    value = rounding(low)
    if value != rounding(high):
        raise TooFewDigitsError
    return value


def rounded(what: str, enclosure: Callable[[int], Ball]) -> float:
    """Return the correctly rounded double; 0 also for a number proved to be too small.

    A ball that is NaN gives NaN.  Raises LagtopError if no precision decides.
    """

    def nearest(digits: int) -> float:
        ball = enclosure(digits)
        return math.nan if ball.is_nan else float(ball) + 0.0  # never -0.0

    return decided(what, nearest)


def nearest_double(name: str) -> Callable[[DecimalOrFraction], float]:
    """Return the function that rounds a number to a double.

    It raises OutOfRangeError for a number beyond the doubles, or smaller than all doubles but 0.
    """

    def rounding(value: DecimalOrFraction) -> float:
        try:
            nearest = float(value)
        except OverflowError:  # of a fraction; a decimal becomes infinite
            nearest = math.inf
        if math.isinf(nearest):
            raise OutOfRangeError(
                f"{name} must be within 1.8e308 in size, got {_short(value)}: change the units"
            )
        if value and not nearest:
            raise OutOfRangeError(
                f"{name} must be 0 or at least 5e-324 in size, got {_short(value)}: use digits=N"
            )
        return nearest + 0.0  # never -0.0

    return rounding


def _decimal(value: DecimalOrFraction, context: Context) -> Decimal:
    """Return a number as a decimal, rounded in a context."""
    if isinstance(value, Fraction):
        return context.divide(Decimal(value.numerator), Decimal(value.denominator))
    return context.plus(value)


def _short(value: DecimalOrFraction) -> str:
    """Return a number with four digits, for a message."""
    return f"{_decimal(value, own_context(20, [])):.3e}"


def rounding_of(name: str, digits: int | None) -> Callable[[DecimalOrFraction], Any]:
    """Return the function that rounds a number to a double, or to `digits` significant digits."""
    return nearest_double(name) if digits is None else lambda value: text_of(value, digits)


def text_of(value: DecimalOrFraction, digits: int) -> NumberText:
    """Return a number with `digits` significant digits, in full if its size is ordinary."""
    context = own_context(digits, [])
    rounded = _decimal(value, context)
    if not rounded:
        return NumberText("0.0")
    rounded = rounded.normalize(context)
    style = "f" if -5 < rounded.adjusted() < 16 else "e"
    figures, e, exponent = f"{rounded:{style}}".partition("e")
    point = "" if "." in figures else ".0"
    return NumberText(f"{figures}{point}{e}{exponent}")


def _distance(end: DecimalOrFraction, value: float | NumberText) -> Decimal:
    """Return the distance of two numbers in 20 digits, rounded up."""
    if isinstance(end, Decimal):
        return _OUTWARDS.subtract(end, Decimal(value)).copy_abs()
    away = abs(end - Fraction(value))
    return _OUTWARDS.divide(Decimal(away.numerator), Decimal(away.denominator))
