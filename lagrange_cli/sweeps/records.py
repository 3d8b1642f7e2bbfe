"""Many tops at once: the records of `solve`, a column for each key.

Tops released from rest go through `formulas` as arrays of doubles, others as arrays of pairs of
doubles.  `solve` computes a top by itself if digits are lost, if its sizes are beyond 1e+-30, or if
a key is not among FAST_KEYS.  An invalid top gets an `error` and no numbers.
"""

from __future__ import annotations

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
from .elementary import ELEMENTARY, Elementary, Steady
from .formulas import (
    OF_PENDULUMS,
    OF_RELEASED,
    OF_TORQUE_FREE,
    OF_VERTICAL,
    Motions,
    Start,
    gaps_from_rest,
    texts,
)
from .results import ResultColumn, Results, SweepInputs
from .tops import TopArrays
from .trust import AnyStart

TEXTS = frozenset({*motion_record.TEXT_KEYS, "error"})
"""The columns of texts."""
OF_MODULI = ("k_squared", "comodular_angle_deg")
"""Further keys that are formulas of the moduli."""
FAST_KEYS = frozenset({*motion_record.record_keys(), *OF_MODULI, *ELEMENTARY})
"""Keys that are formulas of the inputs or of the motion, in degrees."""
FORMULAS = {
    Regime.SLEEPING: OF_VERTICAL,
    Regime.HANGING: OF_VERTICAL,
    Regime.TORQUE_FREE: OF_TORQUE_FREE,
    Regime.NO_SPIN: OF_PENDULUMS,
    Regime.REGULAR: OF_RELEASED,
}
"""The formulas of tops of a regime that are released from rest."""
BLOCK_ROWS = 1 << 12
"""Number of tops computed together, so that their arrays stay in the cache."""
_SHARE, _LEAST_ROWS = 80, 512
"""A top takes 800 bytes while it is computed: such a share of the tops times keys of a sweep takes
1.25 times its result."""


def column_keys(*, radians: bool = False) -> list[str]:
    """Return the keys of a record, and `error`."""
    return [*motion_record.record_keys(radians=radians), "error"]


def sweep(
    *tops: object,
    keys: Sequence[str] | None = None,
    radians: bool = False,
    **inputs: ArrayLike,
) -> Results:
    """Return the records of many tops: arrays by key, in the shape to which the inputs broadcast.

    Inputs are those of `Top`, as numbers, arrays or pandas Series: pass a DataFrame of inputs as
    `sweep(**df)`.  Only `keys` are computed; angles are in
    degrees or `radians`.  A further key costs as much as a key of the record if it is a formula
    of the inputs (such as `stability_factor` or `Lz`), and about a millisecond per top otherwise.
    If a regime has no value for a key, its number is NaN and its text None.  An invalid top has an
    `error` and no values.  If a number is beyond the range of doubles, it is NaN, and `error` says
    so.  If `keys` lacks `error`, the results have it only if a top has an error.  Raises
    LagtopError for an unknown input or key, for uncertain inputs, or if shapes do not broadcast.

    >>> sweep(r0=[[50.0], [60.0]], theta0_deg=[30.0, 90.0], keys=["T_nutation"]).to_xarray().sizes
    Frozen({'r0': 2, 'theta0_deg': 2})
    """
    if tops:
        raise LagtopError("sweep takes inputs by name: pass columns by name: sweep(**df)")
    chosen = check_keys(keys, radians=radians)
    given = SweepInputs(inputs)
    size, found = given.size, empty_columns(chosen, given.size)
    step = min(max(size * len(chosen) // _SHARE, _LEAST_ROWS), BLOCK_ROWS)
    for first in range(0, max(size, 1), step):
        rows = slice(first, first + step)
        part = {key: x[rows] for key, x in found.items()}
        part = records(given.part(rows), part, {}, radians=radians)
        if part["error"].any():
            found.setdefault("error", np.full(size, None))[rows] = part["error"]
    columns = {key: found[key] for key in chosen}
    if "error" in found and found["error"].any():
        columns["error"] = found["error"]
    return given.results(columns)


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
    inputs = tops._asdict() | {unit_name("theta0_deg", radians=radians): tops.tilt_in(radians)}
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
                missing &= ~_filled(tops, rows, regime, columns, keys, radians=radians)
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
    *,
    radians: bool,
) -> Mask:
    """Fill the keys of those tops of a group whose numbers can all be trusted; return these."""
    some = tops if rows.all() else tops.part(rows)
    start = some.start(rough=regime in FORMULAS and not ELEMENTARY.keys() & {*keys})
    motions, elementary = _motions(some, start, regime, radians), Elementary(some, start)
    known, found = motions.trusted(keys), dict[str, Any]()
    for key in [*keys, *({"psidot0"} & motions.keys() & columns.keys())]:
        if key in ELEMENTARY:
            found[key], lost = elementary.number(key)
            known = known & ~lost
        else:
            found[key] = motions[key]
    rows[rows] = known
    target: Any = slice(None) if rows.all() else rows  # which is faster than a mask
    source: Any = slice(None) if np.all(known) else known
    for key, value in found.items():
        if value is not None:
            columns[key][target] = value[source] if isinstance(value, np.ndarray) else value
    return rows


def _motions(tops: TopArrays, start: Start, regime: Regime | None, radians: bool) -> Motions:
    """Return the motions of a group of `TopArrays.groups`."""
    if regime is None:
        return AnyStart(start)
    nutates = regime in {Regime.REGULAR, Regime.NO_SPIN}
    if regime == Regime.STEADY:
        motions: Motions = Steady(tops, start)
    else:
        rough = start.in_doubles()
        motions = Motions(FORMULAS[regime], rough, gaps_from_rest(rough) if nutates else None)
    motions["regime"] = regime.value
    motions["path"] = "cusped" if regime == Regime.REGULAR else None
    motions.formulas = motions.formulas | {"remark": lambda _: _remarks(regime, start)}
    for key in ["theta_min_deg"] if nutates else ["theta_min_deg", "theta_max_deg"]:
        motions[unit_name(key, radians=radians)] = tops.tilt_in(radians)
    return motions


def _remarks(regime: Regime, start: Start) -> Any:
    """Return the remarks on tops released from rest: the words of `solve`, without its numbers."""
    if regime in {Regime.HANGING, Regime.SLEEPING}:
        stable, unstable = (vertical_remark(regime, x) for x in (True, False))
        return texts(start.sleep.high >= 0, stable, unstable)
    if regime == Regime.REGULAR:
        return texts((start.b * start.b - start.a * float(FAST)).high >= 0, FAST_WORDS, None)
    return None
