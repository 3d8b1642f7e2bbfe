"""The examples of every `--help` run in an empty folder, one after the other."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT, Lagtop

from lagrange_cli.cli.app import NAMES

QUICK = ("solve", "scenes")


@pytest.mark.parametrize(
    "name",
    [pytest.param(x, marks=[] if x in QUICK else [pytest.mark.slow]) for x in ["", *NAMES]],
)
def test_examples_run_in_an_empty_folder(name: str, lagtop: Lagtop, tmp_path: Path) -> None:
    bin_folder, folder = tmp_path / "bin", tmp_path / "empty"
    bin_folder.mkdir()
    folder.mkdir()
    script = bin_folder / "lagtop"
    started = "if __name__ == '__main__':  # as pip writes it: workers import this file\n    main()"
    script.write_text(f"#!{sys.executable}\nfrom lagrange_cli.__main__ import main\n{started}\n")
    script.chmod(0o755)
    path = f"{bin_folder}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)}
    shown = lagtop(*name.split(), "--help").stdout
    examples = shown.partition("Examples:\n")[2].partition("\n\n")[0].splitlines()
    assert len(examples) >= 3
    for line in examples:
        before = [*folder.iterdir()]
        command = ["bash", "-e", "-o", "pipefail", "-c", line]
        done = subprocess.run(
            command, capture_output=True, check=False, cwd=folder, env=environment
        )
        assert done.returncode == 0, (line, done.stderr.decode())
        assert b"Error" not in done.stderr or line.endswith("|| true")
        assert done.stdout or [path for path in folder.iterdir() if path not in before], line
