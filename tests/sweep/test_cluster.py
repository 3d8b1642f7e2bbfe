"""Sweeps on a Dask cluster of two worker processes: the bytes of a local run, whatever dies."""

from __future__ import annotations

import json
import os
import pickle
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from socketserver import BaseRequestHandler, ThreadingTCPServer
from threading import Thread
from typing import Any

import pytest
from conftest import LAGTOP, assert_gone, joined, process, wait_until
from distributed import Client, LocalCluster

from lagrange_cli.errors import UnavailableError
from lagrange_cli.inputs.ranges import parse_values
from lagrange_cli.sweep.cluster import Computed, compute, computed, connected
from lagrange_cli.sweep.folder import Folder
from lagrange_cli.sweep.plan import Part, plan

pytestmark = pytest.mark.filterwarnings("default")  # whatever the cluster itself does


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        yield cluster


@pytest.mark.slow
def test_the_bytes_of_a_local_run(cluster: LocalCluster, tmp_path: Path) -> None:
    options = ["sweep", "--r0", "0:90:301", "--theta0", "0:180:31"]
    options += ["--keys", "r0,regime,T_nutation,error"]
    here = process(*options).stdout
    there = process(*options, "--dask", cluster.scheduler_address)
    assert there.stdout == here
    assert there.stderr == b""
    process(*options, "--dask", cluster.scheduler_address, "--parts", str(tmp_path))
    assert len(list(tmp_path.glob("part-*"))) == 3
    assert joined(tmp_path) == here


@pytest.mark.slow
@pytest.mark.parametrize("seen", [True, False])
def test_workers_write_the_parts_of_a_folder_that_they_see(
    seen: bool, cluster: LocalCluster, tmp_path: Path
) -> None:
    """The client writes the others; a folder of the same name elsewhere lacks its token."""
    axes = {"r0": parse_values("1:100:9000"), "theta0_deg": parse_values("0,30")}
    todo = plan([], axes, keys=["r0", "K"], described=True)
    folder = Folder(str(tmp_path), todo.sweep, todo.description)
    blocks = list(todo.blocks)
    with folder.made_by_workers() as make:
        if not seen:
            next(tmp_path.glob(".lagtop-*")).unlink()
        with (
            connected(cluster.scheduler_address) as client,
            computed(make, blocks, client) as parts,
        ):
            found = list(parts)
    assert [part.is_written for part in found] == [seen] * len(blocks)
    assert [not part.text for part in found] == [seen] * len(blocks)
    folder.write(found)
    assert (
        joined(tmp_path)
        == process("sweep", "--r0", "1:100:9000", "--theta0", "0,30", "--keys", "r0,K").stdout
    )
    assert list(tmp_path.glob(".lagtop-*")) == []


@pytest.mark.slow
def test_a_worker_that_cannot_write(tmp_path: Path) -> None:
    """One line, as where the client cannot: here a file may not grow beyond 10 kB."""
    with LocalCluster(n_workers=0, dashboard_address=None) as empty:
        address, out = empty.scheduler_address, tmp_path / "out"
        limited = """if True:
            import resource, runpy, signal
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000))
            runpy.run_module("distributed.cli.dask_worker", run_name="__main__")
        """
        with ended("-c", limited, address, "--no-nanny", "--no-dashboard", cwd=tmp_path):
            wait_for_workers(address, 1)
            options = ["sweep", "--r0", "1:100:9000", "--dask", address, "--parts", str(out)]
            result = process(*options, check=False)
    assert (result.returncode, result.stdout) == (74, b"")
    assert result.stderr.startswith(f"Error: cannot write {out}/part-".encode())
    assert result.stderr.endswith(b": File too large\n")
    assert result.stderr.count(b"\n") == 1
    assert [path.name for path in out.iterdir()] == ["sweep.json"]


@pytest.mark.slow
def test_rows_and_errors_as_in_a_local_run(cluster: LocalCluster, tmp_path: Path) -> None:
    file = tmp_path / "tops.csv"
    file.write_text("id,r0\n" + "".join(f"{i},{'x' if i % 999 == 5 else i}\n" for i in range(9000)))
    here = process("sweep", str(file), check=False)
    there = process("sweep", str(file), "--dask", cluster.scheduler_address, check=False)
    assert here.returncode == there.returncode == 1
    assert (there.stdout, there.stderr) == (here.stdout, here.stderr)


@pytest.mark.slow
def test_a_killed_worker_loses_nothing(cluster: LocalCluster, tmp_path: Path) -> None:
    options = ["sweep", "--r0", "1:100:150000"]
    here = process(*options).stdout
    with Client(cluster.scheduler_address) as client:
        victim = min(client.run(os.getpid).values())
    running = subprocess.Popen(
        [*LAGTOP, *options, "--dask", cluster.scheduler_address, "--parts", str(tmp_path)]
    )
    wait_until(lambda: len(list(tmp_path.glob("part-*"))) >= 2, running)
    os.kill(victim, signal.SIGKILL)
    assert running.wait(timeout=60) == 0
    assert joined(tmp_path) == here
    assert list(tmp_path.glob(".lagtop-*")) == []  # nor of the worker that was killed


@pytest.mark.slow
def test_a_cluster_of_its_own_goes_with_it(tmp_path: Path) -> None:
    command = [*LAGTOP, "sweep", "--r0", "1:100:1e8", "--dask", "local", "-o"]
    running = subprocess.Popen(
        [*command, str(tmp_path / "out.csv")], stderr=subprocess.PIPE, start_new_session=True
    )
    wait_until(lambda: any(path.stat().st_size for path in tmp_path.iterdir()), running)
    os.killpg(running.pid, signal.SIGINT)
    assert running.communicate(timeout=60)[1] == b""
    assert running.returncode == -signal.SIGINT
    assert list(tmp_path.iterdir()) == []
    assert_gone(running.pid)


@contextmanager
def ended(*command: str, **extra: Any) -> Iterator[subprocess.Popen[bytes]]:
    """Start a process, and kill it at the end if it runs then."""
    with subprocess.Popen([sys.executable, *command], stderr=subprocess.PIPE, **extra) as running:
        try:
            yield running
        finally:
            running.kill()


@contextmanager
def worker(address: str, folder: Path, init: str) -> Iterator[subprocess.Popen[bytes]]:
    """Start a worker that has a package lagrange_cli of its own, of these lines."""
    (folder / "lagrange_cli").mkdir(parents=True)
    (folder / "lagrange_cli" / "__init__.py").write_text(init)
    path = os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")])
    command = ["-m", "distributed.cli.dask_worker", address, "--no-nanny", "--no-dashboard"]
    env = os.environ | {"PYTHONPATH": path}
    with ended(*command, "--nthreads", "1", cwd=folder, env=env) as running:
        yield running


def wait_for_workers(address: str, count: int) -> None:
    with Client(address) as client:
        client.wait_for_workers(count, timeout=60)


BAD_WORKERS = {
    "without": ("raise ImportError('not here')", b"has no lagtop: not here"),
    "other": ("__version__ = '0.0.9'", b"has lagtop 0.0.9, and not "),
}


def assert_lost(running: subprocess.Popen[bytes], message: bytes, *codes: int) -> None:
    """Check that a sweep ends with one line of error, and prints nothing else."""
    stdout, stderr = running.communicate(timeout=60)
    assert running.returncode in (codes or {69})
    assert stdout in {None, b""}
    assert re.match(rb"Error: .*\n\Z", stderr)
    assert re.search(message, stderr)


def assert_refused(address: str, message: bytes, *codes: int, cwd: Path | None = None) -> None:
    """Check that a sweep on a cluster ends with one line of error."""
    options = ["-m", "lagrange_cli", "sweep", "--dask", address, "--parts", "out"]
    options = options if cwd else options[:-2]
    with ended(*options, cwd=cwd, stdout=subprocess.PIPE) as running:
        assert_lost(running, message, *codes)


@pytest.mark.slow
@pytest.mark.parametrize("kind", BAD_WORKERS)
def test_a_worker_that_would_compute_otherwise_is_refused(kind: str, tmp_path: Path) -> None:
    """The worker lives on: a shared cluster may have such workers."""
    init, message = BAD_WORKERS[kind]
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster,
        worker(cluster.scheduler_address, tmp_path, init) as other,
    ):
        wait_for_workers(cluster.scheduler_address, 2)
        assert_refused(cluster.scheduler_address, message)
        assert other.poll() is None
        wait_for_workers(cluster.scheduler_address, 2)


@pytest.mark.slow
@pytest.mark.parametrize("kind", BAD_WORKERS)
def test_a_bad_worker_that_joins_later_is_refused(kind: str, tmp_path: Path) -> None:
    init = BAD_WORKERS[kind][0]
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        options = ["-m", "lagrange_cli", "sweep", "--r0", "1:100:1e8", "--parts", "out", "--dask"]
        with ended(*options, cluster.scheduler_address, cwd=tmp_path) as running:
            wait_until(lambda: list(tmp_path.glob("out/part-*")), running)
            with worker(cluster.scheduler_address, tmp_path / "worker", init) as other:
                assert_lost(running, b"Error: a worker of the cluster has no lagtop")
                assert other.poll() is None


def test_a_part_of_another_version_is_not_computed() -> None:
    content = pickle.dumps((None, None))
    with pytest.raises(UnavailableError, match="a worker of the cluster has lagtop"):
        compute("0.0.9", content)


@pytest.mark.slow
def test_a_cluster_without_workers() -> None:
    with LocalCluster(n_workers=0, dashboard_address=None) as cluster:
        assert_refused(cluster.scheduler_address, b"the cluster has no worker")


@pytest.mark.slow
def test_a_scheduler_that_is_not_there() -> None:
    assert_refused("tcp://127.0.0.1:9", b"no scheduler answers at tcp://127.0.0.1:9")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("who", "number"),
    [("scheduler", signal.SIGSTOP), ("scheduler", signal.SIGKILL), ("worker", signal.SIGKILL)],
)
def test_a_lost_scheduler_or_worker_is_reported(number: int, who: str, tmp_path: Path) -> None:
    """A stopped worker is not among them: the scheduler waits for it as long as it likes."""
    file = tmp_path / "scheduler.json"
    options = ["--scheduler-file", str(file)]
    module = "distributed.cli.dask_"
    with ended("-m", f"{module}scheduler", "--port", "0", "--no-dashboard", *options) as scheduler:
        address = ""
        while not address:
            assert scheduler.poll() is None
            time.sleep(0.01)
            with suppress(FileNotFoundError, ValueError):  # not there yet, or half of it
                address = json.loads(file.read_text())["address"]
        command = ["-m", f"{module}worker", address, "--no-nanny", "--no-dashboard"]
        sweep = ["-m", "lagrange_cli", "sweep", "--r0", "1:100:1e8", "--dask", address]
        with (
            ended(*command, "--nthreads", "1") as only_worker,
            ended(*sweep, "--parts", str(tmp_path / "out")) as running,
        ):
            wait_until(lambda: list(tmp_path.glob("out/part-*")), running)
            os.kill((scheduler if who == "scheduler" else only_worker).pid, number)
            assert_lost(running, b"Error: (the cluster|all workers of the cluster) ")


@pytest.mark.slow
@pytest.mark.parametrize(
    "address", ["nowhere", "tls://127.0.0.1:5", "ucx://1", "http://127.0.0.1:9", "tcp://", ""]
)
def test_no_cluster(address: str, tmp_path: Path) -> None:
    said = f"Error: --dask must be local or a scheduler, got {re.escape(address)}"
    assert_refused(address, said.encode(), 2, cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []


class Answers(BaseRequestHandler):
    """A server that is no scheduler."""

    words = b""

    def handle(self) -> None:
        """Say something and close soon, or say nothing until the other side closes."""
        self.request.sendall(self.words)
        if self.words:
            time.sleep(1)
        else:
            while self.request.recv(1 << 16):
                pass


@pytest.mark.slow
@pytest.mark.parametrize(
    argnames="words",
    ids=["web", "ones", "zeros", "shell", "silent"],
    argvalues=[
        b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n",
        b"\xff" * 64,
        bytes(64),
        b"SSH-2.0",
        b"",
    ],
)
def test_a_server_that_is_no_scheduler(words: bytes) -> None:
    handler = type("Says", (Answers,), {"words": words})
    with ThreadingTCPServer(("127.0.0.1", 0), handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        address = f"tcp://127.0.0.1:{server.server_address[1]}"
        try:
            assert_refused(address, re.escape(address).encode(), 2, 69)
        finally:
            server.shutdown()


@pytest.mark.parametrize(
    ("count", "seconds", "next_count"), [(1, 0.02, 16), (1, 0.25, 4), (4, 1.0, 4), (4, 30.0, 1)]
)
def test_a_task_has_about_a_second_of_work(count: int, seconds: float, next_count: int) -> None:
    parts = [Part(number, b"", 4096, 0, "") for number in range(count)]
    assert Computed(parts, seconds).next_size() == next_count
