"""Trajectories as arrays: npy, npz and Parquet.

Rows are read as they are needed, so that memory does not grow with their number.  Sizes declared in
a file are checked before memory is allocated.  Any exception of a library for a broken file becomes
a DataError.  Streams must be seekable.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import UnsupportedOperation
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from ..arithmetic.text import quoted, shortened
from ..errors import DataError, LagtopError, UnavailableError
from .descriptions import Description, description_in
from .names import repeated
from .trajectory_columns import quantities_in
from .trajectory_text import Block, PlainNumbers, Words, parts

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


class _Numbers:
    """A table that holds only numbers."""

    place = "row"
    description: Description = MappingProxyType({})

    def __init__(self, name: str, form: str, names: Sequence[str] | None, width: int) -> None:
        self.name, self.form, self.names, self.width = name, form, names, width

    def words_of(self, column: int) -> Words:
        """Return the numbers of the column as texts."""
        return PlainNumbers()

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns of the rows; null becomes NaN."""
        tables, first = self._tables(min(ROWS_AT_ONCE, 1 + NUMBERS_AT_ONCE // (1 + self.width))), 1
        while True:
            with _sound(self.name, self.form):
                table = next(tables, None)
            if table is None:
                return
            yield Block(table[:, columns], range(first, first + len(table)))
            first += len(table)

    def _tables(self, most: int) -> Iterator[Array]:
        """Yield blocks of at most `most` rows with all columns."""
        raise NotImplementedError


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
        if self._whole is None:
            table = self._read(count).reshape(count, *self.shape[1:])
        else:
            table = self._whole[start : start + count]
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

    def names(self) -> list[str] | None:
        """Return the names of the columns of a structured array; None for other arrays."""
        if not self._fields:
            return None
        sizes = ((name, math.prod(x.shape) if x.shape else 0) for name, x in self._fields)
        return [part for name, size in sizes for part in parts(name, size)]


class ArrayTable(_Numbers):
    """Arrays side by side; each holds some of the columns."""

    arrays: Sequence[NpyStream]

    def _tables(self, most: int) -> Iterator[Array]:
        while self.arrays[0].left:
            yield np.concatenate([array.rows(most) for array in self.arrays], axis=1)


def read_npy(stream: BinaryIO, name: str) -> ArrayTable:
    """Return the rows of an npy file: a structured or a two-dimensional array."""
    form = "an npy"
    with _sound(name, form):
        array = NpyStream(stream, name)
    names = array.names()
    width = len(names) if names else math.prod(array.shape[1:])
    table = ArrayTable(name, form, names, width)
    table.arrays = [array]
    return table


def read_npz(stream: BinaryIO, name: str) -> ArrayTable:
    """Return the rows of an npz file, from all arrays that are as long as the array of times."""
    form = "an npz"
    with _sound(name, form):
        arrays = _arrays(stream, name)
    keys = list(arrays)
    if "t" not in (found := quantities_in(keys)):
        raise DataError(f"{name} must have an array for the time, t, got {', '.join(keys)[:100]}")
    count = arrays[keys[found["t"].columns[0]]].shape[0]
    fitting = {key: array for key, array in arrays.items() if array.shape[0] == count}
    names = [
        part
        for key, array in fitting.items()
        for part in (array.names() or parts(key, array.shape[1] if array.shape[1:] else 0))
    ]
    table = ArrayTable(name, form, names, len(names))
    table.arrays = list(fitting.values())
    return table


def _arrays(stream: BinaryIO, name: str) -> dict[str, NpyStream]:
    """Return the arrays of an npz file by key."""
    from zipfile import ZipFile

    archive = ZipFile(stream)
    members = {x.removesuffix(".npy"): x for x in archive.namelist()}
    if len(members) > MOST_ARRAYS:
        raise DataError(f"{name} must have at most {MOST_ARRAYS} arrays, got {len(members)}")
    return {
        key: NpyStream(cast(Any, archive.open(member)), f"{name}, array {key}")
        for key, member in members.items()
    }


class ParquetTable(_Numbers):
    """Rows of a Parquet file: columns of numbers, or of lists of a fixed size."""

    def __init__(self, stream: BinaryIO, name: str) -> None:
        try:
            from pyarrow import parquet
        except ImportError:
            raise UnavailableError(
                f"{name}: Parquet needs pyarrow: pip install 'lagtop[parquet]'"
            ) from None
        form = "a Parquet"
        with _sound(name, form):
            self.file = parquet.ParquetFile(stream)
            metadata = self.file.schema_arrow.metadata or {}
            fields = [x for x in self.file.schema_arrow if _is_numeric(x.type)]
        self.fields = [x.name for x in fields]
        if (twice := repeated(self.fields)) is not None:
            raise DataError(f"{name} must name each column once, got {quoted(twice)} twice")
        names = [part for x in fields for part in parts(x.name, getattr(x.type, "list_size", 0))]
        super().__init__(name, form, names, len(names))
        texts = (b": ".join(pair).decode(errors="replace") for pair in metadata.items())
        self.description = description_in(texts)

    def _tables(self, most: int) -> Iterator[Array]:
        for batch in self.file.iter_batches(most, columns=self.fields):
            if batch.num_rows:
                yield np.concatenate([_column(x) for x in batch.columns], axis=1)


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
