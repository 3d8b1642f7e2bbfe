"""Tables as text: numbered lines, comments, delimiters, cells and JSON objects.

The readers of tops, times and trajectories share these, so that their lines have one grammar.
Only the cells of a trajectory are split elsewhere, mostly by NumPy (see `trajectory_text`).
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from io import BufferedIOBase
from typing import Any, BinaryIO

from ..arithmetic.text import json_text, shortened
from ..errors import DataError, LagtopError

LONGEST_LINE = 1 << 20
"""Bytes of a line: memory does not grow with a file that has no line ends."""
BYTES_AT_ONCE = 1 << 21
DELIMITERS = ",;\t"
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


class NumberedLines:
    """The lines of a file with their numbers, from 1; each is yielded once."""

    def __init__(self, stream: BufferedIOBase | BinaryIO, name: str) -> None:
        self.stream, self.name, self.number = stream, name, 0

    def __iter__(self) -> Iterator[tuple[int, bytes]]:
        """Yield the next lines one by one.  Raises DataError for a long line."""
        while line := self.stream.readline(LONGEST_LINE):
            self.number += 1
            self._check_length(line, self.number)
            yield self.number, line.removeprefix(_BYTE_ORDER_MARK) if self.number == 1 else line

    def blocks(self) -> Iterator[list[tuple[int, bytes]]]:
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


def has_row(line: bytes) -> bool:
    """Return whether a line is neither blank nor a comment, which begins with #."""
    bare = line.strip()
    return bool(bare) and not bare.startswith(b"#")


def decoded_row(line: bytes, what: str = "a row") -> str:
    """Return the text of a line.  Raises LagtopError for a line that is not UTF-8."""
    try:
        return line.decode().rstrip("\r\n")
    except UnicodeDecodeError:
        raise LagtopError(f"{what} must be UTF-8 text") from None


def delimiter_of(header: str) -> str | None:
    """Return the delimiter of a table by its first row, None for white space."""
    return next((x for x in DELIMITERS if x in header), None)


def split_cells(line: str, delimiter: str) -> list[str]:
    """Return the cells of a line of CSV.

    A quoted cell ends on its line, or one open quote would swallow the rows that follow.  Raises
    LagtopError for a wrong quote.
    """
    if '"' not in line:
        return line.split(delimiter)
    try:
        return next(csv.reader([line], strict=True, delimiter=delimiter))
    except csv.Error as error:
        raise LagtopError(f"a row must be CSV, got a wrong quote: {error}") from None


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
