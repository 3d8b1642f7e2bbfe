"""Text tables: the one reader of files of tops, trajectories, recordings and times.

A row is one line: cells separated by tabs, semicolons, commas or blanks, or a JSON object.  The
delimiter, the headings and the decimal mark are decided once per file, from its first rows.  A file
is kept as one text, whose lines are split when they are read.
"""

from __future__ import annotations

import csv
import re
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.text import parse_number, quoted, shortened
from ..arithmetic.types import Array, Mask
from ..errors import DataError, LagtopError, arg
from ..top.units import is_unit
from .json_rows import MOST_CELLS, entries_of, json_value, rows_of_value, shown

_SAMPLE = 1000
"""Number of rows that decide whether numbers have decimal commas."""
_TITLES = 50
"""Most rows above the headings, such as the title `mass A` of Tracker or the header of LabVIEW."""
_COMMENT = re.compile(r"^\s*(?:[#%]+|//)")
_NO_ROW = re.compile(r"\n[^\S\n]*(?:\n|\Z|[#%─]|//)")
"""A line end and an empty line, a comment, or a line that is drawn."""
LARGEST_ARRAY = 1 << 26
"""Most characters of a JSON array, because it is held in memory as objects."""
_MOST_VALUES = LARGEST_ARRAY // 8
"""Most values of a JSON array."""
_MOST_LINES = 1 << 24
"""Most lines of a file: a small archive may hold more than can be read in a minute."""
_LONGEST_LINE = 1 << 22
"""Most characters of each of the first rows, which are searched for headings."""
_AT_ONCE = 1 << 20
_SWAPPED = str.maketrans(",.", ".,")
_DIGITS = r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eEdD][+-]?\d+)?"  # D as Fortran writes it
_NUMBER = re.compile(rf"{_DIGITS}|[+-]?(?:nan|inf)", re.IGNORECASE | re.ASCII)
_WITH_UNIT = re.compile(rf"{_DIGITS}(?:\s+[^\W\d_].*|\s*°)")
_MAYBE_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+", re.ASCII)
_ENCLOSED = re.compile(r'"[^"]*"|\[[^\[\]]*\]|\([^()]*\)')
_HEADING = re.compile(r'"[^"]*"|[^\s\[(]+(?:\s*[\[(][^\[\]()]*[\])])*')
_PLAIN = dict.fromkeys(map(ord, "()[]"))
EXPONENT = str.maketrans("dD", "ee")
_FORTRAN = re.compile(r"(?<=[\d.])D(?=[+-]?\d)")
_MISSING = {"", "NA", "N/A", "#N/A", "NULL", "null", "None", "-"}
"""Cells that are empty, as programs write them."""
CountKnown = Callable[[Sequence[str]], int]
"""Returns the number of known headings in a row, which distinguishes headings from titles."""


class Lines:
    """The lines of a text with their numbers, from a line on, without empty lines and comments."""

    def __init__(self, text: str, first: int = 1) -> None:
        self.text, self.first = text, first

    def __iter__(self) -> Iterator[tuple[int, str]]:
        for numbers, lines in self.blocks():
            yield from zip(numbers, lines, strict=True)

    def blocks(self) -> Iterator[tuple[Sequence[int], Sequence[str]]]:
        """Yield the numbers of some lines, and the lines, which are split block by block."""
        at, number = 0, 1
        while at < len(self.text):
            end = self.text.find("\n", at + _AT_ONCE)
            chunk = self.text[at:] if end < 0 else self.text[at:end]
            skipped, after = max(self.first - number, 0), number + chunk.count("\n") + 1
            if not chunk.isspace():  # a small archive may hold millions of empty lines
                lines, numbers = chunk.split("\n")[skipped:], [*range(number + skipped, after)]
                if _NO_ROW.search(f"\n{chunk}"):
                    kept = [i for i, line in enumerate(lines) if not _NO_ROW.match(f"\n{line}")]
                    numbers, lines = [numbers[i] for i in kept], [lines[i] for i in kept]
                yield numbers, lines
            at, number = at + len(chunk) + 1, after


@dataclass
class Table:
    """The rows of a file, or some of them."""

    name: str
    """The name of the file in messages."""
    headings: Sequence[str] | None
    """None if the file has none."""
    width: int
    """The number of columns."""
    rows: Iterable[tuple[int, Any]]
    """The number of each row in messages, and its text, its JSON object or its cells."""
    delimiter: str = ","
    """Empty if rows are JSON objects."""
    decimal: str = "."
    """The decimal mark, a point or a comma."""
    place: str = "line"
    """The unit of the numbers of rows in messages: `line` or `row`."""
    sizes: dict[str, int] = field(default_factory=dict)
    """The lengths of lists in JSON objects, by their names."""

    @property
    def described(self) -> str:
        """The headings, or the number of columns if there are none, for messages."""
        shown = shortened(", ".join(map(repr, self.headings or ())))
        return shown or (f"{self.width} columns without headings" if self.width else "none")

    def cells(self, row: Any) -> list[Any]:
        """Return the cells of a row.  Raises LagtopError for a wrong quote and for wrong JSON."""
        if isinstance(row, list):
            return row
        if self.delimiter:
            return split_row(row, self.delimiter)
        found = entries_of(row, self.sizes)
        return [found.get(name) for name in self.headings or ()]

    def check(self, cells: Sequence[Any]) -> None:
        """Raise LagtopError for a row with another number of cells."""
        if len(cells) != self.width:
            wrong = f"a row must have {self.width} cells, got {len(cells)}"
            if self.delimiter == "," and len(cells) == 2 * self.width:
                wrong += ": a comma cannot both separate cells and be the decimal mark"
            raise LagtopError(wrong)

    def blocks(self, size: int) -> Iterator[Table]:
        """Yield the table in blocks of `size` rows, which any process can read."""
        rows = iter(self.rows)
        while block := list(islice(rows, size)):
            yield replace(self, rows=block)

    def column(self, index: int) -> Iterator[tuple[int, Any]]:
        """Yield the numbers of the rows and the cells of one column.  Raises DataError."""
        return ((number, cells[index]) for number, cells in self._checked_rows())

    def _checked_rows(self) -> Iterator[tuple[int, list[Any]]]:
        for number, row in self.rows:
            try:
                cells = self.cells(row)
                self.check(cells)
            except LagtopError as error:
                raise self.wrong(number, error) from None
            yield number, cells

    def wrong(self, number: int, what: object, column: str = "") -> DataError:
        """Return an error with the name of the file and the number of a row."""
        return DataError(f"{self.name}, {self.place} {number}{column}: {what}")

    def numbers(self, columns: Sequence[int], names: Sequence[str]) -> NumericColumns:
        """Return columns of numbers, without the rows that have none in these columns.

        `names` are those of all columns.  Raises DataError with the place of a cell that is no
        number.
        """
        found = self._at_once() or self._at_once(columns) or self.of_cells(columns, names)
        if found.values.shape[1] != len(columns):
            found = NumericColumns(found.values[:, columns], found.empty[:, columns], found.lines)
        kept = ~found.empty.all(axis=1)
        return found if kept.all() else NumericColumns(*(np.asarray(x)[kept] for x in found))

    def _at_once(self, columns: Sequence[int] | None = None) -> NumericColumns | None:
        """Return columns of numbers, or None if NumPy cannot read the rows.

        Only with `columns`, a cell may be empty, and other columns may hold words.
        """
        rows, mark, lines = self.rows, self.delimiter, array("q")
        blank = mark.strip(" ") or None  # None: any blanks
        if not isinstance(rows, Lines) or not mark or next(iter(rows), None) is None:
            return None

        def texts() -> Iterator[str]:
            for numbers, block in rows.blocks():
                lines.extend(numbers)
                swapped = (x.translate(_SWAPPED) for x in block) if self.decimal == "," else block
                yield from map(filled, swapped) if columns else swapped

        words = "|".join(map(re.escape, filter(None, _MISSING)))
        edge, empty = (blank, "?") if blank else (r"\s", "")
        missing = re.compile(f"(?<![^{edge}])(?:{words}){empty}(?![^{edge}])")

        def filled(line: str) -> str:
            """Return a line with -nan in its empty cells, and with e in exponents with D."""
            if "D" in line:
                line = _FORTRAN.sub("e", line)
            count = line.count(blank) + 1 if blank else len(line.split())
            if "-nan" in line or count != self.width:
                raise ValueError
            return missing.sub("-nan", line)

        try:
            values = np.loadtxt(texts(), delimiter=blank, usecols=columns, comments=None, ndmin=2)
        except ValueError:
            return None
        if values.shape != (len(lines), len(columns or range(self.width))):
            return None
        return NumericColumns(values, np.isnan(values) & np.signbit(values) & bool(columns), lines)

    def of_cells(self, columns: Sequence[int], names: Sequence[str]) -> NumericColumns:
        """Return columns of numbers, read cell by cell.  Raises DataError."""
        values, empty, lines = array("d"), bytearray(), array("q")
        for number, cells in self._checked_rows():
            lines.append(number)
            empty.extend(_is_missing(cells[i]) for i in columns)
            values.extend(self._double(number, i, names[i], cells[i]) for i in columns)
        shape = (len(lines), len(columns))
        mask = np.frombuffer(empty, np.bool_).reshape(shape)
        return NumericColumns(np.frombuffer(values, np.float64).reshape(shape), mask, lines)

    def _double(self, row: int, column: int, name: str, cell: Any) -> float:
        """Return the number in a cell, NaN if it is empty.  Raises DataError."""
        if _is_missing(cell):
            return float("nan")
        if type(cell) in {int, float}:
            return float(cell)
        plain = self.plain(cell) if isinstance(cell, str) else ""
        if "," not in plain and _NUMBER.fullmatch(plain):
            return float(plain.translate(EXPONENT))
        try:
            return float(self.number(cell))
        except LagtopError as error:
            raise self.wrong(row, f"{name} {error.marked}", f", column {column + 1}") from None

    def number(self, cell: Any) -> Fraction:
        """Return the number in a cell exactly.  Raises LagtopError with the cell as written."""
        if type(cell) in {int, float}:
            return parse_number(repr(cell))
        if not isinstance(cell, str):
            raise LagtopError(f"must be a finite number, got {shown(cell)}")
        other, mark = ("point", ".") if self.decimal == "," else ("comma", ",")
        is_other = self.delimiter != "," and mark in cell and _NUMBER.fullmatch(cell)
        try:
            plain = self.plain(cell)
            return parse_number(plain.translate(EXPONENT) if _NUMBER.fullmatch(plain) else plain)
        except LagtopError:
            has_unit = _WITH_UNIT.fullmatch(cell)
            if not is_other and not has_unit and self.decimal != ",":
                raise
        hint = f" (use {arg('decimal', other)})" if is_other else ""
        hint = " (write the unit in the heading, as NAME [UNIT])" if has_unit else hint
        raise LagtopError(f"must be a finite decimal number, got {quoted(cell)}{hint}")

    def plain(self, cell: Any) -> str:
        """Return a cell as text with a decimal point; the other mark then fails to parse."""
        text = "" if cell is None else str(cell)
        return text.translate(_SWAPPED) if self.decimal == "," else text


class NumericColumns(NamedTuple):
    """Columns of numbers."""

    values: Array
    """Shape (rows, columns); NaN for an empty cell."""
    empty: Mask
    """Whether a cell is empty, in the same shape."""
    lines: Any
    """The number of each row in messages."""


def read_table(
    text: str, name: str, known: CountKnown, decimal: str = "", width: int | None = None
) -> Table:
    """Read a text table.

    `decimal` is a point, a comma, or empty if the first rows decide.  `width` is the number of
    columns if their names are given: headings then do not decide the layout.  Raises DataError.
    """
    if text.count("\n") > _MOST_LINES:
        raise DataError(f"{name}: a file must have at most {_MOST_LINES} lines: split it")
    sample = list(islice(Lines(text), _SAMPLE + _TITLES))
    if sample and sample[0][1].lstrip()[0] in "{[":
        return _json_table(text, name, sample, known)
    for number, line in sample:
        if len(line) > _LONGEST_LINE or max(map(line.count, '\t;, "')) > MOST_CELLS:
            most = f"{_LONGEST_LINE} characters and {MOST_CELLS} cells or quotes"
            raise DataError(f"{name}, line {number}: a row must have at most {most}")
    if (flat := _flattened(text, sample[: _TITLES + 1])) is not None:
        return read_table(flat, name, known, decimal, width)
    head = [line for _, line in sample[: _TITLES + 1]]
    above = text[: max(text.find(f"\n{head[0]}"), 0)] if head else ""
    comments = [_COMMENT.sub("", x) for x in above[-_AT_ONCE:].rstrip().split("\n")[-_TITLES:]]
    splits = [_splits(x, decimal) for x in head]
    headings, first, delimiter = _layout(head, splits, comments, known)
    if width:
        first, delimiter = _first_row(splits, width)
    elif headings is not None and first and delimiter != " ":
        number, line = sample[first - 1]
        try:
            split_row(line, delimiter)
        except LagtopError as error:
            raise DataError.at(f"{name}, line {number}", error) from None
    at = first - bool(width)  # the row above the numbers, or below the headings
    if headings and (units := _units_in(sample[at : at + 2], delimiter, len(headings))):
        pairs, first = zip(headings, units, strict=True), at + 1
        headings = [f"{name} [{unit}]" if unit else name for name, unit in pairs]
    rows = sample[first:]
    cells = _split(rows[0][1], delimiter) if rows else []
    count = len(cells if width else headings or cells)
    lines = Lines(text, rows[0][0] if rows else text.count("\n") + 2)
    table = Table(name, headings, count, lines, delimiter)
    return replace(table, decimal=decimal or _decimal_mark(table, rows[:_SAMPLE]))


def _flattened(text: str, sample: Sequence[tuple[int, str]]) -> str | None:
    """Return a text whose cells hold lists such as `1,0,0,0` with a cell for each number, or None.

    The cells are separated by tabs or semicolons.  The parts of q are q_0, q_1 ...
    """
    above = ""
    for number, line in sample:
        mark = next((x for x in "\t;" if x in line), ",")
        cells = [x for x in line.split(mark) if not _MAYBE_THOUSANDS.fullmatch(x)]
        lists = [cell.split(",") for cell in cells]
        if any(len(x) > 2 and _are_numbers([y.strip() for y in x]) for x in lists):
            rows = text.split("\n", number - 1)
            names, sizes = above.split(mark), [*map(len, lists)]
            if len(names) == len(sizes):
                sized = zip(names, sizes, strict=True)
                parts = [[x] if n == 1 else [f"{x}_{i}" for i in range(n)] for x, n in sized]
                rows[-2] = mark.join(x for part in parts for x in part)
            return "\n".join([*rows[:-1], rows[-1].replace(",", mark)])
        above = line
    return None


def _decimal_mark(table: Table, rows: Sequence[tuple[int, str]]) -> str:
    """Return the decimal mark of some rows.

    Raises DataError if a comma may be a decimal mark or separate thousands.
    """
    places: dict[str, int] = {}
    for number, text in rows:
        if "," in text and (table.delimiter != "," or '"' in text):
            for cell in _split(text, table.delimiter):
                if "," in cell and _NUMBER.fullmatch(cell):
                    places.setdefault(cell, number)
    if places and all(map(_MAYBE_THOUSANDS.fullmatch, places)):
        cell, number = next(iter(places.items()))
        wrong = f"a comma may be a decimal mark or separate thousands, got {quoted(cell)}"
        raise table.wrong(
            number, f"{wrong}: use {arg('decimal', 'point')} or {arg('decimal', 'comma')}"
        )
    return "," if places else "."


def _layout(
    head: Sequence[str],
    splits: Sequence[Mapping[str, Sequence[str]]],
    comments: Sequence[str],
    known: CountKnown,
) -> tuple[Sequence[str] | None, int, str]:
    """Return the headings, the index of the first row of numbers, and their delimiter.

    The headings are the row with the most known names; so may be a comment, as numpy.savetxt writes
    it.  Titles may hold known names, too, but headings are as many as the cells below.
    """
    first, delimiter = _first_row(splits)
    at_first = splits[first] if first < len(splits) else {}
    numeric = [x for x, cells in at_first.items() if _are_numbers(cells)]
    stop = first if numeric else len(head)
    rows = [(i, x, first if numeric else i) for i, x in enumerate(head[:stop], 1)]
    best: Any = None
    for start, text, below in [*rows, *((first, x, first) for x in reversed(comments))]:
        data = splits[below] if below < len(splits) else {}
        marks = numeric or [*data]
        for mark, names in _splits(text).items():
            is_one = mark == " " and all(len(data[x]) == 1 for x in marks)  # with its unit
            cells, delimiters = [text.strip()] if is_one else names, sorted(marks, key=mark.__ne__)
            if mark != " " and len(data.get(mark, ())) == len(names):
                delimiters = [mark]  # of `3 4,4` below `r0,s` the first cell is no number
            fits = [x for x in delimiters if len(data[x]) == len(cells)]
            rank = bool(fits), mark in delimiters, known(names)
            if rank[-1] and (best is None or rank > best[0]) and (fits or text in head):
                best = rank, cells, start, [*fits, *delimiters, mark][0]
    above = splits[first - 1] if first else {}
    is_plain = any(len(above.get(x, ())) == len(at_first[x]) for x in numeric)
    if best and (best[0][0] or not is_plain):
        _, headings, first, delimiter = best
        return headings, first, delimiter
    return _split(head[first - 1], delimiter) if first else None, first, delimiter


def _units_in(rows: Sequence[tuple[int, str]], delimiter: str, count: int) -> list[str]:
    """Return the units in the first of two rows below headings, "" for a column without a unit.

    The list is empty unless the second row has numbers below the units.
    """
    cells = [_split(text.translate(_PLAIN), delimiter) for _, text in rows]
    if len(cells) < 2 or not len(cells[0]) == len(cells[1]) == count or _are_numbers(cells[0]):
        return []
    units = ["" if x == "-" else x for x in cells[0]]
    if any(_NUMBER.fullmatch(x) for x in units if x != "1"):
        return []
    below = [y for x, y in zip(units, cells[1], strict=True) if x]
    return units if _are_numbers(below) and all(is_unit(x) for x in units if x) else []


def _first_row(
    splits: Sequence[Mapping[str, Sequence[str]]], width: int | None = None
) -> tuple[int, str]:
    """Return the index of the first row of numbers, and its delimiter.

    All of its cells are numbers if there is such a row.  If its `width` is known, it has a number
    and so many cells, as the row below has.
    """
    ranked = []
    for i, (row, below) in enumerate(zip(splits, [*splits[1:], *splits[-1:]], strict=True)):
        for mark, cells in row.items():
            fits, are_numbers = len(cells) == width, _are_numbers(cells)
            is_usual = width or are_numbers or mark != " " or len(row) == 1
            if is_usual and any(map(_NUMBER.fullmatch, cells)):
                fit = fits and len(below.get(mark, ())) == width
                ranked.append(((fit, fits, are_numbers and not width, -i, are_numbers), i, mark))
    if ranked:
        _, i, mark = max(ranked, key=lambda x: x[0])
        return i, mark
    if width or not splits:
        return len(splits), " "
    return 1, next(iter(splits[min(1, len(splits) - 1)]))


def _splits(text: str, decimal: str = "") -> dict[str, list[str]]:
    """Return the cells of a row by its possible delimiters, the most probable one first."""
    bare = _ENCLOSED.sub("", text)
    marks = [x for x in "\t;," if x in bare and (x != decimal or '"' in text)]
    return {x: _split(text, x) for x in [*marks, " "]}


def _are_numbers(cells: Sequence[str]) -> bool:
    return any(cells) and all(_NUMBER.fullmatch(x) for x in cells if x not in _MISSING)


def _is_missing(cell: Any) -> bool:
    return cell is None or (isinstance(cell, str) and cell in _MISSING)


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
    form: Any = {"delimiter": delimiter, "strict": True, "skipinitialspace": True}
    try:
        return [x.strip() for x in next(csv.reader([text.strip(" ")], **form))]
    except csv.Error as error:
        wrong, most = f"end with a quote on the same line: {error}", csv.field_size_limit()
        if max(map(len, text.split('"'))) > most:
            wrong = f"have at most {most} characters"
        raise LagtopError(f"a quoted cell must {wrong}") from None


def _json_table(
    text: str, name: str, sample: Sequence[tuple[int, str]], known: CountKnown
) -> Table:
    """Return JSON objects, one per line or in one array, or an object of columns."""
    number, line = sample[0]
    table = Table(name, [], 0, Lines(text, number), "")
    if line.lstrip().startswith("[") or len(sample) == 1 or not _is_json(line):
        whole = text.split("\n", number - 1)[-1]
        if len(sample) > 1 and _is_json(line):  # a list in each line, as Python prints it
            whole = "[" + ",\n".join(x for _, x in table.rows) + "]"
        if len(whole) > LARGEST_ARRAY or whole.count(",") > _MOST_VALUES:
            most = (
                f"{LARGEST_ARRAY} characters and {_MOST_VALUES} values: write one object per line"
            )
            raise DataError(f"{name}: a JSON array must have at most {most}")
        try:
            rows = rows_of_value(json_value(whole, number), known)
        except DataError as error:
            raise DataError(f"{name}, {error}") from None
        except LagtopError as error:
            raise DataError(f"{name}, line {number}: {error}") from None
        first: Any = rows[0] if rows else None
        are_lists = isinstance(first, list)
        is_named = are_lists and {*map(type, first)} == {str} and not _are_numbers(first)
        table = replace(table, rows=[*enumerate(rows[is_named:], 1)], place="row")
        if are_lists:
            return replace(table, headings=first if is_named else None, width=len(first) or 1)
    headings: dict[str, None] = {}
    wrong = None
    for number, row in table.rows:
        try:
            headings |= dict.fromkeys(entries_of(row, table.sizes))
        except LagtopError as error:  # which is raised again when the row is read
            wrong = wrong or table.wrong(number, error)
        if not headings and number > _SAMPLE:
            break
    if not headings and wrong:
        raise wrong
    return replace(table, headings=[*headings], width=len(headings))


def _is_json(text: str) -> bool:
    try:
        json_value(text)
    except LagtopError:
        return False
    return True
