"""CSV: the rows, with a header; also with decimal commas, as some spreadsheets read it."""

from __future__ import annotations

from collections.abc import Sequence
from types import NoneType
from typing import TYPE_CHECKING, Any

from ...arithmetic.text import NumberText
from ..text import csv_text
from .base import Columns, Format

if TYPE_CHECKING:
    from ...arithmetic.types import Array


class Csv(Format):
    """A line per row; a missing value is an empty cell."""

    only_rows = True
    separator = b","

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return lines."""
        if len(columns) == 1 and not isinstance(columns[0], Sequence):
            return self.lines(columns[0], b"" if len(names) > 1 else b'""')  # no line is empty
        lines = zip(*map(self._cells, columns), strict=True)
        return b"".join((self.separator.join(line) or b'""') + b"\n" for line in lines)

    def header(self, names: Sequence[str]) -> bytes:
        """Return a line of names."""
        return self.separator.join(map(self.cell, names)) + b"\n"

    def cell(self, value: Any) -> bytes:
        """Return the cell of a value."""
        return csv_text(value).encode()

    def lines(self, numbers: Array, missing: bytes = b"") -> bytes:
        """Return an array of numbers, a line per row and a `missing` cell for NaN."""
        import numpy as np
        import orjson

        rows = numbers.reshape((*numbers.shape, 1)[:2])
        if not rows.size:
            return b""
        text = bytearray(orjson.dumps(rows.ravel(), option=orjson.OPT_SERIALIZE_NUMPY))
        if b"n" in text:
            text = text.replace(b"null", missing)
        # Commas at the ends of rows are replaced in place: a search for `],[` takes twice as long.
        view = np.frombuffer(text, dtype=np.uint8)
        commas = np.flatnonzero(view == ord(","))
        view[commas[rows.shape[1] - 1 :: rows.shape[1]]] = ord("\n")
        view[-1] = ord("\n")
        return bytes(view[1:])

    def _cells(self, column: Any) -> Sequence[bytes]:
        """Return the cells of columns, a text per row."""
        if not isinstance(column, Sequence):
            return self.lines(column).split(b"\n")[:-1]
        if not {*map(type, column)} <= {str, NoneType}:
            return [*map(self.cell, column)]
        cells = {x: self.cell(x) for x in {*column}}  # a sweep repeats few texts
        return [cells[x] for x in column]


class CsvWithCommas(Csv):
    """Decimal commas, and semicolons between cells; a text with a semicolon or comma is quoted."""

    separator = b";"

    def cell(self, value: Any) -> bytes:
        """Return the cell of a value."""
        text = super().cell(value)
        if isinstance(value, float | NumberText):
            return text.replace(b".", b",")
        return b'"%b"' % text if b";" in text and not text.startswith(b'"') else text

    def lines(self, numbers: Array, missing: bytes = b"") -> bytes:
        """Return an array of numbers, a line per row and a `missing` cell for NaN."""
        return super().lines(numbers, missing).translate(bytes.maketrans(b",.", b";,"))


FORMAT = Csv()
WITH_COMMAS = CsvWithCommas()
