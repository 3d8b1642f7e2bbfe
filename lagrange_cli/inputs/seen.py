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
FRAMES = ("body", "space")


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
        for key, known, got in (
            ("quaternion_order", (None, *ORDERS), self.quaternion),
            ("rates_frame", FRAMES, self.rates),
        ):
            if got not in known:
                wanted = " or ".join(filter(None, known))
                raise LagtopError(f"{key} must be {wanted}, got {quoted(got)}", key)
        try:
            euler_sequence(self.euler)
        except LagtopError as error:
            raise LagtopError(f"euler_sequence {error}", "euler_sequence") from None
        return self


def euler_sequence(text: str) -> str:
    """Return a valid sequence of three axes in SciPy's notation; neighbours must differ.

    Raises LagtopError for any other text.
    """
    if not re.fullmatch(r"(?!.*(.)\1)([xyz]{3}|[XYZ]{3})", str(text)):
        wanted = "three axes, such as xyz (axes of space) or XYZ (axes of the body)"
        raise LagtopError(f"must be {wanted}, got {quoted(str(text))}")
    return text


@dataclass(frozen=True)
class Seen:
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

    def turned(self, space: Array, body: Array) -> Seen:
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


Quantities = Mapping[str, Array]
"""Arrays of shape (n, parts) by the name of the quantity (see `inputs.trajectory_columns`)."""


Named = Mapping[str, FoundQuantity]
"""The quantities of a file, with the conventions and the angle units that their names imply."""


def see(given: Quantities, conventions: Conventions, named: Named) -> Seen:
    """Return the motion from its quantities; names override the conventions.

    Raises LagtopError for rates of the angles without an attitude.
    """
    reader = _Reader(given, conventions, named)
    seen = Seen(given["t"][:, 0], **reader.attitude())
    return replace(seen, **reader.rates(seen))


def angles_in(given: Quantities, conventions: Conventions, named: Named) -> dict[str, Array]:
    """Return tilt, spin and precession, in radians, as far as each has its own column."""
    reader = _Reader(given, conventions, named)
    return {key: reader.angle(key)[:, 0] for key in ANGLES if key in given}


class _Reader:
    """Quantities with their conventions."""

    def __init__(self, given: Quantities, conventions: Conventions, named: Named) -> None:
        self.given, self.conventions, self.named = given, conventions, named

    def attitude(self) -> dict[str, Any]:
        """Return the attitude from the first quantity that gives all of it, or most of it."""
        given = self.given
        alone = angles_in(given, self.conventions, self.named)
        found: dict[str, Any] = {"angles": alone}
        if len(alone) == len(ANGLES) and not {"quaternion", "matrix"} & given.keys():
            found = {"quaternion": rotations.of_angles(**alone)}
        elif "quaternion" in given:
            order = self.convention("quaternion", self.conventions.quaternion or ORDERS[0])
            found = _directed("quaternion", given["quaternion"][:, [*map(order.index, "wxyz")]])
        elif "matrix" in given:
            rotation, fault = rotations.of_matrix(given["matrix"])
            found = {"quaternion": rotation, "norm": fault}
        elif "euler" in given:
            sequence = self.convention("euler", self.conventions.euler)
            found = {"quaternion": rotations.of_euler(sequence, self.angle("euler"))}
        elif "rotvec" in given:
            found = {"quaternion": rotations.of_vector(given["rotvec"])}
        elif "axis" in given:
            found = _directed("axis", given["axis"])
        elif "position" in given and not alone:
            distance = np.linalg.norm(given["position"], axis=1)
            found = {"axis": rotations.directed(given["position"]), "distance": distance}
        return found

    def rates(self, seen: Seen) -> dict[str, Any]:
        """Return the angular velocity, in the frame in which it is given.

        Raises LagtopError for rates of the angles without any attitude.
        """
        if "rates" in self.given:
            frame = self.convention("rates", self.conventions.rates)
            return {f"{frame}_rates": self.given["rates"]}
        if "angle_rates" not in self.given:
            return {}
        if seen.quaternion is None and seen.axis is None and not seen.angles:
            wanted = "an attitude or a part of it, such as theta, phi and psi"
            raise LagtopError(f"angle_rates must come with {wanted}, got none", "angle_rates")
        if seen.quaternion is None:
            return {}
        at = rotations.angles_of(seen.quaternion)
        rates = dict(zip(rotations.EulerRates._fields, self.given["angle_rates"].T, strict=True))
        found = rotations.body_rates(at["theta"], at["phi"], **rates)
        return {"body_rates": np.stack(found, axis=1)}

    def convention(self, key: str, other: str) -> str:
        """Return the convention that the name of a quantity implies, or else `other`."""
        return self.named.get(key, NAMELESS).says or other

    def angle(self, key: str) -> Array:
        """Return angles in radians."""
        named = self.named.get(key, NAMELESS)
        in_radians = self.conventions.radians if named.unit is None else named.unit == "rad"
        angles = self.given[key]
        if named.says == ELEVATION:
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
        numbers, shape = doubles_of(key, _unmasked(array)), (len(block["t"]), QUANTITIES[key].size)
        if numbers.size != math.prod(shape):
            wanted = f"real numbers of shape {shape}"
            raise LagtopError(f"{key} must be {wanted}, got the shape {numbers.shape}", key)
        block[key] = numbers.reshape(shape)
    return block


def _unmasked(array: ArrayLike) -> ArrayLike:
    """Return an array with NaN for its masked elements."""
    if isinstance(array, np.ma.MaskedArray) and array.dtype.kind in "iuf":
        numbers: Array = np.ma.filled(array.astype(np.float64), np.nan)
        return numbers
    return array
