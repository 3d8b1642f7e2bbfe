"""Rotations, and conversion between Euler angle rates and angular velocity (4,1).

Quaternions are w, x, y, z along the last axis, and need not be normalised.  Angles are in
radians.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .types import Array

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
HALF_TURN_X = np.array([0.0, 1.0, 0.0, 0.0])

_TURN = np.array([0.5, 0.5, 0.5, 0.5])
"""A cyclic exchange of the axes, which turns y to z."""


def product(first: Array, second: Array) -> Array:
    """Return the rotation `second` followed by `first`."""
    a, b, c, d = (first[..., i] for i in range(4))
    w, x, y, z = (second[..., i] for i in range(4))
    parts = (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def directed(values: Array) -> Array:
    """Return quaternions or vectors, with NaN for those of length 0 or inf: without direction."""
    length = np.linalg.norm(values, axis=-1, keepdims=True)
    return np.where((length > 0) & (length < np.inf), values, np.nan)


def conjugate(rotation: Array) -> Array:
    """Return the inverse of a rotation, up to its norm."""
    return np.asarray(rotation * np.array([1.0, -1.0, -1.0, -1.0]))


def angle_between(first: Array, second: Array) -> Array:
    """Return the angle of the rotation between two, in [0, pi], accurate for tiny angles too."""
    between = product(conjugate(first), second)
    half = np.arctan2(np.linalg.norm(between[..., 1:], axis=-1), abs(between[..., 0]))
    return np.asarray(2.0 * half)


def rotated(rotation: Array, vectors: Array) -> Array:
    """Return the vectors turned by the rotations."""
    unit = rotation / np.linalg.norm(rotation, axis=-1, keepdims=True)
    pure = np.concatenate([np.zeros_like(vectors[..., :1]), vectors], axis=-1)
    return product(product(unit, pure), conjugate(unit))[..., 1:]


def about_z(angle: float | Array) -> Array:
    """Return the rotation about z by an angle, or by each angle of an array."""
    half = np.asarray(angle) / 2
    return np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=-1)


def to_z(axis: str) -> Array:
    """Return a rotation that turns an axis (x, -x, y, -y, z or -z) to z."""
    turn = {"x": _TURN * [1, -1, -1, -1], "y": _TURN, "z": IDENTITY}[axis[-1]]
    return product(HALF_TURN_X, turn) if axis.startswith("-") else turn


def of_angles(theta: Array, phi: Array, psi: Array) -> Array:
    """Return the rotation from body to space for tilt, spin and precession."""
    sum_, difference = (psi + phi) / 2, (psi - phi) / 2
    upper, lower = np.cos(theta / 2), np.sin(theta / 2)
    first = upper * np.cos(sum_), lower * np.cos(difference)
    return np.stack([*first, lower * np.sin(difference), upper * np.sin(sum_)], axis=-1)


def angles_of(rotation: Array) -> dict[str, Array]:
    """Return tilt, spin and precession of rotations; the last two may be off by whole turns."""
    w, x, y, z = (rotation[..., i] for i in range(4))
    upper, lower = np.arctan2(z, w), np.arctan2(y, x)
    tilt = 2.0 * np.arctan2(np.hypot(x, y), np.hypot(w, z))
    return {"theta": tilt, "phi": upper - lower, "psi": upper + lower}


def axis_of(rotation: Array) -> Array:
    """Return the body's z axis in space, for rotations from body to space."""
    return rotated(rotation, np.broadcast_to([0.0, 0.0, 1.0], (*rotation.shape[:-1], 3)))


def angles_of_axis(axis: Array) -> dict[str, Array]:
    """Return tilt and precession of a figure axis (sin theta sin psi, -sin theta cos psi, ...)."""
    x, y, z = (axis[..., i] for i in range(3))
    return {"theta": np.arctan2(np.hypot(x, y), z), "psi": np.arctan2(x, -y)}


def angle_between_vectors(first: Array, second: Array) -> Array:
    """Return the angle between vectors, in [0, pi], accurate for tiny angles too."""
    across = np.linalg.norm(np.cross(first, second), axis=-1)
    return np.asarray(np.arctan2(across, np.sum(first * second, axis=-1)))


def within_half_turn(angle: Array) -> Array:
    """Return the angle reduced to (-pi, pi] by whole turns."""
    return np.asarray(angle - np.ceil(angle / (2 * np.pi) - 0.5) * (2 * np.pi))


def of_scipy(form: str, *given: Any) -> Array:
    """Return rotations in another form of SciPy, such as `euler` with a sequence and angles."""
    from scipy.spatial.transform import Rotation  # start-up

    return np.asarray(getattr(Rotation, f"from_{form}")(*given).as_quat(scalar_first=True))


def of_matrix(rows: Array) -> tuple[Array, Array]:
    """Return the rotations nearest to matrices, given row by row, and the greatest |R R^T - 1|.

    The rotation is NaN for a matrix that is not a rotation, such as a reflection.
    """
    matrices = rows.reshape(-1, 3, 3)
    gram = np.einsum("nij,nkj->nik", matrices, matrices)
    fault: Array = np.max(np.abs(gram - np.eye(3)), axis=(1, 2))
    good = np.asarray(np.isfinite(rows).all(axis=1))
    good[good] = np.linalg.det(matrices[good]) > 0
    found = np.full((len(rows), 4), np.nan)
    if good.any():
        found[good] = of_scipy("matrix", matrices[good])
    return found, fault


def body_rates(
    theta: Array, phi: Array, thetadot: Array, phidot: Array, psidot: Array
) -> tuple[Array, Array, Array]:
    """Return p, q, r of a top at a tilt and a spin angle, from the rates of its angles (4,1)."""
    sin, cos, around = np.sin(phi), np.cos(phi), psidot * np.sin(theta)
    return (
        around * sin + thetadot * cos,
        around * cos - thetadot * sin,
        psidot * np.cos(theta) + phidot,
    )


def to_matrix(rotation: Array) -> Array:
    """Return the matrices of rotations, shape (n, 3, 3)."""
    columns = [rotated(rotation, np.broadcast_to(x, (len(rotation), 3))) for x in np.eye(3)]
    return np.stack(columns, axis=-1)
