"""The kinds of picture: each takes its curves (see `curves`) and draws them on a panel."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import SubFigure
from matplotlib.ticker import LogLocator, NullLocator

from ..arithmetic.types import Array
from ..motion.record import Regime
from ..motion.solve import Motion
from . import curves
from .key_map import INPUTS, Axis, KeyMap, Watch, default_axes, key_map
from .phase import Cubic, cubic_curve, phase_portrait
from .sphere import draw_path_on_sphere
from .style import Look, mark_start, scale


class Wish(NamedTuple):
    """What was asked for beside the kind."""

    t_max: float | None = None
    radians: bool = False
    key: str = "mean_precession_rate"
    x: Axis | None = None
    y: Axis | None = None
    watch: Watch = lambda rows, _: rows


def draw_sphere(panel: SubFigure, motion: Motion, wish: Wish, style: Look) -> None:
    """The path of the figure axis on the unit sphere."""
    draw_path_on_sphere(panel, motion, wish.t_max, wish.radians, style)


def draw_angles(panel: SubFigure, motion: Motion, wish: Wish, style: Look) -> None:
    """Tilt, spin and precession over time, the mean rates as thin lines."""
    course = curves.angle_curves(motion, wish.t_max or curves.span(motion, 3))
    unit, factor = ("rad", 1.0) if wish.radians else ("deg", 180 / math.pi)
    axes = panel.subplots(3, sharex=True)
    rows = (
        ("ϑ", course.theta, None),
        ("φ", course.phi, course.spin_rate),
        ("ψ", course.psi, course.precession_rate),
    )
    axes[0].set_title("Tilt ϑ, spin φ, precession ψ; thin: mean rates")
    for ax, (symbol, angle, rate), colour in zip(axes, rows, style.lines, strict=True):
        if rate is not None:
            ax.plot(course.t, rate * course.t * factor, color=style.quiet, lw=0.9)
        ax.set_ylabel(f"{symbol} ({unit})")
        if angle is course.psi and motion.regime in (Regime.SLEEPING, Regime.HANGING):
            ax.text(0.5, 0.5, "not defined: all is spin", transform=ax.transAxes, ha="center")
            continue
        ax.plot(course.t, angle * factor, color=colour)
    _finish_time_axes(axes, motion, course.t)
    panel.align_ylabels(axes)


def draw_remainders(panel: SubFigure, motion: Motion, wish: Wish, style: Look) -> None:
    """What is left of spin and precession when the mean rates are taken off."""
    course = curves.remainder_curves(motion, wish.t_max or curves.span(motion, 2))
    unit, factor = ("rad", 1.0) if wish.radians else ("deg", 180 / math.pi)
    axes = panel.subplots(2, sharex=True)
    axes[0].set_title("Spin and precession less their mean growth, (6,4), (7,4)")
    names = "Δφ", "Δψ"
    for ax, remainder, name, colour in zip(
        axes, course.remainders(), names, style.lines[1:], strict=True
    ):
        ax.axhline(0.0, color=style.quiet, lw=0.9)
        ax.plot(course.t, remainder * factor, color=colour)
        ax.set_ylabel(f"{name} ({unit})")
    _finish_time_axes(axes, motion, course.t)
    panel.align_ylabels(axes)


def _finish_time_axes(axes: Any, motion: Motion, t: Array) -> None:
    """Time below; whole nutation periods as ticks above and as thin lines through all panels."""
    axes[-1].set_xlabel("time t")
    axes[-1].locator_params(axis="x", nbins=6)  # small steps have long labels
    axes[-1].set_xlim(t[0], t[-1])
    T = curves.period(motion)
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


def draw_cubic(panel: SubFigure, motion: Motion, wish: Wish, style: Look) -> None:
    """f(u), its roots, and the band in which the motion takes place."""
    cubic = cubic_curve(motion)
    axes = panel.subplots()
    axes.set_title("The cubic f(u) = u̇² (4,9), the motion shaded")
    axes.set(xlabel="u = cos ϑ", ylabel="f(u) (1/time²)")
    axes.set(xlim=(cubic.u[0], cubic.u[-1]), ylim=cubic.heights())
    axes.axhline(0.0, color=style.quiet, lw=0.9)
    low, high = float(motion.u2 or 0), float(motion.u1 or 0)
    inside = (cubic.u >= low) & (cubic.u <= high)
    if low < high:
        axes.axvspan(low, high, color=style.faint, zorder=0)
    axes.fill_between(
        cubic.u, 0.0, cubic.f, where=inside, color=style.lines[0], alpha=0.3, linewidth=0
    )
    axes.plot(cubic.u, cubic.f, color=style.lines[0])
    for pole in (-1, 1):
        if cubic.u[0] <= pole <= cubic.u[-1]:
            axes.axvline(pole, color=style.quiet, lw=1.0, ls=(0, (4, 3)))
    _draw_roots(axes, cubic, style)
    axes.ticklabel_format(axis="x", useOffset=False)
    axes.locator_params(axis="x", nbins=6)


def _draw_roots(axes: Axes, cubic: Cubic, style: Look) -> None:
    """The roots, labelled where the curve leaves room; an arrow to u3 where it is out of view."""
    double = cubic.u1 == cubic.u2
    roots = [("u₁ = u₂" if double else "u₁", cubic.u1, "right", -18)]
    if not double:
        roots.append(("u₂", cubic.u2, "right", 8))
    if cubic.u3 is not None and cubic.u3 <= cubic.u[-1]:
        roots.append(("u₃", cubic.u3, "left", -18))
    elif cubic.u3 is not None:
        text = f"u₃ = {cubic.u3:.6g} →"
        axes.text(0.99, 0.93, text, transform=axes.transAxes, ha="right", color=style.lines[1])
    for name, root, side, height in roots:
        axes.annotate(
            f"{name} = {root:.7g}".replace("-", "−"),
            (root, 0.0),
            (-8 if side == "right" else 8, height),
            textcoords="offset points",
            ha=side,
            size="small",
            color=style.lines[1],
        )
    axes.plot([root[1] for root in roots], [0.0] * len(roots), "o", ms=7, color=style.lines[1])


def draw_phase(panel: SubFigure, motion: Motion, wish: Wish, style: Look) -> None:
    """The nutation in the plane of tilt and tilt rate, and the separatrix."""
    portrait = phase_portrait(motion)
    unit, factor = ("rad", 1.0) if wish.radians else ("deg", 180 / math.pi)
    axes = panel.subplots()
    axes.set_title("Nutation in the phase plane")
    axes.set(xlabel=f"tilt ϑ ({unit})", ylabel="tilt rate ϑ̇ (rad/time)")
    axes.locator_params(axis="x", nbins=5)
    axes.axhline(0.0, color=style.quiet, lw=0.9)
    axes.plot(portrait.theta * factor, portrait.rate, color=style.lines[0], label="this motion")
    mark_start(axes, portrait.start[0] * factor, portrait.start[1], style)
    theta, rate = portrait.separatrix or (np.empty(0), np.empty(0))
    both = np.append(theta, theta[::-1]) * factor, np.append(rate, -rate[::-1])
    dashes = {"lw": 1.4, "ls": (0, (5, 2))} if theta.size else {"lw": 0.0}
    axes.plot(*both, color=style.lines[1], label=portrait.why, **dashes)
    axes.ticklabel_format(axis="x", useOffset=False)
    axes.margins(0.06)
    panel.legend(loc="outside lower center", ncols=3, fontsize="small")


def draw_map(panel: SubFigure, motion: Motion, wish: Wish, style: Look) -> None:
    """A key of the record over two inputs, with the sleeping threshold and the scene itself."""
    usual = default_axes(motion.top)
    chart = key_map(motion, wish.key, wish.x or usual[0], wish.y or usual[1], wish.watch)
    axes = panel.subplots()
    axes.set_title(wish.key)
    axes.set(xlabel=INPUTS[chart.x.name], ylabel=INPUTS[chart.y.name])
    axes.set_facecolor(style.faint)  # where there is no such number
    x, y, values = chart.x.values, chart.y.values, np.ma.masked_invalid(chart.values)
    logarithmic = _is_logarithmic(chart.values)
    norm = LogNorm() if logarithmic else Normalize()
    mesh = axes.pcolormesh(x, y, values, cmap=scale(style), norm=norm, rasterized=True)
    bar = panel.colorbar(mesh, ax=axes, aspect=28)
    bar.outline.set_visible(False)
    if logarithmic:
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        bar.ax.yaxis.set_major_formatter("{x:g}")
        bar.ax.yaxis.set_minor_locator(NullLocator())
    if chart.sleeping.min() < 1.0 < chart.sleeping.max():
        axes.contour(x, y, chart.sleeping, [1.0], colors=style.paper, linewidths=3.2)
        axes.contour(x, y, chart.sleeping, [1.0], colors=style.ink, linewidths=1.6)
        axes.plot([], [], color=style.ink, lw=1.6, label="sleeping threshold, C²r0² = 4Amgs")
    _mark_own(axes, motion, chart, style)
    if axes.get_legend_handles_labels()[0]:
        panel.legend(loc="outside lower center", ncols=2, fontsize="small")


def _mark_own(axes: Axes, motion: Motion, chart: KeyMap, style: Look) -> None:
    inputs = motion.top.inputs()
    inputs["theta0"] = inputs["theta0_deg"]
    own = [float(inputs[axis.name]) for axis in (chart.x, chart.y)]
    pairs = zip(own, (chart.x, chart.y), strict=True)
    if all(axis.values[0] <= value <= axis.values[-1] for value, axis in pairs):
        mark_start(axes, own[0], own[1], style, "this scene")


def _is_logarithmic(values: Array) -> bool:
    """Whether all values are positive and spread over more than a factor of 30."""
    known = values[np.isfinite(values)]
    return bool(known.size and known.min() > 0 and known.max() > 30 * known.min())


Draw = Callable[[SubFigure, Motion, Wish, Look], None]

KINDS: dict[str, Draw] = {
    "sphere": draw_sphere,
    "angles": draw_angles,
    "remainders": draw_remainders,
    "cubic": draw_cubic,
    "phase": draw_phase,
    "map": draw_map,
}
