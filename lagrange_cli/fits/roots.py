"""Where one number of the record, as a function of one input, has a target value.

Each evaluation is by `solve`, whose numbers are correctly rounded: of neighbouring doubles the one
is taken whose number comes nearest.  Where the number hardly changes with the input, many doubles
have the same one, and a root may be that many last bits off.  The number may pass its target, or
touch it: next to a steady precession the axis nutates on either side.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterator

import numpy as np

from ..arithmetic.types import Array

Function = Callable[[float], float]
"""The number less its target value; NaN where there is none."""
Point = tuple[float, float]
"""An argument, and the value of the function there."""
_MOST_EXTREMA = 12
"""Extrema next to the target that are searched: each takes some fifty motions."""
_LEAP = 1e-6
"""The residual of a continuous function at its root, over its size, is far less."""
_STEPS = 64
_EPS, _TINY = 2.0**-52, 5e-324
_GOLDEN = (math.sqrt(5) - 1) / 2
_FIRST_STEPS = 40
"""Steps of golden section, which leave 4e-9 of a bracket."""
_NEARER = 0.1
"""The part of a distance that is left after these, at most, where it goes to 0."""
_BITS = 4.0
"""How many last bits of the argument, and of the number, a distance from 0 may be."""


def roots(function: Function, x: Array, y: Array, target: float = 0.0) -> list[float]:
    """Return where a function is 0, from its values y at points x, in ascending order.

    It is a number less its `target`.  A root is as near as the numbers can tell.  Between two
    points that have the same sign, a pair of roots is found next to an extremum, or the place at
    which an extremum touches 0, if its distance from 0 is explained by some last bits.
    """
    brackets, touching = list(_sign_changes(x, y)), []
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
    near = float(np.max(np.diff(x)))  # two roots next to an extremum are no place that it touches
    apart = {at for at in touching if all(abs(at - root) > near for root in passed)}
    return sorted(passed | apart)


def _sign_changes(x: Array, y: Array) -> Iterator[tuple[float, float]]:
    """Yield neighbouring points between which the sign changes."""
    for i in np.flatnonzero(y[:-1] * y[1:] <= 0).tolist():
        yield float(x[i]), float(x[i + 1])


def _extrema(y: Array) -> list[int]:
    """Return points that are nearer to 0 than both neighbours, on the same side, nearest first."""
    size = np.abs(y)
    inner = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:])) + 1
    inner = inner[(y[inner - 1] * y[inner] > 0) & (y[inner] * y[inner + 1] > 0)]
    found: list[int] = inner[np.argsort(size[inner])][:_MOST_EXTREMA].tolist()
    return found


def _lowest(function: Function, sign: float, low: float, high: float) -> Point:
    """Return where a function, times a sign, is least between two ends, by golden section.

    The search ends at the first value that is not positive.  If the values do not go to 0 it ends
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
    """Return the root between two points, or None where the function leaps or does not exist."""
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

    Where inverse quadratic interpolation cannot be trusted, a bisection halves the number of
    doubles between the points, so that the search ends after a leap, too.  None if the function
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
    """Return where the parabola x(y) through three points meets y = 0, as a part of the way a-b."""
    ab, ac, bc = b[1] - a[1], c[1] - a[1], c[1] - b[1]
    return -a[1] / ab * c[1] / bc + (c[0] - a[0]) / (b[0] - a[0]) * a[1] / ac * b[1] / bc


def middle(x: float, y: float) -> float:
    """Return the double with as many doubles between it and x as between it and y."""
    return _double((_place(x) + _place(y)) // 2)


def _place(x: float) -> int:
    """Return how many doubles lie between 0 and x, with the sign of x."""
    place: int = struct.unpack("<q", struct.pack("<d", abs(x)))[0]
    return -place if x < 0 else place


def _double(place: int) -> float:
    x: float = struct.unpack("<d", struct.pack("<q", abs(place)))[0]
    return -x if place < 0 else x


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
