"""Many tops at once: the records of `solve`, a column for each key.

Blocks of tops are computed in bounded doubles; those with a number whose bound exceeds 1e-13 of its
size, in bounded pairs of doubles; and by `solve` if it still does, or if sizes are beyond 1e+-30.
An invalid top gets an `error` and no numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.bounded import EPS, Bounded
from ..errors import LagtopError
from ..files.tops import Tops
from ..names import check_names
from ..solver import keys as motion_record
from ..solver.facts import FAST, Regime
from ..solver.keys import LINES
from ..solver.record import FAST_WORDS, record_in_range, vertical_remark
from ..solver.solve import solve
from ..top.units import DEGREES, Units, bare_name
from .numbers import GOOD, ArrayNumbers
from .results import ResultColumn, Results, read_inputs
from .tops import TopArrays, top_arrays

TEXTS = frozenset({*motion_record.TEXT_KEYS, "error"})
"""The columns of texts."""
RADIUS = "_radius"
"""The end of the name of a bound."""
_DEGREE = Bounded(180 / np.pi, EPS * 180 / np.pi)
_LEAST, _MOST = 1e-280, 1e280
"""Sizes between which no rounding error is lost."""
Rows = NDArray[np.intp]
BLOCK_ROWS = 1 << 12
"""Number of tops computed together, so that their arrays stay in the cache."""
_MOST_ROWS = 8 * BLOCK_ROWS
"""Most tops in a block of `sweep`: the few that need pairs of doubles are computed together."""
_SHARE, _LEAST_ROWS = 110, 2048
"""A top takes 1,100 bytes while it is computed: such a share of the tops times keys of a sweep
takes 1.25 times its result."""


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
    size = math.prod(results.shape)
    columns = _empty(chosen, size)
    most = min(max(size // 8, BLOCK_ROWS), _MOST_ROWS)  # their columns are computed and copied
    step = min(max(size * len(chosen) // _SHARE, _LEAST_ROWS), most)
    for first in range(0, max(size, 1), step):
        rows = slice(first, min(first + step, size))
        given = {name: x if isinstance(x, str) else x[rows] for name, x in flat.items()}
        part, _ = records(Tops(rows.stop - first, given), chosen, are_bodies=are_bodies)
        if part["error"].any():
            columns.setdefault("error", np.full(size, None))
        for key, column in columns.items():
            column[rows] = part[key]
    results |= {key: x.reshape(results.shape) for key, x in columns.items()}
    return results


def _empty(keys: Iterable[str], count: int) -> dict[str, ResultColumn]:
    return {key: np.empty(count, dtype=object if key in TEXTS else np.float64) for key in keys}


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


def records(
    block: Tops, keys: Sequence[str], *, are_bodies: bool
) -> tuple[dict[str, ResultColumn], int]:
    """Return the columns of a block of tops, with `error`, and the number of tops with C > 2A.

    These tops have an error if the tops must be bodies.  The result does not depend on the
    `numpy.errstate` of the caller.
    """
    tops = top_arrays(block.inputs, block.size)
    not_bodies = tops.not_bodies()
    errors = {**block.errors, **(not_bodies if are_bodies else {})}
    columns = _empty(dict.fromkeys([*keys, "error"]), tops.size)
    inputs = {x: tops.tilt.in_unit(x) for x in ("theta0_deg", "theta0_rad")}
    inputs |= {f"{x}{RADIUS}": np.zeros(tops.size) for x in tops.forms} | tops.forms | tops.inputs
    for key, column in columns.items():
        column[:] = inputs.get(key, np.nan if column.dtype == np.float64 else None)
    columns["error"][[*errors]] = [*errors.values()]
    given = {*inputs, "error"}
    left_keys = [key for key in columns if key not in given and not key.endswith(RADIUS)]
    if "psidot0" in columns and (tops.steady > 0).any():
        left_keys.append("psidot0")
    alone = np.ones(tops.size, dtype=np.bool_)
    alone[[*errors]] = False
    wanted: dict[int, list[str]] = {}
    with np.errstate(all="ignore"):  # what an overflow or a 0/0 has touched is not trusted
        for regime, group in tops.groups().items():
            rows = np.flatnonzero(group & alone)
            left = dict.fromkeys(left_keys, rows) if rows.size else {}
            for pairs in [True] if regime is None else [False, True]:
                left = _rest(tops, left, regime, pairs, columns) if left else {}
            for key, rows in left.items():
                for row in rows.tolist():
                    wanted.setdefault(row, []).append(key)
            alone &= ~group
    wanted |= dict.fromkeys(np.flatnonzero(alone).tolist(), left_keys)
    _solve(tops, dict(sorted(wanted.items())), columns)
    return columns, len(not_bodies)


def _solve(
    tops: TopArrays, wanted: Mapping[int, Sequence[str]], columns: Mapping[str, ResultColumn]
) -> None:
    """Fill the keys of some rows by `solve`, and their errors."""
    units = Units(radians=any(key.endswith("_rad") for key in columns))
    for row, names in wanted.items():
        try:
            motion = solve(tops.one(row))
            record, beyond = record_in_range(motion, radii=True, units=units, keys=names)
        except LagtopError as error:
            columns["error"][row] = str(error)
            continue
        if beyond:
            columns["error"][row] = "; ".join(map(str, beyond))
        for key in tops.inputs.keys() & columns.keys():  # some are known only to `solve`
            record[key] = getattr(motion.top, key)
        if record.get("remark"):
            record["remark"] = record["remark"].partition(":")[0]
        for key, value in record.items():
            if value is not None and key in columns:
                columns[key][row] = value


def _rest(
    tops: TopArrays,
    left: Mapping[str, Rows],
    regime: Regime | None,
    pairs: bool,
    columns: Mapping[str, ResultColumn],
) -> dict[str, Rows]:
    """Fill the rows of each key whose numbers can be trusted, and return the others by key."""
    first, *others = left.values()
    same = all(mine is first for mine in others)
    rows = first if same else np.unique(np.concatenate([first, *others]))
    rest: dict[str, list[Rows]] = {key: [] for key in left}
    for start in range(0, rows.size, BLOCK_ROWS):
        some = rows[start : start + BLOCK_ROWS]
        of = ArrayNumbers(tops.part(_span(some)), regime, pairs=pairs)
        for key, mine in left.items():
            sought = True if same else np.isin(some, mine)
            rest[key].append(_filled(of, key, some, sought, columns))
    return {key: np.concatenate(x) for key, x in rest.items() if any(mine.size for mine in x)}


def _span(rows: Rows) -> Any:
    """Return rows as a slice, which is faster, if no row between them is missing."""
    return slice(rows[0], rows[-1] + 1) if rows[-1] - rows[0] < rows.size else rows


def _filled(
    of: ArrayNumbers, key: str, rows: Rows, sought: Any, columns: Mapping[str, ResultColumn]
) -> Rows:
    """Fill those rows of a key that are sought and can be trusted, and return the other ones."""
    if key in motion_record.TEXT_KEYS:
        value, trusted = text_of(of, key)
        values = {key: value}
    else:
        value, error, trusted = number_of(of, key)
        values = {key: value, f"{key}{RADIUS}": error}
    target, found = _span(rows), None
    if not (sought is True and np.all(trusted)):
        found = np.broadcast_to(sought & trusted, rows.shape)
        target = rows[found]
    for name in values.keys() & columns.keys():
        value = values[name]
        columns[name][target] = value if found is None or not np.ndim(value) else value[found]
    return rows[:0] if found is None else rows[sought & ~found]


def number_of(of: ArrayNumbers, key: str) -> tuple[Any, Any, Any]:
    """Return the numbers of a key, NaN where there is none, their bounds, and which are trusted."""
    bare = bare_name(key)
    has = of.has(bare)
    if has is False or not np.any(has):
        return np.nan, np.nan, True
    number = of[bare].rounded()
    if key.endswith("_deg"):
        number = number * _DEGREE
    value, size, error = number.value, number.size, number.error
    limit = GOOD * (1.0 if bare in LINES and LINES[bare].relative_to else size)
    trusted = (error <= limit) & ((size >= _LEAST) & (size <= _MOST) | (size == 0))
    if has is True or np.all(has):
        return value, error, trusted
    value, error = (np.where(has, x, np.nan) for x in (value, error))
    return value, error, trusted | ~has


def text_of(of: ArrayNumbers, key: str) -> tuple[Any, Any]:
    """Return the texts of a key, and which of them are certain."""
    regime = of.regime
    if key == "path":
        return of.path
    if key == "regime":
        if regime is not None:
            return regime.value, True
        words = np.array([Regime.NO_SPIN.value, Regime.REGULAR.value], dtype=object)
        return words[(of["r0"].doubles != 0).astype(int)], of["is_regular"]
    return _remark(of)


def _remark(of: ArrayNumbers) -> tuple[Any, Any]:
    regime = of.regime
    if of.vertical:
        stable, unstable = (vertical_remark(regime or Regime.HANGING, x) for x in (True, False))
        return np.where(of["b"].doubles ** 2 >= 2 * of["a"].doubles, stable, unstable), True
    if regime is None:
        return None, of["is_regular"]
    if regime is not Regime.REGULAR:
        return None, True
    excess = of["b"] * of["b"] - of["a"] * float(FAST)
    words = np.array([None, FAST_WORDS], dtype=object)
    return words[(excess.doubles >= 0).astype(int)], excess.size > excess.error
