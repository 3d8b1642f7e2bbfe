"""Signals and places to write, each as a shell and the tools of a system treat them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import LAGTOP, Lagtop, assert_one_line, forked, process
from test_processes import wait_for_a_file

INTERRUPT_AT_IMPORT = """if True:
    import os, signal, sys
    name, *sys.argv = sys.argv[1:]

    class Interrupt:
        @staticmethod
        def find_spec(module, *_):
            if module == name:
                os.kill(os.getpid(), signal.SIGINT)

    sys.meta_path.insert(0, Interrupt)
"""
STARTS = {
    "module": "import runpy; runpy.run_module('lagrange_cli', run_name='__main__')",
    "script": "from lagrange_cli.__main__ import main; main()",
}


@pytest.mark.slow
@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize(
    "module",
    [
        "click",
        "lagrange_cli.cli.app",
        "lagrange_cli.cli.options",
        "lagrange_cli.cli.solve",
        "lagrange_cli.output.report",
        "rich.console",
        "numpy",
    ],
)
def test_ctrl_c_while_modules_are_imported(start: str, module: str) -> None:
    code = f"{INTERRUPT_AT_IMPORT}\n{STARTS[start]}"
    name = "table" if module == "numpy" else "solve"
    command = [sys.executable, "-c", code, module, "lagtop", name]
    done = subprocess.run(command, capture_output=True, check=False)
    assert (done.returncode, done.stderr, done.stdout) == (-signal.SIGINT, b"", b"")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["HUP", "INT", "TERM"])
def test_a_signal_that_is_ignored_at_the_start_stays_ignored(name: str, tmp_path: Path) -> None:
    """The command `nohup` does that with SIGHUP, and a shell with SIGINT of a job with &."""
    target = tmp_path / "out.csv"
    line = f"trap '' {name}; exec \"$@\""
    command = ["bash", "-c", line, "_", *LAGTOP, "table", "--n", "1e6", "-o", str(target)]
    with subprocess.Popen(command, stderr=subprocess.PIPE) as running:
        wait_for_a_file(tmp_path)
        running.send_signal(getattr(signal, f"SIG{name}"))
        assert running.communicate(timeout=60)[1] == b""
    assert running.returncode == 0
    assert target.read_bytes().count(b"\n") == 1_000_001
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("nofile/", "cannot write nofile/: Is a directory"),
        ("folder", "cannot write folder: Is a directory"),
        ("folder/", "cannot write folder/: Is a directory"),
        ("loop", "cannot write loop: Too many levels of symbolic links"),
        ("", "cannot write '': No such file or directory"),
        ("none/x", "cannot write none/x: No such file or directory"),
        ("file/x", "cannot write file/x: Not a directory"),
    ],
)
def test_places_that_a_shell_refuses(
    path: str, message: str, tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    before = sorted(tmp_path.rglob("*"))
    assert_one_line(lagtop("solve", "-o", path), 74, message)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_link_to_nothing_makes_its_target(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("target")
    process("solve", "-o", "link", cwd=tmp_path)
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_bytes() == process("solve").stdout


def test_new_content_does_not_inherit_the_right_of_another_user(tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    target.touch()
    target.chmod(0o4755)
    process("solve", "-o", str(target))
    assert target.stat().st_mode & 0o7777 == 0o755


WITHOUT_WHAT_WINDOWS_LACKS = """if True:
    import _signal, os, signal, stat, sys
    for name in ("SIGHUP", "SIGPIPE", "SIGALRM", "SIGUSR1", "SIGUSR2", "SIGQUIT", "SIGKILL",
                 "SIGCHLD", "SIGSTOP", "SIGCONT", "SIGXFSZ", "alarm", "pthread_sigmask",
                 "pthread_kill", "siginterrupt", "sigwait", "setitimer"):
        delattr(signal, name)
        delattr(_signal, name)
    for name in ("fchmod", "fchown", "chown", "mkfifo", "fork", "forkpty", "openpty", "getuid",
                 "geteuid", "getpgid", "setsid", "killpg", "sysconf", "statvfs",
                 "O_DIRECTORY", "O_NOFOLLOW", "O_NONBLOCK", "getloadavg", "sched_getaffinity"):
        delattr(os, name)
    sync = os.fsync

    def fsync(descriptor):
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            raise PermissionError(13, "Permission denied")
        sync(descriptor)

    os.fsync = fsync
    from lagrange_cli.__main__ import main
    sys.argv = ["lagtop", *sys.argv[1:]]
    main()
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "line",
    [
        "--help",
        "solve",
        "solve --format json -o solved.json",
        "solve --theta0 60 --digits 30",
        "table --n 5 -o table.csv",
        "table --times times.txt --columns t,axis",
        "sweep --r0 1:9:9 --parts parts",
        "sweep tops.csv --keys r0,error",
        "jacobi --k 0.5 --u 1",
        "eta --delta 0.5 --delta-star -0.5 --p 2 --q 1 --g 1 --tau 1",
        "plot -o top.png",
        "view -o top.html",
        "bench --n 3 --t-max 1 --methods lagtop,theta-series",
    ],
)
def test_commands_run_without_features_that_windows_lacks(line: str, tmp_path: Path) -> None:
    (tmp_path / "times.txt").write_text("1\n")
    (tmp_path / "tops.csv").write_text("r0\n1\n")
    (tmp_path / "solved.json").write_text("old")
    command = [sys.executable, "-c", WITHOUT_WHAT_WINDOWS_LACKS, *line.split()]
    done = subprocess.run(command, capture_output=True, check=False, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, b"")
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".lagtop")]


def test_a_reader_that_went_away_where_there_is_no_sigpipe() -> None:
    command = [sys.executable, "-c", WITHOUT_WHAT_WINDOWS_LACKS, "table", "--n", "1e6"]
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, check=False)
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, b"")


# what is echoed

HOSTILE = "a\x1b[31m\x9b\x7f\u202e\u2066\u200b\udcff.csv"


ECHOING = [
    "solve {}.toml",
    "solve {}",
    "table --times {}",
    "table --tops {}",
    "table --columns {}",
    "solve -o nowhere/{}",
    "sweep {}",
    "sweep --shard {}",
    "sweep --dask {}",
    "sweep --parts file/{}",
    "jacobi --k 0.5 --u 1 --functions pi --param {}",
    "jacobi {}",
    "plot {}",
    "view {}",
    "plot -o {}",
    "bench --methods {}",
    "stability --strata {}",
    "{}",
    "solve --{}",
    "solve --r0 {}",
    "solve --format {}",
]


@pytest.mark.slow
def test_control_characters_of_names_do_not_reach_the_terminal(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    echoing = [line.replace("{}", HOSTILE).replace(" file/", " ../file/") for line in ECHOING]
    for line, end in zip(echoing, forked(echoing, tmp_path), strict=True):
        shown = end.stderr.decode()
        assert (end.code != 0, end.stdout) == (True, b""), ascii(line)
        assert shown.endswith("\n"), ascii(line)
        assert shown[:-1].isprintable(), ascii(shown)


def test_control_characters_of_data_do_not_reach_the_terminal_but_pass_as_data() -> None:
    raw = b'{"id": "\xc2\x9b31m", "r0": "\xc2\x9b31m\xe2\x80\xae\x7f"}\n'
    done = process("sweep", "-", "--keys", "r0", check=False, input=raw)
    assert done.returncode == 1
    assert done.stderr.decode()[:-1].isprintable()
    assert "\\x9b31m\\u202e\\x7f" in done.stderr.decode()
    assert "\x9b31m".encode() in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("digits", [10, 900_000])
def test_lines_of_errors_are_bounded(digits: int, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(f"m = 1.{'7' * digits}\nr = 3\n")
    shown = process("solve", str(path), check=False).stderr.decode()
    assert len(shown) <= 1002
    assert shown.startswith("Error: ")
    long = process("solve", "--r0", "x" * 50_000, check=False).stderr.decode()
    assert len(long) <= 1002
    missing = process("solve", "y" * 1000 + ".toml", check=False).stderr.decode()
    assert "characters ...]" in missing
    assert missing.startswith("Error: yyy")
    assert missing.endswith("File name too long\n")
