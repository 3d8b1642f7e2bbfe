"""A document: a result as rows for programs, and as a page of texts and tables for people."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from functools import partial
from itertools import groupby
from textwrap import fill
from typing import Any, NamedTuple

from ..arithmetic.text import NumberText, shortened, value_text
from ..names import RADIUS, Key
from .terminal import printable
from .text import json_text

Keys = Mapping[str, Key]
"""Keys of a record by name, in the order of a table."""
WIDE = 110
"""Width in columns from which on the table of a record has the names too."""


class Grid(NamedTuple):
    """A table for people, in texts."""

    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    """A row with one cell is the title of the rows below it."""
    numbers: Container[int] = ()
    """The places of columns that hold numbers."""
    may_stand: bool = False
    """Whether columns may become lines, if only that fits a terminal."""


class Lines(NamedTuple):
    """Lines that stay apart; on a terminal they are wrapped before `hanging`, unless it is 0."""

    lines: Sequence[str]
    hanging: int = 0


Page = Sequence[str | Grid | Lines]
"""Paragraphs, tables and lines, with an empty line between them."""


class Document(NamedTuple):
    """A result that every format can write."""

    names: Sequence[str]
    """The columns."""
    rows: Sequence[Mapping[str, Any]]
    """The rows by column; NDJSON writes all of their values, CSV and Parquet the columns."""
    page: Callable[[int | None], Page]
    """What people read, for the width of a terminal if there is one."""
    whole: Any = None
    """What JSON holds, if it is not the list of rows."""
    asides: Sequence[str] = ()
    """Lines for standard error if the format holds only the rows."""

    def columns(self) -> list[list[Any]]:
        """Return the rows by column."""
        return [[row.get(name) for row in self.rows] for name in self.names]


def record_document(
    record: Mapping[str, Any],
    keys: Callable[[], Keys],
    more: Mapping[str, Any] | None = None,
    shown: Mapping[str, Any] | None = None,
) -> Document:
    """Return one record: its row, with what only JSON has `more`, and what is `shown` to people."""
    whole = {**record, **(more or {})}
    page = partial(record_page, whole | {**(shown or {})}, keys)
    return Document([*record], [whole], page, whole)


def rows_grid(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Grid:
    """Return rows of numbers and texts as a table."""
    return Grid(headings, rows, range(len(headings)), may_stand=True)


def lists_of(columns: Sequence[Any]) -> Iterator[Sequence[Any]]:
    """Yield a list for each column of arrays of one or several columns, and of lists."""
    for x in columns:
        yield from [x] if isinstance(x, Sequence) else x.reshape((*x.shape, 1)[:2]).T.tolist()


def texts_of(columns: Sequence[Any]) -> list[tuple[str, ...]]:
    """Return rows of texts, of the columns that `lists_of` takes."""
    return [*zip(*([*map(shown_text, x)] for x in lists_of(columns)), strict=True)]


def record_page(record: Mapping[str, Any], declared: Callable[[], Keys], width: int | None) -> Page:
    """Return a record: its summary, a line for each key with a value, and its remark.

    If there are radii, they replace the equations.
    """
    keys = declared()
    last = "Radius" if any(f"{name}{RADIUS}" in record for name in keys) else "Equation"
    headings = ["Key", "Symbol", "Name", "Value", "Unit", last]
    if (width or 0) < WIDE:
        headings.remove("Name")
    rows: list[list[str]] = []
    with_value = (x for x in keys.items() if record.get(x[0]) is not None and x[0] != "remark")
    for group, items in groupby(with_value, lambda x: x[1].group):
        rows.append([group])
        for name, key in items:
            cells = {"Key": name, "Symbol": key.symbol, "Name": key.meaning, "Unit": key.unit}
            cells["Value"] = value_text(record[name])
            cells["Equation"] = key.equation
            cells["Radius"] = value_text(record.get(f"{name}{RADIUS}"))
            rows.append([cells[heading] for heading in headings])
    summary, remark = record.get("summary"), record.get("remark")
    table = Grid(headings, rows, [headings.index("Value")])
    return [*filter(None, [summary and fill(summary, width or 80)]), table, *filter(None, [remark])]


def shown_text(value: Any) -> str:
    """Return a text for a table: one line of printable characters, and not too many."""
    if value is None or isinstance(value, float | NumberText):
        return value_text(value)
    return shortened(printable(value if isinstance(value, str) else json_text(value), ""), 500)
