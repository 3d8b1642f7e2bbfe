"""Units of inputs: their exact meaning, and the system that all of them are put in.

pint is loaded only for a unit that is not common.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from typing import Any

from ..arithmetic.decimals import pi_to
from ..arithmetic.numbers import Number
from ..arithmetic.points import Points
from ..arithmetic.values import Values
from ..errors import LagtopError, UnavailableError
from .common_units import common_unit
from .measured import EXACT_DIGITS
from .quantity_text import TILT, Quantity
from .top import BODY

_RATE = (0, 0, -1)
_TIME = (0, 0, 1)
DIMENSIONS = {
    "m": (1, 0, 0),
    "A": (1, 2, 0),
    "A_cm": (1, 2, 0),
    "C": (1, 2, 0),
    "s": (0, 1, 0),
    "g": (0, 1, -2),
    **dict.fromkeys(("r0", "phidot0", "thetadot0", "psidot0"), _RATE),
    **dict.fromkeys(("t_min", "t_max", "dt"), _TIME),
}
"""The powers of mass, length and time in each input."""
_EXAMPLES = {
    (1, 0, 0): "350g",
    (1, 2, 0): "'3.9e-3 kg*m^2'",
    (0, 1, 0): "4cm",
    (0, 1, -2): "'9.81 m/s^2'",
    _RATE: "'50 rad/s' or 480rpm",
    _TIME: "2s",
}
_ANGLE_EXAMPLE = "30deg or 0.5rad"

_NAME = r"(?:[^\W\d]\w*|°)(?:\s*(?:\*\*|\^)\s*-?\d(?!\d))?"
_GRAMMAR = re.compile(rf"(?:1?\s*/\s*)?{_NAME}(?:\s*[*·/ ]\s*{_NAME})*")
"""Names of units with powers of one figure, times or over one another: others never reach pint."""
_MOST_CHARACTERS = 60
_RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_FIGURES = {figure: raised for raised, figure in _RAISED.items()}
_ROOTS = {"gram": 0, "meter": 1, "second": 2}


class System(Values):
    """A system of units, its mass and length in grams and metres; its time is the second."""

    mass: str
    length: str
    grams: Fraction
    metres: Fraction

    def factor(self, dimensions: tuple[int, int, int]) -> Fraction:
        """Return the unit of these dimensions in those of pint: grams, metres and seconds."""
        return self.grams ** dimensions[0] * self.metres ** dimensions[1]

    def worked_example(self) -> dict[str, Number]:
        """Return the body of the worked example, which is in CGS, in these units."""
        return {
            key: Fraction(value) * CGS.factor(DIMENSIONS[key]) / self.factor(DIMENSIONS[key])
            for key, value in BODY.items()
        }

    def named(self, unit: str) -> str:
        """Return a unit such as `mass len²` or `rad/time` with the names of this system."""
        names = {
            "mass": self.mass,
            "len": self.length,
            "time": "s",
        }
        return re.sub(r"[a-z]+", lambda word: names.get(word[0], word[0]), unit)

    def unit_of(self, powers: Mapping[str, Fraction]) -> str:
        """Return the unit of a product of powers of inputs, such as `kg m²/s²`; radians are 1."""
        sums = [
            sum((n * DIMENSIONS[x][i] for x, n in powers.items()), Fraction()) for i in range(3)
        ]
        parts = list(zip((self.mass, self.length, "s"), sums, strict=True))
        above = " ".join(_raised(name, n) for name, n in parts if n > 0)
        below = " ".join(_raised(name, -n) for name, n in parts if n < 0)
        if not below:
            return above
        return f"{above or 1}/({below})" if " " in below else f"{above or 1}/{below}"

    def in_words(self, remark: str) -> str:
        """Return a remark with the second after numbers and strokes."""
        return re.sub(r"(?<=\d )time\b|(?<=/)time\b", "s", remark)


def _raised(name: str, power: Fraction) -> str:
    """Return a power of a unit, such as `m²`."""
    return name if power == 1 else name + str(power).translate(_FIGURES)


CGS = System("g", "cm", Fraction(1), Fraction(1, 100))
SYSTEMS = {"si": System("kg", "m", Fraction(1000), Fraction(1)), "cgs": CGS}
"""The systems of units by name; the first is the default."""


class Meaning(Values):
    """The size of a unit in grams, metres, seconds and radians, and its dimensions."""

    rational: Fraction
    """The size over that power of pi."""
    power_of_pi: int
    dimensions: tuple[int, int, int]
    angular: bool
    """Whether a plane angle is in the unit, or nothing but times, which goes for a rate too."""

    @property
    def size(self) -> Fraction:
        """The size, with pi in `EXACT_DIGITS` digits."""
        return self.rational * (Fraction(pi_to(EXACT_DIGITS)) if self.power_of_pi else 1)


def system_of(inputs: Mapping[str, Any], name: str | None) -> System | None:
    """Return the system for inputs in units or without; None where nothing but a tilt has a unit.

    A 0 and a time need none.  Raises LagtopError for an input without a unit where others have one,
    or where a system is asked for.
    """
    bare = [x for x in inputs if needs_unit(x, inputs[x])]
    united = [x for x in inputs if hasattr(inputs[x], "unit") and x != TILT]
    if bare and (united or name is not None):
        why = f"as {united[0]} has" if united else "where a time or the output has one"
        example = _EXAMPLES[DIMENSIONS[bare[0]]]
        wrong = f"{bare[0]} must have a unit such as {example}, {why}, got none"
        raise LagtopError(wrong, bare[0])
    return SYSTEMS[name or "si"] if united or name else None


def converted(inputs: Mapping[str, Any], system: System | None) -> dict[str, Any]:
    """Return inputs as numbers in a system; a tilt with a unit is in degrees or in radians.

    Raises LagtopError for a unit of other dimensions.
    """
    found: dict[str, Any] = {}
    for key, value in inputs.items():
        if not hasattr(value, "unit"):
            found[key] = value
        elif key == TILT:
            unit, factor = _tilt(value)
            found[unit] = scaled(value.number, factor)
        else:
            size = factor_of(key, value)
            found[key] = scaled(value.number, size / (system or CGS).factor(DIMENSIONS[key]))
    return found


def needs_unit(key: str, value: Any) -> bool:
    """Return whether an input is a number without a unit that would need one."""
    dimensions = DIMENSIONS.get(key, _TIME)
    if dimensions == _TIME or hasattr(value, "unit"):
        return False
    zero = value.bounds() == [0.0, 0.0] if isinstance(value, Points) else value == 0
    return not zero


def scaled(number: Any, factor: Fraction) -> Any:
    """Return a number, or what stands in its place, times a factor."""
    return number.scaled(factor) if hasattr(number, "scaled") else number * factor


def factor_of(key: str, value: Quantity[Any]) -> Fraction:
    """Return the size of the unit of an input.  Raises LagtopError for wrong dimensions."""
    dimensions = DIMENSIONS[key]
    meaning = _meaning(key, value, _EXAMPLES[dimensions])
    if meaning.dimensions != dimensions or meaning.angular != (dimensions == _RATE):
        raise _refused(key, value, _EXAMPLES[dimensions])
    return meaning.size


def _tilt(value: Quantity[Any]) -> tuple[str, Fraction]:
    """Return the key of a tilt, in degrees or in radians, whichever is exact, and the factor."""
    meaning = _meaning(TILT, value, _ANGLE_EXAMPLE)
    if meaning.dimensions != (0, 0, 0) or not meaning.angular:
        raise _refused(TILT, value, _ANGLE_EXAMPLE)
    if meaning.power_of_pi:
        return f"{TILT}_deg", meaning.rational * 180
    return f"{TILT}_rad", meaning.rational


def _refused(key: str, value: Quantity[Any], example: str, why: str = "") -> LagtopError:
    hint = f" ({why})" if why else ""
    unit = repr(value.unit)[:_MOST_CHARACTERS]
    return LagtopError(f"{key} must have a unit as in {example}, got the unit {unit}{hint}", key)


def _meaning(key: str, value: Quantity[Any], example: str) -> Meaning:
    text = re.sub("[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+", lambda x: f"^{x[0].translate(_RAISED)}", value.unit.strip())
    if len(text) > _MOST_CHARACTERS or not _GRAMMAR.fullmatch(text):
        raise _refused(key, value, example)
    try:
        return meaning_of(f"1{text}" if text.startswith("/") else text)
    except ImportError:
        raise UnavailableError(
            f"{key} must be a finite decimal number "
            f"(units need pint: pip install 'lagtop[units]'), got the unit {value.unit!r}",
            key,
        ) from None
    except _UnknownUnitError as error:
        raise _refused(key, value, example, str(error)) from None


class _UnknownUnitError(Exception):
    """A unit that pint does not know, or that is none of mechanics."""


def meaning_of(text: str) -> Meaning:
    """Return what a unit is.  Raises ImportError without pint for one that is not common."""
    if common := common_unit(text):
        unit, of_times = common
        if unit.angles in {0, 1}:
            angular = unit.angles == 1 or (of_times and unit.dimensions == _RATE)
            return Meaning(unit.rational, unit.power_of_pi, unit.dimensions, angular)
    return meaning_by_pint(text)


@lru_cache(maxsize=256)
def meaning_by_pint(text: str) -> Meaning:
    """Return what a unit is by pint, whose constants are exact, but for pi."""
    registry = _registry()
    try:
        unit = registry.Quantity(Fraction(1), registry.parse_units(text))
        root = unit.to_root_units()
    except Exception as error:  # pint raises errors of many kinds, those of the language among them
        raise _UnknownUnitError("no such unit") from error
    powers = dict(root.unit_items())
    angle = powers.pop("radian", 0)
    whole = all(power == int(power) for power in powers.values())
    if not powers.keys() <= _ROOTS.keys() or angle not in {0, 1} or not whole:
        raise _UnknownUnitError("not one of mass, length, time and angle")
    dimensions = [0, 0, 0]
    for name, power in powers.items():
        dimensions[_ROOTS[name]] = int(power)
    of_times = all(
        dict(registry.Quantity(1, name).dimensionality) == {"[time]": 1}
        for name, _ in unit.unit_items()
    )
    angular = angle == 1 or (of_times and dimensions == [*_RATE])
    size, pi = root.magnitude, registry.Quantity(Fraction(1), "pi").to_root_units().magnitude
    over_pi = size / pi
    of_pi = over_pi.denominator < size.denominator
    a, b, c = dimensions
    return Meaning(over_pi if of_pi else size, int(of_pi), (a, b, c), angular)


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(non_int_type=Fraction)
    registry.define("rev = turn")
    return registry
