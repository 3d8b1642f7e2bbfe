"""The picture `sphere`: the path of the figure axis on the unit sphere."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import SubFigure

from ..arithmetic.types import Array
from ..motion.solve import Motion
from .angles import angle_curves
from .curves import highest_times, phase_times, refined, span, turn_span
from .motion_facts import axis_at
from .request import PlotRequest
from .style import Look, mark_start, scale
from .view import Near, View, best_view, parallel, runs

NARROW = math.radians(6.0)
"""A band of tilts that a circle on the globe hides: it is shown magnified as well."""

PIECES = 160
"""Steps of the colour along a path."""


class AxisPath(NamedTuple):
    """The path of the figure axis on the unit sphere."""

    t: Array
    axis: Array
    """Unit vectors, shape (n, 3); z is up."""
    least: float
    """Least tilt (radians), a circle that the path touches."""
    greatest: float
    """Greatest tilt (radians), a circle that the path touches."""
    path: str | None
    """`cusped`, `looping`, `wavy`, or None where the tilt does not swing."""
    highest: Array
    """The axis where it is highest, shape (m, 3): the cusps of a cusped path."""


def axis_path(motion: Motion, t_max: float) -> AxisPath:
    """Return the path from 0 to t_max."""

    def axis(t: Array) -> Array:
        return axis_at(motion, t)

    t = refined(phase_times(motion, t_max), axis)
    least, greatest = motion.theta_min_deg, motion.theta_max_deg
    assert least is not None
    assert greatest is not None
    highest = axis(highest_times(motion, t_max))
    return AxisPath(t, axis(t), math.radians(least), math.radians(greatest), motion.path, highest)


def draw(panel: SubFigure, motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw the globe with the path on it, and under it a piece of a narrow path, magnified."""
    path = axis_path(motion, request.t_max or turn_span(motion))
    narrow = 0 < path.greatest - path.least < NARROW
    axes = panel.subplots(2, height_ratios=(3.4, 1)) if narrow else [panel.subplots()]
    lines = _draw_sphere(axes[0], path, motion, request, look)
    bar = panel.colorbar(lines, ax=axes[0], shrink=0.7, pad=0.02, aspect=28)
    bar.outline.set_visible(False)
    bar.set_label("time t")
    if narrow:
        _draw_magnified(axes[1], motion, path, request, look)


def draw_on(places: Sequence[Axes], motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw the globe with the path on one axes, without a bar for the colours of time."""
    path = axis_path(motion, request.t_max or turn_span(motion))
    _draw_sphere(places[0], path, motion, request, look)


def _draw_sphere(
    axes: Axes, path: AxisPath, motion: Motion, request: PlotRequest, look: Look
) -> LineCollection:
    """Draw the globe with the path, and return the path on the near side, coloured by time."""
    view = best_view(path.axis)
    axes.set_title(f"Figure axis on the unit sphere: {path.path or motion.regime.value}")
    draw_globe(axes, view, path, request, look)
    return _draw_path(axes, view, path, look)


def draw_globe(axes: Axes, view: View, path: AxisPath, request: PlotRequest, look: Look) -> None:
    """Draw outline, equator, vertical and the limiting circles; far sides dashed and paler."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set(xlim=(-1.06, 1.06), ylim=(-1.06, 1.24))
    outline = np.linspace(0.0, 2 * math.pi, 361)
    axes.fill(np.cos(outline), np.sin(outline), facecolor=look.faint, alpha=0.55, zorder=0)
    axes.plot(np.cos(outline), np.sin(outline), color=look.quiet, lw=1.0, zorder=1)
    _draw_circle(axes, view, math.pi / 2, color=look.quiet, lw=0.6)
    for tilt, colour, label in (
        (path.least, look.lines[0], "ϑ min"),
        (path.greatest, look.lines[1], "ϑ max"),
    ):
        _draw_circle(axes, view, tilt, color=colour, lw=1.2)
        angle = f"{tilt:.4g} rad" if request.radians else f"{math.degrees(tilt):.4g}°"
        axes.plot([], [], color=colour, lw=1.2, label=f"{label} {angle}")
    hidden = view.toward[2] < 0
    feet = np.array([[0.0, 0.0, 1 / view.up[2] if hidden else 1.0], [0.0, 0.0, 1.32]])
    x, y = view.project(feet)
    axes.plot(x, y, color=look.quiet, lw=1.0, zorder=4)
    axes.annotate("z", (x[1], y[1]), (5, -8), textcoords="offset points", color=look.quiet)


def _draw_circle(axes: Axes, view: View, tilt: float, **line: Any) -> None:
    """Draw the circle of a tilt, its far side dashed and paler."""
    circle = parallel(tilt)
    x, y = view.project(circle)
    for part, near in runs(view.faces(circle)):
        fade: dict[str, Any] = (
            {"zorder": 2} if near else {"alpha": 0.45, "ls": (0, (3, 3)), "zorder": 1}
        )
        axes.plot(x[part], y[part], **(line | fade))


def _draw_path(axes: Axes, view: View, path: AxisPath, look: Look) -> LineCollection:
    """Draw the path, coloured by time and paler on the far side, with its start and a legend."""
    x, y = view.project(path.axis)
    near = view.faces(path.axis)
    colours = scale(look)
    for side, alpha, width in ((False, 0.35, 1.2), (True, 1.0, 2.2)):
        pieces, times = _pieces(path.t, np.stack([x, y], axis=1), near, side)
        lines = LineCollection(
            pieces, cmap=colours, linewidths=width, alpha=alpha, capstyle="round"
        )
        lines.set_array(times)
        lines.set_clim(path.t[0], path.t[-1])
        lines.set_zorder(3 if side else 1)
        axes.add_collection(lines)
    mark_start(axes, x[0], y[0], look)
    axes.legend(loc="lower left", fontsize="small", borderaxespad=0, handlelength=1.4)
    lines.set_alpha(None)
    return lines


def _pieces(t: Array, points: Array, near: Near, side: bool) -> tuple[list[Array], Array]:
    """Return the parts of the curve on one side, cut into pieces of one colour, and their times."""
    step = max((t[-1] - t[0]) / PIECES, 1e-300)
    pieces, times = [], []
    for part, on_near in runs(near):
        if on_near is not side:
            continue
        cuts = np.flatnonzero(np.diff(np.floor((t[part] - t[0]) / step))) + 1
        bounds = [0, *cuts.tolist(), t[part].size - 1]
        for first, last in pairwise(bounds):
            if last > first:
                pieces.append(points[part][first : last + 1])
                times.append((t[part][first] + t[part][last]) / 2)
    return pieces, np.array(times)


def _draw_magnified(
    axes: Axes, motion: Motion, path: AxisPath, request: PlotRequest, look: Look
) -> None:
    """Draw two nods unrolled; a degree of precession is as long as it is on the sphere."""
    nods = angle_curves(motion, min(span(motion, 2), path.t[-1]))
    x, y = nods.psi * request.per_radian, nods.theta * request.per_radian
    axes.set_aspect(1 / math.sin(path.greatest), adjustable="datalim")
    axes.plot(x, y, color=scale(look)(0.0))
    mark_start(axes, x[0], y[0], look)
    axes.set_title("the first two nods, magnified", fontsize="medium")
    unit = request.angle_unit
    axes.set(xlabel=f"precession ψ ({unit})", ylabel=f"tilt ϑ ({unit})")
    axes.ticklabel_format(useOffset=False)
    axes.locator_params(axis="y", nbins=4)
    axes.margins(y=0.25)
    axes.invert_yaxis()
