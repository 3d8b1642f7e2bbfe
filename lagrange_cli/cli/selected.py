"""Selected keys of a record: `lagtop solve --get` and `--derivation`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ..errors import AbsentError, LagtopError
from ..inputs.names import check_names
from ..motion.quantity import unit_name
from ..motion.record import all_keys, record_keys

if TYPE_CHECKING:
    from ..arithmetic.values import Key
    from ..motion.numbers import Numbers

_Keys = dict[str, "Key"]


def check_selected(keys: Sequence[str], radians: bool) -> None:
    """Raise LagtopError for an unknown or repeated key."""
    values = [key.removesuffix("_std") for key in keys]
    if len(set(keys)) == len(keys):  # a number and its uncertainty are not one key twice
        values = list(dict.fromkeys(values))
    known = record_keys(radians=radians)
    check_names("get", values, known if set(values) <= {*known} else all_keys(radians=radians))


def chosen_values(motion: Numbers, record: dict[str, Any], keys: Sequence[str]) -> dict[str, Any]:
    """Return values of the record, each with its radius, if any.

    Raises AbsentError if the motion has no such number, LagtopError for the uncertainty of a text.
    """
    for key in keys:
        if key not in record:
            text = key.removesuffix("_std")
            raise LagtopError(f"{text} has no uncertainty: leave {key} out of --get")
        if record[key] is None:
            raise AbsentError(f"{key} is undefined {motion.absence(key)}")
    return {x: record[x] for key in keys for x in (key, f"{key}_radius") if x in record}


def with_std_keys(keys: _Keys) -> _Keys:
    """Return keys and those of their uncertainties."""
    stds = {
        f"{name}_std": key.replace(symbol="", meaning=f"uncertainty of {name}", equation="")
        for name, key in keys.items()
    }
    return keys | stds


def steps_of_section_8(motion: Numbers, radians: bool) -> list[str]:
    """Return the keys of the steps of section 8.  Raises AbsentError if they do not hold."""
    from ..motion.paper.requested import derivation_keys

    if motion.roots_sum is None:
        top = motion.top
        raise AbsentError(
            "--derivation must be of a top that nutates after release from rest, got one of the "
            f"regime {motion.regime.value!r}, thetadot0 = {float(top.thetadot0)}, "
            f"psidot0 = {float(top.psidot0)}"
        )
    return derivation_keys(radians=radians)


def steps_in_order(record: dict[str, Any], names: Sequence[str]) -> dict[str, Any]:
    """Return the values of the steps in their order, with their radii and the remark, if any."""
    more = {x: record[x] for x in record if x.endswith("_radius") or x == "remark"}
    return {name: record[name] for name in names} | more


def keys_by_step(keys: _Keys, radians: bool) -> _Keys:
    """Return the keys of the steps of section 8, in order and grouped by step."""
    from ..motion.paper.requested import CHAIN

    chain = {unit_name(x, radians=radians): step for step, names in CHAIN.items() for x in names}
    return {name: keys[name].replace(group=step) for name, step in chain.items()}
