"""The formats of rows: csv, json, ndjson, parquet, and a table for people.

A double has the same text in all formats (see `arithmetic.text`).  Any process may format a block
of rows as bytes (`block_text`); one process writes all blocks (`write`).
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from io import BytesIO
from itertools import chain
from types import NoneType
from typing import TYPE_CHECKING, Any, BinaryIO

import orjson

from ..arithmetic.text import NumberText, shortened
from ..errors import LagtopError
from .terminal import printable
from .text import csv_text, json_text

if TYPE_CHECKING:
    from ..arithmetic.types import Array

Texts = Sequence[Sequence[str]]
"""A block of rows with numbers as text; an empty text is a missing number."""
BlockColumns = Sequence[Any]
"""Arrays of numbers, each of one or several columns, and lists of texts and JSON values."""
MOST_DRAWN_ROWS = 10_000
"""Most rows of a table for people, because rich takes long for many."""


def block_text(columns: BlockColumns, names: Sequence[str], fmt: str) -> bytes:
    """Return a block of rows in a format; NaN, None and an empty number are missing values."""
    if not len(columns[0]):
        return b""
    if fmt == "parquet":
        return _parquet_file(columns, names)
    if fmt == "table":
        columns = [[*map(_shown, x)] if isinstance(x, Sequence) else x for x in columns]
    if fmt in {"json", "ndjson"}:
        rows = _json_rows(columns, names)
        return b",\n".join(rows) if fmt == "json" else b"".join(row + b"\n" for row in rows)
    if len(columns) == 1 and not isinstance(columns[0], Sequence):
        return _array_lines(columns[0], b"" if len(names) > 1 else b'""')  # no line is empty
    lines = zip(*map(_csv_cells, columns), strict=True)
    return b"".join((b",".join(line) or b'""') + b"\n" for line in lines)  # no line is empty


def _array_lines(column: Array, missing: bytes = b"") -> bytes:
    """Return an array of numbers as CSV, a line per row and a `missing` cell for NaN."""
    import numpy as np

    rows = column.reshape(len(column), -1)
    text = bytearray(orjson.dumps(rows.ravel(), option=orjson.OPT_SERIALIZE_NUMPY))
    if b"n" in text:
        text = text.replace(b"null", missing)
    # Commas at the ends of rows are replaced in place: a search for `],[` takes twice as long.
    view = np.frombuffer(text, dtype=np.uint8)
    commas = np.flatnonzero(view == ord(","))
    view[commas[rows.shape[1] - 1 :: rows.shape[1]]] = ord("\n")
    view[-1] = ord("\n")
    return bytes(view[1:])


def _csv_cells(column: Any) -> Sequence[bytes]:
    """Return the cells of columns, a text per row."""
    if isinstance(column, Sequence):
        if not {*map(type, column)} <= {str, NoneType}:
            return [csv_text(x).encode() for x in column]
        cells = {x: csv_text(x).encode() for x in {*column}}  # a sweep repeats few texts
        return [cells[x] for x in column]
    return _array_lines(column).split(b"\n")[:-1]


def _shown(value: Any) -> str | None:
    """Return a text for a table: one line of printable characters, and not too many."""
    if value is None or isinstance(value, NumberText):
        return value
    return shortened(printable(value if isinstance(value, str) else json_text(value), ""), 500)


def _json_rows(columns: BlockColumns, names: Sequence[str]) -> list[bytes]:
    lists = chain.from_iterable(
        [x] if isinstance(x, Sequence) else x.reshape(len(x), -1).T.tolist() for x in columns
    )
    rows = (dict(zip(names, row, strict=True)) for row in zip(*lists, strict=True))
    as_written = orjson.OPT_PASSTHROUGH_SUBCLASS
    return [orjson.dumps(row, default=_fragment, option=as_written) for row in rows]


def _fragment(value: Any) -> Any:
    """Return a number that is written out already with its digits, or a plain value."""
    if isinstance(value, NumberText):
        return orjson.Fragment(str(value) or "null")
    return str(value) if isinstance(value, str) else float(value)


def write(
    stream: BinaryIO,
    names: Sequence[str],
    blocks: Iterable[bytes],
    fmt: str,
    width: int | None = None,
) -> None:
    """Write blocks of rows, with the bytes before, between and after them.

    A table is drawn when all rows are known, in the `width` of a terminal if there is one.
    """
    blocks = filter(None, blocks)
    if fmt == "parquet":
        _write_parquet(stream, names, blocks)
    elif fmt == "table":
        from .report import rows_text

        rows: list[list[str]] = []
        for block in blocks:
            rows += csv.reader(block.decode().splitlines())
            if len(rows) > MOST_DRAWN_ROWS:
                wanted = f"table shows at most {MOST_DRAWN_ROWS} rows"
                raise LagtopError(f"format {wanted}, got more: use csv", "format")
        stream.write(rows_text(names, rows, width).encode())
    else:
        first = next(blocks, b"")  # before anything is written, because most errors occur here
        stream.write({"json": b"[", "ndjson": b""}.get(fmt, _csv_header(names)) + first)
        for block in blocks:
            stream.write((b",\n" if fmt == "json" else b"") + block)
        stream.write(b"]\n" if fmt == "json" else b"")


def part_file(fmt: str, names: Sequence[str], number: int, text: bytes) -> bytes:
    """Return the content of the file of a part, from the text that `block_text` made.

    The concatenation of CSV or NDJSON files is the output of `write`: only part 0 begins with the
    header.  A Parquet file is complete by itself.
    """
    return text if number or fmt != "csv" else _csv_header(names) + text


def _csv_header(names: Sequence[str]) -> bytes:
    return f"{','.join(map(csv_text, names))}\n".encode()


def _parquet_file(columns: BlockColumns, names: Sequence[str]) -> bytes:
    """Return columns as a Parquet file: numbers with null for NaN, and texts."""
    import pyarrow as pa
    from pyarrow import parquet

    arrays = []
    for column in columns:
        if isinstance(column, Sequence):
            texts = [x if x is None or type(x) is str else json_text(x) for x in column]
            arrays.append(pa.array(texts, pa.string()))
        else:
            numbers = column.reshape(len(column), -1).T.copy()
            arrays += [pa.array(x, from_pandas=True) for x in numbers]
    parquet.write_table(pa.table(arrays, names=list(names)), file := BytesIO())
    return file.getvalue()


def _write_parquet(stream: BinaryIO, names: Sequence[str], blocks: Iterable[bytes]) -> None:
    """Write Parquet files as one, a row group per file."""
    import pyarrow as pa
    from pyarrow import parquet

    files = (parquet.ParquetFile(pa.BufferReader(block)) for block in blocks)
    tables = (file.read(use_threads=False) for file in files)  # threads may abort at the exit
    first = next(tables, pa.table({name: pa.nulls(0) for name in names}))
    # closed in any case, because a writer that is collected later writes to a closed file
    with parquet.ParquetWriter(stream, first.schema) as writer:
        for table in chain([first], tables):
            writer.write_table(table)
