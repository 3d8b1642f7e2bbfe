"""Behaviour that only a separate process can show: modules loaded, streams, signals, files."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from click.shell_completion import ShellComplete
from conftest import LAGTOP, Lagtop, forked, process

from lagrange_cli.cli.app import main

HEAVY = {"distributed", "pyarrow", "numpy", "scipy", "mpmath", "rich", "matplotlib", "orjson"}


LOADED = {
    "solve --format json": set(),
    "solve --format csv --rad --theta0 1": set(),
    "--help": set(),
    "table --help": set(),
    "plot --help": set(),
    "view -o -": set(),
    "solve": {"rich"},
    "table": {"numpy", "orjson"},
    "table --r0 0 --format json": {"numpy", "orjson"},
    "solve --get T_nutation": set(),
    "sweep --help": set(),
    "compare --help": set(),
    "find --help": set(),
    "fit --help": set(),
    "sweep --r0 1:2:3": {"numpy", "orjson"},
    "jacobi --k 0.8 --format json": set(),
    "jacobi --k-prime 1e-9": {"rich"},
    "jacobi --nome 0.1 --format csv": set(),
    "jacobi --k 0.8 --u K/2,K/3 --format csv": {"orjson"},
    "jacobi --k 0.8 --u 0.5 --functions zeta,pi --param 0.7i --format json": {"orjson"},
    "jacobi --k 0.8 --u 0.5 --functions theta,omega --param 0.7": {"orjson", "rich"},
    "jacobi --k 0.8 --phi 30,60 --format csv": {"orjson"},
    "jacobi --k 0.8 --u 0:1:99 --format csv": {"numpy", "orjson"},
    "eta --delta 0.6 --delta-star -0.5 --p 0.1 --q 1.4 --format json": set(),
}
"""Command lines, and the heavy packages that each needs."""


@pytest.mark.slow
def test_nothing_is_loaded_that_is_not_needed(tmp_path: Path) -> None:
    listing = "import atexit; atexit.register(lambda: print(*sys.modules, file=sys.stderr))"
    ends = forked(LOADED, tmp_path, each=listing)
    assert [end.code for end in ends] == [0] * len(LOADED)
    names = [{name.partition(".")[0] for name in end.stderr.decode().split()} for end in ends]
    assert {line: x & HEAVY for line, x in zip(LOADED, names, strict=True)} == LOADED


def shell(line: str, **extra: str) -> subprocess.CompletedProcess[bytes]:
    """Run a line of bash in which $LAGTOP is the command."""
    environment = os.environ | {"LAGTOP": " ".join(LAGTOP)} | extra
    return subprocess.run(["bash", "-c", line], capture_output=True, check=False, env=environment)


@pytest.mark.slow
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "command",
    [
        "table --t-max 1",
        "table --n 200000",
        "table --n 5000 --format json",
        "sweep --r0 1:100:20000",
        "sweep --r0 1:100:5000 --format ndjson",
    ],
)
def test_head_is_silent(command: str, unbuffered: str) -> None:
    line = f"$LAGTOP {command} | head -3; echo ${{PIPESTATUS[0]}}"
    result = shell(line, PYTHONUNBUFFERED=unbuffered)
    assert result.stderr == b""
    assert result.stdout.count(b"\n") == 4
    assert result.stdout.split()[-1] in (b"0", b"141")


@pytest.mark.slow
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "command", ["solve", "solve --format json", "table --n 100000", "sweep --r0 1:9:20000"]
)
@pytest.mark.parametrize(
    ("where", "why"), [("> /dev/full", "No space left on device"), (">&-", "it is closed")]
)
def test_output_that_no_place_takes(where: str, why: str, command: str, unbuffered: str) -> None:
    result = shell(f"$LAGTOP {command} {where}", PYTHONUNBUFFERED=unbuffered)
    said = f"Error: cannot write standard output: {why}\n"
    assert (result.returncode, result.stderr.decode()) == (74, said)


@pytest.mark.slow
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_reader_that_is_gone_before_the_first_byte(unbuffered: str) -> None:
    for command in ("solve --format json", "table", "sweep"):
        line = f"$LAGTOP {command} | true; echo ${{PIPESTATUS[0]}}"
        result = shell(line, PYTHONUNBUFFERED=unbuffered)
        assert (result.stdout, result.stderr) in [(b"141\n", b""), (b"0\n", b"")]


@pytest.mark.slow
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_file_that_may_not_grow(unbuffered: str, tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    target.write_text("old")
    line = f"ulimit -f 64; trap '' XFSZ; $LAGTOP table --n 100000 -o {target}"
    result = shell(line, PYTHONUNBUFFERED=unbuffered)
    assert result.returncode == 74
    assert result.stderr == f"Error: cannot write {target}: File too large\n".encode()
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.slow
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_slow_reader_gets_all_of_it(unbuffered: str) -> None:
    command = [*LAGTOP, "table", "--n", "20000"]
    whole = subprocess.run(command, capture_output=True, check=True).stdout
    environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment) as running:
        assert running.stdout is not None
        time.sleep(1)  # the pipe is full long before
        parts = []
        while part := os.read(running.stdout.fileno(), 30_000):
            parts.append(part)
            time.sleep(0.002)
    assert b"".join(parts) == whole
    assert running.returncode == 0


def test_a_named_pipe_is_written_in_place(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with subprocess.Popen(["cat", str(pipe)], stdout=subprocess.PIPE) as reader:
        process("table", "--n", "3", "-o", str(pipe))
        assert reader.communicate(timeout=30)[0] == process("table", "--n", "3").stdout
    assert pipe.is_fifo()


@pytest.mark.slow
def test_a_shell_loop_stops_with_ctrl_c(tmp_path: Path) -> None:
    line = f"for i in 1 2 3; do echo $i; $LAGTOP table --n 1e9 -o {tmp_path}/out.csv; done; echo 4"
    environment = os.environ | {"LAGTOP": " ".join(LAGTOP)}
    running = subprocess.Popen(
        ["bash", "-c", line], stdout=subprocess.PIPE, env=environment, start_new_session=True
    )
    wait_for_a_file(tmp_path)
    os.killpg(running.pid, signal.SIGINT)
    assert running.communicate(timeout=30)[0] == b"1\n"
    assert running.returncode == -signal.SIGINT
    assert list(tmp_path.iterdir()) == []


def wait_for_a_file(folder: Path, count: int = 1) -> None:
    """Wait until a folder holds so many files and their writer is at work."""
    deadline = time.monotonic() + 30
    while len(list(folder.iterdir())) < count and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(0.2)


def most_memory(*args: str) -> float:
    """Return the most memory of a command in MB, by its own account: ru_maxrss has its parent's."""
    code = """if True:
        import atexit, sys
        from lagrange_cli.__main__ import main
        atexit.register(lambda: sys.stderr.write(open("/proc/self/status").read()))
        main()
    """
    command = [sys.executable, "-c", code, *args, "-o", "/dev/null"]
    status = subprocess.run(command, capture_output=True, check=True).stderr.decode()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024


@pytest.mark.slow
@pytest.mark.parametrize(
    "command", ["table --n {}", "sweep --r0 1:90:{} --keys r0,regime --format ndjson"]
)
def test_memory_does_not_grow_with_the_rows(command: str) -> None:
    few, many = (most_memory(*command.format(n).split()) for n in ("1e5", "1e6"))
    assert many < 200
    assert many < few + 10


@pytest.mark.slow
@pytest.mark.parametrize("form", ["csv", "json", "npy"])
def test_memory_does_not_grow_with_the_rows_of_a_trajectory(form: str, tmp_path: Path) -> None:
    used, path = [], tmp_path / "trajectory.npy"
    for count in ("1e5", "5e5" if form == "json" else "1e6"):  # rows of json are slow to read
        how = ["--t-max", "10", "--n", count, "--columns", "t,theta", "-o", str(path)]
        process("table", *how, "--format", "json" if form == "json" else "csv")
        if form == "npy":
            np.save(path, np.loadtxt(path, delimiter=",", skiprows=1))
        used.append(most_memory("compare", str(path), "--columns", "t,theta"))
    assert used[1] < 200
    assert used[1] < used[0] + 25, used  # of files of 2 and of 20 MB and more


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
def test_a_failed_command_leaves_the_file_as_it_was(
    bad: list[str], tmp_path: Path, lagtop: Lagtop
) -> None:
    target = tmp_path / "out.csv"
    target.write_text("old")
    assert lagtop("table", "-o", target, *bad).exit_code in (2, 65)
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_output_to_a_device() -> None:
    assert process("solve", "-o", "/dev/null").stdout == b""


@pytest.mark.slow
@pytest.mark.parametrize("command", ["table --n 1e9", "sweep --r0 1:2:1e9"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_kill_and_clean_up(number: signal.Signals, command: str, tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    target.write_text("old")
    running = subprocess.Popen(
        [*LAGTOP, *command.split(), "-o", str(target)], stderr=subprocess.PIPE
    )
    wait_for_a_file(tmp_path, 2)
    running.send_signal(number)
    _, stderr = running.communicate(timeout=30)
    assert running.returncode == -number
    assert b"Traceback" not in stderr
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.slow
def test_narrow_terminal_without_colour_cuts_nothing() -> None:
    plain = process("solve").stdout
    environment = os.environ | {"COLUMNS": "40", "NO_COLOR": "1", "TERM": "dumb"}
    assert process("solve", env=environment).stdout == plain


@pytest.mark.parametrize(
    ("line", "completed"),
    [
        ("so", ["solve"]),
        ("solve --get T_nut", ["T_nutation", "T_nutation_elementary"]),
        ("sweep --keys r0,mean_s", ["r0,mean_spin_rate"]),
        ("table --columns t,quat", ["t,quaternion", *(f"t,quaternion_{x}" for x in "wxyz")]),
        ("bench --methods lagtop,muj", [f"lagtop,mujoco{x}" for x in ("-euler", "-rk4", "")]),
        ("stability --strata slo", ["slow"]),
        ("plot sph", ["sphere", "spherical-pendulum"]),
        ("plot --key T_spi", ["T_spin"]),
        ("plot --x thetad", ["thetadot0="]),
        ("find T_pre", ["T_precession="]),
        ("compare --align sta", ["start"]),
        ("solve simo", ["simo-wong-1991"]),
        ("plot scene", ["scene"]),
    ],
)
def test_completion(line: str, completed: list[str]) -> None:
    """What is offered, as a word or, for `scene`, as the beginning of a file."""
    words = line.split()
    items = ShellComplete(main, {}, "lagtop", "_X").get_completions(words[:-1], words[-1])
    assert [item.value for item in items] == completed
    assert {item.type for item in items} == {"file" if line == "plot scene" else "plain"}


def test_bash_gets_completions() -> None:
    asked = {"_LAGTOP_COMPLETE": "bash_complete", "COMP_WORDS": "lagtop so", "COMP_CWORD": "1"}
    assert b"solve" in process(env=os.environ | asked).stdout
