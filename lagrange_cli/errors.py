"""The errors of the package, each with the exit code that the command line ends with.

| code | meaning |
|---|---|
| 0 | success |
| 1 | a top or a check failed, a quantity is undefined, or nothing was found |
| 2 | wrong usage or a bad value |
| 65 | a file cannot be read or holds bad data |
| 69 | a package, an engine or a cluster is not available |
| 74 | output cannot be written |
| 128 + N | ended by signal N |

N is 2 for Ctrl-C and 13 for a reader that went away.
"""

from __future__ import annotations


class LagtopError(ValueError):
    """A bad input, or the base of every other error.

    `key` is the name of the argument at fault, if there is one.  A message about an argument
    begins with its name as Python spells it; the command line turns that into its option.
    """

    exit_code = 2

    def __init__(self, message: str, key: str | None = None) -> None:
        super().__init__(message)
        self.key = key


def check_type(name: str, value: object, *kinds: type) -> None:
    """Raise TypeError for an argument that is of none of these types."""
    if not isinstance(value, kinds):
        wanted = " or ".join(kind.__name__ for kind in kinds)
        raise TypeError(f"{name} must be a {wanted}, got {type(value).__name__}")


class DataError(LagtopError):
    """A file of inputs that cannot be read or has bad data: times, tops, trajectories, scenes."""

    exit_code = 65


class SceneError(DataError):
    """A scene file that cannot be read or that describes no top."""


class SomeFailedError(LagtopError):
    """Some tops, trajectories or recordings have failed; the output shows which, and why."""

    exit_code = 1


class AbsentError(LagtopError):
    """A number that was asked for does not exist, or nothing was found."""

    exit_code = 1


class OutOfRangeError(LagtopError):
    """A number that is beyond the range of doubles."""


class OutOfRangeWarning(UserWarning):
    """Some numbers of a record are beyond the range of doubles, and None in it."""


class MixedBodyWarning(UserWarning):
    """Some of m, A, C, s and g were given; the others are those of the worked example."""


class NothingToDrawError(LagtopError):
    """A picture was asked for that the motion does not have."""


class UnavailableError(LagtopError):
    """A cluster, a method or a package is not available."""

    exit_code = 69


class CannotWriteError(LagtopError):
    """The output cannot be written; the message says where and why."""

    exit_code = 74
