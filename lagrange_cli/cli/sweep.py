"""The command `lagtop sweep`: one record per top."""

from __future__ import annotations

import re
from contextlib import ExitStack
from typing import TYPE_CHECKING

from ..arithmetic.text import quoted
from ..errors import LagtopError
from ..output.terminal import with_progress
from . import options as opt
from .app import complain
from .tables import (
    header_comments_option,
    is_described,
    key_headings,
    text_options,
    warn_no_tops,
)
from .top import SCENE, TopOptions, top_options, value_type, warn_missing

if TYPE_CHECKING:
    from ..inputs.text_lines import Dialect
    from ..output.destination import Output
    from ..sweeps.plan import Make

_FORMATS = ("csv", "ndjson", "json", "parquet", "table", "markdown")
FEW = 50
"""Largest number of tops whose records are drawn as a table on a terminal."""


def _parse_shard(text: str) -> tuple[int, int]:
    """Return I and N of `I/N`, the I-th of N.  Raises LagtopError."""
    match = re.fullmatch(r"([0-9]{1,9})/([0-9]{1,9})", text)
    if match and 1 <= int(match[1]) <= int(match[2]):
        return int(match[1]), int(match[2])
    raise LagtopError(f"must be I/N with 1 <= I <= N < 1e9, got {quoted(text)}")


@opt.command(
    "sweep",
    """
    lagtop sweep --r0 10:200:1000 --theta0 5,10,30 -o tops.csv
    lagtop sweep --r0 log:1:1e4:50 --keys r0,mean_precession_rate
    lagtop sweep tops.csv --keys r0,T_nutation -o solved.ndjson
    """,
    exclusive=["--jobs --dask"],
)
def sweep_command(
    files: tuple[str, ...] = opt.arguments(SCENE, "[SCENE] [TOPS.csv|.ndjson|-]"),
    top: TopOptions = top_options(value_type("parse_values", uncertain=True), None),
    keys: list[str] | None = opt.keys,
    fail_fast: bool = opt.flag("Stop at the first top that cannot be solved."),
    jobs: int | None = opt.jobs,
    folder: str | None = opt.option(
        opt.FOLDER, "Write one file per part into this folder.", "--parts"
    ),
    shard: tuple[int, int] | None = opt.option(
        opt.Parsed("I/N", _parse_shard), "Compute only every N-th part, starting with the I-th."
    ),
    cluster: str | None = opt.option(
        opt.Parsed("ADDRESS", str), "Use a Dask cluster, or `local` for this machine.", "--dask"
    ),
    dialect: Dialect = text_options,
    header_comments: bool = header_comments_option,
    out: Output = opt.output(*_FORMATS, on_terminal="table"),
) -> None:
    """Solve each top of a grid or of a file.

    An input is a number, a list 1,2,3 or a range [log:]start:stop:count, with its unit at the end:
    --r0 '1e3:9e3:5 rpm'.  The grid has every combination of values; the last option varies fastest.

    A file of tops is CSV with a header, or JSON lines, with names such as r0.  Options and the
    scene supply the inputs that it lacks.  Its other columns are copied.  A heading may have a
    unit: m [g].  If a top cannot be solved, its row shows the error, and the exit code is 1.

    A sweep is computed in parts of 4096 tops.  A folder of --parts holds the parts of one sweep;
    repeat the command to resume a run that was killed.
    """
    from ..output.rows import check_parquet
    from ..sweeps.cluster import computed, connected
    from ..sweeps.folder import Folder
    from ..sweeps.plan import Tally, plan, shard_of

    opt.exclude({"--parts": folder, "--output": out.path != "-"})
    if folder is not None:
        out = out.replace(fmt="csv") if not out.is_named else out
        if out.fmt in {"json", "table", "markdown"}:
            raise LagtopError(f"--format {out.fmt} is one document: with --parts use csv or ndjson")
    if out.fmt == "parquet":
        check_parquet()
    to_stdout = folder is None and out.path == "-"
    todo = plan(
        files,
        top.by_key(),
        keys=keys,
        radians=top.radians,
        fmt=out.fmt,
        system=top.units,
        until_error=fail_fast and to_stdout,
        described=folder is not None,
        dialect=dialect,
        is_described=is_described(out, header_comments),
    )
    warn_missing(todo.given)
    sweep = todo.sweep
    if not (out.is_named or 0 < todo.size <= FEW) and out.fmt == "table":
        sweep, out = sweep._replace(fmt="csv"), out.replace(fmt="csv")
    is_shown = "error" in sweep.header
    tally = Tally(
        fail_fast=fail_fast, remedy="" if is_shown else "; add error to --keys to see every reason"
    )
    blocks = shard_of(todo.blocks, shard)
    parts_folder: Folder | None = None
    with ExitStack() as stack:
        stack.callback(todo.close)
        client = stack.enter_context(connected(cluster))  # before anything is written
        make: Make = sweep.part
        if folder is not None:
            parts_folder = Folder(folder, sweep, todo.description)
            blocks = parts_folder.missing(blocks, tally)
            if client is not None and not fail_fast:
                make = stack.enter_context(parts_folder.made_by_workers())
        parts = stack.enter_context(computed(make, blocks, client, jobs or 1))
        passing = tally.passing(parts, ended=to_stdout)
        if todo.size:
            share = todo.size // (shard or (1, 1))[1]
            passing = with_progress(passing, "rows", share, tally.progress)
        else:
            passing = with_progress(passing, "parts")
        if parts_folder:
            parts_folder.write(passing)
        else:
            texts = (part.text for part in passing)
            names = key_headings(sweep.header, sweep.system, out.fmt, radians=top.radians)
            out.blocks(names, texts)
    if parts_folder and parts_folder.found:
        complain(f"Resumed: {parts_folder.found} parts were already in {folder}")
    tally.check()
    if todo.file is not None and shard is None and not tally.count:
        warn_no_tops(todo.file)
