"""Digits that are right and zeros that are proved, of functions that only mpmath has.

Ziv's strategy, as in `arithmetic.correct_rounding`, for many numbers at once: more and more digits
until two precisions agree.  They may agree by chance where few digits are asked for, or on a 0 that
is none.  So they must agree on more digits than are printed, and a computed 0 or pole counts as too
few digits: it has to be known from its formula.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

from ..arithmetic.correct_rounding import TooFewDigitsError, precisions
from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.text import NumberText
from ..errors import LagtopError

_GUARD = 8
"""Digits that must agree beyond those that are printed."""


def require_digits(ar: ManyDigits, digits: int, size: Any) -> None:
    """Raise TooFewDigitsError where a number of this size has fewer digits behind the point."""
    if size > 1 and ar.log10(size) + digits + 5 > ar.dps:
        raise TooFewDigitsError


def settled_or_rounded(
    compute: Callable[[ManyDigits], Mapping[str, Any]],
    digits: int | None,
    known: Collection[str] = (),
) -> dict[str, Any]:
    """Return numbers as `settled_texts` does or, without `digits`, each the nearest double."""
    if digits is not None:
        return settled_texts(compute, digits, known)
    exact = compute(ManyDigits())
    return {name: x if x is None or isinstance(x, str) else float(x) for name, x in exact.items()}


def settled_texts(
    compute: Callable[[ManyDigits], Mapping[str, Any]],
    digits: int,
    known: Collection[str] = (),
) -> dict[str, Any]:
    """Return numbers with so many significant digits, all right; texts and None as they are.

    `known` are the names of the numbers that may be 0 or not finite (which makes an empty text).
    Raises LagtopError where the digits do not settle.
    """
    wanted, most = digits + _GUARD, 20 * (digits + _GUARD) + 4000
    previous: dict[str, Any] | None = None
    for working in precisions(wanted + 15, most):
        ar = ManyDigits(working)
        try:
            values = compute(ar)
        except (TooFewDigitsError, ZeroDivisionError):  # a divisor of which nothing is left
            continue
        if any(_unproved(ar, value) for name, value in values.items() if name not in known):
            continue
        texts = {name: _text(ar, value, wanted) for name, value in values.items()}
        if texts == previous:
            return {name: _text(ar, value, digits) for name, value in values.items()}
        previous = texts
    raise LagtopError(f"{digits} digits did not settle with {most} to work with")


def _unproved(ar: ManyDigits, value: Any) -> bool:
    """Return whether a number is 0 or no number, which takes a proof."""
    return value is not None and not isinstance(value, str) and not (value and ar.isfinite(value))


def _text(ar: ManyDigits, value: Any, digits: int) -> Any:
    """Return a number as text, empty where it is not finite; texts and None stay."""
    if value is None or isinstance(value, str):
        return value
    if not ar.isfinite(value):
        return NumberText()
    return NumberText(ar.nstr(ar.convert(value), digits, min_fixed=-5, max_fixed=16))
