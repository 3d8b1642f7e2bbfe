"""The kinds of picture: one row per kind, from which the command, its help and the page are made.

A new picture is one file of this room with the functions `draw(panel, motion, request, look)` and
`draw_on(places, motion, request, look)`, which draws on axes that are there, and one row here; for
axes of a user it has a function of its own in `on_axes`, whose name stands in `__init__`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure

    from ..motion.solve import Motion
    from .request import PlotRequest
    from .style import Look

    Draw = Callable[[SubFigure, Motion, PlotRequest, Look], None]
    DrawOn = Callable[[Sequence[Axes], Motion, PlotRequest, Look], None]


class Kind(NamedTuple):
    """A kind of picture."""

    name: str
    file: str
    """Module of this room that computes and draws the picture."""
    help: str
    """One line for the help of the command."""
    size: tuple[float, float]
    """Width and height (inches) of a page with this picture alone."""
    on_sheet: bool
    """Whether the picture is on the sheet, which the command draws by default."""
    axes: int = 1
    """Number of axes that the picture takes, one below the other."""

    @property
    def draw(self) -> Draw:
        """The function that draws; its file, and with it matplotlib, is loaded only now."""
        draw: Draw = import_module(f".{self.file}", __package__).draw
        return draw

    @property
    def draw_on(self) -> DrawOn:
        """The function that draws on axes that are there."""
        draw_on: DrawOn = import_module(f".{self.file}", __package__).draw_on
        return draw_on


_ROWS = [
    Kind("sphere", "sphere", "the path of the figure axis on the unit sphere", (6.4, 6.0), True),
    Kind("angles", "angles", "tilt, spin and precession over time", (7.0, 6.0), True, 3),
    Kind("remainders", "remainders", "spin and precession less their mean growth", (7, 5), True, 2),
    Kind("cubic", "cubic", "f(u), its roots, and the band of the motion", (6.8, 5.0), True),
    Kind("phase", "phase", "tilt rate against tilt, and the separatrix", (6.8, 5.0), False),
    Kind("map", "map_picture", "a key of the record over two inputs", (6.8, 5.0), False),
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
