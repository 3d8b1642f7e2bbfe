"""The equation of the figure axis, from which a, b and up follow by one linear least squares.

L = A n x n' + C r0 n and L' = -m g s n x z, divided by A, give for the figure axis n(t)

    n x n'' + b n' + n x G = 0,    b = C r0 / A,    G = (a/2) z,    a = 2 m g s / A,

in any constant frame of space: the direction of G is up.  A decay of the spin makes b a line in t,
and damping d of the rates across the axis adds d n x n'.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array

_DEGREE, _MOST, _POINTS, _ENDS = 7, 20_000, 800, 0.04
"""Of the spline: its degree, the most rows, the points, and the share left out at each end."""
_LEAST = 4 * (_DEGREE + 1)
"""Least number of rows of a spline."""
_WINDOWS, _LEAST_IN_WINDOW = 4, 6
"""Windows per width, and the least number of rows in one."""


class AxisMotion(NamedTuple):
    """Parameters of the motion of a figure axis."""

    b: float
    """C r0 / A, in the middle of the times."""
    gravity: Array
    """The vector a/2 z, shape (3,): its direction is up."""
    residual: float
    """The root mean square of the residual, over that of n x n''."""
    b_slope: float = 0.0
    """The growth of b per unit of time."""
    damping: float = 0.0
    """The decay of the rates across the axis, per unit of time."""
    b_spread: float = 0.0
    a_spread: float = 0.0
    """Largest errors of b and a that a residual of this size allows."""

    @property
    def a(self) -> float:
        """2 m g s / A."""
        return 2.0 * float(np.linalg.norm(self.gravity))

    @property
    def up(self) -> Array:
        """The unit vector that points up; NaN without gravity."""
        return self.gravity / np.linalg.norm(self.gravity)


def from_spline(t: Array, axis: Array) -> AxisMotion | None:
    """Return the parameters of an axis without noise, shape (n, 3), by the derivatives of a spline.

    Times may be irregular, decrease or repeat; rows that are not finite are left out.  Return None
    for fewer than 32 rows.
    """
    from scipy.interpolate import make_interp_spline  # start-up

    t, axis = _ordered(t, axis)
    if t.size < _LEAST:
        return None
    middle, span = (t[0] + t[-1]) / 2, (t[-1] - t[0]) / 2
    spline = make_interp_spline((t - middle) / span, axis, k=_DEGREE)
    at = np.linspace(_ENDS * 2 - 1, 1 - _ENDS * 2, _POINTS)
    n, first, second = spline(at), spline(at, 1), spline(at, 2)
    n = n / np.linalg.norm(n, axis=1, keepdims=True)
    turns = [first, at[:, np.newaxis] * first, np.cross(n, first)]
    found, spread, residual = _solved([*turns, *_weights(n)], -np.cross(n, second))
    b, slope, damping = map(float, found[:3] / span)
    gravity, over = found[3:] / span**2, math.hypot(*spread[3:]) / span**2
    return AxisMotion(
        b, gravity, residual, slope / span, damping, float(spread[0]) / span, 2 * over
    )


def from_windows(
    t: Array, axis: Array, width: float, *, vertical: bool = True
) -> AxisMotion | None:
    """Return the parameters of a noisy axis, shape (n, 3): the equation times bumps, by parts.

    A bump is `width` units of time wide.  One derivative less is needed, and the noise of rows
    has no first-order effect.  If `vertical` is true, G is along z, else it is free.  Return
    None if there are too few rows in a width.
    """
    t, axis = _ordered(t, axis)
    half = width / 2
    if t.size < _LEAST_IN_WINDOW or not 0 < width <= t[-1] - t[0]:
        return None
    count = math.ceil(_WINDOWS * (t[-1] - t[0]) / width) + 20
    rows, right = [], []
    for centre in np.linspace(t[0] + half, t[-1] - half, count):
        near = slice(*np.searchsorted(t, [centre - half, centre + half]))
        if near.stop - near.start < _LEAST_IN_WINDOW:
            continue
        n, s = axis[near], (t[near] - centre) / half
        bump, slope = (1 - s * s) ** 4, -8 * s * (1 - s * s) ** 3 / half
        chord = -8 * (m := (s[1:] + s[:-1]) / 2) * (1 - m * m) ** 3 / half
        right.append(chord @ np.cross(n[:-1], n[1:]))  # n x n' dt
        mean = np.trapezoid(bump[:, np.newaxis] * n, t[near], axis=0)
        swing = -np.trapezoid(slope[:, np.newaxis] * n, t[near], axis=0)
        rows.append([swing, *_weights(mean)[2 if vertical else 0 :]])
    if len(rows) < _LEAST_IN_WINDOW:
        return None
    columns = [np.asarray(x) for x in zip(*rows, strict=True)]
    found, spread, residual = _solved(columns, np.asarray(right))
    gravity = np.array([0.0, 0.0, found[1]]) if vertical else found[1:]
    return AxisMotion(
        float(found[0]),
        gravity,
        residual,
        b_spread=float(spread[0]),
        a_spread=2 * math.hypot(*spread[1:]),
    )


def _weights(n: Array) -> list[Array]:
    """Return the moments n x G of unit vectors G along x, y and z."""
    return [np.cross(n, x) for x in np.eye(3)]


def _solved(columns: list[Array], right: Array) -> tuple[Array, Array, float]:
    """Return the solution of a least squares, its spread, and the relative residual."""
    matrix, wanted = np.stack(columns, axis=-1).reshape(-1, len(columns)), right.reshape(-1)
    scale = np.linalg.norm(matrix, axis=0) + 1e-300
    left, sizes, turns = np.linalg.svd(matrix / scale, full_matrices=False)
    kept = np.where(sizes > 1e-10 * sizes[0], sizes, np.inf)
    found = ((left.T @ wanted) / kept) @ turns / scale
    rest = float(np.linalg.norm(matrix @ found - wanted))
    spread = rest * np.linalg.norm(turns.T / np.maximum(sizes, 1e-10), axis=1) / scale
    return found, spread, rest / (float(np.linalg.norm(wanted)) + 1e-300)


def _ordered(t: Array, axis: Array) -> tuple[Array, Array]:
    """Return the first rows that are finite, in the order of time, each time once."""
    finite = np.isfinite(t) & np.isfinite(axis).all(axis=1)
    times, rows = np.unique(t[finite][:_MOST], return_index=True)
    return times, axis[finite][:_MOST][rows]
