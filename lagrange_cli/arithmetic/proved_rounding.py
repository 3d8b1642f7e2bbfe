"""Roundings that are proved: both ends of an enclosure round alike, or more bits are taken."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from decimal import ROUND_CEILING, Decimal
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

FIRST_BITS, MOST_BITS = 128, 20_000
"""Where the search for enough bits begins and where it ends; a thousand digits are 3322 bits."""
_GUARD_BITS = 48
_RADIUS_DIGITS = 2


class Proved(NamedTuple, Generic[T]):
    """A number as it is printed, and how far the exact value may be from that."""

    value: T
    radius: NumberText


def bits_to_try(digits: int = 0) -> Iterator[int]:
    """Yield the precisions to try for so many digits, each half as much again."""
    bits = max(FIRST_BITS, int(digits * 3.33) + _GUARD_BITS)
    while bits <= MOST_BITS:
        yield bits
        bits = bits * 3 // 2


def decided(what: str, compute: Callable[[int], S], digits: int = 0) -> S:
    """Return the first result that some number of bits decides.

    Raises LagtopError where no number of bits up to 20 000 does.
    """
    for bits in bits_to_try(digits):
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
    exactly: Callable[[], Fraction | None] = lambda: None,
) -> Proved[T] | None:
    """Return the rounding of a number of which every precision gives an enclosure; None for none.

    Both ends have to round alike.  Where the first precision leaves that open, `exactly` is asked:
    it may know the number.  Raises LagtopError where 20 000 bits do not decide.
    """
    known: Fraction | None = None
    asked = False

    def rounded(bits: int) -> Proved[T] | None:
        nonlocal known, asked
        if known is not None:
            return about(rounding(known), known)
        try:
            ball = enclosure(bits)
            return None if ball is None else _rounded(ball, bits, rounding)
        except TooFewDigitsError:
            known, asked = (known if asked else exactly()), True
            raise

    return decided(what, rounded, digits)


def _rounded(ball: Ball, bits: int, rounding: Callable[[Decimal | Fraction], T]) -> Proved[T]:
    """Return what both ends of a ball are rounded to.

    Raises TooFewDigitsError where they differ.
    """
    low, high = ball.ends(bits // 3 + 5)
    value = rounding(low)
    if value != rounding(high):
        raise TooFewDigitsError
    return about(value, low, high)


def about(value: T, *ends: Decimal | Fraction) -> Proved[T]:
    """Return a printed number with its distance from the farther end of an enclosure."""
    printed = Fraction(value)
    return Proved(value, radius_text(max(abs(Fraction(end) - printed) for end in ends)))


def radius_text(radius: Fraction) -> NumberText:
    """Return a radius in two digits, rounded up so far that the double that is read is no less."""
    context = own_context(_RADIUS_DIGITS, [])
    context.rounding = ROUND_CEILING
    outward = radius * (1 + Fraction(1, 10**12))
    shown = context.divide(Decimal(outward.numerator), Decimal(outward.denominator))
    return NumberText(text_of(shown, _RADIUS_DIGITS))
