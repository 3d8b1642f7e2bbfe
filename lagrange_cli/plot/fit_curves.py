"""The picture of a fit: the data, the motion that was found, and what is left."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from .files import About, figure_bytes
from .style import LIGHT, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..arithmetic.types import Array


class FittedCurve(NamedTuple):
    """One channel of a recording, and the motion that was found, in the unit of the labels."""

    name: str
    t: Array
    data: Array
    """What was measured; NaN where it is missing."""
    fine_t: Array
    curve: Array
    """The motion at the fine times."""
    left: Array
    """Data less motion at the times t."""


def draw_fit(curves: Sequence[FittedCurve], unit: str, path: str) -> bytes:
    """Return the picture in the format of the name of its file."""
    from matplotlib.figure import Figure

    with styled(LIGHT, 0.9):
        figure = Figure(figsize=(7.5, 1.0 + 3.0 * len(curves)), layout="constrained")
        draw_fit_panels(figure, curves, unit)
        names = ", ".join(curve.name for curve in curves)
        about = About("lagtop fit", f"Data, the motion that was found, and what is left: {names}")
        return figure_bytes(figure, Path(path).suffix.lower()[1:], 150, about)


def draw_fit_panels(figure: Figure, curves: Sequence[FittedCurve], unit: str) -> None:
    """Draw two panels for each channel: data on the curve, and below it what is left."""
    panels = figure.subplots(
        2 * len(curves), 1, squeeze=False, sharex=True, height_ratios=[3, 1] * len(curves)
    )[:, 0]
    for i, curve in enumerate(curves):
        above, below = panels[2 * i], panels[2 * i + 1]
        colour = LIGHT.lines[i % len(LIGHT.lines)]
        above.plot(curve.fine_t, curve.curve, lw=1.2, color=colour, label="fit")
        above.plot(curve.t, curve.data, ".", ms=3, color=LIGHT.ink, label="data")
        above.set(ylabel=f"{curve.name} ({unit})")
        below.axhline(0, lw=0.8, color=LIGHT.quiet)
        below.plot(curve.t, curve.left, ".", ms=3, color=colour)
        below.set(ylabel="left")
    panels[0].legend(fontsize=8, ncols=2)
    panels[-1].set(xlabel="time")
