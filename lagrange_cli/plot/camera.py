"""The camera that looks at the unit sphere, and the visible faces of the film's cone."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.types import Array, Mask
from ..inputs.rotations import rotated

HEIGHT, RADIUS, WEDGES = 0.62, 0.34, 24
"""Height and radius (in radii of the sphere) and number of wedges of the cone for the top."""


class Camera(NamedTuple):
    """An orthographic camera: three orthonormal vectors."""

    right: Array
    up: Array
    toward: Array
    """Direction from the centre to the camera."""

    def project(self, points: Array) -> tuple[Array, Array]:
        """Return the page coordinates x and y of points of shape (n, 3)."""
        return points @ self.right, points @ self.up

    def faces(self, points: Array) -> Mask:
        """Return whether points on the sphere, of shape (n, 3), are on the near side."""
        near: Mask = points @ self.toward >= 0.0
        return near


def camera_at(azimuth: float, elevation: float) -> Camera:
    """Return the camera in a direction (radians), with z upwards on the page."""
    sa, ca, se, ce = (f(x) for x in (azimuth, elevation) for f in (math.sin, math.cos))
    return Camera(
        right=np.array([-sa, ca, 0.0]),
        up=np.array([-se * ca, -se * sa, ce]),
        toward=np.array([ce * ca, ce * sa, se]),
    )


def best_camera(path: Array) -> Camera:
    """Return the camera that sees most of a path, including its start.

    It is above the horizon unless the path hangs well below it.
    """

    def shown(camera: Camera) -> float:
        """Return a measure of how well a camera sees the path."""
        turned = (path @ camera.toward).mean()
        faces = camera.faces(path).mean() + 0.5 * turned + camera.faces(path[:1])[0]
        return float(faces + 0.2 * (camera.toward[2] > 0))

    return _chosen(path, 25, shown)


def side_camera(path: Array) -> Camera:
    """Return the camera that sees a top on this path from the side, and its lid slightly."""

    def shown(camera: Camera) -> float:
        """Return a score: the mean length of the axis, and how often the lid is visible."""
        facing = path @ camera.toward
        length = np.sqrt(np.maximum(1.0 - facing**2, 0.0))
        return float(length.mean() + 0.3 * (facing > 0).mean() + 0.1 * (facing[0] > 0))

    return _chosen(path, 15, shown)


def _chosen(path: Array, elevation: float, shown: Callable[[Camera], float]) -> Camera:
    """Return the best camera of all azimuths, above or below; if tied, near the start."""
    start = math.atan2(path[0, 1], path[0, 0])
    cameras = [
        camera_at(start + math.radians(azimuth), math.radians(height))
        for height in (elevation, -elevation)
        for azimuth in sorted(range(-180, 180, 15), key=lambda degrees: abs(degrees - 30))
    ]
    return max(cameras, key=lambda camera: round(shown(camera), 2))


def runs(near: Mask) -> Iterator[tuple[slice, bool]]:
    """Yield the pieces of a curve on the near and the far side; neighbours share a point."""
    ends = np.flatnonzero(near[1:] != near[:-1]) + 1
    bounds = [0, *ends.tolist(), near.size]
    for first, last in pairwise(bounds):
        yield slice(max(first - 1, 0), last), bool(near[first])


def on_one_side(camera: Camera, curve: Array, near: bool) -> Array:
    """Return page coordinates of a curve, shape (2, n), with NaN on the other side."""
    shown = np.full((2, len(curve)), np.nan)
    for part, is_near in runs(camera.faces(curve)):
        if is_near is near:
            shown[:, part] = camera.project(curve[part])
    return shown


class Cone(NamedTuple):
    """The cone that stands for the top, on the page: its visible triangles, the lid last."""

    corners: Array
    """x and y of the corners of each triangle, shape (n, 3, 2)."""
    inks: NDArray[np.int_]
    """0 for the light triangles, 1 for others on the side and 2 for others on the lid, shape (n).

    Every other sixth of a turn is light, so that the spin is visible.
    """
    rim: tuple[Array, Array]
    axle: tuple[Array, Array]
    """Line from the middle of the lid to the sphere."""
    lid_in_sight: bool


def cone_at(quaternion: Array, camera: Camera) -> Cone:
    """Return a cone that stands on its tip, rotated from body to space by a quaternion."""
    around = 2 * math.pi / WEDGES * np.arange(WEDGES + 1)
    spokes = np.stack([np.cos(around), np.sin(around), 0 * around], axis=1)
    z = np.array([0.0, 0.0, 1.0])
    outward = HEIGHT * (spokes[1:] + spokes[:-1]) / 2 - RADIUS * z
    points = np.concatenate([[0 * z, HEIGHT * z, z], RADIUS * spokes + HEIGHT * z, outward])
    turned = rotated(quaternion, points)
    page = np.stack(camera.project(turned), axis=1)
    tip, middle, axis, rim = page[0], page[1], page[2], page[3 : WEDGES + 4]
    lid_in_sight = bool(turned[2] @ camera.toward > 0)
    sides = turned[WEDGES + 4 :] @ camera.toward > 0
    edges = np.stack([rim[:-1], rim[1:]], axis=1)
    dark = np.arange(WEDGES) * 6 // WEDGES % 2
    shown = [(tip, sides, 1)] + [(middle, np.ones(WEDGES, np.bool_), 2)] * lid_in_sight
    corners = [np.insert(edges[seen], 0, apex, axis=1) for apex, seen, _ in shown]
    inks = [dark[seen] * ink for _, seen, ink in shown]
    axle = np.stack([middle, axis])
    return Cone(
        np.concatenate(corners),
        np.concatenate(inks),
        (rim[:, 0], rim[:, 1]),
        (axle[:, 0], axle[:, 1]),
        lid_in_sight,
    )
