"""Where one number of the record, as a function of one input, has a wanted value.

Each evaluation is by `solve`, whose numbers are the nearest doubles: of neighbouring doubles the
one is taken whose number comes nearest.  Where the number hardly changes with the input, many
doubles have the same one, and a root may be that many last bits off.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from ..arithmetic.types import Array

Function = Callable[[float], float]
"""The number less its wanted value; NaN where there is none."""
_MOST_EXTREMA = 12
"""Extrema next to the wanted value that are looked at: each takes some thirty motions."""
_LEAP = 1e-6
"""What is left of a continuous function at its root, over its size, is far less."""
_STEPS = 64


def roots(function: Function, x: Array, y: Array) -> list[float]:
    """Return the roots that values y at points x bracket, each as near as its numbers can tell.

    A pair of roots between two points is found where the function has an extremum there.
    """
    brackets = [*_brackets(x, y), *_hidden(function, x, y)]
    found = [root for bracket in brackets if (root := _root(function, *bracket)) is not None]
    return sorted(set(found))


def _brackets(x: Array, y: Array) -> Iterator[tuple[float, float]]:
    """Yield neighbouring points between which the sign changes."""
    for i in np.flatnonzero(y[:-1] * y[1:] <= 0).tolist():
        yield float(x[i]), float(x[i + 1])


def _hidden(function: Function, x: Array, y: Array) -> Iterator[tuple[float, float]]:
    """Yield brackets on both sides of an extremum that lies beyond 0, or on 0, between points."""
    from scipy.optimize import minimize_scalar

    size = np.abs(y)
    inner = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:])) + 1
    inner = inner[(y[inner - 1] * y[inner] > 0) & (y[inner] * y[inner + 1] > 0)]
    for i in inner[np.argsort(size[inner])][:_MOST_EXTREMA].tolist():
        sign = math.copysign(1.0, y[i])
        lowest = minimize_scalar(
            lambda at, sign=sign: _or_infinite(sign * function(float(at))),
            bounds=(x[i - 1], x[i + 1]),
            method="bounded",
            options={"xatol": 1e-9 * float(x[i + 1] - x[i - 1])},
        )
        if lowest.fun <= 0:
            yield float(x[i - 1]), float(lowest.x)
            yield float(lowest.x), float(x[i + 1])


def _or_infinite(value: float) -> float:
    return math.inf if math.isnan(value) else value


def _root(function: Function, low: float, high: float) -> float | None:
    """Return the root between two points, or None where the function leaps or does not exist."""
    from scipy.optimize import brentq

    at_low, at_high = function(low), function(high)
    if not at_low * at_high <= 0:
        return None
    if at_low * at_high == 0:
        return low if at_low == 0 else high
    try:
        near = brentq(_existing(function), low, high, xtol=1e-300, rtol=4 * np.finfo(float).eps)
    except _MissingError:
        return None
    root = _last_bit(function, float(near), math.copysign(1.0, at_high))
    size = max(abs(at_low), abs(at_high))
    return root if abs(function(root)) <= _LEAP * size else None


class _MissingError(ArithmeticError):
    """A motion between two others that does not have the number."""


def _existing(function: Function) -> Function:
    def value(at: float) -> float:
        found = function(at)
        if math.isnan(found):
            raise _MissingError
        return found

    return value


def _last_bit(function: Function, x: float, rising: float) -> float:
    """Return the double next to a root at which the function is nearest to 0."""
    value = function(x)
    for _ in range(_STEPS):
        if value == 0:
            break
        following = math.nextafter(x, -math.inf if value * rising > 0 else math.inf)
        after = function(following)
        if not abs(after) < abs(value):
            break
        x, value = following, after
    return x
