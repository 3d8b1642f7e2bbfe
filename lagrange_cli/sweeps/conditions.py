"""Conditions on the record of a top, such as `T_nutation < 0.4`: for `find` and `sweep --where`."""

from __future__ import annotations

import re
from operator import eq, ge, gt, le, lt
from typing import Any, NamedTuple

from ..arithmetic.text import double_text, quoted, shortened
from ..errors import LagtopError
from ..names import check_names
from ..solver.facts import Regime
from ..solver.keys import all_keys, shown_keys
from ..top.units import Units
from ..top.values import parse_value

WORDS = {"regime": [x.value for x in Regime], "path": ["cusped", "looping", "wavy"]}
"""Keys that hold a word, and the words."""
_RELATIONS: Any = {"=": eq, "<": lt, "<=": le, ">": gt, ">=": ge}


class Condition(NamedTuple):
    """A condition on the record of a top: a word, a target value or a bound."""

    key: str
    relation: str
    value: Any
    has_unit: bool = False
    """Whether the value has a unit other than that of an angle, so that inputs need units too."""

    def __str__(self) -> str:
        value = self.value if self.key in WORDS else double_text(self.value)
        return f"{self.key} {self.relation} {value.removesuffix('.0')}"

    def holds(self, found: Any) -> Any:
        """Return whether a number or word, or which of an array, satisfies the condition.

        A number that is missing, None or NaN, satisfies none.
        """
        return False if found is None else _RELATIONS[self.relation](found, self.value)


def read_condition(text: str, units: Units) -> Condition:
    """Parse `KEY=VALUE` or `KEY<VALUE`; the key of an angle may omit its unit.

    Raises LagtopError.
    """
    relations = "|".join(sorted(_RELATIONS, key=len, reverse=True))
    match = re.fullmatch(rf"\s*(\w+)\s*({relations})\s*(.+?)\s*", text)
    if not match:
        raise LagtopError(f"a condition must be KEY=VALUE or KEY<VALUE, got {quoted(text)}")
    name, relation, word = match.groups()
    key, known = units.key(f"{name}_deg"), all_keys(units)
    if key not in known:
        (key,) = check_names("the key of a condition", [name], known)
    if key in WORDS:
        word = Regime.STEADY.value if (key, word) == ("regime", "steady") else word
        if relation != "=" or word not in WORDS[key]:
            wanted, got = ", ".join(WORDS[key]), f"{relation}{word}".removeprefix("=")
            raise LagtopError(f"{key}= must be one of {wanted}, got {shortened(got)}")
        return Condition(key, relation, word)
    unit = shown_keys(units, requested=True)[key].unit
    value = parse_value(key, word, wanted=unit)
    has_unit = bool(value.unit) and unit not in {"deg", "rad"}
    return Condition(key, relation, float(value.number), has_unit)
