"""Rows of numbers and texts as lines of CSV and objects of JSON (by orjson), and as Parquet."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import chain, pairwise, repeat
from typing import Any, BinaryIO

import numpy as np
import orjson

from ..arithmetic.text import csv_text, json_text
from ..arithmetic.types import Array
from ..errors import UnavailableError

Columns = Sequence["Array | Sequence[Any]"]
"""The columns of a block, in one of two types.

Arrays hold numbers, with one or several columns each and NaN for missing values.  Lists hold texts
and JSON values.
"""

_FEW = 8
"""Numbers per row up to which an array is written as one text instead of row by row."""
_CELLS_AT_ONCE = 1 << 15
"""Number of cells of a block that are processed together, in the cache."""
_WIDE = 256
"""Characters per row beyond which the ends of rows are found first, because splitting at `],[` is
slower.
"""


def csv_lines(columns: Columns, names: Sequence[str]) -> bytes:
    """Return a line of CSV per row, with an empty cell for NaN."""
    if not len(columns[0]):
        return b""
    first = columns[0]
    if len(columns) == 1 and len(names) <= _FEW and isinstance(first, np.ndarray):
        if len(names) > 1:
            return _array_lines(first)
        if np.isfinite(first).all():
            return _one_column(first)
    if len(names) > 1:
        parts = [part for column in columns for part in _parts(column)]
        return b"".join(map(_lines, _slices(parts, names)))
    # Readers would skip an empty line.
    return b"".join(b"%s\n" % (cell or b'""') for cell in _cells(first))


def _lines(columns: Columns) -> bytes:
    """Return lines of CSV, joined from pieces; equal parts of all rows are one piece.

    Such parts are the commas, and texts that are equal in all rows.
    """
    pieces: list[Iterable[bytes]] = []
    between = b""
    for i, column in enumerate(columns, 1):
        cells, after = _cells(column), b"," if i < len(columns) else b"\n"
        if cells.count(cells[0]) == len(cells):
            between += cells[0] + after
            continue
        if between:
            pieces.append(repeat(between))
        pieces.append(cells)
        between = after
    pieces.append(repeat(between, len(columns[0])))
    return b"".join(chain.from_iterable(zip(*pieces, strict=False)))


def _array_lines(rows: Array) -> bytes:
    """Return an array of numbers as CSV, a line per row and an empty cell for NaN."""
    text = bytearray(orjson.dumps(rows.ravel(), option=orjson.OPT_SERIALIZE_NUMPY))
    if b"n" in text:
        text = text.replace(b"null", b"")
    # Commas at the ends of rows are replaced in place: a search for `],[` takes twice as long.
    view = np.frombuffer(text, dtype=np.uint8)
    commas = np.flatnonzero(view == ord(","))
    view[commas[rows.shape[1] - 1 :: rows.shape[1]]] = ord("\n")
    view[-1] = ord("\n")
    return bytes(view[1:])


def _one_column(numbers: Array) -> bytes:
    """Return finite numbers, each on a line."""
    text = orjson.dumps(numbers.ravel(), option=orjson.OPT_SERIALIZE_NUMPY)
    return text[1:-1].replace(b",", b"\n") + b"\n"


def _slices(columns: Columns, names: Sequence[str]) -> Iterator[Columns]:
    """Yield slices of rows of a block."""
    step = max(_CELLS_AT_ONCE // len(names), 1)
    for first in range(0, len(columns[0]), step):
        yield [column[first : first + step] for column in columns]


def _parts(column: Array | Sequence[Any]) -> Iterator[Array | Sequence[Any]]:
    """Yield an array in up to three parts, with equal columns at either end separated.

    Such a part is a view of one row, for example of the inputs that all tops of a sweep share.
    """
    if not isinstance(column, np.ndarray):
        yield column
        return
    bits = column.view(np.int64)
    alike = bits[0] == bits[-1]  # all rows can only be equal if the ends are
    alike[alike] = (bits[:, alike] == bits[0, alike]).all(axis=0)
    places = np.flatnonzero(~alike).tolist()
    first, end = (places[0], places[-1] + 1) if places else (column.shape[1],) * 2
    same = np.broadcast_to(column[0], column.shape)
    yield from (x for x in (same[:, :first], column[:, first:end], same[:, end:]) if x.size)


def _cells(column: Array | Sequence[Any]) -> Sequence[bytes]:
    """Return columns of a CSV file, a text per row."""
    if not isinstance(column, np.ndarray):
        return _texts_of(column, _csv_cell)
    if column.strides[0] == 0:  # one row, repeated
        return _array_rows(column[:1]) * len(column)
    return _array_rows(column)


def _array_rows(rows: Array) -> list[bytes]:
    """Return an array of numbers as text per row, with an empty cell for NaN."""
    text = orjson.dumps(np.ascontiguousarray(rows), option=orjson.OPT_SERIALIZE_NUMPY)
    if b"n" in text:
        text = text.replace(b"null", b"")
    if len(text) < _WIDE * len(rows):
        return text[2:-2].split(b"],[")
    ends = np.flatnonzero(np.frombuffer(text, dtype=np.uint8) == ord("]")).tolist()[:-1]
    return [text[last + 3 : end] for last, end in pairwise([-1, *ends])]


def json_objects(columns: Columns, names: Sequence[str], between: bytes, end: bytes = b"") -> bytes:
    """Return the JSON objects of all rows, with some bytes between them and at the end.

    Members are formatted column by column, several times as fast as objects one by one.
    """
    keys = [orjson.dumps(name) + b":" for name in names]
    rows: list[bytes] = []
    for few in _slices(columns, names):
        rows += map(b",".join, zip(*_members(few, keys), strict=True))
    if not rows:
        return b""
    rows[0] = b"{" + rows[0]
    rows[-1] += b"}" + end
    return (b"}" + between + b"{").join(rows)


def _members(columns: Columns, keys: Sequence[bytes]) -> Iterator[Sequence[bytes]]:
    """Yield the members of JSON objects, column by column."""
    left = iter(keys)
    for column in columns:
        if isinstance(column, np.ndarray):
            for numbers, key in zip(np.ascontiguousarray(column.T), left, strict=False):
                yield _number_members(numbers, key)
        else:
            yield _texts_of(column, partial(_member, next(left)))


def _member(key: bytes, value: Any) -> bytes:
    return key + orjson.dumps(value)


def _number_members(numbers: Array, key: bytes) -> Sequence[bytes]:
    """Return numbers as members of JSON objects, with null for NaN."""
    bits = numbers.view(np.int64)
    count = 1 if (bits == bits[0]).all() else numbers.size  # one text, if all are the same
    text = orjson.dumps(numbers[:count], option=orjson.OPT_SERIALIZE_NUMPY)[1:-1]
    members = (key + text.replace(b",", b"\n" + key)).split(b"\n")
    return members * (numbers.size // count)


def _texts_of(column: Sequence[Any], write: Callable[[Any], bytes]) -> Sequence[bytes]:
    """Return a text per value; repeated texts, and None, are formatted once."""
    try:
        different = set(column)
    except TypeError:  # a JSON value that cannot be hashed
        return [write(value) for value in column]
    if not all(value is None or type(value) is str for value in different):
        return [write(value) for value in column]
    known = {value: write(value) for value in different}
    return (
        list(map(known.__getitem__, column)) if len(known) > 1 else [*known.values()] * len(column)
    )


def _csv_cell(value: Any) -> bytes:
    return csv_text(value).encode()


def check_parquet() -> None:
    """Raise UnavailableError if pyarrow is not installed."""
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        raise UnavailableError(
            "format parquet needs pyarrow: pip install 'lagtop[parquet]'", "format"
        ) from None


def arrow_block(columns: Sequence[Any], names: Sequence[str]) -> bytes:
    """Return columns as one Arrow stream: numbers with null for NaN, and texts."""
    import pyarrow as pa

    arrays = chain.from_iterable(
        [pa.array(x, from_pandas=True) for x in column.T]
        if isinstance(column, np.ndarray)
        else [pa.array([None if x is None else _text(x) for x in column], pa.string())]
        for column in columns
    )
    table = pa.table(list(arrays), names=list(names))
    with pa.BufferOutputStream() as stream:
        with pa.ipc.new_stream(stream, table.schema) as writer:
            writer.write_table(table)
        return stream.getvalue().to_pybytes()  # type: ignore[no-any-return]


def write_parquet(
    stream: BinaryIO,
    names: Sequence[str],
    blocks: Iterable[bytes],
    description: Mapping[str, str],
) -> None:
    """Write Arrow streams as one Parquet file, a row group per stream.

    The description goes into the metadata of the schema.
    """
    import pyarrow as pa
    from pyarrow import parquet

    tables = (
        pa.ipc.open_stream(block).read_all().replace_schema_metadata(description)
        for block in blocks
    )
    first = next(tables, None)
    empty = pa.schema([(x, pa.null()) for x in names], description)
    # closed in any case, because a writer that is collected later writes to a closed file
    with parquet.ParquetWriter(stream, empty if first is None else first.schema) as writer:
        for table in chain([] if first is None else [first], tables):
            writer.write_table(table)


def _text(value: Any) -> str:
    return value if type(value) is str else json_text(value)
