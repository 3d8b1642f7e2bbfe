"""`find`: inputs for which numbers of the record take target values.

A scan by `sweep` supplies the starting points.  One unknown is found by Brent's method between
neighbouring values of the scan, several unknowns by least squares from its best points.  The border
of a class, such as a path with loops, is found by bisection.  All refine with `solve`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import product
from numbers import Integral
from operator import eq, ge, gt, le, lt
from types import NoneType
from typing import Any, NamedTuple

import numpy as np
from scipy.ndimage import minimum_filter
from scipy.optimize import brentq, least_squares

from ..arithmetic.text import double_text, quoted, shortened
from ..arithmetic.types import Array
from ..errors import AbsentError, LagtopError, check_type
from ..names import check_names, repeated
from ..solver.facts import Regime
from ..solver.keys import all_keys, shown_keys, unit_name
from ..solver.solve import Motion, solve
from ..sweeps.plan import shared_inputs
from ..sweeps.records import sweep
from ..top.given import Given, gather
from ..top.inputs import overridden, warn_of
from ..top.top import INPUTS, Top
from ..top.values import (
    Span,
    Value,
    exact_number,
    parse_number_or_span,
    parse_value,
    value_of,
    values_of,
)

COUNTS = {1: 4000, 2: 60, 3: 20}
"""Number of values of each unknown in a scan, by the number of unknowns."""
_WORDS = {"regime": [x.value for x in Regime], "path": ["cusped", "looping", "wavy"]}
"""Keys that hold a word, and the words."""
_RELATIONS: Any = {"=": eq, "<": lt, "<=": le, ">": gt, ">=": ge}
_SWEPT = 2.0**-48
"""Bound of the relative error of a number of a sweep."""
_EXTREMA, _FINER = 12, 100
"""Number of extrema nearest to the target around which the scan is refined, and how much."""
_LEAP = 1e-6
"""Residual at a root, over the residuals at the ends of its bracket, that only a leap exceeds."""
_STARTS, _CLOSE, _APART = 16, 1e-10, 1e-7
"""Starts for several unknowns; the largest residual of a solution, over the spread of the scanned
numbers; the difference, over the range, below which two solutions count as one."""
_FLAT = 1e-7
"""Ratio of singular values of the slopes below which a solution is not isolated."""


class Condition(NamedTuple):
    """A condition on the record of a top: a word, a target value or a bound."""

    key: str
    relation: str
    value: float | str
    has_unit: bool = False
    """Whether the value has a unit other than that of an angle, so that inputs need units too."""

    def holds(self, found: Any) -> bool:
        """Return whether a number or word meets the condition; None does not."""
        return found is not None and bool(_RELATIONS[self.relation](found, self.value))

    def __str__(self) -> str:
        value = self.value if isinstance(self.value, str) else double_text(self.value)
        return f"{self.key} {self.relation} {value.removesuffix('.0')}"


class Search(NamedTuple):
    """Known inputs, ranges of unknown inputs, target values by key, and other conditions.

    If there is no target value, the first of the other conditions has a word: its border is sought.
    """

    fixed: Mapping[str, Any]
    """Numbers; psidot0 may be a word."""
    spans: Mapping[str, Span]
    targets: Mapping[str, float]
    others: Sequence[Condition]
    radians: bool

    @property
    def target_text(self) -> str:
        """The conditions on numbers as text."""
        shown = [Condition(key, "=", x) for key, x in self.targets.items()] or self.others[:1]
        return ", ".join(map(str, shown))

    @property
    def bounds(self) -> Sequence[Condition]:
        """The conditions that solutions must meet besides."""
        return self.others[0 if self.targets else 1 :]

    def top(self, values: Sequence[float] | Array) -> Top:
        """Return the top with these values of the unknowns.  Raises LagtopError."""
        inputs = overridden(dict(self.fixed), dict(zip(self.spans, values, strict=True)))
        return Top(**{x: y if x == "psidot0" else float(y) for x, y in inputs.items()})

    def residuals(self, values: Sequence[float] | Array) -> Array:
        """Return numbers of `solve` minus their targets; NaN where a key has no number."""
        try:
            record = solve(self.top(values)).record(radians=self.radians, keys=list(self.targets))
        except LagtopError:
            return np.full(len(self.targets), np.nan)
        return np.array([record[key] for key in self.targets], float) - [*self.targets.values()]

    def swept(self, values: Array) -> Array:
        """Return the same by `sweep`: a row for each row of values, shape (tops, unknowns)."""
        found = self.sweep(values, list(self.targets))
        return np.array([found[key] - x for key, x in self.targets.items()], float).T

    def sweep(self, values: Array, keys: Sequence[str]) -> Any:
        """Return keys for each row of values, as arrays by key."""
        inputs = overridden(dict(self.fixed), dict(zip(self.spans, values.T, strict=True)))
        return sweep(keys=keys, radians=self.radians, **inputs)


def search_of(
    inputs: Mapping[str, Any],
    conditions: Sequence[str],
    *,
    scene: str | None = None,
    radians: bool = False,
) -> tuple[Search, Given]:
    """Return a search from inputs, conditions and a scene file, and the inputs that were given.

    An unknown input is a `Span`, or a `Value` of one.  Raises LagtopError for bad options, and for
    conditions that cannot have isolated solutions.
    """
    found = [_read_condition(text, radians=radians) for text in conditions]
    given = gather(values_of(inputs), scene, units=any(x.has_unit for x in found))
    if key := repeated(x.key for x in found if x.relation == "="):
        raise LagtopError(f"a condition must name each key once, got {key} twice")
    targets = {x.key: x.value for x in found if x.relation == "=" and not isinstance(x.value, str)}
    others = [x for x in found if x.relation != "=" or isinstance(x.value, str)]
    spans = {name: x for name, x in given.inputs.items() if isinstance(x, Span)}
    if not spans:
        raise LagtopError("no input is unknown: give a range, such as r0=10:200")
    if len(spans) > max(COUNTS):
        raise LagtopError(f"find takes 1 to {max(COUNTS)} unknown inputs, got {len(spans)}")
    words = [x for x in others if isinstance(x.value, str)]
    if "psidot0" in spans and (
        targets.get("k") == 0 or any(x.value == Regime.STEADY for x in words)
    ):
        raise LagtopError("a steady precession is not found by a scan: use psidot0=steady")
    if len(targets) != len(spans) and not (len(spans) == 1 and words and not targets):
        raise LagtopError(
            f"find needs as many conditions KEY=NUMBER as unknown inputs, got {len(targets)} for "
            f"{len(spans)}: {', '.join(spans)}"
        )
    others.sort(key=lambda x: isinstance(x.value, float))
    known = {name: x for name, x in given.values.items() if name not in spans}
    fixed = shared_inputs(given._replace(values=known), varying=spans)
    return Search(fixed, spans, targets, others, radians), given


def _read_condition(text: str, *, radians: bool) -> Condition:
    """Parse `KEY=VALUE` or `KEY<VALUE`; the key of an angle may omit its unit."""
    match = re.fullmatch(r"\s*(\w+)\s*(<=|>=|<|>|=)\s*(.+?)\s*", text)
    if not match:
        raise LagtopError(f"a condition must be KEY=VALUE or KEY<VALUE, got {quoted(text)}")
    name, relation, word = match.groups()
    key, known = unit_name(f"{name}_deg", radians=radians), all_keys(radians=radians)
    if key not in known:
        (key,) = check_names("a condition", [name], known)
    if key in _WORDS:
        word = Regime.STEADY.value if (key, word) == ("regime", "steady") else word
        if relation != "=" or word not in _WORDS[key]:
            wanted, got = ", ".join(_WORDS[key]), f"{'' if relation == '=' else relation}{word}"
            raise LagtopError(f"{key}= must be one of {wanted}, got {shortened(got)}")
        return Condition(key, relation, word)
    unit = shown_keys(radians=radians, requested=True)[key].unit
    value = parse_value(key, word, wanted=unit)
    has_unit = bool(value.unit) and unit not in {"deg", "rad"}
    return Condition(key, relation, float(value.number), has_unit)


def find_tops(search: Search, count: int | None = None) -> tuple[list[Motion], str]:
    """Return the motions that meet the conditions, and a sentence on the scan.

    Raises AbsentError if there is none; its message has the nearest point of the scan.
    """
    each = COUNTS[len(search.spans)] if count is None else count
    if each < 3 or each ** len(search.spans) > 1e7:
        text = f"scan must be 3 or more values of each unknown, and at most 1e7 tops, got {each}"
        raise LagtopError(text, "scan")
    axes = [
        (np.geomspace if x.logarithmic else np.linspace)(float(x.first), float(x.last), each)
        for x in search.spans.values()
    ]
    values = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))
    if search.targets:
        off = search.swept(values)
        points = (_roots if len(axes) == 1 else _minima)(search, values, off)
    else:
        points = _borders(search, values)
    ranges = " and ".join(f"{name} from {span}" for name, span in search.spans.items())
    looked = f"scanned {ranges} at {each} values: solutions closer together may be missed"
    if len(axes) > 1:
        looked = f"scanned {ranges} at {each} values each: only the best points were followed"
    motions = [solve(search.top(point)) for point in points]
    missed = [
        [(x, y) for x in search.bounds if not x.holds(y := _number(m, x.key))] for m in motions
    ]
    kept = [motion for motion, wrong in zip(motions, missed, strict=True) if not wrong]
    if not kept:
        why = f"of {len(motions)} with {search.target_text} none has "
        why += f"{', '.join(map(str, search.bounds))}: the nearest has"
        misses = [_miss(search, *x) for x in zip(missed, points, strict=True)]
        why = f"{why} {min(misses)[1]}" if motions else _nearest(search, values)
        raise AbsentError(f"no top found: {why}; {looked}")
    return kept, looked


def _miss(
    search: Search, wrong: Sequence[tuple[Condition, Any]], point: Sequence[float] | Array
) -> tuple[float, str]:
    """Return how far numbers are from their conditions, and a text with the unknown inputs."""
    sizes, texts = [0.0], []
    for condition, y in wrong:
        if y is None or isinstance(y, str):
            texts.append(f"{condition.key} = {y}")
        else:
            sizes.append(abs(y - float(condition.value)))
            texts.append(f"{condition.key} = {double_text(y)}, {sizes[-1]:.2g} off,")
    where = ", ".join(f"{name} = {x:.6g}" for name, x in zip(search.spans, point, strict=True))
    return sum(sizes), f"{' '.join(texts)} at {where}"


def _number(motion: Motion, key: str) -> Any:
    return motion.record(radians=key.endswith("_rad"), keys=[key])[key]


def _distances(search: Search, residuals: Array) -> tuple[Array, Array]:
    """Return the spread of each number in the scan, and the distance of each top from the targets.

    The distance is the norm of the residuals over the spreads, infinite where a number is missing.
    """
    known = np.isfinite(residuals).all(axis=1)
    sizes = np.maximum(np.abs([*search.targets.values()]), 1e-300)
    spread = np.std(residuals[known], axis=0) if known.any() else sizes
    scale = np.where(spread > 0, spread, sizes)
    return scale, np.where(known, np.linalg.norm(residuals / scale, axis=1), np.inf)


def _nearest(search: Search, values: Array) -> str:
    """Return where the scan comes nearest to the targets, or why it has no numbers."""
    if not search.targets:
        return f"no border of {search.target_text}"
    at = values[int(np.argmin(_distances(search, search.swept(values))[1]))]
    try:
        record = solve(search.top(at)).record(radians=search.radians, keys=list(search.targets))
    except LagtopError as error:
        return f"no top of the scan has {search.target_text} ({error})"
    if None in record.values():
        return f"no top of the scan has {search.target_text}"
    wrong = [(Condition(key, "=", x), record[key]) for key, x in search.targets.items()]
    return f"nearest to {search.target_text} is {_miss(search, wrong, at)[1]}"


def _borders(search: Search, values: Array) -> list[list[float]]:
    """Return where the class of a word begins and ends, in ascending order.

    A class without width, such as that of cusps, is the border of two others: then neighbouring
    doubles may have these.  Raises LagtopError if the whole scan has the word.
    """
    (name, span), (wanted, *_) = next(iter(search.spans.items())), search.others
    words = np.array(search.sweep(values, [wanted.key])[wanted.key], object)
    if (words == wanted.value).all():
        sleeps = wanted.value == Regime.SLEEPING
        hint = "stability_factor=1" if sleeps else "another condition, or another unknown"
        raise LagtopError(f"every {name} from {span} has {wanted}: use {hint}")
    borders = set()
    for i in np.flatnonzero(words[:-1] != words[1:]).tolist():
        ends = [words[i], words[i + 1]]
        if None in ends or (wanted.value in words) != (wanted.value in ends):
            continue
        low, high = values[i : i + 2, 0].tolist()
        while low < (middle := low + (high - low) / 2) < high:
            found = _number(solve(search.top([middle])), wanted.key)
            low, high = (middle, high) if found == ends[0] else (low, middle)
            if found == wanted.value not in ends:
                break
        borders.add(low if ends[0] == wanted.value else high)
    return [[x] for x in sorted(borders)]


def _roots(search: Search, values: Array, residuals: Array) -> list[list[float]]:
    """Return where the number passes its target, in ascending order.

    Raises LagtopError if a whole range of the unknown has the target value.
    """
    ((name, _),), (target,) = search.spans.items(), search.targets.values()

    def off(at: float) -> float:
        return float(search.residuals([at])[0])

    x, y = _refined(search, values[:, 0], residuals[:, 0])
    near = np.abs(y) <= _SWEPT * abs(target)
    flat = near[:-2] & near[1:-1] & near[2:]
    if flat.any():
        first = int(np.argmax(flat))
        last = first + int(np.argmin([*near[first:], False])) - 1
        raise LagtopError(
            f"every {name} from {x[first]:g} to {x[last]:g} has {search.target_text}, which does "
            f"not determine {name}: use another condition, or another unknown"
        )
    roots = set()
    for i in np.flatnonzero((y[:-1] * y[1:] <= 0) | near[:-1] | near[1:]).tolist():
        low, high = float(x[i]), float(x[i + 1])
        ends = off(low), off(high)
        if not ends[0] * ends[1] <= 0:
            continue
        precision = {"xtol": 2e-16 * max(abs(low), abs(high)), "rtol": 8.9e-16, "maxiter": 200}
        try:
            root = float(brentq(off, low, high, **precision, disp=False))
        except ValueError:  # no number between the ends
            continue
        if abs(off(root)) <= _LEAP * max(map(abs, ends)) + 4 * np.spacing(abs(target)):
            roots.add(root)
    return [[x] for x in sorted(roots)]


def _refined(search: Search, x: Array, y: Array) -> tuple[Array, Array]:
    """Return a scan with more points around its extrema, which may hide two solutions."""
    size = np.abs(y)
    least = (size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:])
    inner = np.flatnonzero(least & (y[:-2] * y[1:-1] > 0) & (y[1:-1] * y[2:] > 0)) + 1
    inner = inner[np.argsort(size[inner])][:_EXTREMA]
    finer = np.linspace(x[inner - 1], x[inner + 1], 2 * _FINER + 1).ravel()
    x, order = np.unique([*x, *finer], return_index=True)
    return x, np.concatenate([y, search.swept(finer[:, np.newaxis])[:, 0]])[order]


def _minima(search: Search, values: Array, residuals: Array) -> list[list[float]]:
    """Return where all numbers have their targets, by least squares from minima of the scan.

    Raises LagtopError if solutions are not single points.
    """
    low, high = values.min(axis=0), values.max(axis=0)
    scale, distance = _distances(search, residuals)
    cube = distance.reshape((round(len(distance) ** (1 / len(low))),) * len(low))
    neighbours = [x for x in product((-1, 0, 1), repeat=cube.ndim) if any(x)]
    for off in residuals.T.reshape(-1, *cube.shape):  # flat parts lead nowhere
        moved = (np.roll(off, x, range(cube.ndim)) for x in neighbours)
        same = sum((abs(x - off) <= _SWEPT * abs(off)).astype(int) for x in moved)
        cube = np.where((3 * same > len(neighbours)) & (off != 0), np.inf, cube)
    least = cube == minimum_filter(cube, 3, mode="constant", cval=np.inf)
    starts = np.flatnonzero(least.ravel() & np.isfinite(cube.ravel()))

    def residual(x: Array) -> Array:
        return np.nan_to_num(search.residuals(low + x * (high - low)) / scale, nan=1e6)

    found: list[Array] = []
    for start in starts[np.argsort(distance[starts], kind="stable")][:_STARTS].tolist():
        inside = np.clip((values[start] - low) / (high - low), 1e-9, 1 - 1e-9)
        exact: dict[str, Any] = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)
        ended = least_squares(residual, inside, "3-point", (0, 1), **exact, max_nfev=40)
        is_new = all(np.max(np.abs(ended.x - x)) > _APART for x in found)
        if not is_new or np.max(np.abs(ended.fun)) > _CLOSE:
            continue
        found.append(ended.x)
        sizes = np.linalg.svd(ended.jac)[1]
        if sizes[-1] <= _FLAT * sizes[0]:
            raise LagtopError(
                f"the conditions do not determine {' and '.join(search.spans)}: many values give "
                f"{search.target_text}; use another condition, or another unknown"
            )
    return sorted(np.clip(low + x * (high - low), low, high).tolist() for x in found)


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
    given = {name: _input(name, x) for name, x in inputs.items() if x is not None}
    texts = conditions
    if isinstance(conditions, Mapping):
        texts = [f"{key}={_text(key, value_of(key, x).number)}" for key, x in conditions.items()]
    search, found = search_of(given, list(texts), radians=radians)
    if found.missing:
        warn_of(found.missing, stacklevel=3)
    try:
        return find_tops(search, scan)[0]
    except AbsentError:
        return []


def _text(key: str, number: Any) -> str:
    return number if isinstance(number, str) else repr(float(exact_number(key, number)))


def _input(name: str, given: Any) -> Value:
    """Return a number, or a pair as a range.  Raises LagtopError."""
    if isinstance(given, str):
        steady = name == "psidot0"
        return parse_value(name, given, parse_number_or_span, uncertain=True, steady=steady)
    if np.shape(given) != (2,):
        return value_of(name, given)
    first, last = (float(exact_number(name, x)) for x in given)
    return parse_value(name, f"{first!r}:{last!r}", parse_number_or_span)
