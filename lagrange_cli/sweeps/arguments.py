"""Inputs of many tops as arrays, from numbers, arrays, and objects of other libraries."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np

from ..arithmetic.arrays import doubles_of
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.given import gather
from ..inputs.input_keys import EXAMPLE, overridden, warn_of
from ..inputs.names import check_names
from ..inputs.top import INPUTS
from ..inputs.value import steady_refused
from .results import ResultColumn, Results, std_columns
from .top_arrays import TopArrays, top_arrays


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
        read = gather(unlabelled)
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
