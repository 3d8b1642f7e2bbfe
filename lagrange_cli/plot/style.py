"""How pictures look: one style sheet, light and dark.

The colours of lines are Okabe and Ito's, made to be told apart by every kind of colour vision; time
and keys are coloured by viridis, whose lightness grows evenly, cut where it would fade into the
background.  A test simulates the three kinds of colour blindness.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import LagtopError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap


class Look(NamedTuple):
    """The colours of one style."""

    paper: str
    ink: str
    quiet: str
    """For what helps to read the rest: circles, axes, mean rates."""
    faint: str
    """For areas."""
    lines: tuple[str, str, str]
    scale: tuple[float, float]
    """The part of viridis that stands out from the paper."""


LIGHT = Look(
    "#ffffff", "#1a1a1a", "#6b6b6b", "#e9eef2", ("#0072b2", "#d55e00", "#009e73"), (0, 0.85)
)
DARK = Look(
    "#14181d", "#ececec", "#9a9fa5", "#252c34", ("#56b4e9", "#e69f00", "#cc79a7"), (0.25, 1)
)


def require_matplotlib() -> None:
    """Raise LagtopError, with the remedy, where it is missing."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise LagtopError("pictures need matplotlib: pip install 'lagtop[plot]'") from None


def look(dark: bool) -> Look:
    """The style."""
    return DARK if dark else LIGHT


def settings(style: Look, size: float = 1.0) -> dict[str, Any]:
    """The style sheet, as matplotlib's settings; `size` is that of the letters and lines."""
    return {
        "axes.axisbelow": True,
        "axes.edgecolor": style.quiet,
        "axes.facecolor": style.paper,
        "axes.formatter.limits": (-4, 5),
        "axes.formatter.use_mathtext": True,
        "axes.formatter.useoffset": False,
        "axes.labelcolor": style.ink,
        "axes.spines.right": False,
        "axes.spines.top": False,
        "axes.titlelocation": "left",
        "axes.titlesize": 12.0 * size,
        "figure.facecolor": style.paper,
        "font.family": "DejaVu Sans",  # comes with matplotlib, and has Greek
        "font.size": 11.0 * size,
        "hatch.color": style.quiet,
        "legend.frameon": False,
        "lines.linewidth": 1.8 * size,
        "lines.solid_capstyle": "round",
        "lines.solid_joinstyle": "round",
        "mathtext.fontset": "dejavusans",
        "path.simplify": False,  # it would blunt the cusps
        "savefig.facecolor": style.paper,
        "svg.hashsalt": "lagtop",  # the same names inside the file every time
        "text.color": style.ink,
        "xtick.color": style.quiet,
        "xtick.labelcolor": style.ink,
        "ytick.color": style.quiet,
        "ytick.labelcolor": style.ink,
    }


def scale(style: Look) -> Colormap:
    """The colours of a quantity."""
    import numpy as np
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps["viridis"](np.linspace(*style.scale, 256)), name="lagtop")


def mark_start(axes: Axes, x: float, y: float, style: Look, label: str = "start") -> None:
    """A ring at one point."""
    axes.plot(
        x, y, "o", ms=7, mfc=style.paper, mec=style.ink, mew=1.6, zorder=6, label=label, ls="none"
    )
