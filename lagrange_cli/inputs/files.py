"""Input files, or standard input for `-`: their names and their bytes.

Every error in reading an input file is a DataError, even if the file does not exist.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from io import BufferedIOBase, BufferedReader, RawIOBase
from typing import Any, BinaryIO, cast

from ..errors import CannotWriteError, DataError
from .text_lines import NumberedLines

_AT_ONCE = 1 << 16
_GZIP, _UTF16 = b"\x1f\x8b", (b"\xff\xfe", b"\xfe\xff")


@contextmanager
def reading(path: str) -> Iterator[BufferedIOBase]:
    """Open a file for reading bytes, or standard input for `-`.

    Raises DataError if the file cannot be opened, or if reading fails inside the block.
    """
    try:
        if path == "-":
            if sys.stdin is None:
                raise OSError("it is closed: give a file in place of -")
            yield cast(BufferedIOBase, sys.stdin.buffer)
            return
        with open(path, "rb") as file:
            yield file
    except OSError as error:
        raise DataError(f"{shown_path(path)}: {error.strerror or error}") from None


@contextmanager
def decoded_file(path: str, stream: BufferedIOBase | None = None) -> Iterator[BufferedReader]:
    """Open a file like `reading`; gzip is decompressed, and marked UTF-16 becomes UTF-8.

    An open `stream` is read in place of the path, and closed.  Raises DataError for a broken file,
    here or while it is read.
    """
    name = shown_path(path)
    with stream or reading(path) as file:
        reader = found = BufferedReader(cast(Any, file), _AT_ONCE)
        if found.peek(2)[:2] == _GZIP:
            found = BufferedReader(_Chunks(_decompressed(found, name)), _AT_ONCE)
        if found.peek(2)[:2] in _UTF16:
            found = BufferedReader(_Chunks(_from_utf16(found, name)), _AT_ONCE)
        try:
            yield found
        finally:
            with suppress(ValueError):  # the stream may be closed
                reader.detach()


class _Chunks(RawIOBase):
    """Forward-only stream over chunks of bytes."""

    def __init__(self, chunks: Iterator[bytes]) -> None:
        self._chunks, self._left = chunks, memoryview(b"")

    def readable(self) -> bool:
        """Return True: the stream is readable."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Fill a buffer with the next bytes, and return their number."""
        if not self._left:
            self._left = memoryview(next(filter(None, self._chunks), b""))
        count = min(len(buffer), len(self._left))
        buffer[:count], self._left = self._left[:count], self._left[count:]
        return count


def _decompressed(stream: BufferedReader, name: str) -> Iterator[bytes]:
    import gzip  # for few files only, like zlib
    import zlib

    try:
        with gzip.GzipFile(fileobj=stream) as file:
            while chunk := file.read(_AT_ONCE):
                yield chunk
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise DataError(f"{name}: not a gzip file: {error}") from None


def _from_utf16(stream: BufferedReader, name: str) -> Iterator[bytes]:
    from codecs import getincrementaldecoder

    decoder = getincrementaldecoder("utf-16")()
    try:
        while chunk := stream.read(_AT_ONCE):
            yield decoder.decode(chunk).encode()
        decoder.decode(b"", True)
    except UnicodeError as error:
        raise DataError(f"{name}: not UTF-16 text: {error}") from None


@contextmanager
def temporary_files() -> Iterator[None]:
    """Raise CannotWriteError if a temporary file or folder cannot be made or written."""
    try:
        yield
    except OSError as error:
        raise CannotWriteError(f"cannot write temporary files: {error.strerror}") from None


@contextmanager
def temporary_copy(stream: BufferedIOBase) -> Iterator[BinaryIO]:
    """Copy the unread part of a stream to a temporary file, deleted at the end of the block.

    Raises CannotWriteError if there is no space for the file.
    """
    from tempfile import TemporaryFile

    with ExitStack() as stack:
        with temporary_files():
            copy = stack.enter_context(TemporaryFile())
        while chunk := stream.read(1 << 20):
            with temporary_files():
                copy.write(chunk)
        with temporary_files():
            copy.seek(0)
        yield cast(BinaryIO, copy)


def utf8_path(path: str) -> str:
    """Return the name of a file, with bytes that are not UTF-8 escaped."""
    return path.encode("utf-8", "backslashreplace").decode()


def shown_path(path: str) -> str:
    """Return the name of a file for messages."""
    return "standard input" if path == "-" else utf8_path(path) or "''"


def digested(path: str) -> tuple[BufferedIOBase | None, str]:
    """Return the digest of a file, and a copy of it on disk if it can be read only once."""
    with reading(path) as file:
        if file.seekable():
            next(iter(NumberedLines(file, shown_path(path))), None)  # /dev/zero has no digest
            return None, _digest(file)
        with temporary_copy(file) as copy:
            return os.fdopen(os.dup(copy.fileno()), "rb"), _digest(cast(BufferedIOBase, copy))


def _digest(stream: BufferedIOBase) -> str:
    from hashlib import file_digest  # for sweeps in parts only

    stream.seek(0)
    digest = file_digest(stream, "sha256").hexdigest()
    stream.seek(0)
    return f"sha256:{digest}"
