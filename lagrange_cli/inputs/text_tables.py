"""Text tables: the one reader of files of tops, trajectories, recordings and times.

A row is one line: cells separated by tabs, semicolons, commas or blanks, or a JSON object.  The
delimiter, the headings and the decimal mark are decided once per file, from its first rows.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import json_text, parse_number, quoted, shortened
from ..errors import DataError, LagtopError
from .files import decoded

if TYPE_CHECKING:
    from ..arithmetic.types import Array

_SAMPLE = 1000
"""Number of rows that decide whether numbers have decimal commas."""
_TITLES = 5
"""The headings are within these first rows, perhaps below a title such as Tracker's `mass A`."""
_LINES_AT_ONCE = 50_000
_SWAPPED = str.maketrans(",.", ".,")
_DIGITS = r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?"
_NUMBER = re.compile(rf"{_DIGITS}|[+-]?(?:nan|inf)", re.IGNORECASE | re.ASCII)
_MAYBE_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+", re.ASCII)
_ENCLOSED = re.compile(r'"[^"]*"|\[[^\]]*\]|\([^)]*\)')
_HEADING = re.compile(r'"[^"]*"|[^\s\[(]+(?:\s*[\[(][^\])]*[\])])*')
_LABVIEW, _END_OF_HEADER = "LabVIEW Measurement", "***End_of_Header***"
"""The first and the last line of a header of LabVIEW."""
Known = Callable[[Sequence[str]], int]
"""Returns the number of known headings in a row, which distinguishes headings from titles."""


class Table:
    """The rows of a file in memory: cells of text, values of JSON, or numbers."""

    place = "line"
    """The unit of the places of rows in messages: `line` or `row`."""

    def __init__(self, name: str, headings: Sequence[str] | None, width: int) -> None:
        """Take the name of the file for messages, the names of its columns, and their number."""
        self.name, self.headings, self.width = name, headings, width

    def rows(self) -> Sequence[Sequence[Any]]:
        """Return the cells of all rows, or the values of JSON.  Raises DataError."""
        raise NotImplementedError

    def column(self, index: int) -> list[Any]:
        """Return the cells of one column.  Raises DataError for a row of another width."""
        return [row[index] for row in self.rows()]

    def numbers(self, columns: Sequence[int], names: Sequence[str]) -> Array:
        """Return columns of numbers, shape (rows, columns), with NaN for empty cells.

        `names` are the names of all columns in messages.  Raises DataError with the place of a cell
        that is no number.
        """
        raise NotImplementedError

    def decide(self, columns: Iterable[int]) -> None:
        """Set the decimal mark from the first rows of some columns, unless it is set.

        Raises DataError if a comma may be a decimal mark or separate thousands.
        """

    def number(self, cell: Any) -> Fraction:
        """Return the number in a cell exactly.  Raises LagtopError with the cell as written."""
        raise NotImplementedError

    @property
    def lines(self) -> Sequence[int]:
        """The line of each row, or its number, from 1."""
        raise NotImplementedError

    def where(self, row: int) -> str:
        """Return the name of the file and the place of a row."""
        return f"{self.name}, {self.place} {self.lines[row]}"


class TextTable(Table):
    """Rows of cells."""

    def __init__(
        self,
        name: str,
        lines: Sequence[str],
        first: int,
        headings: Sequence[str] | None,
        *,
        delimiter: str,
        decimal: str = "",
        comments: Sequence[str] = (),
    ) -> None:
        """Take all lines, and the index of the `first` one below the headings.

        `decimal` is a point or a comma, or empty if the first rows decide.  `comments` are the
        texts of comments above the headings.
        """
        self.name, self.comments, self._all, self._first = name, comments, lines, first
        self.texts = [x for x in lines[first:] if _is_row(x)]
        self.delimiter, self.decimal = delimiter, "." if delimiter == "," else decimal
        width = len(headings or (self._cells(0) if self.texts else ()))
        super().__init__(name, headings, width)

    @cached_property
    def lines(self) -> Sequence[int]:
        """The line of each row, from 1."""
        return [i + 1 for i in range(self._first, len(self._all)) if _is_row(self._all[i])]

    def rows(self) -> Sequence[Sequence[str]]:
        """Return the cells of all rows.  Raises DataError for a row of another width."""
        return list(map(self.row, range(len(self.texts))))

    def row(self, index: int) -> list[str]:
        """Return the cells of a row.  Raises DataError for a row of another width."""
        cells = self._cells(index)
        if len(cells) != self.width:
            wrong = f"a row must have {self.width} cells, got {len(cells)}"
            raise DataError(f"{self.where(index)}: {wrong}")
        return cells

    def _cells(self, index: int) -> list[str]:
        try:
            return cells_of(self.texts[index], self.delimiter)
        except LagtopError as error:
            raise DataError(f"{self.where(index)}: {error}") from None

    def decide(self, columns: Iterable[int]) -> None:
        """Set the decimal mark from the first rows of some columns, unless it is set."""
        if self.decimal:
            return
        wanted, places = set(columns), dict[str, int]()
        for i, text in enumerate(self.texts[:_SAMPLE]):
            for j, cell in enumerate(self._cells(i) if "," in text else ()):
                if j in wanted and "," in cell and _NUMBER.fullmatch(cell):
                    places.setdefault(cell, i)
        if places and all(map(_MAYBE_THOUSANDS.fullmatch, places)):
            cell, i = next(iter(places.items()))
            wrong = f"a comma may be a decimal mark or separate thousands, got {quoted(cell)}"
            raise DataError(f"{self.where(i)}: {wrong}: pass --decimal point or --decimal comma")
        self.decimal = "," if places else "."

    def numbers(self, columns: Sequence[int], names: Sequence[str]) -> Array:
        """Return columns of numbers, shape (rows, columns), with NaN for empty cells."""
        import numpy as np

        self.decide(columns)
        blocks = []
        for first in range(0, len(self.texts), _LINES_AT_ONCE):
            texts = self.texts[first : first + _LINES_AT_ONCE]
            values = self._plain(texts)
            if values is None:
                rows = range(first, first + len(texts))
                blocks.append(np.array([self._doubles(i, columns, names) for i in rows]))
            else:
                blocks.append(values[:, columns])
        return np.concatenate(blocks) if blocks else np.empty((0, len(columns)))

    def _plain(self, texts: Sequence[str]) -> Array | None:
        """Return all columns of some rows, or None if NumPy does not read them."""
        import numpy as np

        text = "\n".join(texts)
        if not text.isascii() or '"' in text or "\0" in text:
            return None
        if self.decimal == ",":
            texts = text.translate(_SWAPPED).split("\n")
        delimiter = None if self.delimiter == " " else self.delimiter
        try:
            values = np.loadtxt(texts, delimiter=delimiter, ndmin=2, comments=None)
        except ValueError:
            return None
        return values if values.shape == (len(texts), self.width) else None

    def _doubles(self, index: int, columns: Sequence[int], names: Sequence[str]) -> list[float]:
        cells = self.row(index)
        return [self._double(index, i, names[i], cells[i]) for i in columns]

    def _double(self, index: int, column: int, name: str, cell: str) -> float:
        plain = self.plain(cell)
        if plain and ("," in plain or not _NUMBER.fullmatch(plain)):
            wrong = f"{name} must be a number, got {quoted(cell)}{self._hint(cell)}"
            raise DataError(f"{self.where(index)}, column {column + 1}: {wrong}")
        return float(plain or "nan")

    def plain(self, cell: str) -> str:
        """Return a cell with a decimal point; a number with the other mark then fails to parse."""
        return cell.translate(_SWAPPED) if self.decimal == "," else cell

    def number(self, cell: str) -> Fraction:
        """Return the number in a cell exactly.  Raises LagtopError with the cell as written."""
        try:
            return parse_number(self.plain(cell))
        except LagtopError as error:
            hint = self._hint(cell)
            if hint or self.decimal == ",":
                wrong = f"must be a finite decimal number, got {quoted(cell)}{hint}"
                raise LagtopError(wrong) from None
            raise error from None

    def _hint(self, cell: str) -> str:
        """Return a hint in parentheses if a cell is a number with the other decimal mark."""
        other, mark = ("point", ".") if self.decimal == "," else ("comma", ",")
        fits = self.delimiter != "," and mark in cell and _NUMBER.fullmatch(cell)
        return f" (use --decimal {other})" if fits else ""


class JsonTable(Table):
    """JSON objects as rows; a list of numbers becomes several columns."""

    def __init__(self, name: str, objects: Sequence[dict[str, Any]], lines: Sequence[int]) -> None:
        """Take the objects, and the line of each; no lines if they are parts of one array."""
        self._lines = lines or range(1, len(objects) + 1)
        self.place = "line" if lines else "row"
        self._sizes: dict[str, int] = {}
        for row in objects:
            for key, value in row.items():
                if not self._sizes.get(key):
                    self._sizes[key] = len(value) if isinstance(value, list) else 0
        self._objects = objects
        headings = [part for key, size in self._sizes.items() for part in parts(key, size)]
        super().__init__(name, headings, len(headings))

    @property
    def lines(self) -> Sequence[int]:
        """The line of each object, or its number in the array, from 1."""
        return self._lines

    def rows(self) -> Sequence[Sequence[Any]]:
        """Return the values of all objects.  Raises DataError for a list of another length."""
        return self._values

    @cached_property
    def _values(self) -> list[list[Any]]:
        return [self._row(i, x) for i, x in enumerate(self._objects)]

    def _row(self, index: int, entries: dict[str, Any]) -> list[Any]:
        row: list[Any] = []
        for key, size in self._sizes.items():
            value = entries.get(key)
            if size and value is not None and not (isinstance(value, list) and len(value) == size):
                wrong = f"must be {size} numbers, got {_shown(value)}"
                raise DataError(f"{self.where(index)}, column {key}: {wrong}")
            row += value or [None] * size if size else [value]
        return row

    def numbers(self, columns: Sequence[int], names: Sequence[str]) -> Array:
        """Return columns of numbers, shape (rows, columns), with NaN for null."""
        import numpy as np

        rows = self.rows()
        for i in columns:
            for j, row in enumerate(rows):
                if type(row[i]) not in {int, float, type(None)}:
                    wrong = f"{names[i]} must be a number, got {_shown(row[i])}"
                    raise DataError(f"{self.where(j)}, column {self.headings[i]}: {wrong}")  # type: ignore[index]
        chosen = [[row[i] for i in columns] for row in rows]
        return np.array(chosen, np.float64).reshape(-1, len(columns))

    def number(self, cell: Any) -> Fraction:
        """Return a number exactly, as the shortest decimal of its double.

        Raises LagtopError for anything else.
        """
        if type(cell) not in {int, float}:
            raise LagtopError(f"must be a finite number, got {_shown(cell)}")
        return parse_number(repr(cell))


def read_table(
    content: bytes, name: str, known: Known, decimal: str = "", width: int | None = None
) -> TextTable | JsonTable:
    """Read a text table.

    `known` distinguishes headings from titles.  `decimal` is a point, a comma, or empty if the
    first rows decide.  `width` is the number of columns if their names are given; headings in the
    file are then ignored.  Raises DataError.
    """
    lines = decoded(content, name).split("\n")
    start = 0
    if lines[0].startswith(_LABVIEW):
        start = 1 + max(
            (i for i, x in enumerate(lines) if x.startswith(_END_OF_HEADER)), default=-1
        )
    rows = [i for i in range(start, len(lines)) if _is_row(lines[i])][: _TITLES + 1]
    if rows and re.fullmatch('"?sep=."?', lines[rows[0]].strip()):
        del rows[0]
    if not rows:
        return TextTable(name, lines, len(lines), None, delimiter=" ", decimal=decimal)
    comments = [x.strip("# \t") for x in lines[start : rows[0]] if x.lstrip().startswith("#")]
    if lines[rows[0]].lstrip()[0] in "{[":
        return _json_table(name, lines, rows[0])
    at, delimiter = _layout([lines[i] for i in rows], known, decimal, width)
    headings, first = None, rows[0]
    if at is not None:
        first = rows[at] + 1
        headings = None if width else _headings(name, lines, rows[at], delimiter)
    more = {"delimiter": delimiter, "decimal": decimal}
    return TextTable(name, lines, first, headings, comments=comments, **more)


def _headings(name: str, lines: Sequence[str], at: int, delimiter: str) -> list[str]:
    """Return the headings in a line.  Raises DataError for a quoted one that does not end."""
    if delimiter != " ":
        try:
            return cells_of(lines[at], delimiter)
        except LagtopError as error:
            raise DataError(f"{name}, line {at + 1}: {error}") from None
    widths = {len(x.split()) for x in lines[at + 1 :] if _is_row(x)}
    return [lines[at].strip()] if widths == {1} else _split(lines[at], delimiter)


def _is_row(line: str) -> bool:
    """Return whether a line has a row: it is not blank, a comment, or a rule of a drawn table."""
    bare = line.strip()
    return bool(bare) and bare[0] not in "#\u2500"


def _layout(
    texts: Sequence[str], known: Known, decimal: str, width: int | None
) -> tuple[int | None, str]:
    """Return the index of the row with the headings, or None, and the delimiter.

    The row with most known headings has them, or else the row above the first number.
    """
    best, found = 0, (0, _delimiters(texts[0], decimal)[0])
    for i, text in enumerate(texts):
        if any(_are_numbers(_split(text, x)) for x in (*_delimiters(text, decimal), " ")):
            break
        for delimiter in _delimiters(text, decimal):
            if (count := known(_split(text, delimiter))) > best:
                best, found = count, (i, delimiter)
    numeric = (i for i, x in enumerate(texts) if _has_number(x, decimal))
    first = found[0] + 1 if best else next(numeric, len(texts))
    if first == len(texts) or (best and (width is None or found[1] != " ")):
        return found
    return first - 1 if first else None, _delimiter_of(texts[first], decimal, width)


def _delimiters(text: str, decimal: str) -> list[str]:
    """Return the possible delimiters of a row, the most probable one first."""
    bare = _ENCLOSED.sub("", text)
    return [x for x in "\t;," if x in bare and x != decimal] or [" "]


def _has_number(text: str, decimal: str) -> bool:
    """Return whether some cell of a row is a number."""
    return any(_NUMBER.fullmatch(x) for d in _delimiters(text, decimal) for x in _split(text, d))


def _are_numbers(cells: Sequence[str]) -> bool:
    """Return whether all cells are numbers or empty."""
    return all(_NUMBER.fullmatch(x) for x in cells if x)


def _delimiter_of(text: str, decimal: str, width: int | None) -> str:
    """Return the delimiter with which most cells are numbers and the row has `width` cells."""

    def fits(delimiter: str) -> tuple[bool, bool]:
        cells = _split(text, delimiter)
        return width in {None, len(cells)}, _are_numbers(cells)

    return max([*_delimiters(text, decimal), " "], key=fits)


def _split(text: str, delimiter: str) -> list[str]:
    """Return the headings in a row; a blank before a unit in brackets is not a delimiter."""
    if delimiter == " ":
        return [x.strip('"') for x in _HEADING.findall(text)]
    try:
        return cells_of(text, delimiter)
    except LagtopError:
        return [x.strip() for x in text.split(delimiter)]


def cells_of(text: str, delimiter: str) -> list[str]:
    """Return the cells of a line.  Raises LagtopError for a quoted cell that does not end on it."""
    if '"' not in text:
        return text.split() if delimiter == " " else [x.strip() for x in text.split(delimiter)]
    try:
        rows = csv.reader([text.strip()], delimiter=delimiter, strict=True, skipinitialspace=True)
        return [x.strip() for x in next(rows)]
    except csv.Error as error:
        wrong = "a quoted cell must end with its quote, and on its line"
        raise LagtopError(f"{wrong}: {error}") from None


def _json_table(name: str, lines: Sequence[str], first: int) -> JsonTable:
    """Return JSON objects, one per line or in one array, as a table.  Raises DataError."""
    if lines[first].lstrip()[0] == "[":
        rows = _parsed(name, "\n".join(lines[first:]), first)
        wrong = [f"row {i}" for i, x in enumerate(rows, 1) if not isinstance(x, dict)]
        numbers: list[int] = []
    else:
        numbers = [i for i in range(first, len(lines)) if _is_row(lines[i])]
        rows = [_parsed(name, lines[i], i) for i in numbers]
        wrong = [f"line {i + 1}" for i, x in zip(numbers, rows, strict=True) if type(x) is not dict]
    if wrong:
        raise DataError(f"{name}, {wrong[0]}: a row must be a JSON object")
    return JsonTable(name, rows, [i + 1 for i in numbers])


def _parsed(name: str, text: str, first: int) -> Any:
    """Return parsed JSON that begins in the line with index `first`.  Raises DataError."""
    import orjson

    try:
        return orjson.loads(text)
    except orjson.JSONDecodeError as error:
        wrong = f"not JSON: {error.msg} at character {error.colno}"
        raise DataError(f"{name}, line {first + error.lineno}: {wrong}") from None


def _shown(value: Any) -> str:
    """Return a JSON value as text for a message."""
    return shortened(json_text(value))


def parts(name: str, size: int) -> list[str]:
    """Return the names of the columns of an entry with `size` numbers; 0 means a single number."""
    return [f"{name}_{i}" for i in range(size)] if size else [name]
