"""`lagtop solve`: one record."""

from __future__ import annotations

from typing import Any

import click

from ..errors import AbsentError, LagtopError
from ..motion.record import record_keys
from ..output.write import write_record, write_value
from .command import ExamplesFirst, top_layout, write_keys
from .options import (
    MOST_RECORD_DIGITS,
    digits_option,
    exclude,
    given,
    output_options,
    scene_options,
    solved,
)


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
        lagtop solve --rad --theta0 0.05 --format csv -o solved.csv
    """,
)
@scene_options
@digits_option(MOST_RECORD_DIGITS)
@click.option(
    "--get", "key", metavar="KEY", help="Print one value of the record, bare; the keys stand below."
)
@output_options("table", "json", "csv")
def command(
    scene: str | None,
    rad: bool,
    digits: int | None,
    key: str | None,
    fmt: str,
    output: str,
    **options: Any,
) -> None:
    """Roots, moduli, periods and mean rates of one top.

    Every number is the double nearest to its exact value, or has --digits right digits.  JSON and
    CSV hold the same keys; what a regime does not have is null or empty.
    """
    if key is not None:
        exclude({"--get": key, "--format": fmt if given("fmt") else None})
        names = record_keys(radians=rad)
        if key not in names:
            raise LagtopError(f"--get must be among {' '.join(names)}, got {key!r}")
    keys = None if key is None else [key]
    motion = solved(scene, rad, digits is not None, options)
    if digits:
        record = motion.digits(digits, radians=rad, keys=keys)
    else:
        record = motion.record(radians=rad, keys=keys)
    if key is None:
        write_record(record, fmt, output, top_layout)
        return
    if record[key] is None:
        raise AbsentError(f"a top of the regime {motion.regime.value!r} has no {key}")
    write_value(record[key], output)
