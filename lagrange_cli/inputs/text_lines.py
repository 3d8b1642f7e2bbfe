"""Lines of text files: numbered, of limited length, each with a row, a comment or nothing.

A `Dialect` splits a row into cells and reads the numbers in them.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from io import BufferedIOBase
from typing import Any, BinaryIO, NamedTuple

from ..arithmetic.text import json_text, parse_number, quoted, shortened
from ..errors import DataError, LagtopError

LONGEST_LINE = 1 << 20
"""Most bytes of a line, so that memory stays limited for a file without line ends."""
BYTES_AT_ONCE = 1 << 21
_RULE = "\u2500".encode()
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
SWAP = bytes.maketrans(b",.", b".,")
"""Exchanges decimal points and commas."""
DIGITS = r"(?:\d+(?:\.\d*|,\d+)?|[.,]\d+)(?:[eE][+-]?\d+)?"
_NUMBER = re.compile(rf"[+-]?(?:{DIGITS}|nan|inf)", re.IGNORECASE | re.ASCII)
_THOUSANDS = re.compile(
    r"[+-]?\d{1,3}(?:,\d{3}(?:,\d{3})*\.\d*|\.\d{3}(?:\.\d{3})*,\d*|(?:,\d{3}){2,}|(?:\.\d{3}){2,})",
    re.ASCII,
)
_PERHAPS_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
_QUOTED_OR_PLAIN = re.compile(r'(?:"((?:[^"]|"")*)"|([^\s"]\S*))(?=\s|$)')

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

    def blocks(self) -> Iterator[Iterable[Numbered]]:
        """Yield the next lines, many at once.  Raises DataError for a long line."""
        while chunk := self.stream.read(BYTES_AT_ONCE):
            if not chunk.endswith(b"\n"):
                chunk += self.stream.readline(LONGEST_LINE)
            first, self.number = self.number + 1, self.number + chunk.count(b"\n")
            lines = chunk.split(b"\n")
            longest = max(lines, key=len)
            self._check_length(longest, first + lines.index(longest))
            yield enumerate(lines, first)

    def _check_length(self, line: bytes, number: int) -> None:
        if len(line) >= LONGEST_LINE:
            wrong = f"a line must have less than {LONGEST_LINE} bytes"
            raise DataError(f"{self.name}, line {number}: {wrong}")


@contextmanager
def at_line(name: str, number: int) -> Iterator[None]:
    """Turn a LagtopError about a line into a DataError that names the line."""
    try:
        yield
    except DataError:
        raise
    except LagtopError as error:
        raise DataError(f"{name}, line {number}: {error}") from None


def has_row(line: bytes) -> bool:
    """Return whether a line holds a row: no blank line, comment, or rule of a drawn table."""
    bare = line.strip()
    return bool(bare) and not bare.startswith((b"#", _RULE))


def decoded_row(line: bytes) -> str:
    """Return the text of a line.  Raises LagtopError for a line that is not UTF-8 text."""
    try:
        text = line.decode().rstrip("\r\n")
    except UnicodeDecodeError:
        raise LagtopError("a row must be UTF-8 text: save the file as UTF-8") from None
    if "\0" in text:
        raise LagtopError("a row must be text, got the character NUL")
    return text


def json_object(line: bytes) -> dict[str, Any]:
    """Parse a line as a JSON object.  Raises LagtopError for any other line."""
    import orjson

    try:
        values = orjson.loads(line)
    except orjson.JSONDecodeError as error:
        wrong = f"{error.msg} at character {error.colno}"
        raise LagtopError(f"a row must be a JSON object: {wrong}") from None
    if not isinstance(values, dict):
        raise LagtopError(f"a row must be a JSON object, got {shown_json(values)}")
    return values


def shown_json(value: Any) -> str:
    """Return a JSON value as text for a message."""
    return shortened(json_text(value))


class Dialect(NamedTuple):
    """The delimiter and the decimal mark of a table; an empty text means not decided yet."""

    delimiter: str = ""
    """A comma, a semicolon, a tab, or a blank for any white space."""
    decimal: str = ""
    """A point or a comma."""

    def cells(self, text: str) -> list[str]:
        """Return the cells of a line.

        A quoted cell must end on its line; otherwise an open quote would swallow the rows below.
        Raises LagtopError for a wrong quote.
        """
        delimiter = self.delimiter
        if '"' not in text:
            return text.split() if delimiter == " " else text.split(delimiter)
        if delimiter == " ":
            return _cells_between_blanks(text)
        try:
            skips = f'{delimiter} "' in text
            lines = csv.reader([text], strict=True, delimiter=delimiter, skipinitialspace=skips)
            return next(lines)
        except csv.Error:
            cells = enumerate(text.split(delimiter), 1)
            number, cell = next((x for x in cells if x[1].count('"') % 2), (1, text))
            raise _wrong_quote(cell, number) from None

    def row(self, line: bytes, width: int) -> list[str]:
        """Return the cells of a line.  Raises LagtopError unless there are `width` cells."""
        cells = self.cells(decoded_row(line))
        if len(cells) != width:
            raise LagtopError(f"a row must have {width} cells, got {len(cells)}")
        return cells

    def number(self, cell: str) -> Fraction:
        """Return the number in a cell exactly.  Raises LagtopError with the cell as written."""
        plain, bare = self.with_point(cell), cell.strip()
        try:
            return parse_number(plain)
        except LagtopError as error:
            wrong = str(error).replace(quoted(plain.strip()), quoted(bare))
            hint = self.remedy(bare)
            raise LagtopError(f"{wrong.partition(' (')[0]}{hint}" if hint else wrong) from None

    def with_point(self, cell: str) -> str:
        """Return a cell with a decimal point; a cell with the other mark then fails to parse."""
        return cell.translate({44: 46, 46: 44}) if self.decimal == "," else cell

    def remedy(self, cell: str) -> str:
        """Return a hint in parentheses if a cell is a number with the other decimal mark."""
        other = "point" if self.decimal == "," else "comma"
        helps = self.delimiter != "," and is_number(cell) and set(cell) & {",", "."}
        return f" (use --decimal {other})" if helps else ""


UNDECIDED = Dialect()


def is_number(cell: str) -> bool:
    """Return whether a cell is a number, with either decimal mark, or nan or inf."""
    return _NUMBER.fullmatch(cell) is not None


def decimal_mark(cell: str) -> str:
    """Return the decimal mark of a number; `perhaps` for a comma that may separate thousands."""
    if _THOUSANDS.fullmatch(cell):
        return "thousands"
    if not is_number(cell):
        return ""
    if _PERHAPS_THOUSANDS.fullmatch(cell):
        return "perhaps"
    return next((mark for mark in ",." if mark in cell), "")


def _cells_between_blanks(text: str) -> list[str]:
    cells, rest = list[str](), text.strip()
    while rest:
        found = _QUOTED_OR_PLAIN.match(rest)
        if found is None:
            raise _wrong_quote(rest, len(cells) + 1)
        quoted_cell, plain = found.groups()
        cells.append(plain if quoted_cell is None else quoted_cell.replace('""', '"'))
        rest = rest[found.end() :].lstrip()
    return cells


def _wrong_quote(cell: str, number: int) -> LagtopError:
    return LagtopError(
        f"a quoted cell must end with its quote, got {quoted(cell.strip())} in column {number}"
    )
