"""Text tables: the common grammar of files of tops, trajectories, recordings and times.

A row is one line: a JSON object, or cells separated by commas, semicolons, tabs or white space.
The delimiter and the decimal mark are decided once per file, from its headings and its first rows.
A comma is a decimal mark only if it is not the delimiter.  A file that can be read in two ways, or
that has thousands separators, is refused.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from io import BufferedIOBase
from itertools import chain
from typing import BinaryIO, NamedTuple

from ..arithmetic.text import quoted
from ..errors import DataError, LagtopError
from .text_lines import (
    DIGITS,
    UNDECIDED,
    Dialect,
    Numbered,
    NumberedLines,
    at_line,
    decimal_mark,
    decoded_row,
    has_row,
    is_number,
)

SAMPLE_ROWS, _SAMPLE_BYTES = 1000, 1 << 22
"""The number of rows that decide how a file is read, and their most bytes."""
_MOST_TITLES = 5
"""The headings are within these first rows, perhaps below a title such as Tracker's `mass A`."""
_SEPARATORS = "\t;,"
_NUMBERS = re.compile(rf"[+-]?{DIGITS}(?:\s+[+-]?{DIGITS})+", re.ASCII)
_ENCLOSED = re.compile(r'"[^"]*"|\[[^\]]*\]|\([^)]*\)')
_HEADING = re.compile(r'"[^"]*"|[^\s\[(]+(?:\s*[\[(][^\])]*[\])])*')
_LABVIEW, _END_OF_HEADER = "LabVIEW Measurement", b"***End_of_Header***"


class TextTable(NamedTuple):
    """A table whose beginning was read: its headings, its dialect and its rows."""

    lines: NumberedLines
    """The unread lines."""
    first: Sequence[Numbered]
    """The rows already read, below the headings."""
    comments: Sequence[str] = ()
    """The comments above the first row."""
    headings: Sequence[str] | None = None
    """The headings; None without headings, or if the rows are JSON objects."""
    place: int = 1
    """The line number of the headings, or else of the first row."""
    dialect: Dialect = UNDECIDED
    around: bytes | None = None
    """The characters that may surround a JSON object; None for a table of cells."""

    def rows(self) -> Iterator[Numbered]:
        """Yield the rows, once, as soon as they are read."""
        yield from self.first
        for line in self.lines:
            yield from self.rows_in([line])

    def blocks(self) -> Iterator[list[Numbered]]:
        """Yield the rows, once, many at a time and without blanks around them."""
        for lines in chain([self.first], self.lines.blocks()):
            if rows := self.rows_in(lines, self.around or b" \r\n"):
                yield rows

    def rows_in(self, lines: Iterable[Numbered], around: bytes = b"") -> list[Numbered]:
        """Return the lines that hold a row, without the characters `around` them."""
        around = self.around or around
        return [(i, row) for i, x in lines if has_row(row := x.strip(around))]

    def decided(self, columns: Iterable[int]) -> Dialect:
        """Return the dialect with the decimal mark found in some columns.

        Raises DataError for thousands separators, and for ambiguous numbers.
        """
        if self.dialect.decimal:
            return self.dialect
        if self.dialect.delimiter == ",":
            return self.dialect._replace(decimal=".")
        wanted = set(columns)
        seen: dict[str, tuple[int, str]] = {}
        for number, line in self.first:
            for i, cell in enumerate(_cells((number, line), self.dialect)):
                if i in wanted:
                    seen.setdefault(decimal_mark(cell.strip()), (number, cell.strip()))
        commas = [seen[x] for x in (",", "perhaps") if x in seen]
        if "thousands" in seen:
            raise self._refused(seen["thousands"], "a number must have no thousands separators")
        if commas and "." in seen:
            raise self._refused(max(*commas, seen["."]), "a file must have one decimal mark")
        if commas and "," not in seen:
            raise self._refused(commas[0], "a comma may be a decimal mark or separate thousands")
        return self.dialect._replace(decimal="," if commas else ".")

    def _refused(self, where: tuple[int, str], wanted: str) -> DataError:
        number, cell = where
        return DataError(
            f"{self.lines.name}, line {number}: {wanted}, got {quoted(cell)}: "
            "pass --decimal point or --decimal comma"
        )


def read_table(
    stream: BufferedIOBase | BinaryIO,
    name: str,
    asked: Dialect,
    known: Callable[[Sequence[str]], int],
    width: int | None = None,
) -> TextTable:
    """Read the beginning of a table.

    `known` returns the number of known headings in a row, which distinguishes headings from titles.
    `width` is the number of columns if their names are given; headings in the file are then
    optional, and ignored.  Raises DataError for a file that can be read with two delimiters.
    """
    lines = NumberedLines(stream, name)
    kept = _sample(lines)
    above = next((i for i, x in enumerate(kept) if has_row(x[1])), len(kept))
    comments = [_decoded(x, name).strip("# \t") for x in kept[:above] if x[1].strip()]
    start = kept[above][1].lstrip()[:1] if kept[above:] else b""
    around = {b"{": b" \t\r\n", b"[": b"[], \t\r\n"}.get(start)
    table = TextTable(lines, (), comments, dialect=asked, around=around)
    rows = table.rows_in(kept[above:])
    if not rows or around is not None:
        return table._replace(first=rows, place=rows[0][0] if rows else 1)
    rows, asked = _without_preamble(rows, name, asked)
    return _with_headings(table._replace(first=rows, dialect=asked), known, width)


def _with_headings(
    table: TextTable, known: Callable[[Sequence[str]], int], width: int | None
) -> TextTable:
    """Return a table of cells whose first rows have been read, with its headings and delimiter."""
    rows, asked, name = table.first, table.dialect, table.lines.name
    texts, numbers = list[str](), list[bool]()
    for number, row in rows[:_MOST_TITLES]:
        with at_line(name, number):
            texts.append(decoded_row(row))
            numbers.append(_has_number(texts[-1], asked))
    at, delimiters = _find_headings(texts, numbers, asked, known)
    below = rows if at is None else rows[at + 1 :]
    headings, place = None, below[0][0] if below else table.lines.number + 1
    if at is not None and width is None:
        place = rows[at][0]
        delimiter = _fitting(delimiters, texts[at], below, f"{name}, line {place}")
        headings = _headings(texts[at], delimiter)
        if delimiter == " " and below and all(len(_cells(x, Dialect(" "))) == 1 for x in below):
            headings = [texts[at].strip()]
    elif at is not None and len(delimiters) == 1 and delimiters != [" "]:
        delimiter = delimiters[0]
    else:
        delimiter = asked.delimiter or _delimiter_of_rows(below, name, asked, width)
    dialect = asked._replace(delimiter=delimiter)
    return table._replace(first=below, headings=headings, place=place, dialect=dialect)


def _sample(lines: NumberedLines) -> list[Numbered]:
    """Return the first lines, with up to `SAMPLE_ROWS` rows."""
    kept, rows, size = [], 0, 0
    for number, line in lines:
        kept.append((number, line))
        rows, size = rows + has_row(line), size + len(line)
        if rows == SAMPLE_ROWS or size > _SAMPLE_BYTES:
            break
    return kept


def _without_preamble(
    kept: list[Numbered], name: str, asked: Dialect
) -> tuple[list[Numbered], Dialect]:
    """Return the lines below Excel's `sep=;` or LabVIEW's header, and the declared dialect."""
    first = _decoded(kept[0], name).strip()
    if found := re.fullmatch(r'"?sep=(.)"?', first):
        return kept[1:], asked._replace(delimiter=asked.delimiter or found[1])
    if not first.startswith(_LABVIEW):
        return kept, asked
    ends = [i for i, x in enumerate(kept) if x[1].startswith(_END_OF_HEADER)]
    end = ends[-1] + 1 if ends else 0
    mark = next((x for _, x in kept[:end] if x.startswith(b"Decimal_Separator")), b"").strip()
    decimal = asked.decimal or {b",": ",", b".": "."}.get(mark[-1:], "")
    return kept[end:], asked._replace(decimal=decimal)


def _find_headings(
    titles: Sequence[str],
    numbers: Sequence[bool],
    asked: Dialect,
    known: Callable[[Sequence[str]], int],
) -> tuple[int | None, list[str]]:
    """Return the index of the row with the headings, or None, and its possible delimiters.

    Among the first rows without `numbers` it is the one with most known headings, or else the last.
    """
    found, most = None, 0
    end = numbers.index(True) if True in numbers else len(titles)
    for i, text in enumerate(titles[: max(end, 1)]):
        counts = {x: known(_headings(text, x)) for x in _delimiters_in(text, asked)}
        if max(counts.values()) > most:
            found, most = (i, [x for x, count in counts.items() if count]), max(counts.values())
    if found is not None:
        return found
    above = end - 1 if True in numbers else min(end, 1) - 1
    return (above, _delimiters_in(titles[above], asked)[:1]) if above >= 0 else (None, [])


def _delimiters_in(text: str, asked: Dialect) -> list[str]:
    """Return the possible delimiters of a row: those in it, or white space."""
    bare = _ENCLOSED.sub("", text)
    return [asked.delimiter] if asked.delimiter else [x for x in _SEPARATORS if x in bare] or [" "]


def _has_number(text: str, asked: Dialect) -> bool:
    return any(is_number(x) for d in _delimiters_in(text, asked) for x in _headings(text, d))


def _headings(text: str, delimiter: str) -> list[str]:
    """Return the headings in a row; white space before a unit in brackets is not a delimiter."""
    if delimiter == " ":
        return [x.strip('"') for x in _HEADING.findall(text)]
    return [x.strip() for x in Dialect(delimiter).cells(text)]


def _fitting(delimiters: Sequence[str], text: str, rows: Sequence[Numbered], where: str) -> str:
    """Return the delimiter that gives rows and headings the same number of cells.

    Raises DataError if several delimiters do.
    """
    if len(delimiters) == 1:
        return delimiters[0]
    widths = {x: len(_headings(text, x)) for x in delimiters}
    fitting = [
        x for x, width in widths.items() if any(len(_cells(r, Dialect(x))) == width for r in rows)
    ]
    if len(fitting) != 1:
        raise _two_delimiters(where, text)
    return fitting[0]


def _delimiter_of_rows(
    rows: Sequence[Numbered], name: str, asked: Dialect, width: int | None
) -> str:
    """Return the delimiter of rows without headings: no cell may then hold several numbers.

    Raises DataError if several delimiters fit, or none.
    """
    texts = [_decoded(row, name) for row in rows]
    possible = [x for text in texts if (x := _delimiters_of_row(text, asked, width))]
    if width is not None and not possible:  # the reader of the rows reports the width
        return _delimiters_in(texts[0], asked)[0] if texts else " "
    common = set.intersection(*possible) if possible else {" "}
    if len(common) != 1:
        raise _two_delimiters(f"{name}, line {rows[0][0]}", texts[0].strip())
    return common.pop()


def _delimiters_of_row(text: str, asked: Dialect, width: int | None) -> set[str]:
    """Return the delimiters with which no cell of a row holds several numbers or a delimiter."""
    present = [x for x in _SEPARATORS if x in text and x != asked.decimal]
    present += [] if "\t" in present else [" "]
    found = set()
    for delimiter in present:
        with suppress(LagtopError):
            cells = [x.strip() for x in Dialect(delimiter).cells(text)]
            if width in {None, len(cells)} and not any(map(_is_several, cells)):
                found.add(delimiter)
    return found


def _is_several(cell: str) -> bool:
    several = set(cell) & set(_SEPARATORS) or _NUMBERS.fullmatch(cell)
    return bool(several) and not is_number(cell)


def _two_delimiters(where: str, text: str) -> DataError:
    return DataError(
        f"{where}: the delimiter must be clear, got {quoted(text)}: pass --delimiter, "
        "or --decimal comma for decimal commas"
    )


def _cells(row: Numbered, dialect: Dialect) -> list[str]:
    """Return the cells of a row; none if it cannot be read, which its reader reports later."""
    with suppress(LagtopError):
        return dialect.cells(decoded_row(row[1]))
    return []


def _decoded(row: Numbered, name: str) -> str:
    with at_line(name, row[0]):
        return decoded_row(row[1])
