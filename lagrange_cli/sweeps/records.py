"""Many tops at once: the records of `solve`, a column for each key.

Blocks of tops are computed in bounded doubles; those with a number whose bound exceeds 1e-13 of its
size, in bounded pairs of doubles; and by `solve` if it still does, or if sizes are beyond 1e+-30.
An invalid top gets an `error` and no numbers.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.bounded import EPS, Bounded, choose
from ..errors import LagtopError
from ..files.tops import Tops
from ..names import RADIUS, check_names
from ..solver import keys as motion_record
from ..solver.facts import Regime
from ..solver.keys import LINES
from ..solver.record import path_words, record_in_range, remark_without_numbers, remark_words
from ..solver.solve import solve
from ..top.units import DEGREES, Units, bare_name
from .numbers import GOOD, ArrayNumbers
from .results import ResultColumn, Results, read_inputs
from .tops import INPUTS, TopArrays, top_arrays

TEXTS = frozenset({*motion_record.TEXT_KEYS, "error"})
"""The columns of texts."""
_TOGETHER = 1 << 13
"""Number of tops computed together: their arrays take at most 14 MB."""
_DEGREE = Bounded(180 / np.pi, None, EPS, positive=True)
_LEAST, _MOST = 1e-280, 1e280
"""Sizes between which no rounding error is lost."""
Rows = NDArray[np.intp]
Lost = dict[tuple[Regime | None, bool], dict[str, list[Rows]]]
"""Rows whose bounds are too wide, by group and key."""
Columns = dict[str, ResultColumn]


def column_keys(units: Units = DEGREES) -> list[str]:
    """Return the keys of a record, and `error`."""
    return [*motion_record.record_keys(units), "error"]


def sweep(
    *tops: object,
    keys: Sequence[str] | None = None,
    radians: bool = False,
    radii: bool = False,
    **inputs: ArrayLike,
) -> Results:
    """Return the records of many tops: arrays by key, in the shape to which the inputs broadcast.

    Inputs are those of `Top`, as numbers, arrays or pandas Series: pass a DataFrame of inputs as
    `sweep(**df)`.  Only `keys` are computed; angles are in degrees or `radians`.  `radii` adds
    KEY_radius, a bound on the distance from the double KEY to its exact value: at most 1e-13 of its
    size (of 1 for a cosine), whether it is added or not.  If a regime has no value for a key, its
    number is NaN and its text None.  An invalid top has an `error` and no values.  If a number is
    beyond the range of doubles, it is NaN, and `error` says so.  If `keys` lacks `error`, the
    results have it only if a top has an error.  Raises LagtopError for an unknown input or key, for
    uncertain inputs, or if shapes do not broadcast.

    >>> sweep(r0=[[50.0], [60.0]], theta0_deg=[30.0, 90.0], keys=["T_nutation"]).to_xarray().sizes
    Frozen({'r0': 2, 'theta0_deg': 2})
    """
    if tops:
        raise LagtopError("sweep takes inputs by name: pass columns by name: sweep(**df)")
    chosen = with_radii(check_keys(keys, Units(radians)), radii=radii)
    flat, results, are_bodies = read_inputs(inputs)
    block = Tops(math.prod(results.shape), flat)
    columns, errors, _ = records(block, chosen, are_bodies=are_bodies)
    if errors:
        columns.setdefault("error", np.full(block.size, None))
        columns["error"][[*errors]] = [*errors.values()]
    results |= {key: x.reshape(results.shape) for key, x in columns.items()}
    return results


def check_keys(keys: Sequence[str] | None, units: Units = DEGREES) -> Sequence[str]:
    """Return the keys, by default all of a record and `error`.

    Raises LagtopError for an unknown or repeated key.
    """
    if keys is None:
        return column_keys(units)
    return check_names("keys", keys, [*motion_record.all_keys(units), "error"])


def with_radii(keys: Sequence[str], *, radii: bool) -> list[str]:
    """Return keys and, with `radii`, the names of the bounds of their errors."""
    return [*keys, *(f"{key}{RADIUS}" for key in keys if radii and bare_name(key) in LINES)]


@np.errstate(all="ignore")  # what an overflow or a 0/0 has touched is not trusted
def records(
    block: Tops, keys: Iterable[str], *, are_bodies: bool
) -> tuple[Columns, dict[int, str], int]:
    """Return the columns of a block of tops, errors by row, and the number of tops with C > 2A.

    These tops have an error if the tops must be bodies.  The column of errors is empty.  The result
    does not depend on the `numpy.errstate` of the caller.
    """
    columns: Columns = {
        key: np.full(block.size, None if key in TEXTS else np.nan) for key in dict.fromkeys(keys)
    }
    errors, not_bodies, alone = dict(block.errors), 0, dict[int, list[str]]()
    lost: Lost = defaultdict(lambda: defaultdict(list))
    for first in range(0, block.size, _TOGETHER):
        rows = np.arange(first, min(first + _TOGETHER, block.size))
        tops = _taken(block, rows)
        known = tops.known(columns)
        for key, x in known.items():
            columns[key][_span(rows)] = x
        heavy = rows[tops.numbers["C"] > 2 * tops.numbers["A"]]
        not_bodies += heavy.size
        if are_bodies:
            errors |= dict.fromkeys(heavy.tolist(), _NO_BODY)
        sought = [x for x in columns if x not in {*known, "error"} and not x.endswith(RADIUS)]
        fine = ~np.isin(rows, [*errors])
        for group, mask in tops.groups().items():
            mine = np.flatnonzero(mask & fine)
            fine &= ~mask
            if not mine.size:
                continue
            of = ArrayNumbers(tops.part(_span(mine)), group[0])
            for key in [*sought, *["psidot0"] * (group[0] is Regime.STEADY)]:
                if (left := _filled(of, key, first + mine, True, columns)).size:
                    lost[group][key].append(left)
        alone |= dict.fromkeys(rows[fine].tolist(), sought)
    _solve(block, alone | _lost_in_pairs(block, lost, columns), columns, errors)
    return columns, errors, not_bodies


def _lost_in_pairs(block: Tops, lost: Lost, columns: Columns) -> dict[int, list[str]]:
    """Fill rows that are lost in doubles, and return the keys of those that only `solve` has."""
    alone: dict[int, list[str]] = defaultdict(list)
    for (regime, _), found in lost.items():
        left = {key: np.concatenate(rows) for key, rows in found.items()}
        every = np.unique(np.concatenate([*left.values()]))
        for start in range(0, every.size, _TOGETHER):
            rows = every[start : start + _TOGETHER]
            of = ArrayNumbers(_taken(block, rows), regime, pairs=True)
            for key, mine in left.items():
                for row in _filled(of, key, rows, np.isin(rows, mine), columns).tolist():
                    alone[row].append(key)
    return alone


_NO_BODY = "C must be <= 2 A (no rigid body has more)"


def _span(rows: Rows) -> Any:
    """Return rows as a slice, which is faster, if no row between them is missing."""
    return slice(rows[0], rows[-1] + 1) if rows[-1] - rows[0] < rows.size else rows


def _taken(block: Tops, rows: Rows) -> TopArrays:
    """Return some of the tops."""
    span, many = _span(rows), np.ndarray | np.flatiter
    inputs = {name: x[span] if isinstance(x, many) else x for name, x in block.inputs.items()}
    return top_arrays(inputs, rows.size)


def _solve(
    block: Tops,
    wanted: Mapping[int, Sequence[str]],
    columns: Mapping[str, ResultColumn],
    errors: dict[int, str],
) -> None:
    """Fill the keys of some rows by `solve`, and their errors."""
    units = Units(radians=any(key.endswith("_rad") for key in columns))
    for row, names in sorted(wanted.items()):
        try:
            motion = solve(_taken(block, np.array([row])).one(0))
            record, beyond = record_in_range(motion, radii=True, units=units, keys=names)
        except LagtopError as error:
            errors[row] = str(error)
            continue
        if beyond:
            errors[row] = "; ".join(map(str, beyond))
        for key in INPUTS & columns.keys():  # some are known only to `solve`
            record[key] = getattr(motion.top, key)
        if "remark" in record:
            record["remark"] = remark_without_numbers(motion.facts)
        for key, value in record.items():
            if value is not None and key in columns:
                columns[key][row] = value


def _filled(of: ArrayNumbers, key: str, rows: Rows, sought: Any, columns: Columns) -> Rows:
    """Fill those rows of a key that are sought and can be trusted, and return the other ones."""
    error: Any = np.nan
    if key in motion_record.TEXT_KEYS:
        value, trusted = text_of(of, key)
    else:
        number, trusted = number_of(of, key)
        value = number.value
        if f"{key}{RADIUS}" in columns:
            error = np.where(np.isnan(value), value, number.error)
    target, found = _span(rows), None
    if not (sought is True and np.all(trusted)):
        found = np.broadcast_to(sought & trusted, rows.shape)
        target = rows[found]
    for name, x in ((key, value), (f"{key}{RADIUS}", error)):
        if name in columns:
            columns[name][target] = x if found is None or not np.ndim(x) else x[found]
    return rows[:0] if found is None else rows[sought & ~found]


def number_of(of: ArrayNumbers, key: str) -> tuple[Bounded, Any]:
    """Return the numbers of a key, NaN where there is none, and which are trusted."""
    bare = bare_name(key)
    has = of.has(bare)
    if has is False or not np.any(has):
        return Bounded(np.nan), True
    number = of[bare].rounded()
    if key.endswith("_deg"):
        number = number * _DEGREE
    size, trusted = number.size, True
    if number.relative is None or number.relative > GOOD:
        is_cosine = bare in LINES and LINES[bare].relative_to
        trusted = number.error <= GOOD * (1.0 if is_cosine else size)
    if not (np.min(size) >= _LEAST and np.max(size) <= _MOST):
        trusted = trusted & ((size >= _LEAST) & (size <= _MOST) | (size == 0))
    if has is True or np.all(has):
        return number, trusted
    return choose(has, number, Bounded(np.nan)), trusted | ~has


def text_of(of: ArrayNumbers, key: str) -> tuple[Any, Any]:
    """Return the texts of a key, and which of them are certain."""
    words = path_words(of, of) if key == "path" else remark_words(of)
    if key == "regime":
        spinless = of.regime is None and of.spin == 0
        words = iter([(Regime.NO_SPIN.value, spinless), (str(of.regime or Regime.REGULAR), True)])
    text: Any = None
    for word, holds in reversed([*words]):
        shared = np.array(word, object)  # one text for all tops
        text = shared if holds is True else np.where(holds, shared, text)
    return text, of.is_certain(key)
