"""The camera that looks at the unit sphere: which points are in sight, and where on the page."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array, Mask


class Camera(NamedTuple):
    """An orthographic camera: three orthonormal vectors."""

    right: Array
    up: Array
    toward: Array
    """Direction from the centre to the camera."""

    def project(self, points: Array) -> tuple[Array, Array]:
        """Return x and y on the page of points of shape (n, 3)."""
        return points @ self.right, points @ self.up

    def faces(self, points: Array) -> Mask:
        """Return whether points of the sphere, of shape (n, 3), lie on the near side."""
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
    """Return the camera, above or below, that a path faces most, with its start in sight."""

    def shown(camera: Camera) -> float:
        """Return how well the path is seen."""
        turned = (path @ camera.toward).mean()
        return float(camera.faces(path).mean() + 0.5 * turned + camera.faces(path[:1])[0])

    return _chosen(path, 25, shown)


def side_camera(path: Array) -> Camera:
    """Return the camera that sees a top on this path from the side, and its lid a little."""

    def shown(camera: Camera) -> float:
        """Return the mean length of the axis on the page, and how often the lid is in sight."""
        facing = path @ camera.toward
        length = np.sqrt(np.maximum(1.0 - facing**2, 0.0))
        return float(length.mean() + 0.3 * (facing > 0).mean() + 0.1 * (facing[0] > 0))

    return _chosen(path, 15, shown)


def _chosen(path: Array, elevation: float, shown: Callable[[Camera], float]) -> Camera:
    """Return the best camera of all azimuths, above or below; near the start if several are."""
    start = math.atan2(path[0, 1], path[0, 0])
    cameras = [
        camera_at(start + math.radians(azimuth), math.radians(height))
        for height in (elevation, -elevation)
        for azimuth in sorted(range(-180, 180, 15), key=lambda degrees: abs(degrees - 30))
    ]
    return max(cameras, key=lambda camera: round(shown(camera), 2))


def runs(near: Mask) -> Iterator[tuple[slice, bool]]:
    """Yield the pieces of a curve on the near side and behind; neighbours share a point."""
    ends = np.flatnonzero(near[1:] != near[:-1]) + 1
    bounds = [0, *ends.tolist(), near.size]
    for first, last in pairwise(bounds):
        yield slice(max(first - 1, 0), last), bool(near[first])
