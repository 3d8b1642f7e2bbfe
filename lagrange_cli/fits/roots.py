"""Roots: values of one input at which one number of the record has its target value.

Each evaluation uses `solve`, whose numbers are correctly rounded.  The root is the double whose
number is nearest to the target.  If the number hardly changes with the input, many doubles have the
same number, and the root may be off by as many last bits.  The number may pass its target, or only
touch it.  It touches it at a steady precession, on either side of which the axis nutates.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..arithmetic.types import Array

Function = Callable[[float], float]
"""The number minus its target value; NaN if there is none."""
Point = tuple[float, float]
"""An argument, and the value of the function at it."""
_MOST_EXTREMA = 12
"""Number of extrema next to the target that are searched; each takes some fifty motions."""
_LEAP = 1e-6
"""Bound of the residual at a root, over its size, that only a leap exceeds."""
_STEPS = 64
_EPS, _TINY = 2.0**-52, 5e-324
_GOLDEN = (math.sqrt(5) - 1) / 2
_FIRST_STEPS = 40
"""Steps of golden section, which reduce a bracket to 4e-9 of its length."""
_NEARER = 0.1
"""Largest remaining share of a distance after these steps, if it goes to 0."""
_BITS = 4.0
"""Largest distance from 0 at a touch, in last bits of the argument and of the number."""


def roots(function: Function, x: Array, y: Array, target: float = 0.0) -> list[float]:
    """Return where a function is 0, from its values y at points x, in ascending order.

    The function is a number minus its `target`.  Roots are as exact as the numbers allow.  Between
    points of the same sign, a pair of roots next to an extremum is found.  An extremum counts as
    touching 0 if some last bits explain its distance from 0.
    """
    changes = np.flatnonzero(y[:-1] * y[1:] <= 0)
    brackets = [(float(x[i]), float(x[i + 1])) for i in changes.tolist()]
    touching = []
    for i in _extrema(y):
        left, right, sign = float(x[i - 1]), float(x[i + 1]), math.copysign(1.0, y[i])
        at, height = _lowest(function, sign, left, right)
        if height <= 0:
            brackets += [(left, at), (at, right)]
            continue
        slope = max(abs(float(y[j]) / (float(x[j]) - at)) for j in (i - 1, i + 1))
        if height <= _BITS * (slope * math.ulp(at) + math.ulp(target)):
            touching.append(at)
    passed = {root for bracket in brackets if (root := _root(function, *bracket)) is not None}
    near = float(np.max(np.diff(x)))  # an extremum between two roots does not touch 0
    apart = {at for at in touching if all(abs(at - root) > near for root in passed)}
    return sorted(passed | apart)


def _extrema(y: Array) -> list[int]:
    """Return points nearer to 0 than both neighbours and with the same sign, nearest first."""
    size = np.abs(y)
    inner = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:])) + 1
    inner = inner[(y[inner - 1] * y[inner] > 0) & (y[inner] * y[inner + 1] > 0)]
    found: list[int] = inner[np.argsort(size[inner])][:_MOST_EXTREMA].tolist()
    return found


def _lowest(function: Function, sign: float, low: float, high: float) -> Point:
    """Return the minimum of a function, times a sign, between two ends, by golden section.

    The search ends at the first value that is not positive.  If the values do not go to 0, it ends
    after some steps, with infinity for the value.
    """

    def at(x: float) -> Point:
        height = sign * function(x)
        return x, math.inf if math.isnan(height) else height

    left, right = at(high - _GOLDEN * (high - low)), at(low + _GOLDEN * (high - low))
    first, step = min(left[1], right[1]), 0
    while low < left[0] < right[0] < high and min(left[1], right[1]) > 0:
        if left[1] <= right[1]:
            high, right = right[0], left
            left = at(high - _GOLDEN * (high - low))
        else:
            low, left = left[0], right
            right = at(low + _GOLDEN * (high - low))
        step += 1
        if step == _FIRST_STEPS and not min(left[1], right[1]) <= _NEARER * first:
            return left[0], math.inf
    return left if left[1] <= right[1] else right


def _root(function: Function, low: float, high: float) -> float | None:
    """Return the root between two points, or None if the function leaps or does not exist."""
    at_low, at_high = function(low), function(high)
    if not at_low * at_high <= 0:
        return None
    if at_low * at_high == 0:
        return low if at_low == 0 else high
    near = crossing(function, (low, at_low), (high, at_high))
    if near is None:
        return None
    root = _last_bit(function, near, math.copysign(1.0, at_high))
    size = max(abs(at_low), abs(at_high))
    return root if abs(function(root)) <= _LEAP * size else None


def crossing(function: Function, a: Point, b: Point) -> float | None:
    """Return a double next to the sign change between two points, by Chandrupatla's method (1997).

    If inverse quadratic interpolation cannot be trusted, a bisection halves the number of doubles
    between the points.  The search therefore also ends at a leap.  Returns None if the function
    does not exist at a point between.
    """
    c, trusted = a, False
    while True:
        best = min(a, b, key=lambda point: abs(point[1]))
        least = max(2 * _EPS * abs(best[0]), _TINY) / abs(b[0] - a[0])
        if least >= 0.5 or best[1] == 0:
            return best[0]
        x = middle(a[0], b[0])
        if trusted:
            step = _interpolated(a, b, c)
            x = a[0] + min(max(step, least), 1 - least) * (b[0] - a[0])
        value = function(x)
        if math.isnan(value):
            return None
        c, b = (a, b) if (value > 0) == (a[1] > 0) else (b, a)
        a = x, value
        place, height = (a[0] - b[0]) / (c[0] - b[0]), (a[1] - b[1]) / (c[1] - b[1])
        trusted = height * height < place and (1 - height) ** 2 < 1 - place


def _interpolated(a: Point, b: Point, c: Point) -> float:
    """Return the zero of the parabola x(y) through three points, as a fraction of the way a-b."""
    ab, ac, bc = b[1] - a[1], c[1] - a[1], c[1] - b[1]
    return -a[1] / ab * c[1] / bc + (c[0] - a[0]) / (b[0] - a[0]) * a[1] / ac * b[1] / bc


def middle(x: float, y: float) -> float:
    """Return the double with as many doubles between it and x as between it and y."""
    bits = np.abs([x, y]).view(np.int64)  # the bits of a double > 0 count the smaller doubles
    place = sum(np.where(np.signbit([x, y]), -bits, bits).tolist()) // 2
    return math.copysign(float(np.int64(abs(place)).view(np.float64)), place)


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
