"""The script `.ci/run`: it leaves the folder alone, and says what it could not test."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT

TOOLS = "bash sed tar mktemp rm id dirname ln mkdir".split()
NOTHING = ["python3", "true"]
"""Programs that do nothing."""
COMMAND = """\
python3 -m venv .venv && mkdir -p .venv/bin && for x in python ruff mypy; do \
ln -s "$(type -P true)" .venv/bin/$x; done; echo pytest
"""
"""A command as that of the README, whose tests, lint and types do nothing."""


@pytest.mark.parametrize("browser", [True, False])
def test_run(browser: bool, tmp_path: Path) -> None:
    programs, folder = tmp_path / "bin", tmp_path / "checkout"
    for made in (programs, folder / ".ci", folder / ".venv"):
        made.mkdir(parents=True)
    for name in TOOLS:
        (programs / name).symlink_to(str(shutil.which(name)))
    for name in [*NOTHING, *(["chromium", "chromedriver"] if browser else [])]:
        (programs / name).symlink_to(str(shutil.which("true")))
    shutil.copy(ROOT / ".ci" / "run", folder / ".ci")
    (folder / "README.md").write_text(f"# Title\n\n{COMMAND}")
    (folder / ".venv" / "mine").touch()
    before = sorted(folder.rglob("*"))
    environment = os.environ | {"PATH": str(programs), "TMPDIR": str(tmp_path)}
    done = subprocess.run(
        [folder / ".ci" / "run"], capture_output=True, check=False, env=environment, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("python3 -m venv")
    assert sorted(folder.rglob("*")) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bin", "checkout"]
    assert ("tests of the page were SKIPPED" in done.stderr) is not browser
