"""Many tops at once: the records of `solve`, a column for each key.

Tops released from rest go through the formulas of `motion` as arrays of doubles, others as arrays
of pairs of doubles.  A top whose sizes are unusual (beyond 1e+-30), or whose digits a cancellation
uses up, goes through `solve` by itself, and so does every top where a key on request is asked for;
an invalid one gets an `error` and no numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.types import Array, Mask
from ..errors import LagtopError
from ..inputs.input_keys import from_example, one_of_each, overridden, warn_of
from ..inputs.names import check_names
from ..inputs.top import INPUTS, Top
from ..motion import record as motion_record
from ..motion.kinds import fast_remark, kind_of, vertical_remark
from ..motion.numbers import gaps_of
from ..motion.regime import FAST, Facts, Regime
from ..motion.solve import record_in_range, solve
from .arguments import dimensions_of, read_arguments
from .measured_arrays import top_arrays
from .results import Column, Results
from .start_arrays import StartArrays
from .top_arrays import TopArrays

TEXTS = frozenset({*motion_record.TEXT_KEYS, "error"})
"""The columns of texts."""
BLOCK_ROWS = 1 << 12
"""Tops that are computed together: their arrays stay in the cache."""
_SHARE, _LEAST_ROWS = 80, 512
"""A top takes 800 bytes while it is computed: such a share of the tops times keys of a sweep takes
1.25 times its result."""


def record_keys(*, radians: bool = False) -> list[str]:
    """Return the keys of a record, and `error`."""
    return [*motion_record.record_keys(radians=radians), "error"]


def sweep(
    *, keys: Sequence[str] | None = None, radians: bool = False, **inputs: ArrayLike
) -> Results:
    """Return the records of many tops: arrays by key, in the shape of the inputs together.

    Inputs are those of `Top`: numbers, arrays, pandas Series, xarray DataArrays (broadcast by the
    names of their dimensions), pint quantities (converted to SI) or, for single numbers, ufloats,
    which add `KEY_std`.  A number that a regime does not have is NaN, a text None; `error` says
    what is wrong with a top, which has neither, or with a number beyond the range of doubles, which
    alone is NaN.  Only `keys` are computed.
    Raises LagtopError for an unknown input or key, or for shapes that do not go together.
    """
    chosen = check_keys(record_keys(radians=radians) if keys is None else keys, radians=radians)
    together = Together(inputs)
    size = together.size
    found = empty_columns(
        {**dict.fromkeys(chosen), "error": None} if together.stds else chosen, size
    )
    step = min(max(size * len(chosen) // _SHARE, _LEAST_ROWS), BLOCK_ROWS)
    for first in range(0, max(size, 1), step):
        rows = slice(first, first + step)
        records(
            together.part(rows),
            list(found),
            radians=radians,
            columns={key: x[rows] for key, x in found.items()},
        )
    stds = together.stds_of(found) if together.stds else {}
    columns = {key: found[key] for key in chosen} | stds
    return together.results({key: x.reshape(together.shape) for key, x in columns.items()})


class Together:
    """Inputs of `Top`, numbers or arrays, as arrays of one shape, from which blocks are taken."""

    def __init__(self, inputs: Mapping[str, ArrayLike]) -> None:
        """Raise LagtopError for an unknown input, or for shapes that do not go together."""
        if unknown := set(inputs) - set(INPUTS):
            raise LagtopError(f"inputs must be among {' '.join(INPUTS)}, got {min(unknown)}")
        one_of_each(name for name in inputs if not name.startswith("theta0_"))
        if missing := from_example(inputs):
            warn_of(missing, stacklevel=4)
        read = read_arguments(inputs)
        self.stds, self._given, self._system = read.stds, read.arrays, read.system
        example = Top().inputs() | (read.system.worked_example() if read.system else {})
        given = overridden(example, read.arrays)
        try:
            arrays = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in given.values()))
        except ValueError:
            shapes = ", ".join(f"{name} {x.shape}" for name, x in read.arrays.items() if x.ndim)
            raise LagtopError(f"inputs must broadcast together, got the shapes {shapes}") from None
        self.shape, self.size = arrays[0].shape, arrays[0].size
        self._names = read.dimensions
        flat: list[Any] = [x if x.ndim == 1 else x.flat for x in arrays]
        self._flat = dict(zip(given, flat, strict=True))

    def part(self, rows: slice) -> TopArrays:
        """Return some of the tops; nothing but these rows is copied."""
        count = len(range(*rows.indices(self.size)))
        return top_arrays({name: x[rows] for name, x in self._flat.items()}, count)

    def results(self, columns: Mapping[str, Column], t: Array | None = None) -> Results:
        """Return columns with the inputs that vary, and with the times of a last dimension."""
        dimensions, coordinates = dimensions_of(self._given, self._names, self.shape)
        if t is not None and t.ndim:
            dimensions += ("t" if t.ndim == 1 else "sample",)
            coordinates["t"] = t if t.ndim > 1 else t.reshape((1,) * len(self.shape) + t.shape)
        return Results(columns, coordinates, dimensions, self._system)

    def stds_of(self, columns: Mapping[str, Column]) -> dict[str, Array]:
        """Return `KEY_std` for each number of the records."""
        from .uncertain_rows import std_columns

        given = {
            name: np.broadcast_to(x, self.shape).reshape(-1) for name, x in self._given.items()
        }
        return std_columns(columns, self.part(slice(None)), given, self.stds)


def empty_columns(keys: Iterable[str], count: int) -> dict[str, Column]:
    """Return columns for so many tops, to be filled."""
    return {key: np.empty(count, dtype=object if key in TEXTS else np.float64) for key in keys}


def check_keys(keys: Sequence[str], *, radians: bool = False) -> Sequence[str]:
    """Return the keys.  Raises LagtopError for one that no motion has, or that comes twice."""
    known = record_keys(radians=radians)
    if isinstance(keys, Sequence) and not set(keys) <= set(known):
        known = [*motion_record.all_keys(radians=radians), "error"]
    return check_names("keys", keys, known)


def records(
    tops: TopArrays,
    keys: Sequence[str],
    *,
    radians: bool = False,
    errors: Mapping[int, str] | None = None,
    columns: dict[str, Column] | None = None,
) -> dict[str, Column]:
    """Return the columns of a block of tops; rows that have an error already stay empty.

    They are new, or those of `empty_columns` that are given.  Nothing depends on the
    `numpy.errstate` of the caller.
    """
    with ARRAYS.working():
        columns = empty_columns(keys, tops.m.size) if columns is None else columns
        block = _Block(tops, columns, radians)
        left = np.ones(tops.m.shape, dtype=np.bool_)
        for row, error in (errors or {}).items():
            left[row], block.columns["error"][row] = False, error
        for regime, found in tops.regimes().items():
            if (rows := found & left).any():
                block.fill(rows, regime)
                left &= ~rows
        left = block.fill_moving(left)
        alone = np.flatnonzero(left).tolist()
        for row in range(tops.m.size) if block.requested else alone:
            keys_left = [*block.texts, *block.numbers] if left[row] else []
            block.solve(row, [*keys_left, *block.requested])
        return columns


class _Block:
    """The columns of a block of tops, while they are being filled."""

    def __init__(self, tops: TopArrays, columns: Mapping[str, Column], radians: bool) -> None:
        self.tops, self.radians = tops, radians
        self.columns = {"error": np.empty(tops.m.size, dtype=object), **columns}
        tilt = {f"theta0_{'rad' if radians else 'deg'}": tops.tilt_in(radians)}
        given = tops._asdict() | tilt
        known = motion_record.record_keys(radians=radians)
        others = {*given, *TEXTS}
        self.texts = [key for key in columns if key in motion_record.TEXT_KEYS]
        self.numbers = [key for key in columns if key in known and key not in others]
        self.requested = [key for key in columns if key not in known and key not in others]
        for key, column in self.columns.items():
            column[:] = given.get(key, np.nan if column.dtype == np.float64 else None)

    def fill(self, rows: Mask, regime: Regime) -> None:
        """Fill the rows of one regime, all released from rest, by the formulas over doubles."""
        chosen = slice(None) if rows.all() else rows
        tops = self.tops.part(chosen)
        facts, state = _facts(regime, tops.r0), tops.state()
        gaps = gaps_of(ARRAYS, facts, state)
        motion = kind_of(facts)(ARRAYS, facts, state, gaps)
        for key in self.numbers:
            if key.startswith("theta_min"):  # the start
                self.columns[key][chosen] = tops.tilt_in(self.radians)
                continue
            name = key.replace("_rad", "_deg")
            value = None if name in motion.lacks else getattr(motion, name)
            if value is not None:
                self.columns[key][chosen] = np.radians(value) if key != name else value
        remarks: Sequence[str | None] | None = None
        if regime in {Regime.SLEEPING, Regime.HANGING}:
            remarks = [vertical_remark(regime, stable) for stable in state.sleep >= 0]
        elif regime is Regime.REGULAR and "remark" in self.texts:
            remarks = self._fast_remarks(tops, motion)
        path = "cusped" if regime is Regime.REGULAR else None
        for key, texts in (("regime", regime.value), ("path", path), ("remark", remarks)):
            if key in self.texts:
                self.columns[key][chosen] = texts

    def _fast_remarks(self, tops: TopArrays, motion: Any) -> list[str | None]:
        """Return what `solve` says of each pseudo-regular precession among tops."""
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

    def fill_moving(self, left: Mask) -> Mask:
        """Fill rows that start with other rates as far as they can be trusted; return the rest."""
        if not left.any() or not (moving := left & self.tops.moving()).any():
            return left
        chosen: Any = slice(None) if moving.all() else np.flatnonzero(moving)
        tops = self.tops.part(chosen)
        motions = StartArrays(tops)
        trusted = motions.trusted(self.numbers)
        if not trusted.all():
            moving[moving] = trusted
            chosen = moving
        fine = slice(None) if trusted.all() else trusted
        if "regime" in self.texts:
            regimes = np.array([Regime.REGULAR.value, Regime.NO_SPIN.value], dtype=object)
            self.columns["regime"][chosen] = regimes[(tops.r0[fine] == 0).astype(np.intp)]
        if "path" in self.texts:
            self.columns["path"][chosen] = motions.paths()[fine]
        for key in self.numbers:
            value = motions.number(key.replace("_rad", "_deg"))
            if value is not None:
                value = np.radians(value) if key.endswith("_rad") else value
                self.columns[key][chosen] = value[fine]
        return left & ~moving

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


def _facts(regime: Regime, r0: Array) -> Facts:
    """Return what the regime of tops released from rest says of all of them."""
    stays = regime not in {Regime.REGULAR, Regime.NO_SPIN}
    pole = {Regime.SLEEPING: 1, Regime.HANGING: -1}.get(regime, 0)
    plane = regime is Regime.NO_SPIN
    sign = np.where(r0 < 0, -1, 1)
    return Facts(
        regime=regime,
        at_rest=True,
        steady=stays,
        free=regime is Regime.TORQUE_FREE,
        spins=regime is Regime.REGULAR,
        pole=pole,
        upper_root=3 if plane else 0,
        over_bottom=plane,
        cusp=regime is Regime.REGULAR,
        sign_plus=sign,
        sign_minus=1 if plane else -sign,
    )
