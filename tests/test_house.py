"""House rules: imports point down one list, modules are small, docstrings can be read alone."""

from __future__ import annotations

import ast
import subprocess
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from conftest import ROOT
from prose import bad_sentences, faults

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
THROUGH_THE_FACE = {("fits", "draw_outcome"), ("motion", "draw"), ("motion", "view")}
"""Names that a room asks the face of the package for: a method whose work is done further up."""
PAGES = sorted(
    path
    for path in ROOT.rglob("*.md")
    if not any(part.startswith(".") for part in path.relative_to(ROOT).parts)
)
ALIAS = PACKAGE / "alias.py"
"""Installed as `lagtop.py` beside the package, so it imports as a user does."""
FILES = sorted(set(PACKAGE.rglob("*.py")) - {ALIAS})
TESTS = sorted((ROOT / "tests").rglob("*.py"))

MOST_LINES = 300
"""Lines of a module."""
NOQA = 4
"""Lint warnings switched off in the package.  The number only falls."""


@cache
def parsed(path: Path) -> ast.Module:
    """Return the syntax tree of a module."""
    return ast.parse(path.read_text())


@cache
def lines_of(path: Path) -> list[str]:
    """Return the lines of a module."""
    return path.read_text().splitlines()


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
        *("errors.py", "__init__.py", "__main__.py", "alias.py", "alias.pyi", "py.typed"),
        *("LICENSE", "CHANGES.md", "CITATION.cff"),
    }


def points_down(room: str, other: str) -> bool:
    """Return whether a module of a room may import from another place."""
    if other == "__version__":
        return room in {"cli", "bench", "sweeps"}
    if room in (other, "__init__") or (room, other) in THROUGH_THE_FACE:
        return True
    return FLOOR[other] > FLOOR[room] and (room, other) not in NEVER


def test_imports_point_down() -> None:
    offenders = [
        f"{path.relative_to(PACKAGE)} imports {'.'.join(module)}"
        for path in FILES
        for module in imported_modules(path)
        if not points_down(path.relative_to(PACKAGE).parts[0].removesuffix(".py"), module[0])
    ]
    assert offenders == []


@pytest.mark.parametrize(
    ("room", "other"),
    [("motion", "output"), ("inputs", "output"), ("elliptic", "motion"), ("judge", "__version__")],
)
def test_the_rule_of_imports_sees_offenders(room: str, other: str) -> None:
    assert not points_down(room, other)


def module_of(path: Path) -> tuple[str, ...]:
    """Return the name of a module below the package, by parts."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return parts[:-1] if parts[-1] == "__init__" else parts


def test_imports_form_no_cycle() -> None:
    """Types and late imports count; the package itself, which names every part, does not."""
    modules = {module_of(path) for path in FILES} - {()}
    graph: dict[tuple[str, ...], set[tuple[str, ...]]] = {}
    for path in FILES:
        found = {(tuple(module), tuple(module[:-1])) for module in imported_modules(path)}
        targets = {whole if whole in modules else base for whole, base in found}
        graph[module_of(path)] = (targets & modules) - {module_of(path)}
    graph.pop(())
    assert sum(map(len, graph.values())) > 1000
    TopologicalSorter(graph).prepare()  # raises CycleError, which names the cycle


def test_late_imports_give_a_reason() -> None:
    """Nearly always the reason is the start-up.  The commands share one, in `cli/__init__.py`."""
    offenders = [
        f"{path.relative_to(PACKAGE)}:{node.lineno}"
        for path in FILES
        if module_of(path)[:1] not in {("cli",), ("__main__",)}
        for function in ast.walk(parsed(path))
        if isinstance(function, ast.FunctionDef)
        for node in ast.walk(function)
        if isinstance(node, ast.ImportFrom) and node.level
        if not any("  # " in line for line in lines_of(path)[node.lineno - 1 : node.end_lineno])
    ]
    assert offenders == []


def test_the_rule_was_tested_on_real_arrows() -> None:
    arrows = {
        (path.relative_to(PACKAGE).parts[0], module[0])
        for path in FILES
        for module in imported_modules(path)
    }
    assert len({(room, other) for room, other in arrows if room != other}) > 20
    assert ("motion", "elliptic") in arrows


def test_texts_are_plain_english() -> None:
    bad = [fault for path in FILES for fault in faults(path, str(path.relative_to(ROOT)))]
    for path in TESTS:
        bad += faults(path, str(path.relative_to(ROOT)), sentences_too=False)
    shown = "\n".join(f"{x.place}: {x.beginning!r}: {x.reason}" for x in bad)
    assert not bad, shown


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_pages_are_plain_english(path: Path) -> None:
    assert list(bad_sentences(path.read_text())) == []


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ('def f():\n    """Of the top."""', "begins with 'Of'"),
        ('def f():\n    """The same in degrees."""', "begins with 'The same'"),
        ('class A:\n    """It holds a top."""', "begins with 'It'"),
        ('def f():\n    """Return the top"""', "its first sentence has no full stop"),
        ('x = 1\n"""And one."""', "begins with 'And'"),
        ('def f():\n    """What a top does."""', "begins with 'What'"),
        ('def f():\n    """Return so many tops."""', "says 'so many'"),
        (f'def f():\n    """Return {"a " * 25}top."""', "has 27 words"),
        ('x = option(int, "Print so many tops.")', "says 'so many'"),
        ('raise LagtopError("the rest hangs on it")', "says 'hangs on'"),
        ('raise LagtopError(f"What {x} is not given " + "is left")', "begins with 'What'"),
        ('def f():\n    """Return the top."""', None),
        ('class A:\n    """A top."""\n    x: int\n    """Period of the nutation."""', None),
        ('def f():\n    """Return the sum; with `what is left` it is exact."""', None),
    ],
)
def test_the_rule_of_english_sees_faults(text: str, reason: str | None, tmp_path: Path) -> None:
    path = tmp_path / "module.py"
    path.write_text(text + "\n")
    assert [fault.reason for fault in faults(path, "module")] == ([reason] if reason else [])


def test_modules_are_small() -> None:
    sizes = {path: len(path.read_text().splitlines()) for path in FILES}
    assert {str(path): size for path, size in sizes.items() if size > MOST_LINES} == {}


def test_no_private_name_leaves_its_module() -> None:
    offenders = [
        f"{path.relative_to(PACKAGE)} imports {name}"
        for path in FILES
        for module in imported_modules(path)
        for name in module
        if name.startswith("_") and not name.startswith("__")
    ]
    assert offenders == []


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


def public_names(path: Path) -> Iterator[str]:
    """Yield the public names that a module defines."""
    for node in parsed(path).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign):
            yield from (x.id for x in node.targets if isinstance(x, ast.Name))
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield node.target.id


def test_a_public_name_has_one_meaning() -> None:
    rooms: dict[str, set[str]] = {}
    for path in FILES:
        for name in public_names(path):
            rooms.setdefault(name, set()).add(path.relative_to(PACKAGE).parts[0])
    shared = {name for name, found in rooms.items() if len(found) > 1 and name[0] != "_"}
    assert shared <= {"command", "main", "report"}
