"""Display in notebooks: the record of a motion as a table, and documents in a frame."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from .record import KEYS


class Document(str):
    """An HTML document as text, which a notebook shows in a frame."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        """Return the document in a frame of its own."""
        style = "width: 100%; height: 720px; border: 0"
        return f'<iframe style="{style}" srcdoc="{escape(self)}"></iframe>'

    def save(self, path: str | Path) -> None:
        """Write the document to a file.  Raises OSError."""
        Path(path).write_text(self, encoding="utf-8")


class HasRecord:
    """Results with a verdict and a record: a dict for programs, a table for notebooks."""

    verdict: Any

    def record(self) -> dict[str, Any]:
        """Return the results by key."""
        raise NotImplementedError

    def to_dict(self) -> dict[str, Any]:
        """Return the results by key, as `record` does."""
        return self.record()

    def _repr_html_(self) -> str:
        """Return the results as a table for a notebook, without keys that have none."""
        left = 'style="text-align: left"'
        rows = "".join(
            f"<tr><td {left}>{escape(name)}</td><td>{escape(str(value))}</td></tr>"
            for name, value in self.record().items()
            if value is not None
        )
        return f"<table><caption>{escape(str(self.verdict))}</caption>{rows}</table>"


def record_html(record: Mapping[str, Any]) -> str:
    """Return the record of a motion as an HTML table: symbol, meaning, value and unit."""
    rows = "".join(
        f'<tr title="{name}"><td>{KEYS[name].symbol}</td><td style="text-align: left">'
        f"{escape(KEYS[name].meaning or name)}</td><td>{escape(str(value))}</td>"
        f'<td style="text-align: left">{escape(KEYS[name].unit)}</td></tr>'
        for name, value in record.items()
        if value is not None
    )
    return f"<table><caption>{escape(record['regime'])}</caption>{rows}</table>"
