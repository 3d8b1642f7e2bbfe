"""Trajectories as arrays: npy, npz and Parquet.

Rows are read as they are needed, so that memory does not grow with their number.  Sizes declared in
a file are checked before memory is allocated.  Any exception of a library for a broken file becomes
a DataError.  Streams must be seekable.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from io import UnsupportedOperation
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from ..arithmetic.text import quoted, shortened
from ..errors import DataError, LagtopError, UnavailableError
from .names import repeated
from .scene_file import description_in
from .trajectory_columns import quantities_in
from .trajectory_text import Block, Table, parts

if TYPE_CHECKING:
    from ..arithmetic.types import Array


ROWS_AT_ONCE = 1 << 15
NUMBERS_AT_ONCE = 1 << 21
LARGEST_ROW = 1 << 20
"""Most bytes of a row, as for a line of text."""
LARGEST_WHOLE = 1 << 28
"""Most bytes of an array in Fortran order inside an npz file, which is read whole."""
MOST_ARRAYS = 1000
"""Most arrays in an npz file."""


class ArrayTable(Table):
    """A table of numbers in blocks of rows."""

    place = "row"

    def __init__(
        self,
        name: str,
        form: str,
        names: Sequence[str] | None,
        width: int,
        tables: Callable[[int], Iterator[Array]],
    ) -> None:
        """Take a function that yields blocks of all columns, given the most rows of a block.

        `form` is the format with its article, for errors.
        """
        super().__init__(name, names, width)
        self.form, self._tables = form, tables

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns of the rows; null becomes NaN."""
        tables, first = self._tables(min(ROWS_AT_ONCE, 1 + NUMBERS_AT_ONCE // (1 + self.width))), 1
        while True:
            with _sound(self.name, self.form):
                table = next(tables, None)
            if table is None:
                return
            yield table[:, columns], range(first, first + len(table))
            first += len(table)


def read_arrays(stream: BinaryIO, name: str, kind: str) -> Table:
    """Return the rows of an npy, npz or Parquet file.  Raises DataError."""
    readers = {"npy": _read_npy, "npz": _read_npz, "parquet": _read_parquet}
    form = "a Parquet" if kind == "parquet" else f"an {kind}"
    with _sound(name, form):
        return readers[kind](stream, name, form)


@contextmanager
def _sound(name: str, form: str) -> Iterator[None]:
    """Turn any exception of a library that reads a broken file into a DataError."""
    try:
        yield
    except LagtopError:
        raise
    except Exception as error:  # no library lists its exceptions
        why = " ".join(str(error).split())[:100] or type(error).__name__
        raise DataError(f"{name}: not {form} file: {why}") from None


class NpyStream:
    """An array of an npy file, read row by row."""

    def __init__(self, stream: BinaryIO, name: str) -> None:
        """Read the header.  Raises DataError for anything but a table of real numbers."""
        self.stream, self.name = stream, name
        header = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }[np.lib.format.read_magic(stream)]
        self.shape, fortran, self.dtype = header(stream)
        self._fields = [(x, self.dtype[x]) for x in self.dtype.names or ()]
        kinds = {x.base.kind if 0 not in x.shape else "" for _, x in self._fields}
        kinds = kinds or {self.dtype.kind}
        if len(self.shape) not in {1, 2} or min(self.shape) < 0 or not kinds <= set("iuf"):
            raise DataError(
                f"{name} must be an array of real numbers with 1 or 2 dimensions, "
                f"got {shortened(str(self.dtype))} of shape {self.shape}"
            )
        self._row_bytes = math.prod(self.shape[1:]) * self.dtype.itemsize
        if self._row_bytes > LARGEST_ROW:
            raise DataError(f"{name}: a row must have at most {LARGEST_ROW} bytes")
        self.left = self.shape[0]
        self._whole = self._in_columns() if fortran and self.shape[1:] else None

    def rows(self, most: int) -> Array:
        """Return the next rows, at most `most`, as columns of float64."""
        count, start = min(most, self.left), self.shape[0] - self.left
        self.left -= count
        whole = self._whole
        table = self._read(count) if whole is None else whole[start : start + count]
        if self._fields:
            from numpy.lib.recfunctions import structured_to_unstructured

            table = structured_to_unstructured(table, np.dtype(np.float64))
        plain: Array = table.reshape(count, -1).astype(np.float64)
        return plain

    def _read(self, rows: int) -> Any:
        raw = self.stream.read(rows * self._row_bytes)
        self._check_size(len(raw), rows)
        return np.frombuffer(raw, self.dtype)

    def _in_columns(self) -> Any:
        """Return an array in Fortran order: mapped if it is a file, else read whole."""
        try:
            size = os.fstat(self.stream.fileno()).st_size - self.stream.tell()
        except UnsupportedOperation:  # a member of an npz file
            if self.left * self._row_bytes > LARGEST_WHOLE:
                raise DataError(
                    f"{self.name}: an array in Fortran order in an npz file must have at most "
                    f"{LARGEST_WHOLE} bytes (convert it with numpy.ascontiguousarray)"
                ) from None
            return self._read(self.left).reshape(self.shape, order="F")
        self._check_size(size, self.left)
        place: Any = {"offset": self.stream.tell(), "shape": self.shape}
        return np.memmap(cast(Any, self.stream), self.dtype, "r", order="F", **place)

    def _check_size(self, size: int, rows: int) -> None:
        if size < rows * self._row_bytes:
            raise DataError(f"{self.name} must hold {self.shape[0]} rows, but ends early")

    def names(self, key: str | None = None) -> list[str] | None:
        """Return the names of the columns, from the fields or the key of the array, if any."""
        if self._fields:
            sizes = ((name, math.prod(x.shape) if x.shape else 0) for name, x in self._fields)
            return [part for name, size in sizes for part in parts(name, size)]
        return None if key is None else parts(key, self.shape[1] if self.shape[1:] else 0)


def _side_by_side(arrays: Sequence[NpyStream], most: int) -> Iterator[Array]:
    """Yield blocks of rows of arrays that each hold some of the columns."""
    while arrays[0].left:
        yield np.concatenate([array.rows(most) for array in arrays], axis=1)


def _read_npy(stream: BinaryIO, name: str, form: str) -> Table:
    """Return the rows of a structured or a two-dimensional array."""
    array = NpyStream(stream, name)
    names = array.names()
    width = len(names) if names else math.prod(array.shape[1:])
    return ArrayTable(name, form, names, width, partial(_side_by_side, [array]))


def _read_npz(stream: BinaryIO, name: str, form: str) -> Table:
    """Return the rows of all arrays that are as long as the array of times."""
    from zipfile import ZipFile

    archive = ZipFile(stream)
    members = {x.removesuffix(".npy"): x for x in archive.namelist()}
    if len(members) > MOST_ARRAYS:
        raise DataError(f"{name} must have at most {MOST_ARRAYS} arrays, got {len(members)}")
    arrays = {
        key: NpyStream(cast(Any, archive.open(member)), f"{name}, array {key}")
        for key, member in members.items()
    }
    keys = list(arrays)
    if "t" not in (found := quantities_in(keys)):
        raise DataError(f"{name} must have an array for the time, t, got {', '.join(keys)[:100]}")
    count = arrays[keys[found["t"].columns[0]]].shape[0]
    fitting = {key: array for key, array in arrays.items() if array.shape[0] == count}
    names = [part for key, array in fitting.items() for part in array.names(key) or ()]
    return ArrayTable(name, form, names, len(names), partial(_side_by_side, [*fitting.values()]))


def _read_parquet(stream: BinaryIO, name: str, form: str) -> Table:
    """Return the rows of the numeric columns: numbers, or lists of a fixed size."""
    try:
        from pyarrow import parquet
    except ImportError:
        raise UnavailableError(
            f"{name}: Parquet needs pyarrow: pip install 'lagtop[parquet]'"
        ) from None
    file = parquet.ParquetFile(stream)
    numeric = [x for x in file.schema_arrow if _is_numeric(x.type)]
    fields = [x.name for x in numeric]
    if (twice := repeated(fields)) is not None:
        raise DataError(f"{name} must name each column once, got {quoted(twice)} twice")
    names = [part for x in numeric for part in parts(x.name, getattr(x.type, "list_size", 0))]

    def tables(most: int) -> Iterator[Array]:
        for batch in file.iter_batches(most, columns=fields):
            if batch.num_rows:
                yield np.concatenate([_column(x) for x in batch.columns], axis=1)

    table = ArrayTable(name, form, names, len(names), tables)
    metadata = file.schema_arrow.metadata or {}
    texts = (b": ".join(pair).decode(errors="replace") for pair in metadata.items())
    table.description = description_in(texts)
    return table


def _is_numeric(kind: Any) -> bool:
    from pyarrow import types

    kind = kind.value_type if types.is_fixed_size_list(kind) else kind
    return bool(types.is_floating(kind) or types.is_integer(kind))


def _column(array: Any) -> Array:
    """Return the numbers of a column, or of a column of lists; null becomes NaN."""
    size = getattr(array.type, "list_size", 1)
    flat = array.values.slice(array.offset * size, len(array) * size) if size > 1 else array
    numbers = flat.to_numpy(zero_copy_only=False).astype(np.float64).reshape(len(array), -1)
    if array.null_count:
        numbers[array.is_null().to_numpy(zero_copy_only=False)] = np.nan
    return numbers  # type: ignore[no-any-return]
