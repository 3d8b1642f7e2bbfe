"""Files that are read, or standard input for `-`: their names, and the error where they cannot be.

Whatever is wrong with a file of inputs is a DataError, that it is not there among it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from io import BufferedIOBase, BytesIO
from typing import BinaryIO, cast

from ..errors import CannotWriteError, DataError


@contextmanager
def opened(path: str) -> Iterator[BufferedIOBase]:
    """Open a file for reading bytes, or standard input for `-`.

    Raises DataError where it cannot be opened, and where it cannot be read inside.
    """
    try:
        if path == "-":
            yield cast(BufferedIOBase, sys.stdin.buffer) if sys.stdin else BytesIO()
            return
        with open(path, "rb") as file:
            yield file
    except OSError as error:
        raise DataError(f"{shown_path(path)}: {error.strerror or error}") from None


@contextmanager
def temporary_files() -> Iterator[None]:
    """Raise CannotWriteError if a temporary file or folder cannot be made or written."""
    try:
        yield
    except OSError as error:
        raise CannotWriteError(f"cannot write temporary files: {error.strerror}") from None


@contextmanager
def temporary_copy(stream: BufferedIOBase) -> Iterator[BinaryIO]:
    """Yield a file with what is left of a stream, which is gone when the block ends.

    Raises CannotWriteError if there is no space for it.
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
    """Return the name of a file with escapes in place of bytes that are not UTF-8."""
    return path.encode("utf-8", "backslashreplace").decode()


def shown_path(path: str) -> str:
    """Return the name of a file for messages."""
    return "standard input" if path == "-" else utf8_path(path) or "''"
