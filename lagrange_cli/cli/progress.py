"""Progress of long work: one line on the terminal of standard error, which vanishes at the end.

The line appears after a second, from a separate thread, even if the first part is still being
computed.  Rich is loaded only then.  Nothing is shown if standard error is no terminal.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from threading import Timer
from typing import TYPE_CHECKING

import click

from ..output.progress import Item, one
from ..output.terminal import Screen

if TYPE_CHECKING:
    from rich.progress import Progress

DELAY = 1.0
"""Seconds of work before the line appears."""


def with_progress(
    parts: Iterable[Item],
    label: str,
    total: int | None = None,
    size: Callable[[Item], int] = one,
) -> Iterator[Item]:
    """Yield the parts as they arrive, and show the progress; see `output.progress.Progress`."""
    if not sys.stderr.isatty():
        yield from parts
        return
    if total is None and isinstance(parts, Sequence):
        total = sum(map(size, parts))
    with _line(label, total) as line:
        for part in parts:
            yield part
            line.advance(size(part))


@contextmanager
def _line(label: str, total: int | None) -> Iterator[_Line]:
    """Show a line while the block runs, and always remove it.

    It is removed even if a consumer is interrupted and does not come back, because a command closes
    its context before its frames are gone.
    """
    line = _Line(label, total)
    if context := click.get_current_context(silent=True):
        context.call_on_close(line.stop)
    try:
        yield line
    finally:
        line.stop()


class _Line:
    """The line of one piece of work."""

    def __init__(self, label: str, total: int | None) -> None:
        self.label, self.total, self.done = label, total, 0
        self.progress: Progress | None = None
        self.timer = Timer(DELAY, self._show)
        self.timer.daemon = True
        self.timer.start()

    def _show(self) -> None:
        progress = _progress(counts=self.total is None)
        progress.add_task(self.label, total=self.total, completed=self.done)
        progress.start()
        self.progress = progress
        Screen.without_progress = self._out_of_the_way

    def advance(self, count: int) -> None:
        """Count items that are done."""
        self.done += count
        if self.progress:
            self.progress.update(self.progress.task_ids[0], completed=self.done)

    @contextmanager
    def _out_of_the_way(self) -> Iterator[None]:
        assert self.progress
        self.progress.stop()
        yield
        self.progress.start()

    def stop(self) -> None:
        """Remove the line, or prevent it from appearing."""
        self.timer.cancel()
        self.timer.join()  # it may be about to draw
        if self.progress:
            Screen.without_progress = nullcontext
            self.progress.stop()


def _progress(*, counts: bool) -> Progress:
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
