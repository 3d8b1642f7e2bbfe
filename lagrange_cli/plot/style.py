"""The look of pictures, light and dark, and the files that hold them: one style for all of them.

Tilt is blue, spin orange and precession green, in every picture and on the page.  The colours
follow Okabe and Ito; on white they are darker, so that letters also have a contrast of 4.5.
Viridis colours time and keys, because its lightness increases evenly.  It is cut where it would
fade into the background.  A test simulates three kinds of colour blindness.

Text remains text in SVG, and PDF embeds TrueType outlines (Type 42), as journals require.
"""

from __future__ import annotations

import io
import logging
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from ..errors import LagtopError, UnavailableError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure, FigureBase


POINTS = 11.0
"""Size of ordinary letters on a page of the usual size."""

HEIGHT, RADIUS, WEDGES = 0.62, 0.34, 24
"""Height and radius (in radii of the globe) and number of wedges of the cone for the top."""

FONTS = ["DejaVu Sans", "Verdana", "Arial"]
"""The first font comes with matplotlib and has Greek; the others are for readers of an SVG."""

_IN_FILES = {"svg.fonttype": "none", "pdf.fonttype": 42, "svg.hashsalt": "lagtop"}


class Look(NamedTuple):
    """The colours of a picture on light or on dark paper."""

    paper: str
    ink: str
    quiet: str
    """Colour of auxiliary elements: circles, axes, mean rates."""
    faint: str
    """Colour of areas."""
    lines: tuple[str, str, str]
    """Colours of tilt, spin and precession, and of other curves."""
    scale: tuple[float, float]
    """The part of viridis that stands out from the paper."""


LIGHT = Look(
    "#ffffff", "#1a1a1a", "#6b6b6b", "#e9eef2", ("#0058a8", "#c04f00", "#008656"), (0, 0.85)
)
DARK = Look(
    "#14181d", "#ececec", "#9a9fa5", "#252c34", ("#56b4e9", "#e69f00", "#3ddc97"), (0.25, 1)
)


@contextmanager
def styled(look: Look, size: float = 1.0) -> Iterator[None]:
    """Apply our settings only, whatever the user's own matplotlibrc contains.

    `size` scales letters, lines and gaps.
    """
    from matplotlib import rc_context, rcParams, rcParamsDefault

    usual = {key: value for key, value in rcParamsDefault.items() if key != "backend"}
    changed = {key: value for key, value in usual.items() if rcParams[key] != value}
    colours = {key: getattr(look, name) for name, keys in _COLOURED.items() for key in keys}
    scaled = {key: value * size for key, value in _SCALED.items()}
    with rc_context(cast(Any, changed | _FIXED | colours | scaled)):  # the stub lists every key
        yield


_COLOURED = {
    "paper": ("axes.facecolor", "figure.facecolor", "savefig.facecolor"),
    "ink": ("axes.labelcolor", "text.color", "xtick.labelcolor", "ytick.labelcolor"),
    "quiet": ("axes.edgecolor", "hatch.color", "xtick.color", "ytick.color"),
}
"""Settings of matplotlib that take each colour of a look."""
_SCALED = {
    "axes.labelpad": 4.0,
    "axes.titlepad": 6.0,
    "axes.titlesize": 12.0,
    "figure.constrained_layout.h_pad": 0.042,
    "figure.constrained_layout.w_pad": 0.042,
    "figure.titlesize": 12.0,
    "font.size": POINTS,
    "lines.linewidth": 1.8,
    **dict.fromkeys(("xtick.major.pad", "xtick.major.size"), 3.5),
    **dict.fromkeys(("ytick.major.pad", "ytick.major.size"), 3.5),
}
"""Settings that scale with the letters, and their values on a page of the usual size."""
_FIXED = {
    "axes.axisbelow": True,
    "axes.formatter.limits": (-4, 5),
    "axes.formatter.useoffset": False,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "font.family": "sans-serif",
    "font.sans-serif": FONTS,
    "legend.frameon": False,
    "lines.solid_capstyle": "round",
    "lines.solid_joinstyle": "round",
    "mathtext.fontset": "dejavusans",
    "path.simplify": False,  # it would blunt the cusps
}


def points(length: float) -> float:
    """Convert a length to points on the page being drawn, whose letters may be small."""
    import matplotlib

    return length * float(matplotlib.rcParams["font.size"]) / POINTS


def head(panel: FigureBase, title: str) -> None:
    """Write the title of a picture at its upper left."""
    panel.suptitle(title, x=0.012, ha="left")


def number_from_left_to_right(axes: Axes) -> None:
    """Label the horizontal axis with as many numbers as fit; few, if they are long.

    The numbers are written in full, because readers overlook an offset at the corner of a picture.
    """
    low, high = axes.get_xlim()
    decimals = max(0.0, -math.log10((high - low) / 5)) if low < high else 0.0
    count = next(n for n, most in ((6, 4), (4, 6), (3, 8), (2, math.inf)) if decimals <= most)
    axes.ticklabel_format(axis="x", useOffset=False)
    axes.locator_params(axis="x", nbins=count)


def number_text(value: float) -> str:
    """Return a number to seven digits; if that rounds it to 1 or -1, by its distance from there."""
    shown = f"{value:.7g}"
    if shown in {"1", "-1"} and abs(value) != 1:
        beyond = abs(value) - 1
        shown = f"{shown} {'+' if (beyond > 0) == (value > 0) else '-'} {abs(beyond):.2g}"
    return shown.replace("-", "−")


def short_text(value: float) -> str:
    """Return a number to four digits."""
    return number_text(float(f"{value:.4g}"))


def scale(look: Look) -> Colormap:
    """Return the colour scale for the size of a quantity."""
    import numpy as np
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps["viridis"](np.linspace(*look.scale, 256)), name="lagtop")


def mark_start(axes: Axes, x: float, y: float, look: Look, label: str = "start") -> None:
    """Draw a ring with a label at one point."""
    ring: dict[str, Any] = {"mfc": look.paper, "mec": look.ink, "mew": points(1.6), "zorder": 6}
    axes.plot(x, y, "o", ls="none", ms=points(7), label=label, **ring)


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
    with matplotlib.rc_context(_IN_FILES):  # type: ignore[arg-type]  # the stub lists every key
        canvas = get_registered_canvas_class(fmt)(figure)
        getattr(canvas, f"print_{fmt}")(buffer, metadata=about.fields(fmt), **how)
    if fmt != "svg":
        return buffer.getvalue()
    end = b"</title>"  # a description for screen readers follows
    described = end + f"\n <desc>{escape(about.text)}</desc>".encode()
    return buffer.getvalue().replace(end, described, 1)


def require_matplotlib() -> None:
    """Raise UnavailableError, with the remedy, if matplotlib is missing.

    Raises LagtopError if a variable of the environment, such as MPLBACKEND, stops it.
    """
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # such as about its folder of settings
    try:
        import matplotlib  # noqa: F401

        datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", "0")), UTC)
    except ImportError:
        raise UnavailableError("pictures need matplotlib: pip install 'lagtop[plot]'") from None
    except (ValueError, OverflowError) as error:
        raise LagtopError(f"unset MPLBACKEND and SOURCE_DATE_EPOCH: {error}") from None
