"""`lagtop table`: angles, rates and attitude over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from .. import __version__
from ..arithmetic.text import value_text
from ..errors import LagtopError
from ..output.formats import Header
from ..output.write import MAX_TABLE_ROWS, write_table, write_text_blocks
from .command import ExamplesFirst, write_columns
from .options import (
    COLUMN_NAMES,
    COUNT,
    FILE,
    MOST_TABLE_DIGITS,
    certify_option,
    digits_option,
    exclude,
    output_options,
)
from .progress import with_progress
from .row_options import dialect, header_comments_option, is_described, jobs_option, text_options
from .top_options import (
    TIME,
    UNCERTAIN,
    angle_stds,
    blaming,
    by_key,
    in_seconds,
    input_options,
    inputs_of,
    motion_of,
    say_missing,
    say_no_tops,
    scene_argument,
)

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..inputs.given import Given
    from ..inputs.units import System
    from ..inputs.value import Value
    from ..motion.over_time.times import TableRequest
    from ..motion.solve import Motion


@click.command(
    "table",
    cls=ExamplesFirst,
    shows=write_columns,
    examples="""
        lagtop table --t-max 1 > out.csv
        lagtop table sample_inputs/fast-gyroscope.toml --t-max 10 --dt 0.01 --wrap
        lagtop table --t-min -5 --t-max 5 --n 1e6 --rad -o angles.csv
        lagtop table --t-max 1 --columns t,axis,energy
        lagtop table --t-max 1e9 --n 3 --digits 30 --certify --format json
        lagtop table --theta0 '30(1)' --t-max 1 --n 11
        lagtop table --tops tops.csv --t-max 1 --n 11 --jobs auto
        seq 0 0.25 2 | lagtop table --times - --format json
    """,
)
@scene_argument
@input_options(UNCERTAIN)
@click.option("--t-max", type=TIME, help="Last time.  [default: one nutation period, or 1]")
@click.option("--t-min", type=TIME, help="First time.  [default: 0]")
@click.option("--n", "count", type=COUNT, help="Number of times.  [default: 101]")
@click.option("--dt", type=TIME, help="Step, instead of --n.")
@click.option(
    "--times",
    type=FILE,
    metavar="FILE|-",
    help="Times from a file, one per line, instead of a grid.",
)
@click.option(
    "--columns",
    type=COLUMN_NAMES,
    help="Names of columns, which stand below, with commas between; parts such as quaternion_w "
    "are columns too.  [default: t,theta,phi,psi]",
)
@click.option(
    "--tops",
    type=FILE,
    metavar="FILE|-",
    help="A table of each top in a file, CSV or JSON lines as for `sweep`, one after the other.",
)
@jobs_option
@click.option("--wrap", is_flag=True, help="Spin and precession in (-180, 180].")
@digits_option(MOST_TABLE_DIGITS)
@certify_option
@text_options
@header_comments_option
@output_options("csv", "json", "table", "parquet", "npy")
def command(
    scene: str | None,
    rad: bool,
    t_max: Value | None,
    t_min: Value | None,
    count: int | None,
    dt: Value | None,
    times: str | None,
    columns: list[str] | None,
    tops: str | None,
    jobs: int | None,
    wrap: bool,
    digits: int | None,
    certify: bool,
    fmt: str,
    output: str,
    **options: Any,
) -> None:
    """Tilt theta, spin phi and precession psi over time, or other --columns.

    Angles are within 4 units at times up to 2^50 nutation periods; a unit is 2^-52 times the angle,
    or 1 rad if that is larger, and more where an angle sweeps round next to a pole.  Spin and
    precession count on from 0 at t = 0 unless --wrap.  The times are t-min + i dt, each rounded
    once.  Where inputs have units (see lagtop solve --help) a time without one is in seconds.

    Uncertain inputs (see there too) add the standard uncertainties of the angles, theta_deg_std and
    so on, as the last columns.
    """
    from ..motion.over_time.columns import DEFAULT_COLUMNS
    from ..motion.over_time.times import DEFAULT_ROWS, TableRequest

    options, interval = in_seconds(options, t_min=t_min, t_max=t_max, dt=dt)
    exclude({"--n": count, "--dt": dt})
    if jobs is not None and tops is None:
        raise LagtopError("--jobs shares out many tops: it needs --tops")
    exclude({"--tops": tops, "--digits": digits})
    exclude({"--tops": tops, "--certify": certify or None})
    stdin = {"the scene -": scene, "--tops -": tops, "--times -": times}
    exclude({name: True if path == "-" else None for name, path in stdin.items()})
    for name, value in {"--t-max": t_max, "--t-min": t_min, "--n": count, "--dt": dt}.items():
        exclude({"--times": times, name: value})
    _check_format(fmt, times, tops, digits, certify)
    request = TableRequest(
        _listed(times, tops, fmt) or partial(_grid, n=count, **interval),
        DEFAULT_COLUMNS if columns is None else columns,
        rad,
        wrap,
        count or (None if dt or times else DEFAULT_ROWS),
        tops is not None and (times is not None or t_max is not None),
    )
    if tops is None:
        found = inputs_of(scene, rad, options)
        motion = motion_of(found, digits is not None)
        for name, value in {"--digits": digits, "--certify": certify or None}.items():
            exclude({name: value, "uncertain inputs": found.stds or None})
        with blaming(times):
            if certify or digits is not None:
                _write_proved(motion, request, found, digits, certify, fmt, output)
            else:
                _write_one(motion, request, found, fmt, output)
    else:
        _write_many(tops, scene, options, request, jobs or 1, fmt, output)


def _check_format(
    fmt: str, times: str | None, tops: str | None, digits: int | None, certify: bool
) -> None:
    """Raise LagtopError for a format that cannot hold what is asked for."""
    if tops is not None and fmt in {"table", "npy"}:
        holds = "shows one top" if fmt == "table" else "holds numbers of one top"
        raise LagtopError(f"--format {fmt} {holds}: with --tops take csv, json or parquet")
    if (digits is not None or certify) and fmt in {"npy", "parquet"}:
        texts = "--certify" if certify else "--digits"
        raise LagtopError(f"--format {fmt} holds doubles: with {texts} take csv, json or table")
    if times == "-" and fmt == "npy":
        raise LagtopError("--format npy begins with the number of rows: give --times a file")
    if fmt == "parquet":
        from ..output.parquet import check_parquet

        check_parquet()


def _listed(times: str | None, tops: str | None, fmt: str) -> Callable[[Motion], Points] | None:
    """Return the times of a file as those of every motion, if there is a file.

    Many tops, and the one width of a drawn table, need them more than once.
    """
    if times is None:
        return None
    from ..inputs.times_file import TimesFile

    file = TimesFile(times, counted=fmt == "npy", dialect=dialect())
    if tops is None and fmt != "table":
        return lambda _: file
    return partial(_same, file.listed(None if tops is not None else MAX_TABLE_ROWS + 1))


def _same(times: Points, _: Motion) -> Points:
    return times


def _grid(motion: Motion, **interval: Any) -> Points:
    from ..motion.over_time.times import grid

    return grid(motion, **interval)


def _times(motion: Motion, request: TableRequest, fmt: str) -> Points:
    """Return the times of a table.  Raises LagtopError for more rows than can be drawn."""
    times = request.times(motion)
    if fmt == "table" and times.count > MAX_TABLE_ROWS:
        raise LagtopError(f"--format table shows at most {MAX_TABLE_ROWS} rows, got {times.count}")
    return times


def _write_one(motion: Motion, request: TableRequest, found: Given, fmt: str, output: str) -> None:
    from ..motion.over_time.columns import chosen_columns

    times, stds = _times(motion, request, fmt), angle_stds(found, motion)
    header, parts = request.rows(motion, times, stds.at if stds else None)
    if fmt == "table":
        units = [part.unit for part in chosen_columns(request.columns)]
        if found.system is not None:
            units = [found.system.named(unit) for unit in units]
        named = [f"{x} [{unit}]" if unit else x for x, unit in zip(header, units, strict=False)]
        header = [*named, *header[len(named) :]]
    if is_described(fmt):
        header = _described(header, motion.top.texts(), found.system, request)
    write_table(
        header, with_progress(parts, "rows", times.count or None, len), fmt, output, times.count
    )


def _described(
    header: Sequence[str],
    scene: Mapping[str, str],
    system: System | None,
    request: TableRequest,
    *,
    is_whole: bool = True,
) -> Header:
    """Return the names of columns with the description of the file."""
    from ..inputs.descriptions import describe

    return Header(
        header, describe(__version__, scene, system, radians=request.radians, is_whole=is_whole)
    )


def _write_proved(
    motion: Motion,
    request: TableRequest,
    found: Given,
    digits: int | None,
    radii: bool,
    fmt: str,
    output: str,
) -> None:
    """Write a table whose numbers are rounded from enclosures."""
    from ..motion.over_time.proved_table import ProvedTable

    times, shown = _times(motion, request, fmt), {"radians": request.radians, "wrap": request.wrap}
    header, parts = ProvedTable(motion, request.columns, digits, **shown).rows(times, radii=radii)
    if is_described(fmt):
        header = _described(header, motion.top.texts(), found.system, request)
    write_table(
        header, with_progress(parts, "rows", times.count or None, len), fmt, output, times.count
    )


def _write_many(
    tops: str,
    scene: str | None,
    options: Mapping[str, Any],
    request: TableRequest,
    jobs: int,
    fmt: str,
    output: str,
) -> None:
    from ..sweeps.plan import Tally
    from ..sweeps.tables import open_tables

    inputs = by_key(options, radians=request.radians)
    system = inputs.pop("units", None)
    tables, lines, given = open_tables(
        tops, scene, inputs, request, fmt=fmt, system=system, dialect=dialect()
    )
    exclude({"--tops": tops, "uncertain inputs": given.stds or None})
    say_missing(given)
    header: Sequence[str] = tables.header
    if is_described(fmt):
        shared = {key: value_text(x) for key, x in tables.shared.items()}
        header = _described(header, shared, given.system, request, is_whole=False)
    tally = Tally()
    texts = (part.text for part in tally.passing(tables.computed(lines, jobs)))
    write_text_blocks(fmt, header, with_progress(texts, "blocks"), output)
    tally.check()
    if not tally.count:
        say_no_tops(tops)
