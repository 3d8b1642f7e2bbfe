"""Numbers of many digits held as sums of two or three doubles, for arrays to be computed with.

They are made without NumPy; `double_double` computes with them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from .ball import Ball

if TYPE_CHECKING:
    from .types import Array


class Pair(NamedTuple):
    """A number, or an array of numbers, to twice the precision."""

    high: float | Array
    low: float | Array


def pair(value: Any) -> Pair:
    """Return a many-digit number, or a fraction, as two doubles.

    Raises TooFewDigitsError for a ball that does not know them.
    """
    high = float(value)
    return Pair(high, float(_less(value, high)))


class Triple(NamedTuple):
    """A number to three times the precision."""

    high: float | Array
    middle: float | Array
    low: float | Array


def triple(value: Any) -> Triple:
    """Return a many-digit number as three doubles."""
    high, middle = map(float, pair(value))
    return Triple(high, middle, float(_less(_less(value, high), middle)))


def _less(value: Any, part: float) -> Any:
    return value - (part if isinstance(value, Ball) else type(value)(part))
