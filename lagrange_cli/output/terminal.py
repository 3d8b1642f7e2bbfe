"""Terminals: text that is safe to show, their width, and the line of progress."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING

from ..arithmetic.values import Values

if TYPE_CHECKING:
    from typing import TextIO

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
