"""The command line: parse, one library call, one writer."""

from __future__ import annotations

from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING, Any

import click

from . import __version__
from .motion import Motion, solve
from .options import (
    COUNT,
    MOST_RECORD_DIGITS,
    MOST_TABLE_DIGITS,
    NUMBER,
    LagtopGroup,
    complain,
    digits_option,
    output_options,
    scene_options,
    with_progress,
)
from .output import MAX_TABLE_ROWS, write_record, write_rows, write_texts
from .top import LagtopError, Number, build_top

if TYPE_CHECKING:
    from .table import Times


def solved(
    scene: str | None, rad: bool, exact: bool, options: dict[str, Fraction | None]
) -> Motion:
    """The motion of the top in a scene file, if any, and in the options, which win."""
    given: dict[str, Number] = {key: x for key, x in options.items() if x is not None}
    if "theta0" in given:
        given["theta0_rad" if rad else "theta0_deg"] = given.pop("theta0")
    motion = solve(build_top(given, exact=exact)) if scene is None else _of(scene, given, exact)
    if caveat := motion.top.caveat():
        complain(f"Warning: {caveat}")
    return motion


def _of(scene: str, given: dict[str, Number], exact: bool) -> Motion:
    from .scene import SceneFile

    file = SceneFile(scene)
    tilt_given = any(key.startswith("theta0_") for key in given)
    inputs = {x: y for x, y in file.inputs.items() if not (tilt_given and x.startswith("theta0_"))}
    try:
        return solve(build_top(inputs | given, exact=exact))
    except LagtopError as error:
        raise error if error.key in given else file.error(error) from None


@click.group(
    cls=LagtopGroup,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    examples="""
        lagtop solve --theta0 30
        lagtop solve sample_inputs/chrapan-1952.toml --format json
        lagtop table --t-max 1 > out.csv
    """,
)
@click.version_option(__version__, prog_name="lagtop")
@click.pass_context
def main(ctx: click.Context) -> None:
    """The Lagrange top, a heavy symmetric top with a fixed point, in closed form.

    Inputs default to the worked example of J. Chrapan (1952); any consistent units will do.
    """
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


@main.command(
    "solve",
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
def solve_command(
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
        from .digits import settled_record

        record = settled_record(motion.top, digits, radians=rad)
    write_record(record, style, output)


@main.command(
    "table",
    examples="""
        lagtop table --t-max 1 > out.csv
        lagtop table sample_inputs/fast-gyroscope.toml --t-max 10 --dt 0.01 --wrap
        lagtop table --t-min -5 --t-max 5 --n 1e6 --rad -o angles.csv
        lagtop table --t-max 1 --columns t,axis,energy
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
    metavar="NAMES",
    help="Of t theta phi psi u thetadot phidot psidot p q r axis quaternion energy Lz, with commas "
    "between.  [default: t,theta,phi,psi]",
)
@click.option("--wrap", is_flag=True, help="Spin and precession in (-180, 180].")
@digits_option(MOST_TABLE_DIGITS)
@output_options("csv", "json", "table")
def table_command(  # noqa: PLR0917 - click passes them by name
    scene: str | None,
    rad: bool,
    t_max: Fraction | None,
    t_min: Fraction | None,
    count: int | None,
    dt: Fraction | None,
    times: str | None,
    columns: str | None,
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
    from .table import DEFAULT_COLUMNS, digit_rows, grid, read_times, rows

    _exclude({"--n": count, "--dt": dt})
    _exclude({"--columns": columns, "--digits": digits})
    for name, value in {"--t-max": t_max, "--t-min": t_min, "--n": count, "--dt": dt}.items():
        _exclude({"--times": times, name: value})
    motion = solved(scene, rad, digits is not None, options)
    chosen: Times = (
        read_times(times) if times is not None else grid(motion, t_min, t_max, n=count, dt=dt)
    )
    if style == "table" and chosen.count > MAX_TABLE_ROWS:
        raise LagtopError(f"--format table shows at most {MAX_TABLE_ROWS} rows, got {chosen.count}")
    names = DEFAULT_COLUMNS if columns is None else columns.replace(",", " ").split()
    header, blocks = rows(motion, chosen, names, radians=rad, wrap=wrap)
    if digits is None:
        write_rows(header, with_progress(blocks, chosen.count, 3_000_000), style, output)
    else:
        parts = digit_rows(motion, chosen, digits, radians=rad, wrap=wrap)
        texts = chain.from_iterable(with_progress(parts, chosen.count, 1000))
        write_texts(header, texts, style, output)


def _exclude(options: dict[str, Any]) -> None:
    given = [name for name, value in options.items() if value is not None]
    if len(given) > 1:
        raise LagtopError(f"{given[0]} and {given[1]} exclude each other: leave one out")


if __name__ == "__main__":
    main()
