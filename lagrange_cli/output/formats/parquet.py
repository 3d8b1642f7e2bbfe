"""Parquet: rows of doubles and texts, by pyarrow."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib.util import find_spec
from io import BytesIO
from itertools import chain
from types import NoneType
from typing import Any, BinaryIO

from ...arithmetic.text import NumberText
from ...errors import LagtopError, UnavailableError, arg, install
from ..document import Document
from ..text import json_text
from .base import Columns, Format

_OTHERS = f"leave out {arg('digits')} and {arg('certify')}, or use another format"

_GROUP_ROWS = 100_000
"""The least number of rows of a row group: readers are slow with small ones."""


class Parquet(Format):
    """A table of pyarrow for each block."""

    only_rows = True
    blocks_in_part = 32

    def document(self, document: Document, width: int | None) -> bytes:
        """Return the rows, whose columns of numbers are doubles."""
        import numpy as np

        columns = document.columns()
        numbers = [{*map(type, column)} <= {float, int, NoneType} for column in columns]
        doubles = [np.array(x, float) if y else x for x, y in zip(columns, numbers, strict=True)]
        self.write(file := BytesIO(), document.names, [self.block(doubles, document.names)], width)
        return file.getvalue()

    def block(self, columns: Columns, names: Sequence[str]) -> Any:
        """Return a table: numbers with null for NaN, and texts."""
        import pyarrow as pa

        arrays = []
        for column in columns:
            if isinstance(column, Sequence):
                if any(isinstance(x, NumberText) for x in column):
                    raise LagtopError(f"format parquet holds doubles: {_OTHERS}", "format")
                texts = [x if x is None or type(x) is str else json_text(x) for x in column]
                arrays.append(pa.array(texts, pa.string()))
            else:
                numbers = column.reshape((*column.shape, 1)[:2]).T.copy()
                arrays += [pa.array(x, from_pandas=True) for x in numbers]
        return pa.table(arrays, names=list(names))

    def with_units(self, block: Any, units: Mapping[str, str]) -> Any:
        """Return a table whose fields have the metadata `unit`."""
        import pyarrow as pa

        fields = [
            x.with_metadata({"unit": units[x.name]}) if units.get(x.name) else x
            for x in block.schema
        ]
        return block.cast(pa.schema(fields))

    def write(
        self, stream: BinaryIO, names: Sequence[str], blocks: Iterable[Any], width: int | None
    ) -> None:
        """Write tables as one file, in row groups of at least 100,000 rows but the last."""
        if width is not None:
            raise LagtopError("format parquet is not for a terminal: use -o FILE.parquet", "format")
        if find_spec("pyarrow") is None:
            why = f"format parquet needs pyarrow: {install('parquet')}"
            raise UnavailableError(why, "format")
        import pyarrow as pa
        from pyarrow import parquet

        tables = iter(blocks)
        first = next(tables, pa.table({name: pa.nulls(0) for name in names}))
        # closed in any case, because a writer that is collected later writes to a closed file
        with parquet.ParquetWriter(stream, first.schema) as writer:
            group: list[Any] = []
            for table in chain([first], tables):
                group.append(table)
                if sum(x.num_rows for x in group) >= _GROUP_ROWS:
                    writer.write_table(pa.concat_tables(group))
                    group = []
            if group:
                writer.write_table(pa.concat_tables(group))

    def part(self, names: Sequence[str], number: int, block: Any) -> bytes:
        """Return a file that is complete by itself."""
        self.write(file := BytesIO(), names, [block], None)
        return file.getvalue()


FORMAT = Parquet()
