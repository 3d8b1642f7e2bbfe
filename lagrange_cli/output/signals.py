"""Signals that end the program: an ignored one stays ignored, any other kills as a signal.

A shell loop stops only when the command inside it dies by the signal itself, not with an exit code
that looks like one.  Whether SIGPIPE was ignored at the start cannot be told: Python ignores it
before any of this code runs.
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
"""The exit code for a reader that went away, where the system has no SIGPIPE."""


class Terminated(BaseException):
    """A signal to end, raised so that a temporary file is removed on the way out."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def _terminate(number: int, _: FrameType | None) -> NoReturn:
    raise Terminated(number)


@contextmanager
def terminated_by(names: Sequence[str]) -> Iterator[None]:
    """Turn these signals into Terminated while the block runs.

    A signal that is ignored or handled already, or that the system does not have, is left alone.
    """
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    ours = [number for number in numbers if signal.getsignal(number) == signal.SIG_DFL]
    caught = []
    try:
        with suppress(ValueError):  # handlers belong to the main thread; in another there are none
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

    Before and after it Ctrl-C kills at once (see `__main__`), as nothing would catch the exception.
    """
    if signal.getsignal(signal.SIGINT) != signal.SIG_DFL:  # ignored, or in the hands of a host
        yield
        return
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def die_by(number: int | None) -> NoReturn:
    """End the program by a signal, or with an exit code where the system does not have it."""
    if number is None:
        sys.exit(NO_SIGPIPE)
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    raise AssertionError("unreachable")
