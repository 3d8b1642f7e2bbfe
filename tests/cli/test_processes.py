"""Behaviour that only a separate process can show: modules loaded, streams, signals, terminals."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete
from conftest import LAGTOP, ROOT, Lagtop, process, shell, wait_until

from lagrange_cli.cli.app import NAMES, main
from lagrange_cli.cli.app import NAMES as COMMANDS

HEAVY = {"distributed", "pyarrow", "numpy", "scipy", "mpmath", "rich", "matplotlib"}
LOADED = {
    "solve --format json": set(),
    "solve --format csv --rad --theta0 1": set(),
    "solve --get T_nutation": set(),
    **{f"{name} --help": set() for name in COMMANDS},
    "view -o -": set(),
    "solve": {"rich"},
    "table": {"numpy"},
    "sweep --r0 1:2:3": {"numpy", "scipy"},
    "sweep --r0 1:2:3 --keys K,mean_precession_rate": {"numpy"},
    "find --r0 40:60 T_nutation=0.4 --format csv": {"numpy"},
    "jacobi --k 0.8 --format json": set(),
    "eta --delta 0.6 --delta-star -0.5 --p 0.1 --q 1.4 --format json": set(),
}
"""Command lines, and the heavy packages that each needs."""
LINES = {
    "": "",  # the help
    "solve": "solve --format json",
    "table": "table --n 5",
    "sweep": "sweep --r0 1:9:5",
    "find": "find --r0 10:200 T_precession=2",
    "fit": f"fit {ROOT}/sample_inputs/recording.csv --format csv",
    "compare": f"compare {ROOT}/sample_inputs/files/mujoco.txt --max-error 9 --format csv",
    "plot": "plot sphere -o -",
    "view": "view -o -",
    "jacobi": "jacobi --k 0.8 --u 1",
    "eta": "eta --delta 0.6 --delta-star -0.5 --p 0.1 --q 1.4",
    "bench": "bench --n 3 --methods lagtop --format csv",
    "explain": "explain",
    "scenes": "scenes",
    "stability": "stability --kinds slow-spin --samples 1 --format csv",
}
"""A line of each command."""
HOSTILE = "a\x1b[31m\x9b\x7f\u202e\u2066\u200b\udcff.csv"
ECHOING = [
    *("solve {}.toml", "solve {}", "solve --{}", "solve --r0 {}", "solve --format {}", "{}"),
    *("table --times {}", "table --columns {}", "solve -o nowhere/{}", "sweep {}", "plot -o {}"),
    *("jacobi --k 0.5 --u 1 --functions pi --param {}", "jacobi {}", "plot {}", "view {}"),
    *("sweep --shard {}", "sweep --dask {}", "bench --methods {}", "compare {}", "fit {}"),
]


def started_with(code: str, line: str, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run a command in a process that runs some code first."""
    start = "\nfrom lagrange_cli.__main__ import main\nmain()"
    command = [sys.executable, "-c", textwrap.dedent(code) + start, *line.split()]
    return subprocess.run(command, capture_output=True, check=False, cwd=folder, text=True)


def test_a_crash_asks_for_a_report() -> None:
    broken = "import lagrange_cli.cli.solve as it; it.record_document = lambda *_: 1 / 0"
    ended = started_with(broken, "solve")
    assert (ended.returncode, ended.stdout) == (70, "")
    text = "Error: this is a bug, please report it with your command: ZeroDivisionError in solve.py"
    assert ended.stderr.startswith(text)
    assert ended.stderr.count("\n") == 1


def test_packages_that_are_not_installed(tmp_path: Path) -> None:
    (tmp_path / "a.parquet").write_bytes(b"PAR1")
    lines = {
        "plot cubic -o -": "plot",
        "bench --n 3 --methods lagtop --plot a.svg": "plot",
        "sweep --r0 1,2 -o b.parquet": "parquet",
        "compare a.parquet": "parquet",
        "sweep --r0 1,2 --dask tcp://127.0.0.1:9": "cluster",
    }
    code = f"""
        import sys
        from click.testing import CliRunner
        from lagrange_cli.cli.app import main
        sys.modules |= dict.fromkeys(["matplotlib", "pyarrow", "distributed"])
        for line in {list(lines)}:
            done = CliRunner().invoke(main, line.split())
            print(done.exit_code, repr(done.stdout), done.stderr, end="")
        raise SystemExit
    """
    for said, extra in zip(
        started_with(code, "", tmp_path).stdout.splitlines(), lines.values(), strict=True
    ):
        assert said.startswith("69 '' Error: ")
        assert said.endswith(f": pip install '.[{extra}]' in the folder of lagtop")


@pytest.mark.parametrize("count", [1, pytest.param(None, marks=pytest.mark.slow)])
def test_only_needed_packages_are_loaded(count: int | None) -> None:
    listing = "import atexit, sys; atexit.register(lambda: print(*sys.modules, file=sys.stderr))"
    for line in [*LOADED][:count]:
        end = started_with(listing, line)
        assert end.returncode == 0
        names = {name.partition(".")[0] for name in end.stderr.split()}
        assert names & HEAVY == LOADED[line], line


# streams


@pytest.mark.parametrize(
    "name",
    [pytest.param(x, marks=[] if x == "solve" else pytest.mark.slow) for x in ["", *COMMANDS]],
)
def test_streams_of_every_command(name: str) -> None:
    """Each stream is closed or full, or its reader leaves."""
    assert LINES.keys() == {"", *COMMANDS}
    line = LINES[name]
    whole = shell(f"lagtop {line}")
    assert whole.returncode == 0, whole.stderr
    for where, why in ((">&-", "it is closed"), ("> /dev/full", "No space left on device")):
        refused = shell(f"lagtop {line} {where}")
        said = f"Error: cannot write standard output: {why}"
        assert (refused.returncode, refused.stderr.decode().splitlines()[-1]) == (74, said)
    for where in ("2>&- <&-", "2>/dev/full"):
        done = shell(f"lagtop {line} {where}")
        assert done.returncode == 0, where
        assert done.stdout.count(b"\n") == whole.stdout.count(b"\n") > 0  # it may hold run times
    early = shell(f"lagtop {line} | head -c 1; echo ${{PIPESTATUS[0]}}")
    assert early.stdout[1:] in (b"0\n", b"141\n")
    assert b"Error" not in early.stderr


@pytest.mark.slow
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_long_output(unbuffered: str, tmp_path: Path) -> None:
    """A reader that leaves, a slow one that gets all, and a disk that is full in the middle."""
    line = "lagtop table --n 200000 | head -3; echo ${PIPESTATUS[0]}"
    ended = shell(line, PYTHONUNBUFFERED=unbuffered)
    assert (ended.stdout.split()[-1], ended.stderr) == (b"141", b"")
    line = "lagtop table --n 20000 | (sleep 0.5; cat) | wc -l"
    assert shell(line, PYTHONUNBUFFERED=unbuffered).stdout.strip() == b"20001"
    target = tmp_path / "out.csv"
    target.write_text("old")
    line = f"ulimit -f 64; trap '' XFSZ; lagtop table --n 100000 -o {target}"
    full = shell(line, PYTHONUNBUFFERED=unbuffered)
    said = f"Error: cannot write {target}: File too large\n"
    assert (full.returncode, full.stderr.decode()) == (74, said)
    assert (target.read_text(), os.listdir(tmp_path)) == ("old", ["out.csv"])


@pytest.mark.parametrize("line", ["table -", "sweep -", "compare -", "table --times -"])
def test_closed_standard_input(line: str) -> None:
    done = shell(f"lagtop {line} <&-")
    said = "Error: standard input: it is closed: give a file in place of -\n"
    assert (done.returncode, done.stdout, done.stderr.decode()) == (65, b"", said)


def test_too_little_memory_for_numpy_and_scipy() -> None:
    """OpenBLAS may wait for it without end, and then no signal but SIGKILL stops the program."""
    for size, name in ((90000, b"numpy needs 100"), (180000, b"scipy needs 200")):
        done = shell(f"ulimit -v {size}; lagtop sweep")
        assert (done.returncode, done.stdout) == (69, b"")
        assert done.stderr == b"Error: out of memory: " + name + b" MB\n"
    assert shell("ulimit -v 90000; lagtop sweep --help").returncode == 0


def test_closed_standard_error_and_a_file(tmp_path: Path) -> None:
    """No file that is opened later becomes standard error: messages are lost."""
    assert shell(f"lagtop sweep --r0 40,x -o {tmp_path}/out.csv 2>&-").returncode == 2
    assert os.listdir(tmp_path) == []


@pytest.mark.slow
def test_memory_does_not_grow_with_the_rows() -> None:
    code = """
        import atexit, sys
        atexit.register(lambda: sys.stderr.write(open("/proc/self/status").read()))
    """
    used = []
    for count in ("1e5", "1e6"):
        status = started_with(code, f"table --n {count} -o /dev/null").stderr
        used.append(int(status.partition("VmHWM:")[2].split()[0]) / 1024)
    assert used[1] < min(200, used[0] + 10)


# signals and the environment


def heed_signals() -> None:
    """Undo what `nohup` and `&` do to a run of the tests, and to the commands that it starts."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGQUIT, signal.SIG_DFL)


def started(*options: str, folder: Path, before: str = "") -> subprocess.Popen[bytes]:
    """Start `lagtop table` with a file as output, and wait until it writes."""
    command = [*LAGTOP, "table", *options, "-o", str(folder / "out.csv")]
    line = f'{before} exec "$@"'
    heed_signals()
    running = subprocess.Popen(["bash", "-c", line, "_", *command], stderr=subprocess.PIPE)
    wait_until(lambda: any(folder.glob(".lagtop*")), running)
    return running


@pytest.mark.parametrize(
    ("names", "code"),
    [("INT", -2), ("TERM", 143), ("HUP", 129), ("QUIT", 131), ("INT INT INT INT", -2)],
)
def test_signals_end_a_command_that_cleans_up(names: str, code: int, tmp_path: Path) -> None:
    (tmp_path / "out.csv").write_text("old")
    running = started("--n", "1e9", folder=tmp_path)
    for name in names.split():
        running.send_signal(getattr(signal, f"SIG{name}"))
    assert running.communicate(timeout=30)[1] == b""
    assert running.returncode == code
    assert ((tmp_path / "out.csv").read_text(), os.listdir(tmp_path)) == ("old", ["out.csv"])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["HUP", "INT", "TERM"])
def test_a_signal_that_is_ignored_at_the_start_stays_ignored(name: str, tmp_path: Path) -> None:
    """The command `nohup` does that with HUP, and a shell with INT of a job with &."""
    running = started("--n", "1e6", folder=tmp_path, before=f"trap '' {name};")
    running.send_signal(getattr(signal, f"SIG{name}"))
    assert running.communicate(timeout=60)[1] == b""
    assert running.returncode == 0
    assert (tmp_path / "out.csv").read_bytes().count(b"\n") == 1_000_001


AT_IMPORTS = {
    **dict.fromkeys(("click", "lagrange_cli.cli.app", "numpy"), "signal.raise_signal(number)"),
    # another error takes the place of the exception, as in flint if it cannot import zlib
    "flint": "try: signal.raise_signal(number)\nexcept BaseException: raise ImportError",
    # Python ignores the exceptions of callbacks
    "flint.pyflint": "it = set(); weak = weakref.ref(it, lambda _: signal.raise_signal(number))\n"
    "del it; time.sleep(0.5)",
}
"""Modules, and what is done when they are imported."""


@pytest.mark.slow
@pytest.mark.parametrize("module", AT_IMPORTS)
@pytest.mark.parametrize(("name", "wanted"), [("INT", {-2}), ("TERM", {-15, 143})])
def test_signals_while_modules_are_imported(name: str, wanted: set[int], module: str) -> None:
    code = f"""
        import signal, sys, time, weakref
        number = signal.SIG{name}

        class Signalling:
            def find_spec(name, *_):
                if name == {module!r}:
                    exec({AT_IMPORTS[module]!r}, globals())

        sys.meta_path.insert(0, Signalling)
    """
    done = started_with(code, "table")
    assert (done.stderr, done.stdout) == ("", "")
    assert done.returncode in wanted


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "line", "code", "said"),
    [
        ("MPLBACKEND=nonsense", "plot -o {}/a.png", 69, "'nonsense' is not a valid value"),
        ("SOURCE_DATE_EPOCH=abc", "plot -o {}/a.pdf", 69, "of the year 9999), got 'abc'"),
        ("SOURCE_DATE_EPOCH=", "bench --n 3", 69, "of the year 9999), got ''"),
        ("SOURCE_DATE_EPOCH=253402300800", "solve", 69, "up to 253402300799"),
        ("_LAGTOP_COMPLETE=bash_complete", "", 2, "_LAGTOP_COMPLETE needs"),
        ("_LAGTOP_COMPLETE=x", "", 2, "_LAGTOP_COMPLETE must be such as bash_source, got 'x'"),
        ("BROWSER=/nonexistent", "view --open", 69, "--open found no browser"),
    ],
)
def test_bad_surroundings_end_in_one_line(
    settings: str, line: str, code: int, said: str, tmp_path: Path
) -> None:
    done = shell(f"{settings} lagtop {line.format(tmp_path)}")
    assert (done.returncode, done.stdout, os.listdir(tmp_path)) == (code, b"", [])
    assert said in done.stderr.decode()
    assert done.stderr.count(b"\n") == 1


@pytest.mark.slow
def test_a_folder_of_modules_is_not_imported(tmp_path: Path) -> None:
    names = "numpy click json rich orjson signal sitecustomize scipy pickle socket selectors "
    names += "tempfile logging random struct lagrange_cli"
    for name in names.split():
        (tmp_path / f"{name}.py").write_text(f"open('RAN-{name}', 'w')\nraise SystemExit")
    script = Path(sys.executable).with_name("lagtop")
    sweep = "sweep --r0 1:9:20000 --jobs 2 --keys r0"
    for line in ("solve", "table --n 3", sweep, "plot sphere -o x.svg"):
        done = subprocess.run(
            [script, *line.split()], capture_output=True, check=False, cwd=tmp_path
        )
        assert (done.returncode, done.stderr) == (0, b""), line
    assert not [*tmp_path.glob("RAN-*")]


# terminals


def test_control_characters_of_names_do_not_reach_the_terminal(lagtop: Lagtop) -> None:
    for line in ECHOING:
        ended = lagtop(*line.replace("{}", HOSTILE).split())
        assert ended.exit_code != 0, ascii(line)
        assert ended.stdout == "", ascii(line)
        assert ended.stderr.endswith("\n"), ascii(line)
        assert ended.stderr[:-1].isprintable(), ascii(ended.stderr)


def on_terminal(line: str, code: int = 0, **extra: str) -> str:
    """Return what a command writes to a terminal of 80 columns."""
    terminal, child = os.openpty()
    environment = {x: y for x, y in os.environ.items() if x != "COLUMNS"} | {"TERM": "xterm"}
    with subprocess.Popen(
        [*LAGTOP, *line.split()], stdin=child, stdout=child, stderr=child, env=environment | extra
    ) as running:
        os.close(child)
        written = b""
        try:
            while chunk := os.read(terminal, 65536):
                written += chunk
        except OSError:  # nobody has the terminal open any more
            pass
    os.close(terminal)
    assert running.returncode == code, written
    return written.decode()


def test_headings_are_bold_on_a_terminal() -> None:
    assert "\x1b[1m" in on_terminal("solve")
    assert "\x1b" not in on_terminal("solve", TERM="dumb")


@pytest.mark.slow
def test_data_on_a_terminal(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_bytes(b"id,r0\n\x1b]0;evil\x07\x1b[31mred,40\n")
    assert "\u2500" in on_terminal("sweep --r0 40:50:3 --keys theta0_deg,T_nutation")
    shown = on_terminal(f"sweep {tmp_path}/x.csv --keys theta0_deg,T_nutation", TERM="dumb")
    assert "\\x1b]0;evil\\x07\\x1b[31mred" in shown
    assert "\x1b" not in shown
    refused = on_terminal("table --t-max 1 --n 3 --format parquet", 2)
    assert "is not for a terminal: use -o FILE.parquet" in refused


@pytest.mark.parametrize(
    ("line", "completed"),
    [("so", ["solve"]), ("solve simo", ["simo-wong-1991"]), ("plot scene", ["scene"])],
)
def test_completion(line: str, completed: list[str]) -> None:
    words = line.split()
    items = ShellComplete(main, {}, "lagtop", "_X").get_completions(words[:-1], words[-1])
    assert [item.value for item in items] == completed


def test_bash_gets_completions() -> None:
    asked = {"_LAGTOP_COMPLETE": "bash_complete", "COMP_WORDS": "lagtop so", "COMP_CWORD": "1"}
    assert b"solve" in process(env=os.environ | asked).stdout


# The examples of every --help run in an empty folder, one after the other


QUICK = ("solve", "scenes")


@pytest.mark.parametrize(
    "name",
    [pytest.param(x, marks=[] if x in QUICK else [pytest.mark.slow]) for x in ["", *NAMES]],
)
def test_examples_run_in_an_empty_folder(name: str, lagtop: Lagtop, tmp_path: Path) -> None:
    shown = lagtop(*name.split(), "--help").stdout
    examples = shown.partition("Examples:\n")[2].partition("\n\n")[0].splitlines()
    assert len(examples) >= 3
    for line in examples:
        before = [*tmp_path.iterdir()]
        done = shell(f"set -e -o pipefail\n{line}", tmp_path)
        assert done.returncode == 0, (line, done.stderr.decode())
        assert b"Error" not in done.stderr or line.endswith("|| true")
        assert done.stdout or [path for path in tmp_path.iterdir() if path not in before], line
