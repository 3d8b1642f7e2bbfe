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
from ..names import ANGLES
from . import rotations
from .columns import QUANTITIES

ORDERS = ("wxyz", "xyzw")
Quantities = Mapping[str, Array]
"""Arrays of shape (n, parts) by the name of the quantity (see `files.columns`)."""


class Conventions(NamedTuple):
    """Conventions of quantities whose names do not imply them."""

    quaternion: str | None = None
    """Order of the parts, `wxyz` or `xyzw`; None to determine it from the first row."""
    euler: str = "xyz"
    """Sequence of axes in SciPy's notation: lower case for space, upper case for the body."""
    rates: str = "body"
    """Frame of the angular velocity, `body` or `space`."""
    radians: bool = False
    """Whether angles without a unit are in radians."""

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
    """Distance of the centre of mass from the pivot."""

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


@np.errstate(all="ignore")  # rows that are not finite raise no warnings
def observe(given: Quantities, conventions: Conventions) -> Observed:
    """Return the motion from its quantities, with all angles in radians.

    The first quantity that gives all of the attitude, or most of it, is used.  Raises LagtopError
    for rates of the angles without an attitude.
    """
    alone = angles_in(given)
    found: dict[str, Any] = {"t": given["t"][:, 0]}
    if "quaternion" in given:
        order = conventions.quaternion or ORDERS[0]
        found |= _directed("quaternion", given["quaternion"][:, [*map(order.index, "wxyz")]])
    elif "matrix" in given:
        found["quaternion"], found["norm"] = rotations.of_matrix(given["matrix"])
    elif len(alone) == len(ANGLES):
        found["quaternion"] = rotations.of_angles(**alone)
    elif "euler" in given:
        found["quaternion"] = rotations.of_scipy("euler", conventions.euler, given["euler"])
    elif "rotvec" in given:
        found["quaternion"] = rotations.of_scipy("rotvec", given["rotvec"])
    elif "axis" in given:
        found |= _directed("axis", given["axis"])
    elif "position" in given and not alone:
        found["axis"] = rotations.directed(given["position"])
        found["distance"] = np.linalg.norm(given["position"], axis=1)
    if not {"quaternion", "axis"} & found.keys():
        found["angles"] = alone
    if "rates" in given:
        found[f"{conventions.rates}_rates"] = given["rates"]
    elif "angle_rates" in given and "quaternion" in found:
        at = rotations.angles_of(found["quaternion"])
        rates = rotations.body_rates(at["theta"], at["phi"], *given["angle_rates"].T)
        found["body_rates"] = np.stack(rates, axis=1)
    elif "angle_rates" in given and not (alone or "axis" in found):
        wanted = "an attitude or a part of it, such as theta, phi and psi"
        raise LagtopError(f"angle_rates must come with {wanted}, got none", "angle_rates")
    return Observed(**found)


def angles_in(given: Quantities) -> dict[str, Array]:
    """Return tilt, spin and precession, as far as each has its own column."""
    return {x: given[x][:, 0] for x in ANGLES if x in given}


def _directed(key: str, values: Array) -> dict[str, Array]:
    """Return quaternions or axes, and the distances of their norms from 1."""
    return {key: rotations.directed(values), "norm": np.linalg.norm(values, axis=1) - 1.0}


def rows_of(given: Quantities, rows: slice | NDArray[np.intp]) -> dict[str, Array]:
    """Return some of the rows of all quantities."""
    return {key: values[cast(Any, rows)] for key, values in given.items()}


def quantities_of(t: ArrayLike, arrays: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Return times and arrays with a row for each; a masked element is NaN.  Raises LagtopError."""
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
