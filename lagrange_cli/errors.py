"""The errors of the package.  Each has an exit code, which `lagtop --help` explains."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Self

MARK = "\ud800"
"""What stands on both sides of an argument in a text: half of a surrogate pair.

No decoder of a file, of a file name or of JSON returns it, so that none of them can forge a mark.
"""


def arg(name: str, value: object = None) -> str:
    """Return the name of an argument, with its value if there is one, for the text of a message."""
    return f"{MARK}{name}{MARK}" if value is None else f"{MARK}{name}={value}{MARK}"


class Message(str):
    """A text that names arguments, as in Python; the command line writes options instead.

    >>> text = Message(f"use {arg('decimal', 'comma')} in dt=1.csv")
    >>> text, text.with_options({"decimal": "--decimal", "dt": "--dt"})
    ('use decimal=comma in dt=1.csv', 'use --decimal comma in dt=1.csv')
    """

    marked: str
    """The text with marks around the arguments, to be part of another message."""

    def __new__(cls, text: str) -> Self:
        """Take a text with arguments that `arg` has marked."""
        found = super().__new__(cls, text.replace(MARK, ""))
        found.marked = marked(text)
        return found

    def with_options(self, options: Mapping[str, str]) -> str:
        """Return the text with options for the arguments that have one.

        The name `x=` stands for an argument `x` with a value, if its option differs.
        """
        parts = self.marked.split(MARK)
        for i, part in enumerate(parts[1::2]):
            name, equals, value = part.partition("=")
            if option := options.get(name + equals) or options.get(name):
                parts[2 * i + 1] = option + equals.replace("=", " ") + value
        return "".join(parts)


def marked(text: str | LagtopError) -> str:
    """Return the text of a message or of an error with its marks, or a plain text."""
    return getattr(text, "marked", str(text))


def joined(texts: Iterable[str | LagtopError], by: str = "; ") -> Message:
    """Return several texts or errors as one message."""
    return Message(by.join(map(marked, texts)))


class LagtopError(ValueError):
    """A bad input, and the base class of all other errors.

    `key` is the name of the argument at fault, if there is one.  A message that begins with it has
    the name of the option on the command line.

    >>> Top(m=-1)
    Traceback (most recent call last):
    lagrange_cli.errors.LagtopError: m must be > 0, got -1.0
    """

    exit_code = 2

    def __init__(self, message: str, key: str | None = None) -> None:
        if key and message.startswith(f"{key} "):
            message = arg(key) + message.removeprefix(key)
        super().__init__(Message(message))
        self.key = key

    @property
    def marked(self) -> str:
        """The message with marks around the arguments, to be part of another message."""
        return marked(self.args[0])

    @classmethod
    def at(cls, place: str, error: LagtopError, remedy: str = "") -> Any:
        """Return an error of this class with the message of another one, after a place."""
        found = cls(f"{place}: {error.marked}{remedy}")
        found.key = error.key
        return found


def install(extra: str) -> str:
    """Return the command that installs an extra of lagtop, for the text of a message."""
    return f"pip install '.[{extra}]' in the folder of lagtop"


def check_type(name: str, value: object, *kinds: type) -> None:
    """Raise TypeError for an argument of any other type."""
    if not isinstance(value, kinds):
        words = {"Integral": "whole number", "NoneType": "None"}
        wanted = " or ".join(words.get(x.__name__, x.__name__) for x in kinds)
        raise TypeError(f"{name} must be a {wanted}, got {type(value).__name__}")


class DataError(LagtopError):
    """A file of inputs cannot be read or has bad data: times, tops, trajectories, scenes."""

    exit_code = 65


class SceneError(DataError):
    """A scene file cannot be read or describes no top."""


class SomeFailedError(LagtopError):
    """Some tops, trajectories or recordings have failed; the output shows which ones, and why."""

    exit_code = 1


class AbsentError(LagtopError):
    """A requested number does not exist, or nothing was found."""

    exit_code = 1


class OutOfRangeError(LagtopError):
    """A number is beyond the range of doubles."""


class OutOfRangeWarning(UserWarning):
    """Some numbers of a record are beyond the range of doubles, and are None in it."""


class MixedBodyWarning(UserWarning):
    """Only some of m, A, C, s and g were given; the others come from the worked example.

    >>> with warnings.catch_warnings(record=True) as caught:
    ...     top = Top(m=1500)
    >>> str(caught[0].message)[:46]
    'A, C, s and g default to the worked example, i'
    """


class UnavailableError(LagtopError):
    """A cluster, a method or a package is not available."""

    exit_code = 69


class CannotWriteError(LagtopError):
    """The output cannot be written; the message states where and why."""

    exit_code = 74
