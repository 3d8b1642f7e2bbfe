"""The look of pictures, light and dark, and the way they become files.

The colours of lines are Okabe and Ito's, made to be told apart by every kind of colour vision; time
and keys are coloured by viridis, whose lightness grows evenly, cut where it would fade into the
background.  A test simulates the three kinds of colour blindness.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from ..errors import CannotWriteError, LagtopError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure


POINTS = 11.0
"""Size of ordinary letters on a page of the usual size."""


class Look(NamedTuple):
    """The colours of a picture on light or on dark paper."""

    paper: str
    ink: str
    quiet: str
    """Colour of what helps to read the rest: circles, axes, mean rates."""
    faint: str
    """Colour of areas."""
    lines: tuple[str, str, str]
    scale: tuple[float, float]
    """The part of viridis that stands out from the paper."""


LIGHT = Look(
    "#ffffff", "#1a1a1a", "#6b6b6b", "#e9eef2", ("#0072b2", "#d55e00", "#009e73"), (0, 0.85)
)
DARK = Look(
    "#14181d", "#ececec", "#9a9fa5", "#252c34", ("#56b4e9", "#e69f00", "#cc79a7"), (0.25, 1)
)


METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
"""What matplotlib would add to each kind of file, and with it the day and the version."""


REPORT_KINDS = (".svg", ".png")
"""The kinds of file that the picture of a report may have."""


def require_matplotlib() -> None:
    """Raise LagtopError, with the remedy, where matplotlib is missing."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise LagtopError("pictures need matplotlib: pip install 'lagtop[plot]'") from None


def check_plot(path: str | None, output: str) -> None:
    """Raise LagtopError for a kind of file that is not drawn, or that is the report itself.

    Raises LagtopError where matplotlib is missing, too, and CannotWriteError where there is no such
    directory.
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


def figure_bytes(figure: Figure, fmt: str, dpi: float) -> bytes:
    """Return the figure as `png`, `svg` or `pdf`: the same bytes for the same figure."""
    import matplotlib

    buffer = io.BytesIO()
    os.environ.setdefault("SOURCE_DATE_EPOCH", "0")  # or the fonts in a PDF would carry the day
    with matplotlib.rc_context({"svg.hashsalt": "lagtop"}):  # names inside the file do not change
        figure.savefig(buffer, format=fmt, dpi=dpi, metadata=METADATA[fmt])
    return buffer.getvalue()


def chosen_look(dark: bool) -> Look:
    """Return the dark look or the light one."""
    return DARK if dark else LIGHT


@contextmanager
def styled(look: Look, size: float = 1.0) -> Iterator[None]:
    """Set our settings and nobody else's, whatever the user's own matplotlibrc says."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(cast(Any, settings(look, size)))  # the stub lists every key
        yield


def settings(look: Look, size: float = 1.0) -> dict[str, Any]:
    """Return the style sheet as matplotlib's settings; `size` scales letters, lines and gaps."""
    return {
        "axes.axisbelow": True,
        "axes.edgecolor": look.quiet,
        "axes.facecolor": look.paper,
        "axes.formatter.limits": (-4, 5),
        "axes.formatter.use_mathtext": True,
        "axes.formatter.useoffset": False,
        "axes.labelcolor": look.ink,
        "axes.spines.right": False,
        "axes.spines.top": False,
        "axes.labelpad": 4.0 * size,
        "axes.titlelocation": "left",
        "axes.titlepad": 6.0 * size,
        "axes.titlesize": 12.0 * size,
        "figure.constrained_layout.h_pad": 0.042 * size,
        "figure.constrained_layout.w_pad": 0.042 * size,
        "figure.facecolor": look.paper,
        "font.family": "DejaVu Sans",  # comes with matplotlib, and has Greek
        "font.size": POINTS * size,
        "hatch.color": look.quiet,
        "legend.frameon": False,
        "lines.linewidth": 1.8 * size,
        "lines.solid_capstyle": "round",
        "lines.solid_joinstyle": "round",
        "mathtext.fontset": "dejavusans",
        "path.simplify": False,  # it would blunt the cusps
        "savefig.facecolor": look.paper,
        "text.color": look.ink,
        "xtick.color": look.quiet,
        "xtick.major.pad": 3.5 * size,
        "xtick.major.size": 3.5 * size,
        "xtick.labelcolor": look.ink,
        "ytick.color": look.quiet,
        "ytick.major.pad": 3.5 * size,
        "ytick.major.size": 3.5 * size,
        "ytick.labelcolor": look.ink,
    }


def scale(look: Look) -> Colormap:
    """Return the colours that stand for the size of a quantity."""
    import numpy as np
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps["viridis"](np.linspace(*look.scale, 256)), name="lagtop")


def mark_start(axes: Axes, x: float, y: float, look: Look, label: str = "start") -> None:
    """Draw a ring at one point."""
    axes.plot(
        x, y, "o", ms=7, mfc=look.paper, mec=look.ink, mew=1.6, zorder=6, label=label, ls="none"
    )
