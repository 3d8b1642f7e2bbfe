"""Results of many tops: arrays by name, for pandas, polars, xarray and notebooks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.types import Array
from ..errors import LagtopError, UnavailableError
from ..inputs.top import Top
from ..inputs.units import System
from ..inputs.value import Stds
from ..motion.notebook import html_table
from ..motion.record import TEXT_KEYS, shown_keys
from .top_arrays import TopArrays

ResultColumn = Array | NDArray[np.object_]
"""A column: numbers (NaN if a regime has none) or texts (None if there is none)."""
TEXTS = frozenset({*TEXT_KEYS, "error"})
"""The columns of texts."""
_ROWS_SHOWN = 20


class Results(dict[str, ResultColumn]):
    """Arrays by name: a dict of columns, with the inputs that vary along each dimension.

    The first dimensions are those of the broadcast inputs; the times of `sweep_angles` are the
    last.

    >>> found = sweep(r0=[50.0, 60.0], keys=["T_nutation", "regime"])
    >>> found.dimensions, found["T_nutation"].shape, list(found.coordinates)
    (('r0',), (2,), ['r0'])
    >>> found.to_pandas().columns.tolist(), found.to_polars().shape, dict(found.to_xarray().sizes)
    (['r0', 'T_nutation', 'regime'], (2, 3), {'r0': 2})
    """

    def __init__(
        self,
        columns: Mapping[str, ResultColumn],
        coordinates: Mapping[str, Array],
        dimensions: Sequence[str],
        system: System | None = None,
    ) -> None:
        """Take columns, and inputs by name with their own shapes, one name per dimension."""
        super().__init__(columns)
        self.coordinates = dict(coordinates)
        self.dimensions = tuple(dimensions)
        self._system = system

    def to_pandas(self) -> Any:
        """Return a pandas DataFrame with a row per top (and time), inputs that vary first.

        Raises UnavailableError if pandas is not installed.
        """
        return _library("pandas").DataFrame(self._rows())

    def to_polars(self) -> Any:
        """Return a polars DataFrame with a row per top (and time), inputs that vary first.

        Raises UnavailableError if polars is not installed.
        """
        texts = {name: x.tolist() if x.dtype == object else x for name, x in self._rows().items()}
        return _library("polars").DataFrame(texts)

    def to_xarray(self) -> Any:
        """Return an xarray Dataset whose dimensions and coordinates are named after the inputs.

        Units are attributes.  Raises UnavailableError if xarray is not installed.
        """
        dimensions, coordinates = self.dimensions, {}
        for name, values in self.coordinates.items():
            axes = [axis for axis, size in enumerate(values.shape) if size > 1]
            shape = [values.shape[axis] for axis in axes]
            names = [dimensions[axis] for axis in axes]
            coordinates[name] = (names, values.reshape(shape), self._attributes(name))
        variables = {
            name: (dimensions[: x.ndim], x, self._attributes(name))
            for name, x in self.items()
            if name not in coordinates
        }
        return _library("xarray").Dataset(variables, coordinates)

    def _rows(self) -> dict[str, NDArray[Any]]:
        """Return all columns with one element per row."""
        shape = max((x.shape for x in self.values()), key=len, default=())
        inputs = {name: x for name, x in self.coordinates.items() if name not in self}
        return {
            name: np.broadcast_to(x.reshape(x.shape + (1,) * (len(shape) - x.ndim)), shape).reshape(
                -1
            )
            for name, x in (inputs | self).items()
        }

    def _attributes(self, name: str) -> dict[str, str]:
        """Return the unit of a column, if it has one."""
        named = self._system.named if self._system else str
        keys = shown_keys(radians=name.endswith("_rad"), named=named, requested=True)
        return {"units": keys[name].unit} if name in keys and keys[name].unit else {}

    def _repr_html_(self) -> str:
        """Return the first rows as a table for a notebook."""
        rows = self._rows()
        count = max((len(x) for x in rows.values()), default=0)
        lines = zip(*(x[:_ROWS_SHOWN].tolist() for x in rows.values()), strict=True)
        more = f" of {count}" if count > _ROWS_SHOWN else ""
        return html_table(f"{min(count, _ROWS_SHOWN)}{more} rows", lines, list(rows))


def _library(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        why = f"{name} is not installed: pip install {name}"
        raise UnavailableError(why) from None


def std_keys(keys: Sequence[str]) -> list[str]:
    """Return the names of the uncertainties of numeric keys."""
    return [f"{key}_std" for key in keys if key not in TEXTS]


def std_columns(
    columns: Mapping[str, ResultColumn],
    tops: TopArrays,
    given: Mapping[str, Array | float],
    stds: Stds,
) -> dict[str, Array]:
    """Return `KEY_std` for each number of some records, NaN if there is none.

    `given` has the inputs as they were passed, NaN if a top has none.
    """
    from ..motion.sensitivity.uncertainty import FirstOrder, stds_of  # for start-up

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
