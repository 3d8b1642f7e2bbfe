"""Break the package on purpose, one small change at a time, and count which tests see it.

    python tests/tools/mutations.py 40 --seed 1 --out mutations.csv

Each mutation is made in a temporary clone of the last commit.  It meets the quick tests of its
folder, but only the test files that run the changed line.  The folders take turns.  Results are
added to the file as they come, and a run with the same seed goes on where the last one ended.
A mutation that uses much more CPU than the tests usually do hangs, and counts as seen.  A test that
fails again without the mutation proves nothing: the result is then undecided.

Needs the package `coverage`.
"""

from __future__ import annotations

import argparse
import ast
import csv
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import accumulate, zip_longest
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[2]
FOLDERS = (
    *("arithmetic", "elliptic", "inputs", "output", "motion", "sweep", "fit", "plot", "compare"),
    *("bench", "cli"),
)
MODULES = {"fit": ["fit", "find.py"]}
"""Modules of a folder, if not those of the same name."""
TESTS = {"output": ["output", "cli"]}
"""Folders of tests of a folder, if not the one of the same name."""
OTHER_PROCESSES = ("subprocess", "process(", "forked(")
"""Words of test files that run the package in other processes, whose lines are not recorded."""

WALL_SECONDS = 3600
"""Limit for the tests of a mutation on a busy machine; a mutation that exceeds it is undecided."""


class Mutation(NamedTuple):
    """A change of one place of a module, in bytes of its text."""

    path: str
    line: int
    start: int
    end: int
    old: str
    new: str

    def __str__(self) -> str:
        """Return file, line and change."""
        return f"{self.path}:{self.line}: {shortened(self.old)} -> {shortened(self.new)}"


class Outcome(NamedTuple):
    """The result of a mutation."""

    folder: str
    number: int
    mutation: str
    result: str
    by: str
    seconds: str


class Run(NamedTuple):
    """The end of a run of tests."""

    failed: str
    """The first test that fails, or why the run ended; empty if all tests pass."""
    cpu: float
    is_decided: bool = True


def mutations(root: Path, path: Path) -> list[Mutation]:
    """Return all mutations of a module that still compile."""
    text = path.read_bytes()
    starts = [0, *accumulate(map(len, text.splitlines(keepends=True)))]

    def place(node: ast.expr | ast.stmt) -> tuple[int, int]:
        """Return the bytes that a node takes."""
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        start = starts[node.lineno - 1] + node.col_offset
        return start, starts[node.end_lineno - 1] + node.end_col_offset

    name = str(path.relative_to(root))
    found = [
        Mutation(name, node.lineno, start, end, text[start:end].decode(), new)
        for node in changeable(ast.parse(text))
        for start, end, new in changes(node, place, text.decode("latin-1"))
    ]
    return [m for m in found if m.old != m.new and compiles(mutated(text, m))]


def changeable(node: ast.AST) -> Iterator[ast.expr | ast.stmt]:
    """Yield the expressions and statements below a node.

    Annotations, docstrings, and statements for the type checker are left out.
    """
    for field, value in ast.iter_fields(node):
        if field in {"annotation", "returns", "decorator_list"}:
            continue
        for child in value if isinstance(value, list) else [value]:
            match child:
                case ast.JoinedStr() | ast.Expr(ast.Constant(str())):
                    continue
                case ast.If(ast.Name("TYPE_CHECKING")):
                    continue
                case ast.expr() | ast.stmt():
                    yield child
            if isinstance(child, ast.AST):
                yield from changeable(child)


OPERATORS: dict[type, tuple[str, str]] = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.Pow: ("**", "*"),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}

Place = Callable[[ast.expr | ast.stmt], tuple[int, int]]
Change = tuple[int, int, str]


def changes(node: ast.expr | ast.stmt, place: Place, text: str) -> Iterator[Change]:
    """Yield the changes of one node: bytes from, bytes to, new text."""
    start, end = place(node)
    match node:
        case ast.Constant(bool(value)):
            yield start, end, str(not value)
        case ast.Constant(int(value)):
            yield start, end, str(value + 1)
            yield start, end, f"({value - 1})"
        case ast.Constant(float(value)):
            yield start, end, repr(value + 1)
            yield start, end, repr(value * 1.001)
        case ast.Compare(left, [operator], [right]):
            yield from between(left, right, operator, place, text)
        case ast.BinOp(left, operator, right):
            yield from between(left, right, operator, place, text)
        case ast.BoolOp(operator, [left, right, *_]):
            yield from between(left, right, operator, place, text)
        case ast.UnaryOp(ast.USub() | ast.Not(), operand):
            yield start, place(operand)[0], ""
        case ast.Call(ast.Name("min" | "max")):
            pass  # the order of their arguments makes no difference
        case ast.Call(_, [first, second, *_]) if not isinstance(first, ast.Starred):
            (a, b), (c, d) = place(first), place(second)
            yield a, d, recoded(text[c:d] + text[b:c] + text[a:b])
        case ast.IfExp(test):
            yield *place(test), f"not ({recoded(text[slice(*place(test))])})"
        case ast.If(test) | ast.While(test):
            yield *place(test), f"not ({recoded(text[slice(*place(test))])})"
        case ast.Expr(ast.Call()) | ast.AugAssign() | ast.Raise():
            yield start, end, "pass"


def between(
    left: ast.expr, right: ast.expr, operator: ast.AST, place: Place, text: str
) -> Iterator[Change]:
    """Yield the change of the operator that stands between two operands."""
    if type(operator) not in OPERATORS:
        return
    old, new = OPERATORS[type(operator)]
    begin, limit = place(left)[1], place(right)[0]
    at = text.find(old, begin, limit)
    if at >= 0:
        yield at, at + len(old), new


def recoded(text: str) -> str:
    """Return as text what was read as one character per byte."""
    return text.encode("latin-1").decode()


def mutated(text: bytes, mutation: Mutation) -> bytes:
    """Return the module with its change."""
    return text[: mutation.start] + mutation.new.encode() + text[mutation.end :]


def compiles(text: bytes) -> bool:
    """Return whether a module is still a program."""
    try:
        compile(text, "module", "exec", dont_inherit=True)
    except (SyntaxError, ValueError):
        return False
    return True


def shortened(text: str) -> str:
    """Return a text in one line of at most 40 characters."""
    line = " ".join(text.split())
    return f"`{line if len(line) <= 40 else line[:37] + '...'}`"


def chosen(root: Path, folder: str, count: int, seed: int) -> list[Mutation]:
    """Return random mutations of a folder; every module is as likely as every other."""
    rng = random.Random(seed)
    places = [root / "lagrange_cli" / name for name in MODULES.get(folder, [folder])]
    paths = sorted(
        path for x in places for path in ([x] if x.suffix else x.rglob("*.py")) if path.exists()
    )
    by_module = [found for path in paths if (found := mutations(root, path))]
    picked: dict[Mutation, None] = {}
    total = sum(map(len, by_module))
    while len(picked) < min(count, total):
        picked[rng.choice(rng.choice(by_module))] = None
    return list(picked)


class FirstFailure:
    """A plugin of pytest that keeps the name of the first test that fails."""

    name = ""

    def keep(self, report: Any) -> None:
        """Keep the name of a failed test, or of a file that cannot be read."""
        if report.failed and not self.name:
            self.name = report.nodeid or "collection"

    pytest_runtest_logreport = pytest_collectreport = keep


def run_tests(clone: Path, tests: list[str], limit: float, lines: Path | None = None) -> Run:
    """Run quick tests in a fork of this process, with a limit of CPU seconds.

    Write the lines of the package that run to a file, if it is given.
    """
    shutil.rmtree(clone / ".hypothesis", ignore_errors=True)
    shutil.rmtree(clone / ".tmp", ignore_errors=True)
    answer, begin = clone / ".answer", time.monotonic()
    answer.unlink(missing_ok=True)
    child = os.fork()
    if not child:
        with suppress(BaseException):
            os.setsid()
            os.chdir(clone)
            resource.setrlimit(resource.RLIMIT_CPU, (int(limit), int(limit) + 10))
            resource.setrlimit(resource.RLIMIT_AS, (16 << 30, 16 << 30))
            tested(clone, tests, answer, lines)
        os._exit(0)
    status, usage = 0, None
    while usage is None:
        ended, status, used = os.wait4(child, os.WNOHANG)
        usage = used if ended else None
        if usage is None and time.monotonic() - begin > WALL_SECONDS:
            break
        time.sleep(0.05)
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    if usage is None:
        os.waitpid(child, 0)
        return Run("no end on a busy machine", 0.0, is_decided=False)
    cpu = usage.ru_utime + usage.ru_stime
    if not answer.exists():
        return Run("hangs" if cpu >= int(limit) - 1 else f"ends with status {status}", cpu)
    return Run(json.loads(answer.read_text()), cpu)


def tested(clone: Path, tests: list[str], answer: Path, lines: Path | None) -> None:
    """Run tests in this process and write the name of the first failure."""
    import pytest

    with open(os.devnull, "w") as nothing:
        for number in (1, 2):
            os.dup2(nothing.fileno(), number)
    os.environ["PYTHONPATH"] = str(clone)
    sys.path.insert(0, str(clone))
    recorder: Any = None
    if lines is not None:
        from coverage import Coverage

        recorder = Coverage(data_file=None, source=[str(clone / "lagrange_cli")])
        recorder.start()
    first = FirstFailure()
    options = ["-x", "-q", "-p", "no:cacheprovider", "-m", "not slow", "--hypothesis-seed=0"]
    code = pytest.main([*options, f"--basetemp={clone / '.tmp'}", *tests], plugins=[first])
    if recorder is not None and lines is not None:
        recorder.stop()
        data = recorder.get_data()
        found = {str(Path(x).relative_to(clone)): data.lines(x) for x in data.measured_files()}
        lines.write_text(json.dumps(found))
    answer.write_text(json.dumps("" if code in (0, 5) else first.name or f"exit code {int(code)}"))


class TestFile(NamedTuple):
    """A file of tests: the lines of the package that it runs, and its CPU seconds."""

    name: str
    lines: dict[str, set[int]]
    cpu: float
    """Infinite if the file fails without any mutation."""
    forks: bool
    """Whether it runs the package in other processes."""


def test_files(clone: Path, folder: str, store: Path) -> list[TestFile]:
    """Run the test files of a folder without any mutation, once for all runs of this program."""
    found = []
    names = [clone / "tests" / name for name in TESTS.get(folder, [folder])]
    for path in sorted(x for name in names for x in name.rglob("test_*.py")):
        name = str(path.relative_to(clone))
        kept = store / (name.replace("/", "-") + ".json")
        if not kept.exists():
            lines = clone / ".lines"
            lines.write_text("{}")
            run = run_tests(clone, [name], WALL_SECONDS, lines)
            if run.failed:
                print(f"{name} is left out: {run.failed} fails without any mutation", flush=True)
            cpu = float("inf") if run.failed else run.cpu
            kept.write_text(json.dumps([json.loads(lines.read_text()), cpu]))
        lines_of, cpu = json.loads(kept.read_text())
        forks = any(word in path.read_text() for word in OTHER_PROCESSES)
        found.append(TestFile(name, {x: set(y) for x, y in lines_of.items()}, cpu, forks))
    return [file for file in found if file.cpu < float("inf")]


def statement_lines(text: str, line: int) -> set[int]:
    """Return the lines of the statement at a line; of a block, those before its body."""
    found: set[int] = set()
    for node in ast.walk(ast.parse(text)):  # inner statements come later
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or node.lineno):
            body = getattr(node, "body", None) or getattr(node, "cases", None)
            end = body[0].lineno - 1 if isinstance(node, ast.stmt) and body else node.end_lineno
            found = set(range(node.lineno, max(node.lineno, end or 0) + 1))
    return found


def judged(clone: Path, files: list[TestFile], number: int, mutation: Mutation) -> tuple[str, str]:
    """Return what became of a mutation in a clone, which is left as it was."""
    lines = statement_lines((clone / mutation.path).read_text(), mutation.line)
    wanted = [x for x in files if x.forks or lines & x.lines.get(mutation.path, set())]
    if not wanted:
        return "LIVED", "no test runs the line"
    wanted.sort(key=lambda x: x.cpu)
    path, before = clone / mutation.path, (clone / mutation.path).stat()
    text = path.read_bytes()
    path.write_bytes(mutated(text, mutation))
    os.utime(path, (10**9 + number, 10**9 + number))  # no bytecode of another text fits
    try:
        run = run_tests(clone, [x.name for x in wanted], 60 + 20 * sum(x.cpu for x in wanted))
    finally:
        path.write_bytes(text)
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    if not run.failed:
        return "LIVED", ""
    forks = any(run.failed.startswith(x.name) for x in wanted if x.forks)
    if not run.is_decided or (forks and run_tests(clone, [run.failed], WALL_SECONDS).failed):
        return "undecided", run.failed
    return "seen", run.failed


def preload() -> None:
    """Import the packages that tests use, so that a fork need not do it again."""
    import click.testing
    import mpmath
    import numpy
    import pytest
    import rich.table
    import scipy.integrate
    import scipy.optimize
    import scipy.spatial.transform
    import scipy.special

    assert all((click, mpmath, numpy, pytest, rich, scipy))


def main() -> None:
    """Make the mutations that are not yet in the file, then print the share that is seen."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, help="mutations of each folder")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", choices=FOLDERS, help="only this folder")
    parser.add_argument("--out", type=Path, default=Path("mutations.csv"))
    parser.add_argument("--commit", default="HEAD", help="the program and its tests")
    parser.add_argument("--list", action="store_true", help="print the mutations and run nothing")
    options = parser.parse_args()
    store = options.out.with_suffix(".lines")
    store.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="mutations-") as place:
        clone = Path(place) / "clone"
        subprocess.run(["git", "clone", "-q", ROOT, clone], check=True)
        subprocess.run(["git", "checkout", "-q", options.commit], cwd=clone, check=True)
        folders = [options.folder] if options.folder else list(FOLDERS)
        picked = {x: chosen(clone, x, options.count, options.seed) for x in folders}
        turns = [
            (folder, number, mutation)
            for number, row in enumerate(zip_longest(*picked.values()), 1)
            for folder, mutation in zip(picked, row, strict=True)
            if mutation is not None
        ]
        if options.list:
            print(*(f"{folder} {mutation}" for folder, _, mutation in turns), sep="\n")
            return
        os.environ["OPENBLAS_NUM_THREADS"] = "1"
        preload()
        done = {(x.folder, x.number) for x in known(options.out)}
        for folder, number, mutation in turns:
            if (folder, number) not in done:
                begin, files = time.monotonic(), test_files(clone, folder, store)
                result = judged(clone, files, number, mutation)
                seconds = f"{time.monotonic() - begin:.0f}"
                add(options.out, Outcome(folder, number, str(mutation), *result, seconds))
    print_shares(known(options.out))


def known(path: Path) -> list[Outcome]:
    """Return the outcomes that a file holds already."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return [Outcome(row[0], int(row[1]), *row[2:]) for row in csv.reader(file)]


def add(path: Path, outcome: Outcome) -> None:
    """Append an outcome to the file and print it."""
    with path.open("a", newline="") as file:
        csv.writer(file).writerow(outcome)
    print(*outcome, flush=True)


def print_shares(outcomes: list[Outcome]) -> None:
    """Print how many mutations of each folder are seen, as a table in Markdown."""
    counts = Counter((x.folder, x.result) for x in outcomes)
    print("| folder | mutations | seen | lived | undecided |", "|---|---|---|---|---|", sep="\n")
    for folder in [*FOLDERS, ""]:
        row = [
            sum(n for (x, y), n in counts.items() if folder in {x, ""} and y == result)
            for result in ("seen", "LIVED", "undecided")
        ]
        if sum(row):
            print(f"| {folder or 'all'} | {sum(row)} |", " | ".join(map(str, row)), "|")


if __name__ == "__main__":
    main()
