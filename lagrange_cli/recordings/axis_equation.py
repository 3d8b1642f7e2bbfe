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

    finite = np.isfinite(t) & np.isfinite(axis).all(axis=1)
    t, first = np.unique(t[finite][:_MOST], return_index=True)
    axis = axis[finite][:_MOST][first]
    if t.size < _LEAST:
        return None
    middle, span = (t[0] + t[-1]) / 2, (t[-1] - t[0]) / 2
    spline = make_interp_spline((t - middle) / span, axis, k=_DEGREE)
    at = np.linspace(_ENDS * 2 - 1, 1 - _ENDS * 2, _POINTS)
    n, first, second = spline(at), spline(at, 1), spline(at, 2)
    n = n / np.linalg.norm(n, axis=1, keepdims=True)
    turns = [first, at[:, np.newaxis] * first, np.cross(n, first)]
    moments = [np.cross(n, x) for x in np.eye(3)]  # n x G of unit vectors G
    found, spread, residual = _solved([*turns, *moments], -np.cross(n, second))
    b, slope, damping = map(float, found[:3] / span)
    gravity, over = found[3:] / span**2, math.hypot(*spread[3:]) / span**2
    return AxisMotion(
        b, gravity, residual, slope / span, damping, float(spread[0]) / span, 2 * over
    )


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
