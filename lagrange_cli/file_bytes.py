"""Input files, or standard input for `-`: their names, bytes and text.

Every error in reading an input file is a DataError, even if the file does not exist.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BytesIO
from typing import Any

from .errors import DataError

LARGEST_FILE = 1 << 28
"""Most bytes of an input file after decompression.  Reading takes up to 21 times the memory."""
_AT_ONCE = 1 << 20
_BINARY = (
    *(b"PAR1", b"PK\x03\x04", b"PK\x05\x06", b"\xd0\xcf\x11\xe0", b"\x93NUM"),
    *(b"\x89HDF", b"ARROW1", b"#ROSBAG", b"\x89MCAP"),
)
"""The first bytes of Parquet, archives and new workbooks, empty archives, old workbooks, npy, HDF5,
Feather and bags of ROS."""
_GZIP, _UTF16 = b"\x1f\x8b", (b"\xff\xfe", b"\xfe\xff")


def read_bytes(path: str, most: int = LARGEST_FILE) -> bytes:
    """Return the contents of a file, or of standard input for `-`; gzip is decompressed.

    Raises DataError for a file that cannot be read, or that has more than `most` bytes.
    """
    try:
        with _opened(path) as file:
            content = _read_whole(file, most)
        if content[:2] == _GZIP:
            import gzip  # for few files only, like zlib
            import zlib

            try:
                with gzip.open(BytesIO(content)) as file:
                    content = _read_whole(file, most)
            except (EOFError, zlib.error, gzip.BadGzipFile) as error:
                raise OSError(f"not a gzip file: {error}") from None
    except OSError as error:
        remedy = ": pass a file" if isinstance(error, IsADirectoryError) else ""
        raise DataError(f"{shown_path(path)}: {error.strerror or error}{remedy}") from None
    return content


@contextmanager
def _opened(path: str) -> Iterator[Any]:
    """Open a file for reading bytes.  Standard input waits for all of its bytes."""
    if path != "-":
        with open(path, "rb") as file:
            yield file
        return
    if sys.stdin is None:
        raise OSError("it is closed: give a file in place of -")
    with suppress(OSError, AttributeError):  # stand-ins of a test, Windows before Python 3.12
        os.set_blocking(sys.stdin.fileno(), True)
    yield sys.stdin.buffer


def _read_whole(file: Any, most: int) -> bytes:
    """Return the bytes of a file.  Raises OSError for more than `most` of them."""
    chunks, size = list[bytes](), 0
    while chunk := file.read(_AT_ONCE):
        chunks.append(chunk)
        size += len(chunk)
        if size > most:
            raise OSError(f"it must have at most {most} bytes, has more")
        if len(chunk) < _AT_ONCE:
            break  # a terminal ends at the first Ctrl-D, and goes on if it is read again
    return b"".join(chunks)


def decoded(content: bytes, name: str) -> str:
    r"""Return UTF-8 text, or marked UTF-16 text, with `\n` as the only line end.

    Raises DataError for other bytes and for NUL, with their line.
    """
    wrong = "it is not text but a workbook, an archive or binary data: save it as CSV"
    if content.startswith(_BINARY):
        raise DataError(f"{name}: {wrong}")
    try:
        text = content.decode("utf-16" if content[:2] in _UTF16 else "utf-8-sig")
    except UnicodeDecodeError as error:
        if b"\0" in content and content[:2] not in _UTF16:
            raise DataError(f"{name}: {wrong}") from None
        line = content.count(b"\n", 0, error.start) + 1
        wrong = "the text must be UTF-8 or UTF-16: save the file as UTF-8"
        raise DataError(f"{name}, line {line}: {wrong}") from None
    if (place := text.find("\0")) >= 0:  # UTF-16 without its mark has one in each letter
        line = text.count("\n", 0, place) + 1
        raise DataError(f"{name}, line {line}: the text has a NUL byte: save the file as UTF-8")
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def extension(path: str) -> str:
    """Return the extension of a file, in lower case and without its dot."""
    return os.path.splitext(path)[1][1:].lower()


def utf8_path(path: str) -> str:
    """Return the name of a file, with bytes that are not UTF-8 escaped."""
    return path.encode("utf-8", "backslashreplace").decode()


def shown_path(path: str) -> str:
    """Return the name of a file for messages."""
    return "standard input" if path == "-" else utf8_path(path) or "''"
