"""How formulas are evaluated: inside their arithmetic; polynomials by Horner's rule."""

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
