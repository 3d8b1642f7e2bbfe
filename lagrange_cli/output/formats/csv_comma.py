"""CSV with decimal commas and semicolons between cells, as some spreadsheets read it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...arithmetic.text import NumberText
from ..text import csv_text
from .base import Columns
from .csv import Csv, array_lines

_MARKS = bytes.maketrans(b",.", b";,")


class CsvWithCommas(Csv):
    """A line per row; a text with a semicolon is quoted, and so are all texts with a comma."""

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return lines."""
        lines = zip(*map(_cells, columns), strict=True)
        return b"".join((b";".join(line) or b'""') + b"\n" for line in lines)

    def header(self, names: Sequence[str]) -> bytes:
        """Return a line of names."""
        return f"{';'.join(map(_text, names))}\n".encode()


def _cells(column: Any) -> Sequence[bytes]:
    """Return the cells of columns, a text per row."""
    if isinstance(column, Sequence):
        return [_text(x).encode() for x in column]
    return array_lines(column).translate(_MARKS).split(b"\n")[:-1]


def _text(value: Any) -> str:
    text = csv_text(value)
    if isinstance(value, float | NumberText):
        return text.replace(".", ",")
    return f'"{text}"' if ";" in text and not text.startswith('"') else text


FORMAT = CsvWithCommas()
