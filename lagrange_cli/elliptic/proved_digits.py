"""Digits that are right and zeros that are proved, on top of Ziv's strategy in `correct_digits`.

Two precisions may agree by chance where few digits are asked for, or on a 0 that is none.  So they
must agree on more digits than are printed, and a computed 0 or pole counts as too few digits: it
has to be known from its formula.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

from ..arithmetic.correct_digits import NumberText, TooFewDigitsError, require_digits, settle
from ..arithmetic.generic import Arithmetic

__all__ = ["TooFewDigitsError", "require_digits", "settled_texts"]

_GUARD = 8
"""Digits that must agree beyond those that are printed."""


def settled_texts(
    compute: Callable[[Arithmetic], Mapping[str, Any]],
    digits: int,
    known: Collection[str] = (),
) -> dict[str, Any]:
    """Return numbers with so many significant digits, all right; texts and None as they are.

    `known` are the names of the numbers that may be 0 or not finite (which makes an empty text).
    Raises LagtopError where the digits do not settle.
    """
    latest: dict[str, Any] = {}

    def checked(ar: Arithmetic) -> Mapping[str, Any]:
        try:
            latest.update(compute(ar))
        except ZeroDivisionError:  # a divisor of which nothing is left
            raise TooFewDigitsError from None
        if any(_unproved(ar, value) for name, value in latest.items() if name not in known):
            raise TooFewDigitsError
        return latest

    texts = settle(checked, digits + _GUARD)
    return {name: _shorter(texts[name], value, digits) for name, value in latest.items()}


def _unproved(ar: Arithmetic, value: Any) -> bool:
    """Return whether a number is 0 or no number, which takes a proof."""
    return value is not None and not isinstance(value, str) and not (value and ar.isfinite(value))


def _shorter(text: Any, value: Any, digits: int) -> Any:
    """Return the text of a number with fewer digits; other texts stay."""
    if not isinstance(text, NumberText) or not text:
        return text
    return NumberText(value.context.nstr(value, digits, min_fixed=-5, max_fixed=16))
