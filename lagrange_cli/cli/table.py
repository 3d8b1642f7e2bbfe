"""`lagtop table`: angles, rates and attitude over time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..arithmetic.text import value_text
from ..errors import DataError, LagtopError
from ..output.terminal import with_progress
from . import options as opt
from .tables import angle_stds, header_comments_option, is_described, text_options, warn_no_tops
from .top import TIME, UNCERTAIN, TopOptions, motion_of, top_options, warn_missing

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..inputs.given import Given
    from ..inputs.text_lines import Dialect
    from ..inputs.units import System
    from ..inputs.value import Value
    from ..motion.over_time.table_request import TableRequest
    from ..motion.solve import Motion
    from ..output.destination import Output
    from ..output.formats import Header

MAX_DRAWN_ROWS = 10_000
"""Largest number of rows that are drawn; nobody reads more, and drawing them is slow."""
_DRAWN = ("table",)


@opt.command(
    "table",
    """
    lagtop table --t-max 1 -o angles.csv
    lagtop table fast-gyroscope --t-max 10 --dt 0.01 --columns t,axis,energy
    lagtop table --t-max 1e9 --n 3 --digits 30 --certify --format json
    """,
    exclusive=[
        *("--n --dt", "--tops --digits", "--tops --certify"),
        *("--times --t-max", "--times --t-min", "--times --n", "--times --dt"),
    ],
)
def table_command(
    top: TopOptions = top_options(UNCERTAIN),
    t_max: Value | None = opt.option(
        TIME, "Last time.  [default: one nutation period; 1 without nutation]"
    ),
    t_min: Value | None = opt.option(TIME, "First time.  [default: 0]"),
    count: int | None = opt.count("Number of times.  [default: 101]", "--n"),
    dt: Value | None = opt.option(TIME, "Time step, instead of --n."),
    times: str | None = opt.file("Read the times from a file, one per line."),
    columns: list[str] | None = opt.names(
        "Columns (see lagtop explain).  [default: t,theta,phi,psi]",
        offered=opt.late("motion.over_time.columns", "column_names"),
    ),
    tops: str | None = opt.file("Tabulate each top of a file, as in sweep."),
    jobs: int | None = opt.jobs,
    wrap: bool = opt.flag("Keep spin and precession in (-180, 180]."),
    digits: int | None = opt.digits(opt.MOST_TABLE_DIGITS),
    certify: bool = opt.certify,
    dialect: Dialect = text_options,
    header_comments: bool = header_comments_option,
    out: Output = opt.output("csv", "json", "ndjson", "table", "parquet"),
) -> None:
    """Tabulate tilt, spin and precession, or other columns, over time.

    Errors of angles are at most 4 units at times up to 2^50 nutation periods.  A unit is 2^-52
    max(1 rad, |angle|), or more if the axis passes near the vertical.  If inputs are uncertain, the
    last columns are the uncertainties of the angles.
    """
    from ..motion.over_time.columns import DEFAULT_COLUMNS
    from ..motion.over_time.table_request import DEFAULT_ROWS, TableRequest, grid

    top, interval = top.in_seconds(t_min=t_min, t_max=t_max, dt=dt)
    if jobs is not None and tops is None:
        raise LagtopError("--jobs needs --tops: one top is computed by one process")
    stdin = {"the scene -": top.scene, "--tops -": tops, "--times -": times}
    opt.exclude({name: path == "-" for name, path in stdin.items()})
    _check_format(out.fmt, times, tops, digits, certify)
    request = TableRequest(
        _listed(times, tops, out.fmt, dialect) or partial(grid, n=count, **interval),
        DEFAULT_COLUMNS if columns is None else columns,
        top.radians,
        wrap,
        count or (None if dt or times else DEFAULT_ROWS),
        tops is not None and (times is not None or t_max is not None),
    )
    if tops is not None:
        described = is_described(out, header_comments)
        _write_many(tops, top, request, jobs or 1, dialect, described, out)
        return
    found = top.given()
    motion = motion_of(found, exact=digits is not None)
    for name, value in {"--digits": digits, "--certify": certify}.items():
        opt.exclude({name: value, "uncertain inputs": found.stds or None})
    described = is_described(out, header_comments)
    with blaming(times):
        at = _times(motion, request, out.fmt)
        if digits is None and not certify:
            header, parts = _rows(motion, at, request, found, out.fmt)
        else:
            from ..motion.over_time.proved_table import ProvedTable

            proved = ProvedTable(motion, request.columns, digits, radians=top.radians, wrap=wrap)
            header, parts = proved.rows(at, radii=certify)
        if described:
            header = _described(header, motion.top.texts(), found.system, request)
        out.table(header, with_progress(parts, "rows", at.count or None, len), at.count)


def _check_format(
    fmt: str, times: str | None, tops: str | None, digits: int | None, certify: bool
) -> None:
    """Raise LagtopError for a format that cannot hold the table."""
    if tops is not None and fmt in _DRAWN:
        raise LagtopError(f"--format {fmt} shows one top: with --tops use csv, json or parquet")
    if (digits is not None or certify) and fmt in opt.BINARY:
        texts = "--certify" if certify else "--digits"
        raise LagtopError(f"--format {fmt} holds doubles: with {texts} use csv, json or table")
    if fmt == "parquet":
        from ..output.formats import check_parquet

        check_parquet()


def _listed(
    times: str | None, tops: str | None, fmt: str, dialect: Dialect
) -> Callable[[Motion], Points] | None:
    """Return the times of a file as times of every motion, if there is a file.

    They are kept, because many tops, or the common width of a drawn table, need them repeatedly.
    """
    if times is None:
        return None
    from ..inputs.trajectory import read_times

    return partial(_same, read_times(times, dialect.decimal))


def _same(times: Points, _: Motion) -> Points:
    """Return the times of a file, which other processes can receive as this function."""
    return times


def _times(motion: Motion, request: TableRequest, fmt: str) -> Points:
    """Return the times of a table.  Raises LagtopError for more rows than can be drawn."""
    times = request.times(motion)
    if fmt in _DRAWN and times.count > MAX_DRAWN_ROWS:
        raise LagtopError(f"--format {fmt} shows at most {MAX_DRAWN_ROWS} rows, got {times.count}")
    return times


def _rows(
    motion: Motion, times: Points, request: TableRequest, found: Given, fmt: str
) -> tuple[Sequence[str], Iterable[Any]]:
    """Return the header and the rows of a table in doubles."""
    from ..motion.over_time.columns import chosen_columns

    stds = angle_stds(found, motion)
    header, parts = request.rows(motion, times, stds.at if stds else None)
    if fmt in _DRAWN:
        named = found.system.named if found.system is not None else str
        chosen = chosen_columns(request.columns).values()
        units = ["" if column.is_angle else named(column.key.unit) for column in chosen]
        texts = [f"{x} [{unit}]" if unit else x for x, unit in zip(header, units, strict=False)]
        header = [*texts, *header[len(texts) :]]
    return header, parts


def _described(
    header: Sequence[str],
    scene: Mapping[str, str],
    system: System | None,
    request: TableRequest,
    *,
    is_whole: bool = True,
) -> Header:
    """Return the names of columns with the description of the file."""
    from ..inputs.scene_file import describe
    from ..output.formats import Header

    texts = describe(__version__, scene, system, radians=request.radians, is_whole=is_whole)
    return Header(header, texts)


def _write_many(
    tops: str,
    top: TopOptions,
    request: TableRequest,
    jobs: int,
    dialect: Dialect,
    described: bool,
    out: Output,
) -> None:
    from ..sweep.plan import Tally
    from ..sweep.tables import open_tables

    tables, lines, given = open_tables(
        tops, top.scene, top.by_key(), request, fmt=out.fmt, system=top.units, dialect=dialect
    )
    opt.exclude({"--tops": tops, "uncertain inputs": given.stds or None})
    warn_missing(given)
    header: Sequence[str] = tables.header
    if described:
        shared = {key: value_text(x) for key, x in tables.shared.items()}
        header = _described(header, shared, given.system, request, is_whole=False)
    tally = Tally()
    texts = (part.text for part in tally.passing(tables.computed(lines, jobs)))
    out.blocks(header, with_progress(texts, "blocks"))
    tally.check()
    if not tally.count:
        warn_no_tops(tops)


@contextmanager
def blaming(times: str | None) -> Iterator[None]:
    """Raise DataError for a time out of reach in a file of times."""
    try:
        yield
    except LagtopError as error:
        if times is None or error.key != "t":
            raise
        from ..inputs.files import shown_path

        raise DataError(f"{shown_path(times)}: {error}") from None
