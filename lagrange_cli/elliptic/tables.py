"""Tables of functions: a row of correctly rounded numbers for each argument."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import chain, islice
from typing import Any

from flint import ctx

from ..arithmetic.rounding import equal_digits
from ..arithmetic.text import NumberText
from .enclosures import Value, cell, rounded

Texts = Sequence[Sequence[NumberText]]
"""Rows of numbers as text; an empty text is a missing number."""
Rows = tuple[list[str], Iterator[Texts]]

_ROWS_AT_ONCE = 100


class TableOfFunctions:
    """A row of functions for each of `count` arguments."""

    count: int

    def __init__(self) -> None:
        self._constants = cache(lambda bits: self.constants())

    def rows(self, digits: int | None = None) -> Rows:
        """Return the header, and blocks of rows as text, as doubles or with N significant digits.

        In doubles, arguments are rounded to the nearest doubles first.  A pole, or a number that no
        double can hold, is an empty text.  Raises LagtopError, before any row, for inputs that the
        table cannot hold.
        """
        self.check(doubles=digits is None)
        rows = (self._row(x, digits) for x in self.arguments(doubles=digits is None))
        first = next(rows)
        texts = ([cell(value) for value in row.values()] for row in chain([first], rows))
        return list(first), iter(lambda: list(islice(texts, _ROWS_AT_ONCE)), [])

    def _row(self, x: Any, digits: int | None) -> dict[str, Any]:
        def compute() -> dict[str, Value]:
            return self.columns(x, self._constants(ctx.prec))

        return rounded(compute, digits, equal_digits(self.inputs(x), digits or 0))

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError for inputs that are invalid, or too large for doubles."""
        raise NotImplementedError

    def arguments(self, *, doubles: bool) -> Iterator[Any]:
        """Yield the arguments; for doubles, their nearest doubles."""
        raise NotImplementedError

    def inputs(self, x: Any) -> Iterable[Fraction]:
        """Return the inputs on which the row of an argument depends."""
        raise NotImplementedError

    def constants(self) -> Any:
        """Return the constants that do not depend on the argument, in balls."""
        raise NotImplementedError

    def columns(self, x: Any, constants: Any) -> dict[str, Value]:
        """Return the columns at an argument in balls; None for a pole."""
        raise NotImplementedError


def nearest(x: Fraction) -> Fraction:
    """Return the double nearest to a number."""
    return Fraction(float(x))
