"""Ways to call the program, shared by the tests."""

from __future__ import annotations

import compileall
import json
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from hypothesis import HealthCheck, settings

from lagrange_cli.cli.group import main

ROOT = Path(__file__).parent.parent
LAGTOP = [sys.executable, "-m", "lagrange_cli"]

Lagtop = Callable[..., Result]


def pytest_configure(config: pytest.Config) -> None:
    """Write the bytecode of the package, as pip does: else each tested command makes it again."""
    if not hasattr(config, "workerinput"):  # once, not in each worker of pytest-xdist
        compileall.compile_dir(ROOT / "lagrange_cli", quiet=1)


# No test may fail because the machine is busy.
settings.register_profile("untimed", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("untimed")


if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A shell starts jobs with `&` so; commands under test would inherit it and outlive a Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def lagtop() -> Lagtop:
    """Run the command in this process: lagtop("solve", "--r0", 3, charset="ascii")."""

    def run(*args: Any, charset: str = "utf-8", **extra: Any) -> Result:
        return CliRunner(charset=charset).invoke(main, list(map(str, args)), **extra)

    return run


@pytest.fixture
def solved(lagtop: Lagtop) -> Callable[..., dict[str, Any]]:
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


def process(*args: str, check: bool = True, **extra: Any) -> subprocess.CompletedProcess[bytes]:
    """Run the command as a process of its own."""
    return subprocess.run([*LAGTOP, *args], capture_output=True, check=check, **extra)
