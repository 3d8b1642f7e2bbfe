"""Real numbers as inputs, and units of angles."""

from __future__ import annotations

from fractions import Fraction
from operator import index
from typing import Any

Real = float | Fraction
"""An input: a double, or the exact value of a decimal."""

_NOT_REAL = (bool, str, bytes, bytearray, complex)


def is_real(value: object) -> bool:
    """Return whether a value is a real number: no truth value, text, complex, masked or array."""
    dtype = getattr(value, "dtype", None)
    if dtype is None:
        return not isinstance(value, _NOT_REAL)
    is_scalar = not hasattr(value, "__len__") and not hasattr(value, "mask")
    return is_scalar and getattr(dtype, "kind", None) in {"i", "u", "f"}


def unrounded(value: Any, nearest: float) -> Real:
    """Return a finite real number as its nearest double if that is exact, else as a fraction.

    Numbers of a type without a ratio of integers are rounded.
    """
    exact = index(value) if hasattr(value, "__index__") else value
    if exact == nearest or not hasattr(exact, "as_integer_ratio"):
        return nearest
    return Fraction(*exact.as_integer_ratio())
