"""Trajectories as text: a row per line, or JSON lines.

NumPy parses a block of lines at once.  If that fails, the lines are read one by one.  Empty cells
then become NaN, and errors name the line and column of a bad cell.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, BinaryIO

from ..arithmetic.text import quoted
from ..errors import DataError
from .names import repeated
from .scene_file import Description, description_in
from .text_lines import SWAP, Dialect, at_line, decoded_row, is_number, json_object
from .text_tables import TextTable, read_table
from .trajectory_columns import known_quantities, names_in_comments

if TYPE_CHECKING:
    from ..arithmetic.types import Array


Block = tuple["Array", Sequence[int]]
"""Consecutive rows as an array, and their places: numbers of lines, or of rows, from 1.

The array has the shape (rows, requested columns), with NaN for an empty cell.
"""


class Table:
    """Rows of numbers, in any file format."""

    place = "line"
    """The unit of the places of a block: `line` or `row`."""
    description: Description = MappingProxyType({})
    """The description in the file; empty if it has none."""

    def __init__(self, name: str, names: Sequence[str] | None, width: int) -> None:
        """Take the name of the file, the names of the columns, if any, and their number."""
        self.name, self.names, self.width = name, names, width

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns, once, a block of rows at a time; `names` are used in errors.

        Raises DataError for cells that are not numbers.
        """
        raise NotImplementedError

    def word_of(self, column: int) -> Callable[[float], str]:
        """Read a column as numbered words from now on; return a function from number to word.

        In a column of numbers, each number is its own word.
        """
        return "{:.17g}".format


class Words(dict[str, float]):
    """The words of a column, numbered in order of appearance."""

    def number(self, word: str) -> float:
        """Return the number of a word; quotes and blanks around it are ignored."""
        return self.setdefault(word.strip().strip('"'), float(len(self)))

    def word(self, number: float) -> str:
        """Return the word with a number."""
        return list(self)[int(number)]


def read_text(stream: BinaryIO, name: str, dialect: Dialect, width: int | None) -> Table:
    """Return the rows of a text; `width` is the number of columns if their names are given.

    Raises DataError if there are no rows.
    """
    source = read_table(stream, name, dialect, known_quantities, width)
    if not source.first and source.headings is None:
        raise DataError(f"{name} must hold a trajectory, got no row")
    return CellTable(source) if source.around is None else JsonTable(source)


class CellTable(Table):
    """Rows of a text, with or without headings; comments may give the names too."""

    def __init__(self, source: TextTable) -> None:
        """Take the names of the columns.  Raises DataError for a bad first row."""
        self.name, self._source, self._dialect = source.lines.name, source, source.dialect
        self.description, self._words = description_in(source.comments), dict[int, Words]()
        names = source.headings
        width = len(self._cells(*source.first[0]) if names is None else names)
        names = names_in_comments(source.comments, width) if names is None else names
        super().__init__(self.name, names, width)

    def word_of(self, column: int) -> Callable[[float], str]:
        """Read a column as words."""
        return self._words.setdefault(column, Words()).word

    def _cells(self, number: int, line: bytes) -> list[str]:
        with at_line(self.name, number):
            return [x.strip() for x in self._dialect.cells(decoded_row(line))]

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns of the rows."""
        import numpy as np

        self._dialect = self._source.decided(i for i in columns if i not in self._words)
        named = list(zip(columns, names, strict=True))
        for rows in self._source.blocks():
            places, texts = zip(*rows, strict=True)
            values = self._plain(texts)
            if values is None:
                yield np.array([self._row(*x, named) for x in rows]), places
            else:
                yield values[:, columns], places

    def _plain(self, texts: Sequence[bytes]) -> Array | None:
        """Return all columns of rows, or None if NumPy cannot parse them."""
        import numpy as np

        text, swaps = b"\n".join(texts), self._dialect.decimal == ","
        if not text.isascii() or b'"' in text or b"\0" in text or (swaps and self._words):
            return None
        with suppress(ValueError):
            values = np.loadtxt(
                text.translate(SWAP).split(b"\n") if swaps else texts,
                delimiter=None if self._dialect.delimiter == " " else self._dialect.delimiter,
                ndmin=2,
                comments=None,
                converters={i: words.number for i, words in self._words.items()} or None,
            )
            if values.shape == (len(texts), self.width):
                return values
        return None

    def _row(self, number: int, line: bytes, named: Sequence[tuple[int, str]]) -> list[float]:
        cells, where = self._cells(number, line), f"{self.name}, line {number}"
        if len(cells) != self.width:
            raise DataError(f"{where}: a row must have {self.width} cells, got {len(cells)}")
        row = []
        for i, name in named:
            if i in self._words:
                row.append(self._words[i].number(cells[i]))
                continue
            plain = self._dialect.with_point(cells[i])
            if plain and (not is_number(plain) or "," in plain):
                raise DataError(
                    f"{where}, column {i + 1}: {name} must be a number, "
                    f"got {quoted(cells[i])}{self._dialect.remedy(cells[i])}"
                )
            row.append(float(plain or "nan"))
        return row


class JsonTable(Table):
    """JSON lines, an object per row; an array with one object per line is accepted too."""

    def __init__(self, source: TextTable) -> None:
        """Take the names of the columns from the first object.  Raises DataError for a bad one."""
        self.name, self._source = source.lines.name, source
        self.description, self._words = description_in(source.comments), dict[str, Words]()
        entries = self._object(*source.first[0])
        # A parser keeps only the last of several equal keys.
        keys = (key for key, _ in json.loads(source.first[0][1], object_pairs_hook=list))
        if (twice := repeated(keys)) is not None:
            wanted = "must name each quantity once"
            raise DataError(f"{self.name} {wanted}, got {twice!r} and {twice!r}")
        self.sizes = {
            key: len(value) if isinstance(value, list) else 0
            for key, value in entries.items()
            if isinstance(value, int | float | list | str | None)
        }
        self._texts = {key for key, value in entries.items() if isinstance(value, str)}
        self._columns = [part for key, n in self.sizes.items() for part in parts(key, n)]
        super().__init__(self.name, self._columns, len(self._columns))

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns of the rows."""
        import numpy as np

        if wrong := {self._columns[i] for i in columns} & self._texts - self._words.keys():
            raise DataError(f"{self.name}, column {min(wrong)}: must be numbers, got texts")
        for rows in self._source.blocks():
            values = np.array([self._row(*x) for x in rows], dtype=np.float64)
            yield values[:, columns], [i for i, _ in rows]

    def word_of(self, column: int) -> Callable[[float], str]:
        """Read a column as words, if it holds texts."""
        name = self._columns[column]
        if name not in self._texts:
            return super().word_of(column)
        return self._words.setdefault(name, Words()).word

    def _object(self, number: int, line: bytes) -> dict[str, Any]:
        with at_line(self.name, number):
            return json_object(line)

    def _row(self, number: int, line: bytes) -> list[float]:
        row: list[float] = []
        values = self._object(number, line)
        for key, size in self.sizes.items():
            value = values.get(key)
            if key in self._texts:
                words = self._words.get(key)
                row.append(words.number(str(value)) if words is not None else math.nan)
                continue
            numbers = [value] if not size else [None] * size if value is None else value
            if not isinstance(numbers, list) or len(numbers) != (size or 1) or not _real(numbers):
                wanted = f"{size} numbers" if size else "a number"
                raise DataError(
                    f"{self.name}, line {number}, column {key}: must be {wanted}, "
                    f"got {quoted(str(value))}"
                )
            row += [math.nan if x is None else float(x) for x in numbers]
        return row


def _real(values: Sequence[Any]) -> bool:
    """Return whether each value is a real number or missing."""
    return all(
        x is None or (isinstance(x, int | float) and not isinstance(x, bool)) for x in values
    )


def parts(name: str, size: int) -> list[str]:
    """Return the names of the columns of an entry with `size` numbers; 0 means a single number."""
    return [f"{name}_{i}" for i in range(size)] if size else [name]
