"""A request for pictures: everything that was asked for beside the kinds of picture."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.numbers import per_radian
from ..arithmetic.points import LogPoints
from ..errors import LagtopError
from ..inputs.input_keys import NINE, Input
from ..inputs.ranges import parse_range
from ..output.progress import Progress, silent

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from ..inputs.units import System
    from ..motion.quantity import Key
    from ..motion.sensitivity.angle_uncertainty import AngleStds

MAP_KEY = "mean_precession_rate"
"""The key that a map shows where none is asked for."""

MOST_VALUES = 2000
"""Most values of an input along one axis of a map."""


class InputRange(NamedTuple):
    """An input of the top and the values it takes along one axis of a map."""

    name: str
    values: Array
    """Increasing values; a tilt in degrees."""
    logarithmic: bool = False
    """Whether the values grow by equal factors and not by equal steps."""

    def text(self) -> str:
        """Return the range as it is written on the command line."""
        first, last = (repr(float(self.values[i])) for i in (0, -1))
        steps = "log:" if self.logarithmic else ""
        return f"{self.name}={steps}{first}:{last}:{self.values.size}"


def parse_input_range(name: str, text: str) -> InputRange:
    """Return the range that a text such as `r0=10:100:40` or `r0=log:1:100:40` stands for.

    `name` is the argument that an error names.  Raises LagtopError where the input is unknown, and
    where it is no range of 2 to 2000 increasing values.
    """
    known, _, grid = text.partition("=")
    if known not in NINE:
        wanted = f"one of {' '.join(NINE)} and ="
        raise LagtopError(f"{name} must begin with {wanted}, got {text!r}", name)
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


class PlotRequest(NamedTuple):
    """What a picture of a motion should show."""

    t_max: float | None = None
    """Last time of the pictures over time; by default each picture takes what suits it."""
    radians: bool = False
    """Whether angles are shown in radians and not in degrees."""
    key: str = MAP_KEY
    """Key of the record that a map shows."""
    x: InputRange | None = None
    """Horizontal axis of a map; by default the spin."""
    y: InputRange | None = None
    """Vertical axis of a map; by default the tilt."""
    system: System | None = None
    """The units of the inputs, where these have units."""
    camera: tuple[float, float] | None = None
    """Azimuth and elevation (radians) of the camera; by default where it sees most of a path."""
    limits: tuple[float, float] | None = None
    """Ends of the colours of a map; by default all but the outermost values are within."""
    numbers: bool = True
    """Whether the numbers of the scene stand beside several pictures."""
    progress: Progress = silent
    """What may show the progress of a map."""
    stds: AngleStds | None = None
    """Uncertainties of the angles, drawn as bands."""

    def unit(self, unit: str) -> str:
        """Return a unit such as `rad/time` with the names of the units of the inputs."""
        return self.system.named(unit) if self.system else unit

    def in_words(self, remark: str) -> str:
        """Return a remark on the motion with the names of the units of the inputs."""
        return self.system.in_words(remark) if self.system else remark

    def label(self, text: str) -> str:
        """Return a label whose unit stands between brackets, in the units of the inputs."""
        return re.sub(r"\((.*?)\)", lambda inside: f"({self.unit(inside[1])})", text)

    @property
    def time_label(self) -> str:
        """The label of an axis of time."""
        unit = self.unit("time")
        return f"time t ({'unit of the inputs' if unit == 'time' else unit})"

    def unit_of(self, key: Key | Input) -> str:
        """Return the unit of a key of the record or an input, in the units in use."""
        return self.angle_unit if key.unit == "angle" else self.unit(key.unit)

    @property
    def angle_unit(self) -> str:
        """The name of the unit of angles, as it stands on an axis."""
        return "rad" if self.radians else "deg"

    @property
    def per_radian(self) -> float:
        """The size of one radian in the unit of angles."""
        return per_radian(radians=self.radians)

    def options(self) -> list[str]:
        """Return what differs from the usual, as options of the command."""
        given = {
            "--t-max": self.t_max and repr(self.t_max),
            "--key": self.key if self.key != MAP_KEY else None,
            "--x": self.x and self.x.text(),
            "--y": self.y and self.y.text(),
            "--camera": self.camera
            and ",".join(f"{x * self.per_radian:.10g}" for x in self.camera),
            "--colour-limits": self.limits and ":".join(map(repr, self.limits)),
        }
        flags = ["--rad"] * self.radians + ["--no-numbers"] * (not self.numbers)
        return [f"{name} {text}" for name, text in given.items() if text] + flags
