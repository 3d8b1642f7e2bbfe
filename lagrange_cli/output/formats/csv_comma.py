"""CSV with decimal commas and semicolons between cells, as some spreadsheets read it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...arithmetic.text import NumberText
from .csv import Csv

if TYPE_CHECKING:
    from ...arithmetic.types import Array

_MARKS = bytes.maketrans(b",.", b";,")


class CsvWithCommas(Csv):
    """A line per row; a text with a semicolon is quoted, and so are all texts with a comma."""

    separator = b";"

    def cell(self, value: Any) -> bytes:
        """Return the cell of a value."""
        text = super().cell(value)
        if isinstance(value, float | NumberText):
            return text.replace(b".", b",")
        return b'"%b"' % text if b";" in text and not text.startswith(b'"') else text

    def lines(self, numbers: Array, missing: bytes = b"") -> bytes:
        """Return an array of numbers, a line per row and a `missing` cell for NaN."""
        return super().lines(numbers, missing).translate(_MARKS)


FORMAT = CsvWithCommas()
