"""JSON lines: an object per row."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...arithmetic.text import NumberText
from ..document import Document, lists_of
from ..text import json_value
from .base import Columns, Format


class NdJson(Format):
    """An object per line."""

    only_rows = True

    def document(self, document: Document, width: int | None) -> bytes:
        """Return the rows."""
        return "".join(f"{json_value(row)}\n" for row in document.rows).encode()

    def block(self, columns: Columns, names: Sequence[str]) -> bytes:
        """Return lines."""
        return b"".join(row + b"\n" for row in json_rows(columns, names))


def json_rows(columns: Columns, names: Sequence[str]) -> list[bytes]:
    """Return a JSON object for each row."""
    import orjson

    def fragment(value: Any) -> Any:
        if isinstance(value, NumberText):  # it keeps its digits
            return orjson.Fragment(str(value) or "null")
        return str(value) if isinstance(value, str) else float(value)

    rows = (dict(zip(names, row, strict=True)) for row in zip(*lists_of(columns), strict=True))
    as_written = orjson.OPT_PASSTHROUGH_SUBCLASS
    return [orjson.dumps(row, default=fragment, option=as_written) for row in rows]


FORMAT = NdJson()
