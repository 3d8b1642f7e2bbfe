"""Progress of long work: functions that pass on its parts, and may show a line on the terminal.

The line of standard error vanishes at the end.  It appears after a second, from a separate thread,
even if the first part is still being computed.  Rich is loaded only then.  Nothing is shown if
standard error is not a terminal.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from threading import Timer
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from .terminal import Screen

if TYPE_CHECKING:
    from rich.progress import Progress as Display

Item = TypeVar("Item")


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

    def __init__(self, label: str, total: int | None) -> None:
        self.label, self.total, self.done = label, total, 0
        self.display: Display | None = None
        self.timer = Timer(DELAY, self._show)
        self.timer.daemon = True
        self.timer.start()
        Screen.end_progress = self.stop

    def _show(self) -> None:
        display = _display(counts=self.total is None)
        display.add_task(self.label, total=self.total, completed=self.done)
        display.start()
        self.display = display
        Screen.without_progress = self._out_of_the_way

    def advance(self, count: int) -> None:
        """Count items that are done."""
        self.done += count
        if self.display:
            self.display.update(self.display.task_ids[0], completed=self.done)

    @contextmanager
    def _out_of_the_way(self) -> Iterator[None]:
        assert self.display
        self.display.stop()
        yield
        self.display.start()

    def stop(self) -> None:
        """Remove the line, or prevent it from appearing."""
        self.timer.cancel()
        self.timer.join()  # it may be about to draw
        if self.display:
            Screen.without_progress = nullcontext
            self.display.stop()


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
