"""The globe on which pictures and films show a motion: outline, axes of space, limiting circles."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from ..arithmetic.types import Array
from .camera import Camera, runs
from .kinds import PlotRequest
from .style import Look, points, short_text

TIP, NAME = 1.24, 0.1
"""Length of the axes of space in radii of the globe, and distance of their names from the tips."""
DASH_DOTTED = {"ls": (0, (7, 2, 1, 2))}
"""Style of the circle of the greatest tilt."""
SAME_PLACE = 0.13
"""Distance at which the names of two axes would touch, so that they are joined."""
INSEPARABLE = math.radians(0.8)
"""Difference of tilt below which two circles are one line on the globe."""


def draw_globe(
    axes: Axes, camera: Camera, limits: tuple[float, float], request: PlotRequest, look: Look
) -> None:
    """Draw outline, equator, axes of space and limiting circles, far sides dashed and paler."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.add_artist(Circle((0, 0), 1, facecolor=look.faint, edgecolor="none", alpha=0.55, zorder=0))
    axes.add_artist(Circle((0, 0), 1, fill=False, ec=look.quiet, lw=points(1.0), zorder=1))
    _draw_circle(axes, camera, math.pi / 2, color=look.quiet, lw=points(0.6))
    _draw_frame(axes, camera, look)
    least, greatest = limits
    blue: dict[str, Any] = {"color": look.lines[0], "lw": points(1.2)}
    low, high = (_tilt_text(tilt, request.radians) for tilt in limits)
    if greatest == least:
        _draw_limit(axes, camera, least, f"tilt ϑ = {low}", **blue)
    elif greatest - least < INSEPARABLE:
        _draw_limit(axes, camera, greatest, f"tilt ϑ from {low} to {high}", **blue)
    else:
        _draw_limit(axes, camera, least, f"ϑ min {low}", **blue)
        _draw_limit(axes, camera, greatest, f"ϑ max {high}", **blue | DASH_DOTTED)


def _tilt_text(tilt: float, radians: bool) -> str:
    return f"{short_text(tilt)} rad" if radians else f"{short_text(math.degrees(tilt))}°"


def _draw_limit(axes: Axes, camera: Camera, tilt: float, label: str, **line: Any) -> None:
    """Draw the circle of a limiting tilt, or a dot if the circle is a pole."""
    if math.sin(tilt) > 1e-3:
        _draw_circle(axes, camera, tilt, **line)
        axes.plot([], [], label=label, **line)
        return
    pole = np.array([[0.0, 0.0, math.cos(tilt)]])
    dot: dict[str, Any] = {"color": line["color"], "ms": points(5), "ls": "none", "label": label}
    axes.plot(
        *camera.project(pole), "o", alpha=1.0 if camera.faces(pole)[0] else 0.45, zorder=2, **dot
    )


def _draw_circle(axes: Axes, camera: Camera, tilt: float, **line: Any) -> None:
    """Draw the circle of a tilt, with its far side dashed and paler."""
    circle = _parallel(tilt)
    x, y = camera.project(circle)
    for part, near in runs(camera.faces(circle)):
        fade: dict[str, Any] = (
            {"zorder": 2} if near else {"alpha": 0.45, "ls": (0, (3, 3)), "zorder": 1}
        )
        axes.plot(x[part], y[part], **(line | fade))


def _parallel(tilt: float) -> Array:
    """Return the circle of a tilt (radians) on the unit sphere, in shape (n, 3)."""
    around = np.linspace(0.0, 2 * math.pi, 241)
    sine, cosine = math.sin(tilt), math.cos(tilt)
    return np.stack([sine * np.cos(around), sine * np.sin(around), 0 * around + cosine], axis=1)


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
        near = [other for other in names if math.dist(place, other) < SAME_PLACE]
        if near:
            names[near[0]] += f", {name}"
        else:
            names[place] = name
    for (x, y), name in names.items():
        layer, alpha = (4, 1.0) if math.hypot(x, y) > 1 or name in in_front else (0.5, 0.5)
        axes.text(x, y, name, c=look.quiet, ha="center", va="center", zorder=layer, alpha=alpha)
    across, upward = np.array(list(names)).T
    axes.set(xlim=_room(across), ylim=_room(upward))


def _room(names: Array) -> tuple[float, float]:
    """Return the limits of an axis of the page that shows the globe and the names around it."""
    return min(-1.06, float(names.min()) - 0.1), max(1.06, float(names.max()) + 0.1)
