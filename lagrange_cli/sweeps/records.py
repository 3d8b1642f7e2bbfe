"""Many tops at once: the records of `solve`, a column for each key.

Tops released from rest go through `formulas` as arrays of doubles, others as arrays of pairs of
doubles.  `solve` computes a top by itself if `trust` finds that digits are lost, if its sizes are
beyond 1e+-30, and for a steady precession given by a word.  It also computes all further keys.  An
invalid top gets an `error` and no numbers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.types import Array, Mask
from ..errors import LagtopError
from ..names import check_names
from ..solver import keys as motion_record
from ..solver.facts import Regime
from ..solver.keys import degree_name, unit_name
from ..solver.record import record_in_range
from ..solver.solve import solve
from ..top.top import Top
from .elementary import ELEMENTARY, Elementary
from .formulas import (
    OF_PENDULUMS,
    OF_RELEASED,
    OF_TORQUE_FREE,
    OF_VERTICAL,
    Motions,
    Start,
    gaps_from_rest,
)
from .results import ResultColumn, Results, SweepInputs
from .tops import TopArrays
from .trust import AnyStart

TEXTS = frozenset({*motion_record.TEXT_KEYS, "error"})
"""The columns of texts."""
OF_MODULI = ("k_squared", "comodular_angle_deg")
"""Further keys that are formulas of the moduli."""
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
    if keys is None:
        return column_keys(radians=radians)
    return check_names("keys", keys, [*motion_record.all_keys(radians=radians), "error"])


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
    with np.errstate(all="ignore"):  # `trust` rejects what an overflow or a 0/0 has touched
        columns = _empty_columns(keys, tops.m.size) if columns is None else columns
        block = _Block(tops, columns, radians, errors or {})
        for regime, rows in tops.released().items():
            block.fill_released(rows & block.missing, regime)
        block.fill_moving(tops.moving() & block.missing)
        block.fill_elementary()
        block.solve_the_rest()
        return block.columns


class _Block:
    """The columns of a block of tops, while they are being filled."""

    def __init__(
        self,
        tops: TopArrays,
        columns: Mapping[str, ResultColumn],
        radians: bool,
        errors: Mapping[int, str],
    ) -> None:
        self.tops, self.radians = tops, radians
        self.columns = {"error": np.empty(tops.m.size, dtype=object), **columns}
        inputs = tops._asdict() | {f"theta0_{'rad' if radians else 'deg'}": tops.tilt_in(radians)}
        record = motion_record.record_keys(radians=radians)
        self.inputs = [key for key in columns if key in inputs]
        self.texts = [key for key in columns if key in motion_record.TEXT_KEYS]
        self.elementary = [key for key in columns if key in ELEMENTARY]
        others = {*self.inputs, *self.texts, *self.elementary, "error"}
        known = {*record, *OF_MODULI, *(unit_name(key, radians=True) for key in OF_MODULI)} - others
        self.numbers = [key for key in columns if key in known]
        self.further = [key for key in columns if key not in known | others]
        for key, column in self.columns.items():
            column[:] = inputs.get(key, np.nan if column.dtype == np.float64 else None)
        self.missing = np.ones(tops.m.shape, dtype=np.bool_)
        """Tops whose numbers and texts are not filled yet; those with an error stay empty."""
        self.lost = np.zeros(tops.m.shape, dtype=np.bool_)
        """Other tops with an elementary key that has lost digits."""
        for row, error in errors.items():
            self.missing[row], self.columns["error"][row] = False, error

    def fill_released(self, rows: Mask, regime: Regime) -> None:
        """Fill tops of one regime that are released from rest."""
        if not rows.any():
            return
        tops = self.tops if rows.all() else self.tops.part(rows)
        start, formulas = tops.start(), FORMULAS[regime]
        nutates = regime in {Regime.REGULAR, Regime.NO_SPIN}
        motions = Motions(formulas, start, gaps_from_rest(start) if nutates else None)
        texts: dict[str, Any] = {"regime": regime.value}
        texts["path"] = "cusped" if regime == Regime.REGULAR else None
        if "remark" in self.texts:
            texts["remark"] = _remarks(regime, tops, start)
        tilts = {"theta_min_deg"} if nutates else {"theta_min_deg", "theta_max_deg"}
        self._write(rows, motions, texts, dict.fromkeys(tilts, tops.tilt_in(self.radians)))

    def fill_moving(self, rows: Mask) -> None:
        """Fill the tops with other initial rates that can be trusted."""
        if not rows.any():
            return
        tops = self.tops if rows.all() else self.tops.part(rows)
        motions = AnyStart(tops.start_in_pairs())
        trusted = motions.trusted(self.numbers)
        words = np.array([Regime.REGULAR.value, Regime.NO_SPIN.value], dtype=object)
        texts = {"regime": words[(tops.r0 == 0).astype(np.intp)], "path": motions.paths}
        filled = rows.copy()
        filled[rows] = trusted
        self._write(filled, motions, texts, {}, slice(None) if trusted.all() else trusted)

    def _write(
        self,
        rows: Mask,
        motions: Motions,
        texts: Mapping[str, Any],
        given: Mapping[str, Array],
        some: Any = slice(None),
    ) -> None:
        """Write the texts and numbers of some motions into rows.

        Numbers that are `given` are in the unit of the columns already.
        """
        chosen: Any = slice(None) if rows.all() else rows
        for key in texts.keys() & {*self.texts}:
            text = texts[key]
            self.columns[key][chosen] = text[some] if isinstance(text, np.ndarray) else text
        for key in self.numbers:
            name = degree_name(key)
            value = given[name] if name in given else motions[name]
            if value is not None and name not in given and key != name:
                value = np.radians(value)
            if value is not None:
                self.columns[key][chosen] = value[some]
        self.missing &= ~rows

    def fill_elementary(self) -> None:
        """Fill the keys that are formulas of the inputs, of all tops that are not missing."""
        if not self.elementary:
            return
        numbers, done = Elementary(self.tops), ~self.missing
        for key in self.elementary:
            values, lost = numbers.number(key)
            self.columns[key][done] = values[done]
            self.lost |= lost & done

    def solve_the_rest(self) -> None:
        """Fill by `solve` what is missing, and the further keys of all tops."""
        rows = self.missing | self.lost | bool(self.further)
        opened = self.tops.open
        for row in np.flatnonzero(rows).tolist():
            keys = list(self.further)
            if self.missing[row]:
                keys += [*self.texts, *self.numbers]
            if self.missing[row] or self.lost[row]:
                keys += self.elementary
            self._solve(row, keys, is_open=bool(opened[row]))

    def _solve(self, row: int, keys: Sequence[str], *, is_open: bool) -> None:
        """Fill some keys of one top by `solve`, unless it has an error."""
        columns = self.columns
        if columns["error"][row] is not None:
            return
        try:
            motion = solve(self.tops.one(row))
            record, beyond = record_in_range(motion, radians=self.radians, keys=keys)
        except LagtopError as error:
            columns["error"][row] = str(error)
            return
        if beyond:
            columns["error"][row] = "; ".join(map(str, beyond))
        if is_open:
            record |= {key: getattr(motion.top, key) for key in {"r0", "psidot0"} & {*self.inputs}}
        if record.get("remark"):
            record["remark"] = _words(record["remark"])
        for key, value in record.items():
            if value is not None:
                columns[key][row] = value


def _remarks(regime: Regime, tops: TopArrays, start: Start) -> Any:
    """Return the remarks on tops released from rest: the words of `solve`, without its numbers."""
    words: list[str | None]
    if regime == Regime.HANGING:
        return _remark_on(theta0_deg=180)
    if regime == Regime.SLEEPING:
        words = [_remark_on(theta0_deg=0, r0=1.0), _remark_on(theta0_deg=0, r0=1e3)]
        return np.array(words, dtype=object)[(start.sleep >= 0).astype(np.intp)]
    if regime == Regime.REGULAR:
        words = [None, _remark_on(r0=1e3)]
        return np.array(words, dtype=object)[tops.fast().astype(np.intp)]
    return None


@cache
def _remark_on(**start: float) -> str:
    """Return the words of the remark on the worked example with another start."""
    return _words(solve(Top(**start)).record()["remark"])


def _words(remark: str) -> str:
    """Return a remark without the numbers that follow its words."""
    return remark.partition(":")[0]
