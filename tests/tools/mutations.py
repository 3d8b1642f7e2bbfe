"""Break the package on purpose, one small change at a time, and count which tests see it.

    python tests/tools/mutations.py 40 --seed 1 --out mutations.csv
    python tests/tools/mutations.py 12 --folder elliptic

Each mutation is made in a temporary clone of the last commit, and meets the quick tests of its
folder.  The folders take turns.  Results are added to the file as they come, and a run with the
same seed goes on where the last one ended.  A mutation that uses much more CPU than the tests do
hangs, and counts as seen.  A test that fails again without the mutation proves nothing: the result
is then undecided.
"""

from __future__ import annotations

import argparse
import ast
import csv
import os
import random
import re
import resource
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from itertools import accumulate, zip_longest
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
FOLDERS = "arithmetic elliptic inputs output motion sweep fit plot compare bench cli".split()
MODULES = {"fit": ["fit", "find.py"]}
"""Modules of a folder, if not those of the same name."""
TESTS = {"output": ["output", "cli"]}
"""Folders of tests of a folder, if not the one of the same name."""
CPU_SECONDS = 900

_OPPOSITES: list[tuple[type[ast.AST], type[ast.AST]]] = [
    *((ast.Lt, ast.LtE), (ast.Gt, ast.GtE), (ast.Eq, ast.NotEq), (ast.In, ast.NotIn)),
    *((ast.Is, ast.IsNot), (ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.And, ast.Or)),
]
OTHER = dict([*_OPPOSITES, *((y, x) for x, y in _OPPOSITES)]) | {ast.Pow: ast.Mult}


class Mutation(NamedTuple):
    """A change of one place of a module, in bytes of its text."""

    path: Path
    line: int
    start: int
    end: int
    old: str
    new: str

    def __str__(self) -> str:
        """Return file, line and change."""
        old, new = (" ".join(text.split())[:40] for text in (self.old, self.new))
        return f"{self.path}:{self.line}: `{old}` -> `{new}`"


def changes(node: ast.AST) -> Iterator[tuple[ast.AST, str]]:
    """Yield the changes of one node: the node that is replaced, and its new text."""
    match node:
        case ast.Constant(bool(value)):
            yield node, str(not value)
        case ast.Constant(int(value)):
            yield node, f"({value + 1})"
            yield node, f"({value - 1})"
        case ast.Constant(float(value)):
            yield node, f"({value + 1!r})"
            yield node, f"({value * 1.001!r})"
        case ast.Compare(left, [operator], right) if type(operator) in OTHER:
            new: ast.AST = ast.Compare(left, [OTHER[type(operator)]()], right)  # type: ignore[list-item]
            yield node, f"({ast.unparse(new)})"
        case ast.BinOp(left, operator, right) if type(operator) in OTHER:
            new = ast.BinOp(left, OTHER[type(operator)](), right)  # type: ignore[arg-type]
            yield node, f"({ast.unparse(new)})"
        case ast.BoolOp(operator, values):
            new = ast.BoolOp(OTHER[type(operator)](), values)  # type: ignore[arg-type]
            yield node, f"({ast.unparse(new)})"
        case ast.UnaryOp(ast.USub() | ast.Not(), operand):
            yield node, f"({ast.unparse(operand)})"
        case ast.Call(ast.Name("min" | "max")):
            pass  # the order of their arguments makes no difference
        case ast.Call(function, [first, second, *more], keywords):
            yield node, ast.unparse(ast.Call(function, [second, first, *more], keywords))
        case ast.IfExp(test) | ast.If(test) | ast.While(test):
            yield test, f"(not ({ast.unparse(test)}))"
        case ast.Expr(ast.Call()) | ast.AugAssign() | ast.Raise():
            yield node, "pass"


def below(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes below a node, without annotations, decorators and f-strings."""
    for name, value in ast.iter_fields(node):
        if name not in {"annotation", "returns", "decorator_list"}:
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST) and not isinstance(child, ast.JoinedStr):
                    yield child
                    yield from below(child)


def mutations(root: Path, path: Path) -> list[Mutation]:
    """Return all mutations of a module that still compile."""
    text, found = path.read_bytes(), []
    starts = [0, *accumulate(map(len, text.splitlines(keepends=True)))]
    for node in below(ast.parse(text)):
        for place, new in changes(node):
            assert isinstance(place, ast.expr | ast.stmt)
            assert place.end_lineno is not None
            assert place.end_col_offset is not None
            start = starts[place.lineno - 1] + place.col_offset
            end = starts[place.end_lineno - 1] + place.end_col_offset
            old = text[start:end].decode()
            one = Mutation(path.relative_to(root), place.lineno, start, end, old, new)
            try:
                compile(mutated(text, one), "module", "exec", dont_inherit=True)
            except (SyntaxError, ValueError):
                continue
            found.append(one)
    return found


def mutated(text: bytes, mutation: Mutation) -> bytes:
    """Return the module with its change."""
    return text[: mutation.start] + mutation.new.encode() + text[mutation.end :]


def chosen(root: Path, folder: str, count: int, seed: int) -> list[Mutation]:
    """Return random mutations of a folder; every module is as likely as every other."""
    rng, package = random.Random(seed), root / "lagrange_cli"
    places = [package / name for name in MODULES.get(folder, [folder])]
    paths = sorted(y for x in places for y in ([x] if x.suffix else x.rglob("*.py")))
    modules = [found for path in paths if (found := mutations(root, path))]
    picked: dict[Mutation, None] = {}
    while len(picked) < min(count, sum(map(len, modules))):
        picked[rng.choice(rng.choice(modules))] = None
    return list(picked)


def first_failure(clone: Path, tests: list[str]) -> str:
    """Run quick tests; return the first that fails, `hangs`, or nothing."""
    options = "-B -m pytest -x -q -p no:cacheprovider --hypothesis-seed=0".split()
    done = subprocess.run(
        [sys.executable, *options, "-m", "not slow", *tests],
        cwd=clone,
        env=os.environ | {"PYTHONPATH": str(clone), "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        check=False,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS)),
    )
    named = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - |$)", done.stdout, re.MULTILINE)
    if named:
        return named[1]
    return {0: "", 5: ""}.get(done.returncode, "hangs or ends")


def checked(clone: Path, folder: str, mutation: Mutation) -> tuple[str, str]:
    """Return what became of a mutation in a clone, which is left as it was."""
    path, tests = clone / mutation.path, [f"tests/{x}" for x in TESTS.get(folder, [folder])]
    text = path.read_bytes()
    path.write_bytes(mutated(text, mutation))
    failed = first_failure(clone, tests)
    path.write_bytes(text)
    if "::" in failed and first_failure(clone, [failed]):
        return "undecided", failed
    return ("seen" if failed else "LIVED"), failed


def known(path: Path) -> list[list[str]]:
    """Return the rows that a file holds already: folder, number, mutation, result, test."""
    return list(csv.reader(path.read_text().splitlines())) if path.exists() else []


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
    with tempfile.TemporaryDirectory(prefix="mutations-") as place:
        clone = Path(place) / "clone"
        subprocess.run(["git", "clone", "-q", ROOT, clone], check=True)
        subprocess.run(["git", "checkout", "-q", options.commit], cwd=clone, check=True)
        folders = [options.folder] if options.folder else FOLDERS
        columns = [chosen(clone, x, options.count, options.seed) for x in folders]
        done = {(row[0], row[1]) for row in known(options.out)}
        for number, row in enumerate(zip_longest(*columns), 1):
            for folder, mutation in zip(folders, row, strict=True):
                if options.list and mutation:
                    print(folder, mutation)
                elif mutation and (folder, str(number)) not in done:
                    result = [folder, number, mutation, *checked(clone, folder, mutation)]
                    print(*result, flush=True)
                    with options.out.open("a", newline="") as file:
                        csv.writer(file).writerow(result)
    counts = Counter((row[0], row[3]) for row in known(options.out))
    print("| folder | seen | lived | undecided |", "|---|---|---|---|", sep="\n")
    for folder in sorted({folder for folder, _ in counts}):
        shown = (str(counts[folder, result]) for result in ("seen", "LIVED", "undecided"))
        print(f"| {folder} |", " | ".join(shown), "|")


if __name__ == "__main__":
    main()
