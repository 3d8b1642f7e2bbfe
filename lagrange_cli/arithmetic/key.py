"""The presentation of a number: its symbol, meaning, unit, equation and formula."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple


class Key(NamedTuple):
    """The presentation of a number of a record; the unit `angle` stands for degrees or radians."""

    group: str
    symbol: str
    meaning: str
    unit: str = ""
    equation: str = ""
    formula: str = ""
    """The formula, written with names of keys, such as `2*m*g*s/A`; see `solver.explanation`."""
    only: str = ""
    """The condition of the number, such as `if r0 is not 0`; some regimes lack it too."""

    def in_units(self, *, radians: bool, named: Callable[[str], str] = str) -> Key:
        """Return the key with its unit as printed; `named` gives the names of units of a system."""
        angle = "rad" if radians else "deg"
        return self._replace(unit=angle if self.unit == "angle" else named(self.unit))
