"""Trajectories as text: a row per line, with commas, semicolons, tabs or white space; JSON lines.

A block of lines goes through NumPy's parser.  Where this refuses it, the lines are read one by one:
empty cells are NaN, and what is no number is named by its line and column.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO

from ..arithmetic.text import quoted
from ..errors import DataError, LagtopError
from .text_tables import NumberedLines, decoded_row, delimiter_of, json_object
from .trajectory_columns import names_in_comments
from .trajectory_rows import Block, PlainNumbers, Table, Words

if TYPE_CHECKING:
    from ..arithmetic.types import Array

_COMMENT = b"#"
_AROUND = b"[], \t"
"""What may stand around the objects of an array, one per line."""

Numbered = tuple[int, bytes]


def read_text(stream: BinaryIO, name: str) -> Table:
    """Return the rows of a text.  Raises DataError where there are none."""
    lines = NumberedLines(stream, name)
    comments: list[str] = []
    for number, raw in lines:
        line = raw.strip(b" \r\n")
        if line.startswith(_COMMENT):
            comments.append(_decoded(line, name, number).lstrip("# \t"))
        elif line in {b"", b"["}:
            continue
        elif line[:1] in {b"{", b"["}:
            return JsonTable(name, (number, line), lines)
        else:
            return TextTable(name, (number, line), lines, comments)
    raise DataError(f"{name} must hold a trajectory, got no row")


def _decoded(line: bytes, name: str, number: int) -> str:
    try:
        text = decoded_row(line)
    except LagtopError as error:
        raise DataError(f"{name}, line {number}: {error}") from None
    if "\0" in text:
        raise DataError(f"{name}, line {number}: a row must be text, got the character NUL")
    return text


def _is_plain(text: bytes) -> bool:
    """Return whether lines are ASCII text without quoted cells, which are left to `_row`."""
    return text.isascii() and b'"' not in text and b"\0" not in text


class TextTable:
    """Rows of a text, with or without a header; comments may give the names too."""

    place = "line"

    def __init__(
        self, name: str, first: Numbered, lines: NumberedLines, comments: Sequence[str]
    ) -> None:
        self.name = name
        self.delimiter = delimiter_of(first[1].decode(errors="replace"))
        cells = self._cells(*first)
        self.width = len(cells)
        has_header = not any(_is_number(cell) for cell in cells)
        self.names: Sequence[str] | None = (
            cells if has_header else names_in_comments(comments, self.width)
        )
        self._lines = chain([[] if has_header else [first]], lines.blocks())
        self._words: dict[int, Words] = {}

    def words_of(self, column: int) -> Words:
        """Return the words of a column."""
        return self._words.setdefault(column, Words())

    def _cells(self, number: int, line: bytes) -> list[str]:
        cells = [x.strip() for x in _decoded(line, self.name, number).split(self.delimiter)]
        for i, cell in enumerate(cells, 1):
            if cell.startswith('"') and (len(cell) == 1 or not cell.endswith('"')):
                raise DataError(
                    f"{self.name}, line {number}, column {i}: a quoted cell must end with its "
                    f"quote, got {quoted(cell)}"
                )
        return [cell.strip('"') for cell in cells]

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns of the rows.  Raises DataError for what is no number."""
        for lines in self._lines:
            block = [x for x in lines if not x[1].startswith(_COMMENT)]
            if block:
                places, texts = zip(*block, strict=True)
                yield Block(self._parsed(block, texts, columns, names), places)

    def _parsed(
        self,
        block: Sequence[Numbered],
        texts: Sequence[bytes],
        columns: Sequence[int],
        names: Sequence[str],
    ) -> Array:
        import numpy as np

        if _is_plain(b"\n".join(texts)):
            with suppress(ValueError):
                values = np.loadtxt(
                    texts,
                    delimiter=self.delimiter,
                    ndmin=2,
                    comments=None,
                    converters={i: words.number for i, words in self._words.items()} or None,
                )
                if values.shape == (len(texts), self.width):
                    return values[:, columns]
        return np.array([self._row(*x, columns, names) for x in block])

    def _row(
        self, number: int, line: bytes, columns: Sequence[int], names: Sequence[str]
    ) -> list[float]:
        cells = self._cells(number, line)
        if len(cells) != self.width:
            raise DataError(
                f"{self.name}, line {number}: a row must have {self.width} cells, got {len(cells)}"
            )
        row = []
        for i, name in zip(columns, names, strict=True):
            if i in self._words:
                row.append(self._words[i].number(cells[i]))
                continue
            if cells[i] and not _is_number(cells[i]):
                raise DataError(
                    f"{self.name}, line {number}, column {i + 1}: {name} must be a number, "
                    f"got {quoted(cells[i])}"
                )
            row.append(float(cells[i] or "nan"))
        return row


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return cell.isascii() and "_" not in cell


class JsonTable:
    """JSON lines, an object per row; an array with an object per line is read as well."""

    place = "line"

    def __init__(self, name: str, first: Numbered, lines: NumberedLines) -> None:
        self.name = name
        self._lines = chain([[first]], lines.blocks())
        bare = first[1].strip(_AROUND)
        entries = self._object(first[0], bare)
        _check_once(bare, name)
        self.sizes = {
            key: len(value) if isinstance(value, list) else 0
            for key, value in entries.items()
            if isinstance(value, int | float | list | str | None)
        }
        self._texts = {key for key, value in entries.items() if isinstance(value, str)}
        self._words: dict[str, Words] = {}
        self.names: Sequence[str] = [
            name for key, n in self.sizes.items() for name in parts(key, n)
        ]
        self.width = len(self.names)

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns of the rows.  Raises DataError for what is no number."""
        import numpy as np

        if wrong := {self.names[i] for i in columns} & self._texts - self._words.keys():
            raise DataError(f"{self.name}, column {min(wrong)}: must be numbers, got texts")
        for lines in self._lines:
            bare = ((i, line.strip(_AROUND)) for i, line in lines)
            if block := [x for x in bare if x[1]]:
                values = np.array([self._row(*x) for x in block], dtype=np.float64)
                yield Block(values[:, columns], [i for i, _ in block])

    def words_of(self, column: int) -> Words:
        """Return the words of a column, or the texts of its numbers."""
        name = self.names[column]
        return self._words.setdefault(name, Words()) if name in self._texts else PlainNumbers()

    def _object(self, number: int, line: bytes) -> dict[str, Any]:
        try:
            return json_object(line)
        except LagtopError as error:
            raise DataError(f"{self.name}, line {number}: {error}") from None

    def _row(self, number: int, line: bytes) -> list[float]:
        row: list[float] = []
        values = self._object(number, line)
        for key, size in self.sizes.items():
            value, count = values.get(key), size or 1
            if key in self._texts:
                words = self._words.get(key)
                row.append(words.number(str(value)) if words else math.nan)
                continue
            numbers = [value] if not size else [None] * size if value is None else value
            if not isinstance(numbers, list) or len(numbers) != count or not _are_real(numbers):
                wanted = f"{size} numbers" if size else "a number"
                raise DataError(
                    f"{self.name}, line {number}, column {key}: must be {wanted}, "
                    f"got {quoted(str(value))}"
                )
            row += [math.nan if x is None else float(x) for x in numbers]
        return row


def _check_once(line: bytes, name: str) -> None:
    """Raise DataError for an object that has a key twice, of which a reader sees the last alone."""
    import json

    counts = Counter(key for key, _ in json.loads(line, object_pairs_hook=list))
    if twice := [key for key, count in counts.items() if count > 1]:
        raise DataError(f"{name} must name each quantity once, got {twice[0]!r} and {twice[0]!r}")


def _are_real(values: Sequence[Any]) -> bool:
    """Return whether each value is a real number or missing."""
    return all(
        x is None or (isinstance(x, int | float) and not isinstance(x, bool)) for x in values
    )


def parts(name: str, size: int) -> list[str]:
    """Return the names of the columns of an entry of so many numbers; a size of 0 is one number."""
    return [f"{name}_{i}" for i in range(size)] if size else [name]
