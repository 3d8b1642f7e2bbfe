"""`lagtop solve`: one record."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from ..errors import AbsentError, LagtopError
from ..motion.record import all_keys, record_keys
from ..motion.solve import record_in_range
from ..output.write import write_record, write_values
from .command import (
    ExamplesFirst,
    chain_layout,
    complain,
    in_units,
    top_layout,
    units_of,
    write_keys,
    write_report,
)
from .options import (
    COUNT,
    KEY_NAMES,
    MOST_RECORD_DIGITS,
    certify_option,
    digits_option,
    exclude,
    on_command_line,
    output_options,
)
from .top_options import UNCERTAIN, input_options, inputs_of, motion_of, scene_argument

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..inputs.units import System
    from ..motion.solve import Motion
    from ..output.layouts import Layout


@click.command(
    "solve",
    cls=ExamplesFirst,
    shows=write_keys,
    examples="""
        lagtop solve --theta0 30
        lagtop solve sample_inputs/simo-wong-1991.toml --r0 40
        lagtop solve --r0 -20 --theta0 120 --format json | jq .T_nutation
        lagtop solve --theta0 60 --psidot0 -3 --digits 50
        period=$(lagtop solve --r0 80 --get T_nutation)
        lagtop solve --r0 80 --get theta_min_deg,theta_max_deg
        lagtop solve --theta0 60 --get psi_period_deg
        lagtop solve --m 350g --A 8.5e-4kg*m^2 --C 4e-4kg*m^2 --s 3cm --g 1g_0 --r0 12000rpm
        lagtop solve --theta0 60 --derivation
        lagtop solve --digits 30 --certify --format json
        lagtop solve --m '1587(2)' --theta0 '30 +/- 1 %'
        lagtop solve --m '1587(2)' --theta0 '30(1)' --budget T_nutation
        lagtop solve --theta0 '30(1)' --samples 100000 --seed 1
        lagtop solve --rad --theta0 0.05 -o solved.csv
    """,
)
@scene_argument
@input_options(UNCERTAIN)
@digits_option(MOST_RECORD_DIGITS)
@click.option(
    "--derivation",
    is_flag=True,
    help="The steps of the paper's worked example, section 8, for a top released from rest.",
)
@click.option(
    "--get",
    "keys",
    type=KEY_NAMES,
    metavar="KEY,...",
    help="Print values of the record, bare, one per line; the keys stand below.",
)
@certify_option
@click.option(
    "--budget", metavar="KEY", help="What each uncertain input contributes to a number (GUM)."
)
@click.option(
    "--samples",
    type=COUNT,
    metavar="N",
    help="Monte Carlo: quantiles of N random tops, and whether first order holds.",
)
@click.option("--seed", type=COUNT, metavar="N", help="Seed of the random tops.")
@output_options("table", "json", "csv")
def command(
    scene: str | None,
    rad: bool,
    digits: int | None,
    certify: bool,
    derivation: bool,
    keys: list[str] | None,
    budget: str | None,
    samples: int | None,
    seed: int | None,
    fmt: str,
    output: str,
    **options: Any,
) -> None:
    """Roots, moduli, periods and mean rates of one top.

    Every number is the double nearest to its exact value, or has --digits right digits.  JSON and
    CSV hold the same keys; what a regime does not have is null or empty.

    All inputs or none may have units (pip install 'lagtop[units]'); the output is then in SI, or in
    --units cgs, and JSON names them.

    An input may be uncertain: '1587(2)', '1587+/-2' or '1587 +/- 0.1 %'.  Then numbers
    are shown with their standard uncertainties, of first order by exact derivatives; JSON and CSV
    have them as KEY_std after the record.
    """
    exclude(
        {
            "--get": keys,
            "--derivation": derivation or None,
            "--budget": budget,
            "--samples": samples,
        }
    )
    if keys is not None:
        exclude({"--get": keys, "--format": fmt if on_command_line("fmt") else None})
        _check_keys(keys, rad)
    if seed is not None and samples is None:
        raise LagtopError("--seed is that of random tops: it needs --samples")
    found = inputs_of(scene, rad, options)
    on_request = any(key.endswith("_std") for key in keys or ())
    if found.stds or on_request or budget is not None or samples is not None:
        from . import uncertainty

        uncertainty.check(found, digits, derivation, certify)
    motion = motion_of(found, digits is not None)
    if budget is not None or samples is not None:
        find = uncertainty.asked_report(found, motion, budget, samples, seed, rad)
        write_report(find, fmt, output)
        return
    chosen = _steps(motion, rad) if derivation else keys
    wanted = list(dict.fromkeys(key.removesuffix("_std") for key in chosen)) if chosen else None
    record = _record(motion, digits, rad, wanted, certify)
    if found.system is not None and record.get("remark"):
        record["remark"] = found.system.in_words(record["remark"])
    if found.stds:
        record = uncertainty.with_stds(found, motion, record, fmt == "table" and keys is None)
    if keys is not None:
        write_values([_number(motion, record, key) for key in keys], output)
    elif derivation:
        more = {x: record[x] for x in record if x.endswith("_radius") or x == "remark"}
        steps = {name: record[name] for name in chosen or ()}
        _write(steps | more, found.system, fmt, output, chain_layout)
    else:
        _write(record, found.system, fmt, output, top_layout)


def _check_keys(keys: list[str], radians: bool) -> None:
    """Raise LagtopError for a key that no motion has, or that comes twice."""
    from ..inputs.names import check_names

    values = [key.removesuffix("_std") for key in keys]
    if len(set(keys)) == len(keys):  # a number and its uncertainty are not one key twice
        values = list(dict.fromkeys(values))
    known = record_keys(radians=radians)
    check_names("get", values, known if set(values) <= {*known} else all_keys(radians=radians))


def _write(
    record: dict[str, Any],
    system: System | None,
    fmt: str,
    output: str,
    layout: Callable[[], Layout],
) -> None:
    """Write a record, with units where its inputs had any."""
    if system is None:
        write_record(record, fmt, output, layout)
        return
    named = in_units(layout(), system.named)
    if fmt == "json":
        record = record | {"units": units_of(record, named)}
    write_record(record, fmt, output, lambda: named)


def _record(
    motion: Motion, digits: int | None, radians: bool, keys: list[str] | None, certify: bool
) -> dict[str, Any]:
    """Return the record, or some keys of it; of what is beyond the range of doubles, say so."""
    record, beyond = record_in_range(
        motion, digits=digits, radii=certify, radians=radians, keys=keys
    )
    if beyond and keys:
        raise beyond[0]
    if beyond:
        complain("Warning: " + "; ".join(map(str, beyond)))
    return record


def _number(motion: Motion, record: dict[str, Any], key: str) -> Any:
    """Return a value of the record.  Raises AbsentError where the regime has none."""
    if record[key] is None:
        raise AbsentError(f"a top of the regime {motion.regime.value!r} has no {key}")
    return record[key]


def _steps(motion: Motion, radians: bool) -> list[str]:
    """Return the keys of the steps of section 8.  Raises AbsentError where they do not hold."""
    from ..motion.paper.worked_example import derivation_keys

    if motion.roots_sum is None:
        top = motion.top
        raise AbsentError(
            "--derivation must be of a top that nutates after release from rest, got one of the "
            f"regime {motion.regime.value!r}, thetadot0 = {float(top.thetadot0)}, "
            f"psidot0 = {float(top.psidot0)}"
        )
    return derivation_keys(radians=radians)
