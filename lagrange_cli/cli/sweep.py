"""Records of many tops: `lagtop sweep`, and `lagtop find`, which searches for them."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from contextlib import closing
from itertools import islice
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import quoted
from ..errors import LagtopError, UnavailableError
from ..file_bytes import shown_path
from ..names import listed
from ..output.formats import FORMATS
from ..output.formats.base import format_of
from ..output.terminal import with_progress
from ..top.scenes import is_scene_file
from ..top.units import Units
from ..top.values import parse_number_or_span, parse_values
from . import shared as opt
from .app import complain

if TYPE_CHECKING:
    from ..output.destination import Output
    from ..sweeps.parts import Parts
    from ..sweeps.plan import NumberedBlock, Part

MOST_JOBS = 1024


def _parse_shard(text: str) -> tuple[int, int]:
    """Return I and N of `I/N`, the I-th of N.  Raises LagtopError."""
    match = re.fullmatch(r"([0-9]{1,9})/([0-9]{1,9})", text)
    if match and 1 <= int(match[1]) <= int(match[2]):
        return int(match[1]), int(match[2])
    raise LagtopError(f"must be I/N with 1 <= I <= N < 1e9, got {quoted(text)}")


def _parse_jobs(text: str) -> int:
    """Return a number of processes; `auto` is one for each core that this process may use.

    Raises LagtopError.
    """
    if text == "auto":
        may_use = getattr(os, "sched_getaffinity", None)
        return len(may_use(0)) if may_use else os.cpu_count() or 1
    if not (re.fullmatch("[0-9]{1,4}", text) and 1 <= int(text) <= MOST_JOBS):
        raise LagtopError(f"must be auto or in [1, {MOST_JOBS}], got {quoted(text)}")
    return int(text)


@opt.command(
    "sweep",
    "sweep --r0 10:200:1000 --theta0 5,10,30 -o tops.csv",
    "sweep --r0 log:1:1e4:50 --keys r0,mean_precession_rate",
    "sweep tops.csv --keys r0,T_nutation -o solved.ndjson",
    "sweep --r0 10:200:1000 --where 'T_nutation < 0.4'",
)
@opt.top(
    "[SCENE] [TOPS.csv|.ndjson|-]",
    parse=parse_values,
    is_scene=is_scene_file,
)
@opt.keys
@opt.certify
@opt.option(
    "--where",
    metavar="CONDITION",
    multiple=True,
    help="Keep tops with KEY<NUMBER, KEY=WORD ...; may be repeated.",
)
@opt.option(
    "--jobs",
    metavar="N|auto",
    type=opt.Parsed("N", _parse_jobs),
    help="Number of processes; auto: one per core.",
)
@opt.option("--parts", metavar="DIR", help="Write one file per part into this folder.")
@opt.option("--shard", type=opt.Parsed("I/N", _parse_shard), help="Compute parts I, I + N, ...")
@opt.option("--dask", metavar="ADDRESS", help="Use the Dask cluster of this scheduler.")
@opt.decimal(writes=True)
@opt.output("csv", rows=True)
def sweep_command(
    top: opt.TopOptions,
    words: Sequence[str],
    keys: list[str] | None,
    certify: bool,
    where: Sequence[str],
    jobs: int | None,
    parts: str | None,
    shard: tuple[int, int] | None,
    dask: str | None,
    decimal: str,
    out: Output,
) -> None:
    """Solve each top of a grid or of a file.

    An input is a number, a list 1,2,3 or a range [log:]start:stop:count, with its unit at the end:
    --r0 '1e3:9e3:5 rpm'.  The grid has every combination of values; the last option varies fastest.

    A file of tops is CSV with a header, or JSON lines, with names such as r0.  Options and the
    scene supply the inputs that it lacks.  Its other columns are copied.  A heading may have a
    unit: m [g].  If a top cannot be solved, the exit code is 1 and the column error gives the
    reason.  With --keys on a grid, include error to see the reasons.

    --where keeps the rows of tops that satisfy a condition: a key, one of < <= > >= =, and a number
    with its unit, or a word.  A top without the number does not satisfy it.

    Solving a top takes a few microseconds.  The error of each number has a bound, at most 1e-13 of
    its size (of 1 for a cosine); --certify prints it.

    A sweep is computed in parts of 4096 tops.  A folder of --parts holds the parts of one sweep;
    repeat the command to resume a run that was killed.
    """
    from ..sweeps.parts import Parts, digest_of
    from ..sweeps.plan import BLOCK_ROWS, Part, check, noted, plan
    from ..sweeps.workers import in_order

    opt.exclude(jobs=jobs, dask=dask)
    opt.exclude(parts=parts, output=out.path != "-")
    if parts is not None:
        out = out._replace(fmt="csv") if not out.is_named else out
        if not out.format.only_rows:
            most = listed(x for x in FORMATS if format_of(x).only_rows)
            raise LagtopError(f"--format {out.fmt} is one document: with --parts use {most}")
    if len(words) > 1:
        raise LagtopError(f"a sweep takes one file of tops, got {' '.join(words)}")
    path = words[0] if words else None
    digest = digest_of(path, decimal) if path is not None and parts is not None else ""
    out = opt.with_mark(out, decimal, reads=path is not None)
    how: dict[str, Any] = {"units": Units(top.radians), "decimal": decimal}
    how |= {"keys": keys, "radii": certify, "where": where}
    how["blocks"] = out.format.blocks_in_part if parts is not None else 1
    sweep, every_block, size, given = plan(path, top.inputs, top.scene, **how)
    opt.warn(given)
    sweep = sweep._replace(fmt=out.fmt)
    hidden = "" if "error" in sweep.header else "; add error to --keys to see every reason"
    if where:
        hidden = "; leave out --where to see every reason"
    done, (first, every) = list[Part](), shard or (1, 1)
    blocks: Iterable[NumberedBlock] = islice(every_block, first - 1, None, every)
    folder = None if parts is None else Parts(parts, sweep, digest)
    if folder:
        blocks = folder.missing(blocks, done)
    shared = jobs or 1, dask, lambda text: complain(f"Warning: {text}")
    with closing(in_order(sweep.part, blocks, *shared)) as computed:
        total = size // every or None
        shown = with_progress(noted(computed, done), "tops", total, lambda part: part.size)
        if folder:
            parts_of_all = -(-size // (BLOCK_ROWS * how["blocks"]))
            _write_parts(folder, shown, done, len(range(first - 1, parts_of_all, every)))
        else:
            headings = _headings(sweep.header, sweep.units, out)
            out.blocks(sweep.header, (part.text for part in shown), headings)
    if folder and folder.found:
        complain(f"Resumed: parts already in {parts}: {folder.found}")
    if count := sum(part.not_bodies for part in done):
        tops = f"{count} of {sum(part.size for part in done)} tops"
        complain(f"Warning: no rigid body has C > 2A, but {tops} have; computed anyway")
    check(done, hidden)
    if path is not None and shard is None and not any(part.size for part in done):
        complain(f"Warning: {shown_path(path)} holds no tops")
    elif where and shard is None and not any(part.rows for part in done):
        complain(f"Warning: no top satisfies {' and '.join(map(str, sweep.where))}")


def _write_parts(folder: Parts, parts: Iterable[Part], done: Sequence[Part], count: int) -> None:
    """Write parts.  If a process or a cluster is lost, the error counts the parts that are done.

    The number of all parts is 0 if it is not known.
    """
    try:
        folder.write(parts)
    except UnavailableError as error:
        found = f"{len(done)} of {count}" if count else f"{len(done)}"
        raise UnavailableError(f"{error}; {found} parts are done: repeat the command") from None


def _headings(names: Sequence[str], units: Units, out: Output) -> Sequence[str]:
    """Return the headings of keys, with units if inputs have units."""
    from ..solver.keys import shown_keys

    keys = shown_keys(units, requested=True) if units.si else {}
    return opt.with_units(names, {name: key.unit for name, key in keys.items()}, out)


@opt.command(
    "find",
    "find --r0 10:200 T_precession=2",
    "find --r0 10:200 --theta0 5:150 T_precession=0.8 T_nutation=0.43",
    "find --psidot0=-8:0 theta_max=80 path=looping --keys psidot0",
)
@opt.top(
    "[SCENE] CONDITION...",
    parse=parse_number_or_span,
)
@opt.option(
    "--scan", type=opt.count(), help="Values per unknown.  [default: 4000, 60, 20 for 1, 2, 3]"
)
@opt.keys
@opt.decimal(reads=False, writes=True)
@opt.output("csv", rows=True)
def find_command(
    top: opt.TopOptions,
    words: Sequence[str],
    scan: int | None,
    keys: list[str] | None,
    decimal: str,
    out: Output,
) -> None:
    """Find the inputs for which results take given values.

    An input given as a range from:to (or log:from:to) is an unknown; up to three are allowed.  Give
    as many conditions KEY=NUMBER as unknowns.  If inputs have units, a condition may have a unit
    too (T_precession=500ms); without one, it is in SI.  Conditions such as regime=regular,
    path=looping or 'theta_max<120' restrict the solutions.  With one unknown and no KEY=NUMBER,
    path= or regime= finds the borders of a class, such as the spin at which loops begin.

    With one unknown, find returns every solution that the scan brackets.  With several, it follows
    the best points of the scan and can miss solutions.  The exit code is 1 if no solution is found.
    """
    import numpy as np

    from ..names import check_names
    from ..solver.keys import TEXT_KEYS, all_keys, record_keys
    from ..solver.record import record_in_range
    from ..sweeps.find import find_tops, search_of

    units, out = Units(top.radians), opt.with_mark(out, decimal)
    chosen = record_keys(units)
    if keys is not None:
        known = all_keys(units)
        named = {x: units.key(f"{x}_deg") for x in keys}
        chosen = check_names("keys", [y if y in known else x for x, y in named.items()], known)
    search, given = search_of(top.inputs, words, top.scene, units)
    motions, looked = find_tops(search, scan)
    opt.warn(given)
    opt.warn_of_body(motions[0].top)
    complain(f"{len(motions)} found; {looked}")
    units = given.units(radians=top.radians)
    records = [record_in_range(motion, units=units, keys=chosen)[0] for motion in motions]
    for motion, record in zip(motions, records, strict=True):
        if "psidot0" in record:  # the number of a steady rate
            record["psidot0"] = float(motion.top.psidot0)
    columns = {key: [record.get(key) for record in records] for key in chosen}
    block = [x if key in TEXT_KEYS else np.array(x, float) for key, x in columns.items()]
    out.blocks(chosen, [out.format.block(block, chosen)], _headings(chosen, units, out))
