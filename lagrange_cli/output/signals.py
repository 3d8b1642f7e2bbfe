"""Signals that end the program: ignored signals stay ignored, others kill as a signal.

A shell loop stops only if the command inside it dies by the signal itself, not with an exit code
that looks like one.  It is unknown whether SIGPIPE was ignored at the start, because Python ignores
it before this code runs.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from types import FrameType
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    import signal
else:
    import _signal as signal  # without the enumerations of `signal`, 2 % of `lagtop solve`

INTERRUPT = signal.SIGINT
ENDING = ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGALRM", "SIGUSR1", "SIGUSR2", "SIGXCPU")
"""Other signals that end a program: temporary files are removed first."""
CLOSED_PIPE = getattr(signal, "SIGPIPE", None)
NO_SIGPIPE = 128 + 13
"""The exit code if the reader has gone away and the system has no SIGPIPE."""


class Terminated(BaseException):
    """A signal to end, raised so that temporary files are removed."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def _terminate(number: int, _: FrameType | None) -> NoReturn:
    raise Terminated(number)


@contextmanager
def terminated_by(names: Sequence[str]) -> Iterator[None]:
    """Turn these signals into Terminated while the block runs.

    A signal is left alone if it is ignored, already handled, or unknown to the system.
    """
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    ours = [number for number in numbers if signal.getsignal(number) == signal.SIG_DFL]
    caught = []
    try:
        with suppress(ValueError):  # only the main thread can set handlers
            for number in ours:
                signal.signal(number, _terminate)
                caught.append(number)
        yield
    finally:
        for number in caught:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def interrupts() -> Iterator[None]:
    """Raise KeyboardInterrupt for Ctrl-C while the block runs, so that it can clean up.

    Outside the block Ctrl-C kills at once (see `__main__`), as nothing would catch the exception.
    """
    if signal.getsignal(signal.SIGINT) != signal.SIG_DFL:  # ignored, or handled by a host
        yield
        return
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def die_by(number: int | None) -> NoReturn:
    """End the program by a signal, or with an exit code if the system does not have the signal."""
    if number is None:
        sys.exit(NO_SIGPIPE)
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    raise AssertionError("unreachable")
