"""Where output goes: a standard output that is watched for failure, or a file that is replaced
whole or not at all."""

from __future__ import annotations

import io
import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, BinaryIO, NoReturn

from ..errors import CannotWriteError


class Terminated(BaseException):
    """A signal to end, raised so that a temporary file is removed on the way out."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


@contextmanager
def sink(path: str) -> Iterator[BinaryIO]:
    """A binary stream to `path`, or to standard output for `-`.

    An existing file is replaced when the block ends well and left alone when it does not.  Raises
    CannotWriteError; a reader that went away raises BrokenPipeError.
    """
    try:
        with _standard_output() if path == "-" else _file(path) as stream:
            yield stream
    except BrokenPipeError:
        raise
    except OSError as error:
        name = "standard output" if path == "-" else path
        raise CannotWriteError(f"cannot write {name}: {error.strerror or error}") from None


@contextmanager
def _standard_output() -> Iterator[BinaryIO]:
    # A duplicate with a buffer of its own: unlike sys.stdout under PYTHONUNBUFFERED it neither
    # drops what a full disk or a slow reader did not take nor hides the failure.
    if sys.stdout is None:
        raise OSError("it is closed")
    try:
        descriptor = os.dup(sys.stdout.fileno())
    except io.UnsupportedOperation:  # replaced in-process, as by click's test runner
        yield sys.stdout.buffer
        sys.stdout.buffer.flush()
        return
    with open(descriptor, "wb") as stream:
        yield stream


@contextmanager
def _file(path: str) -> Iterator[BinaryIO]:
    if os.path.exists(path) and not stat.S_ISREG(os.stat(path).st_mode):  # a device, a pipe
        with open(path, "wb") as stream:
            yield stream
        return
    from tempfile import mkstemp

    _catch_signals()
    target = os.path.realpath(path)
    descriptor, temporary = mkstemp(prefix=".lagtop-", dir=os.path.dirname(target))
    with open(descriptor, "wb") as stream:
        try:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
            os.chmod(temporary, _mode(target))
            os.replace(temporary, target)
        except BaseException:
            os.unlink(temporary)
            raise


def _mode(target: str) -> int:
    """The mode of the file that is replaced, or of a new one."""
    if os.path.exists(target):
        return stat.S_IMODE(os.stat(target).st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _catch_signals() -> None:
    """Let the signals that end us remove the temporary file first."""
    import signal

    def end(number: int, _: Any) -> NoReturn:
        raise Terminated(number)

    for name in ("SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), end)
