"""`find`: inputs for which numbers of the record take target values.

A scan by `sweep` supplies the starting points.  One unknown, and the border of a class such as a
path with loops, are found by bisection between neighbouring values of the scan, several unknowns by
least squares from its best points.  All refine with `solve`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from numbers import Integral
from types import NoneType
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.text import double_text
from ..arithmetic.types import Array
from ..errors import AbsentError, LagtopError, arg, check_type
from ..names import check_names, repeated
from ..solver.facts import Regime
from ..solver.solve import Motion, solve
from ..top.given import Given, gather
from ..top.inputs import INPUTS, STEADY_WORDS, overridden, warn_of
from ..top.top import Top
from ..top.units import Units
from ..top.values import (
    Span,
    exact_number,
    parse_number_or_span,
    parse_value,
    value_of,
    values_of,
)
from .conditions import WORDS, Condition, read_condition
from .plan import shared_inputs
from .records import sweep
from .results import Results

_COUNTS = {1: 4000, 2: 60, 3: 20}
"""Number of values of each unknown in a scan, by the number of unknowns."""
_SWEPT = 2.0**-48
"""Bound of the relative error of a number of a sweep."""
_EXTREMA, _FINER = 12, 100
"""Number of extrema nearest to the target around which the scan is refined, and how much."""
_TINY = 1e-300
"""Size up to which a border is 0."""
_LEAP = 1e-6
"""Residual at a root, over the residuals at the ends of its bracket, that only a leap exceeds."""
_COINCIDE, _ALONG, _DOUBLE = 1e-3, 1e-2, 1e4
"""Differences, over the range, of one double root found twice, and at which a curve is looked for;
the condition number of the slopes at a double root that is not met exactly."""
_STARTS, _CLOSE, _APART, _SINGULAR = 16, 1e-10, 1e-7, 1e7
"""Starts for several unknowns; the largest residual of a solution, over the spread of the scanned
numbers; the difference, over the range, below which two solutions count as one; the condition
number of the slopes from which a solution is not isolated."""


class Search(NamedTuple):
    """Known inputs, ranges of unknown inputs, and conditions."""

    fixed: Mapping[str, Any]
    """Numbers; psidot0 may be a word."""
    spans: Mapping[str, Span]
    goals: Sequence[Condition]
    """A target value for each unknown input, or one word, whose border is sought."""
    bounds: Sequence[Condition]
    """The conditions that solutions must meet besides."""
    units: Units
    is_body: bool
    """Whether the top must be a body."""

    @property
    def targets(self) -> dict[str, float]:
        """The target values by key."""
        return {x.key: x.value for x in self.goals}

    def top(self, values: Sequence[float] | Array) -> Top:
        """Return the top with these values of the unknowns.  Raises LagtopError."""
        inputs = overridden(dict(self.fixed), dict(zip(self.spans, values, strict=True)))
        top = Top(**{x: y if x == "psidot0" else float(y) for x, y in inputs.items()})
        if self.is_body:
            top.check_body()
        return top

    def residuals(self, values: Sequence[float] | Array) -> Array:
        """Return numbers of `solve` minus their targets; NaN where a key has no number."""
        try:
            record = solve(self.top(values)).record(
                radians=self.units.radians, keys=[*self.targets]
            )
        except LagtopError:
            return np.full(len(self.goals), np.nan)
        return np.array([record[x] for x in self.targets], float) - [*self.targets.values()]

    def swept(self, values: Array) -> Array:
        """Return the same by `sweep`: a row for each row of values, shape (tops, unknowns)."""
        found = self.sweep(values)
        return np.stack([np.asarray(found[x], float) - y for x, y in self.targets.items()], axis=-1)

    def sweep(self, values: Array) -> Results:
        """Return the numbers or words of the goals for each row of values of the unknowns."""
        inputs = overridden(dict(self.fixed), dict(zip(self.spans, values.T, strict=True)))
        return sweep(keys=[*self.targets], radians=self.units.radians, **inputs)


def search_of(
    inputs: Mapping[str, Any], conditions: Sequence[str], scene: str | None, units: Units
) -> tuple[Search, Given]:
    """Return a search from inputs, conditions and a scene file, and the inputs that were given.

    An unknown input is a `Span`, or a `Value` of one.  Raises LagtopError for bad options, and for
    conditions that cannot have isolated solutions.
    """
    found = [read_condition(text, units) for text in conditions]
    given = gather(values_of(inputs), scene, units=any(x.has_unit for x in found))
    if key := repeated(x.key for x in found if x.relation == "="):
        raise LagtopError(f"a condition must name each key once, got {key} twice")
    spans = {name: x for name, x in given.inputs.items() if isinstance(x, Span)}
    if len(spans) not in _COUNTS:
        wanted = f"1 to {max(_COUNTS)} unknown inputs as ranges, such as {arg('r0', '10:200')}"
        raise LagtopError(f"find takes {wanted}, got {len(spans)}")
    steady = {("k", 0), ("regime", Regime.STEADY.value)}
    is_steady = given.inputs.get("psidot0") in STEADY_WORDS
    if not is_steady and steady & {(x.key, x.value) for x in found if x.relation == "="}:
        remedy = f"use {arg('psidot0', 'steady')}"
        raise LagtopError(f"a scan does not find steady precession: {remedy}")
    goals = [x for x in found if x.relation == "=" and x.key not in WORDS]
    if not goals and len(spans) == 1:
        goals = [x for x in found if x.key in WORDS][:1]
    if len(goals) != len(spans):
        raise LagtopError(
            "find needs one condition KEY=NUMBER for each unknown input, got "
            f"{len(goals)} for {', '.join(spans)}"
        )
    known = {name: x for name, x in given.values.items() if name not in spans}
    fixed = shared_inputs(given._replace(values=known), varying=spans)
    bounds = [x for x in found if x not in goals]
    return Search(fixed, spans, goals, bounds, units, given.is_body), given


def find_tops(search: Search, count: int | None = None) -> tuple[list[Motion], str]:
    """Return the motions that meet the conditions, and a sentence on the scan.

    Raises AbsentError if there is none; its message has the nearest point of the scan.
    """
    each = _COUNTS[len(search.spans)] if count is None else count
    if each < 3 or each ** len(search.spans) > 1e7:
        text = f"scan must be 3 or more values of each unknown, and at most 1e7 tops, got {each}"
        raise LagtopError(text, "scan")
    axes = [
        (np.geomspace if x.logarithmic else np.linspace)(float(x.first), float(x.last), each)
        for x in search.spans.values()
    ]
    values = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))
    nearest: list[Any] = []
    double: list[list[float]] = []
    if search.goals[0].key in WORDS:
        points = _borders(search, values)
    else:
        off = search.swept(values)
        if len(axes) == 1:
            points = _roots(search, values, off)
        else:
            found = _minima(search, values, off)
            points, double = [x for x, _ in found], [x for x, is_double in found if is_double]
        nearest = [values[np.argmin(_distances(search, off)[1])]]
    ranges = ", ".join(f"{name} from {span}" for name, span in search.spans.items())
    looked = f"scanned {ranges} at {each} values: solutions closer together may be missed"
    if len(axes) > 1:
        looked = f"scanned {ranges} at {each} values each: only the best points were followed"
    if double:
        looked += f"; two solutions coincide at {', and at '.join(_at(search, x) for x in double)}"
    motions = [solve(search.top(point)) for point in points]
    kept = [x for x in motions if not _misses(search, x, search.bounds)]
    if not kept:
        near = _nearest(search, points or nearest, search.bounds if points else search.goals)
        raise AbsentError(f"no top found: {near}; {looked}{_with_fast_rate(search, count)}")
    return kept, looked


def _with_fast_rate(search: Search, count: int | None) -> str:
    """Return a remedy if the fast steady precession has what the slow one has not."""
    if search.fixed.get("psidot0") != "steady":
        return ""
    fast = search._replace(fixed={**search.fixed, "psidot0": "steady-fast"})
    try:
        find_tops(fast, count)
    except LagtopError:
        return ""
    return f"; {arg('psidot0', 'steady-fast')} has such a top"


def _misses(search: Search, motion: Motion, conditions: Sequence[Condition]) -> dict[str, float]:
    """Return the values of a motion that miss conditions, as texts, and by how much."""
    missed = {}
    for x in conditions:
        found = motion.record(radians=search.units.radians, keys=[x.key])[x.key]
        if not x.holds(found):
            off = abs(found - x.value) if isinstance(found, float) else 0.0
            shown = f"{double_text(found)}, {off:.2g} off," if off else found
            missed[f"{x.key} = {shown}"] = off
    return missed


def _nearest(search: Search, points: Sequence[Any], conditions: Sequence[Condition]) -> str:
    """Return which of some points comes nearest to conditions, or why none does."""
    wanted = ", ".join(map(str, [*search.goals, *search.bounds]))
    try:
        misses = [_misses(search, solve(search.top(x)), conditions) for x in points]
    except LagtopError as error:
        return f"no top of the scan has {wanted} ({error})"
    if not points:
        return f"no border of {wanted}"
    missed, at = min(zip(misses, points, strict=True), key=lambda x: sum(x[0].values()))
    return f"nearest to {wanted} is {' '.join(missed)} at {_at(search, at)}"


def _at(search: Search, point: Sequence[float]) -> str:
    """Return the values of the unknowns in words."""
    return ", ".join(f"{name} = {x:.6g}" for name, x in zip(search.spans, point, strict=True))


@np.errstate(over="ignore")  # infinitely far in tiny spreads
def _distances(search: Search, off: Array) -> tuple[Array, Array]:
    """Return the spread of each number in a scan, and the distances of tops in these spreads."""
    size = np.maximum(np.abs([*search.targets.values()]), 1e-300)
    most = np.max(np.abs(off), axis=0, initial=1e-300, where=np.isfinite(off))
    finite = (x[np.isfinite(x)] for x in (off / most).T)  # squares of 1e200 are no doubles
    spread = most * [x.std() if x.size else 0.0 for x in finite]
    scale = np.where(spread > _SWEPT * size, spread, size)
    return scale, np.nan_to_num(np.linalg.norm(off / scale, axis=1), nan=np.inf)


def _borders(search: Search, values: Array) -> list[list[float]]:
    """Return where the class of a word begins and ends, in ascending order.

    A class without width, such as that of cusps, is the border of two others: then neighbouring
    doubles may have these.  Raises LagtopError if the whole scan has the word.
    """
    (wanted,) = search.goals
    words = np.array(search.sweep(values)[wanted.key], object)
    if (words == wanted.value).all():
        raise _undetermined(search, values[:, 0])

    def word_at(x: float) -> Any:
        return solve(search.top([x])).record(keys=[wanted.key])[wanted.key]

    borders = set()
    for i in np.flatnonzero(words[:-1] != words[1:]).tolist():
        ends = [words[i], words[i + 1]]
        if None in ends or (wanted.value in words) != (wanted.value in ends):
            continue
        low, high = _bisected(word_at, *values[i : i + 2, 0].tolist())
        border = low if ends[0] == wanted.value else high
        borders.add(border if abs(border) > _TINY else 0.0)
    return [[x] for x in sorted(borders)]


def _roots(search: Search, values: Array, off: Array) -> list[list[float]]:
    """Return where the number passes its target, in ascending order.

    Raises LagtopError if a whole range of the unknown has the target value.
    """
    x, size = values[:, 0], np.abs(off[:, 0])
    least = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:])) + 1
    least = least[np.argsort(size[least])][:_EXTREMA]  # may hide two roots: scanned more finely
    finer = np.linspace(x[least - 1], x[least + 1], 2 * _FINER + 1)
    x = np.array(sorted({*x.tolist(), *finer.ravel().tolist()}))  # np.unique would import numpy.ma
    y, (target,) = search.swept(x[:, np.newaxis])[:, 0], search.targets.values()
    near = np.abs(y) <= _SWEPT * abs(target)
    if (near[:-2] & near[1:-1] & near[2:]).any():
        raise _undetermined(search, x[near])

    def residual(at: float) -> float:
        return float(search.residuals([at])[0])

    def sign(at: float) -> float:
        return float(np.sign(residual(at)))

    roots, signs = set(), np.sign(y)  # a product might underflow
    for i in np.flatnonzero((signs[:-1] * signs[1:] <= 0) | near[:-1] | near[1:]).tolist():
        ends = x[i : i + 2].tolist()
        if not sign(ends[0]) * sign(ends[1]) <= 0:
            continue
        found = _bisected(sign, *ends)
        root = min(found, key=lambda at: abs(residual(at)))
        most = np.fmax(*np.abs(y[i : i + 2]))
        if abs(residual(root)) <= _LEAP * most + 4 * np.spacing(abs(target)):
            roots.add(root)
    return [[x] for x in sorted(roots)]


def _bisected(f: Callable[[float], Any], low: float, high: float) -> tuple[float, float]:
    """Return two neighbouring doubles between which f changes."""
    first = f(low)
    while low < (middle := low + (high - low) / 2) < high:
        low, high = (middle, high) if f(middle) == first else (low, middle)
    return low, high


def _around(cube: Array, extreme: Any, beyond: float) -> Array:
    """Return the extreme of each number and its neighbours, with a number beyond the border."""
    padded = np.pad(cube, 1, constant_values=beyond)
    windows = np.lib.stride_tricks.sliding_window_view(padded, (3,) * cube.ndim)
    return np.asarray(extreme(windows, axis=tuple(range(cube.ndim, 2 * cube.ndim))))


def _minima(search: Search, values: Array, off: Array) -> list[tuple[list[float], bool]]:
    """Return where all numbers have their targets, by least squares from minima of the scan.

    Each comes with whether two solutions coincide.

    Raises LagtopError if solutions are not single points.
    """
    from scipy.optimize import least_squares  # start-up

    low, high = values.min(axis=0), values.max(axis=0)
    scale, distance = _distances(search, off)
    cube = distance.reshape((round(len(distance) ** (1 / len(low))),) * len(low))
    for y, target in zip(off.T.reshape(-1, *cube.shape), search.targets.values(), strict=True):
        rise = _around(y, np.max, -np.inf) - _around(y, np.min, np.inf)
        is_off = np.abs(y) > _SWEPT * abs(target)
        flat = _around(rise <= _SWEPT * np.abs(y), np.max, False)
        cube = np.where(flat & is_off, np.inf, cube)  # leads nowhere
    least = cube == _around(cube, np.min, np.inf)
    starts = np.flatnonzero(least.ravel() & np.isfinite(cube.ravel()))

    def residual(x: Array) -> Array:
        return np.nan_to_num(search.residuals(low + x * (high - low)) / scale, nan=1e6)

    def solved(start: Array) -> Any:
        exact: dict[str, Any] = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)
        return least_squares(residual, start, "3-point", (0, 1), **exact, max_nfev=40)

    found: dict[tuple[float, ...], bool] = {}
    for start in starts[np.argsort(distance[starts], kind="stable")][:_STARTS].tolist():
        inside = np.clip((values[start] - low) / (high - low), 1e-9, 1 - 1e-9)
        ended = solved(inside)
        slack, x = np.linalg.cond(ended.jac), ended.x
        if np.max(np.abs(ended.fun)) > _CLOSE or _is_among(x, found, slack):
            continue
        if slack >= _DOUBLE:
            if slack >= _SINGULAR and _is_curve(solved, ended):
                raise _undetermined(search)
            twice = x - 2 * np.linalg.lstsq(ended.jac, ended.fun, rcond=None)[0]  # Newton's step
            if np.max(np.abs(residual(np.clip(twice, 0, 1)))) <= _CLOSE:
                x = np.clip(twice, 0, 1)
        found[tuple(x)] = slack >= _DOUBLE
    tops = (
        (np.clip(low + np.array(x) * (high - low), low, high).tolist(), y) for x, y in found.items()
    )
    return sorted(tops)


def _is_among(x: Array, found: Iterable[Sequence[float]], slack: float) -> bool:
    """Return whether a solution was found before; a double root is inaccurate."""
    apart = _COINCIDE if slack >= _DOUBLE else _APART
    return any(np.max(np.abs(x - np.array(y))) <= apart for y in found)


def _is_curve(solved: Callable[[Array], Any], ended: Any) -> bool:
    """Return whether solutions lie along the direction in which a solution is not determined.

    If not, two solutions coincide at it.
    """
    along = np.linalg.svd(ended.jac)[2][-1]
    for step in (_ALONG, -_ALONG):
        other = solved(np.clip(ended.x + step * along, 1e-9, 1 - 1e-9))
        moved = np.max(np.abs(other.x - ended.x))
        if np.max(np.abs(other.fun)) <= _CLOSE and moved > _ALONG / 4:
            return True
    return False


def _undetermined(search: Search, values: Array | None = None) -> LagtopError:
    """Return the error of conditions that many values of the unknowns meet, such as these."""
    names, goals = " and ".join(map(arg, search.spans)), ", ".join(map(str, search.goals))
    where = "" if values is None else f" from {values[0]:g} to {values[-1]:g}"
    sleeps = search.goals[0].value == Regime.SLEEPING
    remedy = "stability_factor=1" if sleeps else "another condition, or another unknown"
    text = f"do not determine {names}: many values{where} give {goals}; use {remedy}"
    return LagtopError(f"the conditions {text}")


def find(
    conditions: Mapping[str, Any] | Sequence[str],
    *,
    scan: int | None = None,
    radians: bool = False,
    **inputs: Any,
) -> list[Motion]:
    """Return the motions that meet all conditions: `find({"T_precession": 2}, r0=(10, 200))`.

    An input is a number, or a pair (from, to) or a text `[log:]from:to` if it is unknown.  Pass up
    to three unknowns, and as many conditions KEY=NUMBER.  `regime=`, `path=` and bounds KEY<NUMBER
    discard motions.  The search starts from `scan` values of each unknown.  Angles are in degrees
    or `radians`.  Uncertainties are ignored.  The list may be empty.  Raises LagtopError, also if
    the conditions do not determine the unknowns.

    >>> [x.top.r0 for x in find({"T_precession": 2.0}, r0=(10, 200), theta0_deg=30)]
    [119.38669907271795]
    """
    check_type("scan", scan, Integral, NoneType)
    check_names("inputs", list(inputs) or ["m"], INPUTS)
    given = {
        name: parse_value(
            name, _text(name, x), parse_number_or_span, uncertain=True, steady=name == "psidot0"
        )
        for name, x in inputs.items()
        if x is not None
    }
    texts: Iterable[str] = [conditions] if isinstance(conditions, str) else conditions
    if isinstance(conditions, Mapping):
        texts = [f"{key}={_text(key, x)}" for key, x in conditions.items()]
    search, found = search_of(given, list(texts), None, Units(radians))
    if found.missing:
        warn_of(found.missing, stacklevel=3)
    try:
        return find_tops(search, scan)[0]
    except AbsentError:
        return []


def _text(name: str, given: Any) -> str:
    """Return a text, a number or a pair of numbers as a text.  Raises LagtopError."""
    if isinstance(given, str):
        return given
    numbers = [value_of(name, x).number for x in (given if np.shape(given) == (2,) else [given])]
    return ":".join(repr(float(exact_number(name, x))) for x in numbers)
