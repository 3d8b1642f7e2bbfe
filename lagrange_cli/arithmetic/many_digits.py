"""The arithmetic of mpmath: any number of digits, complex numbers, and special functions."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from mpmath.ctx_mp import MPContext


class ManyDigits(MPContext):  # type: ignore[misc]
    """An mpmath context of its own: nobody else's precision is touched.

    By default it has the digits for constants that are rounded to doubles; 34 would do, the rest is
    margin.
    """

    is_array = False

    @property
    def magnitude(self) -> float:
        """The decimal logarithm of eps."""
        return 1.0 - float(self.dps)

    def __init__(self, digits: int = 50) -> None:
        super().__init__()
        self.dps = digits

    @staticmethod
    def working() -> AbstractContextManager[object]:
        """Return a context manager that has nothing to do: the numbers know their context."""
        return nullcontext()

    @staticmethod
    def where(condition: Any, yes: Any, no: Any) -> Any:
        """Return one of two numbers."""
        return yes if condition else no

    @staticmethod
    def anywhere(condition: Any) -> bool:
        """Return whether the condition holds."""
        return bool(condition)

    everywhere = anywhere

    @staticmethod
    def widened(
        x: Any,
        small: Callable[[], tuple[Any, ...]],
        bound: Callable[..., Any],
        *,
        values_only: bool = False,
    ) -> Any:
        """Return x: what an iteration leaves out is below the last digit."""
        return x

    @staticmethod
    def either(condition: Any) -> Any:
        """Return a condition on which only the way to the result depends."""
        return condition

    @staticmethod
    def fixed(x: Any) -> Any:
        """Return x as a constant."""
        return x
