"""Standard streams that the caller has closed: every command works without standard error."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import pytest
from conftest import LAGTOP, ROOT, Lagtop

from lagrange_cli.cli.app import NAMES as COMMANDS

LINES = {
    "solve": "solve",
    "table": "table --n 5",
    "sweep": "sweep --r0 1:9:5",
    "find": "find --r0 10:200 T_precession=2",
    "fit": f"fit {ROOT}/sample_inputs/recording.csv --format csv",
    "compare": "compare trajectory.csv",
    "plot": "plot -o -",
    "view": "view -o -",
    "jacobi": "jacobi --k 0.8 --u 1",
    "eta": "eta --delta 0.6 --delta-star -0.5 --p 0.1 --q 1.4",
    "bench": "bench --n 3 --t-max 1 --methods lagtop --format csv",
    "explain": "explain",
    "scenes": "scenes",
    "stability": "stability --samples 1 --strata slow --format csv",
}
"""A line of each command that writes more than one block, or from more than one place."""


def test_each_command_has_a_line() -> None:
    assert sorted(LINES) == sorted(COMMANDS)


def run(line: str, redirection: str, folder: Path) -> subprocess.CompletedProcess[bytes]:
    """Run a command line in a folder, with a redirection of bash at its end."""
    code = f"{' '.join(LAGTOP)} {line} {redirection}"
    return subprocess.run(
        ["bash", "-c", code], stdout=subprocess.PIPE, check=False, cwd=folder, timeout=120
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", LINES)
def test_closed_standard_error(name: str, tmp_path: Path, lagtop: Lagtop) -> None:
    (tmp_path / "trajectory.csv").write_text(lagtop("table", "--t-max", 2, "--n", 9).stdout)
    usual, closed = (run(LINES[name], end, tmp_path) for end in ("2>/dev/null", "2>&-"))
    assert (usual.returncode, closed.returncode) == (0, 0)
    if name in {"bench", "stability"}:  # which print run times
        assert closed.stdout.count(b"\n") == usual.stdout.count(b"\n") > 1
    else:
        assert closed.stdout == usual.stdout
        assert len(closed.stdout) > 100


@pytest.mark.parametrize("line", ["table -", "sweep -", "compare -", "table --times -"])
def test_closed_standard_input(line: str, tmp_path: Path) -> None:
    result = run(line, "2>said <&-", tmp_path)
    assert (result.returncode, result.stdout) == (65, b"")
    wrong = "Error: standard input: it is closed: give a file in place of -\n"
    assert (tmp_path / "said").read_text() == wrong


HELP = ["--help", "--version", "", "solve --help"]


@pytest.mark.parametrize("line", HELP)
def test_help_that_cannot_be_written(line: str, tmp_path: Path) -> None:
    for where, why in ((">&-", "it is closed"), ("> /dev/full", "No space left on device")):
        done = run(line, f"{where} 2>said", tmp_path)
        said = (tmp_path / "said").read_text()
        assert (done.returncode, said) == (74, f"Error: cannot write standard output: {why}\n")


@pytest.mark.parametrize("line", HELP)
def test_help_that_nobody_reads(line: str) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [*LAGTOP, *line.split()], stdout=writing, stderr=subprocess.PIPE, check=False
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (-signal.SIGPIPE, b"")


def test_closed_standard_error_and_a_file(tmp_path: Path) -> None:
    """No file that is opened later becomes standard error: messages are lost."""
    line = "sweep --r0 40,x -o out.csv"
    assert run(line, "2>&-", tmp_path).returncode == 2
    assert os.listdir(tmp_path) == []
    assert run("table --n 5 -o out.csv", "2>&-", tmp_path).returncode == 0
    assert (tmp_path / "out.csv").read_bytes() == run("table --n 5", "", tmp_path).stdout


@pytest.mark.slow
@pytest.mark.parametrize("name", ["find", "plot", "view", "jacobi", "compare"])
def test_closed_standard_output(name: str, tmp_path: Path, lagtop: Lagtop) -> None:
    """The commands that test_processes.py does not run so."""
    (tmp_path / "trajectory.csv").write_text(lagtop("table", "--t-max", 2, "--n", 9).stdout)
    result = run(LINES[name], ">&- 2>said", tmp_path)
    assert result.returncode == 74
    said = (tmp_path / "said").read_text().splitlines()
    assert said[-1] == "Error: cannot write standard output: it is closed"
