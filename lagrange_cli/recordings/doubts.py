"""What is doubtful in a recording: angles of an unknown unit, and positions that are none."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError

_JUMP, _BEYOND = 4.4, 1e-3
"""Least jump by a whole turn between two rows, and how far an angle may be beyond one."""
_UNEVEN = 0.05
"""Greatest deviation of a marker from the nearest sphere (rms), over its radius."""
_SURE, _LEAST_CHANGE = 5.0, 2e-3
"""Standard deviations of a shifted origin, and the least change of the distance over itself."""
_FLAT = 0.5
"""Curvature of a marker's path, over that of the sphere about the origin, below which it is in a
plane, as are angular rates with a constant rate of spin."""
_FACING = 0.5
"""Cosine between the normal of a plane and the direction of its middle, if it faces the origin."""
_FEW = 12


def are_radians(angles: Iterable[Array]) -> bool:
    """Return whether angles without a unit are in radians: they stay within a turn and jump by it.

    Angles in degrees jump by 360.
    """
    columns = [x for y in angles for x in y.T]
    return all(_is_within_turn(x) for x in columns) and any(map(_jumps, columns))


def _is_within_turn(angle: Array) -> bool:
    """Return whether an angle stays in [-pi, pi] or in [0, 2 pi]."""
    seen = angle[np.isfinite(angle)]
    if not seen.size:
        return True
    turn = 2 * np.pi + _BEYOND
    return bool(abs(seen).max() < turn / 2 or (seen.min() > -_BEYOND and seen.max() < turn))


def _jumps(angle: Array) -> bool:
    steps = np.abs(np.diff(angle[np.isfinite(angle)]))
    return bool((steps > _JUMP).any())


def shifted_origin(position: Array) -> Array | None:
    """Return the pivot in the coordinates of a marker, if these do not begin at the pivot.

    The distance of the marker from its origin grows by d.e if the origin is off by d, with the
    direction e of the marker.  Returns None if the distance does not vary by more than noise.
    """
    offset, directions, distance = _offset(position)
    explained = directions @ offset
    rest = distance - distance.mean() - explained
    noise = float(rest @ rest) / max(distance.size - 4, 1)
    gain = float(explained @ explained) / (noise + 1e-30)
    if gain < _SURE**2 + 3 or np.ptp(explained) < _LEAST_CHANGE * distance.mean():
        return None
    for _ in range(8):  # to first order in what is left
        offset = offset + _offset(position - offset)[0]
    return offset


def _offset(marker: Array) -> tuple[Array, Array, Array]:
    """Return the pivot to first order, a marker's directions less their mean, and its distances."""
    distance = np.linalg.norm(marker, axis=1)
    directions = marker / distance[:, np.newaxis]
    directions = directions - directions.mean(axis=0)
    basis = np.column_stack([np.ones(distance.size), directions])
    return np.linalg.lstsq(basis, distance, rcond=1e-3)[0][1:], directions, distance


def check_position(position: Array) -> None:
    """Raise LagtopError for numbers that are no positions of a point that turns about a pivot."""
    seen = position[np.isfinite(position).all(axis=1) & (position != 0).any(axis=1)]
    if len(seen) < _FEW:
        return
    how = ""
    if _is_flat(seen):
        how = "lie in a plane, not on a sphere"
    elif (off := _off_sphere(seen)) > _UNEVEN:
        how = f"are {off:.1%} off the nearest sphere (rms)"
    if how:
        may = "rates, accelerations, or the marker of a top whose pivot moves"
        raise LagtopError(f"x, y, z must be a position about a pivot, but {how}: are they {may}?")


def _off_sphere(points: Array) -> float:
    """Return the deviation of points from the nearest sphere (rms), over its radius."""
    middle = points.mean(axis=0)
    away = points - middle
    square = (away**2).sum(axis=1)
    basis = np.column_stack([2 * away, np.ones(len(away))])
    *centre, _ = np.linalg.lstsq(basis, square, rcond=1e-3)[0]
    distances = [np.linalg.norm(points - x, axis=1) for x in (middle + centre, np.zeros(3))]
    return min(float(x.std() / (x.mean() or 1.0)) for x in distances)


def _is_flat(points: Array) -> bool:
    """Return whether points lie in a plane although a sphere about the origin would be seen.

    The rates of a top in its body do: the rate of spin is constant.  A plane through the origin is
    that of a pendulum.
    """
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle, full_matrices=False)[2]
    u, v, height = normal @ (points - middle).T
    if abs(normal[2] @ middle) < _FACING * np.linalg.norm(middle):
        return False
    basis = np.column_stack([np.ones(len(u)), u, v, (u**2 + v**2) / 2])
    found, rest, rank, _ = np.linalg.lstsq(basis, height, rcond=1e-9)
    if rank < basis.shape[1]:
        return False
    noise, inverse = float(rest[0]) / (len(u) - 4), np.linalg.inv(basis.T @ basis)[3, 3]
    _, *centre = np.linalg.lstsq(basis[:, :3], basis[:, 3], rcond=1e-9)[0]
    squares = (u - centre[0]) ** 2 + (v - centre[1]) ** 2
    if 1 / inverse < _SURE**2 * noise * squares.sum():  # a circle with noise
        return False
    error = float(np.sqrt(noise * inverse))
    expected = 1 / float(np.linalg.norm(points, axis=1).mean())
    return bool(abs(found[3]) + _SURE * error < _FLAT * expected)
