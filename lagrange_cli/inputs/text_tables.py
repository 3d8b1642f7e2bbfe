"""Text tables: the one reader of files of tops, trajectories, recordings and times.

A row is one line: cells separated by tabs, semicolons, commas or blanks, or a JSON object.  The
delimiter, the headings and the decimal mark are decided once per file, from its first rows.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import json_text, parse_number, quoted, shortened
from ..errors import DataError, LagtopError
from .files import decoded

if TYPE_CHECKING:
    from ..arithmetic.types import Array

_SAMPLE = 1000
"""Number of rows that decide whether numbers have decimal commas."""
_TITLES = 5
"""Most rows above the headings, such as the title `mass A` of Tracker."""
_ROWS_AT_ONCE = 50_000
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
    """The rows of a file in memory."""

    place = "line"
    """The unit of `lines` in messages: `line` or `row`."""
    decimal = ""
    """The decimal mark, a point or a comma; empty if it is not decided."""

    def __init__(
        self,
        name: str,
        headings: Sequence[str] | None,
        rows: Sequence[Any],
        lines: Sequence[int],
        delimiter: str = "",
    ) -> None:
        """Take the name of the file and its rows: lines of text, or lists of values of JSON.

        `lines` are their numbers in messages.  `headings` are None if the file has none.
        """
        self.name, self.headings, self.texts, self.lines = name, headings, rows, lines
        self.delimiter, self.comments = delimiter, list[str]()
        self.width = len(headings or (self.cells(0, whole=False) if rows else ()))

    def where(self, row: int) -> str:
        """Return the name of the file and the place of a row."""
        return f"{self.name}, {self.place} {self.lines[row]}"

    def cells(self, row: int, *, whole: bool = True) -> list[Any]:
        """Return the cells of a row.

        Raises DataError for a wrong quote and, if `whole`, for another number of cells.
        """
        text = self.texts[row]
        try:
            cells = split_row(text, self.delimiter) if isinstance(text, str) else text
            if whole and len(cells) != self.width:
                wrong = f"a row must have {self.width} cells, got {len(cells)}"
                if self.delimiter == "," and len(cells) == 2 * self.width:
                    wrong += ": a comma cannot both separate cells and be the decimal mark"
                raise LagtopError(wrong)
        except LagtopError as error:
            raise DataError(f"{self.where(row)}: {error}") from None
        return cells

    def column(self, index: int) -> list[Any]:
        """Return the cells of one column.  Raises DataError as `cells` does."""
        return [self.cells(row)[index] for row in range(len(self.texts))]

    def decide(self, columns: Iterable[int]) -> None:
        """Set the decimal mark from the first rows of some columns, unless it is set.

        Raises DataError if a comma may be a decimal mark or separate thousands.
        """
        if self.delimiter in {"", ","}:
            self.decimal = "."
        if self.decimal:
            return
        wanted, places = set(columns), dict[str, int]()
        for row, text in enumerate(self.texts[:_SAMPLE]):
            for i, cell in enumerate(self.cells(row, whole=False) if "," in text else ()):
                if i in wanted and "," in cell and _NUMBER.fullmatch(cell):
                    places.setdefault(cell, row)
        if places and all(map(_MAYBE_THOUSANDS.fullmatch, places)):
            cell, row = next(iter(places.items()))
            wrong = f"a comma may be a decimal mark or separate thousands, got {quoted(cell)}"
            raise DataError(f"{self.where(row)}: {wrong}: pass --decimal point or --decimal comma")
        self.decimal = "," if places else "."

    def numbers(self, columns: Sequence[int], names: Sequence[str]) -> Array:
        """Return columns of numbers, shape (rows, columns), with NaN for empty cells.

        `names` are the names of all columns in messages.  Raises DataError with the place of a cell
        that is no number.
        """
        import numpy as np

        self.decide(columns)
        blocks = [np.empty((0, len(columns)))]
        for first in range(0, len(self.texts), _ROWS_AT_ONCE):
            rows = range(first, min(first + _ROWS_AT_ONCE, len(self.texts)))
            values = self._by_numpy(self.texts[rows.start : rows.stop])
            if values is not None:
                blocks.append(values[:, columns])
                continue
            each = ((row, self.cells(row)) for row in rows)
            found = [[self._double(row, i, names[i], x[i]) for i in columns] for row, x in each]
            blocks.append(np.array(found))
        return np.concatenate(blocks)

    def _by_numpy(self, texts: Sequence[Any]) -> Array | None:
        """Return all columns of some rows, or None if NumPy cannot read them."""
        import numpy as np

        text = "\n".join(texts) if self.delimiter else '"'
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

    def _double(self, row: int, column: int, name: str, cell: Any) -> float:
        """Return the number in a cell, NaN if it is empty.  Raises DataError."""
        if type(cell) in {int, float}:
            return float(cell)
        if not cell and cell is not False:
            return float("nan")
        plain = self._plain(cell) if isinstance(cell, str) else ""
        if "," in plain or not _NUMBER.fullmatch(plain):
            wrong = f"{name} must be a number, got {_shown(cell)}{self._hint(cell)}"
            raise DataError(f"{self.where(row)}, column {column + 1}: {wrong}")
        return float(plain)

    def number(self, cell: Any) -> Fraction:
        """Return the number in a cell exactly.  Raises LagtopError with the cell as written."""
        if type(cell) in {int, float}:
            return parse_number(repr(cell))
        if not isinstance(cell, str):
            raise LagtopError(f"must be a finite number, got {_shown(cell)}")
        try:
            return parse_number(self._plain(cell))
        except LagtopError:
            if self.decimal == "," or self._hint(cell):
                wrong = f"must be a finite decimal number, got {quoted(cell)}{self._hint(cell)}"
                raise LagtopError(wrong) from None
            raise

    def _plain(self, cell: str) -> str:
        """Return a cell with a decimal point; a number with the other mark then fails to parse."""
        return cell.translate(_SWAPPED) if self.decimal == "," else cell

    def _hint(self, cell: Any) -> str:
        """Return a hint in parentheses if a cell is a number with the other decimal mark."""
        other, mark = ("point", ".") if self.decimal == "," else ("comma", ",")
        fits = self.delimiter not in {"", ","} and mark in cell and _NUMBER.fullmatch(cell)
        return f" (use --decimal {other})" if fits else ""


def read_table(
    content: bytes, name: str, known: Known, decimal: str = "", width: int | None = None
) -> Table:
    """Read a text table.

    `known` distinguishes headings from titles.  `decimal` is a point, a comma, or empty if the
    first rows decide.  `width` is the number of columns if their names are given; headings in the
    file are then ignored.  Raises DataError.
    """
    lines, start = decoded(content, name).split("\n"), 0
    if lines[0].startswith(_LABVIEW):
        ends = (i for i, x in enumerate(lines, 1) if x.startswith(_END_OF_HEADER))
        start = max(ends, default=0)
    kept = [
        i for i in range(start, len(lines)) if (x := lines[i].strip()) and x[0] not in "#\u2500"
    ]
    if kept and re.fullmatch('"?sep=."?', lines[kept[0]].strip()):
        del kept[0]
    if kept and lines[kept[0]].lstrip()[0] in "{[":
        return _json_table(name, lines, kept)
    top = [lines[i] for i in kept[: _TITLES + 1]]
    at, delimiter = _layout(top, known, decimal, width) if top else (None, " ")
    headings, below = None, kept if at is None else kept[at + 1 :]
    rows = [lines[i] for i in below]
    if at is not None and not width:
        headings = _split(top[at], delimiter)
        if delimiter == " " and {len(x.split()) for x in rows} == {1}:
            headings = [top[at].strip()]
        elif delimiter != " ":
            headings = Table(name, None, [top[at]], [kept[at] + 1], delimiter).cells(0)
    table = Table(name, headings, rows, [i + 1 for i in below], delimiter)
    table.decimal = decimal
    above = lines[start : kept[0]] if kept else []
    table.comments = [x.strip("# \t") for x in above if x.lstrip().startswith("#")]
    return table


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

    def fits(delimiter: str) -> tuple[bool, bool]:
        cells = _split(texts[first], delimiter)
        return width in {None, len(cells)}, _are_numbers(cells)

    return first - 1 if first else None, max([*_delimiters(texts[first], decimal), " "], key=fits)


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


def _split(text: str, delimiter: str) -> list[str]:
    """Return the headings in a row; a blank before a unit in brackets is not a delimiter."""
    if delimiter == " ":
        return [x.strip('"') for x in _HEADING.findall(text)]
    try:
        return split_row(text, delimiter)
    except LagtopError:
        return [x.strip() for x in text.split(delimiter)]


def split_row(text: str, delimiter: str) -> list[str]:
    """Return the cells of a line.  Raises LagtopError for a quoted cell that does not end on it."""
    if '"' not in text:
        return text.split() if delimiter == " " else [x.strip() for x in text.split(delimiter)]
    try:
        rows = csv.reader([text.strip()], delimiter=delimiter, strict=True, skipinitialspace=True)
        return [x.strip() for x in next(rows)]
    except csv.Error as error:
        wrong = "a quoted cell must end with its quote, and on its line"
        raise LagtopError(f"{wrong}: {error}") from None


def _json_table(name: str, lines: Sequence[str], kept: Sequence[int]) -> Table:
    """Return JSON objects, one per line or in one array; a list in them becomes several columns.

    Raises DataError.
    """
    first, place = kept[0], "line"
    if lines[first].lstrip()[0] == "[":
        objects, place = _parsed(name, "\n".join(lines[first:]), first), "row"
        numbers: Sequence[int] = range(1, len(objects) + 1)
    else:
        objects = [_parsed(name, lines[i], i) for i in kept]
        numbers = [i + 1 for i in kept]
    sizes: dict[str, int] = {}
    for number, row in zip(numbers, objects, strict=True):
        if not isinstance(row, dict):
            raise DataError(f"{name}, {place} {number}: a row must be a JSON object")
        for key, value in row.items():
            if not sizes.get(key):
                sizes[key] = len(value) if isinstance(value, list) else 0
    rows: list[list[Any]] = []
    for number, row in zip(numbers, objects, strict=True):
        rows.append([])
        for key, size in sizes.items():
            value = row.get(key)
            if size and value is not None and not (isinstance(value, list) and len(value) == size):
                wrong = f"column {key}: must be {size} numbers, got {_shown(value)}"
                raise DataError(f"{name}, {place} {number}, {wrong}")
            rows[-1] += (value or [None] * size) if size else [value]
    table = Table(name, [x for key, size in sizes.items() for x in parts(key, size)], rows, numbers)
    table.place = place
    return table


def _parsed(name: str, text: str, first: int) -> Any:
    """Return parsed JSON that begins in the line with index `first`.  Raises DataError."""
    import orjson

    try:
        return orjson.loads(text)
    except orjson.JSONDecodeError as error:
        wrong = f"not JSON: {error.msg} at character {error.colno}"
        raise DataError(f"{name}, line {first + error.lineno}: {wrong}") from None


def _shown(value: Any) -> str:
    """Return a cell as text for a message, a value of JSON as it writes it."""
    return quoted(value) if isinstance(value, str) else shortened(json_text(value))


def parts(name: str, size: int) -> list[str]:
    """Return the names of the columns of an entry with `size` numbers; 0 means a single number."""
    return [f"{name}_{i}" for i in range(size)] if size else [name]
