"""The command `lagtop sweep`: one record per top."""

from __future__ import annotations

import re
from contextlib import ExitStack
from typing import TYPE_CHECKING

import click

from ..arithmetic.text import quoted
from ..errors import LagtopError
from ..output.write import write_text_blocks
from .command import ExamplesFirst, write_keys
from .options import FILE, KEY_NAMES, Parsed, exclude, output_options
from .progress import with_progress
from .row_options import dialect, header_comments_option, is_described, jobs_option, text_options
from .top_options import by_key, input_options, say_missing, say_no_tops, value_type

if TYPE_CHECKING:
    from ..inputs.value import Value
    from ..sweeps.plan import Make


def _parse_shard(text: str) -> tuple[int, int]:
    """Return I and N of `I/N`, the I-th of N.  Raises LagtopError."""
    match = re.fullmatch(r"([0-9]{1,9})/([0-9]{1,9})", text)
    if match and 1 <= int(match[1]) <= int(match[2]):
        return int(match[1]), int(match[2])
    raise LagtopError(f"must be I/N with 1 <= I <= N < 1e9, got {quoted(text)}")


@click.command(
    "sweep",
    cls=ExamplesFirst,
    shows=write_keys,
    examples="""
        lagtop sweep --r0 10:200:1000 --theta0 5,10,30 > tops.csv
        lagtop sweep --r0 log:1:1e4:50 --keys r0,mean_precession_rate
        lagtop sweep --r0 10:100:10 --m '1587(2)' --keys r0,T_nutation
        lagtop sweep tops.csv -o solved.ndjson
        jq -c .top log.json | lagtop sweep - --keys T_nutation,error
        lagtop sweep --r0 10:200:1e5 --jobs auto -o solved.csv
        lagtop sweep --r0 10:200:1e5 --parts out
        lagtop sweep --r0 10:200:1e5 --shard $SLURM_ARRAY_TASK_ID/100 --parts out
        lagtop sweep tops.csv --dask local -o solved.csv
    """,
)
@click.argument("files", nargs=-1, type=FILE, metavar="[SCENE.toml] [TOPS.csv|.ndjson|-]")
@input_options(value_type("range", "parse_values", uncertain=True))
@click.option(
    "--keys", type=KEY_NAMES, help="Compute and print only these keys, with commas between."
)
@click.option("--fail-fast", is_flag=True, help="Stop at the first top that cannot be solved.")
@click.option(
    "--shard", type=Parsed("I/N", _parse_shard), help="Only every N-th part, from the I-th on."
)
@jobs_option
@click.option(
    "--dask",
    "cluster",
    metavar="ADDRESS|local",
    help="Compute the parts on a Dask cluster, or on one of this machine.",
)
@click.option(
    "--parts",
    "folder",
    type=FILE,
    metavar="DIR",
    help="Write a file per part; resume a folder that is not complete.",
)
@text_options
@header_comments_option
@output_options("csv", "ndjson", "json", "parquet")
def command(
    files: tuple[str, ...],
    rad: bool,
    keys: list[str] | None,
    fail_fast: bool,
    shard: tuple[int, int] | None,
    jobs: int | None,
    cluster: str | None,
    folder: str | None,
    fmt: str,
    output: str,
    units: str | None,
    **axes: Value | None,
) -> None:
    """The record of `solve` for each top of a grid or of a file.

    An input is a number, a list 1,2,3 or a range [log:]start:stop:count.  The grid is the product
    of all; the last option varies fastest.  A unit stands once, at the end: --r0 '1e3:9e3:5 rpm'.

    A file is CSV with a header, or JSON lines, whose names are those of a record.  What a row lacks
    comes from the options and the scene; other columns are carried through.  A heading may have a
    unit, as in m [g], if all have one.  A top that cannot be
    solved has its `error` in its row, and the exit code is 1.

    Where inputs of all tops are uncertain (see lagtop solve --help), the standard uncertainty of
    each number is its KEY_std, a column of its own.

    A folder of --parts belongs to one sweep: any number of runs, shards among them, may fill it,
    and a run that was killed is resumed by the same command.
    """
    from ..output.parquet import check_parquet
    from ..sweeps.cluster import computed, connected
    from ..sweeps.folder import Folder
    from ..sweeps.plan import Tally, plan, shard_of

    exclude({"--jobs": jobs, "--dask": cluster})
    exclude({"--parts": folder, "--output": None if output == "-" else output})
    if folder is not None and fmt == "json":
        raise LagtopError("--format json is one array: with --parts take csv or ndjson")
    if fmt == "parquet":
        check_parquet()
    inputs = by_key(axes, radians=rad)
    to_stdout = folder is None and output == "-"
    todo = plan(
        files,
        inputs,
        keys=keys,
        radians=rad,
        fmt=fmt,
        system=units,
        until_error=fail_fast and to_stdout,
        described=folder is not None,
        dialect=dialect(),
        is_described=is_described(fmt),
    )
    say_missing(todo.given)
    tally = Tally(fail_fast=fail_fast)
    blocks = shard_of(todo.blocks, shard)
    parts_folder: Folder | None = None
    with ExitStack() as stack:
        client = stack.enter_context(connected(cluster))  # before anything is written
        make: Make = todo.sweep.part
        if folder is not None:
            parts_folder = Folder(folder, todo.sweep, todo.description)
            blocks = parts_folder.missing(blocks, tally)
            if client is not None and not fail_fast:
                make = stack.enter_context(parts_folder.made_by_workers())
        parts = stack.enter_context(computed(make, blocks, client, jobs or 1))
        passing = tally.until_error(parts, ended=to_stdout) if fail_fast else tally.passing(parts)
        if todo.size:
            share = todo.size // (shard or (1, 1))[1]
            passing = with_progress(passing, "rows", share, tally.progress)
        else:
            passing = with_progress(passing, "parts")
        if parts_folder:
            parts_folder.write(passing)
        else:
            texts = (part.text for part in passing)
            write_text_blocks(fmt, todo.sweep.header, texts, output)
    tally.check()
    if todo.file is not None and shard is None and not tally.count:
        say_no_tops(todo.file)
