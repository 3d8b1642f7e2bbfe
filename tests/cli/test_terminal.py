"""What a terminal shows: one line of progress that vanishes, and tables that fit."""

from __future__ import annotations

import fcntl
import os
import re
import struct
import subprocess
import sys
import termios
from collections.abc import Iterator

import pytest

ESCAPE = re.compile("\x1b\\[[?]?([0-9;]*)([A-Za-z])|([\r\n])|([^\x1b\r\n]+)")
IMPATIENT = """if True:
    import sys
    from lagrange_cli.__main__ import main
    from lagrange_cli.cli import progress
    progress.DELAY = 0.0
    main()
"""


def on_terminal(columns: int, line: str, *, only_errors: bool = False, code: str = "") -> str:
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
    assert running.returncode == 0, written
    return written.decode()


def chunks(terminal: int) -> Iterator[bytes]:
    """Yield what is written until nobody has the terminal open any more."""
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
    "jacobi --k 0.5 --u-range 0:1:100000 --format csv -o /dev/null",
]


@pytest.mark.slow
@pytest.mark.parametrize("line", LONG, ids=lambda line: line[:25])
def test_progress_is_one_line_that_vanishes(line: str) -> None:
    columns = 60
    text = on_terminal(columns, line, only_errors=True, code=IMPATIENT)
    shown = list(screens(text, columns))
    assert any("%" in x or "done" in x for lines in shown for x in lines), "no progress"
    for lines in shown:
        assert sum(x != "" for x in lines) <= 1, lines
    assert not any(shown[-1])
    assert text.count("\x1b[?25l") == text.count("\x1b[?25h") > 0  # the cursor is back
