"""Destination of output: standard output, or a file that is replaced only when it is complete.

`Output` is a destination with a format; it writes documents and rows.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

from ..errors import CannotWriteError
from .document import Document, rows_grid, texts_of
from .formats.base import Format, format_of
from .terminal import is_screen, printable, width_of

if TYPE_CHECKING:
    from ..arithmetic.types import Array

MOST_ROWS, MOST_UPRIGHT = 1000, 50
"""Most rows of a table on a terminal, and if its columns must become lines, by default."""
Texts = Sequence[Sequence[Any]]
"""A block of rows of NumberText; an empty text is a missing number."""


class Output(NamedTuple):
    """A destination, a file or `-` for standard output, and the name of a format."""

    path: str
    fmt: str
    is_named: bool = False
    """Whether the user named the format."""

    @property
    def format(self) -> Format:
        """The format, imported when it is used."""
        return format_of(self.fmt)

    def document(self, document: Document) -> None:
        """Write a document.  Raises LagtopError if the format cannot hold it."""
        with opened(self.path) as stream:
            stream.write(self.bytes_of(document))

    def bytes_of(self, document: Document) -> bytes:
        """Return a document in the format, without control characters on a terminal."""
        written: bytes = self._safe(self.format.document(document, width_of(self.path)))
        return written

    def rows(
        self, names: Sequence[str], blocks: Iterable[Array | Texts], headings: Sequence[str] = ()
    ) -> None:
        """Write rows in blocks: arrays, or lists of numbers as text."""
        columns = ([*zip(*x, strict=True)] if isinstance(x, list) else [x] for x in blocks)
        self.blocks(names, (self.format.block(x, names) for x in columns), headings)

    def blocks(
        self, names: Sequence[str], blocks: Iterable[Any], headings: Sequence[str] = ()
    ) -> None:
        """Write blocks that the format has encoded; people see `headings` in place of the names.

        If the user named no format, a table that is long or does not fit a terminal becomes CSV.
        """
        width, form = width_of(self.path), self.format
        each: Iterator[Any] = (block for block in blocks if len(block))
        if form.is_for_people:
            if width and not self.is_named:
                is_short, each = _looked_at(each, headings or names, width)
                if not is_short:
                    plain = self._replace(fmt="csv")
                    plain.blocks(names, (plain.format.block(x, names) for x in each))
                    return
            names = headings or names
        with opened(self.path) as stream:
            safe = (self._safe(block) for block in each)
            form.write(stream, [*map(self._safe, names)], safe, width)

    def _safe(self, written: Any) -> Any:
        """Return what is written without control characters if the output is a terminal."""
        if self.format.is_for_people or not is_screen(self.path):
            return written
        if isinstance(written, str):
            return printable(written)
        return printable(written.decode()).encode()


def _looked_at(
    blocks: Iterator[Any], headings: Sequence[str], width: int
) -> tuple[bool, Iterator[Any]]:
    """Return whether blocks of columns are few rows for a terminal, and all of the blocks."""
    from .formats.table import fits  # start-up

    seen, rows = list[Any](), list[Sequence[str]]()
    for block in blocks:
        seen.append(block)
        rows += texts_of(block)
        if len(rows) > MOST_ROWS:
            break
    most = MOST_ROWS if fits(rows_grid(headings, rows), width) else MOST_UPRIGHT
    return len(rows) <= most, chain(seen, blocks)


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
