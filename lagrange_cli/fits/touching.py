"""Where one number of the record touches its wanted value without passing it.

A steady precession is such a place: next to it the axis nutates on either side.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..arithmetic.types import Array
from .roots import Function

_MOST_EXTREMA = 12
_GOLDEN = (math.sqrt(5) - 1) / 2
_FIRST_STEPS = 15
"""Steps of golden section, which leave a thousandth of a bracket."""
_NEARER = 0.1
"""The part of a distance that is left then, at most, where it goes to 0."""
_BITS = 4.0
"""How many last bits of the unknown, and of the number, a distance from 0 may be."""


def touching(function: Function, x: Array, y: Array, wanted: float) -> list[float]:
    """Return where a function is 0 at an extremum, from its values y at points x.

    It is a number less its `wanted` value.  A place is the double at which the number is nearest to
    it, if that is no farther off than some last bits of the place explain.
    """
    found = []
    for i in _extrema(y):
        at = _nearest(function, float(x[i - 1]), float(x[i + 1]))
        if at is None:
            continue
        slope = max(abs(float(y[j]) / (float(x[j]) - at)) for j in (i - 1, i + 1))
        if abs(function(at)) <= _BITS * (slope * math.ulp(at) + math.ulp(wanted)):
            found.append(at)
    return found


def _extrema(y: Array) -> Iterator[int]:
    """Yield the points that are nearer to 0 than both neighbours, on the same side, best first."""
    size = np.abs(y)
    inner = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:])) + 1
    inner = inner[(y[inner - 1] * y[inner] > 0) & (y[inner] * y[inner + 1] > 0)]
    yield from inner[np.argsort(size[inner])][:_MOST_EXTREMA].tolist()


def _nearest(function: Function, low: float, high: float) -> float | None:
    """Return the double between two ends at which a function is nearest to 0, by golden section.

    None where it does not go to 0.
    """
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_left, at_right = abs(function(left)), abs(function(right))
    first, step = min(at_left, at_right), 0
    while low < left < right < high:
        if at_left <= at_right or math.isnan(at_right):
            high, right, at_right = right, left, at_left
            left = high - _GOLDEN * (high - low)
            at_left = abs(function(left))
        else:
            low, left, at_left = left, right, at_right
            right = low + _GOLDEN * (high - low)
            at_right = abs(function(right))
        step += 1
        if step == _FIRST_STEPS and not min(at_left, at_right) <= _NEARER * first:
            return None
    return left if at_left <= at_right else right
