"""The picture `map`: the drawing of a key of the record over a grid of two inputs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import SubFigure
from matplotlib.ticker import LogLocator, NullLocator

from ..arithmetic.types import Array
from ..motion.record import KEYS
from ..motion.solve import Motion
from .key_map import INPUTS, OUTERMOST, KeyMap, default_ranges, key_map
from .request import InputRange, PlotRequest
from .style import Look, head, mark_start, points, scale


def draw(panel: SubFigure, motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw a key over two inputs, with its contours, the sleeping threshold and the scene."""
    head(panel, _title(request))
    axes = panel.subplots()
    _draw_map(axes, motion, request, look)
    if axes.get_legend_handles_labels()[0]:
        panel.legend(loc="outside lower left", fontsize="small")


def draw_on(places: Sequence[Axes], motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw the picture on one axes, with the bar of its colours and without the legend."""
    places[0].set_title(_title(request))
    _draw_map(places[0], motion, request, look)


def _title(request: PlotRequest) -> str:
    """Return what the key is; nothing for a key that is not known, which is refused later."""
    key = KEYS.get(request.key.replace("_rad", "_deg"))
    return f"{key.group}: {key.meaning}, {key.symbol} {key.equation}" if key else ""


def _draw_map(axes: Axes, motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw cells, contours, threshold and scene."""
    usual = default_ranges(motion.top, radians=request.radians)
    x, y = request.x or usual[0], request.y or usual[1]
    chart = key_map(motion, request.key, x, y, request.progress, radians=request.radians)
    unit = request.unit_of(KEYS[chart.key.replace("_rad", "_deg")])
    axes.set(xlabel=_label(x.name, request), ylabel=_label(y.name, request))
    axes.set_facecolor(look.faint)  # where there is no such number
    axes.set(xscale=_scale_name(x), yscale=_scale_name(y))
    bar = _draw_cells(axes, chart, request.limits, look)
    bar.set_label(f"{chart.key} ({unit})" if unit else chart.key)
    _draw_contours(axes, chart, bar, look)
    if not np.isfinite(chart.values).all():
        axes.fill([], [], color=look.faint, label="has no such number")
    if chart.sleeping.min() < 1.0 < chart.sleeping.max():
        for colour, width in ((look.paper, 3.2), (look.ink, 1.6)):
            how: dict[str, Any] = {"colors": colour, "linewidths": points(width)}
            axes.contour(x.values, y.values, chart.sleeping, [1.0], **how)
        label = "sleeping threshold, C²r₀² = 4Amgs: faster, an upright top is stable"
        axes.plot([], [], color=look.ink, lw=points(1.6), label=label)
    _mark_own(axes, motion, chart, request.radians, look)


def colour_limits(values: Array) -> tuple[float, float]:
    """Return the ends of the colours: all values but the outermost ones, which may be peaks."""
    known = values[np.isfinite(values)]
    if not known.size:
        return 0.0, 1.0
    low, high = (float(x) for x in np.percentile(known, [OUTERMOST, 100 - OUTERMOST]))
    if not low < high:
        low, high = float(known.min()), float(known.max())
    return (low, high) if low < high else (low - 0.5 * (abs(low) or 1), low + 0.5 * (abs(low) or 1))


def _draw_cells(
    axes: Axes, chart: KeyMap, limits: tuple[float, float] | None, look: Look
) -> Colorbar:
    """Draw the values as coloured cells, with the bar that explains the colours."""
    low, high = limits or colour_limits(chart.values)
    logarithmic = low > 0 and high > 30 * low
    mesh = axes.pcolormesh(
        _edges(chart.x),
        _edges(chart.y),
        np.ma.masked_invalid(chart.values),
        cmap=scale(look),
        norm=LogNorm(low, high) if logarithmic else Normalize(low, high),
        rasterized=True,
    )
    known = chart.values[np.isfinite(chart.values)]
    below, above = bool((known < low).any()), bool((known > high).any())
    ends = {(False, False): "neither", (True, False): "min", (False, True): "max"}
    bar = axes.figure.colorbar(mesh, ax=axes, aspect=28, extend=ends.get((below, above), "both"))
    bar.outline.set_visible(False)
    if logarithmic:
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        bar.ax.yaxis.set_major_formatter("{x:g}")
        bar.ax.yaxis.set_minor_locator(NullLocator())
    return bar


def _draw_contours(axes: Axes, chart: KeyMap, bar: Colorbar, look: Look) -> None:
    """Draw lines of equal value at the numbers of the bar, light on dark and dark on light."""
    known = chart.values[np.isfinite(chart.values)]
    if not known.size:
        return
    ends = bar.norm.vmin or 0.0, bar.norm.vmax or 0.0
    low, high = max(float(known.min()), ends[0]), min(float(known.max()), ends[1])
    levels = [float(level) for level in bar.get_ticks() if low < level < high]
    if not levels:
        return
    colours = np.asarray(scale(look)(np.asarray(bar.norm(levels))))
    brightness = colours[:, :3] @ np.array([0.299, 0.587, 0.114])
    inks = ["#ffffff" if light < 0.5 else "#1a1a1a" for light in brightness]
    values = np.ma.masked_invalid(chart.values)
    lines = axes.contour(
        chart.x.values, chart.y.values, values, levels, colors=inks, linewidths=points(0.8)
    )
    axes.clabel(lines, fontsize="small", fmt="%g")


def _label(name: str, request: PlotRequest) -> str:
    """Return what an input is, with its unit where there is one."""
    key = KEYS["theta0_deg" if name == "theta0" else name]
    unit = request.unit_of(key)
    known = unit != key.unit or ("len" not in unit and "mass" not in unit)
    return f"{INPUTS[name]} ({unit})" if known else INPUTS[name]


def _scale_name(axis: InputRange) -> str:
    return "log" if axis.logarithmic else "linear"


def _edges(axis: InputRange) -> Array:
    """Return the borders of the cells, half way between their values."""
    values = np.log(axis.values) if axis.logarithmic else axis.values
    middle = (values[1:] + values[:-1]) / 2
    ends = [values[0] - (middle[0] - values[0])], [values[-1] + (values[-1] - middle[-1])]
    edges: Array = np.concatenate([ends[0], middle, ends[1]])
    return np.exp(edges) if axis.logarithmic else edges


def _mark_own(axes: Axes, motion: Motion, chart: KeyMap, radians: bool, look: Look) -> None:
    """Mark the scene itself where it is on the map."""
    inputs = {
        name.partition("_")[0]: value for name, value in motion.top.inputs(radians=radians).items()
    }
    own = [float(inputs[axis.name]) for axis in (chart.x, chart.y)]
    pairs = zip(own, (chart.x, chart.y), strict=True)
    if all(axis.values[0] <= value <= axis.values[-1] for value, axis in pairs):
        mark_start(axes, own[0], own[1], look, "this scene")
