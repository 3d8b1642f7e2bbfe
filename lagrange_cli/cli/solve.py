"""`lagtop solve`: one record, or selected keys of it (`--get` and `--derivation`)."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from ..account.summary import summary
from ..arithmetic.text import value_text
from ..errors import AbsentError, LagtopError, OutOfRangeError, joined
from ..names import RADIUS, Key, check_names
from ..output.destination import Output
from ..output.document import Document, Lines, record_document
from ..solver.facts import Regime
from ..solver.keys import all_keys, derivation_keys, key_of, shown_keys
from ..solver.record import record_in_range
from ..solver.solve import Motion
from ..top.units import Units
from . import shared as opt
from .app import complain


@opt.command(
    "solve",
    "solve simo-wong-1991 --r0 40",
    "solve --theta0 60 --get T_nutation,theta_max_deg --digits 30",
    "solve --r0 '477(2) rpm' --budget T_nutation",
)
@opt.top()
@opt.option("--get", type=opt.LIST, help="Print only the values of these keys, one per line.")
@opt.option(
    "--derivation", is_flag=True, help="Print the steps of Chrapan's section 8 (release from rest)."
)
@opt.digits(opt.MOST_RECORD_DIGITS)
@opt.certify
@opt.option("--budget", metavar="KEY", help="Print each input's share of the uncertainty of KEY.")
@opt.option(
    "--samples",
    type=opt.count(10**5),
    help="Estimate uncertainties from N random tops (normally distributed inputs).",
)
@opt.output("table")
def solve_command(
    top: opt.TopOptions,
    get: list[str] | None,
    derivation: bool,
    digits: int | None,
    certify: bool,
    budget: str | None,
    samples: int | None,
    out: Output,
) -> None:
    """Compute the periods, turning points and mean rates of one top.

    The results form the record, and their names are keys: lagtop explain lists all keys.  Every
    number is correctly rounded, or has N correct digits with --digits N.  A quantity that is
    undefined in a regime is null in JSON and empty in CSV.

    Inputs may have units ('480 rpm').  Give units for all inputs that you set, or for none; the
    tilt needs none.  An input may have an uncertainty ('1587(2)').
    """
    opt.exclude(get=get, derivation=derivation, budget=budget)
    found = top.given()
    units = found.units(radians=top.radians)
    if get is not None:
        get = _selected(get, units)
    of_stds = [key for key in get or () if key.endswith("_std")]
    if samples and get and not of_stds and not out.is_named:
        raise LagtopError(f"--samples estimates uncertainties: add {get[0]}_std to --get")
    opt.exclude(budget=budget, samples=samples)
    if found.stds or budget is not None or samples or of_stds:
        from . import uncertainty

        uncertainty.check(found, digits=digits, derivation=derivation, certify=certify)
    motion = opt.motion_of(found, exact=digits is not None)
    if budget is not None:
        budget = key_of(budget, units)
        from ..account.uncertain import budget as budget_of

        report, is_linear = budget_of(found, motion, budget, units)
        remedy = "use --samples 10000 in place of --budget"
        uncertainty.warn_of_nonlinear([] if is_linear else [budget], remedy)
        opt.write_report(out, lambda: report)
        return
    steps = _steps_of_section_8(motion, units) if derivation else {}
    names = [*steps] or get
    wanted = list(dict.fromkeys(name.removesuffix("_std") for name in names)) if names else None
    record, beyond = record_in_range(motion, keys=wanted, digits=digits, radii=certify, units=units)
    if beyond and wanted:
        raise beyond[0]
    if beyond:
        complain(f"Warning: {joined(beyond).marked}")
    more: dict[str, Any] = {}
    if wanted is None:
        with suppress(OutOfRangeError):  # there are no words for such a number
            more["summary"] = summary(motion, units)
    shown: dict[str, Any] = {}
    if found.stds:
        record, shown = uncertainty.with_stds(found, motion, record, samples)
    if get is not None:
        _write_selected(motion, record, shown, get, out)
        return
    keys = steps or shown_keys(units)
    if steps:
        record = {x: record[x] for x in [*steps, *record]}
    elif units.si:
        more["units"] = {x: key.unit for x, key in keys.items() if x in record and key.unit}
    if "regime" in record and motion.regime is Regime.SLEEPING and not motion.facts.stable:
        shown["regime"] = f"{record['regime']}, unstable"
    out.document(record_document(record, lambda: keys, more, shown))


def _selected(words: Sequence[str], units: Units) -> list[str]:
    """Return the keys that words or symbols name.

    Raises LagtopError for an unknown or a repeated key.
    """
    keys = [key_of(word, units) for word in words]
    values = [key.removesuffix("_std") for key in keys]
    if len(set(keys)) == len(keys):  # a number and its uncertainty are not one key twice
        values = list(dict.fromkeys(values))
    check_names("get", values, all_keys(units))
    return keys


def _write_selected(
    motion: Motion,
    record: dict[str, Any],
    shown: dict[str, Any],
    keys: Sequence[str],
    out: Output,
) -> None:
    """Write some values of the record, each with its radius, if any; missing ones are empty.

    Raises AbsentError, after writing, if the motion lacks some of the numbers, and before it if it
    lacks all.  Raises LagtopError for the uncertainty of a text.
    """
    for key in keys:
        if key not in record:
            text = key.removesuffix("_std")
            raise LagtopError(f"{text} has no uncertainty: leave {key} out of --get")
    reasons = [f"{key} is {_absence(motion, record, key)}" for key in keys if record[key] is None]
    if len(reasons) < len(keys):
        record = {x: record[x] for key in keys for x in (key, f"{key}{RADIUS}") if x in record}
        texts = record | shown if out.is_named else record
        values = Lines([value_text(texts[key]) for key in record])
        out.document(Document([*record], [record], lambda _: [values], record))
    if reasons:
        raise AbsentError("; ".join(reasons))


def _absence(motion: Motion, record: dict[str, Any], key: str) -> str:
    """Return why a record has no value for a key."""
    number = key.removesuffix("_std")
    if number != key and record.get(number) is not None:
        return "undefined, as the warning says"
    return motion.absence(number)


def _steps_of_section_8(motion: Motion, units: Units) -> dict[str, Key]:
    """Return the keys of the steps of section 8.  Raises AbsentError if they do not hold."""
    if motion.roots_sum is None:
        top = motion.top
        raise AbsentError(
            "--derivation needs a top that nutates after release from rest, got the "
            f"regime {motion.regime.value!r}, thetadot0 = {float(top.thetadot0)}, "
            f"psidot0 = {float(top.psidot0)}"
        )
    return derivation_keys(units)
