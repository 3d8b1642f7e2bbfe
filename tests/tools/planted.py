"""Plant faults in a subpackage and see whether its own quick tests fail; not collected by pytest.

    python tests/tools/planted.py account --faults 20 --seed 1

Each fault changes one operator, comparison, condition or number in a copy of the project: + becomes
-, * becomes /, < becomes >=, a condition or a truth value its opposite, a number one more.  Default
values of arguments, annotations and messages are left alone.  The tests of the folder of the same
name and those of the examples run with -x.  A fault that no test sees is printed: judge whether it
changes anything.
The exit code is 1 if less than 80 % are seen.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
SKIPPED = shutil.ignore_patterns(".*", "__pycache__", "images")
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    **{ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult},
    **{ast.FloorDiv: ast.Mult, ast.Mod: ast.Mult, ast.BitOr: ast.BitAnd, ast.BitAnd: ast.BitOr},
}
COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    **{ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq},
    **{ast.NotEq: ast.Eq, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot},
}


def nodes_of(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes that a fault may change, in order."""
    for name, field in ast.iter_fields(tree):
        for node in field if isinstance(field, list) else [field]:
            if name in {"annotation", "returns"} or not isinstance(node, ast.AST):
                continue
            if not isinstance(node, ast.arguments | ast.Raise | ast.JoinedStr):
                yield node
                yield from nodes_of(node)


def plant(node: ast.AST) -> bool:
    """Put a fault into a node; return False if there is none for it."""
    if isinstance(node, ast.BinOp | ast.AugAssign) and type(node.op) in OPERATORS:
        node.op = OPERATORS[type(node.op)]()
    elif isinstance(node, ast.Compare) and type(node.ops[0]) in COMPARISONS:
        node.ops[0] = COMPARISONS[type(node.ops[0])]()
    elif isinstance(node, ast.If | ast.IfExp) and not isinstance(node.test, ast.Compare):
        node.test = ast.UnaryOp(ast.Not(), node.test)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        node.value = not node.value if isinstance(node.value, bool) else node.value + 1
    else:
        return False
    ast.fix_missing_locations(node)
    return True


def planted(path: Path, which: float) -> tuple[str, str]:
    """Return the text of a module with one fault, and its line before and after."""
    source = path.read_text(encoding="utf-8")
    places = [i for i, node in enumerate([*nodes_of(ast.parse(source))]) if plant(node)]
    if not places:
        raise ValueError(f"{path} has no place for a fault")
    tree = ast.parse(source)
    node = [*nodes_of(tree)][places[int(which * len(places))]]
    before = ast.unparse(node) if isinstance(node, ast.expr) else "..."
    plant(node)
    after = ast.unparse(node) if isinstance(node, ast.expr) else "the opposite"
    line = f"{path.name}:{getattr(node, 'lineno', 0)}: {before[:60]} -> {after[:60]}"
    return ast.unparse(tree), line


def is_seen(copy: Path, folder: str) -> bool:
    """Return whether the quick tests of a folder of the copy fail, or run for ten minutes."""
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    environment = os.environ | {"PYTHONPATH": str(copy)}
    command += [f"tests/{folder}", "tests/test_examples.py"]
    try:
        subprocess.run(
            command, cwd=copy, env=environment, capture_output=True, check=True, timeout=600
        )
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired):
        return True
    return False


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", help="a subpackage with tests of its own, such as account")
    parser.add_argument("--faults", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng, seen = random.Random(options.seed), 0
    with TemporaryDirectory() as place:
        copy = Path(place)
        for name in ("lagrange_cli", "tests", "sample_inputs"):
            shutil.copytree(ROOT / name, copy / name, ignore=SKIPPED)
        shutil.copy(ROOT / "pyproject.toml", copy)
        if is_seen(copy, options.folder):
            parser.error("the tests fail without a fault")
        paths = sorted((copy / "lagrange_cli" / options.folder).rglob("*.py"))
        sizes = [path.stat().st_size for path in paths]
        for _ in range(options.faults):
            (path,) = rng.choices(paths, sizes)
            right = path.read_text(encoding="utf-8")
            wrong, line = planted(path, rng.random())
            path.write_text(wrong, encoding="utf-8")
            if is_seen(copy, options.folder):
                seen += 1
            else:
                print(f"not seen: {line}", flush=True)
            path.write_text(right, encoding="utf-8")
    print(f"{options.folder}: {seen} of {options.faults} faults seen, seed {options.seed}")
    return 0 if seen >= 0.8 * options.faults else 1


if __name__ == "__main__":
    sys.exit(main())
