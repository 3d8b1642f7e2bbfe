"""A window of the browser for a page."""

from __future__ import annotations

import tempfile
import webbrowser
from pathlib import Path

from ...errors import LagtopError
from ...motion.notebook import Document


def open_page(page: Document, path: str | None = None) -> None:
    """Open a page that was written to a file, else one of a new file, in the user's browser.

    Raises LagtopError where there is no browser.
    """
    if path is None:
        path = str(Path(tempfile.mkdtemp(prefix="lagtop-")) / "top.html")
        page.save(path)
    if not webbrowser.open(Path(path).resolve().as_uri()):
        raise LagtopError(f"open found no browser; the page is {path}", "open")
