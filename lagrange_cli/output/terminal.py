"""What a terminal is safe to show, how wide it is, and who else writes to it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext

MOST_CHARACTERS = 1000
"""The length of a line that is still read."""


def one_line(text: str, most: int = MOST_CHARACTERS) -> str:
    """Return a text as one line of printable characters, with the middle left out of a long one.

    Control characters, marks that change the direction of writing and the like come out as escapes,
    such as `\\x1b`: a file name or a datum may hold any of them, and a terminal would obey.
    """
    words = " ".join(text.split())
    line = "".join(x if x.isprintable() else x.encode("unicode_escape").decode() for x in words)
    if len(line) <= most:
        return line
    half = (most - 40) // 2
    return f"{line[:half]} [... {len(line) - 2 * half} characters ...] {line[-half:]}"


def is_terminal(path: str) -> bool:
    """Return whether output to this path (`-` is standard output) goes to a terminal."""
    return path == "-" and sys.stdout is not None and sys.stdout.isatty()


def width(path: str) -> int | None:
    """Return the columns of the terminal that the output goes to; None where it goes elsewhere.

    The variable COLUMNS wins over what the terminal says.
    """
    if not is_terminal(path):
        return None
    from shutil import get_terminal_size

    return get_terminal_size().columns


def encoding(path: str) -> str:
    """Return the encoding of the text that is written to this path."""
    return (path == "-" and getattr(sys.stdout, "encoding", None)) or "utf-8"


class Screen:
    """The terminal of the process, which output may share with a line of progress."""

    without_progress: Callable[[], AbstractContextManager[None]] = nullcontext
    """Takes the line of progress, if any, away while others write."""
