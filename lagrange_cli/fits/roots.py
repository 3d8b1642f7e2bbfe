"""Where one number of the record, as a function of one input, has a wanted value.

Each evaluation is by `solve`, whose numbers are the nearest doubles: of neighbouring doubles the
one is taken whose number comes nearest.  Where the number hardly changes with the input, many
doubles have the same one, and a root may be that many last bits off.
"""

from __future__ import annotations

import math
import struct
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
_EPS, _TINY = 2.0**-52, 5e-324
Point = tuple[float, float]
"""An argument, and the value of the function there."""


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
    size = np.abs(y)
    inner = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:])) + 1
    inner = inner[(y[inner - 1] * y[inner] > 0) & (y[inner] * y[inner + 1] > 0)]
    for i in inner[np.argsort(size[inner])][:_MOST_EXTREMA].tolist():
        from scipy.optimize import minimize_scalar  # half a second, for searches that need it

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
