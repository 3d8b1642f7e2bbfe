"""Text tables: the common grammar of files of tops, trajectories, recordings and times.

A row is one line: a JSON object, or cells separated by commas, semicolons, tabs or white space.
The delimiter and the decimal mark are decided once per file, from its headings and its first rows.
A comma is a decimal mark only if it is not the delimiter.  A file that can be read in two ways, or
that has thousands separators, is refused.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from io import BufferedIOBase
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
_THOUSANDS = re.compile(
    r"[+-]?\d{1,3}(?:,\d{3}(?:,\d{3})*\.\d*|\.\d{3}(?:\.\d{3})*,\d*|(?:,\d{3}){2,}|(?:\.\d{3}){2,})",
    re.ASCII,
)
_PERHAPS_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
_ENCLOSED = re.compile(r'"[^"]*"|\[[^\]]*\]|\([^)]*\)')
_HEADING = re.compile(r'"[^"]*"|[^\s\[(]+(?:\s*[\[(][^\])]*[\])])*')
_LABVIEW, _END_OF_HEADER = "LabVIEW Measurement", b"***End_of_Header***"


class TableHead(NamedTuple):
    """The beginning of a table: its headings, its first lines, and its dialect."""

    lines: NumberedLines
    """The unread lines."""
    kept: Sequence[Numbered]
    """The lines already read below the headings, with blank lines and comments."""
    comments: Sequence[str]
    """The comments above the first row."""
    headings: Sequence[str] | None
    """The headings; None without headings, or if the rows are JSON objects."""
    place: int
    """The line number of the headings, or else of the first row."""
    dialect: Dialect = UNDECIDED
    around: bytes | None = None
    """The characters that may surround a JSON object; None for a table of cells."""

    def rows(self) -> list[Numbered]:
        """Return the first rows."""
        return [x for x in self.kept if has_row(x[1].strip(self.around))]

    def decided(self, columns: Iterable[int] | None = None) -> Dialect:
        """Return the dialect with the decimal mark found in some columns (default: all).

        Raises DataError for thousands separators, and for ambiguous numbers.
        """
        if self.dialect.decimal:
            return self.dialect
        if self.dialect.delimiter == ",":
            return self.dialect._replace(decimal=".")
        wanted = None if columns is None else set(columns)
        seen: dict[str, tuple[int, str]] = {}
        for number, line in self.rows():
            for i, cell in enumerate(_cells((number, line), self.dialect)):
                if wanted is None or i in wanted:
                    seen.setdefault(_mark_of(cell.strip()), (number, cell.strip()))
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


def read_head(
    stream: BufferedIOBase | BinaryIO,
    name: str,
    asked: Dialect,
    known: Callable[[Sequence[str]], int],
    width: int | None = None,
) -> TableHead:
    """Read the beginning of a table.

    `known` returns the number of known headings in a row, which distinguishes headings from titles.
    `width` is the number of columns if their names are given; headings in the file are then
    optional, and ignored.  Raises DataError for a file that can be read with two delimiters.
    """
    lines = NumberedLines(stream, name)
    kept = _sample(lines)
    above = next((i for i, x in enumerate(kept) if has_row(x[1])), len(kept))
    comments = [_decoded(x, name).strip("# \t") for x in kept[:above] if x[1].strip()]
    kept = kept[above:]
    if not kept:
        return TableHead(lines, kept, comments, None, 1, asked)
    start = kept[0][1].lstrip()[:1]
    if start in {b"{", b"["}:
        around = b"[], \t\r\n" if start == b"[" else b" \t\r\n"
        return TableHead(lines, kept, comments, None, kept[0][0], asked, around)
    kept, asked = _without_preamble(kept, name, asked)
    return _head_of_cells(TableHead(lines, kept, comments, None, 1, asked), known, width)


def _head_of_cells(
    head: TableHead, known: Callable[[Sequence[str]], int], width: int | None
) -> TableHead:
    """Return the beginning of a table of cells whose first lines have been read."""
    rows, asked, name = head.rows(), head.dialect, head.lines.name
    texts = [_decoded(x, name) for x in rows[:_MOST_TITLES]]
    for (number, _), text in zip(rows, texts, strict=False):
        with at_line(name, number):
            _has_number(text, asked)  # for its errors
    at, delimiters = _find_headings(texts, asked, known)
    below = rows if at is None else rows[at + 1 :]
    headings, place = None, below[0][0] if below else head.lines.number + 1
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
    kept = [x for x in head.kept if x[0] >= place + (headings is not None)]
    asked = asked._replace(delimiter=delimiter)
    return head._replace(kept=kept, headings=headings, place=place, dialect=asked)


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
    titles: Sequence[str], asked: Dialect, known: Callable[[Sequence[str]], int]
) -> tuple[int | None, list[str]]:
    """Return the index of the row with the headings, or None, and its possible delimiters.

    Among the first rows without numbers it is the one with most known headings, or else the last.
    """
    found, most = None, 0
    for i, text in enumerate(titles):
        counts = {x: known(_headings(text, x)) for x in _delimiters_in(text, asked)}
        has_number = _has_number(text, asked)
        if max(counts.values()) > most and not (i and has_number):
            found, most = (i, [x for x, count in counts.items() if count]), max(counts.values())
        if has_number:
            above = i - 1
            break
    else:
        above = min(len(titles), 1) - 1
    if found is not None:
        return found
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


def _mark_of(cell: str) -> str:
    """Return the decimal mark of a number; `perhaps` for a comma that may separate thousands."""
    if _THOUSANDS.fullmatch(cell):
        return "thousands"
    if not is_number(cell):
        return ""
    if _PERHAPS_THOUSANDS.fullmatch(cell):
        return "perhaps"
    return next((mark for mark in ",." if mark in cell), "")


def _decoded(row: Numbered, name: str) -> str:
    with at_line(name, row[0]):
        return decoded_row(row[1])
