"""The formats of output, one object each: csv, json, ndjson, parquet, npy and table.

A double has the same text in all of them (see `arithmetic.text`).  Rows are written by orjson,
which is loaded together with numpy.  One record (`solve --format json`) and numbers of many digits
are put together here: importing orjson would cost that command 4 % of its time, and it knows
doubles only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from io import BytesIO
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO, cast

from ..arithmetic.text import csv_text, value_text
from .terminal import View

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from .layouts import Layout
    from .report import Report
    from .row_texts import Columns

Texts = Sequence[Sequence[str]]
"""A block of rows whose numbers are written out; an empty text stands for none."""


class Header(list[str]):
    """The names of columns, with a description of their numbers."""

    def __init__(self, names: Iterable[str], description: Mapping[str, str]) -> None:
        super().__init__(names)
        self.description = description


def description_of(names: Sequence[str]) -> Mapping[str, str]:
    """Return the description that goes with names of columns, if any."""
    return names.description if isinstance(names, Header) else {}


class Format:
    """A format: the bytes before, between and after blocks of rows, and of a block itself."""

    name: str
    between = b""
    closing = b""

    def opening(self, names: Sequence[str]) -> bytes:
        """Return what stands before the rows."""
        return b""

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return rows of numbers and JSON values, given by their columns."""
        raise NotImplementedError

    def texts(self, rows: Texts, names: Sequence[str]) -> bytes:
        """Return rows of numbers that are written out already."""
        raise NotImplementedError

    def record(self, record: Mapping[str, Any], layout: Callable[[], Layout], view: View) -> bytes:
        """Return one record; `layout` gives its groups to the format that needs them."""
        raise NotImplementedError

    def findings(self, findings: Report, view: View) -> bytes:
        """Return what a report found."""
        raise NotImplementedError

    def write_blocks(self, stream: BinaryIO, names: Sequence[str], blocks: Iterable[bytes]) -> None:
        """Write blocks made by `block`, with what stands before, between and after them."""
        texts = filter(None, blocks)
        first = next(texts, b"")  # before anything is written: what is wrong often shows here
        stream.write(self.opening(names) + first)
        for text in texts:
            stream.write(self.between + text)
        stream.write(self.closing)

    def part(self, names: Sequence[str], number: int, text: bytes) -> bytes:
        """Return the file of a part of a sweep: part 0 alone begins with the header."""
        return text if number else self.opening(names) + text

    def write_table(
        self,
        stream: BinaryIO,
        names: Sequence[str],
        blocks: Iterable[Array | Texts],
        view: View,
        count: int,
    ) -> None:
        """Write `count` rows in blocks, arrays or numbers written out; 0 if nobody knows."""
        self.write_blocks(
            stream,
            names,
            (
                self.texts(block, names) if isinstance(block, list) else self._array(block, names)
                for block in blocks
            ),
        )

    def _array(self, block: Any, names: Sequence[str]) -> bytes:
        return self.block([block], names)


class Csv(Format):
    """Comma-separated values with a header; nothing stands for none."""

    name = "csv"

    def opening(self, names: Sequence[str]) -> bytes:
        """Return the header, below comments that describe it."""
        comments = "".join(f"# {key}: {text}\n" for key, text in description_of(names).items())
        return f"{comments}{','.join(map(csv_text, names))}\n".encode()

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return a line per row."""
        from .row_texts import csv_lines

        return csv_lines(columns, names)

    def texts(self, rows: Texts, names: Sequence[str]) -> bytes:
        """Return a line per row."""
        return "".join(",".join(row) + "\n" for row in rows).encode()

    def record(self, record: Mapping[str, Any], layout: Callable[[], Layout], view: View) -> bytes:
        """Return a header and one line."""
        cells = ",".join(map(value_text, record.values()))
        return f"{','.join(record)}\n{cells}\n".encode()

    def findings(self, findings: Report, view: View) -> bytes:
        """Return the rows alone, with a header."""
        header = [field.key for field in findings.fields]
        lines = [header, *(row.values() for row in findings.values())]
        return "".join(",".join(map(csv_text, line)) + "\n" for line in lines).encode()


class Ndjson(Format):
    """JSON lines: an object per row; null stands for none."""

    name = "ndjson"

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return a line per row."""
        from .row_texts import json_objects

        return json_objects(columns, names, b"\n", b"\n")


class Json(Format):
    """JSON: an array with an object per row, each on a line; or one object."""

    name = "json"
    between = b",\n"
    closing = b"]\n"

    def opening(self, names: Sequence[str]) -> bytes:
        """Return the bracket of the array."""
        return b"["

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return the objects, with commas between."""
        from .row_texts import json_objects

        return json_objects(columns, names, b",\n")

    def texts(self, rows: Texts, names: Sequence[str]) -> bytes:
        """Return the objects, with commas between."""
        objects = (
            _object(zip(names, (cell or "null" for cell in row), strict=True)) for row in rows
        )
        return ",\n".join(objects).encode()

    def record(self, record: Mapping[str, Any], layout: Callable[[], Layout], view: View) -> bytes:
        """Return one object on one line."""
        return f"{_json_value(record)}\n".encode()

    def findings(self, findings: Report, view: View) -> bytes:
        """Return one object."""
        return findings.as_json()


class Parquet(Format):
    """Parquet, a row group per block; a block on its way is an Arrow stream."""

    name = "parquet"

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return an Arrow stream."""
        from .parquet import arrow_block

        return arrow_block(columns, names) if len(columns[0]) else b""

    def write_blocks(self, stream: BinaryIO, names: Sequence[str], blocks: Iterable[bytes]) -> None:
        """Write one file of all blocks."""
        from .parquet import write_parquet

        write_parquet(stream, names, filter(None, blocks), description_of(names))

    def part(self, names: Sequence[str], number: int, text: bytes) -> bytes:
        """Return the file of a part of a sweep, which is whole."""
        stream = BytesIO()
        self.write_blocks(stream, names, [text])
        return stream.getvalue()


class Npy(Format):
    """One structured array of NumPy: a field of doubles per column."""

    name = "npy"

    def write_table(
        self,
        stream: BinaryIO,
        names: Sequence[str],
        blocks: Iterable[Array | Texts],
        view: View,
        count: int,
    ) -> None:
        """Write a header that tells the number of rows, and the rows as they come."""
        import numpy as np

        row = np.dtype([(name, "<f8") for name in names])
        header = {"descr": row.descr, "fortran_order": False, "shape": (count,)}
        np.lib.format.write_array_header_1_0(stream, header)
        for block in blocks:
            stream.write(np.ascontiguousarray(block, dtype="<f8").tobytes())


class DrawnTable(Format):
    """A table for the eye, drawn by rich when all of it is known."""

    name = "table"

    def record(self, record: Mapping[str, Any], layout: Callable[[], Layout], view: View) -> bytes:
        """Return a line per key, in groups."""
        from .rich_tables import record_table

        return record_table(record, layout(), view)

    def findings(self, findings: Report, view: View) -> bytes:
        """Return conditions, rows and conclusions."""
        from .rich_tables import findings_table

        return findings_table(findings, view)

    def write_table(
        self,
        stream: BinaryIO,
        names: Sequence[str],
        blocks: Iterable[Array | Texts],
        view: View,
        count: int,
    ) -> None:
        """Write a column per name and a line per row."""
        from .rich_tables import rows_table

        rows = chain.from_iterable(
            block if isinstance(block, list) else cast("Array", block).tolist() for block in blocks
        )
        stream.write(rows_table(names, (map(value_text, row) for row in rows), view))


FORMAT_BY_NAME: dict[str, Format] = {
    fmt.name: fmt for fmt in (Csv(), Ndjson(), Json(), Parquet(), Npy(), DrawnTable())
}
"""The formats by name."""


def _object(members: Iterable[tuple[str, str]]) -> str:
    """Return a JSON object of values that are written out, as orjson would write it."""
    inside = ",".join([f'"{name}":{text}' for name, text in members])
    return f"{{{inside}}}"


def _json_value(value: Any) -> str:
    if isinstance(value, Mapping):
        return _object((key, _json_value(x)) for key, x in value.items())
    if type(value) is str:  # our only strings are plain words
        return f'"{value}"'
    return value_text(value) or "null"
