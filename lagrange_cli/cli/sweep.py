"""Records of many tops: of given ones (`lagtop sweep`) and of found ones (`lagtop find`)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import quoted
from ..errors import LagtopError
from ..output.terminal import with_progress
from . import options as opt
from .app import complain
from .tables import header_comments_option, is_described, text_options, warn_no_tops
from .top import SCENE, TopOptions, top_options, value_type, warn_missing, warn_unused, words

if TYPE_CHECKING:
    from ..inputs.text_lines import Dialect
    from ..inputs.units import System
    from ..motion.solve import Motion
    from ..output.destination import Output
    from ..sweep.plan import Make

_FORMATS = ("csv", "ndjson", "json", "parquet", "table")
FEW = 50
"""Largest number of tops whose records are drawn as a table on a terminal."""
_KEYS = opt.key_names("Compute and print only these keys (see lagtop explain).")


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
    keys: list[str] | None = _KEYS,
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
    unit: m [g].  If a top cannot be solved, the exit code is 1 and the column
    error gives the reason; with --keys, list error to see it.

    A sweep is computed in parts of 4096 tops.  A folder of --parts holds the parts of one sweep;
    repeat the command to resume a run that was killed.
    """
    from ..output.formats import check_parquet
    from ..sweep.cluster import computed, connected
    from ..sweep.folder import Folder
    from ..sweep.plan import Tally, plan, shard_of

    opt.exclude({"--parts": folder, "--output": out.path != "-"})
    if folder is not None:
        out = out.replace(fmt="csv") if not out.is_named else out
        if out.fmt in {"json", "table"}:
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
            names = _headings(sweep.header, sweep.system, out.fmt, radians=top.radians)
            out.blocks(names, texts)
    if parts_folder and parts_folder.found:
        complain(f"Resumed: {parts_folder.found} parts were already in {folder}")
    tally.check()
    if todo.file is not None and shard is None and not tally.count:
        warn_no_tops(todo.file)


def _headings(
    names: Sequence[str], system: System | None, fmt: str, *, radians: bool
) -> Sequence[str]:
    """Return the headings of keys: with units in a table for people, if inputs have units."""
    if system is None or fmt != "table":
        return names
    from ..motion.record import shown_keys
    from ..output.report import with_unit

    keys = shown_keys(radians=radians, named=system.named, requested=True)
    return [with_unit(name, keys[name].unit) if name in keys else name for name in names]


def _beginnings() -> list[str]:
    """Return completions of words of the command: keys and shipped scenes."""
    from ..inputs.scene_file import scene_names
    from ..motion.record import all_keys

    return [*(f"{key}=" for key in all_keys()), *scene_names()]


CONDITION = opt.Parsed("CONDITION", str, _beginnings)


@opt.command(
    "find",
    """
    lagtop find --r0 10:200 T_precession=2
    lagtop find --r0 10:200 --theta0 5:150 T_precession=0.8 T_nutation=0.43
    lagtop find --psidot0 0:20 theta_max=60 'path=looping' --keys psidot0
    """,
)
def find_command(
    top: TopOptions = top_options(
        value_type("parse_number_or_span"), words("[SCENE] CONDITION...", CONDITION), units=False
    ),
    scan: int | None = opt.count(
        "Number of values of each unknown.  [default: 4000, 60 or 20 for 1, 2 or 3 unknowns]",
    ),
    keys: list[str] | None = _KEYS,
    out: Output = opt.output("csv", "ndjson", "json", "table", on_terminal="table"),
) -> None:
    """Find the inputs for which results take given values.

    An input given as a range from:to (or log:from:to) is an unknown; up to three are allowed.  Give
    as many conditions KEY=NUMBER as unknowns.  If inputs have units, a condition may have a unit
    too (T_precession=500ms); without one, it is in SI.  Conditions such as regime=regular,
    path=looping or 'theta_max<120' restrict the solutions.

    With one unknown, find returns every solution that the scan brackets.  With several, it follows
    the best points of the scan and can miss solutions.  The exit code is 1 if no solution is found.
    """
    from ..find import find_tops, search_of
    from ..inputs.names import check_names
    from ..motion.record import all_keys, record_keys

    chosen = record_keys(radians=top.radians)
    if keys is not None:
        chosen = check_names("keys", keys, all_keys(radians=top.radians))
    search, given = search_of(top.by_key(), top.words, scene=top.scene, radians=top.radians)
    motions, looked = find_tops(search, scan)
    warn_missing(given)
    warn_unused(given.stds)
    complain(f"{len(motions)} found; {looked}")
    _write_found(motions, given.system, chosen, top.radians, out)


def _write_found(
    motions: list[Motion], system: System | None, keys: list[str], radians: bool, out: Output
) -> None:
    """Write the records as `lagtop sweep` does, a row for each motion."""
    from ..motion.numbers import record_in_range

    records: list[dict[str, Any]] = [
        record_in_range(motion, radians=radians, keys=keys)[0] for motion in motions
    ]
    for record in records:
        if system is not None and record.get("remark"):
            record["remark"] = system.in_words(record["remark"])
    out.rows(records, keys, _headings(keys, system, out.fmt, radians=radians))
