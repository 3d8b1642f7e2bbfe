"""The kinds of picture: one row per kind, from which the command, its help and the page are made.

A kind is one file of this subpackage, named like the kind.  Its function `drawing` computes the
picture, and returns it ready to be drawn on axes, those of a page as well as those of a user.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..motion.solve import Motion
    from .request import PlotRequest
    from .style import Look


class Drawing(NamedTuple):
    """A picture of a motion: computed, but not drawn yet."""

    title: str
    draw: Callable[[Sequence[Axes], Look], None]
    """Draws everything but the title on axes, one below the other."""
    heights: tuple[float, ...] = (1.0,)
    """Heights of the axes of a page, in any unit."""


class PictureKind(NamedTuple):
    """A kind of picture."""

    name: str
    help: str
    """One line for the help of the command."""
    size: tuple[float, float]
    """Width and height (inches) of a page with this picture alone."""
    on_sheet: bool
    """Whether the picture is on the sheet, which the command draws by default."""
    axes: int = 1
    """Number of axes of a user that the picture takes; several share the time."""

    def drawing(self, motion: Motion, request: PlotRequest) -> Drawing:
        """Compute the picture; its file, and with it matplotlib, is loaded only now.

        Raises LagtopError for a bad request, and NothingToDrawError.
        """
        drawing: Drawing = import_module(f".{self.name}", __package__).drawing(motion, request)
        return drawing


_ROWS = [
    PictureKind("sphere", "the path of the figure axis on the unit sphere", (6.4, 6.0), True),
    PictureKind("angles", "tilt, spin and precession over time", (7.0, 6.0), True, 3),
    PictureKind("remainders", "periodic parts of spin and precession", (7, 5), True, 2),
    PictureKind("cubic", "f(u), its roots, and the band of the motion", (6.8, 5.0), True),
    PictureKind("phase", "tilt rate against tilt, and the separatrix", (6.8, 5.0), False),
    PictureKind("map", "a key of the record over two inputs", (6.8, 5.0), False),
]

KINDS = {kind.name: kind for kind in _ROWS}
"""The kinds by name, in the order of the help."""

SHEET = "all"
"""The name that stands for all kinds on the sheet."""

ON_THE_SHEET = tuple(kind.name for kind in _ROWS if kind.on_sheet)
"""The names of the kinds on the sheet."""


def help_lines() -> list[str]:
    """Return one aligned line per kind, and one for the sheet, for the help of the command."""
    sheet = f"{', '.join(ON_THE_SHEET[:-1])} and {ON_THE_SHEET[-1]}, with the record (the default)"
    texts = {name: kind.help for name, kind in KINDS.items()} | {SHEET: sheet}
    width = max(map(len, texts))
    return [f"{name:{width}}  {text}" for name, text in texts.items()]
