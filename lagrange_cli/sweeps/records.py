"""Many tops at once: the records of `solve`, a column for each key.

Tops released from rest go through `formulas` as arrays of doubles, others as arrays of pairs of
doubles.  `solve` computes a top by itself if digits are lost, if its sizes are beyond 1e+-30, or if
a key is not among FAST_KEYS.  An invalid top gets an `error` and no numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.types import Mask
from ..errors import LagtopError
from ..names import check_names
from ..solver import keys as motion_record
from ..solver.facts import FAST, Regime
from ..solver.keys import degree_name, unit_name
from ..solver.record import FAST_WORDS, record_in_range, vertical_remark
from ..solver.solve import solve
from .elementary import ELEMENTARY, OF_STEADY
from .formulas import OF_PENDULUMS, OF_RELEASED, OF_TORQUE_FREE, OF_VERTICAL, Formulas, Motions
from .results import ResultColumn, Results, read_inputs
from .tops import TopArrays, top_arrays
from .trust import OF_ANY_START, AnyStart

TEXTS = frozenset({*motion_record.TEXT_KEYS, "error"})
"""The columns of texts."""
FAST_KEYS = frozenset(
    {*motion_record.record_keys(), *ELEMENTARY, "k_squared", "comodular_angle_deg"}
)
"""Keys that are formulas of the inputs or of the motion, in degrees."""


def _remarks_on_upright(of: Motions) -> Any:
    stable, unstable = (vertical_remark(Regime.SLEEPING, x) for x in (True, False))
    return np.where(of.start.sleep >= 0, stable, unstable)


def _remarks_on_released(of: Motions) -> Any:
    """Return the remarks on fast tops: the words of `solve`, without its numbers."""
    excess = of.pairs.b * of.pairs.b - of.pairs.a * float(FAST)
    return np.array([None, FAST_WORDS])[(excess.high >= 0).astype(int)]


_FORMULAS: dict[Regime | None, Formulas] = {
    Regime.SLEEPING: OF_VERTICAL | {"remark": _remarks_on_upright},
    Regime.HANGING: OF_VERTICAL | {"remark": lambda _: vertical_remark(Regime.HANGING, True)},
    Regime.TORQUE_FREE: OF_TORQUE_FREE,
    Regime.NO_SPIN: OF_PENDULUMS,
    Regime.REGULAR: OF_RELEASED | {"remark": _remarks_on_released, "path": lambda _: "cusped"},
    Regime.STEADY: OF_STEADY,
    None: OF_ANY_START,
}
"""The formulas of each group of `TopArrays.groups`, except those of ELEMENTARY."""
BLOCK_ROWS = 1 << 12
"""Number of tops computed together, so that their arrays stay in the cache."""
_SHARE, _LEAST_ROWS = 80, 512
"""A top takes 800 bytes while it is computed: such a share of the tops times keys of a sweep takes
1.25 times its result."""


def column_keys(*, radians: bool = False) -> list[str]:
    """Return the keys of a record, and `error`."""
    return [*motion_record.record_keys(radians=radians), "error"]


def sweep(
    *tops: object, keys: Sequence[str] | None = None, radians: bool = False, **inputs: ArrayLike
) -> Results:
    """Return the records of many tops: arrays by key, in the shape to which the inputs broadcast.

    Inputs are those of `Top`, as numbers, arrays or pandas Series: pass a DataFrame of inputs as
    `sweep(**df)`.  Only `keys` are computed; angles are in degrees or `radians`.  A further key
    costs as much as a key of the record if it is a formula of the inputs (such as
    `stability_factor` or `Lz`), and about a millisecond per top otherwise.  If a regime has no
    value for a key, its number is NaN and its text None.  An invalid top has an `error` and no
    values.  If a number is beyond the range of doubles, it is NaN, and `error` says so.  If `keys`
    lacks `error`, the results have it only if a top has an error.  Raises LagtopError for an
    unknown input or key, for uncertain inputs, or if shapes do not broadcast.

    >>> sweep(r0=[[50.0], [60.0]], theta0_deg=[30.0, 90.0], keys=["T_nutation"]).to_xarray().sizes
    Frozen({'r0': 2, 'theta0_deg': 2})
    """
    if tops:
        raise LagtopError("sweep takes inputs by name: pass columns by name: sweep(**df)")
    chosen = check_keys(keys, radians=radians)
    flat, results = read_inputs(inputs)
    size = math.prod(results.shape)
    columns = empty_columns(chosen, size)
    step = min(max(size * len(chosen) // _SHARE, _LEAST_ROWS), BLOCK_ROWS)
    for first in range(0, max(size, 1), step):
        rows = slice(first, min(first + step, size))
        given = {name: x if isinstance(x, str) else x[rows] for name, x in flat.items()}
        part = {key: x[rows] for key, x in columns.items()}
        part = records(top_arrays(given, rows.stop - first), part, {}, radians=radians)
        if part["error"].any():
            columns.setdefault("error", np.full(size, None))[rows] = part["error"]
    results |= {key: x.reshape(results.shape) for key, x in columns.items()}
    return results


def empty_columns(keys: Sequence[str], count: int) -> dict[str, ResultColumn]:
    """Return empty columns for `count` tops."""
    return {key: np.empty(count, dtype=object if key in TEXTS else np.float64) for key in keys}


def check_keys(keys: Sequence[str] | None, *, radians: bool = False) -> Sequence[str]:
    """Return the keys, by default all of a record and `error`.

    Raises LagtopError for an unknown or repeated key.
    """
    if keys is None:
        return column_keys(radians=radians)
    return check_names("keys", keys, [*motion_record.all_keys(radians=radians), "error"])


def records(
    tops: TopArrays,
    columns: Mapping[str, ResultColumn],
    errors: Mapping[int, str],
    *,
    radians: bool = False,
) -> dict[str, ResultColumn]:
    """Fill the columns of a block of tops, and return them with `error`.

    `errors` are those of rows that stay empty.  The result does not depend on the `numpy.errstate`
    of the caller.
    """
    columns = {"error": np.empty(tops.m.size, dtype=object), **columns}
    inputs = tops._asdict() | {
        unit_name("theta0_deg", radians=radians): tops.tilt_in(radians=radians)
    }
    for key, column in columns.items():
        column[:] = inputs.get(key, np.nan if column.dtype == np.float64 else None)
    columns["error"][[*errors]] = [*errors.values()]
    keys = [key for key in columns if key not in inputs and key != "error"]
    missing = np.ones(tops.m.shape, dtype=np.bool_)
    missing[[*errors]] = False
    with np.errstate(all="ignore"):  # what an overflow or a 0/0 has touched is not trusted
        for regime, group in tops.groups().items():
            rows = group & missing
            if {degree_name(key) for key in keys} <= FAST_KEYS and rows.any():
                missing &= ~_filled(tops, rows, regime, columns, keys)
    for row in np.flatnonzero(missing).tolist():
        try:
            motion = solve(tops.one(row))
            record, beyond = record_in_range(motion, radians=radians, keys=keys)
        except LagtopError as error:
            columns["error"][row] = str(error)
            continue
        if beyond:
            columns["error"][row] = "; ".join(map(str, beyond))
        for key in {"r0", "psidot0"} & columns.keys():  # some are known only to `solve`
            record[key] = getattr(motion.top, key)
        if record.get("remark"):
            record["remark"] = record["remark"].partition(":")[0]
        for key, value in record.items():
            if value is not None:
                columns[key][row] = value
    return columns


def _filled(
    tops: TopArrays,
    rows: Mask,
    regime: Regime | None,
    columns: Mapping[str, ResultColumn],
    keys: Sequence[str],
) -> Mask:
    """Fill the keys of those tops of a group whose numbers can all be trusted; return these."""
    some = tops if rows.all() else tops.part(rows)
    at_rest = regime not in {Regime.STEADY, None}
    start = some.start(rough=at_rest and not ELEMENTARY.keys() & {*keys})
    kind = AnyStart if regime is None else Motions
    motions = kind(_FORMULAS[regime] | ELEMENTARY, some, start)
    if regime is not None:
        motions["regime"] = regime.value
    found = {key: motions[key] for key in keys}
    if regime == Regime.STEADY and "psidot0" in columns:
        found["psidot0"] = motions["psidot0"]
    known = motions.known
    rows[rows] = known
    target: Any = slice(None) if rows.all() else rows  # which is faster than a mask
    source: Any = slice(None) if known.all() else known
    for key, value in found.items():
        if value is not None:
            columns[key][target] = value[source] if isinstance(value, np.ndarray) else value
    return rows
