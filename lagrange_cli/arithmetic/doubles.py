"""The arithmetic of plain floats, from the module `math`."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from fractions import Fraction
from typing import Any


class Doubles:
    """The arithmetic of floats."""

    is_array = False
    eps, magnitude = 2.0**-52, -15.65
    pi = math.pi
    nan = math.nan
    sqrt = staticmethod(math.sqrt)
    sin = staticmethod(math.sin)
    cos = staticmethod(math.cos)
    atan2 = staticmethod(math.atan2)
    anywhere = everywhere = staticmethod(bool)

    @staticmethod
    def working() -> AbstractContextManager[object]:
        """Return a context manager that has nothing to do."""
        return nullcontext()

    @staticmethod
    def convert(value: float | Fraction) -> float:
        """Return the double nearest to an exact value."""
        return float(value)

    @staticmethod
    def where(condition: Any, yes: float, no: float) -> float:
        """Return one of two numbers."""
        return yes if condition else no

    @staticmethod
    def widened(
        x: Any,
        small: Callable[[], tuple[Any, ...]],
        bound: Callable[..., Any],
        *,
        values_only: bool = False,
    ) -> Any:
        """Return x: what an iteration leaves out is below the last bit."""
        return x

    @staticmethod
    def either(condition: Any) -> Any:
        """Return a condition on which only the way to the result depends."""
        return condition

    @staticmethod
    def fixed(x: Any) -> Any:
        """Return x as a constant."""
        return x


DOUBLES = Doubles()
