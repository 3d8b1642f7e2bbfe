"""Parquet: blocks of columns as Arrow streams, which any process can make, and a file of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from typing import Any, BinaryIO

import numpy as np

from ..arithmetic.text import json_text
from ..errors import UnavailableError


def check_parquet() -> None:
    """Raise UnavailableError where pyarrow is not installed."""
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

    writer = None
    for block in blocks:
        table = pa.ipc.open_stream(block).read_all().replace_schema_metadata(description)
        writer = writer or parquet.ParquetWriter(stream, table.schema)
        writer.write_table(table)
    writer = writer or parquet.ParquetWriter(
        stream, pa.schema([(x, pa.null()) for x in names], description)
    )
    writer.close()


def _text(value: Any) -> str:
    return value if type(value) is str else json_text(value)
