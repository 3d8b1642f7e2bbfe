"""The picture `angles`: tilt, spin and precession over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import SubFigure

from ..arithmetic.types import Array
from ..motion.regime import Regime
from ..motion.solve import Motion
from .curves import phase_times, refined, span
from .motion_facts import nutation_period
from .request import PlotRequest
from .style import Look, head, number_text, points

TITLE = "Tilt ϑ, spin φ, precession ψ; dashed: mean growth"


class AngleCurves(NamedTuple):
    """Tilt, spin and precession (radians) over time."""

    t: Array
    theta: Array
    phi: Array
    psi: Array


def angle_curves(motion: Motion, t_max: float) -> AngleCurves:
    """Return the three angles from 0 to t_max."""

    def angles(t: Array) -> Array:
        return np.stack(motion.angles(t), axis=1)

    t = refined(phase_times(motion, t_max), angles)
    return AngleCurves(t, *motion.angles(t))


def draw(panel: SubFigure, motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw tilt, spin and precession over time, and their mean growth."""
    axes = panel.subplots(2 if _all_is_spin(motion) else 3, sharex=True)
    head(panel, _title(request))
    _draw_curves(axes, motion, request, look)
    panel.align_ylabels(axes)


def draw_on(places: Sequence[Axes], motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw the picture on three axes, which share the time."""
    places[0].set_title(_title(request))
    last = 2 if _all_is_spin(motion) else 3
    _draw_curves(places[:last], motion, request, look)
    for empty in places[last:]:
        empty.set_axis_off()


def _title(request: PlotRequest) -> str:
    return TITLE if request.stds is None else f"{TITLE}; bands: ±1σ"


def _all_is_spin(motion: Motion) -> bool:
    """Return whether the axis stays vertical, so that there is no precession."""
    return motion.regime in (Regime.SLEEPING, Regime.HANGING)


def _draw_curves(axes: Sequence[Axes], motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw an angle on each of the axes."""
    course = angle_curves(motion, request.t_max or span(motion, 3))
    stds = [None] * 3 if request.stds is None else request.stds.at(course.t)
    rows = [
        ("ϑ", course.theta, None, stds[0]),
        ("φ", course.phi, motion.mean_spin_rate, stds[1]),
        ("ψ", course.psi, motion.mean_precession_rate, stds[2]),
    ]
    for ax, (symbol, angle, rate, std), colour in zip(axes, rows, look.lines, strict=False):
        ax.set_ylabel(f"{symbol} ({request.angle_unit})")
        ax.plot(course.t, angle * request.per_radian, color=colour)
        if std is not None:
            ends = [(angle + side * std) * request.per_radian for side in (-1, 1)]
            ax.fill_between(course.t, *ends, color=colour, alpha=0.3, linewidth=0)
        if rate is not None:
            mean = _draw_mean(ax, course.t, angle, rate, request=request, look=look)
            note = "; all is spin: there is no precession" * _all_is_spin(motion)
            ax.set_title(mean + note, fontsize="small", color=look.quiet)
    finish_time_axes(axes, motion, course.t, request)


def _draw_mean(
    ax: Axes, t: Array, angle: Array, rate: float, *, request: PlotRequest, look: Look
) -> str:
    """Draw the mean growth of an angle upon its curve, and return in words what a line hides."""
    mean: dict[str, Any] = {"lw": points(0.9), "ls": (0, (4, 3)), "zorder": 3}
    ax.plot(t, rate * t * request.per_radian, color=look.ink, **mean)
    apart = float(np.abs(angle - rate * t).max()) * request.per_radian
    text = f"mean {number_text(float(f'{rate:.4g}'))} {request.unit('rad/time')}"
    if apart > 1e-9 * request.per_radian:
        text += f", from which it departs by {apart:.3g} {request.angle_unit} at most"
    return text


def finish_time_axes(axes: Sequence[Axes], motion: Motion, t: Array, request: PlotRequest) -> None:
    """Write the time below; mark nutation periods above and by thin lines through all panels."""
    axes[-1].set_xlabel(request.time_label)
    axes[-1].locator_params(axis="x", nbins=6)  # small steps have long labels
    for ax in axes:
        ax.set_xlim(t[0], t[-1])
    T = nutation_period(motion)
    if not T or t[-1] < T * (1 - 1e-9):
        return
    whole = np.arange(1, round(t[-1] / T + 0.499999) + 1)
    step = max(1, math.ceil(whole.size / 8))
    marks = T * whole[step - 1 :: step]
    marks = marks[marks <= t[-1] * (1 + 1e-9)]
    for ax in axes:
        for mark in marks:
            ax.axvline(mark, color="0.5", lw=points(0.6), alpha=0.5, zorder=0)
    above = axes[0].secondary_xaxis("top")
    above.set_xticks(marks, [f"{round(mark / T)} T".removeprefix("1 ") for mark in marks])
    above.tick_params(labelsize="small", length=3, pad=1)
    above.spines["top"].set_visible(False)
