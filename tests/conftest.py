"""Ways to call the program, shared by the tests."""

from __future__ import annotations

import compileall
import csv
import gc
import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from hypothesis import HealthCheck, settings
from markdown_it import MarkdownIt

from lagrange_cli.cli.app import main

ROOT = Path(__file__).parent.parent
LAGTOP = [sys.executable, "-m", "lagrange_cli"]

collect_ignore = [
    f"{name}.py"
    for name in "cli/test_processes output/test_output sweeps/test_parts "
    "sweeps/test_workers".split()
    if os.name != "posix"
]
"""Tests of shells, signals, devices and links, which Windows lacks."""

Lagtop = Callable[..., Result]
Solved = Callable[..., dict[str, Any]]


def pytest_configure(config: pytest.Config) -> None:
    """Write the bytecode of the package, as pip does: else each tested command makes it again.

    NumPy gets one thread, as in the commands: workers leave no core to a second one.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if not hasattr(config, "workerinput"):  # once, not in each worker of pytest-xdist
        compileall.compile_dir(ROOT / "lagrange_cli", quiet=1)


def pytest_collection_finish() -> None:
    """Leave all that was imported out of the search for garbage: a twelfth of a run."""
    gc.freeze()


# No test may fail because the machine is busy.
settings.register_profile("untimed", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("untimed")


if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A shell starts jobs with `&` so; commands under test would inherit it and outlive a Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def lagtop() -> Lagtop:
    """Run the command in this process: lagtop("solve", "--r0", 3, charset="ascii").

    A crash raises its exception.
    """

    def run(*args: Any, charset: str = "utf-8", **extra: Any) -> Result:
        runner = CliRunner(charset=charset, catch_exceptions=False)
        return runner.invoke(main, list(map(str, args)), **extra)

    return run


@pytest.fixture
def solved(lagtop: Lagtop) -> Solved:
    """Return the record of `lagtop solve` as a dictionary."""

    def run(*args: Any) -> dict[str, Any]:
        result = lagtop("solve", *args, "--format", "json")
        assert result.exit_code == 0, result.stderr
        record: dict[str, Any] = json.loads(result.stdout)
        return record

    return run


def assert_one_line(result: Result, code: int, message: str) -> None:
    """Check that a command failed with one line on standard error, and said nothing else."""
    assert (result.exit_code, result.stdout) == (code, "")
    assert result.stderr.startswith(f"Error: {message}")
    assert result.stderr.count("\n") == 1


def dicts(text: str) -> list[dict[str, str]]:
    """Return the rows of CSV by column."""
    return list(csv.DictReader(io.StringIO(text)))


def columns_of(text: str) -> dict[str, list[str]]:
    """Return the columns of a CSV by their headings."""
    rows = dicts(text)
    return {name: [row[name] for row in rows] for name in rows[0]}


def tables_of(text: str) -> list[list[list[str]]]:
    """Return the cells of all tables in Markdown as a reader sees them."""
    found: list[list[list[str]]] = []
    for token in MarkdownIt("commonmark").enable("table").parse(text):
        if token.type == "table_open":
            found.append([])
        elif token.type == "tr_open":
            found[-1].append([])
        elif token.type == "inline" and token.level >= 3 and found:
            shown = "".join(x.content for x in token.children or [])
            found[-1][-1].append(shown)
    return found


def process(*args: str, check: bool = True, **extra: Any) -> subprocess.CompletedProcess[bytes]:
    """Run the command as a process of its own."""
    return subprocess.run([*LAGTOP, *args], capture_output=True, check=check, **extra)


def shell(line: str, folder: Path = ROOT, **extra: str) -> subprocess.CompletedProcess[bytes]:
    """Run a line of bash in a folder; `lagtop` is the command under test."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)} | extra
    return subprocess.run(
        ["bash", "-c", line], capture_output=True, check=False, cwd=folder, env=environment
    )


def wait_until(is_so: Callable[[], object], running: subprocess.Popen[Any]) -> None:
    """Wait until a condition holds, while a process runs."""
    while not is_so():
        assert running.poll() is None
        time.sleep(0.01)


def assert_gone(group: int) -> None:
    """Check that a process group soon has no process left."""
    deadline = time.monotonic() + 30
    with suppress(ProcessLookupError):
        while True:
            os.killpg(group, 0)
            assert time.monotonic() < deadline
            time.sleep(0.02)


def joined(folder: Path) -> bytes:
    """Return the parts of a sweep in a folder, one after the other."""
    return b"".join(part.read_bytes() for part in sorted(folder.glob("part-*")))
