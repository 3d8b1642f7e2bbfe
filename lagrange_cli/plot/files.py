"""Conversion of a figure to a file that describes itself: fonts, texts and metadata.

Text remains text in SVG, and PDF embeds TrueType outlines (Type 42), as journals require.
"""

from __future__ import annotations

import io
import os
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import CannotWriteError, LagtopError, UnavailableError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

REPORT_KINDS = (".svg", ".png")
"""File types of the pictures of reports."""

_FONTS = {"svg.fonttype": "none", "pdf.fonttype": 42, "svg.hashsalt": "lagtop"}


class About(NamedTuple):
    """A description of a picture in words, for the metadata of its file."""

    title: str
    text: str
    """The scene in a sentence, for readers who cannot see the picture."""
    command: str = ""
    """The command line that draws the picture."""

    def fields(self, fmt: str) -> dict[str, str | None]:
        """Return the metadata for a file type, without date and version."""
        texts = self.title, self.text, self.command
        if fmt == "svg":
            whole = f"{self.text}\n{self.command}".strip()
            return {"Title": self.title, "Description": whole, "Creator": "lagtop", "Date": None}
        if fmt == "pdf":
            named = dict(zip(("Title", "Subject", "Keywords"), texts, strict=True))
            return {**named, "Creator": "lagtop", "Producer": None, "CreationDate": None}
        named = dict(zip(("Title", "Description", "Comment"), texts, strict=True))
        return {**named, "Software": "lagtop"}


def figure_bytes(figure: Figure, fmt: str, dpi: float, about: About) -> bytes:
    """Return the figure as `png`, `svg` or `pdf`; the same figure gives the same bytes.

    The canvas of each format prints it, because `savefig` would draw it twice.
    """
    import matplotlib
    from matplotlib.backend_bases import get_registered_canvas_class

    buffer = io.BytesIO()
    os.environ.setdefault("SOURCE_DATE_EPOCH", "0")  # or the fonts in a PDF would carry the day
    figure.dpi = dpi
    how: dict[str, Any] = {"pil_kwargs": {"compress_level": 3}} if fmt == "png" else {}
    with matplotlib.rc_context(_FONTS):  # type: ignore[arg-type]  # the stub lists every key
        canvas = get_registered_canvas_class(fmt)(figure)
        getattr(canvas, f"print_{fmt}")(buffer, metadata=about.fields(fmt), **how)
    if fmt != "svg":
        return buffer.getvalue()
    end = b"</title>"  # a description for screen readers follows
    described = end + f"\n <desc>{escape(about.text)}</desc>".encode()
    return buffer.getvalue().replace(end, described, 1)


def report_bytes(figure: Figure, path: str, about: About) -> bytes:
    """Return the figure of a report in the format given by its file name."""
    return figure_bytes(figure, Path(path).suffix.lower()[1:], 150, about)


def check_plot(path: str | None, output: str) -> None:
    """Raise LagtopError for an unsupported file type, or for the file of the report itself.

    Raises UnavailableError if matplotlib is missing, and CannotWriteError if the directory does not
    exist.
    """
    if path is None:
        return
    if Path(path).suffix.lower() not in REPORT_KINDS:
        raise LagtopError(f"plot must end in {' or '.join(REPORT_KINDS)}, got {path!r}", "plot")
    if Path(path).resolve() == Path(output).resolve():
        raise LagtopError(f"plot must not be the file of the report, got {path!r}", "plot")
    require_matplotlib()
    if not Path(path).resolve().parent.is_dir():
        raise CannotWriteError(f"cannot write {path}: no such directory")


def require_matplotlib() -> None:
    """Raise UnavailableError, with the remedy, if matplotlib is missing."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise UnavailableError("pictures need matplotlib: pip install 'lagtop[plot]'") from None
