"""Correctly rounded numbers by name, and tables with a row of them for each argument."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import chain, islice
from typing import Any, TypeVar

from flint import arb

from ..arithmetic.enclosures import decided, equal_digits, exact, kept, settled, sign
from ..arithmetic.text import NumberText, value_text
from ..errors import OutOfRangeError
from .arguments import ExactComplex

C = TypeVar("C")
Cell = arb | Fraction | str | None
"""A number in a ball or as a fraction, a word, or None for a number that does not exist."""
Cells = Mapping[str, Cell]
Rows = tuple[list[str], Iterator[Sequence[Sequence[NumberText]]]]
"""The header, and blocks of rows as text; an empty text is a missing number."""

_ROWS_AT_ONCE = 100


def table_rows(
    arguments: Iterable[ExactComplex],
    columns: Callable[[ExactComplex, C], Cells],
    constants: Callable[[], C],
    inputs: Sequence[Fraction],
    digits: int | None,
) -> Rows:
    """Return a table of `columns` of each argument and of constants, in balls.

    `inputs` are the exact numbers on which the constants depend.  A pole is an empty text, and so
    is a number too large for a double if doubles are requested.
    """

    known = kept(lambda _: constants())

    def row(x: ExactComplex) -> dict[str, Any]:
        of_x = [*x, *inputs]
        return numbers(lambda working: columns(x, known(working)), of_x, digits, strict=False)

    rows = map(row, arguments)
    first = next(rows)
    texts = ([NumberText(value_text(x)) for x in row.values()] for row in chain([first], rows))
    return list(first), iter(lambda: list(islice(texts, _ROWS_AT_ONCE)), [])


def numbers(
    compute: Callable[[int], Cells],
    inputs: Iterable[Fraction],
    digits: int | None,
    *,
    strict: bool = True,
) -> dict[str, Any]:
    """Return the numbers that `compute` encloses with some digits, correctly rounded.

    They are doubles, or texts with `digits` significant digits.  Words are left as they are, and
    poles are None.  A number too small for a double is 0.  A number too large for a double raises
    OutOfRangeError or, unless `strict`, is None.
    """
    row, most = kept(compute), equal_digits(inputs, digits or 0)

    def number(name: str) -> Any:
        def ball(working: int) -> Any:  # None if `most` digits do not show that it is finite
            value: Any = row(working)[name]
            found = exact(value) if isinstance(value, Fraction) else value
            return found if found.is_finite() or working < most else None

        try:
            found = settled(name, ball, digits, most)
        except OutOfRangeError:
            if digits is not None:
                raise
            is_small = decided(lambda working: sign(1 - abs(ball(working))) > 0, most)
            if strict and not is_small:
                raise
            return 0.0 if is_small else None
        return found and found.value

    first = decided(row, most, digits=digits)
    return {name: number(name) if isinstance(x, arb | Fraction) else x for name, x in first.items()}
