"""The picture `angles`: tilt, spin and precession over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import SubFigure

from ..arithmetic.types import Array
from ..motion.regime import Regime
from ..motion.solve import Motion
from .curves import phase_times, refined, span
from .motion_facts import nutation_period
from .request import PlotRequest
from .style import Look


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
    """Draw tilt, spin and precession over time, and the mean rates as thin lines."""
    axes = panel.subplots(3, sharex=True)
    draw_on(axes, motion, request, look)
    panel.align_ylabels(axes)


def draw_on(places: Sequence[Axes], motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw the picture on three axes, which share the time."""
    course = angle_curves(motion, request.t_max or span(motion, 3))
    rows = (
        ("ϑ", course.theta, None),
        ("φ", course.phi, motion.mean_spin_rate),
        ("ψ", course.psi, motion.mean_precession_rate),
    )
    places[0].set_title("Tilt ϑ, spin φ, precession ψ; thin: mean rates")
    for ax, (symbol, angle, rate), colour in zip(places, rows, look.lines, strict=True):
        ax.set_ylabel(f"{symbol} ({request.angle_unit})")
        if angle is course.psi and motion.regime in (Regime.SLEEPING, Regime.HANGING):
            ax.text(0.5, 0.5, "not defined: all is spin", transform=ax.transAxes, ha="center")
            ax.set_yticks([])
            continue
        if rate is not None:
            ax.plot(course.t, rate * course.t * request.per_radian, color=look.quiet, lw=0.9)
        ax.plot(course.t, angle * request.per_radian, color=colour)
    finish_time_axes(places, motion, course.t, request)


def finish_time_axes(axes: Sequence[Axes], motion: Motion, t: Array, request: PlotRequest) -> None:
    """Write the time below; mark nutation periods above and by thin lines through all panels."""
    unit = request.unit("time")
    axes[-1].set_xlabel("time t" if unit == "time" else f"time t ({unit})")
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
            ax.axvline(mark, color="0.5", lw=0.6, alpha=0.5, zorder=0)
    above = axes[0].secondary_xaxis("top")
    above.set_xticks(marks, [f"{round(mark / T)} T".removeprefix("1 ") for mark in marks])
    above.tick_params(labelsize="small", length=3, pad=1)
    above.spines["top"].set_visible(False)
