"""The picture `sphere`: the path of the figure axis on the unit sphere."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from ..arithmetic.types import Array, Mask
from ..motion.solve import Motion
from .curves import motion_in_words, sampled_columns, span, sphere_span, tilt_period
from .globe import Camera, best_camera, camera_at, draw_globe, runs
from .kinds import Places, PlotRequest
from .style import Look, mark_start, points, scale

NARROW = math.radians(6.0)
"""Range of tilts (radians) so narrow that a circle on the globe hides it: it is also magnified."""

PERIODS_MAGNIFIED = 3
"""Number of nutation periods of a narrow path in the magnified view."""

PIECES = 160
"""Number of colour steps along a path."""

ARROWS = 0.1, 0.28, 0.46, 0.64, 0.82
"""Places of the arrowheads that show the direction of a path, as shares of its length."""

USUAL_PERIODS = 6
"""Nutation periods up to which a path has its full width; longer paths have finer lines."""


class AxisPath(NamedTuple):
    """The path of the figure axis on the unit sphere."""

    t: Array
    axis: Array
    """Unit vectors, shape (n, 3); z is up."""
    least: float
    """Least tilt (radians), a circle that the path touches."""
    greatest: float
    """Greatest tilt (radians), a circle that the path touches."""

    @property
    def moves(self) -> bool:
        """Whether the axis moves at all."""
        return bool(np.ptp(self.axis, axis=0).max() > 1e-12)


def axis_path(motion: Motion, t_max: float) -> AxisPath:
    """Return the path from 0 to t_max."""
    t, *axis = sampled_columns(motion, t_max, ["axis"]).values()
    least, greatest = motion.theta_min_deg, motion.theta_max_deg
    assert least is not None
    assert greatest is not None
    return AxisPath(t, np.stack(axis, axis=1), math.radians(least), math.radians(greatest))


def sphere_picture(motion: Motion, request: PlotRequest, places: Places) -> str:
    """Draw the globe with the path on it, and the colour bar.

    On a page, a narrow path has a second `Axes` with a magnified piece.
    """
    path = axis_path(motion, request.t_max or sphere_span(motion))
    narrow = 0 < path.greatest - path.least < NARROW
    axes = places((3.4, 1.0) if narrow else (1.0,))
    camera = camera_at(*request.camera) if request.camera else best_camera(path.axis)
    draw_globe(axes[0], camera, (path.least, path.greatest), request)
    lines = _draw_path(axes[0], camera, path, motion, request.look)
    axes[0].legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=3, fontsize="small")
    for below in axes[1:]:
        _draw_magnified(below, motion, path, request)
    if path.moves:
        bar = axes[0].figure.colorbar(
            lines, ax=list(axes), shrink=0.7, pad=0.02, aspect=28, panchor=(0.5, 0.5)
        )
        bar.outline.set_visible(False)
        bar.set_label(request.time_label)
    return f"Figure axis on the unit sphere: {motion_in_words(motion)}"


def _draw_path(
    axes: Axes, camera: Camera, path: AxisPath, motion: Motion, look: Look
) -> LineCollection:
    """Draw the path, coloured by time, paler on the far side, with its start and direction.

    Returns the lines that the colour bar explains.
    """
    x, y = camera.project(path.axis)
    near = camera.faces(path.axis)
    T = tilt_period(motion)
    fineness = max(0.35, math.sqrt(min(1.0, USUAL_PERIODS * T / path.t[-1]))) if T else 1.0
    for side, alpha, width, layer in ((False, 0.35, 1.2, 1), (True, 1.0, 2.2, 3)):
        lines = _coloured(path.t, np.stack([x, y], axis=1), near, look, side=side)
        lines.set(alpha=alpha, linewidths=points(width * fineness), zorder=layer)
        axes.add_collection(lines)
    mark_start(axes, x[0], y[0], look, "start" if path.moves else "the axis stays here")
    _draw_direction(axes, camera, path, motion, look)
    lines.set_alpha(None)
    return lines


def _coloured(t: Array, places: Array, near: Mask, look: Look, *, side: bool) -> LineCollection:
    """Return the parts of a curve on one side of the globe, in pieces coloured by time."""
    step = max((t[-1] - t[0]) / PIECES, 1e-300)
    pieces, times = [], []
    for part, on_near in runs(near):
        colour_changes = np.flatnonzero(np.diff(np.floor((t[part] - t[0]) / step))) + 1
        for first, last in pairwise([0, *colour_changes.tolist(), t[part].size - 1]):
            if last > first and on_near is side:
                pieces.append(places[part][first : last + 1])
                times.append((t[part][first] + t[part][last]) / 2)
    lines = LineCollection(pieces, cmap=scale(look), capstyle="round")
    lines.set_array(np.array(times))
    lines.set_clim(t[0], t[-1])
    return lines


def _draw_direction(axes: Axes, camera: Camera, path: AxisPath, motion: Motion, look: Look) -> None:
    """Draw arrowheads along the near side of a path; for a tiny path, an arc beside it."""
    course = path.axis
    shown = np.stack(camera.project(course), axis=1)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(shown, axis=0), axis=1))])
    whole, colour = float(along[-1]), scale(look)
    if whole < 0.3 and motion.mean_precession_rate:
        tilt, start = (path.least + path.greatest) / 2, math.atan2(course[0, 1], course[0, 0])
        turn = start + math.copysign(1.0, motion.mean_precession_rate) * np.linspace(0.15, 0.8, 40)
        arc = [math.sin(tilt) * np.cos(turn), math.sin(tilt) * np.sin(turn)]
        course = np.stack([*arc, np.full(turn.size, math.cos(tilt))], axis=1)
        x, y = camera.project(course)
        axes.plot(x, y, color=look.ink, lw=points(1.6), zorder=3)
        _arrowhead(axes, (x[-2], y[-2]), (x[-1], y[-1]), look.ink)
    elif whole >= 0.3:
        near = camera.faces(course)
        for part in ARROWS:
            last = int(np.searchsorted(along, part * whole))
            first = int(np.searchsorted(along, part * whole - 0.02))
            if first < last and near[first : last + 1].all():
                time = (path.t[last] - path.t[0]) / (path.t[-1] - path.t[0])
                _arrowhead(axes, shown[last - 1], shown[last], colour(float(time)))


def _arrowhead(axes: Axes, first: object, last: object, colour: object) -> None:
    """Draw an arrowhead at the second of two points."""
    how = {"arrowstyle": "-|>,head_length=0.5,head_width=0.28", "mutation_scale": points(13)}
    how |= {"color": colour, "linewidth": 0, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", last, first, arrowprops=how, zorder=5)  # type: ignore[arg-type]


def _draw_magnified(axes: Axes, motion: Motion, path: AxisPath, request: PlotRequest) -> None:
    """Draw some nutations unrolled, coloured as on the globe.

    A degree of precession has the same length as on the sphere.
    """
    until = min(span(motion, PERIODS_MAGNIFIED), float(path.t[-1]))
    t, psi, theta = sampled_columns(motion, until, ["psi", "theta"]).values()
    places = np.stack([psi, theta], axis=1) * request.per_radian
    axes.set_aspect(1 / math.sin(path.greatest), adjustable="datalim")
    lines = _coloured(t, places, np.ones(t.size, bool), request.look, side=True)
    lines.set(clim=(path.t[0], path.t[-1]), linewidths=points(2.0))
    axes.add_collection(lines)
    axes.autoscale_view()
    mark_start(axes, places[0, 0], places[0, 1], request.look)
    whole = t[-1] == path.t[-1]
    axes.set_title("the same path, magnified" if whole else "its beginning, magnified")
    unit = request.angle_unit
    axes.set(xlabel=f"precession ψ ({unit})", ylabel=f"tilt ϑ ({unit})")
    axes.ticklabel_format(useOffset=False)
    axes.locator_params(axis="y", nbins=4)
    axes.margins(y=0.25)
    axes.invert_yaxis()
