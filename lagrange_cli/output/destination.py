"""Destination of output: a file that is replaced once all is written, or standard output.

`Output` is a destination with a format; it writes a text, a record or rows.  Formats of
rows and tables are imported when they are needed, because `lagtop solve` starts often.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

from ..arithmetic.text import NumberText, value_text
from ..errors import CannotWriteError, LagtopError
from .terminal import is_screen, printable, width_of
from .text import csv_text, json_text

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from .formats import Texts
    from .report import Keys


class Output(NamedTuple):
    """A destination, a file or `-` for standard output, and the name of a format."""

    path: str
    fmt: str
    is_named: bool = False
    """Whether the user named the format."""

    def text(self, text: str) -> None:
        """Write a text, without control characters if the output is a terminal."""
        with opened(self.path) as stream:
            stream.write((printable(text) if is_screen(self.path) else text).encode())

    def record(self, record: Mapping[str, Any], keys: Callable[[], Keys]) -> None:
        """Write one record; a table shows it by its `keys`.  Raises LagtopError for Parquet."""
        if self.fmt == "parquet":
            raise LagtopError("format parquet holds tables: use json or csv", "format")
        if self.fmt in {"json", "ndjson"}:
            self.text(f"{_json_value(record)}\n")
        elif self.fmt == "csv":
            self.text(f"{','.join(record)}\n{','.join(map(csv_text, record.values()))}\n")
        else:
            from .report import record_text

            text = record_text(record, keys(), width_of(self.path))
            with opened(self.path) as stream:
                stream.write(text.encode())

    def table(self, names: Sequence[str], blocks: Iterable[Array | Texts]) -> None:
        """Write rows in blocks: arrays, or lists of numbers as text."""
        from .formats import block_text

        columns = (
            [[*map(NumberText, x)] for x in zip(*rows, strict=True)]
            if isinstance(rows, list)
            else [rows]
            for rows in blocks
            if len(rows)
        )
        self.blocks(names, (block_text(x, names, self.fmt) for x in columns))

    def blocks(self, names: Sequence[str], blocks: Iterable[bytes]) -> None:
        """Write blocks made by `formats.block_text`, with the header and footer of the format."""
        from .formats import write

        if is_screen(self.path):
            names = [printable(name) for name in names]
            blocks = (printable(block.decode()).encode() for block in blocks)
        with opened(self.path) as stream:
            write(stream, names, blocks, self.fmt, width_of(self.path))

    def rows(
        self, rows: Sequence[Mapping[str, Any]], keys: Sequence[str], names: Sequence[str] = ()
    ) -> None:
        """Write some rows by key; their columns have the keys, or other names, as headings."""
        from .formats import block_text

        columns = [[row.get(key) for row in rows] for key in keys]
        self.blocks(names or keys, [block_text(columns, keys, self.fmt)])


def _json_value(value: Any) -> str:
    """Return a value as orjson would write it, with numbers that are written out already."""
    if isinstance(value, Mapping):
        members = [f'"{key}":{_json_value(x)}' for key, x in value.items()]
        return f"{{{','.join(members)}}}"
    if type(value) is str:
        is_plain = value.isprintable() and not set(value) & {'"', "\\"}
        return f'"{value}"' if is_plain else json_text(value)  # start-up: nearly all are plain
    return value_text(value) or "null"


@contextmanager
def opened(path: str) -> Iterator[BinaryIO]:
    """Yield a binary stream to a file, or to standard output for `-`.

    A temporary file `.lagtop-...` beside the file replaces it if the block succeeds.  Raises
    CannotWriteError, or BrokenPipeError if the reader has gone away.
    """
    try:
        with _standard_output() if path == "-" else _file(path) as stream:
            yield stream
    except BrokenPipeError:
        raise
    except OSError as error:
        name = "standard output" if path == "-" else path or "''"
        raise CannotWriteError(f"cannot write {name}: {error.strerror or error}") from None


@contextmanager
def _standard_output() -> Iterator[BinaryIO]:
    if sys.stdout is None:
        raise OSError("it is closed")
    try:
        descriptor = sys.stdout.fileno()
    except io.UnsupportedOperation:  # replaced in this process, as by click's test runner
        yield sys.stdout.buffer
        sys.stdout.buffer.flush()
        return
    # A buffer of our own: that of sys.stdout may be missing, and is flushed once more at exit.
    with open(descriptor, "wb", closefd=False) as stream:
        yield stream


@contextmanager
def _file(path: str) -> Iterator[BinaryIO]:
    if path.endswith("/"):
        raise OSError(errno.EISDIR, os.strerror(errno.EISDIR))
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        if not path:
            raise
        mode = None
    descriptor = _descriptor(path)
    if descriptor is not None or (mode is not None and not stat.S_ISREG(mode)):  # a pipe, a device
        place = path if descriptor is None else descriptor
        with open(place, "wb", closefd=descriptor is None) as stream:
            yield stream
        return
    target = os.path.realpath(path)  # the file behind a link
    temporary = os.path.join(os.path.dirname(target), f".lagtop-{os.urandom(6).hex()}")
    try:
        with open(temporary, "xb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        if mode is not None:
            os.chmod(temporary, mode & 0o777)
        os.replace(temporary, target)
    finally:
        with suppress(FileNotFoundError):
            os.unlink(temporary)


def _descriptor(path: str) -> int | None:
    """Return the open descriptor that a path such as /dev/stdout or /dev/fd/3 leads to, or None."""
    for _ in range(40):  # links, as many as systems follow
        folder, name = os.path.realpath(os.path.dirname(path)), os.path.basename(path)
        if folder in {"/dev/fd", f"/proc/{os.getpid()}/fd"} and name.isdigit():
            return int(name)
        if not os.path.islink(link := os.path.join(folder, name)):
            break
        path = os.path.join(folder, os.readlink(link))
    return None
