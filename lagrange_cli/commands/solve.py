"""`lagtop solve`: one record."""

from __future__ import annotations

from typing import Any

import click

from ..options import (
    MOST_RECORD_DIGITS,
    ExamplesFirst,
    digits_option,
    output_options,
    scene_options,
    solved,
)
from ..output import write_record


@click.command(
    "solve",
    cls=ExamplesFirst,
    examples="""
        lagtop solve --theta0 30
        lagtop solve sample_inputs/simo-wong-1991.toml --r0 40
        lagtop solve --r0 -20 --theta0 120 --format json | jq .T_nutation
        lagtop solve --theta0 60 --psidot0 -3 --digits 50
        lagtop solve --rad --theta0 0.05 --format csv -o solved.csv
    """,
)
@scene_options
@digits_option(MOST_RECORD_DIGITS)
@output_options("table", "json", "csv")
def command(
    scene: str | None, rad: bool, digits: int | None, style: str, output: str, **options: Any
) -> None:
    """Roots, moduli, periods and mean rates of one top.

    Every number is the double nearest to its exact value, or has --digits right digits.  JSON and
    CSV hold the same keys; what a regime does not have is null or empty.
    """
    motion = solved(scene, rad, digits is not None, options)
    if digits is None:
        record = motion.record(radians=rad)
    else:
        from ..digits import settled_record

        record = settled_record(motion.top, digits, radians=rad)
    write_record(record, style, output)
