"""A key of the record over a grid of two inputs, as numbers: nothing here draws."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.ranges import parse_range
from ..inputs.top import Top, overridden
from ..motion.record import NUMBER_KEYS
from ..motion.solve import Motion
from ..sweeps.records import sweep

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

MOST_CELLS = 1_000_000
DEFAULT_COUNTS = 64, 48

Watch = Callable[[Iterable[Array], int], Iterable[Array]]
"""Hands on the rows as they are computed; see `options.with_progress`."""


class Axis(NamedTuple):
    """An input and the values it takes; a tilt in degrees."""

    name: str
    values: Array


class KeyMap(NamedTuple):
    """The key at each pair of inputs: values[i, j] at y[i], x[j]; not a number where there is
    none."""

    key: str
    x: Axis
    y: Axis
    values: Array
    sleeping: Array
    """C |r0| / sqrt(4Amgs), 1 on the sleeping threshold; infinite without torque."""


def parse_axis(option: str, text: str) -> Axis:
    """`r0=10:100:40` or `r0=log:1:100:40`: an input and so many values from the first to the last.

    Raises LagtopError.
    """
    name, _, grid = text.partition("=")
    if name not in INPUTS:
        raise LagtopError(f"{option} must begin with one of {' '.join(INPUTS)} and =, got {text!r}")
    try:
        points = parse_range(grid)
    except LagtopError as error:
        raise LagtopError(f"{option} {error}") from None
    if not 2 <= points.count <= 2000:
        raise LagtopError(f"{option} must have a count in [2, 2000], got {points.count}")
    values = next(points.blocks())
    if not values[0] < values[-1]:
        raise LagtopError(f"{option} must have start < stop, got {text!r}")
    return Axis(name, values)


def default_axes(top: Top) -> tuple[Axis, Axis]:
    """Spin, to twice the sleeping threshold or beyond the top's own, and tilt."""
    columns, rows = DEFAULT_COUNTS
    threshold = math.sqrt(float(4 * top.A * top.m * top.g * top.s)) / float(top.C)
    most = max(2 * threshold, 1.25 * abs(float(top.r0))) or 1.0
    spins = np.linspace(most / columns, most, columns)
    return Axis("r0", spins), Axis("theta0", np.linspace(2.0, 178.0, rows))


def key_map(
    motion: Motion, key: str, x: Axis, y: Axis, watch: Watch = lambda rows, _: rows
) -> KeyMap:
    """The key over the grid, the other inputs as in the motion.  Raises LagtopError."""
    if key not in NUMBER_KEYS:
        raise LagtopError(f"--key must be among {' '.join(NUMBER_KEYS)}, got {key!r}")
    if x.name == y.name:
        raise LagtopError(f"--x and --y must be different inputs, got {x.name} twice")
    if x.values.size * y.values.size > MOST_CELLS:
        cells = x.values.size * y.values.size
        raise LagtopError(f"a map has at most 1e6 cells, this one would have {cells}")
    own = {name: value for name, value in motion.top._asdict().items() if value is not None}

    def over(x_values: Array, y_values: Array | float) -> dict[str, Any]:
        return overridden(own, {_input(x.name): x_values, _input(y.name): y_values})

    rows = (_values(over(x.values, value), key) for value in y.values.tolist())
    values = np.stack(list(watch(rows, x.values.size * y.values.size)))
    return KeyMap(key, x, y, values, _sleeping(over(*np.meshgrid(x.values, y.values)), values))


def _input(name: str) -> str:
    return "theta0_deg" if name == "theta0" else name


def _values(inputs: dict[str, Any], key: str) -> Array:
    found = sweep(keys=[key, "error"], **inputs)
    for error in filter(None, found["error"]):
        raise LagtopError(error)
    return np.asarray(found[key], dtype=np.float64)


def _sleeping(inputs: dict[str, Any], like: Array) -> Array:
    m, A, C, s, g, r0 = (
        inputs[name] + np.zeros_like(like) for name in ("m", "A", "C", "s", "g", "r0")
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = abs(C * r0) / np.sqrt(4 * A * m * g * s)
    return np.where(m * g * s > 0, ratio, np.inf)
