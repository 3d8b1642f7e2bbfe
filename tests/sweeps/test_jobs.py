"""Work shared by several processes: bytes and order as in one, ends that leave nothing behind."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import time
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

import pytest
from conftest import LAGTOP, Lagtop, assert_one_line, process

from lagrange_cli.errors import CannotWriteError, LagtopError, UnavailableError
from lagrange_cli.sweeps.jobs import in_order, parse_jobs


def double(x: int) -> int:
    """Return twice a number; small ones take longer, so that the order has to be restored."""
    time.sleep(0.05 if x < 2 else 0)
    if x == 1000:
        raise LagtopError("too large")
    return 2 * x


def lose(x: int) -> None:
    """Take a while, and kill the process unless it is the one that shares the work out."""
    time.sleep(0.01)
    if multiprocessing.parent_process() is not None:
        os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.slow
def test_results_come_in_the_order_of_the_work() -> None:
    assert list(in_order(double, range(40), 2)) == list(range(0, 80, 2))
    assert list(in_order(double, [], 2)) == []


@pytest.mark.slow
def test_results_find_no_room(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for number in range(100):  # where the files were to be
        (tmp_path / str(number)).mkdir()
    folder = nullcontext(str(tmp_path))
    monkeypatch.setattr("lagrange_cli.sweeps.jobs.TemporaryDirectory", lambda **_: folder)
    with pytest.raises(CannotWriteError, match="Is a directory"):
        list(in_order(double, range(1000), 2))


@pytest.mark.slow
def test_an_error_of_the_work_is_raised() -> None:
    with pytest.raises(LagtopError, match="too large"):
        list(in_order(double, [3, 1000, 4], 2))


@pytest.mark.slow
def test_a_lost_process_is_told() -> None:
    with pytest.raises(UnavailableError, match="was lost"):
        list(in_order(lose, range(1000), 2))


def test_jobs() -> None:
    assert parse_jobs("3") == 3
    assert parse_jobs("auto") >= 1


@pytest.mark.parametrize("text", ["0", "-1", "1.5", "many", "1025", "²", "9" * 5000])
def test_what_is_no_number_of_jobs(text: str, lagtop: Lagtop) -> None:
    result = lagtop("sweep", f"--jobs={text}")
    assert_one_line(result, 2, "--jobs must be auto or in [1, 1024], got")
    assert len(result.stderr) < 200


def test_jobs_need_something_to_share(lagtop: Lagtop) -> None:
    assert_one_line(lagtop("table", "--jobs", 2), 2, "--jobs shares out many tops")
    refused = lagtop("sweep", "--jobs", 2, "--dask", "local")
    assert_one_line(refused, 2, "--jobs and --dask exclude each other")


TOPS = "id,r0,theta0_deg\n" + "".join(f"{i},{20 + i},{i % 190}\n" for i in range(300))


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [
        ["sweep", "--r0", "1:100:20000"],
        ["sweep", "tops.csv", "--keys", "T_nutation", "--fail-fast"],
        ["table", "--tops", "tops.csv", "--n", "3"],
        ["table", "--tops", "tops.csv", "--times", "times.txt", "--format", "json"],
        ["stability", "--samples", "1", "--strata", "fast,slow", "--format", "csv"],
    ],
)
def test_bytes_are_those_of_one_process(options: Sequence[str], tmp_path: Path) -> None:
    (tmp_path / "tops.csv").write_text(TOPS)
    (tmp_path / "times.txt").write_text("0\n0.5\n")
    alone, shared = (
        process(*options, "--jobs", jobs, check=False, cwd=tmp_path) for jobs in ("1", "2")
    )
    assert (shared.returncode, shared.stdout) == (alone.returncode, alone.stdout)
    assert len(shared.stdout) > 10
    if options[0] != "stability":  # which says on standard error how fast the machine is
        assert shared.stderr == alone.stderr


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_signal_ends_all_processes(number: signal.Signals, tmp_path: Path) -> None:
    command = [*LAGTOP, "sweep", "--r0", "1:100:1e8", "--jobs", "2", "-o", str(tmp_path / "o.csv")]
    running = subprocess.Popen(command, stderr=subprocess.PIPE, start_new_session=True)
    while not any(path.stat().st_size for path in tmp_path.iterdir()):  # rows have come
        assert running.poll() is None
        time.sleep(0.01)
    running.send_signal(number)
    assert running.wait(timeout=60) == -number
    deadline = time.monotonic() + 30
    while is_alive(running.pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not is_alive(running.pid)
    said = running.communicate()[1]
    if number != signal.SIGKILL:  # which nothing can clean up after
        assert (said, list(tmp_path.iterdir())) == (b"", [])


def is_alive(group: int) -> bool:
    """Return whether a process group has a process left."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True
