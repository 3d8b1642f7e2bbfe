"""Trajectories as text: a row per line, or JSON lines.

NumPy parses a block of lines at once.  If that fails, the lines are read one by one.  Empty cells
then become NaN, and errors name the line and column of a bad cell.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple, Protocol

from ..arithmetic.text import quoted
from ..errors import DataError
from .descriptions import Description, description_in
from .text_lines import (
    SWAP,
    Dialect,
    Numbered,
    at_line,
    decoded_row,
    has_row,
    is_number,
    json_object,
)
from .text_tables import TableHead, read_head
from .trajectory_columns import known_quantities, names_in_comments

if TYPE_CHECKING:
    from ..arithmetic.types import Array


class Block(NamedTuple):
    """Consecutive rows and their places in the file."""

    values: Array
    """Array of shape (rows, requested columns); NaN for an empty cell."""
    places: Sequence[int]
    """The numbers of the lines, or of the rows in a file without lines, from 1."""


class Words:
    """The words of a column, numbered in order of appearance."""

    def __init__(self) -> None:
        self._numbers: dict[str, float] = {}

    def number(self, word: str) -> float:
        """Return the number of a word; quotes and blanks around it are ignored."""
        return self._numbers.setdefault(word.strip().strip('"'), float(len(self._numbers)))

    def word(self, number: float) -> str:
        """Return the word with a number."""
        return list(self._numbers)[int(number)]


class PlainNumbers(Words):
    """The numbers of a column, as words."""

    def number(self, word: str) -> float:
        """Return the number itself."""
        return float(word)

    def word(self, number: float) -> str:
        """Return the number as text, without a fraction if it is whole."""
        return f"{number:.17g}"


class Table(Protocol):
    """Rows of numbers, in any file format."""

    @property
    def place(self) -> str:
        """The unit of the places of a block: `line` or `row`."""

    @property
    def width(self) -> int:
        """The number of columns."""

    @property
    def description(self) -> Description:
        """The description in the file; empty if it has none."""

    @property
    def names(self) -> Sequence[str] | None:
        """The names of the columns, or None."""

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns, once, a block of rows at a time; `names` are used in errors."""

    def words_of(self, column: int) -> Words:
        """Return the words of a column, which is read as their numbers from now on."""


def read_text(stream: BinaryIO, name: str, dialect: Dialect, width: int | None) -> Table:
    """Return the rows of a text; `width` is the number of columns if their names are given.

    Raises DataError if there are no rows.
    """
    head = read_head(stream, name, dialect, known_quantities, width)
    if not head.kept and head.headings is None:
        raise DataError(f"{name} must hold a trajectory, got no row")
    return TextTable(name, head) if head.around is None else JsonTable(name, head)


def _lines(head: TableHead) -> Iterator[list[Numbered]]:
    """Yield the lines of a table, many at once and without blank ones."""
    kept = ((number, line.strip(b" \r\n")) for number, line in head.kept)
    return chain([[x for x in kept if x[1]]], head.lines.blocks())


class TextTable:
    """Rows of a text, with or without headings; comments may give the names too."""

    place = "line"

    def __init__(self, name: str, head: TableHead) -> None:
        self.name, self._head, self._words = name, head, dict[int, Words]()
        self._dialect = head.dialect
        self.description = description_in(head.comments)
        rows = head.rows()
        self.names = head.headings
        if head.headings is None:
            self.width = len(self._cells(*rows[0]))
            self.names = names_in_comments(head.comments, self.width)
        else:
            self.width = len(head.headings)

    def words_of(self, column: int) -> Words:
        """Return the words of a column."""
        return self._words.setdefault(column, Words())

    def _cells(self, number: int, line: bytes) -> list[str]:
        with at_line(self.name, number):
            return [x.strip() for x in self._dialect.cells(decoded_row(line))]

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns of the rows.  Raises DataError for what is no number."""
        self._dialect = self._head.decided(i for i in columns if i not in self._words)
        for lines in _lines(self._head):
            block = [x for x in lines if has_row(x[1])]
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

        text = b"\n".join(texts)
        swaps = self._dialect.decimal == ","
        is_plain = text.isascii() and b'"' not in text and b"\0" not in text
        if is_plain and not (swaps and self._words):  # `_row` reads all others
            delimiter = None if self._dialect.delimiter == " " else self._dialect.delimiter
            if swaps:
                texts = text.translate(SWAP).split(b"\n")
            with suppress(ValueError):
                values = np.loadtxt(
                    texts,
                    delimiter=delimiter,
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
            plain = self._dialect.with_point(cells[i])
            if plain and (not is_number(plain) or "," in plain):
                raise DataError(
                    f"{self.name}, line {number}, column {i + 1}: {name} must be a number, "
                    f"got {quoted(cells[i])}{self._dialect.remedy(cells[i])}"
                )
            row.append(float(plain or "nan"))
        return row


class JsonTable:
    """JSON lines, an object per row; an array with one object per line is accepted too."""

    place = "line"

    def __init__(self, name: str, head: TableHead) -> None:
        self.name, self._around = name, head.around
        self.description = description_in(head.comments)
        self._lines = _lines(head)
        number, bare = next(
            ((i, x) for i, line in head.kept if (x := line.strip(head.around))), (1, b"")
        )
        entries = self._object(number, bare)
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
            bare = ((i, line.strip(self._around)) for i, line in lines)
            if block := [x for x in bare if has_row(x[1])]:
                values = np.array([self._row(*x) for x in block], dtype=np.float64)
                yield Block(values[:, columns], [i for i, _ in block])

    def words_of(self, column: int) -> Words:
        """Return the words of a column, or its numbers as texts."""
        name = self.names[column]
        return self._words.setdefault(name, Words()) if name in self._texts else PlainNumbers()

    def _object(self, number: int, line: bytes) -> dict[str, Any]:
        with at_line(self.name, number):
            return json_object(line)

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
    """Raise DataError for an object with a repeated key, of which a parser keeps only the last."""
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
    """Return the names of the columns of an entry with `size` numbers; 0 means a single number."""
    return [f"{name}_{i}" for i in range(size)] if size else [name]
