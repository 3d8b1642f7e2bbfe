"""The keys of a record, in their order; each is declared with its formula."""

from __future__ import annotations

from collections.abc import Callable

from ..arithmetic.key import Key
from ..top.inputs import DECLARED, NINE, TILT
from .quantity import keys_of, unit_name
from .spin_precession import SpinPrecession

_INPUTS = {
    f"{name}_deg" if name == TILT else name: Key("Inputs", x.symbol, x.name, x.unit)
    for name, x in DECLARED.items()
    if name in NINE
}
_GROUPS = (
    "Constants",
    "Roots",
    "Moduli and integrals",
    "Periods",
    "Turning points",
    "Mean rates",
    "Rates",
)
_NUMBERS = dict(
    sorted(keys_of(SpinPrecession).items(), key=lambda item: _GROUPS.index(item[1].group))
)

NUMBER_KEYS = list(_NUMBERS)
"""The numbers of a record, in order; `regime` precedes them, `path` and `remark` follow."""
TEXT_KEYS = ("regime", "path", "remark")
"""The keys of a record whose values are words."""
KEYS = (
    _INPUTS
    | {"regime": Key("Constants", "", "regime"), "path": Key("Constants", "", "path of the axis")}
    | _NUMBERS
    | {"remark": Key("Remark", "", "special properties of the motion, if any")}
)
"""The declaration of each key by name, in the order of the groups of a table."""


def number_key(name: str) -> Key | None:
    """Return the declaration of a number of the record or on request; None for other names."""
    return _NUMBERS.get(name) or requested_keys().get(name)


def requested_keys() -> dict[str, Key]:
    """Return the further keys and their declarations."""
    from .requested import REQUESTED  # start-up: not for a record

    return REQUESTED


def all_keys(*, radians: bool = False) -> list[str]:
    """Return the keys of a record and those on request, in their order."""
    names = record_keys(radians=radians)
    return [*names, *(unit_name(name, radians=radians) for name in requested_keys())]


def record_keys(*, radians: bool = False) -> list[str]:
    """Return all keys of a record in their order."""
    names = [*_INPUTS, "regime", *NUMBER_KEYS, "path", "remark"]
    return [unit_name(name, radians=radians) for name in names]


def shown_keys(
    *, radians: bool = False, named: Callable[[str], str] = str, requested: bool = False
) -> dict[str, Key]:
    """Return the declaration of each key by name in a record; `named` gives the names of units."""
    return {
        unit_name(name, radians=radians): key.in_units(radians=radians, named=named)
        for name, key in (KEYS | (requested_keys() if requested else {})).items()
    }
