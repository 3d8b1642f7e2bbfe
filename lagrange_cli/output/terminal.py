"""The terminal and the signals of the process.

A terminal has a width, a character set and colours.  A text that is shown must not control it.

A signal ends the program as if nothing caught it, unless it was ignored at the start.  A shell
loop stops only if the command inside it dies by the signal itself, not with an exit code that
looks like one.  It is unknown whether SIGPIPE was ignored at the start, because Python ignores
it before this code runs.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from typing import TYPE_CHECKING, NoReturn

from ..arithmetic.values import Values

if TYPE_CHECKING:
    import signal
    from types import FrameType
    from typing import TextIO
else:
    import _signal as signal  # without the enumerations of `signal`, 2 % of `lagtop solve`

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


class Screen:
    """The terminal of the process, which output may share with a line of progress."""

    without_progress: Callable[[], AbstractContextManager[None]] = nullcontext
    """A context that hides the line of progress while something else is written."""
    end_progress: Callable[[], object] = nullcontext
    """Removes the line of progress, if there is one."""


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
