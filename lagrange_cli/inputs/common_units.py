"""The units that most inputs have; they take no time, where pint takes a second to load.

The sizes are exact, and the same as those of pint, which knows all other units.
"""

from __future__ import annotations

import re
from collections import Counter
from fractions import Fraction
from math import prod
from typing import NamedTuple

Dimensions = tuple[int, int, int]
"""The powers of mass, length and time."""


class Unit(NamedTuple):
    """A unit, or a product of units, in grams, metres, seconds and radians."""

    rational: Fraction
    """The size over that power of pi."""
    power_of_pi: int
    dimensions: Dimensions
    angles: int
    """The power of plane angles."""


def _units(dimensions: Dimensions, sizes: str, pi: int = 0, angles: int = 0) -> dict[str, Unit]:
    pairs = (pair.split("=") for pair in sizes.split())
    return {name: Unit(Fraction(size), pi, dimensions, angles) for name, size in pairs}


UNITS = {
    **_units((1, 0, 0), "mg=1/1000 g=1 kg=1000 oz=28.349523125 lb=453.59237"),
    **_units((0, 1, 0), "um=1e-6 mm=1e-3 cm=1e-2 m=1 km=1000 in=0.0254 ft=0.3048"),
    **_units((0, 0, 1), "us=1e-6 ms=1e-3 s=1 min=60 h=3600"),
    **_units((1, 1, -2), "N=1000"),
    **_units((0, 0, 0), "rad=1 mrad=1e-3", angles=1),
    **_units((0, 0, 0), "deg=1/180 \u00b0=1/180 arcmin=1/10800 turn=2 rev=2", pi=1, angles=1),
    **_units((0, 0, -1), "rpm=1/30", pi=1, angles=1),
}
_FACTOR = re.compile(r"([*\u00b7/\s]*)(1|[^\W\d]\w*|\u00b0)(?:\s*(?:\*\*|\^)\s*(-?\d))?")


def common_unit(text: str) -> tuple[Unit, bool] | None:
    """Return a product of common units, and whether all are units of time; None for other texts."""
    powers: Counter[str] = Counter()
    for stroke, name, power in _FACTOR.findall(text):
        powers[name] += int(power or 1) * (-1 if "/" in stroke else 1)
    del powers["1"]
    if not powers.keys() <= UNITS.keys():
        return None
    units = [(UNITS[name], n) for name, n in powers.items() if n]
    mass, length, time = (sum(unit.dimensions[i] * n for unit, n in units) for i in range(3))
    product = Unit(
        prod((unit.rational**n for unit, n in units), start=Fraction(1)),
        sum(unit.power_of_pi * n for unit, n in units),
        (mass, length, time),
        sum(unit.angles * n for unit, n in units),
    )
    return product, all(unit.dimensions == (0, 0, 1) for unit, _ in units)
