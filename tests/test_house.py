"""House rules: imports point down one list, without circles."""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from conftest import ROOT

PACKAGE = ROOT / "lagrange_cli"
FILES = sorted(set(PACKAGE.rglob("*.py")) - {PACKAGE / "alias.py"})

LAYERS = [
    *("__main__", "cli", "bench compare", "plot", "find fit", "sweep"),
    *("motion", "elliptic inputs output", "arithmetic", "errors"),
]
"""A subpackage imports only from the lines below its own."""

FACE = {"__version__", "draw", "draw_outcome", "view"}
"""Names that subpackages import from the package itself, late: methods such as `Motion.plot`."""


def imports(path: Path, text: str) -> Iterator[tuple[str, ...]]:
    """Yield each name that a module imports from the package, by its parts."""
    here = path.relative_to(PACKAGE).parts
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            module = tuple(filter(None, (node.module or "").split(".")))
            assert node.level or "lagrange_cli" not in module, f"{path}: use relative imports"
            if node.level:
                yield from ((*here[: -node.level], *module, alias.name) for alias in node.names)


def wrong_imports(texts: dict[Path, str]) -> list[str]:
    """Return the imports that do not point down.  Raise CycleError if imports form a circle."""
    level = {name: i for i, line in enumerate(LAYERS) for name in line.split()}
    graph: dict[tuple[str, ...], set[tuple[str, ...]]] = {
        path.relative_to(PACKAGE).with_suffix("").parts: set() for path in texts
    }
    wrong = []
    for path, text in texts.items():
        module = path.relative_to(PACKAGE).with_suffix("").parts
        for name in imports(path, text) if module != ("__init__",) else ():
            if name[0] != module[0] and name[0] not in FACE and level[name[0]] <= level[module[0]]:
                wrong.append(f"{path} imports {'.'.join(name)}")
            graph[module] |= {x for x in (name, name[:-1], (*name[:-1], "__init__")) if x in graph}
    TopologicalSorter({x: found - {x, ("__init__",)} for x, found in graph.items()}).prepare()
    return wrong


def test_imports_point_down_without_circles() -> None:
    assert wrong_imports({path: path.read_text() for path in FILES}) == []


@pytest.mark.parametrize(
    ("first", "second", "wrong"),
    [
        ("from ..cli.b import x", "", 1),
        ("from ..inputs import x", "", 1),
        ("from ..arithmetic import x", "", 0),
        ("from .. import view", "", 0),
        ("def f():\n    from .b import x", "from ..elliptic.a import x", -1),
    ],
)
def test_wrong_imports_are_found(first: str, second: str, wrong: int) -> None:
    folder = PACKAGE / "elliptic"
    texts = {folder / "a.py": first, folder / "b.py": second}
    if wrong >= 0:
        assert len(wrong_imports(texts)) == wrong
    else:
        with pytest.raises(CycleError):
            wrong_imports(texts)


def test_no_private_name_leaves_its_module() -> None:
    names = {name[-1] for path in FILES for name in imports(path, path.read_text())}
    assert {name for name in names if re.match("_[^_]", name)} == set()


def test_top_of_the_project_holds_only_what_must_be_there() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False, text=True
    )
    if listed.returncode:
        pytest.skip("not a clone of the repository")
    names = {path.partition("/")[0] for path in listed.stdout.split("\0") if path}
    visible = {name for name in names if not name.startswith(".")}
    assert visible == {"pyproject.toml", "README.md", "lagrange_cli", "tests", "sample_inputs"}
