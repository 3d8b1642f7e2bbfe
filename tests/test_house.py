"""House rules: imports point down one list, without circles."""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from conftest import ROOT

PACKAGE = ROOT / "lagrange_cli"
FILES = sorted(set(PACKAGE.rglob("*.py")) - {PACKAGE / "alias.py"})

LAYERS = [
    *("__main__", "cli", "bench comparison", "plot", "inverse"),
    *("account sweeps recordings", "solver"),
    *("elliptic files output", "top", "names file_bytes", "arithmetic", "errors"),
]
"""A subpackage imports only from the lines below its own."""
LEVEL = {name: i for i, line in enumerate(LAYERS) for name in line.split()}
FACE = {"__version__", "draw", "draw_outcome", "view"}
"""Names that subpackages import from the package itself, late: methods such as `Motion.plot`."""


def imports(path: Path) -> Iterator[tuple[str, ...]]:
    """Yield each name that a module imports from the package, by its parts."""
    here = path.relative_to(PACKAGE).parts
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            module = tuple(filter(None, (node.module or "").split(".")))
            assert node.level or "lagrange_cli" not in module, f"{path}: use relative imports"
            if node.level:
                yield from ((*here[: -node.level], *module, alias.name) for alias in node.names)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_point_down(path: Path) -> None:
    here = path.relative_to(PACKAGE).with_suffix("").parts[0]
    for name in imports(path) if here != "__init__" else ():
        below = name[0] in {here, *FACE} or LEVEL[name[0]] > LEVEL[here]
        assert below, f"{path} imports {'.'.join(name)}"
        assert not re.match("_[^_]", name[-1]), f"{name[-1]} is private"


def test_imports_form_no_circles() -> None:
    modules = {path.relative_to(PACKAGE).with_suffix("").parts: path for path in FILES}
    del modules["__init__",]
    graph: dict[tuple[str, ...], set[tuple[str, ...]]] = {}
    for module, path in modules.items():
        names = [x for y in imports(path) for x in (y, y[:-1], (*y[:-1], "__init__"))]
        graph[module] = {x for x in names if x in modules and x != module}
    TopologicalSorter(graph).prepare()


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_only_the_command_line_names_options(path: Path) -> None:
    """A message of the library names arguments: `columns=t`; the command line makes options."""
    if path.relative_to(PACKAGE).parts[0] == "cli":
        return
    tree = ast.parse(path.read_text(encoding="utf-8"))
    docs = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docs:
            assert not re.search(r"(?<!-)--[a-z]", node.value), f"{path}, line {node.lineno}"


def test_top_of_the_project_holds_only_what_must_be_there() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False, text=True
    )
    if listed.returncode:
        pytest.skip("not a clone of the repository")
    names = {path.partition("/")[0] for path in listed.stdout.split("\0") if path}
    visible = {name for name in names if not name.startswith(".")}
    assert visible == {"pyproject.toml", "README.md", "lagrange_cli", "tests", "sample_inputs"}
