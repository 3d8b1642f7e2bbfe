"""Text tables: the one reader of files of tops, trajectories, recordings and times.

A row is one line: cells separated by tabs, semicolons, commas or blanks, or a JSON object.  The
delimiter, the headings and the decimal mark are decided once per file, from its first rows.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import parse_number, quoted, shortened
from ..errors import DataError, LagtopError
from ..file_bytes import decoded

if TYPE_CHECKING:
    from ..arithmetic.types import Array

_SAMPLE = 1000
"""Number of rows that decide whether numbers have decimal commas."""
_TITLES = 50
"""Most rows above the headings, such as the title `mass A` of Tracker or the header of LabVIEW."""
_SWAPPED = str.maketrans(",.", ".,")
_DIGITS = r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?"
_NUMBER = re.compile(rf"{_DIGITS}|[+-]?(?:nan|inf)", re.IGNORECASE | re.ASCII)
_MAYBE_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+", re.ASCII)
_ENCLOSED = re.compile(r'"[^"]*"|\[[^\]]*\]|\([^)]*\)')
_HEADING = re.compile(r'"[^"]*"|[^\s\[(]+(?:\s*[\[(][^\])]*[\])])*')
Known = Callable[[Sequence[str]], int]
"""Returns the number of known headings in a row, which distinguishes headings from titles."""


@dataclass
class Table:
    """The rows of a file in memory."""

    name: str
    """The name of the file in messages."""
    headings: Sequence[str] | None
    """None if the file has none."""
    width: int
    """The number of columns."""
    rows: Any
    """Lines of text, lists of JSON values, or one array."""
    lines: Sequence[int]
    """The numbers of the rows in messages."""
    delimiter: str = ","
    decimal: str = "."
    """The decimal mark, a point or a comma."""
    place: str = "line"
    """The unit of `lines` in messages: `line` or `row`."""

    def where(self, row: int) -> str:
        """Return the name of the file and the place of a row."""
        return f"{self.name}, {self.place} {self.lines[row]}"

    def cells(self, row: int) -> list[Any]:
        """Return the cells of a row.  Raises LagtopError for a wrong quote."""
        text = self.rows[row]
        return split_row(text, self.delimiter) if isinstance(text, str) else text

    def check(self, cells: Sequence[Any]) -> None:
        """Raise LagtopError for a row with another number of cells."""
        if len(cells) != self.width:
            wrong = f"a row must have {self.width} cells, got {len(cells)}"
            if self.delimiter == "," and len(cells) == 2 * self.width:
                wrong += ": a comma cannot both separate cells and be the decimal mark"
            raise LagtopError(wrong)

    def part(self, rows: slice) -> Table:
        """Return some of the rows."""
        return replace(self, rows=self.rows[rows], lines=self.lines[rows])

    def at(self, row: int) -> list[Any]:
        """Return the cells of a row, one for each column.  Raises DataError."""
        try:
            cells = self.cells(row)
            self.check(cells)
        except LagtopError as error:
            raise DataError(f"{self.where(row)}: {error}") from None
        return cells

    def column(self, index: int) -> list[Any]:
        """Return the cells of one column.  Raises DataError as `at` does."""
        return [self.at(row)[index] for row in range(len(self.rows))]

    def numbers(self, columns: Sequence[int], names: Sequence[str]) -> Array:
        """Return columns of numbers, shape (rows, columns), with NaN for empty cells.

        `names` are the names of all columns in messages.  Raises DataError with the place of a cell
        that is no number.
        """
        import numpy as np

        values = self._at_once()
        if values is not None:
            return values[:, columns]
        rows = ((row, self.at(row)) for row in range(len(self.rows)))
        found = [[self._double(row, i, names[i], x[i]) for i in columns] for row, x in rows]
        return np.array(found).reshape(-1, len(columns))

    def _at_once(self) -> Array | None:
        """Return all columns, or None if NumPy cannot read the rows as numbers."""
        import numpy as np

        if isinstance(self.rows, np.ndarray):
            return self.rows
        rows = [x.translate(_SWAPPED) for x in self.rows] if self.decimal == "," else self.rows
        mark = None if self.delimiter == " " else self.delimiter
        try:
            values = np.loadtxt(rows, delimiter=mark, ndmin=2, comments=None) if rows else None
        except (TypeError, ValueError):  # JSON, words or missing numbers
            return None
        return values if values is not None and values.shape == (len(rows), self.width) else None

    def _double(self, row: int, column: int, name: str, cell: Any) -> float:
        """Return the number in a cell, NaN if it is empty.  Raises DataError."""
        if cell is None or cell == "":
            return float("nan")
        plain = self._plain(cell) if isinstance(cell, str) else repr(cell)
        if _NUMBER.fullmatch(plain) and "," not in plain:
            return float(plain)
        try:
            return float(self.number(cell))
        except LagtopError as error:
            raise DataError(f"{self.where(row)}, column {column + 1}: {name} {error}") from None

    def number(self, cell: Any) -> Fraction:
        """Return the number in a cell exactly.  Raises LagtopError with the cell as written."""
        if type(cell) in {int, float}:
            return parse_number(repr(cell))
        if not isinstance(cell, str):
            raise LagtopError(f"must be a finite number, got {_shown(cell)}")
        other, mark = ("point", ".") if self.decimal == "," else ("comma", ",")
        hint = ""
        if self.delimiter != "," and mark in cell and _NUMBER.fullmatch(cell):
            hint = f" (use --decimal {other})"
        try:
            return parse_number(self._plain(cell))
        except LagtopError:
            if hint or self.decimal == ",":
                wrong = f"must be a finite decimal number, got {quoted(cell)}{hint}"
                raise LagtopError(wrong) from None
            raise

    def _plain(self, cell: str) -> str:
        """Return a cell with a decimal point; a number with the other mark then fails to parse."""
        return cell.translate(_SWAPPED) if self.decimal == "," else cell


def read_table(
    content: bytes, name: str, known: Known, decimal: str = "", width: int | None = None
) -> Table:
    """Read a text table.

    `known` distinguishes headings from titles.  `decimal` is a point, a comma, or empty if the
    first rows decide.  `width` is the number of columns if their names are given; headings in the
    file are then ignored.  Raises DataError.
    """
    lines = decoded(content, name).split("\n")
    kept = [i for i, x in enumerate(lines) if x.strip() and x.strip()[0] not in "#─"]
    if kept and lines[kept[0]].lstrip()[0] in "{[":
        return _json_table(name, lines, kept)
    at, delimiter = _layout([lines[i] for i in kept[: _TITLES + 1]], known, decimal, width)
    rows = [lines[i] for i in kept[at + 1 :]]
    # A single heading may have its unit after a blank.
    single = delimiter == " " and len(rows) > 0 and len(rows[0].split()) == 1
    headings: list[str] | None = None
    if at >= 0 and not width:
        line = lines[kept[at]]
        try:
            headings = [line.strip()] if single else _split(line, delimiter, strict=True)
        except LagtopError as error:
            raise DataError(f"{name}, line {kept[at] + 1}: {error}") from None
    found = len(headings or (_split(rows[0], delimiter) if rows else ()))
    if headings is None and not width:  # perhaps in a comment, as numpy.savetxt writes them
        comments = [re.sub("[#,;]", " ", x).split() for x in lines[: min(kept, default=0)]]
        fits = [x for x in comments if len(x) == found and known(x)]
        headings = fits[-1] if fits else None
    table = Table(name, headings, found, rows, [i + 1 for i in kept[at + 1 :]], delimiter)
    return table if delimiter == "," else replace(table, decimal=decimal or _decimal_mark(table))


def _decimal_mark(table: Table) -> str:
    """Return the decimal mark of the first rows.

    Raises DataError if a comma may be a decimal mark or separate thousands.
    """
    places: dict[str, int] = {}
    for row, text in enumerate(table.rows[:_SAMPLE]):
        for cell in _split(text, table.delimiter) if "," in text else ():
            if "," in cell and _NUMBER.fullmatch(cell):
                places.setdefault(cell, row)
    if places and all(map(_MAYBE_THOUSANDS.fullmatch, places)):
        cell, row = next(iter(places.items()))
        wrong = f"a comma may be a decimal mark or separate thousands, got {quoted(cell)}"
        raise DataError(f"{table.where(row)}: {wrong}: pass --decimal point or --decimal comma")
    return "," if places else "."


def _layout(texts: Sequence[str], known: Known, decimal: str, width: int | None) -> tuple[int, str]:
    """Return the index of the row of headings (the most known ones), or -1, and the delimiter."""
    rows = [{x: _split(text, x) for x in _delimiters(text, decimal)} for text in texts]
    if not rows:
        return -1, " "
    most, found = 0, (0, next(iter(rows[0])))
    for i, row in enumerate(rows):
        if any(map(_are_numbers, row.values())):
            break
        for delimiter, cells in row.items():
            if (count := known(cells)) > most:
                most, found = count, (i, delimiter)
    has_number = (any(_NUMBER.fullmatch(x) for y in row.values() for x in y) for row in rows)
    first = found[0] + 1 if most else [*has_number, True].index(True)
    if first == len(rows) or (most and not (width and found[1] == " ")):
        return found
    options = rows[first] | {" ": _split(texts[first], " ")}
    fits = {x: (width in {None, len(row)}, _are_numbers(row)) for x, row in options.items()}
    return first - 1, max(fits, key=fits.__getitem__)


def _delimiters(text: str, decimal: str) -> list[str]:
    """Return the possible delimiters of a row, the most probable one first."""
    bare = _ENCLOSED.sub("", text)
    return [x for x in "\t;," if x in bare and x != decimal] or [" "]


def _are_numbers(cells: Sequence[str]) -> bool:
    """Return whether all cells are numbers or empty."""
    return any(cells) and all(_NUMBER.fullmatch(x) for x in cells if x)


def _split(text: str, delimiter: str, *, strict: bool = False) -> list[str]:
    """Return the headings in a row; a blank before a unit in brackets is not a delimiter.

    Raises LagtopError for a wrong quote if `strict`.
    """
    if delimiter == " ":
        return [x.strip('"') for x in _HEADING.findall(text)]
    try:
        return split_row(text, delimiter)
    except LagtopError:
        if strict:
            raise
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
    """Return JSON objects, one per line or in one array; a list in them becomes several columns."""
    import orjson

    is_array = lines[kept[0]].lstrip()[0] == "["
    texts = {kept[0]: "\n".join(lines[kept[0] :])} if is_array else {i: lines[i] for i in kept}
    objects: list[Any] = []
    for i, text in texts.items():
        try:
            objects.append(orjson.loads(text))
        except orjson.JSONDecodeError as error:
            wrong = f"not JSON: {error.msg} at character {error.colno}"
            raise DataError(f"{name}, line {i + error.lineno}: {wrong}") from None
    objects = objects[0] if is_array else objects
    numbers = range(1, len(objects) + 1) if is_array else [i + 1 for i in kept]
    table = Table(name, None, 0, objects, numbers, place="row" if is_array else "line")
    sizes: dict[str, int] = {}
    for row, found in enumerate(objects):
        if not isinstance(found, dict):
            raise DataError(f"{table.where(row)}: a row must be a JSON object")
        for key, value in found.items():
            sizes[key] = sizes.get(key) or (len(value) if isinstance(value, list) else 0)
    rows: list[list[Any]] = []
    for row, found in enumerate(objects):
        rows.append([])
        for key, size in sizes.items():
            value = found.get(key)
            if size and value is not None and not (isinstance(value, list) and len(value) == size):
                wrong = f"must be {size} numbers, got {_shown(value)}"
                raise DataError(f"{table.where(row)}, column {key}: {wrong}")
            rows[-1] += (value or [None] * size) if size else [value]
    headings = [part for key, size in sizes.items() for part in parts(key, size)]
    return replace(table, headings=headings, width=len(headings), rows=rows)


def _shown(value: Any) -> str:
    """Return a cell as text for a message, a value of JSON as it writes it."""
    return quoted(value) if isinstance(value, str) else shortened(json.dumps(value))


def parts(name: str, size: int) -> list[str]:
    """Return the names of the columns of an entry with `size` numbers; 0 means a single number."""
    return [f"{name}_{i}" for i in range(size)] if size else [name]
