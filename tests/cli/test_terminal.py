"""Output on a terminal: one line of progress that vanishes, and tables that fit."""

from __future__ import annotations

import fcntl
import os
import re
import struct
import subprocess
import sys
import termios
import threading
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import Lagtop
from lagtop import Top, solve

from lagrange_cli.motion.record import shown_keys
from lagrange_cli.output.report import Field, Report, record_text
from lagrange_cli.output.terminal import View, view_of, with_progress

ESCAPE = re.compile("\x1b\\[[?]?([0-9;]*)([A-Za-z])|([\r\n])|([^\x1b\r\n]+)")
IMPATIENT = """if True:
    import sys
    from lagrange_cli.__main__ import main
    from lagrange_cli.output import terminal
    terminal.DELAY = 0.0
    main()
"""


def on_terminal(
    columns: int, line: str, *, only_errors: bool = False, code: str = "", exit_code: int = 0
) -> str:
    """Return what a command writes to a terminal that is so wide, or what only its errors do."""
    terminal, child = os.openpty()
    fcntl.ioctl(child, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    start = ["-c", code] if code else ["-m", "lagrange_cli"]
    environment = {key: x for key, x in os.environ.items() if key != "COLUMNS"} | {"TERM": "xterm"}
    with subprocess.Popen(
        [sys.executable, *start, *line.split()],
        stdin=child,
        stdout=subprocess.DEVNULL if only_errors else child,
        stderr=child,
        env=environment,
    ) as running:
        os.close(child)
        written = b"".join(chunks(terminal))
    os.close(terminal)
    assert running.returncode == exit_code, written
    return written.decode()


def chunks(terminal: int) -> Iterator[bytes]:
    """Yield the output until no process has the terminal open."""
    try:
        while chunk := os.read(terminal, 65536):
            yield chunk
    except OSError:
        return


def screens(text: str, columns: int) -> Iterator[list[str]]:
    """Yield the lines of the screen after every line end, as a terminal so wide shows them."""
    lines, row, column = [""], 0, 0
    for number, letter, end, plain in ESCAPE.findall(text):
        if letter == "A":
            row -= int(number or 1)
        elif letter == "K":
            lines[row] = ""
        elif end == "\r":
            column = 0
        elif end == "\n":
            row += 1
        for character in plain:
            if column == columns:
                row, column = row + 1, 0
            lines += [""] * (row + 1 - len(lines))
            lines[row] = lines[row][:column].ljust(column) + character + lines[row][column + 1 :]
            column += 1
        lines += [""] * (row + 1 - len(lines))
        yield list(lines)


ETA = "eta --delta 0.6 --delta-star -0.5 --p 0.1 --q 1.4"
LONG = [
    "table --n 100000 -o /dev/null",
    "table --n 300 --digits 30 -o /dev/null",
    "sweep --r0 1:9:100000 --keys K -o /dev/null",
    "jacobi --k 0.5 --u 0:1:100000 --format csv -o /dev/null",
    "jacobi --k 0.5 --u 0:1:40 --digits 50 -o /dev/null",
    f"{ETA} --tau 0:3:30 --digits 50 -o /dev/null",
    "table --tops {tops} --n 100 -o /dev/null",
]


@pytest.mark.slow
@pytest.mark.parametrize("line", LONG, ids=lambda line: line[:25])
def test_progress_is_one_line_that_vanishes(line: str, tmp_path: Path) -> None:
    columns = 60
    (tmp_path / "tops.csv").write_text("r0\n" + "50\n" * 200)
    line = line.replace("{tops}", str(tmp_path / "tops.csv"))
    text = on_terminal(columns, line, only_errors=True, code=IMPATIENT)
    shown = list(screens(text, columns))
    assert any("%" in x or "done" in x for lines in shown for x in lines), "no progress"
    for lines in shown:
        assert sum(x != "" for x in lines) <= 1, lines
    assert not any(shown[-1])
    assert text.count("\x1b[?25l") == text.count("\x1b[?25h") > 0  # the cursor is back


def test_a_command_that_fails_leaves_no_line_of_progress(
    lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("lagrange_cli.output.terminal.sys.stderr.isatty", lambda: True)
        parts = with_progress([1, 2], "rows")
        next(parts)
    waiting = threading.active_count()
    assert lagtop("solve", "--m", "-1").exit_code == 2
    assert threading.active_count() == waiting - 1


WIDE = [
    "solve",
    "solve --theta0 0",
    "solve --digits 40 --theta0 60",
    "solve --digits 300",
    "solve --rad --r0 1e-100",
    "table --n 3 --format table",
    "table --n 3 --columns t,axis,quaternion,energy --format table",
    "table --n 3 --digits 90 --format table",
    "jacobi --k 0.5 --u 0:1:3 --functions am,theta,zeta",
    "jacobi --k 0.5 --digits 70",
    f"{ETA} --digits 60",
    f"{ETA} --tau 1 --digits 60",
]


@pytest.mark.slow
@pytest.mark.parametrize("columns", [80, 64])
@pytest.mark.parametrize("line", WIDE)
def test_tables_fit_the_terminal_and_lose_no_digit(line: str, columns: int) -> None:
    bare = re.sub("\x1b\\[[0-9;]*m", "", on_terminal(columns, line))
    assert max(map(len, bare.splitlines())) <= columns
    command = [sys.executable, "-m", "lagrange_cli", *line.split()]
    piped = subprocess.run(command, capture_output=True, check=True).stdout.decode()
    numbers = re.findall(r"\d[\d.]{9,}(?:e[-+]?\d+)?", piped)
    together = "".join(bare.split())
    assert numbers
    assert [number for number in numbers if number not in together] == []


@pytest.mark.parametrize("setting", [{}, {"NO_COLOR": "1"}, {"TERM": "dumb"}])
def test_colours_mean_something_and_can_be_left_out(
    setting: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Inputs are cyan, results green, warnings yellow; without colours there are no codes."""
    for name in ("NO_COLOR", "TERM"):
        monkeypatch.delenv(name, raising=False)
    for name, value in setting.items():
        monkeypatch.setenv(name, value)
    with monkeypatch.context() as patch:
        patch.setattr("lagrange_cli.output.terminal.sys.stdout.isatty", lambda: True)
        view = view_of("-")
    record = solve(Top(theta0_deg=0)).record()
    for width in (view.width, 40):
        shown = record_text(record, shown_keys(), "table", view.replace(width=width))
        text = shown.decode()
        if setting:
            assert "\x1b" not in text
            continue
        assert re.search(r"\x1b\[36m *\n?39032.0\x1b", text)
        assert re.search(r"\x1b\[32m *\n?sleeping\x1b", text)
        assert "\x1b[33m" + record["remark"][:20] in text


@pytest.mark.slow
def test_a_wide_terminal_changes_nothing_but_letters() -> None:
    for line in ("solve", "table --n 3 --columns t,axis --format table"):
        command = [sys.executable, "-m", "lagrange_cli", *line.split()]
        piped = subprocess.run(command, capture_output=True, check=True).stdout.decode()
        shown = re.sub("\x1b\\[[0-9;]*m", "", on_terminal(200, line)).replace("\r", "")
        table = piped.split("\n\n")[-1]  # the sentence of solve is wrapped otherwise
        assert "\n".join(x.rstrip() for x in shown.splitlines()).endswith(table.rstrip())


def test_the_variable_columns_wins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lagrange_cli.output.terminal.sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "61")
    assert view_of("-").width == 61
    assert view_of("file").width is None


def test_reports_fold_with_the_names_of_their_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    fields = [
        Field("method", "method", is_text=True, names_the_row=True),
        *(Field(key, key * 8) for key in "abcdef"),
    ]
    rows = [SimpleNamespace(method=name, **dict.fromkeys("abcdef", 1.5)) for name in ("x", "y")]
    report = Report({"machine": "word " * 30}, fields, rows, ["word " * 30])
    text = report.text("table", View(40, True)).decode()
    plain = re.sub("\x1b\\[[0-9;]*m", "", text)
    assert max(map(len, plain.splitlines())) <= 40
    assert plain.count("method") == 2
    assert plain.count("1.5") == 12
    wide = report.text("table", View()).decode()
    assert wide.count("method") == 1


@pytest.mark.parametrize("form", ["npy", "parquet"])
def test_binary_formats_are_not_written_to_a_terminal(form: str) -> None:
    shown = on_terminal(80, f"table --t-max 1 --n 3 --format {form}", exit_code=2)
    assert "is not for a terminal: use -o FILE." in shown
    assert "NUMPY" not in shown


def test_few_rows_are_a_table_on_a_terminal() -> None:
    shown = on_terminal(80, "sweep --theta0 30,40 --keys theta0_deg,T_nutation")
    assert "T_nutation [time]" in shown or "\u2500" in shown
    assert "," not in shown
