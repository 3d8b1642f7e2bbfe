"""The terminal: its width, its letters and colours, and a line of progress.

A text that is shown must not control the terminal.

Functions with progress pass on the parts of long work.  The line of standard error vanishes at the
end.  It appears after a second, from a separate thread, even if the first part is still being
computed.  Rich is loaded only then.  Nothing is shown if standard error is not a terminal.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from threading import Timer
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

from ..arithmetic.values import Values

if TYPE_CHECKING:
    from typing import TextIO

    from rich.progress import Progress as Display

Item = TypeVar("Item")
MOST_CHARACTERS = 1000
"""The largest length of a line; longer lines are shortened."""


def one_line(text: str) -> str:
    """Return a text as one line of printable characters, with the middle left out of a long one.

    Control characters and marks that change the direction of writing become escapes, such as
    `\\x1b`.  A file name or a datum may hold any of them, and a terminal would obey.
    """
    words = " ".join(text.split())
    line = "".join(x if x.isprintable() else x.encode("unicode_escape").decode() for x in words)
    if len(line) <= MOST_CHARACTERS:
        return line
    half = (MOST_CHARACTERS - 40) // 2
    return f"{line[:half]} [... {len(line) - 2 * half} characters ...] {line[-half:]}"


class View(Values):
    """Properties of the output: its width, its letters and its colours."""

    width: int | None = None
    """Columns of the terminal; None if the output is no terminal, and may have any width."""
    has_greek: bool = True
    """Whether the encoding has every letter that lagtop writes."""
    has_colours: bool = False
    """Whether letters may be bold or coloured."""


def view_of(path: str) -> View:
    """Return the view of the output to a file, or to standard output for `-`.

    The variable COLUMNS overrides the width of the terminal.
    """
    if path != "-" or sys.stdout is None:
        return View()
    has_greek = (getattr(sys.stdout, "encoding", None) or "utf-8").lower().startswith("utf")
    if not sys.stdout.isatty():
        return View(None, has_greek)
    from shutil import get_terminal_size

    return View(get_terminal_size().columns, has_greek, has_colours(sys.stdout))


def is_terminal(stream: TextIO | None) -> bool:
    """Return whether a standard stream is a terminal; a closed stream is None."""
    return stream is not None and stream.isatty()


def has_colours(stream: TextIO) -> bool:
    """Return whether a stream is a terminal with colours, and the user has not disabled them.

    The variable NO_COLOR (https://no-color.org) disables colours.
    """
    unwanted = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return stream.isatty() and not unwanted


_ASCII = str.maketrans(
    {"ϑ": "theta", "φ": "phi", "ψ": "psi", "α": "alpha", "²": "^2", "⁴": "^4", "§": "sec. "}
    | {"Δ": "Delta", "λ": "lambda", "Π": "Pi", "π": "pi", "Ω": "Omega", "₁": "1", "₄": "4"}
    | {"√": "sqrt", "∫": "integral", "·": "*", "°": " deg"}
    | {"β": "beta", "δ": "delta", "γ": "gamma", "σ": "sigma", "η": "eta", "τ": "tau"}
)


def spelt(text: str, view: View) -> str:
    """Return a text, with Greek letters and powers spelt out if the encoding lacks them."""
    return text if view.has_greek else text.translate(_ASCII)


def one(_: Any) -> int:
    """Return 1, the size of a part that counts as one item."""
    return 1


class Progress(Protocol):
    """A function that shows the progress of some work during iteration over its parts."""

    def __call__(
        self,
        parts: Iterable[Item],
        label: str,
        total: int | None = None,
        size: Callable[[Item], int] = one,
    ) -> Iterator[Item]:
        """Yield the parts as they arrive.

        `size` gives the items of a part, and `total` the items of all parts.  Without a total it is
        summed over the parts if these are a sequence, and unknown otherwise.
        """


def silent(
    parts: Iterable[Item],
    label: str,
    total: int | None = None,
    size: Callable[[Item], int] = one,
) -> Iterator[Item]:
    """Yield the parts and show nothing."""
    return iter(parts)


DELAY = 1.0
"""Seconds of work before the line appears."""


def with_progress(
    parts: Iterable[Item],
    label: str,
    total: int | None = None,
    size: Callable[[Item], int] = one,
) -> Iterator[Item]:
    """Yield the parts as they arrive, and show the progress."""
    if not sys.stderr.isatty():
        yield from parts
        return
    if total is None and isinstance(parts, Sequence):
        total = sum(map(size, parts))
    line = _Line(label, total)
    try:
        for part in parts:
            yield part
            line.advance(size(part))
    finally:
        line.stop()


class _Line:
    """The line of one piece of work."""

    last: ClassVar[_Line | None] = None
    """The line that began last: output may share the terminal with it."""

    def __init__(self, label: str, total: int | None) -> None:
        self.label, self.total, self.done = label, total, 0
        self.display: Display | None = None
        self.timer = Timer(DELAY, self._show)
        self.timer.daemon = True
        self.timer.start()
        _Line.last = self

    def _show(self) -> None:
        display = _display(counts=self.total is None)
        display.add_task(self.label, total=self.total, completed=self.done)
        display.start()
        self.display = display

    def advance(self, count: int) -> None:
        """Count items that are done."""
        self.done += count
        if self.display:
            self.display.update(self.display.task_ids[0], completed=self.done)

    def stop(self) -> None:
        """Remove the line, or prevent it from appearing."""
        self.timer.cancel()
        self.timer.join()  # it may be about to draw
        if self.display:
            self.display.stop()
            self.display = None


@contextmanager
def without_progress() -> Iterator[None]:
    """Hide the line of progress, if there is one, while the block writes to the terminal."""
    display = _Line.last and _Line.last.display
    if display:
        display.stop()
    yield
    if display:
        display.start()


def end_progress() -> None:
    """Remove the line of progress of a command that has failed."""
    if _Line.last:
        _Line.last.stop()


def _display(*, counts: bool) -> Display:
    """Return an empty display that fits the width of any terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from rich.progress import TimeRemainingColumn as Remaining

    tail = ["{task.completed:,.0f} done"] if counts else ["{task.percentage:>3.0f}%"]
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=None),
        *(TextColumn(text) for text in tail),
        TimeElapsedColumn() if counts else Remaining(elapsed_when_finished=True),
        console=Console(stderr=True),
        transient=True,
        expand=True,
    )
