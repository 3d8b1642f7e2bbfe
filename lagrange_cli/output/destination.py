"""Destination of output: a file that is replaced only on success, or standard output.

A signal that ends the program removes the temporary file first.

`Output` is a destination with a format; it writes values, a record, rows or a report.  One record
in CSV or JSON is formatted here, because importing orjson would cost `lagtop solve` 4 % of its
time, and orjson only supports doubles.  Formats of rows and reports are imported when they are
needed.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, BinaryIO, NoReturn

from ..arithmetic.text import csv_text, json_text, value_text
from ..arithmetic.values import Values
from ..errors import CannotWriteError

if TYPE_CHECKING:
    import signal
    from types import FrameType

    from _typeshed import ReadableBuffer as Buffer

    from ..arithmetic.types import Array
    from .formats import Texts
    from .report import Keys, Report
else:
    import _signal as signal  # without the enumerations of `signal`, 2 % of `lagtop solve`

ENDING = ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGALRM", "SIGUSR1", "SIGUSR2", "SIGXCPU")
"""Signals that end a program, besides Ctrl-C: temporary files are removed first."""


class Output(Values):
    """A destination, a file or `-` for standard output, and the name of a format."""

    path: str
    fmt: str
    is_named: bool = False
    """Whether the user named the format."""

    def values(self, values: Iterable[Any]) -> None:
        """Write bare values, one per line."""
        self.text("".join(f"{value_text(value)}\n" for value in values))

    def text(self, text: str) -> None:
        """Write a text."""
        write_bytes(self.path, text.encode)

    def record(self, record: Mapping[str, Any], keys: Callable[[], Keys]) -> None:
        """Write one record; a table and markdown show it by its `keys`."""
        if self.fmt in {"json", "ndjson"}:
            self.text(f"{_json_value(record)}\n")
        elif self.fmt == "csv":
            self.text(f"{','.join(record)}\n{','.join(map(_csv_cell, record.values()))}\n")
        else:
            from .report import record_text  # start-up
            from .terminal import view_of  # start-up

            text = record_text(record, keys(), self.fmt, view_of(self.path))
            write_bytes(self.path, lambda: text)

    def table(self, names: Sequence[str], blocks: Iterable[Array | Texts], count: int = 0) -> None:
        """Write `count` rows in blocks: arrays, or lists of numbers as text.

        The count is 0 if it is unknown.
        """
        from .formats import FORMATS  # start-up

        made = FORMATS[self.fmt].rows
        self.blocks(names, (made(block, names) for block in blocks), count)

    def blocks(self, names: Sequence[str], blocks: Iterable[bytes], count: int = 0) -> None:
        """Write blocks made by `formats.block_text`, with the header and footer of the format."""
        from .formats import FORMATS  # start-up
        from .terminal import view_of  # start-up

        with opened(self.path) as stream:
            FORMATS[self.fmt].write(stream, names, blocks, view_of(self.path), count)

    def rows(
        self, rows: Sequence[Mapping[str, Any]], keys: Sequence[str], names: Sequence[str] = ()
    ) -> None:
        """Write some rows by key; their columns have the keys, or other names, as headings."""
        from .formats import block_text  # start-up

        columns = [[row.get(key) for row in rows] for key in keys]
        self.blocks(names or keys, [block_text(columns, keys, self.fmt)])

    def report(self, find: Callable[[], Report]) -> Report:
        """Write what `find` returns, and return it; the destination is opened first."""
        from .terminal import view_of  # start-up

        with opened(self.path) as stream:
            report = find()
            stream.write(report.text(self.fmt, view_of(self.path)))
        return report


def write_bytes(path: str, make: Callable[[], bytes]) -> None:
    """Write bytes that are made only when the destination is open."""
    with opened(path) as stream:
        stream.write(make())


def _csv_cell(value: Any) -> str:
    return csv_text(value) if type(value) is str else value_text(value)


def _json_value(value: Any) -> str:
    """Return a value as orjson would write it."""
    if isinstance(value, Mapping):
        members = [f'"{key}":{_json_value(x)}' for key, x in value.items()]
        return f"{{{','.join(members)}}}"
    if type(value) is str:  # nearly all are plain words, for which orjson is not loaded
        is_plain = value.isprintable() and not set(value) & {'"', "\\"}
        return f'"{value}"' if is_plain else json_text(value)
    return value_text(value) or "null"


@contextmanager
def opened(path: str, mark: str = "") -> Iterator[BinaryIO]:
    """Yield a binary stream to a file, or to standard output for `-`.

    An existing file is replaced if the block succeeds, and kept otherwise.  The name of the
    temporary file is `.lagtop-`, a mark, and some random characters.  Raises CannotWriteError, or
    BrokenPipeError if the reader has gone away.
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
        from .terminal import without_progress  # start-up

        with without_progress():
            count = super().write(data)
            self.flush()
        return count


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
    """Return whether a path is a regular file, or does not exist.

    Raises OSError if a shell would refuse the path too.
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
    """Flush the new name of the file to the disk, if the system can do that."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
