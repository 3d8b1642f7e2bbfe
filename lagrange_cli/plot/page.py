"""A page of pictures: panels, the numbers of the scene beside them, and the output file."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from ..errors import LagtopError, NothingToDrawError
from ..motion.quantity import degree_name
from ..motion.record import KEYS
from ..motion.solve import Motion
from ..motion.uncertainty import stds_of
from ..output.report import uncertain_text
from .curves import motion_in_words
from .kinds import KINDS, PlotRequest
from .style import POINTS, About, figure_bytes, head, number_text, styled

NUMBERS_WIDTH, PANEL = 3.7, (5.8, 5.0)
"""Width of the column of numbers; width and height of one of several panels (inches)."""

ALONE = 0.7
"""Exponent by which letters of a single picture shrink with its size; legible at 3.5 inches."""

REMARK_WIDTH = 52
"""Characters per line of the remark below the numbers."""

LEAST_DPI, MOST_DPI = 20.0, 1000.0
"""Least and greatest pixels per inch of any picture."""
MOST_PIXELS = 5e7
"""Greatest number of pixels of a picture."""
LEAST_LETTERS = 1.0
"""Least height of ordinary letters in pixels.

FreeType draws no letter whose height rounds to 0.  The smallest letters on a page, such as
exponents, are about 0.55 of the ordinary height.
"""


class Page(NamedTuple):
    """The pictures to draw on one page, and their options."""

    motion: Motion
    kinds: Sequence[str]
    request: PlotRequest = PlotRequest()
    size: tuple[float, float] | None = None
    """Width and height in inches; by default chosen for the kinds."""

    def inches(self) -> tuple[float, float]:
        """Return width and height."""
        return self.size or self.usual_inches()

    def lettering(self) -> float:
        """Return the relative size of the letters: 1, or less on a page smaller than usual."""
        pairs = zip(self.inches(), self.usual_inches(), strict=True)
        size = min(1.0, *(length / usual for length, usual in pairs))
        return size**ALONE if len(self.kinds) == 1 else size

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

    def about(self) -> About:
        """Return a description of the page in words, and the command that draws it again.

        The command has inputs in place of the name of a scene file.
        """
        motion, request = self.motion, self.request
        inputs = motion.top.inputs(radians=request.radians)
        listed = ", ".join(f"{name} = {value!r}" for name, value in inputs.items())
        text = f"Lagrange top, {motion_in_words(motion)} ({motion.regime.value}): {listed}"
        scene = [
            f"--{name.partition('_')[0]} {value!r}"
            for name, value in inputs.items()
            if value or not name.endswith("dot0")
        ]
        size = [f"--size {self.size[0]:g}x{self.size[1]:g}"] if self.size else []
        words = " ".join([*self.kinds, *scene, *request.options(self.kinds), *size])
        title = f"Lagrange top: {', '.join(self.kinds)}"
        return About(title, text, f"lagtop plot {words} -o picture.svg")

    def check_dpi(self, dpi: float, fmt: str) -> None:
        """Raise LagtopError unless the pixels per inch suit the page.

        Letters of a PNG need a height of at least one pixel.  The letters of SVG and PDF have no
        pixels.
        """
        least = 72.0 * LEAST_LETTERS / (POINTS * self.lettering()) if fmt == "png" else LEAST_DPI
        check_pixels(dpi, self.inches(), least)


def check_pixels(dpi: float, inches: tuple[float, float], least: float = LEAST_DPI) -> None:
    """Raise LagtopError for a picture with too few or too many pixels per inch.

    `least` is the number that its letters need.
    """
    width, height = inches
    low, high = max(LEAST_DPI, least), min(MOST_DPI, math.sqrt(MOST_PIXELS / (width * height)))
    if not low <= dpi <= high:
        bounds = f"[{math.ceil(low)}, {math.floor(high)}]"
        where = f"for {width:.3g} x {height:.3g} inches"
        raise LagtopError(f"dpi must be in {bounds} {where}, got {dpi:g}", "dpi")


def draw_page(figure: Figure, page: Page) -> None:
    """Draw the kinds as panels; several panels have the scene's numbers beside them.

    Raises NothingToDrawError if a single kind has nothing to draw.
    """
    if len(page.kinds) == 1:
        _draw(page.kinds[0], figure.subfigures(1, 1, squeeze=False)[0, 0], page)
        return
    rows, columns = page.grid()
    widths = NUMBERS_WIDTH, columns * PANEL[0]
    left, right = figure.subfigures(1, 2, squeeze=False, width_ratios=widths)[0]
    _write_numbers(left, page)
    panels = right.subfigures(rows, columns, squeeze=False, wspace=0.04, hspace=0.04)
    for kind, panel in zip(page.kinds, panels.flat, strict=False):
        try:
            _draw(kind, panel, page)
        except NothingToDrawError as reason:
            panel.text(0.5, 0.5, str(reason), ha="center", color=page.request.look.quiet, wrap=True)


def _draw(name: str, panel: SubFigure, page: Page) -> None:
    """Draw a kind of picture on axes of a panel, with the title above and the legend below."""
    kind = KINDS[name]
    together = kind.axes > 1

    def places(heights: Sequence[float]) -> list[Axes]:
        grid = panel.subplots(len(heights), sharex=together, squeeze=False, height_ratios=heights)
        return list(grid.flat)

    head(panel, kind.draw(page.motion, page.request, places))
    if together:
        panel.align_ylabels()
    axes = panel.axes[0]
    if axes.get_legend() is None and axes.get_legend_handles_labels()[0]:
        panel.legend(loc="outside lower left", fontsize="small")


def _write_numbers(panel: SubFigure, page: Page) -> None:
    """Write the record, one line per key with symbol and unit, and the remark."""
    request = page.request
    record = page.motion.record(radians=request.radians)
    stds = stds_of(record, request.uncertain) if request.uncertain else {}
    remark = textwrap.wrap(request.in_words(record.pop("remark") or ""), REMARK_WIDTH)
    shown = {key: value for key, value in record.items() if value is not None}
    step = min(0.0242, 0.95 / (len(shown) + len(remark) + 1.5))
    size = min(8.5 * page.lettering(), step * 72 * page.inches()[1] * 0.8)
    panel.text(0.04, 0.985, "lagtop", va="top", size="x-large")
    height = 0.955
    for name, value in shown.items():
        height -= step
        key = KEYS.get(degree_name(name))
        symbol, unit = (key.symbol, request.unit_of(key)) if key else ("", "")
        std = stds.get(f"{name}_std")
        text = value if isinstance(value, str) else number_text(float(value))
        text = uncertain_text(float(value), std).replace("-", "−") if std else text
        text = f"{text} {unit}".rstrip()
        quiet = name if name != symbol else ""
        for x, word, colour in ((0.04, symbol, request.look.ink), (0.2, quiet, request.look.quiet)):
            panel.text(x, height, word, va="top", size=size, color=colour)
        panel.text(0.98, height, text, va="top", ha="right", size=size)
    for line in remark:
        height -= step
        panel.text(0.04, height - step / 2, line, va="top", size=size)


def page_bytes(page: Page, fmt: str, dpi: float) -> bytes:
    """Return the page as `png`, `svg` or `pdf`; the same picture gives the same bytes.

    Raises LagtopError if the pixels per inch do not suit the page, and NothingToDrawError if there
    is nothing to draw.
    """
    page.check_dpi(dpi, fmt)
    with styled(page.request.look, page.lettering()):
        figure = Figure(figsize=page.inches(), layout="constrained")
        draw_page(figure, page)
        _settle_layout(figure)
        return figure_bytes(figure, fmt, dpi, page.about())


def _settle_layout(figure: Figure) -> None:
    """Compute the layout and round it: the solver's last digits depend on memory addresses."""
    engine = figure.get_layout_engine()
    assert engine is not None
    engine.execute(figure)
    if _write_powers(figure) | _fit_titles(figure):
        engine.execute(figure)
    figure.set_layout_engine("none")
    for panel in figure.findobj(SubFigure):
        box = panel.bbox_relative
        box.p0, box.p1 = box.p0.round(5), box.p1.round(5)
    for axes in figure.axes:
        axes.apply_aspect()
        x, y, width, height = (round(z, 5) for z in axes.get_position().bounds)
        axes.set_aspect("auto")  # it has been applied
        axes.set_position((x, y, width, height))


def _write_powers(figure: Figure) -> bool:
    """Write common factors of an axis as powers of ten, not as 1e5; return whether any exists.

    Other axes do without mathtext, which takes twice the time of the rest of a picture.
    """
    both = [axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)]
    formatters: list[Any] = [axis.get_major_formatter() for axis in both]
    with_factor = [formatter for formatter in formatters if formatter.get_offset()]
    for formatter in with_factor:
        formatter.set_useMathText(True)
    return bool(with_factor)


def _fit_titles(figure: Figure) -> bool:
    """Reduce the letters of titles that are wider than their panel; return whether any was."""
    changed = False
    for panel in figure.findobj(SubFigure):
        for title in [text for text in panel.texts if text.get_text() == panel.get_suptitle()]:
            while title.get_window_extent().x1 > panel.bbox.x1:
                title.set_fontsize(float(title.get_fontsize()) * 0.95)
                changed = True
    return changed


def empty_window(page: Page) -> Figure:
    """Return an empty figure of the page in a window that `show_page` opens.

    Raises LagtopError if there is no display.
    """
    from matplotlib import pyplot

    with styled(page.request.look, page.lettering()):
        try:
            figure = pyplot.figure(figsize=page.inches(), layout="constrained")
        except ImportError as error:  # from the toolkit that MPLBACKEND names
            raise LagtopError(f"show cannot open a window: {error}", "show") from None
    if pyplot.get_backend().lower() == "agg":
        raise LagtopError("show needs a display and a window toolkit (or write a file)", "show")
    return figure


def show_page(page: Page, figure: Figure) -> None:
    """Draw the page on its figure, open the window, and wait until it is closed."""
    from matplotlib import pyplot

    with styled(page.request.look, page.lettering()):
        draw_page(figure, page)
        pyplot.show()
