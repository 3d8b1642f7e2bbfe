"""The numbers of the picture `map`: a key of the record over a grid of two inputs."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.points import LogPoints
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.names import check_names
from ..inputs.ranges import parse_range
from ..inputs.top import Top
from ..motion.quantity import unit_name
from ..motion.record import NUMBER_KEYS
from ..motion.solve import Motion
from .request import InputRange, Progress, no_progress

INPUTS = {
    "m": "mass m",
    "A": "equatorial moment A",
    "C": "polar moment C",
    "s": "pivot to mass centre s",
    "g": "gravity g",
    "r0": "spin r₀",
    "theta0": "tilt ϑ₀",
    "thetadot0": "nutation rate at the start",
    "psidot0": "precession rate at the start",
}
"""The inputs that can vary, and what they are."""

MOST_VALUES = 2000
MOST_CELLS = 1_000_000
DEFAULT_COUNTS = 128, 90

OUTERMOST = 1.0
"""Percentage of the values on either side that does not stretch the range of the colours."""


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


def default_ranges(top: Top, *, radians: bool = False) -> tuple[InputRange, InputRange]:
    """Return spins up to twice the sleeping threshold or beyond the top's own, and tilts."""
    columns, rows = DEFAULT_COUNTS
    threshold = math.sqrt(float(4 * top.A * top.m * top.g * top.s)) / float(top.C)
    most = max(2 * threshold, 1.25 * abs(float(top.r0))) or 1.0
    spins = np.linspace(most / columns, most, columns)
    tilts = np.linspace(2.0, 178.0, rows)
    return InputRange("r0", spins), InputRange("theta0", np.radians(tilts) if radians else tilts)


def key_map(
    motion: Motion,
    key: str,
    x: InputRange,
    y: InputRange,
    progress: Progress = no_progress,
    *,
    radians: bool = False,
) -> KeyMap:
    """Return the key over the grid, the other inputs as in the motion.

    Raises LagtopError for a key that is no number, for one input on both axes, for too many cells,
    and where a top of the grid cannot be.
    """
    check_names("key", [key], [unit_name(name, radians=radians) for name in NUMBER_KEYS])
    if x.name == y.name:
        raise LagtopError(f"x must be another input than y, got {x.name} twice", "x")
    cells = x.values.size * y.values.size
    if cells > MOST_CELLS:
        raise LagtopError(f"x must have at most 1e6 cells together with y, got {cells}", "x")
    tilt = unit_name("theta0_deg", radians=radians)
    x_input, y_input = (tilt if axis.name == "theta0" else axis.name for axis in (x, y))

    def over(x_values: Array, y_values: Array | float) -> dict[str, Any]:
        return motion.top.inputs(radians=radians) | {x_input: x_values, y_input: y_values}

    rows = (_values(over(x.values, value), key, radians) for value in y.values.tolist())
    values = np.stack(list(progress(rows, cells)))
    return KeyMap(key, x, y, values, _sleeping(over(*np.meshgrid(x.values, y.values)), values))


def _values(inputs: dict[str, Any], key: str, radians: bool) -> Array:
    """Return the key at each top of one row.  Raises LagtopError where one cannot be."""
    from ..sweeps.records import sweep  # loaded by the map alone, and not by all pictures

    records = sweep(keys=[key, "error"], radians=radians, **inputs)
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
