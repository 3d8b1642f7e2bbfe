"""The axes of a map: an input of the top and its values, as on the command line."""

from __future__ import annotations

from typing import NamedTuple

from ..arithmetic.points import LogPoints, Points
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.input_keys import NINE, TILT
from ..inputs.ranges import parse_range, refuse_units_inside
from ..inputs.value import Value, parse_value

MOST_VALUES = 2000
"""Greatest number of values of an input along one axis."""


class InputRange(NamedTuple):
    """An input of the top and its values along one axis of a map."""

    name: str
    values: Array
    """Increasing values; a tilt in degrees."""
    logarithmic: bool = False
    """Whether the values grow by equal factors instead of equal steps."""

    def text(self) -> str:
        """Return the range as it is written on the command line."""
        first, last = (repr(float(self.values[i])) for i in (0, -1))
        steps = "log:" if self.logarithmic else ""
        return f"{self.name}={steps}{first}:{last}:{self.values.size}"


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
