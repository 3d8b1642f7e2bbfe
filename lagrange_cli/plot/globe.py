"""The globe on which pictures show a motion, the camera that looks at it, and the film's cone."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from numpy.typing import NDArray

from ..arithmetic.types import Array, Mask
from ..inputs.rotations import rotated
from .kinds import PlotRequest
from .style import HEIGHT, RADIUS, WEDGES, Look, points, short_text

TIP, NAME = 1.24, 0.1
"""Length of the axes of space in radii of the globe, and distance of their names from the tips."""
DASH_DOTTED = {"ls": (0, (7, 2, 1, 2))}
"""Style of the circle of the greatest tilt."""
SAME_PLACE = 0.13
"""Distance at which the names of two axes would touch, so that they are joined."""
INSEPARABLE = math.radians(0.8)
"""Difference of tilt below which two circles are one line on the globe."""


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

    def shown(toward: Array) -> float:
        facing = path @ toward
        seen = (facing >= 0).mean() + 0.5 * facing.mean() + (facing[0] >= 0)
        return float(seen + 0.2 * (toward[2] > 0))

    return _chosen(path, 25, shown)


def side_camera(path: Array) -> Camera:
    """Return the camera that sees a top on this path from the side, and its lid slightly."""

    def shown(toward: Array) -> float:
        facing = path @ toward
        length = np.sqrt(np.maximum(1.0 - facing**2, 0.0))
        return float(length.mean() + 0.3 * (facing > 0).mean() + 0.1 * (facing[0] > 0))

    return _chosen(path, 15, shown)


def _chosen(path: Array, elevation: float, shown: Callable[[Array], float]) -> Camera:
    """Return the camera of all azimuths, above or below, whose direction scores highest.

    If several have the same score, it is the one nearest to the start.
    """
    start = math.atan2(path[0, 1], path[0, 0])
    cameras = [
        camera_at(start + math.radians(azimuth), math.radians(height))
        for height in (elevation, -elevation)
        for azimuth in sorted(range(-180, 180, 15), key=lambda degrees: abs(degrees - 30))
    ]
    return max(cameras, key=lambda camera: round(shown(camera.toward), 2))


def runs(near: Mask) -> Iterator[tuple[slice, bool]]:
    """Yield the pieces of a curve on the near and the far side; neighbours share a point."""
    ends = np.flatnonzero(near[1:] != near[:-1]) + 1
    bounds = [0, *ends.tolist(), near.size]
    for first, last in pairwise(bounds):
        yield slice(max(first - 1, 0), last), bool(near[first])


def draw_globe(
    axes: Axes, camera: Camera, limits: tuple[float, float], request: PlotRequest
) -> None:
    """Draw outline, equator, axes of space and limiting circles, far sides dashed and paler."""
    look = request.look
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.add_artist(Circle((0, 0), 1, facecolor=look.faint, edgecolor="none", alpha=0.55, zorder=0))
    axes.add_artist(Circle((0, 0), 1, fill=False, ec=look.quiet, lw=points(1.0), zorder=1))
    _draw_circle(axes, camera, math.pi / 2, color=look.quiet, lw=points(0.6))
    _draw_frame(axes, camera, look)
    least, greatest = limits
    blue: dict[str, Any] = {"color": look.lines[0], "lw": points(1.2)}
    unit = " rad" if request.radians else "°"
    low, high = (short_text(tilt * request.per_radian) + unit for tilt in limits)
    if greatest == least:
        _draw_limit(axes, camera, least, f"tilt ϑ = {low}", **blue)
    elif greatest - least < INSEPARABLE:
        _draw_limit(axes, camera, greatest, f"tilt ϑ from {low} to {high}", **blue)
    else:
        _draw_limit(axes, camera, least, f"ϑ min {low}", **blue)
        _draw_limit(axes, camera, greatest, f"ϑ max {high}", **blue | DASH_DOTTED)


def _draw_limit(axes: Axes, camera: Camera, tilt: float, label: str, **line: Any) -> None:
    """Draw the circle of a limiting tilt, or a dot if the circle is a pole."""
    if math.sin(tilt) > 1e-3:
        _draw_circle(axes, camera, tilt, **line)
        axes.plot([], [], label=label, **line)
        return
    pole = np.array([[0.0, 0.0, math.cos(tilt)]])
    alpha = 1.0 if camera.faces(pole)[0] else 0.45
    dot: dict[str, Any] = {"color": line["color"], "ms": points(5), "ls": "none", "zorder": 2}
    axes.plot(*camera.project(pole), "o", alpha=alpha, label=label, **dot)


def _draw_circle(axes: Axes, camera: Camera, tilt: float, **line: Any) -> None:
    """Draw the circle of a tilt, with its far side dashed and paler."""
    around, sine = np.linspace(0.0, 2 * math.pi, 241), math.sin(tilt)
    z = np.full(around.size, math.cos(tilt))
    circle = np.stack([sine * np.cos(around), sine * np.sin(around), z], axis=1)
    x, y = camera.project(circle)
    far: dict[str, Any] = {"alpha": 0.45, "ls": (0, (3, 3)), "zorder": 1}
    for part, near in runs(camera.faces(circle)):
        axes.plot(x[part], y[part], **line | ({"zorder": 2} if near else far))


def _draw_frame(axes: Axes, camera: Camera, look: Look) -> None:
    """Draw the axes of space from the sphere outwards, dashed behind it, and their names."""
    names: dict[tuple[float, float], str] = {}
    in_front = {name for name, side in zip("xyz", camera.toward, strict=True) if side >= 0}
    for name, direction in zip("xyz", np.eye(3), strict=True):
        x, y = (float(length[0]) for length in camera.project(direction[None]))
        length = math.hypot(x, y)
        in_sight = 1.0 if direction @ camera.toward >= 0 else 1.0 / max(length, 1.0 / TIP)
        for first, last, fade in ((1.0, in_sight, True), (in_sight, TIP, False)):
            if last - first > 1e-9:
                dashes: dict[str, Any] = {"alpha": 0.5, "ls": (0, (3, 3))} if fade else {}
                ends = [first * x, last * x], [first * y, last * y]
                layer = 0.5 if fade else 4
                axes.plot(*ends, color=look.quiet, lw=points(1.0), zorder=layer, **dashes)
        out_x, out_y = (x / length, y / length) if length > 0.05 else (0.7, 0.7)
        place = TIP * x + NAME * out_x, TIP * y + NAME * out_y
        near = next((other for other in names if math.dist(place, other) < SAME_PLACE), place)
        names[near] = f"{names[near]}, {name}" if near in names else name
    for (x, y), name in names.items():
        layer, alpha = (4, 1.0) if math.hypot(x, y) > 1 or name in in_front else (0.5, 0.5)
        axes.text(x, y, name, c=look.quiet, ha="center", va="center", zorder=layer, alpha=alpha)
    limits = [(min(-1.06, min(at) - 0.1), max(1.06, max(at) + 0.1)) for at in np.array([*names]).T]
    axes.set(xlim=limits[0], ylim=limits[1])


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
    rim: Array
    """Circle around the lid, shape (2, n)."""
    axle: Array
    """Line from the middle of the lid to the sphere, shape (2, 2)."""
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
    axle = np.stack([middle, axis], axis=1)
    return Cone(np.concatenate(corners), np.concatenate(inks), rim.T, axle, lid_in_sight)
