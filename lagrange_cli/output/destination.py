"""Where output goes: a standard output that is watched for failure, or a file that is replaced
whole or not at all."""

from __future__ import annotations

import errno
import io
import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, BinaryIO

from ..errors import CannotWriteError
from .signals import ENDING, terminated_by
from .terminal import Screen

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer as Buffer


@contextmanager
def opened(path: str, mark: str = "") -> Iterator[BinaryIO]:
    """Yield a binary stream to a file, or to standard output for `-`.

    An existing file is replaced when the block ends well and left alone when it does not; the name
    of the temporary file is `.lagtop-`, a mark, and some random characters.  Raises
    CannotWriteError, or BrokenPipeError for a reader that went away.
    """
    try:
        with _standard_output() if path == "-" else _file(path, mark) as stream:
            yield stream
    except BrokenPipeError:
        raise
    except OSError as error:
        name = "standard output" if path == "-" else path or "''"
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
    shared = sys.stdout.isatty()
    with _SharedScreen(io.FileIO(descriptor, "wb")) if shared else open(descriptor, "wb") as stream:
        yield stream


class _SharedScreen(io.BufferedWriter):
    """Standard output on a terminal that may show a line of progress at the same time."""

    def write(self, data: Buffer, /) -> int:
        """Write at once, with the line of progress out of the way."""
        with Screen.without_progress():
            count = super().write(data)
            self.flush()
        return count


@contextmanager
def _file(path: str, mark: str) -> Iterator[BinaryIO]:
    if not _is_replaceable(path):
        with open(path, "wb") as stream:
            yield stream
        return
    from tempfile import mkstemp

    target = os.path.realpath(path)
    folder = os.path.dirname(target)
    with terminated_by(ENDING):
        descriptor, temporary = mkstemp(prefix=f".lagtop-{mark}", dir=folder)
        try:
            with open(descriptor, "wb") as stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
            os.chmod(temporary, _mode(target))
            os.replace(temporary, target)
        except BaseException:
            os.unlink(temporary)
            raise
    _sync_folder(folder)


def _is_replaceable(path: str) -> bool:
    """Return whether a path is a regular file, or nothing yet.

    Raises OSError where a shell would refuse the path too.
    """
    if path.endswith(("/", os.sep)):
        raise OSError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not path:
        raise OSError(errno.ENOENT, os.strerror(errno.ENOENT))
    try:
        return stat.S_ISREG(os.stat(path).st_mode)
    except FileNotFoundError:
        return True


def _mode(target: str) -> int:
    """Return the permissions of the file that is replaced, or of a new one."""
    if os.path.exists(target):
        return os.stat(target).st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _sync_folder(folder: str) -> None:
    """Bring the new name of the file to the disk, where the system can do that."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
