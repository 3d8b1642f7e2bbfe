"""The arithmetics that formulas are written over, and the few things they do not spell alike."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import lru_cache, wraps
from typing import Any, TypeVar, cast

Arithmetic = Any
"""`decimals`, an mpmath context, `math` or `numpy`."""

Number = float | Fraction
"""An input: a double, or the exact value of a decimal."""

F = TypeVar("F", bound=Callable[..., Any])

Real = Any
"""A number of the arithmetic in use: Decimal, mpf, float or float64 array."""


def epsilon(ar: Arithmetic) -> Real:
    """Distance from 1 to the next number of the arithmetic."""
    return getattr(ar, "eps", sys.float_info.epsilon)


@lru_cache(maxsize=256)
def root_of_epsilon(eps: Any, over: int, degree: int) -> Any:
    """Return (eps/over)^(1/degree): where a series with so many orders is exact."""
    return (eps / over) ** (eps / eps / degree)


def everywhere(condition: Any) -> bool:
    """Whether a condition holds, or holds for every element of an array."""
    return condition.all() if hasattr(condition, "all") else bool(condition)


def anywhere(condition: Any) -> bool:
    """Whether a condition holds, or holds for some element of an array; loops that go on while it
    does end for NaN."""
    return bool(condition.any()) if hasattr(condition, "any") else bool(condition)


def where(condition: Any, yes: Real, no: Real) -> Real:
    """Choose between two numbers, or element by element between two arrays."""
    if hasattr(condition, "all"):
        import numpy as np

        return np.where(condition, yes, no)
    return yes if condition else no


def many_digits(digits: int = 50) -> Arithmetic:
    """An mpmath context of its own: nobody else's precision is touched.

    By default for constants that are rounded to doubles; 34 digits would do, the rest is margin.
    """
    from .many_digits import ManyDigits

    return ManyDigits(digits)


def has_arrays(ar: Arithmetic) -> bool:
    """Whether the arithmetic is numpy, rather than one of scalars."""
    return hasattr(ar, "asarray")


def number(ar: Arithmetic, value: Number) -> Real:
    """A number of the arithmetic, rounded once."""
    return ar.convert(value) if hasattr(ar, "convert") else float(value)


BLOCK = 16384
"""So many elements of arrays at a time: what is computed in between stays in the cache."""


def blocks(size: int) -> Iterator[slice]:
    """Slices that cover an array of so many elements; one of them where it is empty."""
    return (slice(start, start + BLOCK) for start in range(0, max(size, 1), BLOCK))


def polynomial(coefficients: Sequence[Real], x: Real) -> Real:
    """Its value at an array x, two coefficients at least, the lowest power first."""
    value = coefficients[-1] * x
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]
    return value


def blockwise(function: F) -> F:
    """A formula f(ar, *arguments), evaluated block by block where the arguments are long arrays."""

    @wraps(function)
    def evaluate(ar: Arithmetic, *arguments: Real) -> Real:
        if not has_arrays(ar):
            return function(ar, *arguments)
        arrays = ar.broadcast_arrays(*arguments)
        if arrays[0].size <= BLOCK:
            return function(ar, *arrays)
        flat = [array.ravel() for array in arrays]
        parts = [function(ar, *(x[block] for x in flat)) for block in blocks(flat[0].size)]
        return ar.concatenate(parts).reshape(arrays[0].shape)

    return cast(F, evaluate)
