"""Numbers of any arithmetic: what formulas need of them at run time.

What their arithmetic offers is said in `protocol`, which only type checkers read.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from .protocol import Real

Number = float | Fraction
"""An input: a double, or the exact value of a decimal."""

R = TypeVar("R", bound="Real")
"""The numbers of the arithmetic in use."""


def absolute(x: R) -> R:
    """Return |x|, with the type of x."""
    return x.__abs__()


@lru_cache(maxsize=256)
def root_of_epsilon(eps: Any, over: int, degree: int) -> Any:
    """Return (eps/over)^(1/degree): where a series with so many orders is exact."""
    return (eps / over) ** (eps / eps / degree)
