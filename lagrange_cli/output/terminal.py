"""The terminal: texts that do not control it, its width, and a line of progress."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from time import monotonic
from typing import TextIO, TypeVar

Item = TypeVar("Item")
MOST_CHARACTERS = 1000
"""The largest length of a message; longer messages are shortened."""
DELAY = 1.0
"""Seconds of work before the line of progress appears."""


def printable(text: str, kept: str = "\n") -> str:
    """Return a text whose characters that control a terminal are escapes, except the `kept` ones.

    Marks that change the direction of writing are among them.
    """
    if text.isprintable():
        return text
    return "".join(
        x if x.isprintable() or x in kept else x.encode("unicode_escape").decode() for x in text
    )


def one_line(text: str) -> str:
    """Return a text as one printable line, with the middle left out of a long one."""
    line = printable(" ".join(x.strip() for x in text.strip().split("\n")), "")
    if len(line) <= MOST_CHARACTERS:
        return line
    half = (MOST_CHARACTERS - 40) // 2
    return f"{line[:half]} [... {len(line) - 2 * half} characters ...] {line[-half:]}"


def is_terminal(stream: TextIO | None) -> bool:
    """Return whether a standard stream is a terminal; a closed stream is None."""
    return stream is not None and stream.isatty()


def is_screen(path: str) -> bool:
    """Return whether the output to a path, or to standard output for `-`, is on a terminal."""
    return path == "-" and is_terminal(sys.stdout)


def width_of(path: str) -> int | None:
    """Return the columns of the terminal, or None if the output is a file or a pipe."""
    if not is_screen(path):
        return None
    from shutil import get_terminal_size

    return get_terminal_size().columns


def with_progress(
    parts: Iterable[Item],
    label: str,
    total: int | None = None,
    size: Callable[[Item], int] = lambda _: 1,
) -> Iterator[Item]:
    """Yield the parts as they arrive, with a line on standard error if it is a terminal.

    `size` gives the items of a part, and `total` the items of all parts, by default their sum if
    the parts are a sequence.  The line appears after a second, and is removed while a part is
    written and at the end.
    """
    if not is_terminal(sys.stderr):
        yield from parts
        return
    if total is None and isinstance(parts, Sequence):
        total = sum(map(size, parts))
    start, done, shown = monotonic(), 0, ""
    try:
        for part in parts:
            shown = _replace(shown, "")
            yield part
            done += size(part)
            if monotonic() - start > DELAY:
                count = f"{100 * done // total} %" if total else f"{done:,} done"
                shown = _replace(shown, f"{label}: {count}")
    finally:
        _replace(shown, "")


@contextmanager
def waiting(text: str) -> Iterator[None]:
    """Show a line on standard error, if it is a terminal, while the block runs."""
    shown = _replace("", text) if is_terminal(sys.stderr) else ""
    try:
        yield
    finally:
        _replace(shown, "")


def _replace(shown: str, line: str) -> str:
    """Replace the line of progress, and return the new one."""
    if shown or line:
        print(f"\r{' ' * len(shown)}\r{line}", end="", file=sys.stderr, flush=True)
    return line
