"""Dirty rows in files of tops, times and trajectories: none lost, none misjudged; not collected.

    python tests/tools/fuzz_rows.py --rows 100000 --seed 1

A row of tops is good if each of its cells is a number that a top can have, by a plain rule of this
script.  A sweep must keep every row in its place: a good one with its numbers, another one with an
error that names its line, in every format, with --jobs, and in parts.  A file of times or a
trajectory must be refused at its first bad line, and at no other.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import math
import random
import re
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from click.testing import CliRunner, Result

from lagrange_cli.cli.app import main

GOOD = "1 2.5 40 50. .5 1e1 -3 +7 0 0.0 1E2 30 90 1e-3".split()
BAD = "x 1,5 -- 1e 0x1 nan inf -inf 1e400 1_0 ٣ 1e-400 --1 1.2.3 1/2 1e1000 −3 .".split()
BAD += ["", " ", "5 0", "1\x00", "'1'", "9" * 2100, "1;2", "1\t2", "ü", "null"]
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
COLUMNS = ["id", "r0", "theta0_deg", "psidot0", "m", "note"]
NOTES = ["plain", "", 'a "quoted" one', "with, comma", "é", "\x1b[31m", "=1+1", "  blanks  "]


class Row(NamedTuple):
    """A line of a file, and whether it describes a top."""

    text: str
    is_good: bool


def is_number(text: str) -> bool:
    """Return whether a text is a decimal number that a double can hold."""
    text = text.strip()
    if len(text) > 2000 or not NUMBER.fullmatch(text):
        return False
    value = float(text)
    return math.isfinite(value) and bool(
        value or not re.search("[1-9]", text.lower().split("e")[0])
    )


def can_be(name: str, text: str) -> bool:
    """Return whether a cell is a number that its input can have."""
    if not is_number(text):
        return False
    value = float(text)
    if name == "theta0_deg":
        return 0 <= value <= 180
    return 1e-100 <= value <= 1e100 if name == "m" else abs(value) <= 1e100


def quoted(cell: str) -> str:
    """Return a cell of CSV."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator="").writerow([cell, "x"])
    return stream.getvalue()[:-2]


def csv_row(rng: random.Random, number: int) -> Row:
    """Return a row of CSV, dirty in one case of three."""
    pool = {name: rng.choice(GOOD) for name in COLUMNS[1:5]} | {"note": rng.choice(NOTES)}
    pool["theta0_deg"], pool["m"] = str(rng.randint(1, 179)), rng.choice(["1", "1587", "2e3"])
    cells = [str(number), *(pool[name] for name in COLUMNS[1:])]
    if rng.random() < 1 / 3:
        cells[rng.randrange(1, 5)] = rng.choice(BAD)
    line = ",".join(map(quoted, cells))
    good = all(can_be(*x) for x in zip(COLUMNS[1:5], cells[1:5], strict=True))
    damage = rng.random()
    if damage < 0.02:
        return Row(line + ",more", False)
    if damage < 0.04:
        return Row(line.rpartition(",")[0], False)
    if damage < 0.05:
        return Row(line[: len(str(number)) + 1] + '"' + line[len(str(number)) + 1 :], False)
    return Row(line, good)


def json_row(rng: random.Random, number: int) -> Row:
    """Return a JSON line, dirty in one case of three."""
    value: dict[str, Any] = {"id": number, "r0": rng.choice([1, 2.5, -40]), "theta0_deg": 30}
    good = True
    if rng.random() < 1 / 3:
        wrong: Any = rng.choice(["1", None, True, [1], {}, "x", 10**400, math.nan, 200])
        name = rng.choice(["r0", "theta0_deg"])
        value[name] = wrong
        good = wrong == 200 and name == "r0"
    text = json.dumps(value)
    if rng.random() < 0.03:
        return Row(text[: rng.randrange(1, len(text) - 1)], False)
    return Row(text, good)


def run(*words: str) -> Result:
    """Run a command in this process."""
    return CliRunner().invoke(main, list(words))


def judged(rows: Sequence[Row], path: Path, fmt: str, more: Sequence[str] = ()) -> Iterator[str]:
    """Yield what is wrong with a sweep of rows in a file."""
    result = run("sweep", str(path), "--keys", "r0,a", "--format", fmt, *more)
    first = 2 if path.suffix == ".csv" else 1
    bad = [i for i, row in enumerate(rows) if not row.is_good]
    if result.exit_code != bool(bad) or result.exception.__class__ not in {SystemExit, type(None)}:
        yield f"{fmt}: exit code {result.exit_code}, {result.exception!r}"
        return
    if bad and not result.stderr.splitlines()[-1].startswith(
        f"Error: {len(bad)} of {len(rows)} tops have an error; the first: line {bad[0] + first}: "
    ):
        yield f"{fmt}: says {result.stderr[:200]!r}"
    found = records(result.stdout, fmt)
    if len(found) != len(rows):
        yield f"{fmt}: {len(found)} rows of {len(rows)}"
        return
    for i, (row, record) in enumerate(zip(rows, found, strict=True)):
        error = record["error"] or ""
        if row.is_good != (not error):
            yield f"{fmt}, line {i + first}: {row.text[:200]!r} has the error {error!r}"
        elif error and not error.startswith(f"line {i + first}: "):
            yield f"{fmt}, line {i + first}: has the error {error!r}"
        elif row.is_good and not math.isfinite(float(record["a"])):
            yield f"{fmt}, line {i + first}: has no numbers"
        if fmt == "ndjson" and "\n" in json.dumps(record):
            yield f"{fmt}, line {i + first}: is more than a line"


def records(text: str, fmt: str) -> list[dict[str, Any]]:
    """Return the rows of an output."""
    if fmt == "csv":
        return list(csv.DictReader(io.StringIO(text)))
    if fmt == "json":
        whole: list[dict[str, Any]] = json.loads(text)
        return whole
    return [json.loads(line) for line in text.splitlines()]


def of_tops(rng: random.Random, count: int, folder: Path, counts: Counter[str]) -> Iterator[str]:
    """Yield the faults of sweeps of so many rows, as CSV and as JSON lines."""
    for suffix, make in ((".csv", csv_row), (".ndjson", json_row)):
        rows = [make(rng, i) for i in range(count)]
        path = folder / f"tops{suffix}"
        header = [",".join(COLUMNS)] if suffix == ".csv" else []
        path.write_bytes("\n".join([*header, *(row.text for row in rows), ""]).encode())
        for fmt in ("csv", "ndjson", "json"):
            counts[f"rows of {suffix} to {fmt}"] += len(rows)
            for wrong in judged(rows, path, fmt):
                yield f"{suffix} {wrong}"
        one = run("sweep", str(path), "--keys", "a")
        two = run("sweep", str(path), "--keys", "a", "--jobs", "2")
        counts[f"rows of {suffix} by two processes"] += len(rows)
        if (one.stdout_bytes, one.stderr) != (two.stdout_bytes, two.stderr):
            yield f"{suffix}: two processes give something else"


def of_lines(rng: random.Random, count: int, folder: Path, counts: Counter[str]) -> Iterator[str]:
    """Yield the faults of files of times and of trajectories, 50 rows each, some with a bad one."""
    for _ in range(count // 50):
        cells = [f"{i / 50}" for i in range(50)]
        at = rng.randrange(50) if rng.random() < 0.7 else None
        if at is not None:
            cells[at] = rng.choice([x for x in BAD if x.strip() and not is_number(x)])
        times, run_file = folder / "times.txt", folder / "run.csv"
        times.write_bytes("\n".join(cells).encode())
        counts["rows of times"] += 50
        shown = run("table", "--times", str(times), "--columns", "t")
        place = f"Error: {times}, line {(at or 0) + 1}: the time "
        if at is None and shown.stdout.count("\n") != 51:
            yield f"times: {shown.stderr!r}"
        if at is not None and (shown.exit_code != 65 or not shown.stderr.startswith(place)):
            yield f"times, line {at + 1}, {cells[at][:20]!r}: {shown.exit_code} {shown.stderr!r}"
        tilts = [f"{30 + i % 5}" for i in range(50)]
        wrong = rng.choice(["x", "1_0", "0x1", "--", "1.2.3", "1e", "'1'", "1/2"])
        if at is not None:
            tilts[at] = wrong
        text = "t,theta\n" + "".join(f"{i / 50},{x}\n" for i, x in enumerate(tilts))
        run_file.write_text(text)
        counts["rows of trajectories"] += 50
        shown = run("compare", str(run_file))
        place = f"Error: {run_file}, line {(at or 0) + 2}, column 2: theta must be a number, got "
        if at is None and shown.exit_code not in {0, 1}:
            yield f"trajectory: {shown.stderr!r}"
        if at is not None and (shown.exit_code != 65 or not shown.stderr.startswith(place)):
            yield f"trajectory, line {at + 2}, {wrong!r}: {shown.exit_code} {shown.stderr!r}"


def script() -> None:
    """Print counts and faults; the exit code is 1 if there is a fault."""
    parser = argparse.ArgumentParser(description="Give files of dirty rows to the commands.")
    parser.add_argument("--rows", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    rng, counts, faults = random.Random(given.seed), Counter[str](), 0
    begun = time.perf_counter()
    with tempfile.TemporaryDirectory() as name:
        for part in (of_tops, of_lines):
            for wrong in part(
                rng, given.rows // (10 if part is of_tops else 5), Path(name), counts
            ):
                faults += 1
                print(ascii(wrong)[:400])
    print(f"{sum(counts.values())} rows, {faults} faults, {time.perf_counter() - begun:.0f} s")
    for what, count in sorted(counts.items()):
        print(f"  {what}: {count}")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    script()
