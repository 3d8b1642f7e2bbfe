"""Units of inputs: a table of sizes, products and powers, and exact conversion to SI.

Results are in kg, m, s and rad if inputs have units.  A tilt stays in degrees or in radians.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from fractions import Fraction
from functools import cache, lru_cache
from typing import NamedTuple

from ..arithmetic.enclosures import pi_to
from ..arithmetic.text import quoted
from ..errors import LagtopError
from ..names import suggestion
from .inputs import DECLARED, TILT

_MOST_CHARACTERS = 80
"""Most characters of a product of units."""
_PI_DIGITS = 1100
"""Digits of pi in inputs: more than any result has."""


class Unit(NamedTuple):
    """A unit, or a product of units, in kg, m, s and rad."""

    size: Fraction = Fraction(1)
    """The size over that power of pi."""
    power_of_pi: int = 0
    dimensions: tuple[int, ...] = (0, 0, 0, 0)
    """The powers of mass, length, time and angle."""

    def times(self, other: Unit, power: int) -> Unit:
        """Return this unit times a power of the other."""
        sums = tuple(x + power * y for x, y in zip(self.dimensions, other.dimensions, strict=True))
        pi = self.power_of_pi + power * other.power_of_pi
        return Unit(self.size * other.size**power, pi, sums)


class Units(NamedTuple):
    """The units of a request: of its angles, and SI if its inputs have units."""

    radians: bool = False
    si: bool = False

    @property
    def angle(self) -> str:
        """The name of the unit of angles."""
        return "rad" if self.radians else "deg"

    @property
    def radian(self) -> float:
        """The size of a radian in the unit of angles."""
        return 1.0 if self.radians else 180 / math.pi

    def key(self, name: str) -> str:
        """Return the key of a number in a document: that of an angle ends in its unit."""
        bare = bare_name(name)
        return name if bare == name else f"{bare}_{self.angle}"

    def keys(self, names: Iterable[str]) -> list[str]:
        """Return the keys of numbers in a document."""
        return [self.key(name) for name in names]

    def named(self, unit: str) -> str:
        """Return a unit such as `angle` or `rad/time` as a document names it."""
        if unit == "angle":
            return self.angle
        return in_si(unit) if self.si else unit

    def remark(self, remark: str | None) -> str | None:
        """Return a remark with seconds in place of units of time, if the units are SI."""
        return re.sub(r"(?<=\d )time\b|(?<=/)time\b", "s", remark) if remark and self.si else remark


DEGREES, RADIANS = Units(), Units(radians=True)
"""The units of documents by default, and of numbers in Python."""


@lru_cache(1000)
def bare_name(name: str) -> str:
    """Return the name of a key without the unit of an angle."""
    return name.removesuffix("_deg").removesuffix("_rad")


_TABLE = """
1 0 0 0 | 0 | mg=1e-6 g=1e-3 kg=1 oz=0.028349523125 lb=0.45359237 slug=8896443230521/609600000000
0 1 0 0 | 0 | um=1e-6 mm=1e-3 cm=1e-2 m=1 km=1000 in=0.0254 ft=0.3048
0 0 1 0 | 0 | ns=1e-9 us=1e-6 ms=1e-3 s=1 min=60 h=3600 d=86400
1 1 -2 0 | 0 | N=1 dyn=1e-5
0 1 -2 0 | 0 | g_0=9.80665
0 0 0 1 | 0 | rad=1 mrad=1e-3
0 0 0 1 | 1 | deg=1/180 arcmin=1/10800 turn=2 rev=2 gon=1/200
0 0 -1 1 | 1 | rpm=1/30
"""
"""The dimensions, the power of pi, and the exact sizes of units."""
UNITS: dict[str, Unit] = {
    name: Unit(Fraction(size), int(pi), tuple(map(int, powers.split())))
    for powers, pi, pairs in (line.split(" | ") for line in _TABLE.strip().split("\n"))
    for name, size in (pair.split("=") for pair in pairs.split())
}
"""The known units by name."""
_SPELLINGS = {
    "s": "sec second seconds",
    "ms": "msec millisec millisecond milliseconds",
    "us": "µs μs µsec μsec usec microsec microsecond microseconds",
    "ns": "nsec nanosec nanosecond nanoseconds",
    "min": "minute minutes",
    "deg": "° degree degrees Grad",
    "rad": "radian radians",
}
SPELLINGS = {word: unit for unit, words in _SPELLINGS.items() for word in words.split()}
"""Other spellings of units."""
EXAMPLES = {"mass": "kg or g", "mass len²": "kg*m^2 or g*cm^2", "len": "m or cm", "time": "s or ms"}
EXAMPLES |= {"len/time²": "m/s^2 or cm/s^2", "rad/time": "rad/s or rpm"}
EXAMPLES |= dict.fromkeys(("deg", "rad"), "deg or rad")
"""Examples of each unit of an input."""
_RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_NAME = r"1|°|g_0|[^\W\d_]+"
_TICKS = re.compile(r"\d{1,9}(?:\.\d{1,9})?(?=\s*[^\W\d])")
"""A number before a unit, as in ticks of 0.1 ms."""
_FACTOR = re.compile(rf"\s*([*·/]?)\s*({_NAME})\s*(?:(?:\*\*|\^)?\s*(-?\d)(?!\d))?")
"""A factor of a product: a stroke, a name, and a power of one digit."""
_ASKED = {
    "U": "write rpm or turn/s",
    "Hz": "turns or radians per second? write rpm, turn/s or rad/s",
    "gr": "grains or grams? write g for grams",
}


@cache
def pi_of_inputs() -> Fraction:
    """Return pi as inputs have it, in units of angle and in periods."""
    return pi_to(_PI_DIGITS)


def unit_of_text(text: str) -> Unit:
    """Return the product of units in a text: `kg*m^2`, `kg m²` or `1/s`.  Raises LagtopError."""
    text = text.strip().translate(_RAISED)
    if len(text) > _MOST_CHARACTERS:
        raise LagtopError(f"a unit has at most {_MOST_CHARACTERS} characters")
    ticks = _TICKS.match(text)
    found, place = Unit(Fraction(ticks[0] if ticks else 1)), ticks.end() if ticks else 0
    while place < len(text):
        match = _FACTOR.match(text, place)
        name = match[2] if match else text[place:]
        unit = Unit() if name == "1" else UNITS.get(SPELLINGS.get(name, name))
        if match is None or unit is None:
            raise LagtopError(_ASKED.get(name) or f"no such unit{_meant(name, text)}")
        found = found.times(unit, int(match[3] or 1) * (-1 if match[1] == "/" else 1))
        place = match.end()
    return found


def power_of_time(unit: str) -> int:
    """Return the power of time in a unit such as `rad/time`."""
    return 0 if unit == "angle" else unit_of_text(in_si(unit)).dimensions[2]


def is_unit(text: str) -> bool:
    """Return whether a text is a unit, also if the unit needs another name, as Hz does."""
    try:
        return bool(unit_of_text(text))
    except LagtopError:
        return text in _ASKED


def _meant(name: str, text: str) -> str:
    """Return a hint with the unit that was meant, such as kg*m^2 for kgm^2, or with all units."""
    for i in range(1, len(name)):
        if {name[:i], name[i:]} <= UNITS.keys():
            return f": write {text.replace(name, f'{name[:i]}*{name[i:]}')}"
    usual = {unit.lower(): unit for unit in UNITS}.get(name.lower())
    hint = f": did you mean {usual!r}?" if usual else suggestion(name, UNITS)
    return hint or f"; known: {', '.join(UNITS)}, their products and powers"


def conversion(key: str, unit: str, wanted: str | None = None) -> tuple[Fraction, str]:
    """Return the factor that converts the quantity `key` from a unit to `wanted` in SI, and that.

    `wanted` is a unit such as `rad/time` or `deg`; by default that of the input or the time `key`.
    A tilt stays in degrees if its unit contains pi, and in radians otherwise.  Raises LagtopError.
    """
    if not unit:
        return Fraction(1), ""
    if is_tilt := wanted is None and key.startswith(TILT):
        key, wanted = TILT, "rad"
    elif wanted is None:
        wanted = DECLARED[key].unit if key in DECLARED else "time"
    into = unit_of_text(in_si(wanted))
    try:
        given = unit_of_text(unit)
        pair = into.dimensions, given.dimensions
        per_time = pair == ((0, 0, -1, 1), (0, 0, -1, 0))  # as 1/s
        if per_time and given.size < 1:  # as 1/min, which many write for rpm
            raise LagtopError("turns or radians? write rpm or rad/min, turn/h or rad/h")
        if given.dimensions != into.dimensions and not per_time:
            raise LagtopError("it measures something else")
    except LagtopError as error:
        example = EXAMPLES.get(wanted) or in_si(wanted)
        must = f"have a unit such as {example}" if wanted else "have no unit"
        wrong = f"{key} must {must}, got the unit {quoted(unit)} ({error})"
        raise LagtopError(wrong, key) from None
    if is_tilt and given.power_of_pi:
        return conversion(key, unit, "deg")
    powers_of_pi = given.power_of_pi - into.power_of_pi
    return given.size / into.size * pi_of_inputs() ** powers_of_pi, wanted


def in_si(unit: str) -> str:
    """Return a unit such as `mass len²` or `rad/time` with the SI names of its parts."""
    names = {"mass": "kg", "len": "m", "time": "s"}
    return re.sub(r"[a-z]+", lambda word: names.get(word[0], word[0]), unit)
