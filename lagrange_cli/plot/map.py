"""The picture `map`: a key of the record over a grid of two inputs."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm, Normalize
from matplotlib.patheffects import withStroke
from matplotlib.ticker import LogLocator, NullLocator

from ..arithmetic.points import LogPoints, Points
from ..arithmetic.types import Array, Mask
from ..errors import LagtopError
from ..inputs.input_keys import DECLARED, NINE, TILT
from ..inputs.names import check_names
from ..inputs.ranges import parse_range, refuse_units_inside
from ..inputs.top import Top
from ..inputs.value import Value, parse_value
from ..motion.quantity import degree_name, unit_name
from ..motion.record import NUMBER_KEYS, number_key, requested_keys
from ..motion.solve import Motion
from ..sweep.records import BLOCK_ROWS, sweep
from .kinds import InputRange, Places, PlotRequest
from .style import Look, mark_start, points, scale

MOST_CELLS = 1_000_000
MOST_VALUES = 2000
"""Greatest number of values of an input along one axis."""
DEFAULT_COUNTS = 128, 90

OUTERMOST = 1.0
"""Percentage of the values at either end that does not extend the colour scale."""


class KeyMap(NamedTuple):
    """A key of the record at each pair of values of two inputs."""

    key: str
    x: InputRange
    y: InputRange
    values: Array
    """values[i, j] belongs to y[i] and x[j]; NaN if the motion has none."""
    sleeping: Array
    """C |r0| / sqrt(4Amgs), 1 at the sleeping threshold; infinite without torque."""

    @property
    def known(self) -> Array:
        """The values that are defined, in one row."""
        return self.values[np.isfinite(self.values)]


def parse_axis(name: str, text: str, *, radians: bool = False) -> tuple[str, Value]:
    """Return the input and the points of an axis such as `r0=10:100:40` or `r0=60:600:40 rpm`.

    A tilt is converted to degrees or `radians`.  `name` is the argument to name in errors.  Raises
    LagtopError for an unknown input.
    """
    known, _, grid = text.partition("=")
    if known not in NINE:
        wanted = f"one of {' '.join(NINE)} and ="
        raise LagtopError(f"{name} must begin with {wanted}, got {text!r}", name)
    try:
        refuse_units_inside(grid, "60:600:40 rpm")
        value = parse_value(grid, parse_range)
        if known == TILT and value.unit:
            from ..inputs.units import factor_of  # few maps have units

            value = value.scaled(factor_of(known, value, "rad" if radians else "deg"))
        return known, value
    except LagtopError as error:
        raise LagtopError(f"{name} {error}", name) from None


def input_range(name: str, known: str, points: Points) -> InputRange:
    """Return the values of an input.  Raises LagtopError unless they are 2 to 2000 and increase."""
    if not 2 <= points.count <= MOST_VALUES:
        raise LagtopError(
            f"{name} must have a count in [2, {MOST_VALUES}], got {points.count}", name
        )
    values = next(points.blocks())
    if not values[0] < values[-1]:
        ends = f"{values[0]:g}:{values[-1]:g}"
        raise LagtopError(f"{name} must have start < stop, got {known}={ends}", name)
    return InputRange(known, values, isinstance(points, LogPoints) and bool(values[0] > 0))


def parse_input_range(name: str, text: str) -> InputRange:
    """Parse a range without a unit, such as `r0=10:100:40` or `r0=log:1:100:40`.

    `name` is the argument to name in errors.  Raises LagtopError as `parse_axis` and `input_range`.
    """
    known, value = parse_axis(name, text)
    if value.unit:
        raise LagtopError(f"{name} must have no unit, as the motion has none, got {text!r}", name)
    return input_range(name, known, value.number)


def default_ranges(top: Top, *, radians: bool = False) -> tuple[InputRange, InputRange]:
    """Return spins up to twice the sleeping threshold or beyond the top's own spin, and tilts."""
    columns, rows = DEFAULT_COUNTS
    threshold = math.sqrt(float(4 * top.A * top.m * top.g * top.s)) / float(top.C)
    most = max(2 * threshold, 1.25 * abs(float(top.r0))) or 1.0
    spins = (np.arange(columns) + 0.5) * most / columns  # none is the threshold itself
    tilts = np.linspace(2.0, 178.0, rows)
    return InputRange("r0", spins), InputRange("theta0", np.radians(tilts) if radians else tilts)


def key_map(motion: Motion, request: PlotRequest) -> KeyMap:
    """Return the key over the grid, with the other inputs of the motion.

    Raises LagtopError for a key that is not a number, for the same input on both axes, and for too
    many cells.  It also refuses a grid that contains an impossible top.
    """
    key, radians = request.key, request.radians
    names = [*NUMBER_KEYS, *requested_keys()]
    check_names("key", [key], [unit_name(name, radians=radians) for name in names])
    usual = default_ranges(motion.top, radians=radians)
    x, y = request.x or usual[0], request.y or usual[1]
    if x.name == y.name:
        raise LagtopError(f"x must differ from y, got {x.name} for both", "x")
    cells = x.values.size * y.values.size
    if cells > MOST_CELLS:
        raise LagtopError(f"x must have at most 1e6 cells together with y, got {cells}", "x")
    tilt = unit_name("theta0_deg", radians=radians)
    x_input, y_input = (tilt if axis.name == "theta0" else axis.name for axis in (x, y))
    keys = list(dict.fromkeys([key, "a", "b", "error"]))

    def part(y_values: Array) -> Array:
        """Return the key, a and b for each top of some rows; raise LagtopError on failure."""
        over = {x_input: x.values, y_input: y_values[:, None]}
        given = motion.top.inputs(radians=radians)
        given["psidot0"] = float(given["psidot0"])  # a steady rate belongs to one top
        records = sweep(keys=keys, radians=radians, **given | over)
        for error in filter(None, records["error"].ravel().tolist()):
            raise LagtopError(error)
        return np.stack([records[name].astype(np.float64) for name in (key, "a", "b")])

    rows = max(BLOCK_ROWS // x.values.size, 1)
    parts = (part(y.values[first : first + rows]) for first in range(0, y.values.size, rows))
    done = list(request.progress(parts, "tops", cells, lambda part: part[0].size))
    values, a, b = np.concatenate(done, axis=1)
    with np.errstate(divide="ignore"):
        return KeyMap(key, x, y, values, np.where(a > 0, abs(b) / np.sqrt(2 * a), np.inf))


def map_picture(motion: Motion, request: PlotRequest, places: Places) -> str:
    """Draw the cells, contours, the sleeping threshold and the marker of the scene."""
    chart = key_map(motion, request)
    x, y, key = chart.x, chart.y, number_key(degree_name(chart.key))
    assert key is not None
    unit = request.unit_of(key)
    (axes,) = places((1.0,))
    axes.set(xlabel=_label(x.name, request), ylabel=_label(y.name, request))
    axes.set(xscale="log" if x.logarithmic else "linear")
    axes.set(yscale="log" if y.logarithmic else "linear")
    bar = _draw_cells(axes, chart, request)
    bar.set_label(f"{chart.key} ({unit})" if unit else chart.key)
    _draw_contours(axes, chart, bar, request.look)
    _draw_threshold(axes, chart, request.look)
    inputs = motion.top.inputs(radians=request.radians)
    own = {name.partition("_")[0]: float(value) for name, value in inputs.items()}
    if all(axis.values[0] <= own[axis.name] <= axis.values[-1] for axis in (x, y)):
        mark_start(axes, own[x.name], own[y.name], request.look, "this scene")
    named = f"{key.symbol}: {key.meaning} {key.equation}".rstrip()
    return f"{named}, in {unit}" if unit else named


def colour_limits(known: Array) -> tuple[float, float]:
    """Return the ends of the colour scale: all values but the outermost, which may be peaks."""
    if not known.size:
        return 0.0, 1.0
    low, high = (float(x) for x in np.percentile(known, [OUTERMOST, 100 - OUTERMOST]))
    if not low < high:
        low, high = float(known.min()), float(known.max())
    return (low, high) if low < high else (low - 0.5 * (abs(low) or 1), low + 0.5 * (abs(low) or 1))


def _draw_cells(axes: Axes, chart: KeyMap, request: PlotRequest) -> Colorbar:
    """Draw the values as coloured cells, with a colour bar."""
    known, look = chart.known, request.look
    axes.set_facecolor(look.faint)  # if the key is undefined
    if known.size < chart.values.size:
        axes.fill([], [], color=look.faint, label="undefined here")
    low, high = request.colour_limits or colour_limits(known)
    logarithmic = low > 0 and high > 30 * low
    mesh = axes.pcolormesh(
        _edges(chart.x),
        _edges(chart.y),
        np.ma.masked_invalid(chart.values),
        cmap=scale(look),
        norm=LogNorm(low, high) if logarithmic else Normalize(low, high),
        rasterized=True,
    )
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
    """Draw contours at the numbers of the colour bar, light on dark and dark on light."""
    known = chart.known
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
    values = np.ma.masked_invalid(np.where(jumps(chart.values, high - low), np.nan, chart.values))
    lines = axes.contour(
        chart.x.values, chart.y.values, values, levels, colors=inks, linewidths=points(0.8)
    )
    axes.clabel(lines, fontsize="small", fmt="%g")


def jumps(values: Array, spread: float) -> Mask:
    """Return a mask of values beside a jump, where contours would be jagged.

    A jump is at least a quarter of the spread of the values, and far greater than the usual step.
    """
    beside = np.zeros(values.shape, np.bool_)
    for grid, marks in ((values, beside), (values.T, beside.T)):
        steps = np.abs(np.diff(grid, axis=0))
        jump = (steps > spread / 4) & (steps > 10 * np.nanmedian(steps))
        marks[:-1] |= jump
        marks[1:] |= jump
    return beside


def _draw_threshold(axes: Axes, chart: KeyMap, look: Look) -> None:
    """Draw the line at which an upright top becomes stable, if it crosses the map."""
    if not chart.sleeping.min() < 1.0 < chart.sleeping.max():
        return
    how: dict[str, Any] = {"colors": look.ink, "linewidths": points(1.6)}
    line = axes.contour(chart.x.values, chart.y.values, chart.sleeping, [1.0], **how)
    line.set_path_effects([withStroke(linewidth=points(3.2), foreground=look.paper)])
    label = "sleeping threshold, C²r₀² = 4Amgs: faster, an upright top is stable"
    axes.plot([], [], color=look.ink, lw=points(1.6), label=label)


def _label(name: str, request: PlotRequest) -> str:
    """Return the name of an input, with its unit if it has one."""
    declared = DECLARED[name]
    unit, text = request.unit_of(declared), f"{declared.name} {declared.symbol}"
    known = unit != declared.unit or ("len" not in unit and "mass" not in unit)
    return f"{text} ({unit})" if known else text


def _edges(axis: InputRange) -> Array:
    """Return the borders of the cells, halfway between their values."""
    values = np.log(axis.values) if axis.logarithmic else axis.values
    middle = (values[1:] + values[:-1]) / 2
    ends = [values[0] - (middle[0] - values[0])], [values[-1] + (values[-1] - middle[-1])]
    edges: Array = np.concatenate([ends[0], middle, ends[1]])
    return np.exp(edges) if axis.logarithmic else edges
