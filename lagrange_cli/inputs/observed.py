"""The observed motion: the quantities of a trajectory, interpreted by their conventions."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.arrays import doubles_of
from ..arithmetic.text import quoted
from ..arithmetic.types import Array
from ..errors import LagtopError
from . import rotations
from .names import ANGLES
from .trajectory_columns import ELEVATION, NAMELESS, QUANTITIES, FoundQuantity

ORDERS = ("wxyz", "xyzw")
Quantities = Mapping[str, Array]
"""Arrays of shape (n, parts) by the name of the quantity (see `inputs.trajectory_columns`)."""
Named = Mapping[str, FoundQuantity]
"""The quantities of a file, with the conventions and the angle units that their names imply."""


class Conventions(NamedTuple):
    """Conventions of quantities whose names do not imply them."""

    quaternion: str | None = None
    """Order of the parts, `wxyz` or `xyzw`; None to determine it from the first row."""
    euler: str = "xyz"
    """Sequence of axes in SciPy's notation: lower case for space, upper case for the body."""
    rates: str = "body"
    """Frame of the angular velocity, `body` or `space`."""
    radians: bool = False

    def checked(self) -> Conventions:
        """Return the conventions.  Raises LagtopError for an unknown one."""
        axes = r"(?!.*(.)\1)([xyz]{3}|[XYZ]{3})"  # neighbours differ
        for key, pattern, wanted, got in (
            ("quaternion_order", "wxyz|xyzw", "wxyz or xyzw", self.quaternion or ORDERS[0]),
            ("rates_frame", "body|space", "body or space", self.rates),
            ("euler_sequence", axes, "three axes, such as xyz (space) or XYZ (body)", self.euler),
        ):
            if not re.fullmatch(pattern, str(got)):
                raise LagtopError(f"{key} must be {wanted}, got {quoted(got)}", key)
        return self


@dataclass(frozen=True)
class Observed:
    """The motion at some times; quantities that are not given are None."""

    t: Array
    quaternion: Array | None = None
    """From body to space, shape (n, 4)."""
    axis: Array | None = None
    """Figure axis in space, shape (n, 3)."""
    angles: Mapping[str, Array] = field(default_factory=dict)
    """Tilt, spin and precession in radians, if only some of them are given."""
    body_rates: Array | None = None
    space_rates: Array | None = None
    norm: Array | None = None
    """Distance of a quaternion's or an axis's norm from 1, or of a matrix from a rotation."""
    distance: Array | None = None
    """Distance of the mass centre from the pivot."""

    def turned(self, space: Array, body: Array) -> Observed:
        """Return the motion in other frames.

        `space` converts coordinates in space to the new ones, `body` converts body coordinates.
        """
        turns = {"axis": space, "body_rates": body, "space_rates": space}
        vectors = {key: getattr(self, key) for key in turns}
        turned: dict[str, Any] = {
            key: rotations.rotated(turns[key], x) for key, x in vectors.items() if x is not None
        }
        if self.quaternion is not None:
            in_space = rotations.product(space, self.quaternion)
            turned["quaternion"] = rotations.product(in_space, rotations.conjugate(body))
        return replace(self, **turned)


def observe(given: Quantities, conventions: Conventions, named: Named) -> Observed:
    """Return the motion from its quantities; names override the conventions.

    The first quantity that gives all of the attitude, or most of it, is used.  Raises LagtopError
    for rates of the angles without an attitude.
    """
    alone = angles_in(given, conventions, named)
    found: dict[str, Any] = {"t": given["t"][:, 0], "angles": alone}
    if "quaternion" in given:
        order = _convention(named, "quaternion", conventions.quaternion or ORDERS[0])
        found |= _directed("quaternion", given["quaternion"][:, [*map(order.index, "wxyz")]])
    elif "matrix" in given:
        found["quaternion"], found["norm"] = rotations.of_matrix(given["matrix"])
    elif len(alone) == len(ANGLES):
        found["quaternion"] = rotations.of_angles(**alone)
    elif "euler" in given:
        sequence = _convention(named, "euler", conventions.euler)
        angles = _in_radians(given, conventions, named, "euler")
        found["quaternion"] = rotations.of_euler(sequence, angles)
    elif "rotvec" in given:
        found["quaternion"] = rotations.of_vector(given["rotvec"])
    elif "axis" in given:
        found |= _directed("axis", given["axis"])
    elif "position" in given and not alone:
        found["axis"] = rotations.directed(given["position"])
        found["distance"] = np.linalg.norm(given["position"], axis=1)
    if {"quaternion", "axis"} & found.keys():
        found["angles"] = {}
    return Observed(**found | _rates(given, conventions, named, found))


def _rates(
    given: Quantities, conventions: Conventions, named: Named, found: Mapping[str, Any]
) -> dict[str, Array]:
    """Return the angular velocity, in the frame in which it is given."""
    if "rates" in given:
        return {f"{_convention(named, 'rates', conventions.rates)}_rates": given["rates"]}
    if "angle_rates" not in given:
        return {}
    if not ({"quaternion", "axis"} & found.keys() or found["angles"]):
        wanted = "an attitude or a part of it, such as theta, phi and psi"
        raise LagtopError(f"angle_rates must come with {wanted}, got none", "angle_rates")
    if "quaternion" not in found:
        return {}
    at = rotations.angles_of(found["quaternion"])
    rates = rotations.body_rates(at["theta"], at["phi"], *given["angle_rates"].T)
    return {"body_rates": np.stack(rates, axis=1)}


def angles_in(given: Quantities, conventions: Conventions, named: Named) -> dict[str, Array]:
    """Return tilt, spin and precession, in radians, as far as each has its own column."""
    return {x: _in_radians(given, conventions, named, x)[:, 0] for x in ANGLES if x in given}


def _convention(named: Named, key: str, other: str) -> str:
    """Return the convention that the name of a quantity implies, or else `other`."""
    return named.get(key, NAMELESS).says or other


def _in_radians(given: Quantities, conventions: Conventions, named: Named, key: str) -> Array:
    found, angles = named.get(key, NAMELESS), given[key]
    in_radians = conventions.radians if found.unit is None else found.unit == "rad"
    if found.says == ELEVATION:
        angles = (np.pi / 2 if in_radians else 90.0) - angles
    return angles if in_radians else np.radians(angles)


def _directed(key: str, values: Array) -> dict[str, Array]:
    """Return quaternions or axes, and the distances of their norms from 1."""
    return {key: rotations.directed(values), "norm": np.linalg.norm(values, axis=1) - 1.0}


def rows_of(given: Quantities, rows: slice | NDArray[np.intp]) -> dict[str, Array]:
    """Return some of the rows of all quantities."""
    return {key: values[cast(Any, rows)] for key, values in given.items()}


def quantities_of(t: ArrayLike, arrays: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Return times and arrays of quantities, with a row for each time; a masked element is NaN.

    Raises LagtopError for an array of another shape.
    """
    block = {"t": doubles_of("t", t).reshape(-1, 1)}
    for key, array in arrays.items():
        masked = isinstance(array, np.ma.MaskedArray) and array.dtype.kind in "iuf"
        plain = np.ma.filled(np.ma.asarray(array, np.float64), np.nan) if masked else array
        numbers, shape = doubles_of(key, plain), (len(block["t"]), QUANTITIES[key].size)
        if numbers.size != math.prod(shape):
            wanted = f"real numbers of shape {shape}"
            raise LagtopError(f"{key} must be {wanted}, got the shape {numbers.shape}", key)
        block[key] = numbers.reshape(shape)
    return block
