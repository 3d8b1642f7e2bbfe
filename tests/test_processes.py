"""What only a process of its own can show: modules loaded, streams, signals, files."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import LAGTOP, process

HEAVY = {"numpy", "scipy", "mpmath", "rich", "matplotlib", "orjson"}


def loaded(*args: str) -> set[str]:
    """Top-level modules that a command imports."""
    command = [sys.executable, "-X", "importtime", "-m", "lagrange_cli", *args]
    listing = subprocess.run(command, capture_output=True, check=True).stderr.decode()
    names = (line.rpartition("|")[2].strip() for line in listing.splitlines() if "|" in line)
    return {name.partition(".")[0] for name in names}


@pytest.mark.parametrize(
    ("line", "allowed"),
    [
        ("solve --format json", set()),
        ("solve --format csv --rad --theta0 1", set()),
        ("--help", set()),
        ("table --help", set()),
        ("plot --help", set()),
        ("solve", {"rich"}),
        ("table", {"numpy", "mpmath", "orjson"}),
        ("table --r0 0 --format json", {"numpy", "mpmath", "orjson"}),
    ],
)
def test_nothing_is_loaded_that_is_not_needed(line: str, allowed: set[str]) -> None:
    assert loaded(*line.split()) & HEAVY == allowed


def test_the_package_alone_loads_no_numpy() -> None:
    code = "import sys, lagrange_cli; print('numpy' in sys.modules)"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert shown.stdout == b"False\n"


def shell(line: str, **extra: str) -> subprocess.CompletedProcess[bytes]:
    """A bash line in which $LAGTOP is the command."""
    environment = os.environ | {"LAGTOP": " ".join(LAGTOP)} | extra
    return subprocess.run(["bash", "-c", line], capture_output=True, check=False, env=environment)


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "command", ["table --t-max 1", "table --n 200000", "table --n 5000 --format json"]
)
def test_head_is_silent(command: str, unbuffered: str) -> None:
    line = f"$LAGTOP {command} | head -3; echo ${{PIPESTATUS[0]}}"
    result = shell(line, PYTHONUNBUFFERED=unbuffered)
    assert result.stderr == b""
    assert result.stdout.count(b"\n") == 4
    assert result.stdout.split()[-1] in (b"0", b"141")


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("command", ["solve", "solve --format json", "table --n 100000"])
def test_full_disk(command: str, unbuffered: str) -> None:
    result = shell(f"$LAGTOP {command} > /dev/full", PYTHONUNBUFFERED=unbuffered)
    assert result.returncode == 74
    assert result.stderr == b"Error: cannot write standard output: No space left on device\n"


def test_closed_output() -> None:
    result = shell("$LAGTOP solve --format json >&-")
    assert result.returncode == 74
    assert result.stderr.startswith(b"Error: cannot write standard output")
    assert result.stderr.count(b"\n") == 1


def test_output_to_a_file(tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    target.write_text("old")
    target.chmod(0o640)
    link = tmp_path / "link.csv"
    link.symlink_to(target)
    assert process("table", "-o", str(link)).stdout == b""
    assert target.read_bytes() == process("table").stdout
    assert link.is_symlink()
    assert target.stat().st_mode & 0o777 == 0o640
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link.csv", "out.csv"]


@pytest.mark.parametrize(
    "bad", [["--theta0", "200"], ["--t-max", "1e30"], ["--times", "/nowhere"], ["nowhere.toml"]]
)
def test_a_failed_command_leaves_the_file_as_it_was(bad: list[str], tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    target.write_text("old")
    result = process("table", "-o", str(target), *bad, check=False)
    assert result.returncode in (2, 65)
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_output_that_cannot_be_written(tmp_path: Path) -> None:
    target = tmp_path / "none" / "out.csv"
    result = process("solve", "--format", "csv", "-o", str(target), check=False)
    assert result.returncode == 74
    assert result.stderr == f"Error: cannot write {target}: No such file or directory\n".encode()


def test_output_to_a_device() -> None:
    assert process("solve", "-o", "/dev/null").stdout == b""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_kill_and_clean_up(number: signal.Signals, tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    target.write_text("old")
    running = subprocess.Popen(
        [*LAGTOP, "table", "--n", "1e9", "-o", str(target)], stderr=subprocess.PIPE
    )
    deadline = time.monotonic() + 30
    while len(list(tmp_path.iterdir())) < 2 and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(0.2)
    running.send_signal(number)
    _, stderr = running.communicate(timeout=30)
    assert running.returncode == -number
    assert b"Traceback" not in stderr
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_narrow_terminal_without_colour_cuts_nothing() -> None:
    plain = process("solve").stdout
    environment = os.environ | {"COLUMNS": "40", "NO_COLOR": "1", "TERM": "dumb"}
    assert process("solve", env=environment).stdout == plain


def test_completion() -> None:
    environment = os.environ | {
        "_LAGTOP_COMPLETE": "bash_complete",
        "COMP_WORDS": "lagtop so",
        "COMP_CWORD": "1",
    }
    assert b"solve" in process(env=environment).stdout


@pytest.mark.parametrize(("rows", "shown"), [("3e6", True), ("1e5", False)])
def test_long_work_shows_progress_on_a_terminal(rows: str, shown: bool) -> None:
    terminal, child = os.openpty()
    with open(terminal, "rb", buffering=0) as screen:
        command = [*LAGTOP, "table", "--n", rows, "-o", "/dev/null"]
        environment = os.environ | {"TERM": "xterm"}
        subprocess.run(command, stderr=child, stdout=child, check=True, env=environment)
        os.close(child)
        try:
            text = screen.read(4096)
        except OSError:  # nothing was written, and nobody can any more
            text = b""
    assert (b"rows" in text) == shown
