"""Binary tables, as columns of numbers: Parquet, and MATLAB's .mat."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np

from ..arithmetic.text import shortened
from ..arithmetic.types import Array
from ..errors import DataError, UnavailableError
from ..file_bytes import LARGEST_FILE
from .text_tables import NumericColumns

_BYTES_OF_A_NUMBER = 24
"""Bytes that a number may take in memory and on the way there."""


@dataclass
class BinaryTable:
    """The columns of numbers in a binary file; masked elements are empty cells."""

    name: str
    headings: Sequence[str] | None
    columns: Sequence[Array]
    place: str = "row"

    @property
    def width(self) -> int:
        """The number of columns."""
        return len(self.columns)

    def numbers(self, columns: Sequence[int], names: Sequence[str]) -> NumericColumns:
        """Return columns of numbers, without the rows that have none in these columns."""
        found = [np.ma.asarray(self.columns[i]) for i in columns]
        values = np.stack([np.ma.filled(x.astype(float), np.nan) for x in found], axis=1)
        empty = np.stack([np.ma.getmaskarray(x) for x in found], axis=1)
        kept = ~empty.all(axis=1)
        return NumericColumns(values[kept], empty[kept], 1 + np.flatnonzero(kept))

    def column(self, index: int) -> Iterator[tuple[int, Any]]:
        """Yield the numbers of the rows and the cells of one column, None for an empty one."""
        return enumerate(np.ma.asarray(self.columns[index]).tolist(), 1)

    def plain(self, cell: Any) -> str:
        """Return a number as text."""
        return "" if cell is None else repr(cell)


def binary_table(content: bytes, name: str) -> BinaryTable | None:
    """Return the table in a binary file, None for another format.  Raises DataError."""
    formats = {b"PAR1": _parquet, b"MATLAB 5": _matlab, b"MATLAB 7": _matlab}
    read = next((y for x, y in formats.items() if content.startswith(x)), None)
    if read is None:
        return None
    try:
        return read(content, name)
    except (DataError, UnavailableError):
        raise
    except Exception as error:  # no library lists its exceptions
        why = shortened(" ".join(str(error).split()), 100) or type(error).__name__
        kind = "Parquet" if read is _parquet else "MATLAB"
        raise DataError(f"{name}: bad {kind} file: {why}") from None


def _parquet(content: bytes, name: str) -> BinaryTable:
    try:
        from pyarrow import BufferReader, parquet, types
    except ImportError:
        raise UnavailableError(f"{name}: Parquet needs pyarrow: pip install pyarrow") from None
    file = parquet.ParquetFile(BufferReader(content))
    is_number = types.is_floating, types.is_integer, types.is_timestamp
    names = [x.name for x in file.schema_arrow if any(y(x.type) for y in is_number)]
    size = file.metadata.num_rows * len(names)
    if size > (most := LARGEST_FILE // _BYTES_OF_A_NUMBER):
        raise ValueError(f"it must have at most {most} numbers, has {size}")
    read = file.read(columns=names, use_threads=False)  # threads may abort at the exit
    units = {x.name: f" [{x.type.unit}]" for x in file.schema_arrow if types.is_timestamp(x.type)}
    headings = [f"{x}{units.get(x, '')}" for x in names]
    return BinaryTable(name, headings, [_of_arrow(x) for x in read.columns])


def _of_arrow(column: Any) -> Array:
    """Return a column of Arrow, with its integers as they are, masked where it is null.

    Times are integers in their own unit.
    """
    null = column.is_null().to_numpy()
    numbers = column.cast("int64") if str(column.type).startswith("timestamp") else column
    values = numbers.fill_null(0).to_numpy()
    return np.ma.array(values, mask=null) if null.any() else values


def _matlab(content: bytes, name: str) -> BinaryTable:
    """Return the matrices and vectors of a MATLAB file, or of its only struct, side by side."""
    from scipy.io import loadmat

    if b"MATLAB 7.3" in content[:128]:
        raise DataError(f"{name}: MATLAB 7.3 files are not read: save it with -v7")
    found: Mapping[str, Any] = loadmat(BytesIO(content), simplify_cells=True)
    found = {x: y for x, y in found.items() if not x.startswith("__")}
    if len(found) == 1 and isinstance(only := next(iter(found.values())), dict):
        found = only
    arrays = {x: np.atleast_1d(y) for x, y in found.items() if np.asarray(y).dtype.kind in "iuf"}
    rows = max((len(x) for x in arrays.values()), default=0)
    blocks = {x: y.reshape(rows, -1) for x, y in arrays.items() if len(y) == rows}
    columns = [column for y in blocks.values() for column in y.T]
    if len(blocks) == 1 and len(columns) > 1:  # a matrix without names
        return BinaryTable(name, None, columns)
    headings = [
        x if y.shape[1] == 1 else f"{x}_{i}" for x, y in blocks.items() for i in range(y.shape[1])
    ]
    return BinaryTable(name, headings, columns)
