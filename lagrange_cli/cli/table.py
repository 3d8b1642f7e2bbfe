"""`lagtop table`: angles, rates and attitude over time."""

from __future__ import annotations

from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING, Any

import click

from ..errors import LagtopError
from ..output.write import MAX_TABLE_ROWS, write_rows, write_text_blocks, write_texts
from .options import (
    COUNT,
    MOST_TABLE_DIGITS,
    NAMES,
    NUMBER,
    ExamplesFirst,
    by_key,
    digits_option,
    exclude,
    output_options,
    scene_options,
    solved,
)
from .progress import with_progress

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..motion.solve import Motion


@click.command(
    "table",
    cls=ExamplesFirst,
    examples="""
        lagtop table --t-max 1 > out.csv
        lagtop table sample_inputs/fast-gyroscope.toml --t-max 10 --dt 0.01 --wrap
        lagtop table --t-min -5 --t-max 5 --n 1e6 --rad -o angles.csv
        lagtop table --t-max 1 --columns t,axis,energy
        lagtop table --tops tops.csv --t-max 1 --n 11
        seq 0 0.25 2 | lagtop table --times - --format json
    """,
)
@scene_options
@click.option("--t-max", type=NUMBER, help="Last time.  [default: one nutation period, or 1]")
@click.option("--t-min", type=NUMBER, help="First time.  [default: 0]")
@click.option("--n", "count", type=COUNT, help="Number of times.  [default: 101]")
@click.option("--dt", type=NUMBER, help="Step, instead of --n.")
@click.option(
    "--times",
    type=click.Path(allow_dash=True),
    metavar="FILE|-",
    help="Times from a file, one a line, instead of a grid.",
)
@click.option(
    "--columns",
    type=NAMES,
    help="Of t theta phi psi u thetadot phidot psidot p q r axis quaternion energy Lz, with commas "
    "between.  [default: t,theta,phi,psi]",
)
@click.option(
    "--tops",
    type=click.Path(allow_dash=True),
    metavar="FILE|-",
    help="A table of each top in a file, CSV or JSON lines as for `sweep`, one after the other.",
)
@click.option("--wrap", is_flag=True, help="Spin and precession in (-180, 180].")
@digits_option(MOST_TABLE_DIGITS)
@output_options("csv", "json", "table")
def command(  # noqa: PLR0917 - click passes them by name
    scene: str | None,
    rad: bool,
    t_max: Fraction | None,
    t_min: Fraction | None,
    count: int | None,
    dt: Fraction | None,
    times: str | None,
    columns: list[str] | None,
    tops: str | None,
    wrap: bool,
    digits: int | None,
    style: str,
    output: str,
    **options: Any,
) -> None:
    """Tilt theta, spin phi and precession psi over time, and more with --columns.

    Right to a few roundings of the angle (or of 1 rad, if that is larger) at any time up to 2^50
    nutation periods away.  Spin and precession count on from 0 at t = 0 unless --wrap.
    """
    from ..inputs.times_file import TimesFile
    from ..motion.table import DEFAULT_COLUMNS, digit_rows, grid, rows

    exclude({"--n": count, "--dt": dt})
    exclude({"--columns": columns, "--digits": digits})
    exclude({"--tops": tops, "--digits": digits})
    exclude(
        {"--tops -": tops if tops == "-" else None, "--times -": times if times == "-" else None}
    )
    for name, value in {"--t-max": t_max, "--t-min": t_min, "--n": count, "--dt": dt}.items():
        exclude({"--times": times, name: value})
    file = None if times is None else TimesFile(times)
    listed = None  # all tops, and the one width of a rich table, need the times more than once
    if file and (tops is not None or style == "table"):
        listed = file.listed(None if tops is not None else MAX_TABLE_ROWS + 1)

    def times_of(motion: Motion) -> Points:
        return listed or file or grid(motion, t_min, t_max, n=count, dt=dt)

    names = DEFAULT_COLUMNS if columns is None else columns
    if tops is not None:
        if style == "table":
            raise LagtopError("--format table shows one top: with --tops take csv or json")
        from ..sweeps.parts import Tally
        from ..sweeps.plan import shared_inputs
        from ..sweeps.tables import open_tables

        given = shared_inputs(scene, by_key(options, radians=rad))
        tables = open_tables(tops, given, names, times_of, radians=rad, wrap=wrap, style=style)
        tally = Tally()
        passing = tally.passing(tables.parts())
        write_text_blocks(style, tables.header, (part.text for part in passing), output)
        tally.check()
        return
    motion = solved(scene, rad, digits is not None, options)
    chosen = times_of(motion)
    if style == "table" and chosen.count > MAX_TABLE_ROWS:
        raise LagtopError(f"--format table shows at most {MAX_TABLE_ROWS} rows, got {chosen.count}")
    header, blocks = rows(motion, chosen, names, radians=rad, wrap=wrap)
    if digits is None:
        write_rows(header, with_progress(blocks, chosen.count, 3_000_000), style, output)
    else:
        parts = digit_rows(motion, chosen, digits, radians=rad, wrap=wrap)
        texts = chain.from_iterable(with_progress(parts, chosen.count, 1000))
        write_texts(header, texts, style, output)
