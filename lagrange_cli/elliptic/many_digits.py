"""Many digits of functions of complex numbers, on which two precisions of mpmath agree.

Agreement is no proof, since the same cancellation could spoil both.  The two must agree to eight
digits more than are printed.  A computed 0 or pole counts as too few digits, because it must be
known from its formula.  Real functions are proved (see `tables.ProvedNumbers`).
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
"""Digits that must agree beyond the printed digits."""


class ManyDigits(Scalars, Unenclosed, MPContext):  # type: ignore[misc]
    """The arithmetic of mpmath: any number of digits, complex numbers, and special functions.

    Each instance is a context of its own and leaves other precisions alone.  The default suits
    constants that are rounded to doubles: 34 digits would do, and the others are margin.
    """

    def __init__(self, digits: int = 50) -> None:
        super().__init__()
        self.dps = digits

    @property
    def magnitude(self) -> float:
        """The decimal logarithm of eps."""
        return 1.0 - float(self.dps)


class AgreeingNumbers:
    """Numbers of a table with `digits` significant digits, on which two precisions agree.

    Contexts are cached, since making one takes longer than computing most numbers.
    """

    def __init__(self, digits: int) -> None:
        self.digits = digits
        self.context = cache(ManyDigits)

    def require(self, ar: ManyDigits, size: Any) -> None:
        """Raise TooFewDigitsError if a number of this size has too few digits after the point."""
        if size > 1 and ar.log10(size) + self.digits + 5 > ar.dps:
            raise TooFewDigitsError

    def texts(
        self, compute: Callable[[ManyDigits], Mapping[str, Any]], known: Collection[str] = ()
    ) -> dict[str, Any]:
        """Return numbers as text with all digits correct; texts and None are left as they are.

        `known` names the numbers that may be 0, or not finite and then an empty text.  Raises
        LagtopError if the digits do not settle.
        """
        wanted = self.digits + _GUARD
        most = 20 * wanted + 4000
        previous: dict[str, Any] | None = None
        working = wanted + 15
        while working <= most:
            ar, working = self.context(working), working * 3 // 2
            try:
                values = compute(ar)
            except (TooFewDigitsError, ZeroDivisionError):  # a divisor cancelled to 0
                continue
            if any(_unproved(ar, value) for name, value in values.items() if name not in known):
                continue
            texts = {name: _text(ar, value, wanted) for name, value in values.items()}
            if texts == previous:
                return {name: _text(ar, x, self.digits) for name, x in values.items()}
            previous = texts
        raise LagtopError(f"{self.digits} digits did not settle at a working precision of {most}")


def _unproved(ar: ManyDigits, value: Any) -> bool:
    """Return whether a number is 0 or not finite, which would take a proof."""
    return value is not None and not isinstance(value, str) and not (value and ar.isfinite(value))


def _text(ar: ManyDigits, value: Any, digits: int) -> Any:
    """Return a number as text, empty if it is not finite; texts and None are left as they are."""
    if value is None or isinstance(value, str):
        return value
    if not ar.isfinite(value):
        return NumberText()
    return NumberText(ar.nstr(ar.convert(value), digits, min_fixed=-5, max_fixed=16))
