"""What is wanted of a top: `T_precession=2`, `regime=regular`, `theta_max_deg<60`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from operator import ge, gt, le, lt
from typing import Any, NamedTuple

from ..arithmetic.text import parse_number, quoted, shortened
from ..errors import LagtopError
from ..inputs.names import check_names
from ..motion.quantity import unit_name
from ..motion.record import all_keys
from ..motion.regime import Regime

_PATHS = ("cusped", "looping", "wavy")
_WORDS = {"regime": tuple(regime.value for regime in Regime), "path": _PATHS}
"""The keys that hold a word, and the words."""
_BOUNDS: Mapping[str, Callable[[float, float], bool]] = {"<": lt, "<=": le, ">": gt, ">=": ge}


class Inequality(NamedTuple):
    """A number that must not be beyond another one."""

    key: str
    relation: str
    limit: float

    def holds(self, record: Mapping[str, Any]) -> bool:
        """Return whether a record keeps the bound; a number that it does not have does not."""
        value = record[self.key]
        return value is not None and _BOUNDS[self.relation](value, self.limit)

    def __str__(self) -> str:
        return f"{self.key}{self.relation}{self.limit:g}"


class Conditions(NamedTuple):
    """What is wanted of the record of a top."""

    numbers: Mapping[str, float]
    """What some keys shall be."""
    words: Mapping[str, str]
    bounds: list[Inequality]

    @property
    def keys(self) -> list[str]:
        """All keys that are spoken of, once."""
        return list(dict.fromkeys([*self.numbers, *self.words, *(x.key for x in self.bounds)]))

    def broken_by(self, record: Mapping[str, Any]) -> str | None:
        """Return the first word or bound that a record does not keep, or None."""
        for key, word in self.words.items():
            if record[key] != word:
                return f"{key}={word}"
        return next((str(bound) for bound in self.bounds if not bound.holds(record)), None)


def read_conditions(texts: Iterable[str], *, radians: bool = False) -> Conditions:
    """Return what `KEY=VALUE` and `KEY<VALUE` say; an angle may leave out its unit.

    Raises LagtopError for an unknown key, and for a value that it cannot have.
    """
    numbers: dict[str, float] = {}
    words: dict[str, str] = {}
    bounds = []
    for text in texts:
        match = re.fullmatch(r"\s*(\w+)\s*(<=|>=|<|>|=)\s*(.+?)\s*", text)
        if not match:
            raise LagtopError(f"a condition must be KEY=VALUE or KEY<VALUE, got {quoted(text)}")
        key, relation, value = _known_key(match[1], radians), match[2], match[3]
        if key in numbers or key in words:
            raise LagtopError(f"a condition must name each key once, got {key} twice")
        if key in _WORDS:
            words[key] = _word(key, relation, value)
        elif relation == "=":
            numbers[key] = _number(key, value)
        else:
            bounds.append(Inequality(key, relation, _number(key, value)))
    return Conditions(numbers, words, bounds)


def _known_key(name: str, radians: bool) -> str:
    known = all_keys(radians=radians)
    with_unit = unit_name(f"{name}_deg", radians=radians)
    return with_unit if with_unit in known else check_names("a condition", [name], known)[0]


def _word(key: str, relation: str, value: str) -> str:
    if relation != "=" or value not in _WORDS[key]:
        wanted = ", ".join(_WORDS[key])
        raise LagtopError(f"{key}= must be one of {wanted}, got {relation}{shortened(value)}")
    return value


def _number(key: str, value: str) -> float:
    try:
        return float(parse_number(value))
    except LagtopError as error:
        raise LagtopError(f"the value of {key} {error}") from None
