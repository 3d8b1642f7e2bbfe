"""The keys of a record, in their order: each is declared where its formula stands."""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ..arithmetic.ball import Ball
from ..arithmetic.balls import balls
from ..arithmetic.rounding import FIRST_DIGITS, Settled, rounding_of, settled
from ..errors import OutOfRangeError
from .quantity import Key, keys_of
from .spin_precession import SpinPrecession

if TYPE_CHECKING:
    from ..inputs.top import Top
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
    from .paper.requested import REQUESTED  # not for a record

    return REQUESTED


def all_keys(*, radians: bool = False) -> list[str]:
    """Return the keys of a record and those on request, in their order."""
    names = record_keys(radians=radians)
    return [*names, *(unit_name(name, radians=radians) for name in requested_keys())]


def record_keys(*, radians: bool = False) -> list[str]:
    """Return all keys of a record in their order."""
    names = [*_INPUTS, "regime", *NUMBER_KEYS, "path", "remark"]
    return [unit_name(name, radians=radians) for name in names]


def record_in_range(
    motion: Motion,
    *,
    digits: int | None = None,
    radii: bool = False,
    radians: bool = False,
    keys: Collection[str] | None = None,
) -> tuple[dict[str, Any], list[OutOfRangeError]]:
    """Return `Motion.record`, and an error for each number beyond the range of doubles."""
    names = record_keys(radians=radians)
    wanted = set(names if keys is None else keys)
    numbers = NUMBER_KEYS
    if not wanted <= set(names):
        names, numbers = all_keys(radians=radians), [*NUMBER_KEYS, *requested_keys()]
    found, beyond = _inputs(motion.top, digits, radians=radians), []
    for name in numbers:
        shown = unit_name(name, radians=radians)
        if shown in wanted:
            try:
                found[shown] = motion.number(name, digits, radians=radians)
            except OutOfRangeError as error:
                found[shown] = None
                beyond.append(error)
    values = {name: None if number is None else number.value for name, number in found.items()}
    values["regime"] = motion.regime.value
    if "path" in wanted:
        values["path"] = motion.path
    if "remark" in wanted:
        values["remark"] = motion.remark_in(radians=radians)
    record = {name: values[name] for name in names if name in wanted}
    if radii:
        known = {name: found[name] for name in record if name in found}
        record |= {f"{name}_radius": x and x.radius for name, x in known.items()}
    return record, beyond


def _inputs(top: Top, digits: int | None, *, radians: bool) -> dict[str, Settled | None]:
    """Return the inputs as they are printed."""

    def shown(name: str, value: Any) -> Settled | None:
        rounding = rounding_of(name, digits)
        if not isinstance(value, Ball):
            return Settled(rounding(Fraction(value)), (Fraction(value),))
        return settled(
            name,
            lambda working: top.inputs(radians=radians, ar=balls(working))[name],
            rounding,
            digits=digits or 0,
        )

    given = top.inputs(radians=radians, ar=balls(FIRST_DIGITS))
    return {name: shown(name, value) for name, value in given.items()}
