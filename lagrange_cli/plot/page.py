"""A page of pictures: the panels, the numbers of the scene beside them, and the file it becomes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from matplotlib.figure import Figure, FigureBase, SubFigure

from ..errors import LagtopError, NothingToDrawError
from ..motion.solve import Motion
from .kinds import KINDS
from .request import PlotRequest
from .style import POINTS, Look, figure_bytes, styled

NUMBERS_WIDTH, PANEL = 3.1, (5.8, 5.0)
"""Width of the column of numbers, and width and height of one panel among several (inches)."""

LEAST_DPI, MOST_DPI = 20.0, 1000.0
"""Least and greatest pixels per inch of any picture."""
MOST_PIXELS = 5e7
"""Most pixels of a picture."""
LEAST_LETTERS = 1.0
"""Least height of ordinary letters in pixels: FreeType draws none whose height rounds to 0, and the
smallest letters on a page, exponents among them, are about 0.55 of the ordinary ones."""


class Page(NamedTuple):
    """The pictures to be drawn on one page, and how."""

    motion: Motion
    kinds: Sequence[str]
    request: PlotRequest
    look: Look
    size: tuple[float, float] | None = None
    """Width and height in inches; by default as the kinds need."""

    def inches(self) -> tuple[float, float]:
        """Return width and height."""
        return self.size or self.usual_inches()

    def lettering(self) -> float:
        """Return the size of the letters: 1, and less on a page that is smaller than usual."""
        pairs = zip(self.inches(), self.usual_inches(), strict=True)
        return min(1.0, *(length / usual for length, usual in pairs))

    def usual_inches(self) -> tuple[float, float]:
        """Return the width and height that the kinds need."""
        if len(self.kinds) == 1:
            return KINDS[self.kinds[0]].size
        rows, columns = self.grid()
        return NUMBERS_WIDTH + PANEL[0] * columns, PANEL[1] * rows

    def grid(self) -> tuple[int, int]:
        """Return the rows and columns of panels."""
        columns = math.ceil(math.sqrt(len(self.kinds)))
        return math.ceil(len(self.kinds) / columns), columns

    def check_dpi(self, dpi: float, fmt: str) -> None:
        """Raise LagtopError where the pixels per inch do not suit the page.

        Letters of a PNG need a height of one pixel at least; SVG and PDF have no pixels there.
        """
        least = 72.0 * LEAST_LETTERS / (POINTS * self.lettering()) if fmt == "png" else LEAST_DPI
        check_pixels(dpi, self.inches(), least)


def check_pixels(dpi: float, inches: tuple[float, float], least: float = LEAST_DPI) -> None:
    """Raise LagtopError where a picture would have too few or too many pixels per inch.

    `least` is the number that its letters need.
    """
    width, height = inches
    low, high = max(LEAST_DPI, least), min(MOST_DPI, math.sqrt(MOST_PIXELS / (width * height)))
    if not low <= dpi <= high:
        bounds = f"[{math.ceil(low)}, {math.floor(high)}]"
        where = f"for {width:.3g} x {height:.3g} inches"
        raise LagtopError(f"dpi must be in {bounds} {where}, got {dpi:g}", "dpi")


def draw_page(figure: Figure, page: Page) -> None:
    """Draw the kinds as panels; where there are several, with the scene's numbers beside them.

    Raises NothingToDrawError where a single kind has nothing to draw.
    """
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
            panel.text(0.5, 0.5, str(reason), ha="center", color=page.look.quiet, wrap=True)


def _draw(kind: str, panel: SubFigure, page: Page) -> None:
    KINDS[kind].draw(panel, page.motion, page.request, page.look)


def _write_numbers(panel: SubFigure, page: Page) -> None:
    """Write the record, to seven digits, a line for each of up to 38 keys."""
    points = min(9.0 * page.lettering(), 0.0242 * 72 * page.inches()[1] * 0.8)
    record = page.motion.record(radians=page.request.radians)
    shown = {key: value for key, value in record.items() if value is not None and key != "remark"}
    height = 0.955
    panel.text(0.05, 0.985, "lagtop", va="top", size="x-large")
    for key, value in shown.items():
        height -= 0.0242
        text = value if isinstance(value, str) else f"{float(value):.7g}"
        panel.text(0.05, height, key, va="top", size=points, color=page.look.quiet)
        panel.text(0.97, height, text, va="top", ha="right", size=points)


def page_bytes(page: Page, fmt: str, dpi: float) -> bytes:
    """Return the page as `png`, `svg` or `pdf`: the same bytes for the same picture.

    Raises LagtopError where the pixels per inch do not suit the page, and NothingToDrawError where
    there is nothing to draw.
    """
    page.check_dpi(dpi, fmt)
    with styled(page.look, page.lettering()):
        figure = Figure(figsize=page.inches(), layout="constrained")
        draw_page(figure, page)
        _settle_layout(figure)
        return figure_bytes(figure, fmt, dpi)


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

    with styled(page.look, page.lettering()):
        try:
            figure = pyplot.figure(figsize=page.inches(), layout="constrained")
        except ImportError as error:  # from a toolkit that was asked for by MPLBACKEND
            raise LagtopError(f"show cannot open a window: {error}", "show") from None
        if pyplot.get_backend().lower() == "agg":
            raise LagtopError("show needs a display and a window toolkit (or write a file)", "show")
        draw_page(figure, page)
        pyplot.show()
