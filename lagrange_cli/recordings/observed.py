"""The observed motion: the quantities of a trajectory, interpreted by their conventions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arithmetic import rotations
from ..arithmetic.arrays import doubles_of
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..names import ANGLES
from .options import Alignment, Reading
from .quantities import QUANTITIES

Quantities = Mapping[str, Array]
"""Arrays of shape (n, parts) by the name of the quantity (see `recordings.quantities`)."""
_UNREAL, _UNITY = np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, -1.0, 0.0]])
"""Half turns: reversed, they turn y round as in Unreal, or exchange x and y, as Unity does."""


@dataclass(frozen=True)
class Observed:
    """The motion at some times; quantities that are not given are None."""

    t: Array
    quaternion: Array | None = None
    """From body to space, shape (n, 4)."""
    axis: Array | None = None
    """Figure axis in space, shape (n, 3)."""
    angles: Mapping[str, Array] = field(default_factory=dict)
    """Tilt, spin and precession in radians, if these are given and no other frames."""
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
            turned["angles"] = {}
        return replace(self, **turned)


@np.errstate(all="ignore")  # rows that are not finite raise no warnings
def observe(given: Quantities, reading: Reading) -> Observed:
    """Return the motion from its quantities, with all angles in radians.

    The first quantity that gives all of the attitude, or most of it, is used.  Raises LagtopError
    for rates of the angles without an attitude.
    """
    alone = {x: given[x][:, 0] for x in ANGLES if x in given}
    found: dict[str, Any] = {"t": given["t"][:, 0]}
    if "quaternion" in given:
        parts = [*map(reading.quaternion_order.index, "wxyz")]
        found |= _directed("quaternion", given["quaternion"][:, parts])
    elif "matrix" in given:
        found["quaternion"], found["norm"] = rotations.of_matrix(given["matrix"])
    elif len(alone) == len(ANGLES):
        found |= {"quaternion": rotations.of_angles(**alone), "angles": alone}
    elif "euler" in given:
        found["quaternion"] = rotations.of_scipy("euler", reading.euler_sequence, given["euler"])
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
        found[f"{reading.rates_frame}_rates"] = given["rates"]
    elif "angle_rates" in given and "quaternion" in found:
        at = rotations.angles_of(found["quaternion"])
        rates = rotations.body_rates(at["theta"], at["phi"], *given["angle_rates"].T)
        found["body_rates"] = np.stack(rates, axis=1)
    elif "angle_rates" in given and not (alone or "axis" in found):
        wanted = "an attitude or a part of it, such as theta, phi and psi"
        raise LagtopError(f"angle_rates must come with {wanted}, got none", "angle_rates")
    return Observed(**found)


def framed(seen: Observed, align: Alignment) -> Observed:
    """Return a motion in the frames of lagtop.

    A left-handed frame is a right-handed one whose axes are all reversed.  Raises LagtopError
    if the attitude is not complete enough.
    """
    if align.frame == Alignment().frame:
        return seen
    if seen.quaternion is None and (align.has_axis or align.conjugate or seen.axis is None):
        needs = "the axis or the whole attitude, and align axis and conjugate the attitude"
        raise LagtopError(f"align up and align left need {needs}: omit them", "align")
    if align.conjugate and seen.quaternion is not None:
        seen = replace(seen, quaternion=rotations.conjugate(seen.quaternion), angles={})
    frames = rotations.to_z(align.up), rotations.to_z(align.axis)
    if not align.left:
        return seen.turned(*frames)
    mirror = _UNREAL if align.up[-1] == "z" else _UNITY
    seen = seen.turned(*(rotations.product(mirror, x) for x in frames))
    return seen if seen.axis is None else replace(seen, axis=-seen.axis)


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
