"""Uncertainties of first order for each top of a sweep, as columns beside those of the record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.top import Top
from ..motion.sensitivity.uncertainty import FirstOrder, stds_of
from .records import TEXTS
from .results import Column
from .top_arrays import TopArrays


def std_keys(keys: Sequence[str]) -> list[str]:
    """Return the names of the uncertainties of those keys that are numbers."""
    return [f"{key}_std" for key in keys if key not in TEXTS]


def std_columns(
    columns: Mapping[str, Column],
    tops: TopArrays,
    given: Mapping[str, Array | float],
    stds: dict[str, float],
) -> dict[str, Array]:
    """Return `KEY_std` for each number of some records, NaN where there is none.

    `given` has the inputs as they were given, NaN where a top has none.
    """
    names = std_keys(list(columns))
    found = {name: np.full(len(columns["error"]), np.nan) for name in names}
    for i, error in enumerate(columns["error"]):
        if error:
            continue
        present = [name for name, x in given.items() if not np.isnan(_of_row(x, i))]
        try:
            uncertain = FirstOrder(Top(**tops.one(i)), stds, present)
        except LagtopError:
            continue
        record = {key: columns[key][i] for key in columns if f"{key}_std" in found}
        for name, std in stds_of(record, uncertain).items():
            if std is not None:
                found[name][i] = std
    return found


def _of_row(values: Array | float, row: int) -> float:
    return float(values[row] if isinstance(values, np.ndarray) and values.ndim else values)
