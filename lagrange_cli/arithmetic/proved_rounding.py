"""Roundings that are proved: both ends of an enclosure round alike, or more bits are taken."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from decimal import ROUND_UP, Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

from ..errors import LagtopError
from .correct_rounding import TooFewDigitsError, text_of
from .decimals import own_context
from .text import NumberText

if TYPE_CHECKING:
    from .balls import Ball

T = TypeVar("T", float, NumberText)
S = TypeVar("S")

FIRST_BITS, MOST_BITS = 192, 20_000
"""Where the search for enough bits begins and where it ends; a thousand digits are 3322 bits."""
_GUARD_BITS = 48
_OUTWARDS, _SHORT = own_context(20, []), own_context(2, [])
_OUTWARDS.rounding = _SHORT.rounding = ROUND_UP
_A_HAIR_MORE = Decimal("1.000000000001")


class Proved(NamedTuple, Generic[T]):
    """A number as it is printed, and how far the exact value may be from that."""

    value: T
    radius: NumberText


def bits_to_try(digits: int = 0, more: int = 0) -> Iterator[int]:
    """Yield the precisions to try for so many digits and some `more` bits, each half more."""
    bits = max(FIRST_BITS, int(digits * 3.33) + _GUARD_BITS) + more
    while bits <= MOST_BITS:
        yield bits
        bits = bits * 3 // 2


def decided(what: str, compute: Callable[[int], S], digits: int = 0, more: int = 0) -> S:
    """Return the first result that some number of bits decides.

    Raises LagtopError where no number of bits up to 20 000 does.
    """
    for bits in bits_to_try(digits, more):
        try:
            return compute(bits)
        except TooFewDigitsError:
            continue
    raise LagtopError(f"{what} cannot be told from 0 or a tie with {MOST_BITS} bits")


def proved(
    what: str,
    enclosure: Callable[[int], Ball | None],
    rounding: Callable[[Decimal | Fraction], T],
    *,
    digits: int = 0,
    more: int = 0,
    exactly: Callable[[], Fraction | None] = lambda: None,
) -> Proved[T] | None:
    """Return the rounding of a number of which every precision gives an enclosure; None for none.

    Both ends have to round alike.  Whole turns, say, take some `more` bits.  Where the first
    precision leaves a number open, `exactly` is asked: it may know it.  Raises LagtopError where
    20 000 bits do not decide.
    """
    known: Fraction | None = None
    asked = False

    def attempt(bits: int) -> Proved[T] | None:
        nonlocal known, asked
        if known is not None:
            return about(rounding(known), known)
        try:
            ball = enclosure(bits)
            return None if ball is None else _alike(ball, bits, rounding)
        except TooFewDigitsError:
            known, asked = (known if asked else exactly()), True
            raise

    return decided(what, attempt, digits, more)


def _alike(ball: Ball, bits: int, rounding: Callable[[Decimal | Fraction], T]) -> Proved[T]:
    """Return what both ends of a ball are rounded to, with its distance from them.

    Raises TooFewDigitsError where they are rounded differently.
    """
    low, high = ball.ends(bits // 3 + 5)
    value = rounding(low)
    if value != rounding(high):
        raise TooFewDigitsError
    return about(value, low, high)


def about(value: T, *ends: Decimal | Fraction) -> Proved[T]:
    """Return a printed number with its distance from the farther end of an enclosure.

    The distance is rounded up to two digits, and so far that the double that is read is no less.
    """
    away = max(_distance(end, value) for end in ends)
    return Proved(value, text_of(_SHORT.multiply(away, _A_HAIR_MORE), _SHORT.prec))


def _distance(end: Decimal | Fraction, value: float | NumberText) -> Decimal:
    """Return the distance of two numbers in 20 digits, rounded up."""
    if isinstance(end, Decimal):
        return _OUTWARDS.subtract(end, Decimal(value)).copy_abs()
    away = abs(end - Fraction(value))
    return _OUTWARDS.divide(Decimal(away.numerator), Decimal(away.denominator))
