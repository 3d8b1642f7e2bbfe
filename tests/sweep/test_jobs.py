"""Work shared by several processes: bytes and order as in one, ends that leave nothing behind."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager, nullcontext, suppress
from pathlib import Path

import pytest
from click.testing import Result
from conftest import LAGTOP, Lagtop, assert_gone, assert_one_line, wait_until

from lagrange_cli.errors import CannotWriteError, LagtopError, UnavailableError
from lagrange_cli.sweep.jobs import _Worker, in_order, parse_jobs


def number_and_place(x: int) -> tuple[int, int]:
    """Return a number and the process that it was in; some take longer: the order is restored."""
    time.sleep(0.02 if x % 5 == 0 else 0.005)
    return x, os.getpid()


def refuse(x: int) -> None:
    """Take a while, and fail unless this is the process that shares the work out."""
    time.sleep(0.01)
    if multiprocessing.parent_process() is not None:
        raise LagtopError(f"{x} is too large")


def lose(x: int) -> None:
    """Take a while, and kill the process unless it is the one that shares the work out."""
    time.sleep(0.01)
    if multiprocessing.parent_process() is not None:
        os.kill(os.getpid(), signal.SIGKILL)


MANY = range(10_000)
"""More than this process has done when another one has started, however slow that is."""


def until_shared(jobs: int) -> list[tuple[int, int]]:
    """Return the results up to the first hundred of another process."""
    found: list[tuple[int, int]] = []
    with closing(in_order(number_and_place, MANY, jobs)) as results:
        for result in results:
            found.append(result)
            if sum(place != os.getpid() for _, place in found) == 100:
                break
    return found


@pytest.mark.slow
def test_results_come_in_the_order_of_the_work() -> None:
    numbers, places = zip(*until_shared(3), strict=True)
    assert numbers == tuple(range(len(numbers)))
    assert len(set(places)) == 3
    assert list(in_order(number_and_place, [], 2)) == []


@pytest.mark.slow
def test_results_that_cannot_be_written_are_reported(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for number in range(100):  # where the files were to be
        (tmp_path / str(number)).mkdir()
    folder = nullcontext(str(tmp_path))
    monkeypatch.setattr("lagrange_cli.sweep.jobs.TemporaryDirectory", lambda **_: folder)
    with pytest.raises(CannotWriteError, match=r"^cannot write .*: Is a directory"):
        list(in_order(number_and_place, MANY, 2))


def test_a_missing_temporary_folder_is_reported(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "missing"))
    with pytest.raises(CannotWriteError, match=r"^cannot write temporary files: No such file"):
        list(in_order(number_and_place, MANY, 2))


@pytest.mark.slow
def test_an_error_of_the_work_is_raised() -> None:
    with pytest.raises(LagtopError, match="too large"):
        list(in_order(refuse, MANY, 2))


@pytest.mark.slow
def test_a_lost_process_is_told() -> None:
    with pytest.raises(UnavailableError, match="was lost"):
        list(in_order(lose, MANY, 2))


def test_jobs() -> None:
    assert parse_jobs("3") == 3
    assert parse_jobs("auto") >= 1


@pytest.mark.parametrize("text", ["0", "-1", "1.5", "many", "1025", "²", "9" * 5000])
def test_invalid_numbers_of_jobs_are_refused(text: str, lagtop: Lagtop) -> None:
    result = lagtop("sweep", f"--jobs={text}")
    assert_one_line(result, 2, "--jobs must be auto or in [1, 1024], got")
    assert len(result.stderr) < 200


def test_jobs_need_something_to_share(lagtop: Lagtop) -> None:
    refused = lagtop("sweep", "--jobs", 2, "--dask", "local")
    assert_one_line(refused, 2, "use --jobs or --dask, not both")


def tops(count: int) -> str:
    """Return a file of tops whose last one has an error."""
    rows = (f"{i},{20 + i},{i % 180 if i + 1 < count else 200}\n" for i in range(count))
    return "id,r0,theta0_deg\n" + "".join(rows)


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [
        ["sweep", "--r0", "1:100:40000"],
        ["sweep", "tops.csv", "--keys", "T_nutation", "--fail-fast"],
    ],
)
def test_bytes_are_those_of_one_process(
    options: Sequence[str], tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("lagrange_cli.sweep.jobs._Worker", Started)
    Path("tops.csv").write_text(tops(9000))
    Path("few.csv").write_text(tops(12))
    Path("times.txt").write_text("0.5\n" * 20_000)
    alone, shared = (lagtop(*options, "--jobs", jobs) for jobs in (1, 2))
    assert (shared.exit_code, determined(shared)) == (alone.exit_code, determined(alone))
    assert len(shared.stdout) > 10
    if options[0] != "stability":  # which says on standard error how fast the machine is
        assert shared.stderr == alone.stderr


def determined(result: Result) -> list[bytes]:
    """Return the lines whose bytes no library chooses: the last digits of Radau are LAPACK's.

    LAPACK adds in an order that depends on where in memory the matrices are.
    """
    return [line for line in result.stdout_bytes.splitlines() if b",Radau-" not in line]


class Started(_Worker):
    """A process that has started before the first item is done: it gets the next ones."""

    def start(self) -> None:
        """Start the process, and wait for it to say so."""
        super().start()
        assert list(self.answer()) == []


@pytest.fixture
def script(tmp_path: Path) -> list[str]:
    """Return the command as the script of an installation runs it: not from the current folder."""
    path = tmp_path / "lagtop.py"
    path.write_text("from lagrange_cli.__main__ import main\nif __name__ == '__main__': main()\n")
    return [sys.executable, str(path)]


@pytest.mark.parametrize("how", ["--jobs 2", pytest.param("--dask local", marks=pytest.mark.slow)])
def test_no_module_of_the_current_folder_is_run(
    how: str, script: list[str], tmp_path: Path
) -> None:
    folder = tmp_path / "downloads"
    folder.mkdir()
    names = "signal pickle socket selectors tempfile logging random struct lagrange_cli".split()
    for name in names:
        (folder / f"{name}.py").write_text(f"open('RAN-{name}', 'w')\nraise SystemExit\n")
    line = ["sweep", "--r0", "1:9:20000", "--keys", "r0", *how.split()]
    done = subprocess.run([*script, *line], cwd=folder, capture_output=True, check=False)
    assert (done.returncode, done.stderr, done.stdout.count(b"\n")) == (0, b"", 20_001)
    assert sorted(path.name for path in folder.iterdir()) == sorted(f"{x}.py" for x in names)


def test_a_folder_that_is_gone(script: list[str], tmp_path: Path) -> None:
    line = f"mkdir x; cd x; rmdir ../x; exec {' '.join(script)} sweep --jobs 2"
    done = subprocess.run(["sh", "-c", line], cwd=tmp_path, capture_output=True, check=False)
    assert (done.returncode, done.stdout) == (69, b"")
    assert done.stderr == b"Error: cannot start a process: No such file or directory\n"


def children(process: int) -> dict[int, str]:
    """Return the command lines of the processes that a process has started."""
    found = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    return {int(pid): Path(f"/proc/{pid}/cmdline").read_text() for pid in found}


HEEDING = ["env", "--default-signal=HUP,INT,QUIT"]
"""Undoes what `nohup` and the background of a shell ignore: ignored signals stay ignored."""


@contextmanager
def sharing(folder: Path, *output: str) -> Iterator[subprocess.Popen[bytes]]:
    """Start a long sweep in a process group of its own, and wait until it shares work."""
    running = subprocess.Popen(
        [*HEEDING, *LAGTOP, "sweep", "--r0", "1:100:1e8", "--jobs", "3", *output],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        start_new_session=True,
        env=os.environ | {"TMPDIR": str(folder)},
    )
    try:
        wait_until(lambda: len(list(folder.glob("lagtop-*/*.result"))) >= 4, running)
        yield running
    finally:
        with suppress(ProcessLookupError):
            os.killpg(running.pid, signal.SIGKILL)


@pytest.mark.slow
@pytest.mark.parametrize("to_file", [True, False])
@pytest.mark.parametrize(
    ("send", "names"),
    [(os.kill, "INT TERM KILL"), (os.killpg, "HUP INT QUIT TERM USR1")],
    ids=["one process", "whole group"],
)
def test_a_signal_ends_all_processes(
    send: Callable[[int, int], None], names: str, to_file: bool, tmp_path: Path
) -> None:
    """A terminal that is closed and a batch system send it to the whole group."""
    for name in names.split():
        number, folder = getattr(signal, f"SIG{name}"), tmp_path / name
        folder.mkdir()
        with sharing(folder, *(["-o", str(folder / "out.csv")] if to_file else [])) as running:
            send(running.pid, number)
            said = running.communicate(timeout=180)[1]
            assert_gone(running.pid)
        assert running.returncode == -number
        if name != "KILL":  # which nothing can clean up after
            assert (said, list(folder.iterdir())) == (b"", []), name


LONG_WORK = """if True:
    import sys, time
    from pathlib import Path
    sys.path.insert(0, {folder!r})
    from test_jobs import sleep_long
    from lagrange_cli.sweep.jobs import in_order
    if __name__ == "__main__":
        list(in_order(sleep_long, range(9), 2))
"""


def sleep_long(_: int) -> None:
    """Take a moment in the process that shares the work out, and a minute in the other one."""
    time.sleep(60 if multiprocessing.parent_process() else 0.2)


def test_a_worker_ends_with_its_parent_in_the_middle_of_its_work() -> None:
    code = LONG_WORK.format(folder=str(Path(__file__).parent))
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    running = subprocess.Popen(
        [sys.executable, "-c", code], start_new_session=True, env=environment
    )
    wait_until(lambda: "spawn_main" in " ".join(children(running.pid).values()), running)
    time.sleep(1.0)  # it has an item by now
    running.kill()
    running.wait()
    assert_gone(running.pid)


@pytest.mark.slow
@pytest.mark.parametrize("who", ["resource_tracker", "spawn_main"])
def test_a_helper_that_is_killed(who: str, tmp_path: Path) -> None:
    with sharing(tmp_path, "-o", str(tmp_path / "out.csv")) as running:
        victim = next(pid for pid, line in children(running.pid).items() if who in line)
        os.kill(victim, signal.SIGKILL)
        if who == "resource_tracker":  # which nothing needs
            time.sleep(0.5)
            running.send_signal(signal.SIGTERM)
        said = running.communicate(timeout=60)[1]
    lost = b"Error: a process that shared the work was lost (killed, or out of memory)\n"
    expected = (-signal.SIGTERM, b"") if who == "resource_tracker" else (69, lost)
    assert (running.returncode, said) == expected
    assert list(tmp_path.iterdir()) == []
