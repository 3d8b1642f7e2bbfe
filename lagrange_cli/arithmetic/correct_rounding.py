"""Correct rounding: compute with more and more digits until the rounding is beyond doubt."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from decimal import Decimal, DivisionByZero, InvalidOperation
from fractions import Fraction
from typing import TypeVar

from ..errors import LagtopError, OutOfRangeError
from .decimals import own_context
from .text import NumberText

T = TypeVar("T")

FIRST_DIGITS = 32
_TIE = Decimal("1e-300")
"""Two values that differ by less, of their size, stay on both sides of a tie for ever."""
_MOST_DIGITS = 2_000


_INFINITE = float("inf")
_WIDE = own_context(2 * _MOST_DIGITS, [])
_PATIENCE = 2
"""Precisions to try before asking whether a number is known exactly."""


class TooFewDigitsError(Exception):
    """A number cannot be computed with the digits at hand."""


def precisions(first: int = FIRST_DIGITS, most: int = _MOST_DIGITS) -> Iterable[int]:
    """Yield the precisions to try, half as much again each time."""
    digits = first
    while digits <= most:
        yield digits
        digits = digits * 3 // 2


def correctly_rounded(
    name: str,
    value_in: Callable[[int], Decimal | None],
    rounding: Callable[[Decimal], T],
    *,
    first: int = FIRST_DIGITS,
    zero_is_proved: bool = False,
    exactly: Callable[[], T | None] = lambda: None,
    lost: int | None = None,
) -> T | None:
    """Return the rounding of a number that can be computed with any number of digits (Ziv 1991).

    The difference of two precisions in a row bounds the error of the better one; both ends of that
    interval have to round alike.  A computed 0 is believed only where it cannot be what is left of
    a cancellation.  Where two precisions are not enough, `exactly` is asked once: it may know the
    number.  Where nothing cancels, `lost` says how many digits roundings may take, and one
    precision is enough.  Raises LagtopError where none is.
    """
    previous: Decimal | None = None
    for i, digits in enumerate(precisions(first)):
        if i == _PATIENCE and (known := exactly()) is not None:
            return known
        try:
            value = value_in(digits)
        except (TooFewDigitsError, InvalidOperation, DivisionByZero):
            previous = None
            continue
        if value is None:
            return None
        if not value and zero_is_proved:
            return rounding(value)
        if lost is not None:
            previous = _WIDE.add(value, value.scaleb(lost - digits, _WIDE))
        if value and previous is not None:
            settled = _rounded(value, previous, rounding)
            if settled is not None:
                return settled
        previous = value
    raise LagtopError(f"{name} cannot be told from 0 or a tie with {_MOST_DIGITS} digits")


def _rounded(value: Decimal, previous: Decimal, rounding: Callable[[Decimal], T]) -> T | None:
    wide = _WIDE
    error, size = wide.abs(wide.subtract(value, previous)), wide.abs(value)
    if wide.compare(error, wide.multiply(size, Decimal("1e-3"))) > 0:
        return None
    low, high = rounding(wide.subtract(value, error)), rounding(wide.add(value, error))
    if low == high:
        return low
    if wide.compare(error, wide.multiply(size, _TIE)) < 0:
        return rounding(own_context(250, []).plus(value))
    return None


def nearest_double(name: str) -> Callable[[Decimal | Fraction], float]:
    """Return the rounding of a number to doubles.  It raises OutOfRangeError beyond them."""

    def rounding(value: Decimal | Fraction) -> float:
        nearest = float(value)
        if not abs(nearest) < _INFINITE:
            raise OutOfRangeError(
                f"{name} must be within 1.8e308 in size, got {value:.3e}: change the units"
            )
        return nearest

    return rounding


def text_of(value: Decimal | Fraction, digits: int) -> NumberText:
    """Return a number with so many significant digits, in full where its size is usual."""
    context = own_context(digits, [])
    if isinstance(value, Fraction):
        rounded = context.divide(Decimal(value.numerator), Decimal(value.denominator))
    else:
        rounded = context.plus(value)
    if not rounded:
        return NumberText("0.0")
    sign, figures, _ = rounded.normalize(context).as_tuple()
    exponent = rounded.adjusted()
    text = "".join(map(str, figures))
    if -5 < exponent < 16:
        if exponent < 0:
            body = "0." + "0" * (-exponent - 1) + text
        else:
            text = text.ljust(exponent + 1, "0")
            body = text[: exponent + 1] + "." + (text[exponent + 1 :] or "0")
    else:
        body = f"{text[0]}.{text[1:] or '0'}e{exponent:+d}"
    return NumberText("-" * sign + body)
