"""The pictures over time: `angles`, and the periodic parts of spin and precession, `remainders`."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from ..arithmetic.types import Array
from ..errors import NothingToDrawError
from ..motion.regime import Regime
from ..motion.solve import Motion
from .curves import sampled_columns, span, tilt_period
from .kinds import Places, PlotRequest
from .style import points, short_text

NOISE = 1e-13
"""Size of a periodic part (radians) that is mostly rounding error, and drawn as a flat line."""


def angles_picture(motion: Motion, request: PlotRequest, places: Places) -> str:
    """Draw the angles, with mean rates and uncertainties; a vertical axis has no precession."""
    all_is_spin = motion.regime in (Regime.SLEEPING, Regime.HANGING)
    t_max = request.t_max or span(motion, 3)
    t, *angles = sampled_columns(motion, t_max, ["theta", "phi", "psi"]).values()
    stds = [None] * 3 if request.stds is None else request.stds.at(t)
    rates = None, motion.mean_spin_rate, motion.mean_precession_rate
    axes = places((1.0,) * (2 if all_is_spin else 3))
    rows = zip(axes, "ϑφψ", angles, rates, stds, request.look.lines, strict=False)
    for ax, symbol, angle, rate, std, colour in rows:
        ax.set_ylabel(f"{symbol} ({request.angle_unit})")
        ax.plot(t, angle * request.per_radian, color=colour)
        if std is not None:
            ends = [(angle + side * std) * request.per_radian for side in (-1, 1)]
            ax.fill_between(t, *ends, color=colour, alpha=0.3, linewidth=0)
        if rate is not None:
            words = _draw_mean(ax, t, angle, rate, request)
            words += "; spin only: there is no precession" * all_is_spin
            ax.set_title(words, fontsize="small", color=request.look.quiet)
    _finish_time_axes(axes, motion, t, request)
    bands = "; bands: ±1σ" * (request.stds is not None)
    return f"Tilt ϑ, spin φ, precession ψ; dashed: mean rate{bands}"


def _draw_mean(ax: Axes, t: Array, angle: Array, rate: float, request: PlotRequest) -> str:
    """Draw the mean rate as a line on the curve; return the rate and the deviation in words."""
    factor, ink = request.per_radian, request.look.ink
    ax.plot(t, rate * t * factor, color=ink, lw=points(0.9), ls=(0, (4, 3)), zorder=3)
    apart = float(np.abs(angle - rate * t).max()) * factor
    text = f"mean {short_text(rate)} {request.unit('rad/time')}"
    if apart > 1e-9 * factor:
        text += f", greatest deviation {apart:.3g} {request.angle_unit}"
    return text


def remainders_picture(motion: Motion, request: PlotRequest, places: Places) -> str:
    """Draw the periodic parts of spin (6,4) and precession (7,4) about 0.

    Raises NothingToDrawError if the tilt has no period, so that both are 0 or undefined.
    """
    if tilt_period(motion) is None or motion.mean_precession_rate is None:
        reason = "never returns" if motion.regime is Regime.SEPARATRIX else "is constant"
        raise NothingToDrawError(f"no remainders: the tilt {reason} ({motion.regime.value})")
    t, *parts = sampled_columns(motion, request.t_max or span(motion, 2), ["dphi", "dpsi"]).values()
    axes = places((1.0, 1.0))
    for ax, symbol, part, colour in zip(axes, "φψ", parts, request.look.lines[1:], strict=True):
        ax.axhline(0.0, color=request.look.quiet, lw=points(0.9))
        ax.plot(t, part * request.per_radian, color=colour)
        if np.abs(part).max() < NOISE:
            ax.set_ylim(-10 * NOISE * request.per_radian, 10 * NOISE * request.per_radian)
        ax.set_ylabel(f"Δ{symbol} ({request.angle_unit})")
    _finish_time_axes(axes, motion, t, request)
    return "Periodic parts of spin and precession, (6,4), (7,4)"


def _finish_time_axes(axes: Sequence[Axes], motion: Motion, t: Array, request: PlotRequest) -> None:
    """Label the time axis, and mark nutation periods above it and by thin lines in all panels."""
    axes[-1].set_xlabel(request.time_label)
    axes[-1].locator_params(axis="x", nbins=6)  # small steps have long labels
    for ax in axes:
        ax.set_xlim(t[0], t[-1])
    T = tilt_period(motion)
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
