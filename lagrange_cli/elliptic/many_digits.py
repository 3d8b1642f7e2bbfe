"""Many digits of functions of complex numbers, on which two precisions of mpmath agree.

This is no proof: the same cancellation may spoil both.  They must agree on eight digits more than
are printed, and a computed 0 or pole counts as too few digits: it has to be known from its formula.
Real functions are proved (see `tables.ProvedNumbers`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import cache
from typing import Any

from mpmath.ctx_mp import MPContext

from ..arithmetic.ball import TooFewDigitsError
from ..arithmetic.numbers import Scalars, Unenclosed
from ..arithmetic.text import NumberText
from ..errors import LagtopError

_GUARD = 8
"""Digits that must agree beyond those that are printed."""


class ManyDigits(Scalars, Unenclosed, MPContext):  # type: ignore[misc]
    """The arithmetic of mpmath: any number of digits, complex numbers, and special functions.

    It is a context of its own: nobody else's precision is touched.  By default it has the digits
    for constants that are rounded to doubles; 34 would do, the rest is margin.
    """

    def __init__(self, digits: int = 50) -> None:
        super().__init__()
        self.dps = digits

    @property
    def magnitude(self) -> float:
        """The decimal logarithm of eps."""
        return 1.0 - float(self.dps)


class AgreeingNumbers:
    """Numbers of a table with so many significant digits, on which two precisions agree.

    The contexts are kept, since making one takes longer than most numbers.
    """

    def __init__(self, digits: int) -> None:
        self.digits = digits
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
        text).  Raises LagtopError where the digits do not settle.
        """
        wanted = self.digits + _GUARD
        most = 20 * wanted + 4000
        previous: dict[str, Any] | None = None
        working = wanted + 15
        while working <= most:
            ar, working = self.context(working), working * 3 // 2
            try:
                values = compute(ar)
            except (TooFewDigitsError, ZeroDivisionError):  # a divisor of which nothing is left
                continue
            if any(_unproved(ar, value) for name, value in values.items() if name not in known):
                continue
            texts = {name: _text(ar, value, wanted) for name, value in values.items()}
            if texts == previous:
                return {name: _text(ar, x, self.digits) for name, x in values.items()}
            previous = texts
        raise LagtopError(f"{self.digits} digits did not settle with {most} to work with")


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
