"""`lagtop solve`: one record."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import LagtopError
from ..motion.numbers import Numbers, record_in_range
from ..motion.record import shown_keys
from ..motion.regime import exact
from . import options as opt
from .app import complain
from .top import UNCERTAIN, TopOptions, top_options, warned

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..arithmetic.values import Key
    from ..inputs.units import System
    from ..output.destination import Output


@opt.command(
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
    keys: list[str] | None = opt.key_names(
        "Print only the values of these keys, one per line.", "--get"
    ),
    derivation: bool = opt.flag(
        "Print the steps of section 8 of the paper, for a top released from rest."
    ),
    digits: int | None = opt.digits(opt.MOST_RECORD_DIGITS),
    certify: bool = opt.certify,
    budget: str | None = opt.option(
        opt.KEY, "Print the uncertainty budget of KEY: the share of each input."
    ),
    samples: int | None = opt.count("Check linear propagation with N random tops."),
    seed: int | None = opt.count("Seed of the random tops."),
    out: Output = opt.output("table", "json", "csv", "ndjson", "markdown"),
) -> None:
    """Compute the periods, turning points and mean rates of one top.

    The results are called the record, and their names keys; lagtop explain lists all keys.  Every
    number is correctly rounded, or has N correct digits with --digits N.  A quantity that a regime
    does not have is null in JSON and empty in CSV.

    Inputs may have units ('480 rpm').  Give units for all inputs that you set, or for none; the
    tilt needs none.  An input may have an uncertainty ('1587(2)').
    """
    radians = top.radians
    if keys is not None or derivation:
        from . import selected
    if keys is not None:
        selected.check_selected(keys, radians)
    if seed is not None and samples is None:
        raise LagtopError("--seed needs --samples")
    found = top.given()
    asked = budget is not None or samples is not None
    if found.stds or asked or any(key.endswith("_std") for key in keys or ()):
        from . import uncertainty

        uncertainty.check(found, digits, derivation, certify)
    motion = warned(Numbers(exact(found.top(exact=digits is not None))), found)
    if asked:
        uncertainty.write_uncertainty(found, motion, budget, samples, seed, radians, out)
        return
    names = selected.steps_of_section_8(motion, radians) if derivation else keys
    wanted = list(dict.fromkeys(name.removesuffix("_std") for name in names)) if names else None
    record = _record(motion, found.system, wanted, digits=digits, radii=certify, radians=radians)
    is_summed = wanted is None and out.fmt != "csv"
    named = str if found.system is None else found.system.named
    summed = _summary(record, motion, named) if is_summed else {}
    if found.stds:
        drawn = out.fmt in {"table", "markdown"} and (keys is None or out.is_named)
        record = uncertainty.with_stds(found, motion, record, drawn)

    def shown() -> dict[str, Key]:
        return shown_keys(radians=radians, named=named, requested=names is not None)

    if keys is not None:
        values = selected.chosen_values(motion, record, keys)
        if out.fmt == "table":
            out.values(values.values())
        else:
            out.record(values, lambda: selected.with_std_keys(shown()))
    elif names is not None:
        out.record(
            selected.steps_in_order(record, names), lambda: selected.keys_by_step(shown(), radians)
        )
    else:
        units = {}
        if found.system is not None and out.fmt in {"json", "ndjson"}:
            units = {name: x.unit for name, x in shown().items() if name in record and x.unit}
        out.record(record | summed | ({"units": units} if units else {}), shown)


def _record(
    motion: Numbers, system: System | None, keys: list[str] | None, **how: Any
) -> dict[str, Any]:
    """Return the record, or some keys of it; warn of numbers beyond the range of doubles.

    `how` holds the other arguments of `record_in_range`.
    """
    record, beyond = record_in_range(motion, keys=keys, **how)
    if beyond and keys:
        raise beyond[0]
    if beyond:
        complain("Warning: " + "; ".join(map(str, beyond)))
    if system is not None and record.get("remark"):
        record["remark"] = system.in_words(record["remark"])
    return record


def _summary(
    record: dict[str, Any], motion: Numbers, named: Callable[[str], str]
) -> dict[str, str]:
    """Return the sentence on a motion, by its key, unless one of its numbers is out of range."""
    from ..motion.summary import summary

    try:
        return {"summary": summary(record, motion.exact.facts, named)}
    except TypeError:  # a number beyond the range of doubles is None
        return {}
