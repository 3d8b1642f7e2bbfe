"""Numbers as they are printed, from balls of Arb of growing precision.

Every number is rounded from a ball that contains it: to the nearest double, or to N digits.  If
the ends of the ball round differently, it is computed again with more digits.  Two numbers that
agree to `equal_digits` are taken as equal: a ball of that many digits stands for the simplest
fraction in it, such as 0, 1, or a tie between two roundings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from fractions import Fraction
from typing import Any

from flint import arb, fmpq

from ..arithmetic.ball import OPEN, Ball, TooFewDigitsError, balls
from ..arithmetic.rounding import precisions, text_of
from ..arithmetic.text import NumberText, double_text
from ..errors import LagtopError, OutOfRangeError

Value = arb | Fraction | str | None
"""A number in a ball or as a fraction, a word, or None for a number that does not exist."""


NARROW = 3_000
"""Least number of bits to which a ball must be known to stand for a fraction."""


def rational(x: Fraction) -> fmpq:
    """Return a fraction as a number of FLINT, whose arithmetic is quicker."""
    return fmpq(x.numerator, x.denominator)


def exact(x: Fraction) -> arb:
    """Return a ball that contains a fraction."""
    return arb(rational(x))


def rounded(
    compute: Callable[[], Mapping[str, Value]], digits: int | None, most: int
) -> dict[str, Any]:
    """Return numbers by name as doubles, or with `digits` significant digits as texts.

    Words and None are left as they are.  A pole is None.  A number that no double can hold is an
    infinity or 0.  Raises LagtopError if `most` digits do not determine all numbers.
    """
    found: dict[str, Any] = {}
    for working in precisions(digits or 0, most=most):
        with balls(working), suppress(TooFewDigitsError):
            values = compute()
            for name, value in values.items():
                if name not in found:
                    result = _rounded(value, digits, is_last=working == most)
                    if result is not OPEN:
                        found[name] = result
            if len(found) == len(values):
                return {name: found[name] for name in values}
    raise LagtopError(f"{most} digits do not determine these numbers")


def _rounded(value: Value, digits: int | None, *, is_last: bool) -> Any:
    """Return a number as it is printed, or OPEN if its ball has numbers that round differently."""
    if isinstance(value, arb):
        if not value.is_finite():
            return None if is_last else OPEN
        low, high = _ends(value, digits)
        if low == high:
            return low
        if not (is_last and value.rel_one_accuracy_bits() > NARROW):
            return OPEN
        value = Ball(value).simplest()
    if isinstance(value, Fraction):
        return _double(value) if digits is None else text_of(value, digits)
    return value


def _ends(ball: arb, digits: int | None) -> tuple[Any, Any]:
    """Return both ends of a ball as they are printed."""
    if digits is None:
        return float(ball.lower()) + 0.0, float(ball.upper()) + 0.0  # never -0.0
    low, high = Ball(ball).ends()
    if (low > 0) is not (high > 0):  # decimals beyond the digits of 0 would read as 0, too
        return low, high
    return text_of(low, digits), text_of(high, digits)


def _double(value: Fraction) -> float:
    try:
        return float(value) + 0.0
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def cell(value: Any) -> NumberText:
    """Return a number as text, empty if it does not exist or no double can hold it."""
    if isinstance(value, float):
        return NumberText(double_text(value) if math.isfinite(value) else "")
    return NumberText(value or "")


def record(
    compute: Callable[[], Mapping[str, Value]], digits: int | None, most: int
) -> dict[str, Any]:
    """Return `rounded` numbers; raise OutOfRangeError if one is beyond the doubles."""
    found = rounded(compute, digits, most)
    for name, value in found.items():
        if isinstance(value, float) and math.isinf(value):
            raise OutOfRangeError(f"{name} is beyond the doubles: use --digits")
    return found
