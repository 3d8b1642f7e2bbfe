"""What arithmetics share, and the arithmetic of plain floats, from the module `math`."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from fractions import Fraction
from typing import Any, TypeVar

T = TypeVar("T")


class Unenclosed:
    """An arithmetic whose numbers have no radii, so that what iterations leave out is ignored."""

    def widened(
        self,
        x: T,
        small: Callable[[], tuple[Any, ...]],
        bound: Callable[..., Any],
        *,
        values_only: bool = False,
    ) -> T:
        """Return x: what an iteration leaves out is below the last digit."""
        return x

    def either(self, condition: Any) -> Any:
        """Return a condition on which only the way to the result depends."""
        return condition

    def fixed(self, x: T) -> T:
        """Return x as a constant."""
        return x


class Scalars:
    """An arithmetic of single numbers, in which a condition is true or false."""

    is_array = False

    def working(self) -> AbstractContextManager[object]:
        """Return a context manager that has nothing to do: the numbers know their precision."""
        return nullcontext()

    def where(self, condition: Any, yes: Any, no: Any) -> Any:
        """Return one of two numbers."""
        return yes if condition else no

    def anywhere(self, condition: Any) -> bool:
        """Return whether a condition holds; that of balls may raise TooFewDigitsError."""
        return bool(condition)

    everywhere = anywhere


class Doubles(Scalars, Unenclosed):
    """The arithmetic of floats."""

    eps, magnitude = 2.0**-52, -15.65
    pi = math.pi
    nan = math.nan
    sqrt = staticmethod(math.sqrt)
    sin = staticmethod(math.sin)
    cos = staticmethod(math.cos)
    atan2 = staticmethod(math.atan2)

    @staticmethod
    def convert(value: float | Fraction) -> float:
        """Return the double nearest to an exact value."""
        return float(value)


DOUBLES = Doubles()
