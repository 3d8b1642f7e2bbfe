"""One engine for the tables of functions; each table declares its columns.

With N digits, every number is rounded from an enclosure, which proves it.  In doubles a table is
computed in arrays.  A short table of real functions is computed as enclosures, which takes less
time than loading NumPy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from functools import cache
from itertools import chain
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ..arithmetic.ball import Ball, TooFewDigitsError, TooSmallError
from ..arithmetic.balls import balls
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..arithmetic.rounding import MOST_DIGITS, alike, precisions, text_of, too_small
from ..arithmetic.text import NumberText, double_text
from ..errors import LagtopError

if TYPE_CHECKING:
    from ..arithmetic.types import Array

    Texts = Sequence[Sequence[str]]
    Rows = tuple[list[str], Iterator[Array | Texts]]
    DigitRows = Iterator[dict[str, NumberText]]
    ArrayColumns = tuple[Callable[[Any], dict[str, Array]], Iterator[Any]]
    Known = Mapping[str, float | Fraction]

_MOST_FOR_DOUBLES = 120
"""Number of digits beyond which arrays of doubles are quicker."""
_FEW = 24
"""Numbers that can be computed as enclosures in the time that NumPy takes to load."""


class ProvedNumbers:
    """Doubles, or numbers with N significant digits, from enclosures of any precision."""

    def __init__(
        self,
        digits: int | None = None,
        *,
        short: bool = False,
        arithmetic: Callable[[int], Any] = balls,
    ) -> None:
        """Take the digits; a `short` search raises TooFewDigitsError if arrays are quicker.

        `arithmetic` returns the balls with some number of digits, real or complex.
        """
        self.digits, self.most = digits, _MOST_FOR_DOUBLES if short else MOST_DIGITS
        self.arithmetic = arithmetic

    def of(
        self,
        compute: Callable[[Any], Mapping[str, Any]],
        known: Mapping[str, float | Fraction] = MappingProxyType({}),
        more: int = 0,
    ) -> dict[str, Any]:
        """Return numbers by name; texts, and None for undefined numbers, are left as they are.

        `known` numbers are not computed; one that is not finite has no value.  `more` is the number
        of digits that are lost in any case.  Raises LagtopError if no precision decides a number.
        """
        found: dict[str, Any] = {}
        for working in precisions(self.digits or 0, more):
            if working > self.most + more:
                raise TooFewDigitsError
            with suppress(TooFewDigitsError):
                values = compute(self.arithmetic(working))
                for name in [name for name in values if name not in found]:
                    value = None if values[name] is None else known.get(name, values[name])
                    try:
                        found[name] = self._settled(value)
                    except TooSmallError:
                        if self.most == MOST_DIGITS:
                            raise too_small(name) from None
                    except TooFewDigitsError:
                        continue
                if len(found) == len(values):
                    return {name: found[name] for name in values}
        raise LagtopError(f"{MOST_DIGITS} digits are not enough to round these numbers")

    def _settled(self, value: Any) -> Any:
        """Return a number as it is printed, or None if it is beyond the range of doubles."""
        if isinstance(value, Ball):
            rounded = alike(value, self._rounding).value
        elif isinstance(value, float) and not math.isfinite(value):
            rounded = None
        elif isinstance(value, int | float | Fraction):
            rounded = self._rounding(Fraction(value))
        else:
            return value
        return None if rounded in {math.inf, -math.inf} else rounded

    def _rounding(self, value: Decimal | Fraction) -> Any:
        return float(value) + 0.0 if self.digits is None else text_of(value, self.digits)

    def texts(self, *arguments: Any) -> dict[str, NumberText]:
        """Return numbers as texts, empty for numbers without a value; see `of`."""
        return {name: _text(value) for name, value in self.of(*arguments).items()}


def _text(value: Any) -> NumberText:
    if value is None:
        return NumberText()
    return NumberText(double_text(value)) if isinstance(value, float) else value


class TableOfFunctions:
    """A row of functions for each of `count` arguments."""

    functions: float = math.inf
    """Functions in a row, if short tables are computed as enclosures; else infinite."""
    arithmetic: Callable[[int], Any] = staticmethod(balls)
    """Returns the balls with some number of digits."""
    rounds = True
    """Whether points are rounded to the nearest doubles in a table of doubles."""

    def __init__(self, points: Any, count: int) -> None:
        self.points, self.count = points, count

    def rows(self, digits: int | None = None) -> Rows:
        """Return the header, and blocks of rows in doubles or with N significant digits.

        In doubles, a pole or a number that no double can hold is NaN or an empty text.  With N
        digits, a pole is an empty text.  Raises LagtopError, before any row, for inputs that the
        table cannot hold (see each table).
        """
        if digits is not None:
            return _listed(self.digit_rows(digits))
        if self.functions * self.count <= _FEW:
            with suppress(TooFewDigitsError):  # something cancels: arrays are quicker
                header, blocks = _listed(self.digit_rows(short=True))
                return header, iter([list(chain.from_iterable(blocks))])
        return self.array_rows()

    def array_rows(self) -> Rows:
        """Return the header, and blocks of rows in doubles as arrays."""
        return _stacked(*self.array_columns())

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError for inputs that are invalid, or that doubles cannot hold."""
        raise NotImplementedError

    def constants(self, ar: Any) -> Any:
        """Return the constants that do not depend on the point, in balls."""
        raise NotImplementedError

    def rounded_constants(self) -> Any:
        """Return the constants in doubles."""
        raise NotImplementedError

    def columns(
        self, ar: FunctionArithmetic, x: Numeric, constants: Any, known: Known
    ) -> dict[str, Numeric]:
        """Return the columns by name at an exact point or an array x, without `known` columns.

        Known columns may be returned, too.
        """
        raise NotImplementedError

    def known(self, x: Any) -> Known:
        """Return the columns that are known exactly at a point; a pole is NaN."""
        raise NotImplementedError

    def put_known(self, columns: dict[str, Array], x: Array) -> None:
        """Put exactly known values into columns of doubles."""

    def digits_lost(self, x: Any) -> int:
        """Return the number of digits taken by the whole periods of a point."""
        return 0

    def digit_rows(self, digits: int | None = None, *, short: bool = False) -> DigitRows:
        """Yield rows with N proved digits or, without `digits`, the nearest doubles.

        A `short` search raises TooFewDigitsError for a number that arrays would yield more quickly.
        """
        self.check(doubles=digits is None)
        numbers = ProvedNumbers(digits, short=short, arithmetic=self.arithmetic)
        constants = cache(self.constants)

        def row(point: Any) -> dict[str, NumberText]:
            x = Fraction(float(point)) if digits is None and self.rounds else point
            known = self.known(x)

            def compute(ar: Any) -> dict[str, Numeric]:
                return self.columns(ar, x, constants(ar), known)

            return numbers.texts(compute, known, self.digits_lost(x))

        return map(row, self.points.decimals())

    def array_columns(self) -> ArrayColumns:
        """Return the columns of a block of points in doubles, and the blocks."""
        from ..arithmetic.arrays import ARRAYS  # start-up

        self.check(doubles=True)
        constants = self.rounded_constants()

        def columns(x: Array) -> dict[str, Array]:
            found = self.columns(ARRAYS, x, constants, {})
            self.put_known(found, x)
            return found

        return columns, self.points.blocks()


def _listed(rows: DigitRows) -> tuple[list[str], Iterator[Texts]]:
    """Return the header of rows of texts, and a block for each row."""
    first = next(rows)
    return list(first), ([list(row.values())] for row in chain([first], rows))


def _stacked(columns: Callable[[Any], dict[str, Array]], arguments: Iterable[Any]) -> Rows:
    """Return the header of columns of doubles, and blocks of rows, with NaN for infinite values.

    If one part of a complex number is not finite, the other part is NaN as well.
    """
    import numpy as np

    def block(x: Any) -> tuple[list[str], Array]:
        with np.errstate(all="ignore"):  # poles and overflows become empty cells
            found = columns(x)
        table = np.stack(list(found.values()), axis=1)
        wrong = ~np.isfinite(table)
        for i, name in enumerate(found):
            if name.endswith("_re"):
                wrong[:, i : i + 2] |= wrong[:, i : i + 2].any(axis=1, keepdims=True)
        table[wrong] = np.nan
        return list(found), table + 0.0  # no -0

    blocks = map(block, arguments)
    header, first = next(blocks)
    return header, chain([first], (table for _, table in blocks))
