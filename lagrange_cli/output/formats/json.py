"""JSON: one object or one list, in which infinite numbers are null."""

from __future__ import annotations

from collections.abc import Sequence

from ..document import Document
from ..text import json_value
from .base import Columns, Format
from .ndjson import json_rows


class Json(Format):
    """The whole document."""

    between, after = b",\n", b"]\n"

    def document(self, document: Document, width: int | None) -> bytes:
        """Return an object, or a list of rows."""
        if document.whole is not None:
            return f"{json_value(document.whole)}\n".encode()
        return "[{}]\n".format(",\n".join(map(json_value, document.rows))).encode()

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return objects and commas."""
        return b",\n".join(json_rows(columns, names))

    def header(self, names: Sequence[str]) -> bytes:
        """Return the beginning of a list."""
        return b"["


FORMAT = Json()
