"""Digits that are right and zeros that are proved, of functions that only mpmath has.

Ziv's strategy, as in `arithmetic.correct_rounding`, for many numbers at once: more and more digits
until two precisions agree.  They may agree by chance where few digits are asked for, or on a 0 that
is none.  So they must agree on more digits than are printed, and a computed 0 or pole counts as too
few digits: it has to be known from its formula.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from functools import cache
from math import isfinite
from typing import TYPE_CHECKING, Any

from ..arithmetic.correct_rounding import TooFewDigitsError, precisions
from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.text import NumberText, double_text
from ..errors import LagtopError

if TYPE_CHECKING:
    from ..arithmetic.types import Array

_GUARD = 8
"""Digits that must agree beyond those that are printed."""
_DIGITS_OF_DOUBLES = 25
_FEW = 24
"""Numbers that are computed in many digits in the time that NumPy takes to load."""


_MOST_FOR_DOUBLES = 120


def small_or_large(
    numbers: int, small: Callable[[], list[list[NumberText]]], large: Callable[[], Iterator[Array]]
) -> Iterator[Array | list[list[NumberText]]]:
    """Return blocks of a table of doubles, made without NumPy where that is sooner.

    So it is with few numbers, unless something cancels and they take many digits.
    """
    if numbers <= _FEW:
        with suppress(TooFewDigitsError):
            return iter([small()])
    return large()


class Settled:
    """What settles the numbers of a table, with so many significant digits.

    Without `digits` each number becomes the nearest double, which `_DIGITS_OF_DOUBLES` tell but for
    one in 1e8.  The contexts are kept, since making one takes longer than most numbers.
    """

    def __init__(self, digits: int | None = None) -> None:
        self.digits = _DIGITS_OF_DOUBLES if digits is None else digits
        self.in_doubles = digits is None
        self.context = cache(ManyDigits)

    def require(self, ar: ManyDigits, size: Any) -> None:
        """Raise TooFewDigitsError where a number of this size has too few behind the point."""
        if size > 1 and ar.log10(size) + self.digits + 5 > ar.dps:
            raise TooFewDigitsError

    def texts(
        self, compute: Callable[[ManyDigits], Mapping[str, Any]], known: Collection[str] = ()
    ) -> dict[str, Any]:
        """Return numbers written out, all digits right; texts and None as they are.

        `known` are the names of the numbers that may be 0 or not finite (which makes an empty
        text).  Raises LagtopError where the digits do not settle and, without `digits`,
        TooFewDigitsError where they take longer than arrays would.
        """
        wanted = self.digits + _GUARD
        most = _MOST_FOR_DOUBLES if self.in_doubles else 20 * wanted + 4000
        previous: dict[str, Any] | None = None
        for working in precisions(wanted + 15, most):
            ar = self.context(working)
            try:
                values = compute(ar)
            except (TooFewDigitsError, ZeroDivisionError):  # a divisor of which nothing is left
                continue
            if any(_unproved(ar, value) for name, value in values.items() if name not in known):
                continue
            texts = {name: _text(ar, value, wanted) for name, value in values.items()}
            if texts == previous:
                return {name: self._rounded(ar, value) for name, value in values.items()}
            previous = texts
        if self.in_doubles:
            raise TooFewDigitsError
        raise LagtopError(f"{self.digits} digits did not settle with {most} to work with")

    def _rounded(self, ar: ManyDigits, value: Any) -> Any:
        """Return a number with its digits, or that of the nearest double."""
        text = _text(ar, value, self.digits)
        if not (text and self.in_doubles and isinstance(text, NumberText)):
            return text
        nearest = float(text) + 0.0  # no -0
        return NumberText(double_text(nearest) if isfinite(nearest) else "")


def settled_or_rounded(
    compute: Callable[[ManyDigits], Mapping[str, Any]],
    digits: int | None,
    known: Collection[str] = (),
) -> dict[str, Any]:
    """Return numbers as `Settled.texts` does or, without `digits`, each the nearest double."""
    if digits is not None:
        return Settled(digits).texts(compute, known)
    exact = compute(ManyDigits())
    return {name: x if x is None or isinstance(x, str) else float(x) for name, x in exact.items()}


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
