"""Inputs of many tops as arrays, from numbers, arrays, and objects of other libraries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import doubles_of
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.input_keys import from_example, one_of_each, overridden, warn_of
from ..inputs.top import INPUTS, Top
from ..inputs.units import DIMENSIONS, System, factor_of, system_of
from ..inputs.value import Value
from .results import ResultColumn, Results, std_columns
from .top_arrays import TopArrays, top_arrays

_TILTS = {"theta0_deg": "degree", "theta0_rad": "radian"}


class Together:
    """Inputs of `Top`, numbers or arrays, broadcast to one shape, from which blocks are taken."""

    def __init__(self, inputs: Mapping[str, ArrayLike]) -> None:
        """Raise LagtopError for an unknown input, or if shapes do not broadcast together."""
        if unknown := set(inputs) - set(INPUTS):
            raise LagtopError(f"inputs must be among {' '.join(INPUTS)}, got {min(unknown)}")
        one_of_each(name for name in inputs if not name.startswith("theta0_"))
        if missing := from_example(inputs):
            warn_of(missing, stacklevel=4)
        if word := getattr(inputs.get("psidot0"), "word", None):
            raise LagtopError(f"psidot0 must be a number for many tops, got {word}", "psidot0")
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
        """Return some of the tops; only these rows are copied."""
        count = len(range(*rows.indices(self.size)))
        return top_arrays({name: x[rows] for name, x in self._flat.items()}, count)

    def results(self, columns: Mapping[str, ResultColumn], t: Array | None = None) -> Results:
        """Return columns as results, with the inputs that vary and the times as dimensions."""
        dimensions, coordinates = dimensions_of(self._given, self._names, self.shape)
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


class Arguments(NamedTuple):
    """Inputs of many tops as doubles."""

    arrays: dict[str, Array]
    stds: dict[str, float]
    """Standard uncertainties of the inputs that have one."""
    system: System | None
    """The system of units that inputs with units are converted to."""
    dimensions: tuple[str, ...]
    """Names of dimensions; empty if no input names any."""


def read_arguments(inputs: Mapping[str, Any]) -> Arguments:
    """Return inputs as doubles, from arrays, pandas Series, xarray, pint and uncertainties objects.

    Labelled arrays (xarray) are broadcast by the names of their dimensions.  Quantities (pint) are
    converted to SI.  Raises LagtopError for an input of another kind, and for an input without a
    unit if others have one.
    """
    inputs, dimensions = _aligned(inputs)
    inputs, stds = _nominal(inputs)
    inputs, stds, system = _in_one_system(inputs, stds)
    arrays = {name: doubles_of(name, x) for name, x in inputs.items()}
    return Arguments(arrays, stds, system, dimensions)


def _aligned(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return labelled arrays broadcast against each other, and the names of their dimensions."""
    labelled = {name: x for name, x in inputs.items() if hasattr(x, "dims") and hasattr(x, "data")}
    if not labelled:
        return dict(inputs), ()
    import xarray  # it is loaded, or there were no such arrays

    for name, x in inputs.items():
        if name not in labelled and np.ndim(x):
            raise LagtopError(f"{name} must be a number or have named dimensions as others", name)
    together = dict(zip(labelled, xarray.broadcast(*labelled.values()), strict=True))
    some = next(iter(together.values()))
    return {**inputs, **{name: x.data for name, x in together.items()}}, tuple(map(str, some.dims))


def _nominal(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, float]]:
    """Return the nominal values of numbers, and their standard uncertainties."""
    uncertain = {name: x for name, x in inputs.items() if hasattr(x, "nominal_value")}
    stds = {name: float(x.std_dev) for name, x in uncertain.items()}
    return {**inputs, **{name: x.nominal_value for name, x in uncertain.items()}}, stds


def _in_one_system(
    inputs: Mapping[str, Any], stds: Mapping[str, float]
) -> tuple[dict[str, Any], dict[str, float], System | None]:
    """Return inputs and uncertainties in SI units if any input is a quantity of pint."""
    united = {name: x for name, x in inputs.items() if hasattr(x, "magnitude")}
    if not united:
        return dict(inputs), dict(stds), None
    found, spread = dict(inputs), dict(stds)
    values = {
        name: Value(Fraction(1), f"{x.units:C}" if name in united else "")
        for name, x in inputs.items()
        if name not in _TILTS and (name in united or np.any(x))
    }
    system = system_of(values, None)
    for name, x in united.items():
        if name in _TILTS:
            found[name] = x.m_as(_TILTS[name])
            continue
        assert system is not None
        factor = factor_of(name, values[name]) / system.factor(DIMENSIONS[name])
        found[name] = _scaled(x.magnitude, factor)
        if hasattr(x.magnitude, "nominal_value"):
            spread[name] = float(x.magnitude.std_dev) * float(abs(factor))
    return found, spread, system


def _scaled(magnitude: Any, factor: Fraction) -> ArrayLike:
    """Return numbers in another unit; a single number is rounded once."""
    magnitude = getattr(magnitude, "nominal_value", magnitude)
    if isinstance(magnitude, int | float):
        return float(Fraction(magnitude) * factor)
    return np.asarray(magnitude) * float(factor)


def dimensions_of(
    arrays: Mapping[str, Array], names: Sequence[str], shape: tuple[int, ...]
) -> tuple[tuple[str, ...], dict[str, Array]]:
    """Return a name for each dimension, and the inputs that vary with all dimensions.

    If only one input varies along a dimension, the dimension has the name of that input.
    """
    full = {name: x.reshape((1,) * (len(shape) - x.ndim) + x.shape) for name, x in arrays.items()}
    varying = {name: x for name, x in full.items() if x.size > 1}
    if names:
        return tuple(names), {name: _without_repeats(x) for name, x in varying.items()}
    found = []
    for axis, size in enumerate(shape):
        alone = [name for name, x in varying.items() if x.size == x.shape[axis] == size]
        default = "top" if len(shape) == 1 else f"top_{axis}"
        found.append(alone[0] if len(alone) == 1 else default)
    return tuple(found), varying


def _without_repeats(values: Array) -> Array:
    """Return an array with dimensions of size 1 where a broadcast repeats its elements."""
    for axis, stride in enumerate(values.strides):
        if not stride:
            values = values.take([0], axis)
    return values
