"""Each README does what it shows.  `python tests/test_readme.py` rewrites outputs and tables."""

from __future__ import annotations

import doctest
import re
import shutil
import sys
from collections.abc import Callable, Iterator
from decimal import Decimal
from functools import partial
from pathlib import Path

import click
import pytest
from conftest import ROOT, shell
from errata import figures_table
from published import published_table

import lagrange_cli
from lagrange_cli.account.explanation import listed
from lagrange_cli.cli.app import NAMES, main
from lagrange_cli.comparison.compare import COMPARISON_KEYS, VERDICTS
from lagrange_cli.output.formats import FORMATS
from lagrange_cli.plot import KINDS, SHEET
from lagrange_cli.recordings.quantities import QUANTITIES
from lagrange_cli.solver.keys import FURTHER_KEYS, NUMBERS
from lagrange_cli.top.inputs import DECLARED, TILT

README = ROOT / "README.md"
READMES = sorted(
    path
    for path in ROOT.rglob("README.md")
    if not any(part.startswith(".") for part in path.relative_to(ROOT).parts)
)
"""Every README of the project, also of the subpackages."""
PAGES = [*READMES, *sorted((ROOT / "sample_inputs" / "tutorials").glob("*.md"))]


def text_of(path: Path) -> str:
    """Return the text of a page, also on a system with another encoding."""
    return path.read_text(encoding="utf-8")


NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def sessions(text: str) -> Iterator[tuple[str, str]]:
    """Yield each command of the console blocks with the output shown below it.

    A line of `#` above a command is a comment.
    """
    for block in re.findall(r"```console\n(.*?)```", text, re.DOTALL):
        for part in re.split(r"^(?:# .*\n)?\$ ", block, flags=re.MULTILINE)[1:]:
            command, _, output = part.partition("\n")
            yield command, output


def run(command: str, folder: Path = ROOT) -> str:
    """Return what a terminal would show for a command."""
    return shell(f"exec 2>&1\n{command}", folder, PYTHONIOENCODING="utf-8").stdout.decode()


def name(path: Path) -> str:
    """Return the path of a page inside the project."""
    return str(path.relative_to(ROOT))


SESSIONS = [
    pytest.param(command, shown, id=f"{name(path)}: {command}"[:120])
    for path in PAGES
    for command, shown in sessions(text_of(path))
]


@pytest.mark.slow
@pytest.mark.parametrize(("command", "shown"), SESSIONS)
def test_session(command: str, shown: str) -> None:
    """Text to the letter, numbers to 1e-13 (the last bit of sin and atan is the platform's).

    A fit ends where its steps get small: its rounded numbers may differ by one last digit.  Three
    dots at the end of the text shown stand for more lines.
    """
    check_session(command, shown, run(command))


def check_session(command: str, shown: str, real: str) -> None:
    """Compare the output of a command with what a page shows."""
    if shown.endswith("\n...\n"):
        shown = shown.removesuffix("...\n")
        real = "".join(real.splitlines(keepends=True)[: shown.count("\n")])
    assert NUMBER.sub("#", real) == NUMBER.sub("#", shown)
    for one, other in zip(NUMBER.findall(real), NUMBER.findall(shown), strict=True):
        last_digit = 10.0 ** int(Decimal(other).as_tuple().exponent)
        slack = 1.001 * last_digit if "lagtop fit" in command else 1e-13
        assert float(one) == pytest.approx(float(other), rel=1e-13, abs=slack)


LINES = [
    pytest.param(line, id=f"{name(path)}: {line}"[:120])
    for path in PAGES
    for block in re.findall(r"```sh\n(.*?)```", text_of(path), re.DOTALL)
    for line in block.splitlines()
    if line.startswith("lagtop ")
]


@pytest.mark.slow
@pytest.mark.parametrize("line", LINES)
def test_line_without_output(line: str, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "sample_inputs", tmp_path / "sample_inputs")
    assert "Error" not in run(line, tmp_path)
    assert all((tmp_path / file).is_file() for file in re.findall(r"(?:-o|--plot) (\S+)", line))


@pytest.mark.parametrize("path", PAGES, ids=name)
def test_python_session(path: Path) -> None:
    assert len(SESSIONS) >= 10
    result = doctest.testfile(str(path), module_relative=False, encoding="utf-8")
    assert result.attempted >= (5 if path == README else 0)
    assert result.failed == 0


def keys_table(kind: str, heading: str) -> list[str]:
    """Return the keys of a kind, or the columns, as a table in Markdown."""
    heads = [heading, "symbol", "meaning", "unit", "formula", "source"]
    heads += ["defined only"] if kind != "column" else []
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for row in listed():
        if row.kind == kind and row.name not in {*DECLARED, "theta0_deg"}:
            key = NUMBERS.get(row.name)
            cells = [f"`{row.name}`", row.symbol, row.meaning, row.unit, row.formula, row.equation]
            cells += [key.only if key else ""] if kind != "column" else []
            lines.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |")
    return lines


def further_keys_table() -> list[str]:
    """Return the further keys by group as a table in Markdown."""
    groups: dict[str, list[str]] = {}
    for name in FURTHER_KEYS:
        groups.setdefault(NUMBERS[name].group, []).append(f"`{name}`")
    lines = [f"| {group} | {', '.join(names)} |" for group, names in groups.items()]
    return ["| group | further keys |", "|---|---|", *lines]


def inputs_table() -> list[str]:
    """Return the inputs of a scene file as a table in Markdown."""
    lines = ["| key | option | meaning | default |", "|---|---|---|---|"]
    for name, x in DECLARED.items():
        key = "`theta0_deg` or `theta0_rad`" if name == TILT else f"`{name}`"
        meaning = ", ".join(filter(None, (x.meaning, x.bound)))
        default = "" if x.default is None else f"{x.default:g} "
        lines.append(f"| {key} | `--{name.replace('_', '-')}` | {meaning} | {default}|")
    return lines


def formats_table() -> list[str]:
    """Return the formats as a table in Markdown."""
    lines = [f"| `{name}` | {x.extension} | {x.holds} |" for name, x in FORMATS.items()]
    return ["| format | extension | holds |", "|---|---|---|", *lines]


def two_columns(first: str, second: str, rows: dict[str, str]) -> list[str]:
    """Return names and their meanings as a table in Markdown."""
    lines = [f"| `{x}` | {y} |" for x, y in rows.items()]
    return [f"| {first} | {second} |", "|---|---|", *lines]


_NAMES = {key: f"{x.meaning}: {x.shown}" for key, x in QUANTITIES.items()}
PICTURES = KINDS | dict.fromkeys(SHEET, "sphere, angles, cubic and phase on one sheet (default)")
TABLES: list[tuple[Callable[[], list[str]], str]] = [
    (inputs_table, "sample_inputs"),
    (formats_table, "lagrange_cli/cli"),
    (figures_table, "tests"),
    (published_table, "tests"),
    (partial(keys_table, "record", "key"), "lagrange_cli/solver"),
    (partial(keys_table, "column", "column"), "lagrange_cli/solver"),
    (further_keys_table, "lagrange_cli/solver"),
    (
        partial(two_columns, "column", "quantity, and known names", _NAMES),
        "lagrange_cli/comparison",
    ),
    (partial(two_columns, "key", "meaning", COMPARISON_KEYS), "lagrange_cli/comparison"),
    (partial(two_columns, "verdict", "if", VERDICTS), "lagrange_cli/comparison"),
]
"""Tables that are made, and the folders of the pages that show them."""


@pytest.mark.parametrize(("table", "folder"), TABLES)
def test_table_that_is_made(table: Callable[[], list[str]], folder: str) -> None:
    page = text_of(ROOT / folder / "README.md")
    assert len(table()) > 3
    assert "\n".join(["", *table(), ""]) in page
    assert with_table(page, table()) == page


def test_every_option_and_key_is_explained() -> None:
    text = "\n".join(text_of(path) for path in READMES)
    context = click.Context(main)
    commands = [main.get_command(context, name) for name in main.list_commands(context)]
    options = {name for command in commands if command for p in command.params for name in p.opts}
    assert "--theta0" in options
    assert {name for name in options if name.startswith("-")} - set(
        re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", text)
    ) == set()
    words = set(re.findall(r"\w+", text))
    assert {*NUMBERS, "regime", "path", "remark"} <= words


@pytest.mark.parametrize("command", NAMES)
def test_every_command_is_documented(command: str) -> None:
    (table,) = re.findall(r"\| command \| use it to \|\n((?:\|.*\n)*)", text_of(README))
    assert re.search(rf"(?<=`){command}`", table)


def test_the_help_lists_the_kinds_of_picture() -> None:
    command = main.get_command(click.Context(main), "plot")
    assert command
    assert command.help
    for kind, meaning in PICTURES.items():
        assert f" {kind:8}{meaning}\n" in command.help


def test_every_public_name_is_on_the_page_of_the_library() -> None:
    words = set(re.findall(r"\w+", text_of(ROOT / "lagrange_cli" / "README.md")))
    assert {*lagrange_cli.__all__} - words == set()


def test_ci_runs_the_test_command_of_the_readme() -> None:
    assert text_of(ROOT / ".ci" / "run").count("README.md") == 1
    assert len(re.findall(r"```sh\n(python3 -m venv .*pytest.*)\n```", text_of(README))) == 1


def rewrite(*, only_tables: bool) -> None:
    """Put the tables that are made, and outputs that no longer are as shown, into every page."""
    for path in PAGES:
        text = text_of(path)
        for command, shown in [] if only_tables else sessions(text):
            try:
                check_session(command, shown, real := run(command))
            except AssertionError:
                text = text.replace(f"$ {command}\n{shown}", f"$ {command}\n{real}", 1)
        for table, folder in TABLES:
            if path.parent == ROOT / folder:
                text = with_table(text, table())
        path.write_text(text, encoding="utf-8")


def with_table(text: str, lines: list[str]) -> str:
    """Return a page with the table that has this first line in place of the one it shows."""
    shown = re.compile(rf"^{re.escape(lines[0])}\n(\|.*\n)*", re.MULTILINE)
    return shown.sub(lambda _: "\n".join([*lines, ""]), text)


if __name__ == "__main__":
    rewrite(only_tables="--tables" in sys.argv)
