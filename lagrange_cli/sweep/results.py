"""Many tops: inputs from objects of other libraries as arrays, and results for these libraries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.arrays import doubles_of
from ..arithmetic.types import Array
from ..errors import LagtopError, UnavailableError
from ..inputs.given import gather
from ..inputs.input_keys import EXAMPLE, overridden, warn_of
from ..inputs.names import check_names
from ..inputs.top import INPUTS, Top
from ..inputs.units import System
from ..inputs.value import Stds, steady_refused, values_of
from ..motion.notebook import html_table
from ..motion.record import TEXT_KEYS, shown_keys
from .top_arrays import TopArrays, top_arrays

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
    from ..motion.solve import solve  # for start-up
    from ..motion.uncertainty import FirstOrder, stds_of

    names = std_keys(list(columns))
    size = len(columns["error"])
    found = {name: np.full(size, np.nan) for name in names}
    rows = {name: np.broadcast_to(x, size) for name, x in given.items()}
    for i, error in enumerate(columns["error"]):
        if error:
            continue
        present = [name for name, x in rows.items() if not np.isnan(x[i])]
        try:
            uncertain = FirstOrder(solve(Top(**tops.one(i))), stds, present)
        except LagtopError:
            continue
        record = {key: columns[key][i] for key in columns if f"{key}_std" in found}
        for name, std in stds_of(record, uncertain).items():
            if std is not None:
                found[name][i] = std
    return found


class Together:
    """Inputs of `Top`, numbers or arrays, broadcast to one shape, from which blocks are taken.

    Inputs may be arrays, pandas Series, xarray DataArrays, and objects of pint and uncertainties.
    Labelled arrays (xarray) are broadcast by the names of their dimensions.  Inputs with units
    (pint) are converted to SI.
    """

    def __init__(self, inputs: Mapping[str, Any]) -> None:
        """Raise LagtopError for an unknown input, and for inputs that do not fit together."""
        check_names("inputs", list(inputs) or ["m"], INPUTS)
        if word := getattr(inputs.get("psidot0"), "word", None):
            raise LagtopError(f"psidot0 {steady_refused(word)}", "psidot0")
        unlabelled, self._labels = _aligned(inputs)
        read = gather(values_of(unlabelled))
        if read.missing:
            warn_of(read.missing, stacklevel=4)
        self.stds, self._system = read.stds, read.system
        self._given = {name: doubles_of(name, x) for name, x in read.inputs.items()}
        given = overridden(EXAMPLE | dict(read.body), self._given)
        try:
            arrays = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in given.values()))
        except ValueError:
            shapes = ", ".join(f"{name} {x.shape}" for name, x in self._given.items() if x.ndim)
            raise LagtopError(f"inputs must broadcast together, got the shapes {shapes}") from None
        self.shape, self.size = arrays[0].shape, arrays[0].size
        flat: list[Any] = [x if x.ndim == 1 else x.flat for x in arrays]
        self._flat = dict(zip(given, flat, strict=True))

    def part(self, rows: slice) -> TopArrays:
        """Return some of the tops; only these rows are copied."""
        count = len(range(*rows.indices(self.size)))
        return top_arrays({name: x[rows] for name, x in self._flat.items()}, count)

    def results(self, columns: Mapping[str, ResultColumn], t: Array | None = None) -> Results:
        """Return columns as results, with the inputs that vary and the times as dimensions."""
        dimensions, coordinates = dimensions_of(self._given, self._labels, self.shape)
        if t is not None and t.ndim:
            dimensions += ("t" if t.ndim == 1 else "sample",)
            coordinates["t"] = t if t.ndim > 1 else t.reshape((1,) * len(self.shape) + t.shape)
        return Results(columns, coordinates, dimensions, self._system)

    def stds_of(self, columns: Mapping[str, ResultColumn]) -> dict[str, Array]:
        """Return `KEY_std` for each number of the records."""
        given = {
            name: np.broadcast_to(x, self.shape).reshape(-1) for name, x in self._given.items()
        }
        return std_columns(columns, self.part(slice(None)), given, self.stds)


def _aligned(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return labelled arrays with common axes, and the labels, or None, of each dimension.

    Raises LagtopError for an unlabelled array beside labelled ones, and for different labels.
    """
    labelled = {name: x for name, x in inputs.items() if hasattr(x, "dims") and hasattr(x, "data")}
    if not labelled:
        return dict(inputs), {}
    import xarray  # it is loaded, or there were no such arrays

    for name, x in inputs.items():
        if name not in labelled and np.ndim(getattr(x, "magnitude", x)):
            raise LagtopError(f"{name} must be a number or have named dimensions as others", name)
    for (first, x), (name, y) in combinations(labelled.items(), 2):
        try:
            xarray.align(x, y, join="exact", copy=False)
        except ValueError:
            shared = ", ".join(str(axis) for axis in x.dims if axis in y.dims)
            why = f"must have the labels of {first} along {shared} (see xarray.align)"
            raise LagtopError(f"{name} {why}", name) from None
    labels = {axis: None for x in labelled.values() for axis in x.dims}
    for x in labelled.values():
        labels |= {axis: x.indexes[axis].to_numpy() for axis in x.dims if axis in x.indexes}
    missing = {
        name: [axis for axis in labels if axis not in x.dims] for name, x in labelled.items()
    }
    arrays = {
        name: x.expand_dims(missing[name]).transpose(*labels).data for name, x in labelled.items()
    }
    return {**inputs, **arrays}, labels


def dimensions_of(
    arrays: Mapping[str, Array], labels: Mapping[Any, Any], shape: tuple[int, ...]
) -> tuple[tuple[str, ...], dict[str, Any]]:
    """Return a name for each dimension, and the labels and inputs that vary with all dimensions.

    If only one input varies along a dimension, the dimension has the name of that input.
    """
    full = {name: x.reshape((1,) * (len(shape) - x.ndim) + x.shape) for name, x in arrays.items()}
    varying = {name: x for name, x in full.items() if x.size > 1}
    if labels:
        along = {
            str(name): np.expand_dims(x, [i for i in range(len(shape)) if i != axis])
            for axis, (name, x) in enumerate(labels.items())
            if x is not None and x.size > 1
        }
        return tuple(map(str, labels)), along | varying
    found = []
    for axis, size in enumerate(shape):
        alone = [name for name, x in varying.items() if x.size == x.shape[axis] == size]
        default = "top" if len(shape) == 1 else f"top_{axis}"
        found.append(alone[0] if len(alone) == 1 else default)
    return tuple(found), varying
