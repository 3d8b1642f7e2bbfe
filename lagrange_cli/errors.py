"""The errors of the package, each with the exit code of the command line.

| code | meaning |
|---|---|
| 0 | success |
| 1 | a top or a check failed, a quantity is undefined, or nothing was found |
| 2 | wrong usage or a bad value |
| 65 | a file cannot be read or holds bad data |
| 69 | a package, an engine or a cluster is not available |
| 74 | output cannot be written |
| 128 + N | ended by signal N |

N is 2 for Ctrl-C and 13 if the reader has gone away.
"""

from __future__ import annotations


class LagtopError(ValueError):
    """A bad input, and the base class of all other errors.

    `key` is the name of the argument at fault, if there is one.  A message about an argument begins
    with its name in Python; the command line converts it to the name of the option.

    >>> Top(m=-1)
    Traceback (most recent call last):
    lagrange_cli.errors.LagtopError: m must be > 0, got -1.0
    """

    exit_code = 2

    def __init__(self, message: str, key: str | None = None) -> None:
        super().__init__(message)
        self.key = key


def check_type(name: str, value: object, *kinds: type) -> None:
    """Raise TypeError for an argument of any other type."""
    if not isinstance(value, kinds):
        wanted = " or ".join(kind.__name__ for kind in kinds)
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
