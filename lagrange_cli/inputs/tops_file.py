"""Files of tops, one a line: CSV with a header, or JSON objects.

Lines are cut into blocks without being read closer, so that any machine can take any block; a line
that cannot be read becomes an error of its own row and harms no other.
"""

from __future__ import annotations

import csv
import math
import re
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import chain, islice
from typing import Any, NamedTuple

from ..arithmetic.text import json_text, parse_number
from ..errors import LagtopError
from .top import Top, overridden

INPUTS = Top._fields


class Lines(NamedTuple):
    """Some lines that follow one another."""

    first: int
    """The number of the first one in its file, from 1."""
    texts: list[bytes]


class Row(NamedTuple):
    """One top: its line, what is carried through, and its inputs or what is wrong with them."""

    line: int
    carried: Sequence[Any]
    inputs: Mapping[str, float]
    error: str | None = None

    def completed(self, given: Mapping[str, float]) -> Mapping[str, float]:
        """The inputs, with those given where the row lacks them; those that could be read where
        there is an error."""
        return self.inputs if self.error else overridden(given, self.inputs)


class RowFile(NamedTuple):
    """How to read the lines of a file: all of its blocks alike."""

    columns: Sequence[str] | None
    """The header of a CSV file; None for JSON lines."""
    carried: Sequence[str]
    """The names that are carried through, in their order."""
    computed: frozenset[str]
    """Names that are neither read nor carried."""

    def rows(self, lines: Lines) -> Iterator[Row]:
        """The rows of some lines; blank ones are left out."""
        read = self._json_row if self.columns is None else self._csv_row
        for number, raw in enumerate(lines.texts, lines.first):
            if not raw.strip():
                continue
            carried: dict[str, Any] = {}
            inputs: dict[str, float] = {}
            error = None
            try:
                read(raw, carried, inputs)
            except LagtopError as wrong:
                error = str(wrong)
            yield Row(number, [carried.get(name) for name in self.carried], inputs, error)

    def _csv_row(self, raw: bytes, carried: dict[str, Any], inputs: dict[str, float]) -> None:
        assert self.columns is not None
        cells = split_cells(_decoded(raw))
        texts = dict(zip(self.columns, cells, strict=False))
        carried.update((name, texts[name]) for name in self.carried if name in texts)
        if len(cells) != len(self.columns):
            raise LagtopError(f"a row must have {len(self.columns)} cells, got {len(cells)}")
        for name, text in texts.items():
            if name in INPUTS:
                inputs[name] = _double(name, text)

    def _json_row(self, raw: bytes, carried: dict[str, Any], inputs: dict[str, float]) -> None:
        values = _json_object(raw)
        carried.update((name, values[name]) for name in self.carried if name in values)
        for name, value in values.items():
            if name in INPUTS:
                inputs[name] = _json_double(name, value)
            elif name not in carried and name not in self.computed:
                raise LagtopError(f"the key {name!r} must be in one of the first rows too")


def split_cells(line: str) -> list[str]:
    """The cells of a line of CSV.  A quoted cell ends on its line, or one open quote would
    swallow the rows that follow.  Raises LagtopError."""
    if '"' not in line:
        return line.split(",")
    try:
        return next(csv.reader([line], strict=True))
    except csv.Error as error:
        raise LagtopError(f"a row must be CSV, got a wrong quote: {error}") from None


def _decoded(raw: bytes) -> str:
    try:
        return raw.decode().rstrip("\r\n")
    except UnicodeDecodeError:
        raise LagtopError("a row must be UTF-8 text") from None


def _double(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if value and math.isfinite(value) and text.isascii() and "_" not in text:
        return value
    if not text.strip():
        raise LagtopError(f"{name} must be a number, got an empty cell")
    try:
        return float(parse_number(text))
    except LagtopError as error:
        raise LagtopError(f"{name} {error}") from None


def _json_object(raw: bytes) -> dict[str, Any]:
    import orjson

    try:
        values = orjson.loads(raw)
    except ValueError as error:
        raise LagtopError(f"a row must be a JSON object: {error}") from None
    if not isinstance(values, dict):
        raise LagtopError(f"a row must be a JSON object, got {_shown(values)}")
    return values


def _json_double(name: str, value: Any) -> float:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    raise LagtopError(f"{name} must be a finite number, got {_shown(value)}")


def _shown(value: Any) -> str:
    return json_text(value)[:60]


def open_rows(path: str, computed: Collection[str], size: int) -> tuple[RowFile, Iterator[Lines]]:
    """How to read a file (or standard input, for `-`), and its lines, `size` at a time.

    Columns whose names are in `computed` are neither read nor carried through.
    Raises LagtopError for a file without a header or an object.
    """
    name = "standard input" if path == "-" else path
    lines = _lines(path, name)
    start, first = next(((i, raw) for i, raw in lines if raw.strip()), (1, b""))
    first = first.removeprefix(b"\xef\xbb\xbf")
    if first.lstrip().startswith(b"{"):
        blocks = _blocks(chain([(start, first)], lines), size)
        head = next(blocks)
        carried = [x for x in _names(head) if x not in computed]
        _check_spelling(carried, name)
        return RowFile(None, carried, frozenset(computed)), chain([head], blocks)
    try:
        columns = [cell.strip() for cell in split_cells(_decoded(first))]
    except LagtopError as error:
        raise LagtopError(f"{name}, line {start}: {error}") from None
    carried = [x for x in columns if x not in INPUTS and x not in computed]
    _check_spelling(carried, name)
    _check_header(columns, name)
    return RowFile(columns, carried, frozenset(computed)), _blocks(lines, size)


def _lines(path: str, name: str) -> Iterator[tuple[int, bytes]]:
    try:
        if path == "-":
            yield from enumerate(sys.stdin.buffer if sys.stdin else (), 1)
            return
        with open(path, "rb") as stream:
            yield from enumerate(stream, 1)
    except OSError as error:
        raise LagtopError(f"{name}: {error.strerror}") from None


def _blocks(lines: Iterator[tuple[int, bytes]], size: int) -> Iterator[Lines]:
    while block := list(islice(lines, size)):
        yield Lines(block[0][0], [raw for _, raw in block])


def _names(head: Lines) -> list[str]:
    """The keys in a block of JSON lines that name no input, in the order they come in."""
    names: dict[str, None] = {}
    for raw in head.texts:
        with suppress(LagtopError):  # which the row will name
            names |= dict.fromkeys(_json_object(raw) if raw.strip() else ())
    return [name for name in names if name not in INPUTS]


def _check_spelling(carried: Sequence[str], name: str) -> None:
    """Raise LagtopError for a column that is not read but looks like an input."""
    for column in carried:
        for known in INPUTS:
            if _plain(column) == _plain(known):
                raise LagtopError(f"{name}: the column {column} must be spelt {known}")


def _plain(column: str) -> str:
    """Without what is easily mistaken: case, underscores, the 0 of theta0, the unit."""
    return re.sub("_|0|deg$|rad$", "", column.lower()) or column


def _check_header(columns: Sequence[str], name: str) -> None:
    if twice := [x for i, x in enumerate(columns) if x in columns[:i]]:
        raise LagtopError(f"{name} must name each column once, got {twice[0]!r} twice")
    if not set(columns) & set(INPUTS):
        raise LagtopError(
            f"{name} must begin with a header that names inputs ({' '.join(INPUTS)}), "
            f"got {','.join(columns)[:60]!r}"
        )
