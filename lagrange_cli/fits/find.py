"""`find`: tops whose records have target values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from numbers import Integral
from types import NoneType
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.text import double_text
from ..arithmetic.types import Array
from ..errors import AbsentError, LagtopError, check_type
from ..inputs.input_keys import warn_of
from ..inputs.names import check_names
from ..inputs.ranges import parse_span
from ..inputs.top import INPUTS
from ..motion.solve import Motion, record_in_range, solve
from ..output.progress import Progress, silent
from .newton import solutions
from .roots import roots
from .search import Scan, Search, scan_of, search_of

_SWEPT = 2.0**-48
"""The relative error of a number of a sweep is less."""


class FoundTops(NamedTuple):
    """The tops that were found, and how they were looked for."""

    motions: list[Motion]
    looked: str
    """One sentence on the scan."""


def find(
    conditions: Sequence[str], *, scan: int | None = None, radians: bool = False, **inputs: Any
) -> list[Motion]:
    """Return the motions that keep all conditions, such as `find(["T_precession=2"], r0="10:200")`.

    An input is a number, or a text `[log:]from:to` where it is unknown; there are up to three
    unknowns, and as many conditions KEY=NUMBER.  `regime=`, `path=` and bounds KEY<NUMBER leave out
    what does not keep them.  Found is what a `scan` of so many values of each unknown brackets.
    One unknown is the double whose number comes nearest to the target: where that number hardly
    changes, other doubles do as well.  The list may be empty.  Raises LagtopError, also where the
    number has its target value in a whole range.
    """
    check_type("scan", scan, Integral, NoneType)
    check_names("inputs", list(inputs) or ["m"], INPUTS)
    given = {name: _read(name, x) for name, x in inputs.items() if x is not None}
    search, found = search_of(given, conditions, radians=radians)
    if found.missing:
        warn_of(found.missing, stacklevel=3)
    try:
        return find_tops(search, scan).motions
    except AbsentError:
        return []


def _read(name: str, value: Any) -> Any:
    """Return a number as it is, and the range that a text stands for."""
    try:
        return parse_span(value) if isinstance(value, str) else value
    except LagtopError as error:
        raise LagtopError(f"{name} {error}", name) from None


def find_tops(search: Search, count: int | None, progress: Progress = silent) -> FoundTops:
    """Return the tops that keep the conditions.

    Raises AbsentError, which says how near the scan came, where there is none.
    """
    grid = scan_of(search, count, progress)
    if len(search.spans) == 1:
        points = [[x] for x in _roots(search, grid)]
    else:
        points = solutions(search, grid)
    motions, broken = [], None
    for point in points:
        motion = solve(search.top(point))
        record = record_in_range(motion, radians=search.radians, keys=search.conditions.keys)[0]
        fault = search.conditions.broken_by(record)
        broken = broken or fault
        if fault is None:
            motions.append(motion)
    looked = _looked(search, grid)
    if not motions:
        raise AbsentError(f"no top found: {_why(search, grid, len(points), broken)}; {looked}")
    return FoundTops(motions, looked)


def _roots(search: Search, grid: Scan) -> list[float]:
    target, x = float(search.targets[0]), grid.values[:, 0]

    def off(at: float) -> float:
        return float(search.numbers([at])[0]) - target

    y = grid.numbers[:, 0] - target
    _refuse_plateaus(search, x, y, off)
    return roots(off, x, y, target)


def _refuse_plateaus(search: Search, x: Array, y: Array, off: Callable[[float], float]) -> None:
    """Raise LagtopError if neighbouring values of the scan all have the target value."""
    near = np.abs(y) <= _SWEPT * np.abs(search.targets[0])
    for i in np.flatnonzero(near[:-2] & near[1:-1] & near[2:]).tolist():
        if not any(map(off, x[i : i + 3].tolist())):
            last = i + int(np.argmin([*near[i:], False])) - 1
            name = next(iter(search.spans))
            raise LagtopError(
                f"every {name} from {x[i]:g} to {x[last]:g} has {search.target_text()}, which does "
                f"not tell {name}: take another condition, or another unknown"
            )


def _looked(search: Search, grid: Scan) -> str:
    """Return how fine the scan was, and what that means."""
    ranges = " and ".join(f"{name} from {span}" for name, span in search.spans.items())
    each = "" if len(grid.shape) == 1 else " each"
    caution = "what lies closer together may be missed"
    if len(grid.shape) > 1:
        caution = "found is what its best points led to"
    return f"scanned {ranges} at {grid.shape[0]} values{each}: {caution}"


def _why(search: Search, grid: Scan, count: int, broken: str | None) -> str:
    """Return why nothing was found: what is nearest, or what is broken by all solutions."""
    if broken is not None:
        return f"of {count} with {search.target_text()} none has {broken}"
    known = np.isfinite(grid.numbers).all(axis=1)
    if not known.any():
        return f"no top of the scan has {search.target_text()}{_error(search, grid)}"
    size = np.maximum(np.abs(search.targets), np.ptp(grid.numbers[known], axis=0))
    off = np.abs(grid.numbers - search.targets) / np.where(size > 0, size, 1.0)
    nearest = int(np.nanargmin(np.where(known, np.linalg.norm(off, axis=1), np.nan)))
    reached = ", ".join(
        f"{key} = {_short(value, wanted)}"
        for (key, wanted), value in zip(
            search.conditions.numbers.items(), grid.numbers[nearest].tolist(), strict=True
        )
    )
    where = ", ".join(
        f"{name} = {value:.6g}"
        for name, value in zip(search.spans, grid.values[nearest], strict=True)
    )
    return f"nearest to {search.target_text()} is {reached} at {where}"


def _error(search: Search, grid: Scan) -> str:
    """Return what is wrong with the first top of a scan, if anything is."""
    try:
        solve(search.top(grid.values[0]))
    except LagtopError as error:
        return f" ({error})"
    return ""


def _short(value: float, wanted: float) -> str:
    """Return a number in six digits, or in all if six are those of the target."""
    text = f"{value:.6g}"
    return double_text(value) if text == f"{wanted:.6g}" else text
