"""Doubts about a recording: angles of an unknown unit, positions, and where the pivot is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.text import uncertain_text
from ..arithmetic.types import Array, Mask
from ..errors import DataError
from .observed import observe
from .options import Reading

_JUMP, _BEYOND = 4.4, 1e-3
"""Least jump by a whole turn between two rows, and how far an angle may be beyond one."""
_SMOOTHER = 5.0
"""Ratio of the greatest turn between two rows to the median one that shows the wrong unit."""
_UNEVEN = 0.05
"""Greatest deviation of a marker from the nearest sphere (rms), over its radius."""
_SURE, _LEAST_CHANGE = 5.0, 2e-3
"""Standard deviations of a shifted origin, and the least change of the distance over itself."""
_DETERMINED, _FAR = 0.2, 3.0
"""Greatest standard deviation of a coordinate of the pivot that is determined, and of the farthest
pivot that is possible, over the distance of the marker."""
_FLAT = 0.5
"""Curvature of a marker's path, over that of the sphere about the origin, below which it is in a
plane, as are angular rates with a constant rate of spin."""
_FACING = 0.5
"""Cosine between the normal of a plane and the direction of its middle, if it faces the origin."""
_FEW, _ENOUGH = 12, 400
"""Rows below which nothing is doubted, and rows that show a frequency."""


def why_radians(bare: Mapping[str, Array], reading: Reading) -> str:
    """Return why angles without a unit are in radians, empty if they are not.

    They stay within a turn and jump by it, or Euler angles turn smoothly only in radians.
    """
    columns = [x[np.isfinite(x)] for y in bare.values() for x in y.T]
    if not all(map(_is_within_turn, columns)):
        return ""
    if any((np.abs(np.diff(x)) > _JUMP).any() for x in columns):
        return "they jump by 6.28"
    if "euler" in bare:
        rough = [_roughness(bare["euler"] * size, reading) for size in (1.0, np.pi / 180)]
        if rough[1] > _SMOOTHER * max(rough[0], 1.0):
            return "only so do they turn smoothly"
    return ""


def _is_within_turn(angle: Array) -> bool:
    """Return whether an angle stays in [-pi, pi] or in [0, 2 pi]."""
    least, most, turn = angle.min(initial=0), angle.max(initial=0), 2 * np.pi + _BEYOND
    return bool(max(-least, most) < turn / 2 or (least > -_BEYOND and most < turn))


def _roughness(euler: Array, reading: Reading) -> float:
    """Return the greatest turn between two rows over the median one."""
    seen = euler[np.isfinite(euler).all(axis=1)]
    if len(seen) < _FEW:
        return 0.0
    turned = observe({"t": seen[:, :1], "euler": seen}, reading).quaternion
    steps = rotations.angle_between(turned[1:], turned[:-1]) if turned is not None else np.zeros(1)
    return float(steps.max() / (np.median(steps) or 1.0))


class Pivot(NamedTuple):
    """The pivot in the coordinates of a marker, with standard deviations."""

    at: Array
    std: Array
    is_determined: Mask

    def __str__(self) -> str:
        found = zip("xyz", *(x.tolist() for x in self), strict=True)
        return ", ".join(f"{x} = {uncertain_text(y, z)}" for x, y, z, known in found if known)


def pivot_of(position: Array) -> Pivot | None:
    """Return the pivot of a marker if it is not at the origin of its coordinates.

    The distance of the marker from the origin grows by d.e if the pivot is at d, with the
    direction e of the marker.  Returns None if the distance does not vary by more than noise.
    """
    seen = position[np.isfinite(position).all(axis=1) & (position != 0).any(axis=1)]
    if len(seen) < _FEW:
        return None
    distance = np.linalg.norm(seen, axis=1)
    directions = seen / distance[:, np.newaxis]
    directions = directions - directions.mean(axis=0)
    explained = directions @ np.linalg.lstsq(directions, distance, rcond=1e-3)[0]
    rest = distance - distance.mean() - explained
    noise = float(rest @ rest) / (distance.size - 4)
    gain = float(explained @ explained) / (noise + 1e-30)
    if gain < _SURE**2 + 3 or np.ptp(explained) < _LEAST_CHANGE * distance.mean():
        return None
    centre, std = _sphere_about(seen)
    radius = float(np.linalg.norm(seen - centre, axis=1).mean())
    return Pivot(centre, std, std < _DETERMINED * radius)


def _sphere_about(points: Array) -> tuple[Array, Array]:
    """Return the centre of the nearest sphere, and its standard deviations."""
    centre, spread = _nearest_centre(points), np.full(3, np.inf)
    for _ in range(12):
        away = points - centre
        distance = np.linalg.norm(away, axis=1)
        basis = np.column_stack([away / distance[:, np.newaxis], np.ones(len(away))])
        step = np.linalg.lstsq(basis, distance, rcond=1e-3)[0]
        noise = np.linalg.norm(distance - basis @ step) / np.sqrt(len(points) - 4)
        _, sizes, axes = np.linalg.svd(basis, full_matrices=False)
        by_noise = len(points) * (noise / step[3]) ** 2 * (1 + 4 / np.sqrt(len(points)))
        shown = np.maximum(sizes**2 - by_noise, 0.0) / sizes  # noise of directions shows nothing
        errors = np.minimum(noise / (shown + 1e-30), _FAR * step[3])
        spread = np.linalg.norm(axes.T * errors, axis=1)[:3]
        centre = centre + step[:3]
    return centre, spread


def _nearest_centre(points: Array) -> Array:
    """Return the centre of the sphere of which points are the least off, in squares."""
    middle = points.mean(axis=0)
    away = points - middle
    basis = np.column_stack([2 * away, np.ones(len(away))])
    *centre, _ = np.linalg.lstsq(basis, (away**2).sum(axis=1), rcond=1e-3)[0]
    return np.asarray(middle + centre)


def centre_above(t: Array, marks: Array) -> Array:
    """Return the point about which a marker turns, if a camera sees it from above.

    The squared distance from it is a function with the period of the nutation: it is 2 c.x less
    than the squared distance from the origin, up to a constant.
    """
    from scipy.optimize import minimize_scalar  # start-up

    seen = np.flatnonzero(np.isfinite(marks).all(axis=1) & np.isfinite(t))
    rows = seen[np.linspace(0, len(seen) - 1, min(len(seen), _ENOUGH)).astype(int)]
    if len(rows) < _FEW:
        return np.zeros(2)
    middle = marks[rows].mean(axis=0)
    away, phase = marks[rows] - middle, t[rows] - t[rows[0]]
    phase = 2 * np.pi * phase / (np.ptp(phase) or 1.0)

    def fitted(cycles: float) -> tuple[float, Array]:
        waves = [f(k * cycles * phase) for k in (1, 2, 3) for f in (np.cos, np.sin)]
        basis = np.column_stack([2 * away, np.ones(len(away)), *waves])
        found = np.linalg.lstsq(basis, square, rcond=1e-6)[0]
        return float(np.linalg.norm(square - basis @ found)), found[:2]

    square = (away**2).sum(axis=1)
    counts = np.arange(1.0, len(rows) / 6, 0.25)
    best = counts[np.argmin([fitted(x)[0] for x in counts])] if counts.size else 1.0
    bounds = (best - 0.25, best + 0.25)
    near = minimize_scalar(lambda x: fitted(x)[0], bounds=bounds, method="bounded").x
    return np.asarray(middle + fitted(near)[1])


def check_position(position: Array) -> None:
    """Raise DataError for numbers that are no positions of a point that turns about a pivot."""
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
        raise DataError(f"x, y, z must be a position about a pivot, but {how}: are they {may}?")


def _off_sphere(points: Array) -> float:
    """Return the deviation of points from the nearest sphere (rms), over its radius."""
    centres: Iterable[Array] = _nearest_centre(points), np.zeros(3)
    distances = [np.linalg.norm(points - x, axis=1) for x in centres]
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
