"""The examples of every `--help` run in an empty folder, one after the other."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import click
import pytest
from conftest import ROOT

from lagrange_cli.cli.app import NAMES, Command, main

SLOW = ("plot", "bench", "stability", "fit", "view")


def command_of(name: str) -> Command:
    """Return a command, or the group for no name."""
    found = main.get_command(click.Context(main), name) if name else main
    assert isinstance(found, Command)
    return found


@pytest.fixture
def lagtop_on_path(tmp_path: Path) -> dict[str, str]:
    """Return an environment with a `lagtop` on the PATH, outside the folder of the examples."""
    script = tmp_path / "bin" / "lagtop"
    script.parent.mkdir()
    started = "if __name__ == '__main__':  # as pip writes it: workers import this file\n    main()"
    script.write_text(f"#!{sys.executable}\nfrom lagrange_cli.__main__ import main\n{started}\n")
    script.chmod(0o755)
    path = f"{script.parent}{os.pathsep}{os.environ['PATH']}"
    return os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)}


@pytest.mark.parametrize(
    "name", [pytest.param(x, marks=[pytest.mark.slow] if x in SLOW else []) for x in ["", *NAMES]]
)
def test_examples_run_in_an_empty_folder(
    name: str, tmp_path: Path, lagtop_on_path: dict[str, str]
) -> None:
    folder = tmp_path / "empty"
    folder.mkdir()
    examples = command_of(name).examples
    assert len(examples) == 3
    for line in examples:
        before = [*folder.iterdir()]
        done = subprocess.run(
            ["bash", "-e", "-o", "pipefail", "-c", line],
            capture_output=True,
            check=False,
            cwd=folder,
            env=lagtop_on_path,
        )
        assert done.returncode == 0, (line, done.stderr.decode())
        assert b"Error" not in done.stderr
        assert done.stdout or [path for path in folder.iterdir() if path not in before], line
