"""The house: imports point down one list, rooms are small, docstrings can be read alone."""

from __future__ import annotations

import ast
import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from conftest import ROOT
from prose import faults

PACKAGE = ROOT / "lagrange_cli"
FLOORS = [
    {"__main__"},
    {"cli"},
    {"bench"},
    {"judge"},
    {"plot"},
    {"fits"},
    {"sweeps"},
    {"motion"},
    {"elliptic", "inputs", "output"},
    {"arithmetic"},
    {"errors"},
]
"""From the top to the ground."""
FLOOR = {room: floor for floor, rooms in enumerate(FLOORS) for room in rooms}
NEVER = {("motion", "output")}
THROUGH_THE_FACE = {("motion", "view")}
"""Names that a room asks the face of the package for: a method whose work is done further up."""
FILES = sorted(PACKAGE.rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))

NOQA = 4
"""Lint warnings switched off in the package.  The number only falls."""


@cache
def parsed(path: Path) -> ast.Module:
    """Return the syntax tree of a module."""
    return ast.parse(path.read_text())


def imported_modules(path: Path) -> Iterator[list[str]]:
    """Yield the modules of the package that a file imports, each as its parts."""
    here = list(path.relative_to(PACKAGE).with_suffix("").parts)
    for node in ast.walk(parsed(path)):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = here[: len(here) - node.level]
            module = base + (node.module.split(".") if node.module else [])
            yield from ([*module, alias.name] for alias in node.names)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            names = [x.name for x in node.names] if isinstance(node, ast.Import) else [node.module]
            assert not any(name and name.startswith("lagrange_cli") for name in names), path


def test_the_package_has_these_rooms_and_no_others() -> None:
    assert {path.name for path in PACKAGE.iterdir() if path.name != "__pycache__"} == {
        *("cli", "bench", "judge", "plot", "fits", "sweeps", "motion"),
        *("elliptic", "inputs", "output", "arithmetic"),
        *("errors.py", "__init__.py", "__main__.py", "py.typed"),
        *("LICENSE", "CHANGES.md"),
    }


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_point_down(path: Path) -> None:
    room = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
    for module in imported_modules(path):
        other = module[0]
        if other == "__version__":
            assert room in {"cli", "bench", "sweeps"}, module
        elif room not in (other, "__init__") and (room, other) not in THROUGH_THE_FACE:
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


def room_of(path: Path) -> str:
    """Return the room of a file: `tests`, a room of the package, or `top` above them all."""
    if path.is_relative_to(ROOT / "tests"):
        return "tests"
    parts = path.relative_to(PACKAGE).parts
    return parts[0] if len(parts) > 1 else "top"


@pytest.mark.parametrize("room", sorted({room_of(path) for path in [*FILES, *TESTS]}))
def test_docstrings_can_be_read_alone(room: str) -> None:
    files = [path for path in [*FILES, *TESTS] if room_of(path) == room]
    bad = [fault for path in files for fault in faults(path, str(path.relative_to(ROOT)))]
    shown = "\n".join(f"{x.place}: {x.beginning!r}: {x.reason}" for x in bad)
    assert not bad, shown


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ('def f():\n    """Of the top."""', "begins with 'Of'"),
        ('def f():\n    """The same in degrees."""', "begins with 'The same'"),
        ('class A:\n    """It holds a top."""', "begins with 'It'"),
        ('def f():\n    """Return the top"""', "its first sentence has no full stop"),
        ('def f():\n    """The top."""', "begins with 'The', which is no verb of the list"),
        ('x = 1\n"""And one."""', "begins with 'And'"),
        ('class A:\n    x: int\n    """As given."""', "begins with 'As'"),
        ('def f():\n    """Return the top."""', None),
        ('@property\ndef f():\n    """Tilt of the axis."""', None),
        ('class A:\n    """A top."""\n    x: int\n    """Period of the nutation."""', None),
    ],
)
def test_the_rule_of_docstrings_sees_faults(text: str, reason: str | None, tmp_path: Path) -> None:
    path = tmp_path / "module.py"
    path.write_text(text + "\n")
    assert [fault.reason for fault in faults(path, "module")] == ([reason] if reason else [])


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_modules_are_small(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= 300


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_no_private_name_leaves_its_module(path: Path) -> None:
    private = [
        name
        for module in imported_modules(path)
        for name in module
        if name.startswith("_") and not name.startswith("__")
    ]
    assert private == []


def test_lint_is_rarely_switched_off() -> None:
    lines = [line for path in FILES for line in path.read_text().splitlines()]
    assert sum("noqa" in line for line in lines) <= NOQA


def test_top_of_the_project_holds_only_what_must_be_there() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False, text=True
    )
    if listed.returncode:
        pytest.skip("not a clone of the repository")
    names = {path.partition("/")[0] for path in listed.stdout.split("\0") if path}
    visible = {name for name in names if not name.startswith(".")}
    assert visible == {"pyproject.toml", "README.md", "lagrange_cli", "tests", "sample_inputs"}
