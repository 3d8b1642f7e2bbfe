"""The formats of rows: csv, json, ndjson, parquet, npy, table and markdown.

A double has the same text in all formats (see `arithmetic.text`).  Any process may format a block
of rows as bytes (`block_text`); one process writes all blocks (`Output.blocks`).
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from io import BytesIO
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

from ..arithmetic.text import csv_text
from .terminal import View

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from .rows import Columns

Texts = Sequence[Sequence[str]]
"""A block of rows with numbers as text; an empty text is a missing number."""
Names = Sequence[str]


class Header(list[str]):
    """The names of columns, with a description of their numbers."""

    def __init__(self, names: Iterable[str], description: Mapping[str, str]) -> None:
        super().__init__(names)
        self.description = description


def description_of(names: Names) -> Mapping[str, str]:
    """Return the description that belongs to the names of columns, if any."""
    return names.description if isinstance(names, Header) else {}


class Format(NamedTuple):
    """A format: the bytes before, between and after blocks of rows, and of a block itself."""

    block: Callable[[Columns, Names], bytes]
    """Makes the bytes of rows of numbers and JSON values, from their columns."""
    texts: Callable[[Texts, Names], bytes] | None = None
    """Makes the bytes of numbers as text.  A format without this function holds doubles."""
    opening: Callable[..., bytes] = lambda names, count=0: b""
    """Makes the bytes before the rows, whose number is 0 if it is unknown."""
    between: bytes = b""
    closing: bytes = b""
    whole: Callable[[Names, Iterable[bytes], View, BinaryIO], None] | None = None
    """Writes all blocks as one document, if this is not the mere sequence of the blocks."""

    def rows(self, block: Array | Texts, names: Names) -> bytes:
        """Return the bytes of an array, or of numbers as text."""
        if not isinstance(block, list):
            return self.block([block], names)
        return self.texts(block, names) if self.texts else self.block([_doubles(block)], names)

    def write(
        self, stream: BinaryIO, names: Names, blocks: Iterable[bytes], view: View, count: int
    ) -> None:
        """Write blocks of rows, with the bytes before, between and after them."""
        blocks = filter(None, blocks)
        if self.whole:
            self.whole(names, blocks, view, stream)
            return
        first = next(blocks, b"")  # before anything is written, because most errors occur here
        stream.write(self.opening(names, count) + first)
        for block in blocks:
            stream.write(self.between + block)
        stream.write(self.closing)


def _of_rows(function: str, **how: Any) -> Callable[..., Any]:
    """Return a function of the module `rows`, which a call imports with NumPy and orjson."""

    def call(*args: Any) -> Any:
        from . import rows  # start-up

        return getattr(rows, function)(*args, **how)

    return call


def _csv_header(names: Names, count: int = 0) -> bytes:
    """Return the header, below comments that describe it."""
    comments = "".join(f"# {key}: {text}\n" for key, text in description_of(names).items())
    return f"{comments}{','.join(map(csv_text, names))}\n".encode()


def _csv_texts(rows: Texts, names: Names) -> bytes:
    """Return a line per row; readers would skip an empty line."""
    return "".join(f"{','.join(row) or _EMPTY}\n" for row in rows).encode()


def _json_texts(rows: Texts, names: Names, between: str, end: str) -> bytes:
    """Return the JSON objects of rows of numbers as text, as orjson would write them."""
    keys = [f'"{name}":' for name in names]
    members = ([f"{key}{x or 'null'}" for key, x in zip(keys, row, strict=True)] for row in rows)
    return between.join(f"{{{','.join(few)}}}{end}" for few in members).encode()


def _npy_header(names: Names, count: int) -> bytes:
    """Return the header of a structured array with a field of doubles per column."""
    import numpy as np

    stream, row = BytesIO(), np.dtype([(name, "<f8") for name in names])
    header = {"descr": row.descr, "fortran_order": False, "shape": (count,)}
    np.lib.format.write_array_header_1_0(stream, header)
    return stream.getvalue()


def _npy_rows(columns: Columns, names: Names) -> bytes:
    import numpy as np

    (block,) = columns
    return np.ascontiguousarray(block, dtype="<f8").tobytes()


def _doubles(rows: Texts) -> Array:
    """Return rows of numbers as text as an array, with NaN for an empty text."""
    import numpy as np

    return np.array([[float(x or "nan") for x in row] for row in rows])


def _write_parquet(names: Names, blocks: Iterable[bytes], view: View, stream: BinaryIO) -> None:
    """Write a row group per block, an Arrow stream."""
    from .rows import write_parquet  # start-up

    write_parquet(stream, names, blocks, description_of(names))


def _draw(fmt: str, names: Names, blocks: Iterable[bytes], view: View, stream: BinaryIO) -> None:
    """Write a table or markdown, drawn when all rows are known, from blocks of CSV."""
    from .report import rows_text  # start-up

    rows = list(csv.reader(b"".join(blocks).decode().splitlines()))
    stream.write(rows_text(names, rows, fmt, view))


_EMPTY = '""'
_CSV = Format(_of_rows("csv_lines"), _csv_texts, _csv_header)
FORMATS = {
    "table": _CSV._replace(whole=partial(_draw, "table")),
    "markdown": _CSV._replace(whole=partial(_draw, "markdown")),
    "csv": _CSV,
    "json": Format(
        _of_rows("json_objects", between=b",\n"),
        partial(_json_texts, between=",\n", end=""),
        lambda names, count=0: b"[",
        b",\n",
        b"]\n",
    ),
    "ndjson": Format(
        _of_rows("json_objects", between=b"\n", end=b"\n"),
        partial(_json_texts, between="", end="\n"),
    ),
    "parquet": Format(_of_rows("arrow_block"), whole=_write_parquet),
    "npy": Format(_npy_rows, opening=_npy_header),
}
"""The formats by name."""


def block_text(columns: Columns, names: Names, fmt: str) -> bytes:
    """Return a block of rows in a format, for `Output.blocks`."""
    return FORMATS[fmt].block(columns, names)


def part_file(fmt: str, names: Names, number: int, text: bytes) -> bytes:
    """Return the content of the file of a part, from the text that `block_text` made.

    The concatenation of the files is the output of `Output.blocks`.  Only part 0 begins with the
    header.  A Parquet file is complete by itself.
    """
    form, stream = FORMATS[fmt], BytesIO()
    if not form.whole:
        return text if number else form.opening(names) + text
    form.write(stream, names, [text], View(), 0)
    return stream.getvalue()
