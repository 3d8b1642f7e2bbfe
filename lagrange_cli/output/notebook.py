"""Display in notebooks: tables, the record of a motion, and documents in a frame."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from ..names import Key


class Document(str):
    """An HTML document as text, which a notebook shows in a frame."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        style = "width: 100%; height: 720px; border: 0"
        return f'<iframe style="{style}" srcdoc="{escape(self)}"></iframe>'

    def save(self, path: str | Path) -> None:
        """Write the document to a file.  Raises OSError."""
        Path(path).write_text(self, encoding="utf-8")


class HasRecord:
    """Results with a verdict and a record: a dict for programs, a table for notebooks."""

    verdict: Any
    record: Callable[[], dict[str, Any]]

    def _repr_html_(self) -> str:
        """Return the results as a table for a notebook, without keys that have none."""
        record = self.record()
        return html_table(self.verdict, (x for x in record.items() if x[1] is not None))


def record_html(caption: str, record: Mapping[str, Any], keys: Mapping[str, Key]) -> str:
    """Return a record as an HTML table: key, symbol, meaning, value and unit."""
    rows = (
        (name, keys[name].symbol, keys[name].meaning, value, keys[name].unit)
        for name, value in record.items()
        if value is not None
    )
    return html_table(caption, rows)


def html_table(caption: str, rows: Iterable[Sequence[Any]]) -> str:
    """Return rows as an HTML table."""
    texts = ([escape(str(x)) for x in row] for row in rows)
    lines = "".join(f"<tr><td>{'</td><td>'.join(row)}</td></tr>" for row in texts)
    return f"<table><caption>{escape(caption)}</caption>{lines}</table>"
