"""Many tops at once: the records of `solve`, a column for each key.

Tops released from rest go through the formulas of `released` as arrays of doubles, others through
those of `general_record`.  What is not usual (a size beyond 1e+-30, lambda within 2^-44 of 1, roots
of a general start that nearly meet) goes through `solve`, one by one, and a top that cannot be gets
an error in place of its numbers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.types import Array, Mask
from ..errors import LagtopError
from ..inputs.names import check_names
from ..inputs.top import Top
from ..motion.record import NUMBER_KEYS
from ..motion.released import STILL, Nutation, remark, unmoved
from ..motion.solve import solve
from .start_arrays import starts
from .top_arrays import Tops

Column = Array | NDArray[np.object_]
"""Numbers, NaN where a regime has none; or texts, None where there is none."""

BLOCK_ROWS = 1 << 12
"""Tops that are computed together: their arrays stay in the cache."""

_TEXT_KEYS = ("regime", "path", "remark")


def record_keys(*, radians: bool = False) -> list[str]:
    """The keys of a record, and `error`."""
    inputs = list(Top().inputs(radians=radians))
    names = [re.sub("_deg$", "_rad", key) if radians else key for key in NUMBER_KEYS]
    return [*inputs, "regime", *names, "path", "remark", "error"]


def sweep(
    *, keys: Sequence[str] | None = None, radians: bool = False, **inputs: ArrayLike
) -> dict[str, Column]:
    """Records of many tops: arrays by key, in the shape that the inputs have together.

    Inputs are those of `Top`, numbers or arrays.  A number that a regime does not have is NaN, a
    text None; `error` says what is wrong with a top, which has neither.  Only `keys` are computed.
    Raises LagtopError for an unknown input or key, or for shapes that do not go together.
    """
    chosen = check_keys(record_keys(radians=radians) if keys is None else keys, radians=radians)
    if unknown := set(inputs) - set(Tops._fields):
        raise LagtopError(f"inputs must be among {' '.join(Tops._fields)}, got {min(unknown)}")
    given = Top().inputs() | {"theta0_rad": np.nan}
    if "theta0_rad" in inputs and "theta0_deg" not in inputs:
        given["theta0_deg"] = np.nan
    doubles = [_doubles(name, (given | inputs)[name]) for name in Tops._fields]
    try:
        arrays = np.broadcast_arrays(*doubles)
    except ValueError as error:
        raise LagtopError(f"the inputs do not go together: {error}") from None
    shape = arrays[0].shape
    tops = Tops(*(x.ravel() for x in arrays))
    blocks = [
        records(tops.part(slice(first, first + BLOCK_ROWS)), chosen, radians=radians)
        for first in range(0, max(tops.m.size, 1), BLOCK_ROWS)
    ]
    return {key: np.concatenate([b[key] for b in blocks]).reshape(shape) for key in chosen}


def _doubles(name: str, values: ArrayLike) -> Array:
    """Return real numbers as an array of doubles.  Raises LagtopError for anything else."""
    if np.ma.isMaskedArray(values) and np.ma.getmaskarray(values).any():
        raise LagtopError(f"{name} must not be masked: fill it or leave the elements out", name)
    try:
        array = np.asarray(values)
        if array.size and array.dtype.kind not in "iufO":
            raise TypeError
        return array.astype(np.float64)
    except (TypeError, ValueError, OverflowError):
        shown = repr(values)[:60]
        raise LagtopError(f"{name} must be real numbers, got {shown}", name) from None


def check_keys(keys: Sequence[str], *, radians: bool = False) -> Sequence[str]:
    """The keys.  Raises LagtopError for one that no record has, or that comes twice."""
    return check_names("keys", keys, record_keys(radians=radians))


def records(
    tops: Tops,
    keys: Sequence[str],
    *,
    radians: bool = False,
    errors: Mapping[int, str] | None = None,
) -> dict[str, Column]:
    """The columns of a block of tops; rows that have an error already are left empty."""
    block = _Block(tops, keys, radians)
    left = np.ones(tops.m.shape, dtype=np.bool_)
    for row, error in (errors or {}).items():
        left[row], block.columns["error"][row] = False, error
    for regime, found in tops.regimes().items():
        if (rows := found & left).any():
            block.fill(rows, regime)
            left &= ~rows
    left = block.fill_moving(left)
    for row in np.flatnonzero(left).tolist():
        block.solve(row)
    return {key: block.columns[key] for key in keys}


class _Block:
    """The columns of a block of tops, while they are being filled."""

    def __init__(self, tops: Tops, keys: Sequence[str], radians: bool) -> None:
        self.tops, self.radians = tops, radians
        tilt = {f"theta0_{'rad' if radians else 'deg'}": tops.tilt_in(radians)}
        given = tops._asdict() | tilt
        self.columns: dict[str, Column] = {"error": np.full(tops.m.size, None)}
        self.texts = [key for key in keys if key in _TEXT_KEYS]
        self.numbers = [
            key for key in keys if key not in given and key not in (*_TEXT_KEYS, "error")
        ]
        self.columns |= {key: x for key, x in given.items() if key in keys}
        self.columns |= {key: np.full(tops.m.size, None) for key in self.texts}
        self.columns |= {key: np.full(tops.m.size, np.nan) for key in self.numbers}

    def fill(self, rows: Mask, regime: Regime) -> None:
        """Rows of one regime, by the formulas of release from rest."""
        chosen = slice(None) if rows.all() else rows
        tops = self.tops.part(chosen)
        inv = tops.invariants()
        value_of: Callable[[str], Any]
        texts: dict[str, Any] = {"regime": regime.value}
        if regime in STILL:
            value_of = unmoved(np, regime, inv, tops.tilt(), tops.r0).get
            texts["remark"] = [remark(regime, stable) for stable in inv.lam_minus_1 >= 0]
        else:
            motion = Nutation(np, inv, tops.tilt(), tops.r0, spins=regime is Regime.REGULAR)
            value_of = partial(getattr, motion)
            texts["path"] = motion.path
        for key in self.texts:
            self.columns[key][chosen] = texts.get(key)
        for key in self.numbers:
            value = value_of(key.replace("_rad", "_deg"))
            if key.startswith("theta_min"):  # it starts there
                value = tops.tilt_in(self.radians)
            elif key.endswith("_rad") and value is not None:
                value = np.radians(value)
            if value is not None:
                self.columns[key][chosen] = value

    def fill_moving(self, left: Mask) -> Mask:
        """Rows that start with other rates, by the formulas of any start; returns what is left."""
        rows = np.flatnonzero(left & self.tops.moving())
        if not rows.size:
            return left
        found = starts(self.tops.part(rows))
        rows, motion = rows[found.clear], found.nutation()
        texts = {
            "regime": np.where(self.tops.r0[rows] == 0, Regime.NO_SPIN.value, Regime.REGULAR.value),
            "path": motion.path,
        }
        for key in self.texts:
            self.columns[key][rows] = texts.get(key)
        for key in self.numbers:
            value = getattr(motion, key.replace("_rad", "_deg"))
            if value is not None:
                self.columns[key][rows] = np.radians(value) if key.endswith("_rad") else value
        still = left.copy()
        still[rows] = False
        return still

    def solve(self, row: int) -> None:
        """One row, by itself."""
        try:
            record = solve(Top(**self.tops.one(row))).record(radians=self.radians)
        except LagtopError as error:
            self.columns["error"][row] = str(error)
            return
        for key in (*self.texts, *self.numbers):
            if record[key] is not None:
                self.columns[key][row] = record[key]
