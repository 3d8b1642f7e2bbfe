"""Units of inputs: a table of sizes, products and powers, and exact conversion to SI.

Results are in kg, m, s and rad if inputs have units.  A tilt stays in degrees or in radians.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

from ..arithmetic.numbers import Number
from ..arithmetic.points import Points
from ..errors import LagtopError
from .derived_inputs import EXACT_DIGITS, pi_fraction
from .input_keys import BODY, DECLARED, TILT
from .names import suggestion
from .values import Value

Dimensions = tuple[int, int, int, int]
"""The powers of mass, length, time and angle."""


class Unit(NamedTuple):
    """A unit, or a product of units, in kg, m, s and rad."""

    size: Fraction
    """The size over that power of pi."""
    power_of_pi: int
    dimensions: Dimensions

    def times(self, other: Unit, power: int) -> Unit:
        """Return this unit times a power of the other."""
        mass, length, time, angle = (
            x + power * y for x, y in zip(self.dimensions, other.dimensions, strict=True)
        )
        size = self.size * other.size**power
        return Unit(size, self.power_of_pi + power * other.power_of_pi, (mass, length, time, angle))


_ONE = Unit(Fraction(1), 0, (0, 0, 0, 0))
_TABLE = """
1 0 0 0 | 0 | mg=1e-6 g=1e-3 kg=1 oz=0.028349523125 lb=0.45359237 slug=8896443230521/609600000000
0 1 0 0 | 0 | um=1e-6 mm=1e-3 cm=1e-2 m=1 km=1000 in=0.0254 ft=0.3048
0 0 1 0 | 0 | us=1e-6 ms=1e-3 s=1 min=60 h=3600
1 1 -2 0 | 0 | N=1 dyn=1e-5
0 1 -2 0 | 0 | g_0=9.80665
0 0 0 1 | 0 | rad=1 mrad=1e-3
0 0 0 1 | 1 | deg=1/180 \u00b0=1/180 arcmin=1/10800 turn=2 rev=2 gon=1/200
0 0 -1 1 | 1 | rpm=1/30
"""
"""The dimensions, the power of pi, and the exact sizes of units."""
UNITS = {
    name: _ONE._replace(
        size=Fraction(size),
        power_of_pi=int(pi),
        dimensions=tuple(map(int, powers.split())),  # type: ignore[arg-type]
    )
    for powers, pi, pairs in (line.split(" | ") for line in _TABLE.strip().splitlines())
    for name, size in (pair.split("=") for pair in pairs.split())
}
_OF_WORDS = {"mass": UNITS["kg"], "len": UNITS["m"], "time": UNITS["s"]}
_UNIT_OF = {name: x.unit.replace("angle", "rad") for name, x in DECLARED.items()}
_EXAMPLES = {
    "mass": "350g",
    "mass len\u00b2": "'3.9e-3 kg*m^2'",
    "len": "4cm",
    "len/time\u00b2": "'9.81 m/s^2'",
    "rad/time": "'50 rad/s' or 480rpm",
    "time": "2s",
    "m": "4cm",
    **dict.fromkeys(("deg", "rad"), "30deg or 0.5rad"),
}
"""An example of each unit of an input."""
_RAISED = str.maketrans("\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079", "-0123456789")
_FIGURES = {figure: raised for raised, figure in _RAISED.items()}
_FACTOR = re.compile(r"\s*([*\u00b7/]?)\s*(1|\u00b0|[^\W\d](?:_?[^\W\d_]|_0)*)(?:\s*(?:\*\*|\^)\s*(-?\d)(?!\d))?")
"""A factor of a product: a stroke, a name, and a power of one digit."""
_HERTZ = "turns or radians per second? write rpm, turn/s or rad/s"


def unit_of_text(text: str) -> Unit:
    """Return the product of units that a text names, such as `kg*m^2`, `kg m\u00b2` or `m/s/s`.

    Raises LagtopError for an unknown unit, with the nearest name.
    """
    found, place = _ONE, 0
    text = re.sub("[\u207b\u2070\u00b9\u00b2\u00b3\u2074-\u2079]+", lambda x: f"^{x[0].translate(_RAISED)}", text.strip())
    while place < len(text):
        match = _FACTOR.match(text, place)
        name = match[2] if match else text[place:]
        unit = _ONE if name == "1" else (UNITS | _OF_WORDS).get(name)
        if match is None or unit is None:
            raise LagtopError(f"no such unit{_usual_spelling(text) or suggestion(name, UNITS)}")
        found = found.times(unit, int(match[3] or 1) * (-1 if match[1] == "/" else 1))
        place = match.end()
    return found


def _usual_spelling(text: str) -> str:
    """Return a question with the usual spelling of a unit, such as rpm for RPM, or an empty text.

    A digit after a name counts as its power, as in `kg m2`.
    """
    known = {name.lower(): name for name in UNITS}
    usual = re.sub(r"[^\W\d_]+", lambda name: known.get(name[0].lower(), name[0]), text)
    usual = re.sub(r"(?<=[^\W\d_])(?=\d)", "^", usual)
    names = re.findall(r"[^\W\d_]+|\u00b0", usual)
    return f"; did you mean {usual}?" if usual != text and {*names} <= {*UNITS} else ""
