"""Sweeps on a Dask cluster of two worker processes: the bytes of a local run, whatever dies."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import LAGTOP, process
from distributed import Client, LocalCluster

pytestmark = pytest.mark.filterwarnings("default")  # whatever the cluster itself does


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        yield cluster


def joined(folder: Path) -> bytes:
    return b"".join(part.read_bytes() for part in sorted(folder.iterdir()))


def test_the_bytes_of_a_local_run(cluster: LocalCluster, tmp_path: Path) -> None:
    options = ["sweep", "--r0", "0:90:301", "--theta0", "0:180:31"]
    options += ["--keys", "r0,regime,T_nutation,error"]
    here = process(*options).stdout
    there = process(*options, "--dask", cluster.scheduler_address)
    assert there.stdout == here
    assert there.stderr == b""
    process(*options, "--dask", cluster.scheduler_address, "--parts", str(tmp_path))
    assert len(list(tmp_path.iterdir())) == 3
    assert joined(tmp_path) == here


def test_rows_and_errors_as_in_a_local_run(cluster: LocalCluster, tmp_path: Path) -> None:
    file = tmp_path / "tops.csv"
    file.write_text("id,r0\n" + "".join(f"{i},{'x' if i % 999 == 5 else i}\n" for i in range(9000)))
    here = process("sweep", str(file), check=False)
    there = process("sweep", str(file), "--dask", cluster.scheduler_address, check=False)
    assert here.returncode == there.returncode == 1
    assert (there.stdout, there.stderr) == (here.stdout, here.stderr)


def test_a_killed_worker_loses_nothing(cluster: LocalCluster, tmp_path: Path) -> None:
    options = ["sweep", "--r0", "1:100:150000"]
    here = process(*options).stdout
    with Client(cluster.scheduler_address) as client:
        victim = min(client.run(os.getpid).values())
    running = subprocess.Popen(
        [*LAGTOP, *options, "--dask", cluster.scheduler_address, "--parts", str(tmp_path)]
    )
    while running.poll() is None and len(list(tmp_path.iterdir())) < 2:
        time.sleep(0.005)
    assert running.poll() is None
    os.kill(victim, signal.SIGKILL)
    assert running.wait(timeout=60) == 0
    assert joined(tmp_path) == here


def test_a_cluster_of_its_own_goes_with_it(tmp_path: Path) -> None:
    command = [*LAGTOP, "sweep", "--r0", "1:100:1e8", "--dask", "local", "-o"]
    running = subprocess.Popen(
        [*command, str(tmp_path / "out.csv")], stderr=subprocess.PIPE, start_new_session=True
    )
    while not list(tmp_path.iterdir()):
        time.sleep(0.05)
    time.sleep(0.5)
    os.killpg(running.pid, signal.SIGINT)
    assert running.communicate(timeout=60)[1] == b""
    assert running.returncode == -signal.SIGINT
    assert list(tmp_path.iterdir()) == []
    deadline = time.monotonic() + 30
    while alive(running.pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not alive(running.pid)


def alive(group: int) -> bool:
    """Whether a process group has a process left."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_no_cluster() -> None:
    result = process("sweep", "--dask", "nowhere", check=False)
    assert (result.returncode, result.stdout) == (2, b"")
    assert result.stderr.startswith(b"Error: --dask must be local or a scheduler, got nowhere")
    assert result.stderr.count(b"\n") == 1
