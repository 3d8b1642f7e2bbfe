"""House rules: imports point down one list, without circles."""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter

import pytest
from conftest import ROOT

from lagrange_cli.output.formats import FORMATS
from lagrange_cli.solver.keys import NUMBERS
from lagrange_cli.top.inputs import declared

PACKAGE = ROOT / "lagrange_cli"
MODULES = {
    path.relative_to(PACKAGE).with_suffix("").parts: ast.parse(path.read_text(encoding="utf-8"))
    for path in sorted(set(PACKAGE.rglob("*.py")) - {PACKAGE / "alias.py"})
}
"""The modules by the parts of their names."""

LAYERS = [
    *("__main__", "cli", "bench comparison", "plot", "inverse"),
    *("account sweeps recordings", "solver"),
    *("elliptic files output", "top", "names file_bytes", "arithmetic", "errors"),
]
"""A subpackage imports only from the lines below its own."""
LEVEL = {name: i for i, line in enumerate(LAYERS) for name in line.split()}
FACE = {"__version__", "draw", "draw_outcome", "view"}
"""Names that subpackages import from the package itself, late: methods such as `Motion.plot`."""
HOMES = """
click | cli.app cli.shared
rich | output.formats.table
orjson | output.text output.formats.csv output.formats.ndjson files.json_rows
pyarrow | output.formats.parquet files.binary_tables
csv | files.text_tables
tomllib | top.scenes
mpmath | bench.reference
distributed | sweeps.workers
arithmetic.formulas.evaluated
    | solver.numbers solver.columns sweeps.numbers top.forms account.worked
solver.columns.Columns | solver.sampling solver.tables
top.units.conversion | top.given top.values files.tops recordings.quantities
top.units.UNITS | recordings.clocks recordings.reading
account.spread.Spread | account.uncertain
files.tables.table_in | files.tops recordings.reading recordings.times bench.points
recordings.reading.read_recording | cli.compare cli.fit
recordings.recording.recording_of | comparison.compare inverse.fit
recordings.observed.framed | recordings.recording
recordings.misreadings.misreadings | comparison.causes inverse.advice
recordings.axis_equation.from_spline | comparison.numbers
output.destination.opened | cli.fit cli.plot cli.shared sweeps.parts
sweeps.records.records | sweeps.plan
bench.hard_scenes.nutating | bench.stability
"""
"""An idea has one home: the only modules that import a package, or a name of the package."""


def imports(module: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield each name that a module imports from the package, by its parts."""
    for node in ast.walk(MODULES[module]):
        if isinstance(node, ast.ImportFrom):
            of = tuple(filter(None, (node.module or "").split(".")))
            assert node.level or "lagrange_cli" not in of, f"{module}: use relative imports"
            if node.level:
                yield from ((*module[: -node.level], *of, alias.name) for alias in node.names)


@cache
def names_from(module: tuple[str, ...]) -> set[str]:
    """Return the names that a module imports from the package, and the other packages."""
    nodes = [x for x in ast.walk(MODULES[module]) if isinstance(x, ast.Import | ast.ImportFrom)]
    others = [y.name for x in nodes if isinstance(x, ast.Import) for y in x.names]
    others += [str(x.module) for x in nodes if isinstance(x, ast.ImportFrom) and not x.level]
    return {*map(".".join, imports(module)), *(x.partition(".")[0] for x in others)}


def test_imports_point_down() -> None:
    for module in MODULES.keys() - {("__init__",)}:
        for name in imports(module):
            below = name[0] in {module[0], *FACE} or LEVEL[name[0]] > LEVEL[module[0]]
            assert below, f"{'.'.join(module)} imports {'.'.join(name)}"
            assert not re.match("_[^_]", name[-1]), f"{name[-1]} is private"


@pytest.mark.parametrize("row", [*declared(HOMES)], ids=lambda row: row[0])
def test_an_idea_has_one_home(row: list[str]) -> None:
    name, modules = row
    assert {".".join(x) for x in MODULES if name in names_from(x)} == {*modules.split()}


def test_only_the_table_of_keys_lists_them() -> None:
    """More than four keys in a list, or in a text of one line, are a second list of keys."""
    for module, tree in MODULES.items():
        for node in ast.walk(tree) if module != ("solver", "keys") else ():
            parts = getattr(node, "elts", getattr(node, "keys", [node]))
            texts = [x.value for x in parts if isinstance(x, ast.Constant)]
            words = " ".join(x for x in texts if isinstance(x, str) and "\n" not in x).split()
            assert len({*words} & {*NUMBERS}) <= 4, f"{'.'.join(module)}: {words}"


def test_only_the_registry_compares_names_of_formats() -> None:
    for module, tree in MODULES.items():
        for node in ast.walk(tree) if module[:2] != ("output", "formats") else ():
            if isinstance(node, ast.Compare):
                sides = {getattr(x, "value", None) for x in ast.walk(node)}
                assert not {*FORMATS} & {x for x in sides if isinstance(x, str)}, module


def test_imports_form_no_circles() -> None:
    graph: dict[tuple[str, ...], set[tuple[str, ...]]] = {}
    for module in MODULES.keys() - {("__init__",)}:
        names = [x for y in imports(module) for x in (y, y[:-1], (*y[:-1], "__init__"))]
        graph[module] = {x for x in names if x in MODULES} - {module, ("__init__",)}
    TopologicalSorter(graph).prepare()


def test_only_the_command_line_names_options() -> None:
    """A message of the library names arguments: `columns=t`; the command line makes options."""
    for module, tree in MODULES.items():
        docs = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
        for node in ast.walk(tree) if module[0] != "cli" else ():
            if isinstance(node, ast.Constant) and id(node) not in docs:
                named = isinstance(node.value, str) and re.search(r"(?<!-)--[a-z]", node.value)
                assert not named, f"{'.'.join(module)}, line {node.lineno}"


def test_top_of_the_project_holds_only_what_must_be_there() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False, text=True
    )
    if listed.returncode:
        pytest.skip("not a clone of the repository")
    names = {path.partition("/")[0] for path in listed.stdout.split("\0") if path}
    visible = {name for name in names if not name.startswith(".")}
    assert visible == {"pyproject.toml", "README.md", "lagrange_cli", "tests", "sample_inputs"}
