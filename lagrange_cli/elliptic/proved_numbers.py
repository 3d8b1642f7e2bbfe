"""Numbers of a table of real functions, each rounded from an enclosure."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from ..arithmetic.ball import Ball, TooFewDigitsError
from ..arithmetic.balls import Balls, balls
from ..arithmetic.rounding import MOST_DIGITS, alike, precisions, text_of
from ..arithmetic.text import NumberText, double_text
from ..errors import LagtopError

_MOST_FOR_DOUBLES = 120
"""Digits beyond which arrays of doubles are sooner ready."""


class ProvedNumbers:
    """Doubles, or numbers with so many significant digits, from enclosures of any precision."""

    def __init__(self, digits: int | None = None, *, short: bool = False) -> None:
        """Take the digits; a `short` search raises TooFewDigitsError where arrays are sooner."""
        self.digits, self.most = digits, _MOST_FOR_DOUBLES if short else MOST_DIGITS

    def of(
        self,
        compute: Callable[[Balls], Mapping[str, Any]],
        known: Mapping[str, float] = MappingProxyType({}),
        more: int = 0,
    ) -> dict[str, Any]:
        """Return numbers by name; texts, and None for what there is not, stay as they are.

        `known` are numbers that need not be computed; one that is not finite has no value.  `more`
        is how many digits are lost anyway.  Raises LagtopError if nothing decides a number.
        """
        found: dict[str, Any] = {}
        for working in precisions(self.digits or 0, more):
            if working > self.most + more:
                raise TooFewDigitsError
            with suppress(TooFewDigitsError):
                values = compute(balls(working))
                for name in values.keys() - found.keys():
                    value = None if values[name] is None else known.get(name, values[name])
                    with suppress(TooFewDigitsError):
                        found[name] = self._settled(value)
                if len(found) == len(values):
                    return {name: found[name] for name in values}
        raise LagtopError(f"{MOST_DIGITS} digits do not decide these numbers")

    def _settled(self, value: Any) -> Any:
        """Return a number as it is printed; None for one that is beyond the doubles."""
        if isinstance(value, Ball):
            rounded = alike(value, self._rounding).value
        elif isinstance(value, int | float):
            rounded = self._rounding(Fraction(value)) if math.isfinite(value) else None
        else:
            return value
        return None if rounded in {math.inf, -math.inf} else rounded

    def _rounding(self, value: Decimal | Fraction) -> Any:
        return float(value) + 0.0 if self.digits is None else text_of(value, self.digits)

    def texts(self, *arguments: Any) -> dict[str, NumberText]:
        """Return numbers as texts, empty for one without a value; see `of`."""
        return {name: _text(value) for name, value in self.of(*arguments).items()}


def _text(value: Any) -> NumberText:
    if value is None:
        return NumberText()
    return NumberText(double_text(value)) if isinstance(value, float) else value
