"""The README does what it shows.  `python tests/test_readme.py` writes its outputs anew."""

from __future__ import annotations

import doctest
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from errata import errata_table

from lagrange_cli.cli.group import main

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
NUMBER = re.compile(r"-?\d+\.\d+(?:e[+-]?\d+)?")


def sessions(text: str) -> Iterator[tuple[str, str]]:
    """Each command of the console blocks with the output shown below it."""
    for block in re.findall(r"```console\n(.*?)```", text, re.DOTALL):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, _, output = part.partition("\n")
            yield command, output


def run(command: str) -> str:
    """What a terminal would show."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=ROOT,
        env=os.environ | {"PATH": path, "PYTHONIOENCODING": "utf-8"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
    )
    return done.stdout.decode()


@pytest.mark.parametrize(("command", "shown"), list(sessions(README.read_text())))
def test_session(command: str, shown: str) -> None:
    """Text to the letter, numbers to 1e-13 (the last bit of sin and atan is the platform's)."""
    real = run(command)
    assert NUMBER.sub("#", real) == NUMBER.sub("#", shown)
    pairs = zip(NUMBER.findall(real), NUMBER.findall(shown), strict=True)
    assert all(float(a) == pytest.approx(float(b), rel=1e-13, abs=1e-13) for a, b in pairs)


def test_python_session() -> None:
    result = doctest.testfile(str(README), module_relative=False)
    assert result.attempted >= 5
    assert result.failed == 0


def test_errata_table() -> None:
    assert "\n".join(errata_table()) in README.read_text()


def test_every_option_and_key_is_explained() -> None:
    text = README.read_text()
    context = click.Context(main)
    commands = [main.get_command(context, name) for name in main.list_commands(context)]
    options = {name for command in commands if command for p in command.params for name in p.opts}
    assert "--theta0" in options
    assert {name for name in options if name.startswith("-")} - set(
        re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", text)
    ) == set()
    from lagrange_cli import Motion

    words = set(re.findall(r"\w+", text))
    assert set(Motion._fields[1:]) <= words


def test_ci_runs_the_test_command_of_the_readme() -> None:
    assert (ROOT / ".ci" / "run").read_text().count("README.md") == 1
    assert len(re.findall(r"```sh\n(python3 -m venv .*pytest.*)\n```", README.read_text())) == 1


def rewrite() -> None:
    """Put the real outputs, and the table of errata, into the README."""
    text = README.read_text()
    for command, shown in sessions(text):
        text = text.replace(f"$ {command}\n{shown}", f"$ {command}\n{run(command)}", 1)
    table = "\n".join(errata_table())
    text = re.sub(r"\| quantity \| printed.*(\n\|.*)*", lambda _: table, text)
    README.write_text(text)


if __name__ == "__main__":
    rewrite()
