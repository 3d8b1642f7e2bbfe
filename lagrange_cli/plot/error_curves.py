"""The picture of trajectories that were judged: error over time, and over the step."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from .style import LIGHT, figure_bytes, scale, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..arithmetic.types import Array

LEAST = 1e-17
"""Least error that is drawn over the step; one of 0 stands there."""
_DASHES = ("-", "--", "-.", ":")
_MARKS = "os^Dv<>pP*X"


class ErrorCurve(NamedTuple):
    """Errors of one trajectory."""

    name: str
    t: Array
    error: Array
    """Errors in radians at the times t; NaN where it is lost."""
    step: float | None = None
    compared: float | None = None
    """Error that goes with the step."""

    def positive(self) -> Array:
        """Return the errors that a logarithm has; where it has none, as at the start, a gap."""
        import numpy as np

        errors: Array = np.where(self.error > 0, self.error, np.nan)
        return errors


def draw_errors(curves: Sequence[ErrorCurve], limit: float, path: str) -> bytes:
    """Return the picture in the format of the name of its file.

    Over time there is a line for each trajectory, darker for the first one; beside it, where there
    are steps, its error over the step.
    """
    from matplotlib.figure import Figure

    has_steps = any(curve.compared for curve in curves)
    with styled(LIGHT, 0.9):
        figure = Figure(figsize=(10 if has_steps else 7.5, 4.6), layout="constrained")
        over_time, *over_step = figure.subplots(1, 2 if has_steps else 1, squeeze=False)[0]
        colors = scale(LIGHT)([i / max(len(curves) - 1, 1) for i in range(len(curves))])
        for i, curve in enumerate(curves):
            look = {"color": colors[i], "ls": _DASHES[i % len(_DASHES)]}
            over_time.plot(curve.t, curve.positive(), lw=1.2, label=curve.name, **look)
        over_time.axhline(limit, color=LIGHT.quiet, lw=0.8)
        over_time.set(yscale="log", xlabel="time", ylabel="error (rad)")
        over_time.set_title("Error over time")
        over_time.legend(fontsize=8)
        for axes in over_step:
            _draw_convergence(axes, curves, colors)
        return figure_bytes(figure, Path(path).suffix.lower()[1:], 150)


def _draw_convergence(axes: Axes, curves: Sequence[ErrorCurve], colors: Array) -> None:
    """Draw error over step, with the slopes of the orders 1, 2 and 4 beside the coarsest."""
    points = [(x.step, max(x.compared, LEAST)) for x in curves if x.step and x.compared]
    for i, curve in enumerate(curves):
        if curve.step and curve.compared:
            mark = _MARKS[i % len(_MARKS)]
            axes.plot(curve.step, max(curve.compared, LEAST), mark, color=colors[i], ms=7)
    step, error = max(points)
    finest = min(points)[0]
    for order in (1, 2, 4):
        ends = [error, max(error * (finest / step) ** order, LEAST)]
        axes.plot([step, finest], ends, color=LIGHT.quiet, lw=0.7, ls=":")
        axes.annotate(
            *(f"order {order}", (finest, ends[1])),
            xytext=(2, -9),
            textcoords="offset points",
            fontsize=8,
            color=LIGHT.quiet,
        )
    axes.set(xscale="log", yscale="log", xlabel="step", ylabel="error (rad)")
    axes.set_title("Convergence")
