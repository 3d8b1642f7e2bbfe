"""Binary tables, which hold columns: Parquet, and MATLAB's .mat."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, partial
from io import BytesIO
from typing import Any

import numpy as np

from ..arithmetic.text import shortened
from ..arithmetic.types import Array
from ..errors import DataError, UnavailableError, install
from ..file_bytes import LARGEST_FILE
from .matlab_elements import check_elements
from .text_tables import NumericColumns, Table

_TIMES = ("timestamp", "duration")
_BYTES_OF_A_NUMBER = 24
"""Bytes that a number may take in memory and on the way there."""


@dataclass
class _Rows:
    """The rows of some columns, which are put together when they are read."""

    columns: Sequence[Callable[[], Array]]
    """Functions that return the columns."""

    def __iter__(self) -> Iterator[tuple[int, list[Any]]]:
        cells = zip(*(read().tolist() for read in self.columns), strict=True)
        return ((number, [*row]) for number, row in enumerate(cells, 1))


@dataclass
class ColumnTable(Table):
    """A table of columns of numbers or texts; masked elements and None are empty cells."""

    rows: _Rows

    def numbers(self, columns: Sequence[int], names: Sequence[str]) -> NumericColumns:
        """Return columns of numbers, without the rows that have none in these columns."""
        found = [np.ma.asarray(self.rows.columns[i]()) for i in columns]
        if any(x.dtype == object for x in found):
            return self.of_cells(columns, names)
        values = np.stack([np.ma.filled(x.astype(float), np.nan) for x in found], axis=1)
        empty = np.stack([np.ma.getmaskarray(x) for x in found], axis=1)
        kept = ~empty.all(axis=1)
        return NumericColumns(values[kept], empty[kept], 1 + np.flatnonzero(kept))

    def column(self, index: int) -> Iterator[tuple[int, Any]]:
        """Yield the numbers of the rows and the cells of one column, None for an empty one."""
        return enumerate(self.rows.columns[index]().tolist(), 1)


def binary_table(content: bytes, name: str) -> Table | None:
    """Return the table in a binary file, None for another format.  Raises DataError."""
    formats = {b"PAR1": _parquet, b"MATLAB 5": _matlab, b"MATLAB 7": _matlab}
    read = next((y for x, y in formats.items() if content.startswith(x)), None)
    return read and read(content, name)


@contextmanager
def _decoding(name: str, kind: str) -> Iterator[None]:
    """Raise a DataError with the name of the file for any exception of a library."""
    try:
        yield
    except Exception as error:  # no library lists its exceptions
        why = shortened(" ".join(str(error).split()), 100) or type(error).__name__
        raise DataError(f"{name}: bad {kind} file: {why}") from None


def _parquet(content: bytes, name: str) -> Table:
    """Return the columns of numbers and texts; a time is a whole number in its own unit."""
    try:
        from pyarrow import BufferReader, parquet, types
    except ImportError:
        raise UnavailableError(f"{name}: Parquet needs pyarrow: {install('parquet')}") from None
    with _decoding(name, "Parquet"):
        file = parquet.ParquetFile(BufferReader(content))
        schema, is_number = file.schema_arrow, (types.is_floating, types.is_integer)
        numbers = [x.name for x in schema if any(y(x.type) for y in is_number)]
        size = file.metadata.num_rows * len(numbers)
        if size > (most := LARGEST_FILE // _BYTES_OF_A_NUMBER):
            raise ValueError(f"it must have at most {most} numbers, has {size}")

    @cache
    def column(index: int) -> Array:
        with _decoding(name, "Parquet"):
            same = [i for i, x in enumerate(schema.names) if x == schema.names[index]]
            read = file.read(columns=[schema.names[index]], use_threads=False)  # may abort at exit
            found = _of_arrow(read.column(same.index(index)))
            if len(found) != file.metadata.num_rows:
                raise ValueError(f"{len(found)} rows in {schema.names[index]}")
            return found

    kept = [i for i, x in enumerate(schema) if not types.is_nested(x.type)]
    times = {x.name: f" [{x.type.unit}]" for x in schema if str(x.type).startswith(_TIMES)}
    headings = [f"{x}{times.get(x, '')}" for x in (schema.names[i] for i in kept)]
    return _table(name, headings, [partial(column, i) for i in kept])


def _of_arrow(column: Any) -> Array:
    """Return a column of Arrow, with its integers as they are, masked where it is null."""
    kind = str(column.type)
    if kind.startswith(_TIMES):
        column = column.cast("int64")
    elif not kind.startswith(("int", "uint", "float", "double", "halffloat")):
        texts = column.cast("string").dictionary_encode().combine_chunks()  # equal ones are shared
        words = [*texts.dictionary.to_pylist(), None]
        return np.array([words[-1 if i is None else i] for i in texts.indices.to_pylist()], object)
    null = column.is_null().to_numpy()
    values = column.fill_null(0).to_numpy()
    return np.ma.array(values, mask=null) if null.any() else values


def _matlab(content: bytes, name: str) -> Table:
    """Return the matrices and vectors of a MATLAB file, or of its only struct, side by side."""
    from scipy.io import loadmat

    if b"MATLAB 7.3" in content[:128]:
        raise DataError(f"{name}: MATLAB 7.3 files are not read: save it with -v7")
    with _decoding(name, "MATLAB"):
        check_elements(content, LARGEST_FILE)
        found: Mapping[str, Any] = loadmat(BytesIO(content), simplify_cells=True)
    found = {x: y for x, y in found.items() if not x.startswith("__")}
    if len(found) == 1 and isinstance(only := next(iter(found.values())), dict):
        found = only
    arrays = {x: np.atleast_1d(y) for x, y in found.items() if np.asarray(y).dtype.kind in "iuf"}
    rows = max((len(x) for x in arrays.values()), default=0)
    blocks = {x: y.reshape(rows, -1) for x, y in arrays.items() if len(y) == rows}
    headings = [
        x if y.shape[1] == 1 else f"{x}_{i}" for x, y in blocks.items() for i in range(y.shape[1])
    ]
    has_names = len(blocks) > 1 or len(headings) == 1  # not a single matrix
    columns = [np.asarray(column) for y in blocks.values() for column in y.T]
    return _table(name, headings if has_names else None, [partial(np.asarray, x) for x in columns])


def _table(name: str, headings: list[str] | None, columns: list[Callable[[], Array]]) -> Table:
    return ColumnTable(name, headings, len(columns), _Rows(columns), place="row")
