"""`lagtop solve`: one record."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import AbsentError, LagtopError
from ..motion.numbers import Numbers, record_in_range
from ..motion.record import all_keys, record_keys, shown_keys
from ..motion.regime import exact
from .app import complain, write_report
from .options import (
    COUNT,
    KEY,
    KEY_NAMES,
    MOST_RECORD_DIGITS,
    certify_option,
    command,
    digits_option,
    flag,
    option,
    output_options,
)
from .top import UNCERTAIN, TopOptions, top_options, warned

if TYPE_CHECKING:
    from ..arithmetic.values import Key
    from ..inputs.units import System
    from ..motion.regime import Facts
    from ..output.destination import Output


@command(
    "solve",
    """
    lagtop solve simo-wong-1991 --r0 40
    lagtop solve --theta0 60 --get T_nutation,theta_max_deg --digits 30
    lagtop solve --r0 '477(2) rpm' --budget T_nutation
    """,
    exclusive=["--get --derivation --budget --samples"],
)
def solve_command(
    top: TopOptions = top_options(UNCERTAIN),
    keys: list[str] | None = option(
        KEY_NAMES, "Print only the values of these keys, one per line.", "--get"
    ),
    derivation: bool = flag(
        "Print the steps of section 8 of the paper, for a top released from rest."
    ),
    digits: int | None = digits_option(MOST_RECORD_DIGITS),
    certify: bool = certify_option,
    budget: str | None = option(
        KEY, "Print the uncertainty budget of KEY: the share of each input."
    ),
    samples: int | None = option(COUNT, "Check linear propagation with N random tops."),
    seed: int | None = option(COUNT, "Seed of the random tops."),
    out: Output = output_options("table", "json", "csv", "ndjson", "markdown"),
) -> None:
    """Compute the periods, turning points and mean rates of one top.

    The results are called the record, and their names keys; lagtop explain lists all keys.  Every
    number is correctly rounded, or has N correct digits with --digits N.  A quantity that a regime
    does not have is null in JSON and empty in CSV.

    Inputs may have units ('480 rpm').  Give units for all inputs that you set, or for none; the
    tilt needs none.  An input may have an uncertainty ('1587(2)').
    """
    if keys is not None:
        _check_keys(keys, top.radians)
    if seed is not None and samples is None:
        raise LagtopError("--seed needs --samples")
    found = top.given()
    on_request = any(key.endswith("_std") for key in keys or ())
    if found.stds or on_request or budget is not None or samples is not None:
        from . import uncertainty

        uncertainty.check(found, digits, derivation, certify)
    motion = warned(Numbers(exact(found.top(exact=digits is not None))), found)
    if budget is not None or samples is not None:
        find = uncertainty.asked_report(found, motion, budget, samples, seed, top.radians)
        write_report(out, find)
        return
    chosen = _steps(motion, top.radians) if derivation else keys
    wanted = list(dict.fromkeys(key.removesuffix("_std") for key in chosen)) if chosen else None
    record = _record(motion, digits, top.radians, wanted, certify)
    if found.system is not None and record.get("remark"):
        record["remark"] = found.system.in_words(record["remark"])
    is_summed = wanted is None and out.fmt != "csv"
    summed = _summary(record, motion.exact.facts, found.system) if is_summed else {}
    bare = keys is not None and not out.is_named
    if found.stds:
        drawn = out.fmt in {"table", "markdown"} and not bare
        record = uncertainty.with_stds(found, motion, record, drawn)
    if keys is not None:
        values = _numbers(motion, record, keys)
        if out.fmt == "table":
            out.values(values.values())
        else:
            out.record(values, lambda: _with_stds(_keys(found.system, top.radians, requested=True)))
    elif derivation:
        more = {x: record[x] for x in record if x.endswith("_radius") or x == "remark"}
        steps = {name: record[name] for name in chosen or ()}
        out.record(steps | more, lambda: _chain(found.system, top.radians))
    else:
        _write(record | summed, found.system, top.radians, out)


def _check_keys(keys: list[str], radians: bool) -> None:
    """Raise LagtopError for an unknown or repeated key."""
    from ..inputs.names import check_names

    values = [key.removesuffix("_std") for key in keys]
    if len(set(keys)) == len(keys):  # a number and its uncertainty are not one key twice
        values = list(dict.fromkeys(values))
    known = record_keys(radians=radians)
    check_names("get", values, known if set(values) <= {*known} else all_keys(radians=radians))


def _keys(system: System | None, radians: bool, *, requested: bool = False) -> dict[str, Key]:
    named = str if system is None else system.named
    return shown_keys(radians=radians, named=named, requested=requested)


def _with_stds(keys: dict[str, Key]) -> dict[str, Key]:
    """Return keys and those of their uncertainties."""
    stds = {
        f"{name}_std": key.replace(symbol="", meaning=f"uncertainty of {name}", equation="")
        for name, key in keys.items()
    }
    return keys | stds


def _chain(system: System | None, radians: bool) -> dict[str, Key]:
    """Return the keys of the steps of section 8, in order."""
    from ..motion.paper.requested import CHAIN
    from ..motion.quantity import unit_name

    keys = _keys(system, radians, requested=True)
    chain = {unit_name(x, radians=radians): step for step, names in CHAIN.items() for x in names}
    return {name: keys[name].replace(group=step) for name, step in chain.items()}


def _summary(record: dict[str, Any], facts: Facts, system: System | None) -> dict[str, str]:
    """Return the sentence on a motion, by its key, unless one of its numbers is out of range."""
    from ..motion.summary import summary

    try:
        return {"summary": summary(record, facts, str if system is None else system.named)}
    except TypeError:  # a number beyond the range of doubles is None
        return {}


def _write(record: dict[str, Any], system: System | None, radians: bool, out: Output) -> None:
    """Write a record, with units if its inputs have any."""
    if system is not None and out.fmt in {"json", "ndjson"}:
        keys = _keys(system, radians).items()
        record |= {"units": {name: key.unit for name, key in keys if name in record and key.unit}}
    out.record(record, lambda: _keys(system, radians))


def _record(
    motion: Numbers, digits: int | None, radians: bool, keys: list[str] | None, certify: bool
) -> dict[str, Any]:
    """Return the record, or some keys of it; warn of numbers beyond the range of doubles."""
    record, beyond = record_in_range(
        motion, digits=digits, radii=certify, radians=radians, keys=keys
    )
    if beyond and keys:
        raise beyond[0]
    if beyond:
        complain("Warning: " + "; ".join(map(str, beyond)))
    return record


def _numbers(motion: Numbers, record: dict[str, Any], keys: list[str]) -> dict[str, Any]:
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


def _steps(motion: Numbers, radians: bool) -> list[str]:
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
