"""Display in notebooks: results as documents in Markdown, and a web page in a frame."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from typing import Any

from ..names import Key
from .document import WIDE, Grid, record_page, shown_text
from .formats.markdown import FORMAT


class WebPage(str):
    """A page of HTML as text, which a notebook shows in a frame."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        style = "width: 100%; height: 720px; border: 0"
        return f'<iframe style="{style}" srcdoc="{escape(self)}"></iframe>'

    def save(self, path: str | Path) -> None:
        """Write the page to a file.  Raises OSError."""
        Path(path).write_text(self, encoding="utf-8")


class HasRecord:
    """Results with a verdict and a record: a dict for programs, a table for notebooks."""

    verdict: Any
    record: Callable[[], dict[str, Any]]

    def _repr_markdown_(self) -> str:
        """Return the verdict and a table of the keys that have a value."""
        rows = [[key, shown_text(x)] for key, x in self.record().items() if x is not None]
        return FORMAT.page([f"Verdict: {self.verdict}", Grid(["Key", "Value"], rows, [1])], None)


def record_markdown(record: Mapping[str, Any], keys: Mapping[str, Key]) -> str:
    """Return a record as Markdown, with the name of each key."""
    return FORMAT.page(record_page(record, lambda: keys, WIDE), None)
