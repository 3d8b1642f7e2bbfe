"""The functions that write: a value, a record, a table, parts of a sweep or a report.

Each opens the destination (see `destination`) and leaves the bytes to a format (see `formats`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import value_text
from .destination import opened
from .formats import FORMAT_BY_NAME, Texts
from .terminal import view_of

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from .layouts import Layout
    from .report import Report
    from .row_texts import Columns

MAX_TABLE_ROWS = 10_000
"""The most rows that are drawn: more of them are neither read nor quickly made."""


def write_values(values: Iterable[Any], path: str) -> None:
    """Write values, bare, one per line."""
    with opened(path) as stream:
        stream.write("".join(f"{value_text(value)}\n" for value in values).encode())


def write_bytes(path: str, make: Callable[[], bytes]) -> None:
    """Write a picture, which is made only when there is a place for it."""
    with opened(path) as stream:
        stream.write(make())


def write_record(
    record: Mapping[str, Any], fmt: str, path: str, layout: Callable[[], Layout]
) -> None:
    """Write one record as a `table` of this layout, `csv` or `json`."""
    text = FORMAT_BY_NAME[fmt].record(record, layout, view_of(path))
    with opened(path) as stream:
        stream.write(text)


def write_table(
    names: Sequence[str], blocks: Iterable[Array | Texts], fmt: str, path: str, count: int = 0
) -> None:
    """Write `count` rows in blocks, which are arrays or lists of numbers written out.

    Where nobody knows the count it is 0.
    """
    with opened(path) as stream:
        FORMAT_BY_NAME[fmt].write_table(stream, names, blocks, view_of(path), count)


def write_text_blocks(fmt: str, names: Sequence[str], blocks: Iterable[bytes], path: str) -> None:
    """Write blocks made by `block_text`, with what stands before, between and after them."""
    with opened(path) as stream:
        FORMAT_BY_NAME[fmt].write_blocks(stream, names, blocks)


def block_text(columns: Columns, names: Sequence[str], fmt: str) -> bytes:
    """Return a block of rows in a format, for `write_text_blocks`."""
    return FORMAT_BY_NAME[fmt].block(columns, names)


def part_file(fmt: str, names: Sequence[str], number: int, text: bytes) -> bytes:
    """Return the content of the file of a part, from the text that `block_text` made.

    One after the other the files are what `write_text_blocks` writes; but for Parquet, where each
    is whole.
    """
    return FORMAT_BY_NAME[fmt].part(names, number, text)


def write_findings(find: Callable[[], Report], fmt: str, path: str) -> Report:
    """Write what a report finds, and return it.

    The destination is opened before the report is made, which takes long.
    """
    with opened(path) as stream:
        findings = find()
        stream.write(FORMAT_BY_NAME[fmt].findings(findings, view_of(path)))
    return findings
