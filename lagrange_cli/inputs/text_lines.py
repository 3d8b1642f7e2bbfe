"""Lines of text files: numbered, of limited length, with a row, a comment or nothing in each."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedIOBase
from typing import Any, BinaryIO

from ..arithmetic.text import json_text, shortened
from ..errors import DataError, LagtopError

LONGEST_LINE = 1 << 20
"""Bytes of a line: memory does not grow with a file that has no line ends."""
BYTES_AT_ONCE = 1 << 21
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"

Numbered = tuple[int, bytes]


class NumberedLines:
    """The lines of a file with their numbers, from 1; each is yielded once."""

    def __init__(self, stream: BufferedIOBase | BinaryIO, name: str) -> None:
        self.stream, self.name, self.number = stream, name, 0

    def __iter__(self) -> Iterator[Numbered]:
        """Yield the next lines one by one.  Raises DataError for a long line."""
        while line := self.stream.readline(LONGEST_LINE):
            self.number += 1
            self._check_length(line, self.number)
            yield self.number, line.removeprefix(_BYTE_ORDER_MARK) if self.number == 1 else line

    def blocks(self) -> Iterator[list[Numbered]]:
        """Yield the next lines many at once, stripped and without blank ones.

        Raises DataError for a long line.
        """
        while chunk := self.stream.read(BYTES_AT_ONCE):
            if not chunk.endswith(b"\n"):
                chunk += self.stream.readline(LONGEST_LINE)
            first, self.number = self.number + 1, self.number + chunk.count(b"\n")
            lines = chunk.split(b"\n")
            longest = max(lines, key=len)
            self._check_length(longest, first + lines.index(longest))
            stripped = (line.strip(b" \r") for line in lines)
            yield [x for x in enumerate(stripped, first) if x[1]]

    def _check_length(self, line: bytes, number: int) -> None:
        if len(line) >= LONGEST_LINE:
            wrong = f"a line must have less than {LONGEST_LINE} bytes"
            raise DataError(f"{self.name}, line {number}: {wrong}")


@contextmanager
def at_line(name: str, number: int) -> Iterator[None]:
    """Raise an error about a line as a DataError that names it."""
    try:
        yield
    except DataError:
        raise
    except LagtopError as error:
        raise DataError(f"{name}, line {number}: {error}") from None


def has_row(line: bytes) -> bool:
    """Return whether a line is neither blank nor a comment, which begins with #."""
    bare = line.strip()
    return bool(bare) and not bare.startswith(b"#")


def decoded_row(line: bytes) -> str:
    """Return the text of a line.  Raises LagtopError for a line that is not UTF-8 text."""
    try:
        text = line.decode().rstrip("\r\n")
    except UnicodeDecodeError:
        raise LagtopError("a row must be UTF-8 text") from None
    if "\0" in text:
        raise LagtopError("a row must be text, got the character NUL")
    return text


def json_object(line: bytes) -> dict[str, Any]:
    """Return the object of a line.  Raises LagtopError for any other line."""
    import orjson

    try:
        values = orjson.loads(line)
    except ValueError as error:
        raise LagtopError(f"a row must be a JSON object: {error}") from None
    if not isinstance(values, dict):
        raise LagtopError(f"a row must be a JSON object, got {shown_json(values)}")
    return values


def shown_json(value: Any) -> str:
    """Return a JSON value for a message."""
    return shortened(json_text(value))
