"""The rooms of the package: imports point down one list, and rooms of one line never meet."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ROOT

PACKAGE = ROOT / "lagrange_cli"
FLOORS = [
    {"__main__"},
    {"cli"},
    {"bench"},
    {"plot"},
    {"sweeps"},
    {"motion"},
    {"elliptic", "inputs", "output"},
    {"arithmetic"},
    {"errors"},
]
"""From the top to the ground."""
FLOOR = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
NEVER = {("motion", "output")}
FILES = sorted(PACKAGE.rglob("*.py"))


def imported_modules(path: Path) -> Iterator[list[str]]:
    """Yield the modules of the package that a file imports, each as its parts."""
    here = list(path.relative_to(PACKAGE).with_suffix("").parts)
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = here[: len(here) - node.level]
            module = base + (node.module.split(".") if node.module else [])
            yield from ([*module, alias.name] for alias in node.names)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            names = [x.name for x in node.names] if isinstance(node, ast.Import) else [node.module]
            assert not any(name and name.startswith("lagrange_cli") for name in names), path


def test_the_package_has_these_rooms_and_no_others() -> None:
    assert {path.name for path in PACKAGE.iterdir() if path.name != "__pycache__"} == {
        *("cli", "bench", "plot", "sweeps", "motion"),
        *("elliptic", "inputs", "output", "arithmetic"),
        *("errors.py", "__init__.py", "__main__.py", "py.typed"),
    }


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_point_down(path: Path) -> None:
    room = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
    for module in imported_modules(path):
        other = module[0]
        if other == "__version__":
            assert room in {"cli", "bench", "sweeps"}, module
        elif room not in (other, "__init__"):
            assert FLOOR[other] > FLOOR[room], (path, module)
            assert (room, other) not in NEVER, (path, module)


def test_the_rule_was_tested_on_real_arrows() -> None:
    arrows = {
        (path.relative_to(PACKAGE).parts[0], module[0])
        for path in FILES
        for module in imported_modules(path)
    }
    assert len({(room, other) for room, other in arrows if room != other}) > 20
    assert ("motion", "elliptic") in arrows
