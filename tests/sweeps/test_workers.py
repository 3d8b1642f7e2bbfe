"""Work shared by processes or a cluster: the bytes of one process, and nothing left behind."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path

import pytest
from conftest import LAGTOP, assert_gone, joined, process, wait_until

from lagrange_cli.cli.sweep import _parse_jobs
from lagrange_cli.errors import UnavailableError
from lagrange_cli.sweeps import workers
from lagrange_cli.sweeps.workers import in_order

LONG = ["sweep", "--r0", "1:100:1e8", "--psidot0", "1", "--jobs", "3"]
LOST = rb"Error: a process that shared the work was lost \(killed, or out of memory\).*\n"


def test_auto_is_a_process_per_core(monkeypatch: pytest.MonkeyPatch) -> None:
    """Some systems cannot list the cores of one process, and some cannot count cores."""
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    for cores, jobs in ((3, 3), (None, 1)):
        monkeypatch.setattr(os, "cpu_count", lambda cores=cores: cores)
        assert _parse_jobs("auto") == jobs


def test_results_and_errors_of_two_processes() -> None:
    assert list(in_order(hex, range(50), 2)) == [*map(hex, range(50))]
    with pytest.raises(ValueError, match="invalid literal"):
        list(in_order(int, ["1", "x"], 2))
    with pytest.raises(UnavailableError, match=r"was lost \(.*it ended with code 3"):
        list(in_order(os._exit, [3], 2))


@pytest.mark.slow
@pytest.mark.parametrize("jobs", ["2", "auto", ""])
def test_bytes_are_those_of_one_process(jobs: str, tmp_path: Path) -> None:
    """Without jobs, on a cluster."""
    file = tmp_path / "tops.csv"
    file.write_text("id,r0\n" + "".join(f"{i},{'x' if i % 999 == 5 else i}\n" for i in range(9000)))
    grid = ["sweep", "--r0", "0:90:301", "--theta0", "0:180:31", "--keys", "r0,regime,K,error"]
    with nullcontext() if jobs else cluster(tmp_path, 2) as found:
        how = ["--dask", found[0]] if found else ["--jobs", jobs]
        for options in (grid, ["sweep", str(file), "--keys", "T_nutation"]):
            alone, shared = (process(*options, *more, check=False) for more in ([], how))
            assert shared.returncode == alone.returncode == (options is not grid)
            assert (shared.stdout, shared.stderr) == (alone.stdout, alone.stderr)
        process(*grid, *how, "--parts", str(tmp_path / "parts"))
    assert joined(tmp_path / "parts") == process(*grid).stdout


def workers_of(process: int) -> list[int]:
    """Return the processes that share the work of a process."""
    children = Path(f"/proc/{process}/task").glob("*/children")  # of each thread
    found = [int(pid) for file in children for pid in file.read_text().split()]
    return [pid for pid in found if "serve()" in Path(f"/proc/{pid}/cmdline").read_text()]


@contextmanager
def sharing(folder: Path) -> Iterator[tuple[subprocess.Popen[bytes], list[int]]]:
    """Yield a long sweep that writes results, in a process group of its own, and its workers.

    At the end none of the processes may be left.
    """
    running = subprocess.Popen(
        ["env", "--default-signal=HUP,INT,QUIT", *LAGTOP, *LONG, "-o", f"{folder}/o.csv"],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        wait_until(lambda: any(x.stat().st_size for x in folder.glob(".lagtop-*")), running)
        workers = workers_of(running.pid)
        assert len(workers) == 3
        yield running, workers
        for group in (running.pid, *workers):
            assert_gone(group)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(running.pid, signal.SIGKILL)


@pytest.mark.slow
@pytest.mark.parametrize("send", [os.kill, os.killpg], ids=["process", "group"])
@pytest.mark.parametrize("name", ["INT", "TERM", "HUP", "INT INT INT", "TERM INT"])
def test_a_signal_ends_all_processes(
    name: str, send: Callable[[int, int], None], tmp_path: Path
) -> None:
    """A terminal that is closed and a batch system send it to the whole group."""
    numbers = [getattr(signal, f"SIG{x}") for x in name.split()]
    with sharing(tmp_path) as (running, _):
        begun = time.monotonic()
        for number in numbers:
            send(running.pid, number)
            time.sleep(0.05)
        said = running.communicate(timeout=60)[1]
    assert running.returncode in {x for n in numbers for x in (-n, 128 + n)}  # any comes first
    assert said == b""
    assert list(tmp_path.iterdir()) == []
    assert time.monotonic() - begun < 10  # measured: 0.2 to 0.5


@pytest.mark.slow
@pytest.mark.parametrize("who", ["worker", "parent"])
def test_a_killed_process_ends_the_sweep(who: str, tmp_path: Path) -> None:
    with sharing(tmp_path) as (running, workers):
        os.kill(workers[0] if who == "worker" else running.pid, signal.SIGKILL)
        said = running.communicate(timeout=60)[1]
    if who == "worker":
        assert (running.returncode, bool(re.fullmatch(LOST, said))) == (69, True), said
        assert list(tmp_path.iterdir()) == []


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Start a scheduler and some workers; yield its address, and the processes in this order."""
    file, started = folder / "scheduler.json", list[subprocess.Popen[bytes]]()

    def start(name: str, *options: str) -> None:
        command = [sys.executable, "-m", f"distributed.cli.dask_{name}", *options]
        more = ["--no-dashboard"]
        started.append(subprocess.Popen([*command, *more], stderr=subprocess.DEVNULL, cwd=folder))

    def address() -> str:
        with suppress(FileNotFoundError, ValueError):  # not there yet, or half of it
            return str(json.loads(file.read_text())["address"])
        return ""

    try:
        start("scheduler", "--port", "0", "--scheduler-file", str(file))
        wait_until(address, started[0])
        for _ in range(workers):
            start("worker", address(), "--no-nanny", "--nthreads", "1")
        yield address(), started
    finally:
        for one in reversed(started):
            one.kill()
            one.wait()


@pytest.mark.slow
def test_workers_of_another_version_are_refused(tmp_path: Path) -> None:
    (tmp_path / "lagrange_cli").mkdir()
    (tmp_path / "lagrange_cli" / "__init__.py").write_text("__version__ = '0.0.9'")
    with cluster(tmp_path, 1) as (address, _):
        done = process("sweep", "--dask", address, check=False)
    assert (done.returncode, done.stdout) == (69, b"")
    assert re.fullmatch(rb"Error: the worker .* needs lagtop .*, has 0\.0\.9\n", done.stderr)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("address", "code"),
    [("nowhere", 2), ("http://127.0.0.1:9", 2), ("", 2), ("tcp://127.0.0.1:9", 69)],
)
def test_no_cluster(address: str, code: int) -> None:
    done = process("sweep", "--dask", address, check=False)
    assert (done.returncode, done.stdout, done.stderr.count(b"\n")) == (code, b"", 1)
    assert done.stderr.startswith(b"Error: ")


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "_PATIENCE", 1.5)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(UnavailableError, match=f"the cluster at {address} does not answer"):
            list(in_order(str, [1], address=address))


@pytest.mark.slow
def test_a_cluster_without_workers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "_PATIENCE", 6.0)
    why = "the cluster at .* has no workers"
    with cluster(tmp_path, 0) as (address, _), pytest.raises(UnavailableError, match=why):
        list(in_order(str, [1], address=address))


@pytest.mark.slow
@pytest.mark.parametrize(
    "case",
    [
        (2, 1, signal.SIGKILL, ""),  # the other worker does its work
        (2, 0, signal.SIGKILL, "was lost"),
        (1, 1, signal.SIGKILL, "does not answer"),
        (1, 1, signal.SIGSTOP, "does not answer"),
    ],
)
def test_a_scheduler_or_a_worker_is_lost(
    case: tuple[int, int, int, str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    count, lost, number, why = case
    with cluster(tmp_path, count) as (address, processes):
        computed = in_order(str, range(600), address=address)
        assert next(computed) == "0"
        monkeypatch.setattr(workers, "_PATIENCE", 3.0)
        processes[lost].send_signal(number)
        with pytest.raises(UnavailableError, match=why) if why else nullcontext():
            assert [*computed] == [*map(str, range(1, 600))]
    assert capfd.readouterr().err == ""  # no log of distributed
