"""Many tops at once: the records of `solve`, a column for each key.

Tops released from rest go through the formulas of `motion` as arrays of doubles, others as arrays
of pairs of doubles.  `solve` computes a top by itself if its sizes are beyond 1e+-30, or if a
cancellation costs too many digits.  It also computes all further keys.  An invalid top gets an
`error` and no numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.types import Array, Mask
from ..errors import LagtopError
from ..names import check_names
from ..solver import record as motion_record
from ..solver.kinds import vertical_remark
from ..solver.numbers import gaps_of, kind_of, record_in_range
from ..solver.quantity import degree_name
from ..solver.regime import FAST, Regime
from ..solver.solve import solve
from ..solver.spin_precession import fast_remark
from ..top.top import Top
from .elementary import ELEMENTARY, Elementary
from .moving_tops import MovingTops
from .results import ResultColumn, Results, SweepInputs
from .top_arrays import TopArrays, facts_at_rest

TEXTS = frozenset({*motion_record.TEXT_KEYS, "error"})
"""The columns of texts."""
OF_MODULI: dict[str, Callable[[Any], Array]] = {
    "k_squared": lambda motion: motion.m,
    "comodular_angle_deg": lambda motion: np.degrees(np.arctan2(motion.k_prime, motion.k)),
}
"""Further keys that a nutation after release from rest has, from its moduli."""
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
    size, found = given.size, _empty_columns(chosen, given.size)
    step = min(max(size * len(chosen) // _SHARE, _LEAST_ROWS), BLOCK_ROWS)
    for first in range(0, max(size, 1), step):
        rows = slice(first, first + step)
        part = records(
            given.part(rows),
            list(found),
            radians=radians,
            columns={key: x[rows] for key, x in found.items()},
        )
        if part["error"].any():
            found.setdefault("error", np.full(size, None))[rows] = part["error"]
    columns = {key: found[key] for key in chosen}
    if "error" in found and found["error"].any():
        columns["error"] = found["error"]
    return given.results(columns)


def _empty_columns(keys: Sequence[str], count: int) -> dict[str, ResultColumn]:
    """Return empty columns for `count` tops."""
    return {key: np.empty(count, dtype=object if key in TEXTS else np.float64) for key in keys}


def check_keys(keys: Sequence[str] | None, *, radians: bool = False) -> Sequence[str]:
    """Return the keys, by default all of a record and `error`.

    Raises LagtopError for an unknown or repeated key.
    """
    known = column_keys(radians=radians)
    if keys is None:
        return known
    if isinstance(keys, Sequence) and not set(keys) <= set(known):
        known = [*motion_record.all_keys(radians=radians), "error"]
    return check_names("keys", keys, known)


def records(
    tops: TopArrays,
    keys: Sequence[str],
    *,
    radians: bool = False,
    errors: Mapping[int, str] | None = None,
    columns: dict[str, ResultColumn] | None = None,
) -> dict[str, ResultColumn]:
    """Return the columns of a block of tops; rows that already have an error stay empty.

    The columns are new, unless columns of `_empty_columns` are passed, and always have `error`.
    The result does not depend on the `numpy.errstate` of the caller.
    """
    with ARRAYS.working():
        columns = _empty_columns(keys, tops.m.size) if columns is None else columns
        block = _Block(tops, columns, radians)
        left = np.ones(tops.m.shape, dtype=np.bool_)
        for row, error in (errors or {}).items():
            left[row], block.columns["error"][row] = False, error
        for regime, found in tops.regimes().items():
            if (rows := found & left).any():
                block.fill(rows, regime)
                left &= ~rows
        if left.any() and (moving := left & tops.moving()).any():
            left &= ~block.fill_moving(moving)
        unsure = left | block.fill_elementary(~left)
        for row in np.flatnonzero(unsure | bool(block.requested)).tolist():
            keys_left = [*block.texts, *block.numbers] if left[row] else []
            some = block.elementary if unsure[row] else []
            block.solve(row, [*keys_left, *some, *block.requested])
        return block.columns


class _Block:
    """The columns of a block of tops, while they are being filled."""

    def __init__(self, tops: TopArrays, columns: Mapping[str, ResultColumn], radians: bool) -> None:
        self.tops, self.radians = tops, radians
        self.columns = {"error": np.empty(tops.m.size, dtype=object), **columns}
        tilt = {f"theta0_{'rad' if radians else 'deg'}": tops.tilt_in(radians)}
        given = tops._asdict() | tilt
        known = motion_record.record_keys(radians=radians)
        others = {*given, *TEXTS}
        self.texts = [key for key in columns if key in motion_record.TEXT_KEYS]
        self.numbers = [key for key in columns if key in known and key not in others]
        self.numbers += [key for key in columns if degree_name(key) in OF_MODULI]
        others |= {*self.numbers, *self.texts}
        self.elementary = [key for key in columns if key in ELEMENTARY]
        self.requested = [key for key in columns if key not in {*others, *self.elementary}]
        for key, column in self.columns.items():
            column[:] = given.get(key, np.nan if column.dtype == np.float64 else None)

    def fill(self, rows: Mask, regime: Regime) -> None:
        """Fill the rows of one regime, all released from rest, by the formulas over doubles."""
        chosen = slice(None) if rows.all() else rows
        tops = self.tops.part(chosen)
        facts, state = facts_at_rest(regime, tops.r0), tops.state()
        gaps = gaps_of(ARRAYS, facts, state)
        motion = kind_of(facts)(ARRAYS, facts, state, gaps)
        lacks = {*motion.lacks, "theta_min_deg"}  # the least tilt is the start
        for key in (key for key in self.numbers if key.startswith("theta_min")):
            self.columns[key][chosen] = tops.tilt_in(self.radians)
        remarks: Sequence[str | None] | None = None
        if regime in {Regime.SLEEPING, Regime.HANGING}:
            remarks = [vertical_remark(regime, stable) for stable in state.sleep >= 0]
        elif regime is Regime.REGULAR and "remark" in self.texts:
            remarks = self._fast_remarks(tops, motion)
        path = "cusped" if regime is Regime.REGULAR else None
        texts = {"regime": regime.value, "path": path, "remark": remarks}

        def number(name: str) -> Array | None:
            if name in OF_MODULI:
                return OF_MODULI[name](motion) if path or facts.plane else None
            return None if name in lacks else getattr(motion, name)

        self._write(chosen, number, texts)

    def _write(
        self, rows: Any, number: Callable[[str], Array | None], texts: Mapping[str, Any]
    ) -> None:
        """Write texts of some rows, and numbers by a function of the key (angles in degrees)."""
        for key in texts.keys() & {*self.texts}:
            self.columns[key][rows] = texts[key]
        for key in self.numbers:
            value = number(degree_name(key))
            if value is not None:
                self.columns[key][rows] = np.radians(value) if key.endswith("_rad") else value

    def _fast_remarks(self, tops: TopArrays, motion: Any) -> list[str | None]:
        """Return the remark of `solve` on each pseudo-regular precession among tops."""
        remarks: list[str | None] = [None] * tops.m.size
        rows = np.flatnonzero(motion.b * motion.b > 0.99 * FAST * motion.a)
        rows = rows[tops.part(rows).fast()] if rows.size else rows
        if rows.size:
            nodding = motion.nodding if self.radians else np.degrees(motion.nodding)
            quantities = nodding, motion.T_nutation, motion.elementary_rate, motion.excess
            numbers = (x[rows].tolist() for x in quantities)
            for row, *found in zip(rows.tolist(), *numbers, strict=True):
                remarks[row] = fast_remark(*found, radians=self.radians)
        return remarks

    def fill_moving(self, rows: Mask) -> Mask:
        """Fill rows with other initial rates, if they can be trusted; return which these are."""
        tops = self.tops.part(slice(None) if rows.all() else np.flatnonzero(rows))
        motions = MovingTops(tops)
        trusted = motions.trusted(self.numbers)
        fine: Any = slice(None) if trusted.all() else trusted
        filled = rows.copy()
        filled[rows] = trusted

        def number(name: str) -> Array | None:
            value = None if name in OF_MODULI else motions.number(name)
            return None if value is None else value[fine]

        regimes = np.array([Regime.REGULAR.value, Regime.NO_SPIN.value], dtype=object)
        without_spin = (tops.r0[fine] == 0).astype(np.intp)
        texts = {"regime": regimes[without_spin], "path": motions.paths()[fine]}
        self._write(slice(None) if filled.all() else filled, number, texts)
        return filled

    def fill_elementary(self, rows: Mask) -> Mask:
        """Fill rows of the keys that are formulas of the inputs; return which `solve` must fill."""
        left = np.zeros_like(rows)
        if not self.elementary:
            return left
        numbers = Elementary(self.tops)
        for key in self.elementary:
            values, unsure = numbers.number(key)
            self.columns[key][rows] = values[rows]
            left |= unsure & rows
        return left

    def solve(self, row: int, keys: Sequence[str]) -> None:
        """Fill some keys of one row by `solve`, unless it has an error."""
        if self.columns["error"][row] is not None:
            return
        try:
            motion = solve(Top(**self.tops.one(row)))
            record, beyond = record_in_range(motion, radians=self.radians, keys=keys)
        except LagtopError as error:
            self.columns["error"][row] = str(error)
            return
        if beyond:
            self.columns["error"][row] = "; ".join(map(str, beyond))
        for key in keys:
            if record[key] is not None:
                self.columns[key][row] = record[key]
