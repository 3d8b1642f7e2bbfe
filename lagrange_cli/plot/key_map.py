"""The picture `map`: a key of the record over a grid of two inputs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import SubFigure
from matplotlib.ticker import LogLocator, NullLocator

from ..arithmetic.points import LogPoints
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.names import check_names
from ..inputs.ranges import parse_range
from ..inputs.top import Top
from ..motion.record import KEYS, NUMBER_KEYS
from ..motion.solve import Motion
from ..sweeps.records import sweep
from .request import InputRange, PlotRequest, Progress, no_progress
from .style import Look, mark_start, scale

INPUTS = {
    "m": "mass m",
    "A": "equatorial moment A",
    "C": "polar moment C",
    "s": "pivot to mass centre s",
    "g": "gravity g",
    "r0": "spin r₀ (rad/time)",
    "theta0": "tilt ϑ₀ (deg)",
    "thetadot0": "nutation rate at the start (rad/time)",
    "psidot0": "precession rate at the start (rad/time)",
}
"""The inputs that can vary, and what they are."""

MOST_VALUES = 2000
MOST_CELLS = 1_000_000
DEFAULT_COUNTS = 64, 48


class KeyMap(NamedTuple):
    """A key of the record at each pair of values of two inputs."""

    key: str
    x: InputRange
    y: InputRange
    values: Array
    """values[i, j] belongs to y[i] and x[j]; not a number where the motion has none."""
    sleeping: Array
    """C |r0| / sqrt(4Amgs), 1 on the sleeping threshold; infinite without torque."""


def parse_input_range(name: str, text: str) -> InputRange:
    """Return the range that a text such as `r0=10:100:40` or `r0=log:1:100:40` stands for.

    `name` is the argument that an error names.  Raises LagtopError where the input is unknown, and
    where it is no range of 2 to 2000 increasing values.
    """
    known, _, grid = text.partition("=")
    if known not in INPUTS:
        inputs = " ".join(INPUTS)
        raise LagtopError(f"{name} must begin with one of {inputs} and =, got {text!r}", name)
    try:
        points = parse_range(grid)
    except LagtopError as error:
        raise LagtopError(f"{name} {error}", name) from None
    if not 2 <= points.count <= MOST_VALUES:
        raise LagtopError(
            f"{name} must have a count in [2, {MOST_VALUES}], got {points.count}", name
        )
    values = next(points.blocks())
    if not values[0] < values[-1]:
        raise LagtopError(f"{name} must have start < stop, got {text!r}", name)
    return InputRange(known, values, isinstance(points, LogPoints) and bool(values[0] > 0))


def default_ranges(top: Top) -> tuple[InputRange, InputRange]:
    """Return spins up to twice the sleeping threshold or beyond the top's own, and tilts."""
    columns, rows = DEFAULT_COUNTS
    threshold = math.sqrt(float(4 * top.A * top.m * top.g * top.s)) / float(top.C)
    most = max(2 * threshold, 1.25 * abs(float(top.r0))) or 1.0
    spins = np.linspace(most / columns, most, columns)
    return InputRange("r0", spins), InputRange("theta0", np.linspace(2.0, 178.0, rows))


def key_map(
    motion: Motion, key: str, x: InputRange, y: InputRange, progress: Progress = no_progress
) -> KeyMap:
    """Return the key over the grid, the other inputs as in the motion.

    Raises LagtopError for a key that is no number, for one input on both axes, for too many cells,
    and where a top of the grid cannot be.
    """
    check_names("key", [key], NUMBER_KEYS)
    if x.name == y.name:
        raise LagtopError(f"x must be another input than y, got {x.name} twice", "x")
    cells = x.values.size * y.values.size
    if cells > MOST_CELLS:
        raise LagtopError(f"x must have at most 1e6 cells together with y, got {cells}", "x")

    def over(x_values: Array, y_values: Array | float) -> dict[str, Any]:
        return motion.top.inputs() | {_input(x.name): x_values, _input(y.name): y_values}

    rows = (_values(over(x.values, value), key) for value in y.values.tolist())
    values = np.stack(list(progress(rows, cells)))
    return KeyMap(key, x, y, values, _sleeping(over(*np.meshgrid(x.values, y.values)), values))


def _input(name: str) -> str:
    return "theta0_deg" if name == "theta0" else name


def _values(inputs: dict[str, Any], key: str) -> Array:
    """Return the key at each top of one row.  Raises LagtopError where one cannot be."""
    records = sweep(keys=[key, "error"], **inputs)
    for error in filter(None, records["error"]):
        raise LagtopError(error)
    return np.asarray(records[key], dtype=np.float64)


def _sleeping(inputs: dict[str, Any], like: Array) -> Array:
    """Return C |r0| / sqrt(4Amgs) in the shape of `like`."""
    m, A, C, s, g, r0 = (
        inputs[name] + np.zeros_like(like) for name in ("m", "A", "C", "s", "g", "r0")
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = abs(C * r0) / np.sqrt(4 * A * m * g * s)
    return np.where(m * g * s > 0, ratio, np.inf)


def draw(panel: SubFigure, motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw a key over two inputs, with the sleeping threshold and the scene itself."""
    axes = panel.subplots()
    draw_on([axes], motion, request, look)
    if axes.get_legend_handles_labels()[0]:
        panel.legend(loc="outside lower center", ncols=2, fontsize="small")


def draw_on(places: Sequence[Axes], motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw the picture on one axes, with the bar of its colours and without the legend."""
    usual = default_ranges(motion.top)
    x, y = request.x or usual[0], request.y or usual[1]
    chart = key_map(motion, request.key, x, y, request.progress)
    (axes,) = places
    axes.set_title(request.key)
    axes.set(xlabel=_label(x.name, request), ylabel=_label(y.name, request))
    axes.set_facecolor(look.faint)  # where there is no such number
    _draw_cells(axes, chart, look)
    axes.set(xscale=_scale_name(x), yscale=_scale_name(y))
    if chart.sleeping.min() < 1.0 < chart.sleeping.max():
        for colour, width in ((look.paper, 3.2), (look.ink, 1.6)):
            axes.contour(x.values, y.values, chart.sleeping, [1.0], colors=colour, linewidths=width)
        axes.plot([], [], color=look.ink, lw=1.6, label="sleeping threshold, C²r₀² = 4Amgs")
    _mark_own(axes, motion, chart, look)


def _draw_cells(axes: Axes, chart: KeyMap, look: Look) -> None:
    """Draw the values as coloured cells, with the bar that explains the colours."""
    logarithmic = _is_logarithmic(chart.values)
    mesh = axes.pcolormesh(
        _edges(chart.x),
        _edges(chart.y),
        np.ma.masked_invalid(chart.values),
        cmap=scale(look),
        norm=LogNorm() if logarithmic else Normalize(),
        rasterized=True,
    )
    bar = axes.figure.colorbar(mesh, ax=axes, aspect=28)
    bar.outline.set_visible(False)
    if logarithmic:
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        bar.ax.yaxis.set_major_formatter("{x:g}")
        bar.ax.yaxis.set_minor_locator(NullLocator())


def _label(name: str, request: PlotRequest) -> str:
    """Return what an input is, with its unit where there is one."""
    text = INPUTS[name]
    if name in KEYS and "(" not in text and request.unit(KEYS[name].unit) != KEYS[name].unit:
        text += f" ({KEYS[name].unit})"
    return request.label(text)


def _scale_name(axis: InputRange) -> str:
    return "log" if axis.logarithmic else "linear"


def _edges(axis: InputRange) -> Array:
    """Return the borders of the cells, half way between their values."""
    values = np.log(axis.values) if axis.logarithmic else axis.values
    middle = (values[1:] + values[:-1]) / 2
    ends = [values[0] - (middle[0] - values[0])], [values[-1] + (values[-1] - middle[-1])]
    edges: Array = np.concatenate([ends[0], middle, ends[1]])
    return np.exp(edges) if axis.logarithmic else edges


def _mark_own(axes: Axes, motion: Motion, chart: KeyMap, look: Look) -> None:
    """Mark the scene itself where it is on the map."""
    inputs = motion.top.inputs()
    inputs["theta0"] = inputs["theta0_deg"]
    own = [float(inputs[axis.name]) for axis in (chart.x, chart.y)]
    pairs = zip(own, (chart.x, chart.y), strict=True)
    if all(axis.values[0] <= value <= axis.values[-1] for value, axis in pairs):
        mark_start(axes, own[0], own[1], look, "this scene")


def _is_logarithmic(values: Array) -> bool:
    """Return whether all values are positive and spread over more than a factor of 30."""
    known = values[np.isfinite(values)]
    return bool(known.size and known.min() > 0 and known.max() > 30 * known.min())
