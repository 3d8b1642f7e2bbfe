"""The picture `map`: a key of the record over a grid of two inputs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, LogNorm, Normalize
from matplotlib.ticker import LogLocator, MaxNLocator

from ..arithmetic.types import Array
from ..errors import LagtopError, NothingToDrawError
from ..inputs.input_keys import DECLARED, NINE
from ..inputs.names import check_names
from ..inputs.top import Top
from ..motion.quantity import degree_name
from ..motion.record import NUMBER_KEYS, number_key, requested_keys
from ..motion.solve import Motion
from ..sweep.records import sweep
from .options import Axis, MapOptions, Options, mark_start
from .style import scale

WORDS = {"regime": "Regime of the motion", "path": "Path of the axis"}
"""Keys whose values are words, with their titles."""
REGIONS = "#9cc9ec #f3c69a #a9dcc3 #d9c3ea #f0e08c #e8a9a4 #c9ced4".split()
"""Colours of words, in the order in which they appear."""
MOST_CELLS, MOST_VALUES = 1_000_000, 2000


def checked_axis(option: str, name: str, values: Array, *, logarithmic: bool = False) -> Axis:
    """Return an axis of a map; `option` is named in errors.

    Raises LagtopError for an unknown input, and unless there are 2 to 2000 increasing values.
    """
    if name not in NINE:
        raise LagtopError(f"{option} must begin with one of {' '.join(NINE)} and =, got {name!r}")
    if not 2 <= values.size <= MOST_VALUES:
        raise LagtopError(f"{option} must have 2 to {MOST_VALUES} values, got {values.size}")
    if not values[0] < values[-1]:
        ends = f"{values[0]:g}:{values[-1]:g}"
        raise LagtopError(f"{option} must have start < stop, got {name}={ends}")
    return Axis(name, values, logarithmic and bool(values[0] > 0))


def usual_axes(top: Top, options: Options) -> tuple[Axis, Axis]:
    """Return spins up to twice the sleeping threshold or beyond the top's own spin, and tilts."""
    threshold = math.sqrt(float(4 * top.A * top.m * top.g * top.s)) / float(top.C)
    most = max(2 * threshold, 1.25 * abs(float(top.r0))) or 1.0
    tilts = np.radians(np.linspace(2.0, 178.0, 120)) * options.factor
    return Axis("r0", (np.arange(160) + 0.5) * most / 160), Axis("theta0", tilts)


def draw_map(motion: Motion, ax: Axes, options: Options) -> str:
    """Draw a key over a grid, the border of stability and the scene; return a title.

    Raises LagtopError for an unknown key, for one input on both axes, for too many cells, and for
    an impossible top.  Raises NothingToDrawError if the key has no value anywhere.
    """
    chart, look = options.map or MapOptions(), options.look
    usual, key = usual_axes(motion.top, options), degree_name(chart.key)
    axes = x, y = chart.x or usual[0], chart.y or usual[1]
    check_names("key", [key], [*WORDS, *NUMBER_KEYS, *requested_keys()])
    if x.name == y.name:
        raise LagtopError(f"x and y must be two inputs, got {x.name} twice")
    if x.values.size * y.values.size > MOST_CELLS:
        raise LagtopError(f"a map must have at most {MOST_CELLS} cells: lower a count")
    values, stable = grid_of(motion, x, y, key, options)
    ax.set_xscale("log" if x.logarithmic else "linear")
    ax.set_yscale("log" if y.logarithmic else "linear")
    ax.set(xlabel=axis_label(x.name, options), ylabel=axis_label(y.name, options))
    if key in WORDS:
        draw_words(ax, axes, values)
        title = WORDS[key]
    else:
        title = draw_numbers(ax, axes, key, values, options)
    if stable.min() < 1.0 < stable.max():
        ax.contour(
            *(x.values, y.values, stable, [1.0]), colors=look.ink, linewidths=1.8, linestyles="--"
        )
        text = "right of it an upright top is stable" if x.name == "r0" else "border of stability"
        ax.plot([], [], "--", color=look.ink, label=text)
    inputs = motion.top.inputs(radians=options.radians)
    own = {name.partition("_")[0]: float(value) for name, value in inputs.items()}
    if all(axis.values[0] <= own[axis.name] <= axis.values[-1] for axis in axes):
        mark_start(ax, own[x.name], own[y.name], look, "this scene")
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2)
    return title


def grid_of(motion: Motion, x: Axis, y: Axis, key: str, options: Options) -> tuple[Array, Array]:
    """Return the key at y[i], x[j], and C |r0| / sqrt(4Amgs) there, which is 1 at the border."""
    inputs: dict[str, Any] = dict(motion.top.inputs(radians=options.radians))
    tilt = next(name for name in inputs if name.startswith("theta0"))
    names = [tilt if axis.name == "theta0" else axis.name for axis in (x, y)]
    rows = []
    for value in (options.map or MapOptions()).progress(y.values.tolist(), "map"):
        both = {names[0]: x.values, names[1]: np.full(x.values.size, value)}
        columns = sweep(keys=[key, "a", "b"], **inputs | both)
        rows.append([columns[name] for name in (key, "a", "b")])
    values, a, b = (np.array(grid) for grid in zip(*rows, strict=True))
    a, b = a.astype(float), b.astype(float)
    with np.errstate(divide="ignore", invalid="ignore"):
        return values, np.where(a > 0, np.abs(b) / np.sqrt(2 * a), np.inf)


def draw_numbers(
    ax: Axes, axes: tuple[Axis, Axis], key: str, values: Array, options: Options
) -> str:
    """Draw a number as filled contours with labelled lines, and a colour bar; return a title.

    The colours span the values without the lowest and the highest 1 %, which may be a peak.  There
    are no lines beside a jump, where they would be jagged.
    """
    declared, look = number_key(key), options.look
    assert declared is not None
    is_angle = declared.unit == "angle"
    factor = math.radians(options.factor) if is_angle else 1.0  # keys of angles are in degrees
    grid = np.ma.masked_invalid(np.asarray(values, float) * factor)
    if not grid.count():
        raise NothingToDrawError(f"no map: {key} is undefined for all of these tops")
    low, high = (float(x) for x in np.percentile(grid.compressed(), [1, 99]))
    if not low < high:
        low, high = low - 0.5 * (abs(low) or 1), low + 0.5 * (abs(low) or 1)
    logarithmic = low > 0 and high > 30 * low
    locator = LogLocator(subs=(1.0, 2.0, 5.0)) if logarithmic else MaxNLocator(10)
    levels = np.unique(locator.tick_values(low, high))
    norm = (LogNorm if logarithmic else Normalize)(levels[0], levels[-1])
    x, y = (axis.values for axis in axes)
    ax.set_facecolor(look.faint)
    filled = ax.contourf(x, y, grid, levels, cmap=scale(look), norm=norm, extend="both")
    slope = np.max(np.abs(np.gradient(grid.filled(np.nan))), axis=0)
    smooth = np.ma.masked_where(slope > (high - low) / 8, grid)
    lines = ax.contour(x, y, smooth, levels, colors=look.paper, linewidths=0.6)
    ax.clabel(lines, levels[1:-1:2], fontsize="small", fmt="%g")
    bar = ax.figure.colorbar(filled, ax=ax, aspect=28, format="%g")
    bar.outline.set_visible(False)
    unit = options.angle if is_angle else options.unit(declared.unit)
    bar.set_label(f"{declared.symbol} ({unit})" if unit else declared.symbol)
    if grid.count() < grid.size:
        ax.plot([], [], "s", color=look.faint, mec=look.quiet, label="undefined")
    return f"{declared.symbol}: {declared.meaning} {declared.equation}".rstrip()


def draw_words(ax: Axes, axes: tuple[Axis, Axis], values: Array) -> None:
    """Draw words as coloured regions with a legend."""
    texts = [["undefined" if word is None else str(word) for word in row] for row in values]
    names, numbers = np.unique(texts, return_inverse=True)
    colours = [REGIONS[i % len(REGIONS)] for i in range(names.size)]
    ax.pcolormesh(
        *(axis.values for axis in axes),
        numbers.reshape(values.shape),
        cmap=ListedColormap(colours),
        vmin=-0.5,
        vmax=names.size - 0.5,
        shading="nearest",
        rasterized=True,
    )
    for colour, name in zip(colours, names, strict=True):
        ax.plot([], [], "s", color=colour, label=name)


def axis_label(name: str, options: Options) -> str:
    """Return the name of an input, with its unit if it has one."""
    declared = DECLARED[name]
    unit = options.angle if declared.unit == "angle" else options.unit(declared.unit)
    text = f"{declared.name} {declared.symbol}"
    return text if "len" in unit or "mass" in unit else f"{text} ({unit})"
