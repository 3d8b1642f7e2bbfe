"""Several numbers of the record that shall have wanted values, by several inputs.

Newton's method, within the ranges, from the best points of the scan; found is what these lead to.
"""

from __future__ import annotations

import math

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..motion.record import NUMBER_KEYS
from ..motion.sensitivity.sensitivities import sensitivities
from .search import Scan, Search

_MOST_STARTS = 16
_NEWTON_STEPS = 6
_APART = 1e-9
"""Solutions that differ by less, over the range, are one."""
_PLATEAU = 3
"""Solutions that are no single points, from which on there are more than can be listed."""
_STILL = 1e-8
"""Parts of the steepest slope that are none: what differences may be off, and more."""
_BITS = 4.0
"""How many last bits of the unknowns, and of the number itself, a number may be off."""
_STEP = 1e-5
"""Steps over the range of an unknown: the error of a central difference is about their square."""


def solutions(search: Search, grid: Scan) -> list[list[float]]:
    """Return the values of the unknowns where all numbers are as wanted.

    Raises LagtopError where these are not single points: where the numbers stay as they are along
    some direction at as many of them as a plateau takes.
    """
    found: list[Array] = []
    loose: list[list[str]] = []
    width = search.ends[1] - search.ends[0]
    for start in _starts(search, grid):
        point = _settled(search, _descended(search, grid, start))
        if point is not None and all(
            np.max(np.abs(point - other) / width) > _APART for other in found
        ):
            found.append(point)
            loose += [names] if (names := _loose(search, grid, point)) else []
            if len(loose) == _PLATEAU:
                raise LagtopError(
                    f"the conditions leave {' and '.join(loose[0])} open: many have "
                    f"{search.wanted_text()}; take another condition, or another unknown"
                )
    return sorted(point.tolist() for point in found)


def _loose(search: Search, grid: Scan, point: Array) -> list[str]:
    """Return the unknowns that can change together while the numbers stay, to first order."""
    width = search.ends[1] - search.ends[0]
    slopes = number_slopes(search, point) * width / _sizes(search, grid)[:, np.newaxis]
    if not np.isfinite(slopes).all():
        return []
    _, sizes, directions = np.linalg.svd(slopes)
    still = directions[sizes <= _STILL * sizes[0]]
    moving = np.abs(still).max(axis=0, initial=0.0) > _STILL
    return [name for name, moves in zip(search.spans, moving.tolist(), strict=True) if moves]


def _sizes(search: Search, grid: Scan) -> Array:
    """Return what each number is measured by: how much it varies in the scan."""
    spread = np.nanstd(np.where(np.isfinite(grid.numbers), grid.numbers, np.nan), axis=0)
    return np.where(spread > 0, spread, np.maximum(np.abs(search.wanted), 1e-300))


def _starts(search: Search, grid: Scan) -> list[Array]:
    """Return the points of the grid that are nearer than all their neighbours, the best first."""
    off = (grid.numbers - search.wanted) / _sizes(search, grid)
    size = np.linalg.norm(off, axis=1)
    size = np.where(np.isfinite(size), size, np.inf).reshape(grid.shape)
    best = np.isfinite(size)
    for axis in range(size.ndim):
        for shift in (1, -1):
            beside = np.roll(size, shift, axis)
            edge = [slice(None)] * size.ndim
            edge[axis] = slice(0, 1) if shift == 1 else slice(-1, None)
            beside[tuple(edge)] = np.inf
            best &= size <= beside
    rows = np.flatnonzero(best.ravel())
    order = np.argsort(size.ravel()[rows], kind="stable")[:_MOST_STARTS]
    return [grid.values[row] for row in rows[order]]


def _descended(search: Search, grid: Scan, start: Array) -> Array:
    """Return where the least squares of what is missing lead to from a point."""
    from scipy.optimize import least_squares

    sizes, (low, high) = _sizes(search, grid), search.ends
    width = high - low

    def missing(x: Array) -> Array:
        off = (search.swept(low + width * x[np.newaxis])[0] - search.wanted) / sizes
        return np.where(np.isfinite(off), off, 1e6)

    def slopes(x: Array) -> Array:
        scaled: Array = number_slopes(search, low + width * x) * width / sizes[:, np.newaxis]
        return scaled

    inside = np.clip((start - low) / width, 1e-9, 1 - 1e-9)
    tight = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15, "max_nfev": 60}
    ended = least_squares(missing, inside, slopes, bounds=(0, 1), **tight)
    return np.asarray(low + width * ended.x)


def _settled(search: Search, point: Array) -> Array | None:
    """Return a point that Newton's method with the numbers of `solve` brings to its last bits.

    None where it is no solution: where the numbers are off by more than roundings explain.
    """
    best, least = None, np.inf
    for _ in range(_NEWTON_STEPS):
        slopes = number_slopes(search, point)
        off = search.numbers(point.tolist()) - search.wanted
        if not (np.isfinite(off).all() and np.isfinite(slopes).all()):
            break
        rounding = np.abs(slopes) @ np.spacing(np.abs(point)) + np.spacing(np.abs(search.wanted))
        size = float(np.max(np.abs(off) / rounding))
        if size < least:
            best, least = point, size
        if size == 0:
            break
        step = np.linalg.lstsq(slopes, -off, rcond=None)[0]
        point = np.clip(point + step, *search.ends)
    return best if least <= _BITS else None


def number_slopes(search: Search, point: Array) -> Array:
    """Return the derivatives of the numbers, a row each, by the unknowns, a column each.

    They are exact for the keys of the record, and differences for those on request.
    """
    slopes = _exact(search, point)
    if slopes is None or not np.isfinite(slopes).all():
        return _differences(search, point)
    return slopes


def _exact(search: Search, point: Array) -> Array | None:
    """Return exact derivatives; None where a key has none, or where there is no top."""
    keys = {key: key.replace("_rad", "_deg") for key in search.conditions.numbers}
    if not set(keys.values()) <= set(NUMBER_KEYS):
        return None
    try:
        found = sensitivities(search.top(point.tolist()), list(keys.values())).derivatives
        slopes = [[found[keys[key]][name] for name in search.spans] for key in keys]
    except (LagtopError, KeyError):
        return None
    units = np.array([math.pi / 180 if key.endswith("_rad") else 1.0 for key in keys])
    exact: Array = np.array(slopes) * units[:, np.newaxis]
    return exact


def _differences(search: Search, point: Array) -> Array:
    """Return central differences."""
    low, high = search.ends
    steps = np.diag(_STEP * (high - low))
    above, below = np.minimum(point + steps, high), np.maximum(point - steps, low)
    found = search.swept(np.concatenate([above, below]))
    count = len(point)
    slopes: Array = ((found[:count] - found[count:]) / np.diag(above - below)[:, np.newaxis]).T
    return slopes
