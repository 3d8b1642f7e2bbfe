"""A page of pictures: the panels, the numbers of the scene beside them, and the file it becomes."""

from __future__ import annotations

import io
import math
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple, cast

import matplotlib
from matplotlib.figure import Figure, FigureBase, SubFigure

from ..errors import LagtopError, NothingToDrawError
from ..motion.solve import Motion
from .kinds import KINDS, Wish
from .style import Look, settings

SIZES = {"sphere": (6.4, 6.0), "remainders": (7.0, 5.0), "angles": (7.0, 6.0)}
USUAL_SIZE = 6.8, 5.0
NUMBERS_WIDTH, PANEL = 3.1, (5.8, 5.0)
METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
"""What matplotlib would add, and with it the day and the version."""


class Page(NamedTuple):
    """What is to be drawn, and how."""

    motion: Motion
    kinds: Sequence[str]
    wish: Wish
    style: Look
    size: tuple[float, float] | None = None
    """Width and height in inches; by default as the kinds need."""

    def inches(self) -> tuple[float, float]:
        """The size."""
        return self.size or self.usual_inches()

    def lettering(self) -> float:
        """Size of the letters: 1, and smaller on a page that is smaller than usual."""
        pairs = zip(self.inches(), self.usual_inches(), strict=True)
        return min(1.0, *(given / usual for given, usual in pairs))

    def usual_inches(self) -> tuple[float, float]:
        """The size that the kinds need."""
        if len(self.kinds) == 1:
            return SIZES.get(self.kinds[0], USUAL_SIZE)
        rows, columns = self.grid()
        return NUMBERS_WIDTH + PANEL[0] * columns, PANEL[1] * rows

    def grid(self) -> tuple[int, int]:
        """Rows and columns of panels."""
        columns = math.ceil(math.sqrt(len(self.kinds)))
        return math.ceil(len(self.kinds) / columns), columns


@contextmanager
def styled(style: Look, size: float = 1.0) -> Iterator[None]:
    """Our settings and nobody else's, whatever the user's own matplotlibrc says."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(cast(Any, settings(style, size)))  # the stub lists every key
        yield


def draw_page(figure: Figure, page: Page) -> None:
    """The kinds as panels; where there are several, with the scene's numbers beside them."""
    if len(page.kinds) == 1:
        _draw(page.kinds[0], figure.subfigures(1, 1, squeeze=False)[0, 0], page)
        return
    rows, columns = page.grid()
    widths = NUMBERS_WIDTH, columns * PANEL[0]
    sides = figure.subfigures(1, 2, squeeze=False, width_ratios=widths)[0]
    _write_numbers(sides[0], page)
    panels = sides[1].subfigures(rows, columns, squeeze=False, wspace=0.04, hspace=0.04)
    for kind, panel in zip(page.kinds, panels.flat, strict=False):
        try:
            _draw(kind, panel, page)
        except NothingToDrawError as reason:
            panel.text(0.5, 0.5, str(reason), ha="center", color=page.style.quiet, wrap=True)


def _draw(kind: str, panel: SubFigure, page: Page) -> None:
    KINDS[kind](panel, page.motion, page.wish, page.style)


def _write_numbers(panel: SubFigure, page: Page) -> None:
    """The record, to seven digits, a line for each of up to 38 keys."""
    points = min(9.0 * page.lettering(), 0.0242 * 72 * page.inches()[1] * 0.8)
    record = page.motion.record(radians=page.wish.radians)
    shown = {key: value for key, value in record.items() if value is not None and key != "remark"}
    height = 0.955
    panel.text(0.05, 0.985, "lagtop", va="top", size="x-large")
    for key, value in shown.items():
        height -= 0.0242
        text = value if isinstance(value, str) else f"{float(value):.7g}"
        panel.text(0.05, height, key, va="top", size=points, color=page.style.quiet)
        panel.text(0.97, height, text, va="top", ha="right", size=points)


def page_bytes(page: Page, file_style: str, dpi: float) -> bytes:
    """The page as `png`, `svg` or `pdf`: the same bytes for the same picture.

    Raises LagtopError where there is nothing to draw.
    """
    buffer = io.BytesIO()
    os.environ.setdefault("SOURCE_DATE_EPOCH", "0")  # or the fonts in a PDF would carry the day
    with styled(page.style, page.lettering()):
        figure = Figure(figsize=page.inches(), layout="constrained")
        draw_page(figure, page)
        _settle_layout(figure)
        figure.savefig(buffer, format=file_style, dpi=dpi, metadata=METADATA[file_style])
    return buffer.getvalue()


def _settle_layout(figure: Figure) -> None:
    """Lay out now, and round: the solver's last digits depend on the addresses of its variables."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    _round_boxes(figure)
    for axes in figure.axes:
        x, y, width, height = (round(z, 5) for z in axes.get_position().bounds)
        axes.set_aspect("auto")  # it has been applied
        axes.set_position((x, y, width, height))


def _round_boxes(figure: FigureBase) -> None:
    for part in figure.subfigs:
        box = part.bbox_relative
        box.p0, box.p1 = box.p0.round(5), box.p1.round(5)
        _round_boxes(part)


def show_page(page: Page) -> None:
    """Open the page in a window and wait until it is closed.

    Raises LagtopError where there is no display.
    """
    from matplotlib import pyplot

    with styled(page.style, page.lettering()):
        try:
            figure = pyplot.figure(figsize=page.inches(), layout="constrained")
        except ImportError as error:  # of a toolkit that was asked for by MPLBACKEND
            raise LagtopError(f"--show cannot open a window: {error}") from None
        if pyplot.get_backend().lower() == "agg":
            raise LagtopError("--show needs a display and a window toolkit: give -o FILE.png")
        draw_page(figure, page)
        pyplot.show()
