"""The cone that stands for the top in a film: its faces in sight of a camera."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..inputs.rotations import rotated
from .camera import Camera

HEIGHT, RADIUS, WEDGES = 0.62, 0.34, 24
"""Height and radius (in radii of the sphere) and wedges of the cone that stands for the top."""


class Face(NamedTuple):
    """A triangle of the cone on the page."""

    corners: Array
    """x and y of the corners, shape (3, 2)."""
    on_lid: bool
    light: bool
    """True on every other sixth of a turn, so that one sees the spin."""


class Cone(NamedTuple):
    """The cone that stands for the top, on the page: the faces in sight, the lid last."""

    faces: list[Face]
    rim: tuple[Array, Array]
    axle: tuple[Array, Array]
    """Line from the middle of the lid to the sphere."""
    lid_in_sight: bool


def cone_at(quaternion: Array, camera: Camera) -> Cone:
    """Return a cone that stands on its tip, turned from body to space by a quaternion."""
    around = 2 * math.pi / WEDGES * np.arange(WEDGES + 1)
    spokes = np.stack([np.cos(around), np.sin(around), 0 * around], axis=1)
    z = np.array([0.0, 0.0, 1.0])
    outward = HEIGHT * (spokes[1:] + spokes[:-1]) / 2 - RADIUS * z
    tip, middle, axis = rotated(quaternion, np.stack([0 * z, HEIGHT * z, z]))
    rim = rotated(quaternion, RADIUS * spokes + HEIGHT * z)
    lid_in_sight = bool(axis @ camera.toward > 0)

    def face(j: int, apex: Array, on_lid: bool) -> Face:
        """Return the triangle between an apex and wedge j of the rim."""
        corners = np.stack(camera.project(np.stack([apex, rim[j], rim[j + 1]])), axis=1)
        return Face(corners, on_lid, light=j * 6 // WEDGES % 2 == 0)

    sides = np.flatnonzero(rotated(quaternion, outward) @ camera.toward > 0)
    faces = [face(int(j), tip, False) for j in sides]
    if lid_in_sight:
        faces += [face(j, middle, True) for j in range(WEDGES)]
    axle = camera.project(np.stack([middle, axis]))
    return Cone(faces, camera.project(rim), axle, lid_in_sight)
