"""`find`: tops whose records have target values.

With one unknown, solutions are roots between values of a scan.  Several unknowns are found by
Newton's method within their ranges, from the best points of the scan.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Integral
from types import NoneType
from typing import Any

import numpy as np

from ..arithmetic.text import double_text
from ..arithmetic.types import Array
from ..errors import AbsentError, LagtopError, check_type
from ..inputs.input_keys import warn_of
from ..inputs.names import check_names
from ..inputs.top import INPUTS
from ..motion.numbers import record_in_range
from ..motion.record import record_keys
from ..motion.solve import Motion, solve
from ..output.terminal import Progress, silent
from ..sweeps.results import TEXTS, ResultColumn, Results
from .roots import roots
from .search import Condition, Scan, Search, condition_texts, read_unknown, scan_of, search_of

_SWEPT = 2.0**-48
"""Bound of the relative error of a number of a sweep."""
_MOST_STARTS = 16
_NEWTON_STEPS = 6
_APART = 1e-9
"""Difference, over the range, below which two solutions count as one."""
_PLATEAU = 3
"""Number of solutions on curves from which the conditions count as insufficient."""
_STILL = 1e-7
"""Ratio to the steepest slope below which a slope counts as 0, above the error of differences."""
_BITS = 4.0
"""Permitted error of a number, in last bits of the unknowns and of the number itself."""
_STEP = 1e-5
"""Steps over the range of an unknown: the error of a central difference is about their square."""


class Found(Results):
    """The records of the tops that `find` found, as arrays by key, and their motions."""

    def __init__(self, motions: Sequence[Motion], *, radians: bool) -> None:
        records = [record_in_range(motion, radians=radians)[0] for motion in motions]
        columns: dict[str, ResultColumn] = {
            key: np.array([x[key] for x in records], dtype=object if key in TEXTS else np.float64)
            for key in record_keys(radians=radians)
        }
        super().__init__(columns, {}, ("top",))
        self.motions = list(motions)


def find(
    conditions: Mapping[str, float | str] | Sequence[str],
    *,
    scan: int | None = None,
    radians: bool = False,
    **inputs: Any,
) -> Found:
    """Return the tops that meet all conditions: `find({"T_precession": 2}, r0=(10, 200))`.

    An input is a number, or a pair (from, to) if it is unknown.  Pass up to three unknowns, and as
    many conditions with a number.  Texts are accepted too: `[log:]from:to` and KEY=NUMBER.
    `regime=`, `path=` and bounds KEY<NUMBER discard tops.  The search starts from `scan` values of
    each unknown.  With one unknown, the solution is the double whose number is nearest to the
    target.  If the number hardly changes, other doubles are equally good.  The result may have no
    tops.  Its angles, and those of conditions, are in degrees or `radians`.  Quantities of pint are
    converted to SI, and uncertainties are ignored.  Raises LagtopError, also if the number has its
    target value in a whole range.

    >>> find({"T_precession": 2.0}, r0=(10, 200), theta0_deg=30).motions[0].top.r0
    119.38669907271795
    """
    check_type("scan", scan, Integral, NoneType)
    check_names("inputs", list(inputs) or ["m"], INPUTS)
    given = {name: read_unknown(name, x) for name, x in inputs.items() if x is not None}
    search, found = search_of(given, condition_texts(conditions), radians=radians)
    if found.missing:
        warn_of(found.missing, stacklevel=3)
    try:
        return Found(find_tops(search, scan)[0], radians=radians)
    except AbsentError:
        return Found([], radians=radians)


def find_tops(
    search: Search, count: int | None, progress: Progress = silent
) -> tuple[list[Motion], str]:
    """Return the tops that keep the conditions, and one sentence on the scan.

    Raises AbsentError if there is none; its message has the nearest point of the scan.
    """
    grid = scan_of(search, count, progress)
    points = _roots(grid) if len(search.spans) == 1 else _solutions(grid)
    motions, broken = [], None
    for point in points:
        motion = solve(search.top(point))
        keys = list(dict.fromkeys(condition.key for condition in search.conditions))
        record = record_in_range(motion, radians=search.radians, keys=keys)[0]
        fault = search.broken_by(record)
        broken = broken or fault
        if fault is None:
            motions.append(motion)
    looked = _looked(grid)
    if not motions:
        raise AbsentError(f"no top found: {_why(grid, len(points), broken)}; {looked}")
    return motions, looked


def _roots(grid: Scan) -> list[list[float]]:
    """Return the values of a single unknown.  Raises LagtopError as `find` does."""
    search, x = grid.search, grid.values[:, 0]
    target = float(search.targets[0])

    def off(at: float) -> float:
        return float(search.numbers([at])[0]) - target

    y = grid.numbers[:, 0] - target
    near = np.abs(y) <= _SWEPT * abs(target)
    for i in np.flatnonzero(near[:-2] & near[1:-1] & near[2:]).tolist():
        if not any(map(off, x[i : i + 3].tolist())):
            last = i + int(np.argmin([*near[i:], False])) - 1
            (name,) = search.spans
            raise LagtopError(
                f"every {name} from {x[i]:g} to {x[last]:g} has {search.target_text()}, which does "
                f"not determine {name}: use another condition, or another unknown"
            )
    return [[root] for root in roots(off, x, y, target)]


def _looked(grid: Scan) -> str:
    """Return a sentence on the resolution of the scan, and its consequence."""
    ranges = " and ".join(f"{name} from {span}" for name, span in grid.search.spans.items())
    each, caution = "", "solutions closer together may be missed"
    if len(grid.shape) > 1:
        each, caution = " each", "only its best points were followed"
    return f"scanned {ranges} at {grid.shape[0]} values{each}: {caution}"


def _why(grid: Scan, count: int, broken: Condition | None) -> str:
    """Return why nothing was found: the nearest number, or a condition that all solutions break."""
    search, wanted = grid.search, grid.search.target_text()
    if broken is not None:
        return f"of {count} with {wanted} none has {broken}"
    known = np.isfinite(grid.numbers).all(axis=1)
    if not known.any():
        return f"no top of the scan has {wanted}{_error(grid)}"
    size = np.maximum(np.abs(search.targets), np.ptp(grid.numbers[known], axis=0))
    off = np.abs(grid.numbers - search.targets) / np.where(size > 0, size, 1.0)
    nearest = int(np.nanargmin(np.where(known, np.linalg.norm(off, axis=1), np.nan)))
    found = zip(search.keys, grid.numbers[nearest].tolist(), search.targets.tolist(), strict=True)
    reached = ", ".join(f"{key} = {_short(value, target)}" for key, value, target in found)
    unknowns = zip(search.spans, grid.values[nearest], strict=True)
    where = ", ".join(f"{name} = {value:.6g}" for name, value in unknowns)
    return f"nearest to {wanted} is {reached} at {where}"


def _error(grid: Scan) -> str:
    """Return the error of the first top of a scan in brackets, if it has one."""
    try:
        solve(grid.search.top(grid.values[0]))
    except LagtopError as error:
        return f" ({error})"
    return ""


def _short(value: float, wanted: float) -> str:
    """Return a number in six digits, or in full if six digits equal those of the target."""
    text = f"{value:.6g}"
    return double_text(value) if text == f"{wanted:.6g}" else text


def _solutions(grid: Scan) -> list[list[float]]:
    """Return the values of the unknowns at which all numbers have their target values.

    Raises LagtopError if the solutions are not single points.  That is the case if at _PLATEAU of
    them the numbers are constant along some direction.
    """
    found: list[Array] = []
    loose: list[list[str]] = []
    search = grid.search
    low, high = search.ends
    for start in _starts(grid):
        point = _settled(search, _descended(grid, start))
        if point is not None and all(
            np.max(np.abs(point - other) / (high - low)) > _APART for other in found
        ):
            found.append(point)
            loose += [names] if (names := _loose(grid, point)) else []
            if len(loose) == _PLATEAU:
                raise LagtopError(
                    f"the conditions do not determine {' and '.join(loose[0])}: many values give "
                    f"{search.target_text()}; use another condition, or another unknown"
                )
    return sorted(point.tolist() for point in found)


def _loose(grid: Scan, point: Array) -> list[str]:
    """Return the unknowns that can change together without changing the numbers, to first order."""
    low, high = grid.search.ends
    slopes = number_slopes(grid.search, point) * (high - low) / grid.sizes[:, np.newaxis]
    if not np.isfinite(slopes).all():
        return []
    _, sizes, directions = np.linalg.svd(slopes)
    still = directions[sizes <= _STILL * sizes[0]]
    moving = np.abs(still).max(axis=0, initial=0.0) > _STILL
    return [name for name, moves in zip(grid.search.spans, moving.tolist(), strict=True) if moves]


def _starts(grid: Scan) -> list[Array]:
    """Return the points of the grid that are nearer than all their neighbours, the best first."""
    size = np.linalg.norm((grid.numbers - grid.search.targets) / grid.sizes, axis=1)
    size = np.where(np.isfinite(size), size, np.inf).reshape(grid.shape)
    best, padded = np.isfinite(size), np.pad(size, 1, constant_values=np.inf)
    for axis in range(size.ndim):
        for shift in (1, -1):
            best &= size <= np.roll(padded, shift, axis)[(slice(1, -1),) * size.ndim]
    rows = np.flatnonzero(best.ravel())
    order = np.argsort(size.ravel()[rows], kind="stable")[:_MOST_STARTS]
    return [grid.values[row] for row in rows[order]]


def _descended(grid: Scan, start: Array) -> Array:
    """Return the point that least squares of the errors reach from a point."""
    from scipy.optimize import least_squares

    search, sizes = grid.search, grid.sizes
    low, high = search.ends
    width = high - low

    def missing(x: Array) -> Array:
        off = (search.swept(low + width * x[np.newaxis])[0] - search.targets) / sizes
        return np.where(np.isfinite(off), off, 1e6)

    def slopes(x: Array) -> Array:
        scaled: Array = number_slopes(search, low + width * x) * width / sizes[:, np.newaxis]
        return scaled

    inside = np.clip((start - low) / width, 1e-9, 1 - 1e-9)
    ended = least_squares(
        missing, inside, slopes, (0, 1), xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=60
    )
    return np.asarray(low + width * ended.x)


def _settled(search: Search, point: Array) -> Array | None:
    """Return a solution refined to its last bits by Newton's method, with the numbers of `solve`.

    Returns None if the numbers are off by more than rounding errors.
    """
    best, least = None, np.inf
    for _ in range(_NEWTON_STEPS):
        slopes = number_slopes(search, point)
        off = search.numbers(point.tolist()) - search.targets
        if not (np.isfinite(off).all() and np.isfinite(slopes).all()):
            break
        rounding = np.abs(slopes) @ np.spacing(np.abs(point)) + np.spacing(np.abs(search.targets))
        size = float(np.max(np.abs(off) / rounding))
        if size < least:
            best, least = point, size
        if size == 0:
            break
        step = np.linalg.lstsq(slopes, -off, rcond=None)[0]
        point = np.clip(point + step, *search.ends)
    return best if least <= _BITS else None


def number_slopes(search: Search, point: Array) -> Array:
    """Return the derivatives of the numbers, a row each, by the unknowns: central differences."""
    low, high = search.ends
    steps = np.diag(_STEP * (high - low))
    above, below = np.minimum(point + steps, high), np.maximum(point - steps, low)
    found = search.swept(np.concatenate([above, below]))
    change = found[: len(point)] - found[len(point) :]
    slopes: Array = (change / np.diag(above - below)[:, np.newaxis]).T
    return slopes
