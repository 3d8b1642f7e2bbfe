"""The keys of a record, in their order: each is declared where its formula stands."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import TYPE_CHECKING, Any

from .quantity import Key, keys_of
from .spin_precession import SpinPrecession

if TYPE_CHECKING:
    from .certified import Certified
    from .kinds import Kind
    from .regime import Exact
    from .solve import Motion

_INPUTS = {
    "m": Key("Inputs", "m", "mass", "mass"),
    "A": Key("Inputs", "A", "equatorial moment", "mass len²"),
    "C": Key("Inputs", "C", "polar moment", "mass len²"),
    "s": Key("Inputs", "s", "pivot to mass centre", "len"),
    "g": Key("Inputs", "g", "gravity", "len/time²"),
    "r0": Key("Inputs", "r0", "total spin rate", "rad/time"),
    "theta0_deg": Key("Inputs", "ϑ0", "tilt at the start", "angle"),
    "thetadot0": Key("Inputs", "ϑ'0", "nutation rate at start", "rad/time"),
    "psidot0": Key("Inputs", "ψ'0", "precession rate at start", "rad/time"),
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
"""The numbers of a record, in its order: `regime` precedes, `path` and `remark` follow them."""
TEXT_KEYS = ("regime", "path", "remark")
"""The keys of a record that hold words."""
CANCELLING = {name for name, key in _NUMBERS.items() if key.cancels}
KEYS = (
    _INPUTS
    | {"regime": Key("Constants", "", "regime"), "path": Key("Constants", "", "path of the axis")}
    | _NUMBERS
    | {"remark": Key("Remark", "", "")}
)
"""How each key is shown, by name; the groups of a table come in this order."""


def unit_name(name: str, *, radians: bool) -> str:
    """Return the name of a key in the unit of angles in use: its `_deg` becomes `_rad`."""
    return f"{name.removesuffix('_deg')}_rad" if radians and name.endswith("_deg") else name


def number_key(name: str) -> Key | None:
    """Return how a number is declared, of the record or on request; None where it is no number."""
    return _NUMBERS.get(name) or requested_keys().get(name)


def requested_keys() -> dict[str, Key]:
    """Return the numbers that a motion has on request only, and how they are shown."""
    from .requested import REQUESTED  # not for a record

    return REQUESTED


def source_of(name: str, kind: Kind[Any], exact: Exact) -> Any:
    """Return the object that computes a number: a kind, or what stands on it for those on request.

    Such objects are made anew for each number; what they share is computed by the kind.
    """
    if name in _NUMBERS:
        return kind
    from .worked_example import WorkedExample  # the last of the classes with such keys

    return WorkedExample(kind, exact)


def all_keys(*, radians: bool = False) -> list[str]:
    """Return the keys of a record and those on request, in their order."""
    names = record_keys(radians=radians)
    return [*names, *(unit_name(name, radians=radians) for name in requested_keys())]


def record_keys(*, radians: bool = False) -> list[str]:
    """Return all keys of a record in their order."""
    names = [*_INPUTS, "regime", *NUMBER_KEYS, "path", "remark"]
    return [unit_name(name, radians=radians) for name in names]


def record_of(
    motion: Motion | Certified,
    inputs: Mapping[str, Any],
    number: Callable[[str, bool], Any],
    *,
    radians: bool,
    keys: Collection[str] | None,
) -> dict[str, Any]:
    """Return inputs and results by key in their order, or some of them; `number` gives a number."""
    names = record_keys(radians=radians)
    wanted = set(names if keys is None else keys)
    numbers = NUMBER_KEYS
    if not wanted <= set(names):
        names, numbers = all_keys(radians=radians), [*NUMBER_KEYS, *requested_keys()]
    values = dict(inputs) | {"regime": motion.regime.value}
    for name in numbers:
        shown = unit_name(name, radians=radians)
        if shown in wanted:
            values[shown] = number(name, radians)
    if "path" in wanted:
        values["path"] = motion.path
    if "remark" in wanted:
        values["remark"] = motion.remark_in(radians=radians)
    return {name: values[name] for name in names if name in wanted}
