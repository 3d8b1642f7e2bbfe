"""The view of the unit sphere and of the top in it: what is in sight, and where on the page."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.types import Array

HEIGHT, RADIUS, WEDGES = 0.62, 0.34, 24
"""Height and radius (in radii of the sphere) and wedges of the cone that stands for the top."""

Near = NDArray[np.bool_]
"""One boolean per point: whether it is on the near side."""


class View(NamedTuple):
    """An orthographic view: three orthonormal vectors."""

    right: Array
    up: Array
    toward: Array
    """Direction from the centre to the eye."""

    def project(self, points: Array) -> tuple[Array, Array]:
        """Return x and y on the page of points of shape (n, 3)."""
        return points @ self.right, points @ self.up

    def faces(self, points: Array) -> Near:
        """Return whether points of the sphere, of shape (n, 3), lie on the near side."""
        near: Near = points @ self.toward >= 0.0
        return near


def view_from(azimuth: float, elevation: float) -> View:
    """Return the view from a direction (radians), with z upwards on the page."""
    sa, ca, se, ce = (f(x) for x in (azimuth, elevation) for f in (math.sin, math.cos))
    return View(
        right=np.array([-sa, ca, 0.0]),
        up=np.array([-se * ca, -se * sa, ce]),
        toward=np.array([ce * ca, ce * sa, se]),
    )


def best_view(path: Array) -> View:
    """Return the view, from above or below, that a path faces most, with its start in sight."""

    def shown(view: View) -> float:
        """Return how well the path is seen."""
        turned = (path @ view.toward).mean()
        return float(view.faces(path).mean() + 0.5 * turned + view.faces(path[:1])[0])

    return max(_views(path, 25), key=lambda view: round(shown(view), 2))


def side_view(path: Array) -> View:
    """Return the view in which a top on this path is seen from the side, and its lid a little."""

    def shown(view: View) -> float:
        """Return the mean length of the axis on the page, and how often the lid is in sight."""
        facing = path @ view.toward
        length = np.sqrt(np.maximum(1.0 - facing**2, 0.0))
        return float(length.mean() + 0.3 * (facing > 0).mean() + 0.1 * (facing[0] > 0))

    return max(_views(path, 15), key=lambda view: round(shown(view), 2))


def _views(path: Array, elevation: float) -> list[View]:
    """Return views at all azimuths, those near the start of a path first, from above and below."""
    start = math.atan2(path[0, 1], path[0, 0])
    return [
        view_from(start + math.radians(azimuth), math.radians(height))
        for height in (elevation, -elevation)
        for azimuth in sorted(range(-180, 180, 15), key=lambda degrees: abs(degrees - 30))
    ]


def parallel(tilt: float) -> Array:
    """Return the circle of a tilt (radians) on the unit sphere, in shape (n, 3)."""
    around = np.linspace(0.0, 2 * math.pi, 241)
    sine, cosine = math.sin(tilt), math.cos(tilt)
    return np.stack([sine * np.cos(around), sine * np.sin(around), 0 * around + cosine], axis=1)


def runs(near: Near) -> Iterator[tuple[slice, bool]]:
    """Yield the pieces of a curve on either side; neighbours share the point where they meet."""
    ends = np.flatnonzero(near[1:] != near[:-1]) + 1
    bounds = [0, *ends.tolist(), near.size]
    for first, last in pairwise(bounds):
        yield slice(max(first - 1, 0), last), bool(near[first])


class Face(NamedTuple):
    """A triangle of the top on the page."""

    corners: Array
    """x and y of the corners, shape (3, 2)."""
    on_lid: bool
    light: bool
    """True on every other sixth of a turn, so that one sees the spin."""


class SeenTop(NamedTuple):
    """The top on the page: the faces in sight, the lid last."""

    faces: list[Face]
    rim: tuple[Array, Array]
    axle: tuple[Array, Array]
    """Line from the middle of the lid to the sphere."""
    lid_in_sight: bool


def seen_top(theta: float, phi: float, psi: float, view: View) -> SeenTop:
    """Return a cone that stands on its tip at these Euler angles (radians)."""
    nodes = np.array([math.cos(psi), math.sin(psi), 0.0])
    axis = np.array(
        [math.sin(theta) * math.sin(psi), -math.sin(theta) * math.cos(psi), math.cos(theta)]
    )
    around = phi + 2 * math.pi / WEDGES * np.arange(WEDGES + 1)
    spokes = np.outer(np.cos(around), nodes) + np.outer(np.sin(around), np.cross(axis, nodes))
    rim, middle = HEIGHT * axis + RADIUS * spokes, HEIGHT * axis
    outward = HEIGHT * (spokes[1:] + spokes[:-1]) / 2 - RADIUS * axis
    lid_in_sight = bool(axis @ view.toward > 0)

    def face(j: int, tip: Array, on_lid: bool) -> Face:
        """Return the triangle between a tip and wedge j of the rim."""
        corners = np.stack(view.project(np.stack([tip, rim[j], rim[j + 1]])), axis=1)
        return Face(corners, on_lid, light=j * 6 // WEDGES % 2 == 0)

    faces = [face(j, 0 * axis, False) for j in range(WEDGES) if outward[j] @ view.toward > 0]
    if lid_in_sight:
        faces += [face(j, middle, True) for j in range(WEDGES)]
    axle = view.project(np.stack([middle, axis]))
    return SeenTop(faces, view.project(rim), axle, lid_in_sight)
