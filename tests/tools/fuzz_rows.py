"""Dirty rows in files of tops, times and trajectories: none lost, none misjudged; not collected.

    python tests/tools/fuzz_rows.py --rows 100000 --seed 1

A row of tops is good if each of its cells is a number that a top can have, by a plain rule of this
script, which reads it character by character, for each delimiter and decimal mark.  A sweep must
keep every row in its place: a good one with its numbers, another one with an error that names its
line, in every format, and with --jobs.  A file of times or a trajectory must be refused at its
first bad line, and at no other.  A file whose decimal mark is unclear must be refused.
"""

from __future__ import annotations

import csv
import io
import json
import math
import random
import re
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from campaign import finish, options
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


class Dialect(NamedTuple):
    """The delimiter and the decimal mark of a file, and the options that name the mark."""

    delimiter: str
    decimal: str

    @property
    def options(self) -> list[str]:
        """The option that names the decimal mark, if there is a choice."""
        names = {".": "point", ",": "comma"}
        return [] if self.delimiter == "," else ["--decimal", names[self.decimal]]


DIALECTS = [Dialect(*x) for x in (",.", ";.", ";,", "\t.", "\t,", " .", " ,")]


def cells_of(line: str, delimiter: str) -> list[str] | None:
    """Return the cells of a line, character by character; None if a quote is wrong."""
    cells, cell, state = list[str](), "", "start"
    for x in [*line, delimiter]:
        if state == "inside":
            cell, state = (cell, "quote") if x == '"' else (cell + x, state)
        elif x == '"' and state == "quote":
            cell, state = cell + x, "inside"
        elif x == delimiter or (delimiter == " " and x.isspace()):
            if delimiter != " " or state != "start":
                cells.append(cell)
            cell, state = "", "start"
        elif state == "quote":
            return None
        elif x == '"' and state == "start":
            state = "inside"
        else:
            cell, state = cell + x, "plain"
    return None if state == "inside" else cells


def is_number(text: str, decimal: str = ".") -> bool:
    """Return whether a text is a decimal number that a double can hold."""
    text = text.strip()
    if decimal == ",":
        text = text.replace(".", "x").replace(",", ".")
    if len(text) > 2000 or not NUMBER.fullmatch(text):
        return False
    value = float(text)
    return math.isfinite(value) and bool(
        value or not re.search("[1-9]", text.lower().split("e")[0])
    )


def can_be(name: str, text: str, decimal: str) -> bool:
    """Return whether a cell is a number that its input can have."""
    if not is_number(text, decimal):
        return False
    value = float(text.replace(",", "."))
    if name == "theta0_deg":
        return 0 <= value <= 180
    return 1e-100 <= value <= 1e100 if name == "m" else abs(value) <= 1e100


def quoted(cell: str, delimiter: str) -> str:
    """Return a cell, between quotes if it has to be."""
    special = not cell or any(x.isspace() for x in cell) if delimiter == " " else False
    if special or delimiter in cell or '"' in cell:
        return '"' + cell.replace('"', '""') + '"'
    return cell


def csv_row(rng: random.Random, number: int, dialect: Dialect) -> Row:
    """Return a row of cells, dirty in one case of three, as a reader of characters judges it."""
    pool = {name: rng.choice(GOOD) for name in COLUMNS[1:5]} | {"note": rng.choice(NOTES)}
    pool["theta0_deg"], pool["m"] = str(rng.randint(1, 179)), rng.choice(["1", "1587", "2e3"])
    cells = [str(number), *(pool[name] for name in COLUMNS[1:])]
    cells[1:5] = [x.replace(".", dialect.decimal) for x in cells[1:5]]
    if rng.random() < 1 / 3:
        cells[rng.randrange(1, 5)] = rng.choice(BAD)
    delimiter = dialect.delimiter
    line = delimiter.join(quoted(x, delimiter) for x in cells)
    damage = rng.random()
    if damage < 0.02:
        line += f"{delimiter}more"
    elif damage < 0.04:
        line = line.rpartition(delimiter)[0]
    elif damage < 0.05:
        line = line[: len(str(number)) + 1] + '"' + line[len(str(number)) + 1 :]
    found = cells_of(line, delimiter)
    good = found is not None and len(found) == len(COLUMNS) and "\0" not in line
    pairs = zip(COLUMNS[1:5], (found or [])[1:5], strict=False)
    return Row(line, good and all(can_be(*x, dialect.decimal) for x in pairs))


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
    """Yield the faults of sweeps of `count` rows in each dialect, and as JSON lines."""
    for dialect in (*DIALECTS, None):
        rows = [csv_row(rng, i, dialect) if dialect else json_row(rng, i) for i in range(count)]
        path = folder / f"tops{'.csv' if dialect else '.ndjson'}"
        header = [dialect.delimiter.join(COLUMNS)] if dialect else []
        path.write_bytes("\n".join([*header, *(row.text for row in rows), ""]).encode())
        more, kind = (dialect.options, repr(dialect)) if dialect else ([], "JSON lines")
        for fmt in ("csv", "ndjson", "json"):
            counts[f"rows of {kind} to {fmt}"] += len(rows)
            for wrong in judged(rows, path, fmt, more):
                yield f"{kind} {wrong}"
        one = run("sweep", str(path), "--keys", "a", *more)
        two = run("sweep", str(path), "--keys", "a", "--jobs", "2", *more)
        counts[f"rows of {kind} by two processes"] += len(rows)
        if (one.stdout_bytes, one.stderr) != (two.stdout_bytes, two.stderr):
            yield f"{kind}: two processes give something else"


def of_decisions(
    rng: random.Random, count: int, folder: Path, counts: Counter[str]
) -> Iterator[str]:
    """Yield the faults of files of 20 rows whose decimal mark nobody names."""
    names = ["a", "b"]
    for _ in range(count // 20):
        dialect = rng.choice(DIALECTS[1:])
        marks = rng.choice([dialect.decimal] * 8 + [".,"])
        cells = [_measured(rng, marks) for _ in range(20)]
        head = dialect.delimiter.join(["r0", "psidot0", *names])
        lines = [dialect.delimiter.join([*pair, "1", "2"]) for pair in cells]
        path = folder / "tops.csv"
        path.write_text("\n".join([head, *lines, ""]))
        counts["rows whose decimal mark nobody names"] += 20
        mark = decision([x for pair in cells for x in pair])
        result = run("sweep", str(path), "--keys", "r0,psidot0", "--format", "json")
        if mark is None:
            if result.exit_code != 65 or "pass --decimal" not in result.stderr:
                yield f"{cells}: is not refused: {result.stderr!r}"
            continue
        wanted = [tuple(float(x.replace(mark, ".")) for x in pair) for pair in cells]
        found = [(x["r0"], x["psidot0"]) for x in json.loads(result.stdout or "[]")]
        if found != wanted:
            yield f"{cells}: {result.stderr!r}"


def _measured(rng: random.Random, marks: str) -> tuple[str, str]:
    """Return two numbers, some of three decimals, which may be thousands as well."""
    left, right = (
        f"{rng.choice([0, 0, 1, 12, 345])}{rng.choice(marks)}{rng.choice(['5', '25', '125', '0'])}"
        if rng.random() < 0.5
        else str(rng.randint(0, 99))
        for _ in range(2)
    )
    return left, right


def decision(cells: Sequence[str]) -> str | None:
    """Return the decimal mark of numbers, None if it is not clear."""
    commas = [x for x in cells if "," in x]
    if commas and any("." in x for x in cells):
        return None
    if commas and all(re.fullmatch(r"[1-9]\d{0,2},\d{3}", x) for x in commas):
        return None
    return "," if commas else "."


def of_lines(rng: random.Random, count: int, folder: Path, counts: Counter[str]) -> Iterator[str]:
    """Yield the faults of files of times and of trajectories, 50 rows each, some with a bad one."""
    for _ in range(count // 50):
        dialect = rng.choice(DIALECTS)
        decimal, delimiter = dialect.decimal, dialect.delimiter
        cells = [f"{i / 50}".replace(".", decimal) for i in range(50)]
        at = rng.randrange(50) if rng.random() < 0.7 else None
        if at is not None:
            bad = [x for x in BAD if x.strip() and not is_number(x, decimal)]
            cells[at] = rng.choice([x for x in bad if delimiter not in x])
        times, run_file = folder / "times.txt", folder / "run.csv"
        times.write_bytes("\n".join(["t", *cells]).encode())
        counts["rows of times"] += 50
        names = {".": "point", ",": "comma"}
        options = ["--decimal", names[decimal]]
        shown = run("table", "--times", str(times), "--columns", "t", *options)
        place = f"Error: {times}, line {(at or 0) + 2}: "
        if at is None and shown.stdout.count("\n") != 51:
            yield f"times: {shown.stderr!r}"
        if at is not None and (shown.exit_code != 65 or not shown.stderr.startswith(place)):
            yield f"times, line {at + 2}, {cells[at][:20]!r}: {shown.exit_code} {shown.stderr!r}"
        tilts = [f"{30 + i % 5}" for i in range(50)]
        wrong = rng.choice(["x", "1_0", "0x1", "--", "1.2.3", "1e", "'1'", "1/2", "1,2,3", "1.5,2"])
        wrong = "x" if delimiter in wrong else wrong
        if at is not None:
            tilts[at] = wrong
        rows = (f"{i / 50}".replace(".", decimal) + delimiter + x for i, x in enumerate(tilts))
        run_file.write_text("\n".join([f"t{delimiter}theta", *rows, ""]))
        counts["rows of trajectories"] += 50
        shown = run("compare", str(run_file), *dialect.options)
        place = f"Error: {run_file}, line {(at or 0) + 2}, column 2: theta must be a number, got "
        if at is None and shown.exit_code not in {0, 1}:
            yield f"trajectory: {shown.stderr!r}"
        if at is not None and (shown.exit_code != 65 or not shown.stderr.startswith(place)):
            yield f"trajectory, line {at + 2}, {wrong!r}: {shown.exit_code} {shown.stderr!r}"


def faults(rows: int, seed: int) -> Iterator[str]:
    """Yield the faults of all files, then print the numbers of their rows."""
    rng, counts = random.Random(seed), Counter[str]()
    with tempfile.TemporaryDirectory() as name:
        for part in (of_tops, of_decisions, of_lines):
            yield from part(rng, rows if part is of_tops else rows // 5, Path(name), counts)
    for what, count in sorted(counts.items()):
        print(f"  {what}: {count}")


if __name__ == "__main__":
    given = options(__doc__, rows=1000).parse_args()
    finish(faults(given.rows, given.seed))
