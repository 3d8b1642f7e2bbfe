"""What a format does, and what the formats for people share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from io import BytesIO
from typing import Any, BinaryIO

from ...errors import LagtopError
from ...names import listed
from ..document import Document, Page, rows_grid, texts_of
from . import FORMATS

Columns = Sequence[Any]
"""Arrays of numbers, each of one or several columns, and lists of texts and JSON values."""
MOST_DRAWN_ROWS = 10_000
"""Most rows of a table for people, because rich takes long for many."""


class Format:
    """A way to write documents, and rows in blocks.

    Any process may encode a block of rows; one process writes all blocks.
    """

    is_for_people = False
    """Whether it holds texts and tables: headings with units, numbers with uncertainties."""
    only_rows = False
    """Whether it holds only the rows of a document; then each part of a sweep may be a file."""
    blocks_in_part = 1
    """The number of blocks of a sweep in each file of its parts."""
    between = after = b""
    """What comes between two blocks, and after the last one."""

    def document(self, document: Document, width: int | None) -> bytes:
        """Return a document, for the `width` of a terminal if there is one: its rows."""
        block = self.block(document.columns(), document.names)
        self.write(stream := BytesIO(), document.names, [block], width)
        return stream.getvalue()

    def block(self, columns: Columns, names: Sequence[str]) -> Any:
        """Return some rows encoded; NaN, None and an empty number are missing values."""
        raise NotImplementedError

    def with_units(self, block: Any, units: Mapping[str, str]) -> Any:
        """Return encoded rows with units of their columns, if the format has a place for them."""
        return block

    def header(self, names: Sequence[str]) -> bytes:
        """Return what comes before the first block."""
        return b""

    def write(
        self, stream: BinaryIO, names: Sequence[str], blocks: Iterable[Any], width: int | None
    ) -> None:
        """Write encoded blocks, with what comes before, between and after them."""
        each = iter(blocks)
        first = next(each, b"")  # before anything is written, because most errors occur here
        stream.write(self.header(names) + first)
        for block in each:
            stream.write(self.between + block)
        stream.write(self.after)

    def part(self, names: Sequence[str], number: int, block: Any) -> bytes:
        """Return the file of part `number` of a sweep, whose files in order are the whole."""
        return self.header(names) * (not number) + bytes(block)


def format_of(name: str) -> Format:
    """Return the format with a name, or a form of one such as `csv.WITH_COMMAS`."""
    module, _, form = name.partition(".")
    found: Format = getattr(import_module(f".{module}", __package__), form or "FORMAT")
    return found


class ForPeople(Format):
    """A format of texts and tables, written when all rows are known."""

    is_for_people = True

    def page(self, page: Page, width: int | None) -> str:
        """Return a page as text."""
        raise NotImplementedError

    def document(self, document: Document, width: int | None) -> bytes:
        """Return the page of a document."""
        return self.page(document.page(width), width).encode()

    def block(self, columns: Columns, names: Sequence[str]) -> Columns:
        """Return the columns as they are."""
        return columns

    def write(
        self, stream: BinaryIO, names: Sequence[str], blocks: Iterable[Any], width: int | None
    ) -> None:
        """Write all rows as one table.  Raises LagtopError for too many."""
        rows: list[Sequence[str]] = []
        for block in blocks:
            rows += texts_of(block)
            if len(rows) > MOST_DRAWN_ROWS:
                others = listed(x for x in FORMATS if not format_of(x).is_for_people)
                most = f"for more than {MOST_DRAWN_ROWS} rows"
                raise LagtopError(f"format must be {others} {most}", "format")
        stream.write(self.page([rows_grid(names, rows)], width).encode())
