"""Break the package on purpose, one small change at a time, and count which tests see it.

    python tests/tools/mutations.py 100 --seed 1 --out mutations.csv

Each mutation is made in a temporary clone of the last commit and meets the tests of its room,
the quick ones before the slow ones; only if it lives there, the quick tests of the whole suite.
Results are added to the file as they come, and a run with the same seed goes on where the last one
ended.
"""

from __future__ import annotations

import argparse
import ast
import csv
import os
import queue
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
ROOM_TESTS = {
    "arithmetic": ["tests/elliptic", "tests/motion"],
    "inputs": ["tests/sweeps", "tests/cli"],
    "output": ["tests/cli", "tests/sweeps"],
    "top": ["tests/cli"],
}
"""Tests of rooms that have no folder of their own, where none appeared since."""

ROOM_SECONDS, SUITE_SECONDS = 900, 3600
"""Limits of time; a mutation that exceeds one hangs, and counts as killed."""


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

    number: int
    mutation: str
    result: str
    by: str
    seconds: str


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


def chosen(root: Path, count: int, seed: int, room: str) -> list[Mutation]:
    """Return random mutations of a room or of all; every module is as likely as every other."""
    rng = random.Random(seed)
    paths = sorted((root / "lagrange_cli" / room).rglob("*.py"))
    by_module = [found for path in paths if (found := mutations(root, path))]
    picked: dict[Mutation, None] = {}
    total = sum(map(len, by_module))
    while len(picked) < min(count, total):
        picked[rng.choice(rng.choice(by_module))] = None
    return list(picked)


def tests_of(root: Path, mutation: Mutation) -> list[str]:
    """Return the folders of tests that stand for the room of a module."""
    parts = Path(mutation.path).parts
    room = parts[1] if len(parts) > 2 else "top"
    folder = f"tests/{room}"
    return [folder] if (root / folder).is_dir() else ROOM_TESTS[room]


def run_tests(clone: Path, folders: list[str], seconds: float, kind: str) -> str | None:
    """Return the first test of a kind that fails, "time" where none ends in time, or None."""
    command = ["nice", sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    command += ["--hypothesis-seed=0"]  # what it finds by luck is not the mutation's
    shutil.rmtree(clone / ".hypothesis", ignore_errors=True)
    running = subprocess.Popen(
        [*command, "-m", kind, *folders],
        cwd=clone,
        env=os.environ | {"PYTHONPATH": str(clone), "PYTHONDONTWRITEBYTECODE": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    try:
        output, _ = running.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        with suppress(ProcessLookupError):
            os.killpg(running.pid, signal.SIGKILL)
        running.communicate()
        return "time"
    if running.returncode in (0, 5):  # 5: there are no tests of this kind
        return None
    lines = [line for line in output.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return lines[0].split(" - ")[0] if lines else f"exit code {running.returncode}"


def judged(clone: Path, number: int, mutation: Mutation) -> Outcome:
    """Return what became of a mutation in a clone, which is left as it was."""
    path, begin = clone / mutation.path, time.monotonic()
    text = path.read_bytes()
    path.write_bytes(mutated(text, mutation))
    try:
        result, by = killed(clone, tests_of(clone, mutation))
    finally:
        path.write_bytes(text)
    return Outcome(number, str(mutation), result, by, f"{time.monotonic() - begin:.0f}")


def killed(clone: Path, room: list[str]) -> tuple[str, str]:
    """Return what became of the mutation in a clone, and the first test that sees it."""
    for kind in ("not slow", "slow"):
        if by := run_tests(clone, room, ROOM_SECONDS, kind):
            return "killed by its room", by
    if by := run_tests(clone, ["tests"], SUITE_SECONDS, "not slow"):
        return "killed by the suite", by
    return "LIVED", ""


def main() -> None:
    """Make the mutations that are not yet in the file, then print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--room", default="", help="only modules of this room")
    parser.add_argument("--out", type=Path, default=Path("mutations.csv"))
    parser.add_argument("--list", action="store_true", help="print the mutations and run nothing")
    parser.add_argument("--jobs", type=int, choices=[1, 2], default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="mutations-") as folder:
        clones: queue.Queue[Path] = queue.Queue()
        for i in range(options.jobs):
            clones.put(Path(folder) / str(i))
            subprocess.run(["git", "clone", "-q", ROOT, Path(folder) / str(i)], check=True)
        picked = chosen(Path(folder) / "0", options.count, options.seed, options.room)
        wanted = list(enumerate(picked, 1))
        if options.list:
            print(*(mutation for _, mutation in wanted), sep="\n")
            return
        done = known(options.out)

        @contextmanager
        def free_clone() -> Iterator[Path]:
            """Yield a clone that no other task uses."""
            clone = clones.get()
            try:
                yield clone
            finally:
                clones.put(clone)

        def judge(task: tuple[int, Mutation]) -> None:
            """Judge one mutation and add it to the file."""
            with free_clone() as clone:
                add(options.out, judged(clone, *task))

        def prove(folders: tuple[str, ...]) -> None:
            """End the run if the tests of a room fail without any mutation."""
            with free_clone() as clone:
                if failed := run_tests(clone, list(folders), ROOM_SECONDS, "not slow"):
                    raise SystemExit(f"Error: {failed} fails without any mutation")

        left = [(i, mutation) for i, mutation in wanted if str(mutation) not in done]
        rooms = {tuple(tests_of(clones.queue[0], mutation)) for _, mutation in left}
        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(prove, sorted(rooms)))
            list(pool.map(judge, left))
    print_table(known(options.out))


def known(path: Path) -> dict[str, Outcome]:
    """Return the outcomes that a file holds already, by mutation."""
    if not path.exists():
        return {}
    with path.open(newline="") as file:
        outcomes = [Outcome(int(row[0]), *row[1:]) for row in csv.reader(file)]
    return {outcome.mutation: outcome for outcome in outcomes}


def add(path: Path, outcome: Outcome) -> None:
    """Append an outcome to the file and say it."""
    with path.open("a", newline="") as file:
        csv.writer(file).writerow(outcome)
    print(*outcome, flush=True)


def print_table(outcomes: dict[str, Outcome]) -> None:
    """Print all outcomes as a table in Markdown, and how many lived."""
    print("| | mutation | result | by | s |", "|---|---|---|---|---|", sep="\n")
    for outcome in sorted(outcomes.values()):
        print("|", " | ".join(str(x).replace("|", "\\|") for x in outcome), "|")
    lived = sum(outcome.result == "LIVED" for outcome in outcomes.values())
    print(f"\n{len(outcomes)} mutations, {lived} lived")


if __name__ == "__main__":
    main()
