"""How formulas are evaluated: inside their arithmetic, block by block over long arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


def polynomial(coefficients: Sequence[Any], x: Any) -> Any:
    """Return the value at an array x of two coefficients at least, the lowest power first."""
    value = coefficients[-1] * x
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= x
    value += coefficients[0]
    return value


def in_arithmetic(function: F) -> F:
    """Return a formula f(ar, ...) that is evaluated inside `ar.working()`.

    So nothing depends on the decimal context or the `numpy.errstate` of the caller.
    """

    @wraps(function)
    def evaluate(ar: Any, *arguments: Any, **named: Any) -> Any:
        with ar.working():
            return function(ar, *arguments, **named)

    return cast(F, evaluate)


def blockwise(function: F) -> F:
    """Return a formula f(ar, *arguments) that is evaluated block by block over long arrays."""

    @in_arithmetic
    @wraps(function)
    def evaluate(ar: Any, *arguments: Any) -> Any:
        if not ar.is_array:
            return function(ar, *arguments)
        return _in_blocks(function, ar, arguments)

    return cast(F, evaluate)


def _in_blocks(function: Callable[..., Any], ar: Any, arguments: tuple[Any, ...]) -> Any:
    import numpy as np

    from .blocks import BLOCK, blocks
    from .double_double import DoubleDouble

    if any(isinstance(x, DoubleDouble) for x in arguments):
        return function(ar, *arguments)
    arrays = np.broadcast_arrays(*arguments)
    if arrays[0].size <= BLOCK:
        return function(ar, *arrays)
    flat = [array.ravel() for array in arrays]
    parts = [function(ar, *(x[block] for x in flat)) for block in blocks(flat[0].size)]
    return np.concatenate(parts).reshape(arrays[0].shape)
