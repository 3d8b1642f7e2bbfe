"""Trajectories as arrays: npy, npz and Parquet.

Rows are read as they are needed, so that memory does not grow with their number; but
for arrays in Fortran order, which are read whole.  npz and Parquet begin at their end: those that
come from a pipe are read whole too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from io import BytesIO
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from ..errors import DataError, UnavailableError
from .trajectory_columns import quantities_in
from .trajectory_rows import Block
from .trajectory_text import parts
from .words import PlainNumbers, Words

if TYPE_CHECKING:
    from ..arithmetic.types import Array


ROWS_AT_ONCE = 1 << 15


class NpyStream:
    """An array of an npy file whose rows are read one after the other."""

    def __init__(self, stream: BinaryIO, name: str) -> None:
        """Read the header.  Raises DataError for what is no table of real numbers."""
        self.stream, self.name = stream, name
        try:
            version = np.lib.format.read_magic(stream)
            header = {
                (1, 0): np.lib.format.read_array_header_1_0,
                (2, 0): np.lib.format.read_array_header_2_0,
            }[version]
            self.shape, fortran, self.dtype = header(stream)
        except (ValueError, KeyError) as error:
            raise DataError(f"{name}: not an npy file: {str(error)[:100]}") from None
        fields = self.dtype.fields
        bases = [self.dtype] if fields is None else [x[0].base for x in fields.values()]
        if len(self.shape) not in {1, 2} or any(base.kind not in "iuf" for base in bases):
            raise DataError(
                f"{name} must be an array of real numbers with 1 or 2 dimensions, "
                f"got {self.dtype} of shape {self.shape}"
            )
        self.left = self.shape[0]
        self._whole = self._read(math.prod(self.shape)) if fortran and self.shape[1:] else None

    def rows(self, count: int) -> Array:
        """Return the next rows, at most so many, as columns of float64."""
        count, start = min(count, self.left), self.shape[0] - self.left
        self.left -= count
        if self._whole is not None:
            table = self._whole.reshape(self.shape, order="F")[start : start + count]
        else:
            flat = self._read(count * math.prod(self.shape[1:]))
            table = flat.reshape(count, *self.shape[1:])
        if self.dtype.fields is None:
            plain: Array = table.reshape(count, -1).astype(np.float64)
            return plain
        columns = [table[field].reshape(count, -1) for field in cast(Any, self.dtype.names)]
        whole: Array = np.concatenate([x.astype(np.float64) for x in columns], axis=1)
        return whole

    def _read(self, count: int) -> Any:
        raw = self.stream.read(count * self.dtype.itemsize)
        if len(raw) < count * self.dtype.itemsize:
            raise DataError(f"{self.name} must hold {self.shape[0]} rows, but ends before")
        return np.frombuffer(raw, self.dtype)

    def names(self) -> list[str] | None:
        """Return the names of the columns of a structured array; others have none."""
        if self.dtype.fields is None:
            return None
        sizes = ((name, x[0].shape) for name, x in self.dtype.fields.items())
        return [
            part for name, shape in sizes for part in parts(name, math.prod(shape) if shape else 0)
        ]


class _Numbers:
    """A table that holds nothing but numbers."""

    def words_of(self, column: int) -> Words:
        """Return the texts of its numbers."""
        return PlainNumbers()


class ArrayTable(_Numbers):
    """Arrays side by side, each with some of the columns."""

    place = "row"

    def __init__(
        self, arrays: Sequence[NpyStream], names: Sequence[str] | None, width: int
    ) -> None:
        self.arrays, self.names, self.width = arrays, names, width

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns of the rows."""
        first = 1
        while self.arrays[0].left:
            block = np.concatenate([array.rows(ROWS_AT_ONCE) for array in self.arrays], axis=1)
            yield Block(block[:, columns], range(first, first + len(block)))
            first += len(block)


def read_npy(stream: BinaryIO, name: str) -> ArrayTable:
    """Return the rows of an npy file: a structured array, or one of two dimensions."""
    array = NpyStream(stream, name)
    names = array.names()
    width = len(names) if names else math.prod(array.shape[1:])
    return ArrayTable([array], names, width)


def read_npz(stream: BinaryIO, name: str) -> ArrayTable:
    """Return the rows of an npz file, of all its arrays that are as long as that of the time."""
    from zipfile import BadZipFile, ZipFile

    try:
        archive = ZipFile(_seekable(stream))
        members = {x.removesuffix(".npy"): x for x in archive.namelist()}
        arrays = {
            key: NpyStream(cast(Any, archive.open(member)), f"{name}, array {key}")
            for key, member in members.items()
        }
    except BadZipFile as error:
        raise DataError(f"{name}: not an npz file: {error}") from None
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
    return ArrayTable(list(fitting.values()), names, len(names))


class ParquetTable(_Numbers):
    """Rows of a Parquet file: columns of numbers, or of lists of a fixed size."""

    place = "row"

    def __init__(self, stream: BinaryIO, name: str) -> None:
        try:
            import pyarrow as pa
            from pyarrow import parquet
        except ImportError:
            raise UnavailableError(
                f"{name}: Parquet needs pyarrow: pip install 'lagtop[parquet]'"
            ) from None
        try:
            self.file = parquet.ParquetFile(_seekable(stream))
        except (pa.ArrowException, OSError) as error:
            raise DataError(f"{name}: not a Parquet file: {str(error)[:100]}") from None
        schema = self.file.schema_arrow
        self.fields = [x.name for x in schema if _is_numeric(x.type)]
        sizes = [getattr(schema.field(x).type, "list_size", 0) for x in self.fields]
        self.names: Sequence[str] | None = [
            part for x, size in zip(self.fields, sizes, strict=True) for part in parts(x, size)
        ]
        self.width = len(self.names)

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns of the rows; null is NaN."""
        first = 1
        for batch in self.file.iter_batches(ROWS_AT_ONCE, columns=self.fields):
            if rows := batch.num_rows:
                block = np.concatenate([_column(x, rows) for x in batch.columns], axis=1)
                yield Block(block[:, columns], range(first, first + rows))
                first += rows


def _is_numeric(kind: Any) -> bool:
    from pyarrow import types

    if types.is_fixed_size_list(kind):
        return _is_numeric(kind.value_type)
    return bool(types.is_floating(kind) or types.is_integer(kind))


def _column(array: Any, rows: int) -> Array:
    flat = (
        array.flatten() if hasattr(array, "flatten") and hasattr(array.type, "list_size") else array
    )
    numbers: Array = flat.to_numpy(zero_copy_only=False).astype(np.float64)
    return numbers.reshape(rows, -1)


def _seekable(stream: BinaryIO) -> BinaryIO:
    """Return the stream, or its content where it only goes forward."""
    return stream if stream.seekable() else BytesIO(stream.read())
