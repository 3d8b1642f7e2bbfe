"""Many tops: inputs as arrays of one shape, and results for pandas and xarray."""

from __future__ import annotations

import math
from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.arrays import doubles_of
from ..arithmetic.types import Array
from ..errors import LagtopError, UnavailableError
from ..names import check_names
from ..top.given import gather
from ..top.inputs import EXAMPLE, INPUTS, STEADY_WORDS, overridden, warn_of
from ..top.values import values_of

ResultColumn = Array | NDArray[np.object_]
"""A column: numbers (NaN if a regime has none) or texts (None if there is none)."""
_SHOWN = 2
"""Number of first and of last tops that are printed."""


class Results(dict[str, ResultColumn]):
    """Arrays by key, in the shape to which the inputs broadcast.

    >>> found = sweep(r0=[50.0, 60.0], keys=["T_nutation", "regime"])
    >>> found["T_nutation"].shape, list(found.inputs)
    ((2,), ['r0'])
    >>> found.to_pandas().columns.tolist(), dict(found.to_xarray().sizes)
    (['r0', 'T_nutation', 'regime'], {'r0': 2})
    """

    def __init__(
        self,
        columns: Mapping[str, ResultColumn],
        inputs: Mapping[str, Array],
        shape: Any,
        index: Any = None,
    ) -> None:
        """Take columns of one shape, and the inputs that vary, as arrays that broadcast to it.

        `index` is the index of the pandas Series among the inputs.
        """
        super().__init__(columns)
        self.inputs, self.shape, self._index = dict(inputs), tuple(shape), index

    def __repr__(self) -> str:
        """Return the shape and, in a line for each column, its first and last values."""
        size = math.prod(self.shape)
        some = np.r_[:_SHOWN, size - _SHOWN : size] if size > 2 * _SHOWN else np.arange(size)
        lines = [f"{size} tops, shape {self.shape}"]
        for name, x in (self.inputs | self).items():
            values = np.broadcast_to(x, self.shape).flat[some].tolist()
            cells = [f"{x:.5g}" if isinstance(x, float) else str(x) for x in values]
            if size > len(cells):
                cells.insert(_SHOWN, "...")
            lines.append(" ".join([f"{name:20}", *(f"{x:>11.11}" for x in cells)]))
        return "\n".join(lines)

    def to_pandas(self) -> Any:
        """Return a pandas DataFrame with a row for each top; inputs that vary come first.

        It has the index of the Series that were passed as inputs, if they are all of one length.
        Raises UnavailableError if pandas is not installed.
        """
        columns = self.inputs | self
        return _library("pandas").DataFrame(
            {name: np.broadcast_to(x, self.shape).reshape(-1) for name, x in columns.items()},
            index=self._index,
        )

    def to_xarray(self) -> Any:
        """Return an xarray Dataset whose dimensions are named after the inputs of a grid.

        A dimension along which several inputs vary, or none, is `top`, or `top_0`, `top_1` ...
        Raises UnavailableError if xarray is not installed.
        """
        full = {
            name: x.reshape((1,) * (len(self.shape) - x.ndim) + x.shape)
            for name, x in self.inputs.items()
        }
        names = []
        for axis, size in enumerate(self.shape):
            alone = [name for name, x in full.items() if x.size == x.shape[axis] == size]
            other = "top" if len(self.shape) == 1 else f"top_{axis}"
            names.append(alone[0] if len(alone) == 1 else other)
        coordinates = {
            name: ([names[i] for i, size in enumerate(x.shape) if size > 1], x.squeeze())
            for name, x in full.items()
        }
        variables = {name: (names, x) for name, x in self.items() if name not in coordinates}
        return _library("xarray").Dataset(variables, coordinates)


def _library(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise UnavailableError(f"{name} is not installed: pip install {name}") from None


def read_inputs(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], Results, bool]:
    """Return inputs of `Top` as flat arrays of one size, and results that have no columns yet.

    The last value is whether the tops must be bodies.  Arrays broadcast without a copy, and a word
    for psidot0 stays one.  Raises LagtopError for an unknown input, and for inputs that do not fit
    together.
    """
    check_names("inputs", list(inputs) or ["m"], INPUTS)
    for name, x in inputs.items():
        if getattr(x, "dims", ()):
            raise LagtopError(f"{name} has named dimensions: pass {name}.to_numpy()", name)
    rate = inputs.get("psidot0")
    words = {"psidot0": rate} if isinstance(rate, str) and rate in STEADY_WORDS else {}
    read = gather(values_of({x: y for x, y in inputs.items() if x not in words}))
    for name in read.stds:
        why = "is uncertain: a sweep does not propagate uncertainties; loop over solve"
        raise LagtopError(f"{name} {why}", name)
    if read.missing:
        warn_of(read.missing, stacklevel=4)
    own = {name: doubles_of(name, x) for name, x in read.inputs.items()}
    given = overridden(EXAMPLE | dict(read.body), own)
    try:
        arrays = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in given.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {x.shape}" for name, x in own.items() if x.ndim)
        raise LagtopError(f"inputs must broadcast together, got the shapes {shapes}") from None
    flat = (x if x.ndim == 1 else x.flat for x in arrays)
    shape, varying = arrays[0].shape, {name: x for name, x in own.items() if x.size > 1}
    results = Results({}, varying, shape, _index_of(inputs, shape))
    return dict(zip(given, flat, strict=True)) | words, results, read.is_body


def _index_of(inputs: Mapping[str, Any], shape: tuple[int, ...]) -> Any:
    """Return the index of the pandas Series among inputs, or None.

    Raises LagtopError if their indices differ: rows would be paired by position.
    """
    series = {name: x for name, x in inputs.items() if hasattr(x, "index") and hasattr(x, "iloc")}
    first = next(iter(series), "")
    for name, x in series.items():
        if not x.index.equals(series[first].index):
            why = f"{first} and {name} are Series with different indices"
            raise LagtopError(f"{why}: align them, or pass {name}.to_numpy()", name)
    return series[first].index if series and shape == series[first].shape else None
