"""Units of inputs: their dimensions, and conversion to one system of units."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from math import prod
from typing import Any, NamedTuple

from ..arithmetic.decimals import pi_to
from ..arithmetic.numbers import Number
from ..arithmetic.points import Points
from ..arithmetic.values import Values
from ..errors import LagtopError, UnavailableError
from .input_keys import BODY, DECLARED, TILT
from .names import usual_spelling
from .stand_ins import EXACT_DIGITS
from .value import Value

Dimensions = tuple[int, int, int]
"""The powers of mass, length and time."""
RATE, TIME = (0, 0, -1), (0, 0, 1)
_ROOTS = ("gram", "meter", "second")
_EXAMPLES = {
    "mass": "350g",
    "mass len²": "'3.9e-3 kg*m^2'",
    "len": "4cm",
    "len/time²": "'9.81 m/s^2'",
    "rad/time": "'50 rad/s' or 480rpm",
    "time": "2s",
    **dict.fromkeys(("deg", "rad"), "30deg or 0.5rad"),
}
"""An example of each unit of an input."""
_UNIT_OF = {name: x.unit.replace("angle", "rad") for name, x in DECLARED.items()} | dict.fromkeys(
    ("t", "t_min", "t_max", "dt"), "time"
)

_NAME = r"(?:[^\W\d]\w*|°)(?:\s*(?:\*\*|\^)\s*-?\d(?!\d))?"
_GRAMMAR = re.compile(rf"(?:1?\s*/\s*)?{_NAME}(?:\s*[*·/ ]\s*{_NAME})*")
"""Products and quotients of named units with one-digit powers; pint sees no other text."""
_MOST_CHARACTERS = 60
_RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_HERTZ = "turns or radians per second? write rpm, turn/s or rad/s"
_FIGURES = {figure: raised for raised, figure in _RAISED.items()}


class System(Values):
    """A system of units: the names of mass and length; time is in seconds."""

    mass: str
    length: str

    def worked_example(self) -> dict[str, Number]:
        """Return the body of the worked example (CGS) in these units."""
        given = {key: Value(Fraction(x), CGS.named(_UNIT_OF[key])) for key, x in BODY.items()}
        return {key: x.number * factor_of(key, x, system=self) for key, x in given.items()}

    def named(self, unit: str) -> str:
        """Return a unit such as `mass len²` or `rad/time` with the names of this system."""
        names = {"mass": self.mass, "len": self.length, "time": "s"}
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
        """Return a remark with `time` replaced by the second."""
        return re.sub(r"(?<=\d )time\b|(?<=/)time\b", "s", remark)


def _raised(name: str, power: Fraction) -> str:
    """Return a power of a unit, such as `m²`."""
    return name if power == 1 else name + str(power).translate(_FIGURES)


GRAM_METRE = System("g", "m")
CGS = System("g", "cm")
SYSTEMS = {"si": System("kg", "m"), "cgs": CGS}
"""The systems of units by name; the first is the default."""


def system_of(inputs: Mapping[str, Value], name: str | None) -> System | None:
    """Return the system of units of some inputs; None if only a tilt has a unit.

    A zero and a time need no unit.  Raises LagtopError for an input without a unit if others have
    one, or if a system is requested.
    """
    bare = [x for x in inputs if needs_unit(x, inputs[x])]
    united = [x for x in inputs if inputs[x].unit and x != TILT]
    if bare and (united or name is not None):
        why = f"as {united[0]} has" if united else "as a time, a condition or the output has"
        number, example = inputs[bare[0]].number, _EXAMPLES[_UNIT_OF[bare[0]]]
        if isinstance(number, Fraction) and number != 1:  # a heading of a file counts as 1
            example = re.sub(r"[\d.e-]*\d", f"{float(number):g}", example, count=1)
        raise LagtopError(f"{bare[0]} must have a unit such as {example}, {why}, got none", bare[0])
    return SYSTEMS[name or "si"] if united or name else None


def converted(inputs: Mapping[str, Value], system: System | None) -> dict[str, Value]:
    """Return inputs converted to a system; a tilt with a unit becomes degrees or radians.

    Raises LagtopError for a unit of other dimensions.
    """
    found: dict[str, Value] = {}
    for key, value in inputs.items():
        if not value.unit:
            found[key] = value
        elif key == TILT:
            factor_of(key, value)  # refuses other dimensions
            wanted = "deg" if _unit_in(key, value).power_of_pi else "rad"
            found[f"{TILT}_{wanted}"] = value.scaled(factor_of(key, value, wanted))
        else:
            found[key] = value.scaled(factor_of(key, value, system=system or CGS))
    return found


def needs_unit(key: str, value: Value) -> bool:
    """Return whether an input needs a unit but has none."""
    number = value.number
    if DIMENSIONS.get(key, TIME) == TIME or value.unit or key == TILT or isinstance(number, str):
        return False
    is_zero = number.bounds() == [0.0, 0.0] if isinstance(number, Points) else number == 0
    return not (is_zero.all() if hasattr(is_zero, "all") else is_zero)  # of an array


def factor_of(
    key: str, value: Value, wanted: str | None = None, system: System = GRAM_METRE
) -> Fraction:
    """Return the factor from the unit of a value to `wanted` in the units of a system.

    `wanted` is a unit such as `mass len²/time²`, `rad/time` or `deg`, by default that of the input
    `key`.  Raises LagtopError for a unit of other dimensions.
    """
    wanted = _UNIT_OF[key] if wanted is None else wanted
    target = unit_of_text(_with_powers(system.named(wanted)))
    try:
        unit = _unit_in(key, value)
        if unit.dimensions != target.dimensions or (
            not unit.angular if target.angles else unit.angles
        ):
            hertz = target.angles and unit.dimensions == target.dimensions
            raise UnknownUnitError(_HERTZ if hertz else "")
    except UnknownUnitError as error:
        example = _EXAMPLES.get(wanted) or repr(f"2 {SYSTEMS['si'].named(wanted)}")
        got, why = repr(value.unit)[:_MOST_CHARACTERS], f" ({error})" if str(error) else ""
        must = f"have a unit as in {example}" if wanted else "have no unit"
        raise LagtopError(f"{key} must {must}, got the unit {got}{why}", key) from None
    powers_of_pi = unit.power_of_pi - target.power_of_pi
    return unit.rational / target.rational * Fraction(pi_to(EXACT_DIGITS)) ** powers_of_pi


def _with_powers(text: str) -> str:
    """Return the name of a unit with `^2` for a raised 2."""
    return re.sub("[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+", lambda x: f"^{x[0].translate(_RAISED)}", text.strip())


def _unit_in(key: str, value: Value) -> Unit:
    text = _with_powers(value.unit)
    if text in {"gr", "gr."}:  # a grain for pint, a gram for many people
        raise UnknownUnitError("grain or gram? write grain or g")
    if len(text) > _MOST_CHARACTERS or not _GRAMMAR.fullmatch(text):
        raise UnknownUnitError
    try:
        return unit_of_text(f"1{text}" if text.startswith("/") else text)
    except ImportError:
        raise UnavailableError(
            f"{key} must be a finite decimal number "
            f"(units need pint: pip install 'lagtop[units]'), got the unit {value.unit!r}",
            key,
        ) from None
    except UnknownUnitError as error:
        raise UnknownUnitError(f"{error}{usual_spelling(text, UNITS)}") from None


class Unit(NamedTuple):
    """A unit, or a product of units, in grams, metres, seconds and radians."""

    rational: Fraction
    """The size over that power of pi."""
    power_of_pi: int
    dimensions: Dimensions
    angles: int
    """The power of plane angles."""
    of_times: bool = False
    """Whether the unit is a product of units of time alone."""

    @property
    def angular(self) -> bool:
        """Whether the unit contains a plane angle, or only times, which serves as a rate too."""
        return self.angles == 1 or (self.of_times and self.dimensions == RATE)


class UnknownUnitError(Exception):
    """A unit that pint does not know, or that does not belong to mechanics."""


def _units(dimensions: Dimensions, sizes: str, pi: int = 0, angles: int = 0) -> dict[str, Unit]:
    pairs, of_times = (pair.split("=") for pair in sizes.split()), dimensions == TIME
    return {x: Unit(Fraction(size), pi, dimensions, angles, of_times) for x, size in pairs}


UNITS = {
    **_units((1, 0, 0), "mg=1/1000 g=1 kg=1000 oz=28.349523125 lb=453.59237"),
    **_units((0, 1, 0), "um=1e-6 mm=1e-3 cm=1e-2 m=1 km=1000 in=0.0254 ft=0.3048"),
    **_units(TIME, "us=1e-6 ms=1e-3 s=1 min=60 h=3600"),
    **_units((1, 1, -2), "N=1000"),
    **_units((0, 0, 0), "rad=1 mrad=1e-3", angles=1),
    **_units((0, 0, 0), "deg=1/180 \u00b0=1/180 arcmin=1/10800 turn=2 rev=2", pi=1, angles=1),
    **_units(RATE, "rpm=1/30", pi=1, angles=1),
}
"""The common units, with the same sizes as in pint."""
_FACTOR = re.compile(r"([*\u00b7/\s]*)(1|[^\W\d]\w*|\u00b0)(?:\s*(?:\*\*|\^)\s*(-?\d))?")


def unit_of_text(text: str) -> Unit:
    """Return the unit that a text names.

    Raises UnknownUnitError, and ImportError for an uncommon unit if pint is not installed.
    """
    common = _common_unit(text)
    return common if common and common.angles in {0, 1} else unit_by_pint(text)


def _common_unit(text: str) -> Unit | None:
    """Return a product of common units, None for other texts."""
    powers: Counter[str] = Counter()
    for stroke, name, power in _FACTOR.findall(text):
        powers[name] += int(power or 1) * (-1 if "/" in stroke else 1)
    del powers["1"]
    if not powers.keys() <= UNITS.keys():
        return None
    units = [(UNITS[name], n) for name, n in powers.items() if n]
    mass, length, time = (sum(unit.dimensions[i] * n for unit, n in units) for i in range(3))
    return Unit(
        prod((unit.rational**n for unit, n in units), start=Fraction(1)),
        sum(unit.power_of_pi * n for unit, n in units),
        (mass, length, time),
        sum(unit.angles * n for unit, n in units),
        all(unit.of_times for unit, _ in units),
    )


DIMENSIONS = {
    name: unit_of_text(_with_powers(GRAM_METRE.named(unit))).dimensions
    for name, unit in _UNIT_OF.items()
}
"""The powers of mass, length and time in each input."""


@lru_cache(maxsize=256)
def unit_by_pint(text: str) -> Unit:
    """Look up a unit in pint, whose constants are exact except pi."""
    registry = _registry()
    try:
        unit = registry.Quantity(Fraction(1), registry.parse_units(text))
        root = unit.to_root_units()
    except Exception as error:  # pint raises errors of many kinds, built-in ones among them
        raise UnknownUnitError("no such unit") from error
    powers = dict(root.unit_items())
    angles = powers.pop("radian", 0)
    whole = all(power == int(power) for power in powers.values())
    if not powers.keys() <= {*_ROOTS} or angles not in {0, 1} or not whole:
        raise UnknownUnitError("not one of mass, length, time and angle")
    mass, length, time = (int(powers.get(name, 0)) for name in _ROOTS)
    of_times = all(
        dict(registry.Quantity(1, name).dimensionality) == {"[time]": 1}
        for name, _ in unit.unit_items()
    )
    size, pi = root.magnitude, registry.Quantity(Fraction(1), "pi").to_root_units().magnitude
    over_pi = size / pi
    of_pi = over_pi.denominator < size.denominator
    rational = over_pi if of_pi else size
    return Unit(rational, int(of_pi), (mass, length, time), int(angles), of_times)


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(non_int_type=Fraction)
    registry.define("rev = turn")
    return registry
