"""Units by their texts: exact sizes and dimensions.

The units that most inputs have take no time; pint, which knows all others, takes a second to load.
"""

from __future__ import annotations

import re
from collections import Counter
from fractions import Fraction
from functools import lru_cache
from math import prod
from typing import Any, NamedTuple

from ..arithmetic.decimals import pi_to
from .measured import EXACT_DIGITS

Dimensions = tuple[int, int, int]
"""The powers of mass, length and time."""
RATE, TIME = (0, 0, -1), (0, 0, 1)
_ROOTS = ("gram", "meter", "second")


class Unit(NamedTuple):
    """A unit, or a product of units, in grams, metres, seconds and radians."""

    rational: Fraction
    """The size over that power of pi."""
    power_of_pi: int
    dimensions: Dimensions
    angles: int
    """The power of plane angles."""
    of_times: bool = False
    """Whether it is a product of units of time alone."""

    @property
    def angular(self) -> bool:
        """Whether a plane angle is in the unit, or nothing but times, which goes for a rate too."""
        return self.angles == 1 or (self.of_times and self.dimensions == RATE)

    @property
    def size(self) -> Fraction:
        """The size, with pi in `EXACT_DIGITS` digits."""
        return self.rational * (Fraction(pi_to(EXACT_DIGITS)) if self.power_of_pi else 1)


class UnknownUnitError(Exception):
    """A unit that pint does not know, or that is none of mechanics."""


def _units(dimensions: Dimensions, sizes: str, pi: int = 0, angles: int = 0) -> dict[str, Unit]:
    pairs = (pair.split("=") for pair in sizes.split())
    return {
        name: Unit(Fraction(size), pi, dimensions, angles, dimensions == TIME)
        for name, size in pairs
    }


UNITS = {
    **_units((1, 0, 0), "mg=1/1000 g=1 kg=1000 oz=28.349523125 lb=453.59237"),
    **_units((0, 1, 0), "um=1e-6 mm=1e-3 cm=1e-2 m=1 km=1000 in=0.0254 ft=0.3048"),
    **_units(TIME, "us=1e-6 ms=1e-3 s=1 min=60 h=3600"),
    **_units((1, 1, -2), "N=1000"),
    **_units((0, 0, 0), "rad=1 mrad=1e-3", angles=1),
    **_units((0, 0, 0), "deg=1/180 \u00b0=1/180 arcmin=1/10800 turn=2 rev=2", pi=1, angles=1),
    **_units(RATE, "rpm=1/30", pi=1, angles=1),
}
"""The common units; their sizes are those of pint."""
_FACTOR = re.compile(r"([*\u00b7/\s]*)(1|[^\W\d]\w*|\u00b0)(?:\s*(?:\*\*|\^)\s*(-?\d))?")


def unit_of_text(text: str) -> Unit:
    """Return what a unit is.

    Raises UnknownUnitError, and ImportError without pint for one that is not common.
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


@lru_cache(maxsize=256)
def unit_by_pint(text: str) -> Unit:
    """Return what a unit is by pint, whose constants are exact, but for pi."""
    registry = _registry()
    try:
        unit = registry.Quantity(Fraction(1), registry.parse_units(text))
        root = unit.to_root_units()
    except Exception as error:  # pint raises errors of many kinds, those of the language among them
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
