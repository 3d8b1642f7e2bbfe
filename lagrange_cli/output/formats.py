"""The formats of rows, one object each: csv, json, ndjson, parquet, npy, table and markdown.

A double has the same text in all formats (see `arithmetic.text`).  Any process may format a block
of rows as bytes (`block_text`); one process writes all blocks (`Output.blocks`).
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from io import BytesIO
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO, cast

from ..arithmetic.text import csv_text, value_text
from .terminal import View

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from .rows import Columns

Texts = Sequence[Sequence[str]]
"""A block of rows with numbers as text; an empty text is a missing number."""


class Header(list[str]):
    """The names of columns, with a description of their numbers."""

    def __init__(self, names: Iterable[str], description: Mapping[str, str]) -> None:
        super().__init__(names)
        self.description = description


def description_of(names: Sequence[str]) -> Mapping[str, str]:
    """Return the description that belongs to the names of columns, if any."""
    return names.description if isinstance(names, Header) else {}


class Format:
    """A format: the bytes before, between and after blocks of rows, and of a block itself."""

    between = b""
    closing = b""

    def opening(self, names: Sequence[str]) -> bytes:
        """Return the bytes before the rows."""
        return b""

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return rows of numbers and JSON values as bytes, from their columns."""
        raise NotImplementedError

    def texts(self, rows: Texts, names: Sequence[str]) -> bytes:
        """Return rows of numbers as bytes, from numbers as text."""
        raise NotImplementedError

    def write_blocks(
        self, stream: BinaryIO, names: Sequence[str], blocks: Iterable[bytes], view: View
    ) -> None:
        """Write blocks made by `block`, with the bytes before, between and after them."""
        texts = filter(None, blocks)
        first = next(texts, b"")  # before anything is written, because most errors occur here
        stream.write(self.opening(names) + first)
        for text in texts:
            stream.write(self.between + text)
        stream.write(self.closing)

    def part(self, names: Sequence[str], number: int, text: bytes) -> bytes:
        """Return the file of a part of a sweep; only part 0 begins with the header."""
        return text if number else self.opening(names) + text

    def write_table(
        self,
        stream: BinaryIO,
        names: Sequence[str],
        blocks: Iterable[Array | Texts],
        view: View,
        count: int,
    ) -> None:
        """Write `count` rows in blocks, arrays or numbers as text; the count is 0 if unknown."""
        made = (
            self.texts(block, names) if isinstance(block, list) else self._array(block, names)
            for block in blocks
        )
        self.write_blocks(stream, names, made, view)

    def _array(self, block: Any, names: Sequence[str]) -> bytes:
        return self.block([block], names)


class Csv(Format):
    """Comma-separated values with a header; an empty cell is a missing value."""

    def opening(self, names: Sequence[str]) -> bytes:
        """Return the header, below comments that describe it."""
        comments = "".join(f"# {key}: {text}\n" for key, text in description_of(names).items())
        return f"{comments}{','.join(map(csv_text, names))}\n".encode()

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return a line per row."""
        from .rows import csv_lines

        return csv_lines(columns, names)

    def texts(self, rows: Texts, names: Sequence[str]) -> bytes:
        """Return a line per row."""
        return "".join(",".join(row) + "\n" for row in rows).encode()


class Json(Format):
    """JSON: an array with an object per row, each on a line; null is a missing value."""

    between = b",\n"
    closing = b"]\n"

    def opening(self, names: Sequence[str]) -> bytes:
        """Return the opening bracket of the array."""
        return b"["

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return the objects, separated by commas."""
        from .rows import json_objects

        return json_objects(columns, names, b",\n")

    def texts(self, rows: Texts, names: Sequence[str]) -> bytes:
        """Return the objects, separated by commas."""
        return ",\n".join(_objects(rows, names)).encode()


class Ndjson(Format):
    """JSON lines: an object per row; null is a missing value."""

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return a line per row."""
        from .rows import json_objects

        return json_objects(columns, names, b"\n", b"\n")

    def texts(self, rows: Texts, names: Sequence[str]) -> bytes:
        """Return a line per row."""
        return "".join(f"{line}\n" for line in _objects(rows, names)).encode()


def _objects(rows: Texts, names: Sequence[str]) -> Iterator[str]:
    """Yield the JSON objects of rows of numbers as text, as orjson would write them."""
    for row in rows:
        pairs = zip(names, row, strict=True)
        yield f"{{{','.join([f'{_QUOTE}{name}{_QUOTE}:{x or _NULL}' for name, x in pairs])}}}"


_QUOTE, _NULL = '"', "null"


class Parquet(Format):
    """Parquet, a row group per block; between processes a block is an Arrow stream."""

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return an Arrow stream."""
        from .rows import arrow_block

        return arrow_block(columns, names) if len(columns[0]) else b""

    def texts(self, rows: Texts, names: Sequence[str]) -> bytes:
        """Return an Arrow stream of doubles."""
        return self._array(_doubles(rows), names)

    def write_blocks(
        self, stream: BinaryIO, names: Sequence[str], blocks: Iterable[bytes], view: View
    ) -> None:
        """Write one file of all blocks."""
        from .rows import write_parquet

        write_parquet(stream, names, filter(None, blocks), description_of(names))

    def part(self, names: Sequence[str], number: int, text: bytes) -> bytes:
        """Return the file of a part of a sweep, which is complete by itself."""
        stream = BytesIO()
        self.write_blocks(stream, names, [text], View())
        return stream.getvalue()


class Npy(Format):
    """One structured array of NumPy: a field of doubles per column."""

    def write_table(
        self,
        stream: BinaryIO,
        names: Sequence[str],
        blocks: Iterable[Array | Texts],
        view: View,
        count: int,
    ) -> None:
        """Write a header with the number of rows, and the rows as they arrive."""
        import numpy as np

        row = np.dtype([(name, "<f8") for name in names])
        header = {"descr": row.descr, "fortran_order": False, "shape": (count,)}
        np.lib.format.write_array_header_1_0(stream, header)
        for block in blocks:
            rows = _doubles(block) if isinstance(block, list) else block
            stream.write(np.ascontiguousarray(rows, dtype="<f8").tobytes())


def _doubles(rows: Texts) -> Array:
    """Return rows of numbers as text as an array, with NaN for an empty text."""
    import numpy as np

    return np.array([[float(x or "nan") for x in row] for row in rows])


class Drawn(Csv):
    """A table or markdown, drawn when all rows are known; between processes a block is CSV."""

    def __init__(self, fmt: str) -> None:
        self.fmt = fmt

    def write_blocks(
        self, stream: BinaryIO, names: Sequence[str], blocks: Iterable[bytes], view: View
    ) -> None:
        """Write a column per name and a line per row."""
        self._draw(stream, names, csv.reader(b"".join(blocks).decode().splitlines()), view)

    def write_table(
        self,
        stream: BinaryIO,
        names: Sequence[str],
        blocks: Iterable[Array | Texts],
        view: View,
        count: int,
    ) -> None:
        """Write a column per name and a line per row."""
        rows = chain.from_iterable(
            block if isinstance(block, list) else cast("Array", block).tolist() for block in blocks
        )
        self._draw(stream, names, (map(value_text, row) for row in rows), view)

    def _draw(
        self, stream: BinaryIO, names: Sequence[str], rows: Iterable[Iterable[str]], view: View
    ) -> None:
        from .report import rows_text

        stream.write(rows_text(names, [list(row) for row in rows], self.fmt, view))


FORMATS: dict[str, Format] = {
    "table": Drawn("table"),
    "markdown": Drawn("markdown"),
    "csv": Csv(),
    "json": Json(),
    "ndjson": Ndjson(),
    "parquet": Parquet(),
    "npy": Npy(),
}
"""The formats by name."""


def block_text(columns: Columns, names: Sequence[str], fmt: str) -> bytes:
    """Return a block of rows in a format, for `Output.blocks`."""
    return FORMATS[fmt].block(columns, names)


def part_file(fmt: str, names: Sequence[str], number: int, text: bytes) -> bytes:
    """Return the content of the file of a part, from the text that `block_text` made.

    The concatenation of the files is the output of `Output.blocks`.  A Parquet file is complete by
    itself.
    """
    return FORMATS[fmt].part(names, number, text)
