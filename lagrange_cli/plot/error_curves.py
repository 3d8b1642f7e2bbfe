"""The picture of trajectories that were judged: error over time, and over the step."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from .files import About, figure_bytes
from .style import LIGHT, scale, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..arithmetic.types import Array

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

    @property
    def has_step(self) -> bool:
        """Whether there is an error over a step that logarithms have."""
        return bool(self.step and self.compared and math.isfinite(self.compared))


def draw_errors(curves: Sequence[ErrorCurve], limit: float, path: str) -> bytes:
    """Return the picture in the format of the name of its file."""
    from matplotlib.figure import Figure

    with_steps = any(curve.has_step for curve in curves)
    with styled(LIGHT, 0.9):
        figure = Figure(figsize=(10 if with_steps else 7.5, 4.6), layout="constrained")
        draw_error_panels(figure, curves, limit)
        names = ", ".join(curve.name for curve in curves)
        about = About("lagtop compare: error over time", f"Errors of {names} in radians.")
        return figure_bytes(figure, Path(path).suffix.lower()[1:], 150, about)


def draw_error_panels(figure: Figure, curves: Sequence[ErrorCurve], limit: float) -> None:
    """Draw a line over time for each trajectory, darker for the first ones, and the limit.

    Beside it, where there are steps, is the error of each over its step.
    """
    stepped = [curve for curve in curves if curve.has_step]
    over_time, *over_step = figure.subplots(1, 2 if stepped else 1, squeeze=False)[0]
    shades = scale(LIGHT)([i / max(len(curves) - 1, 1) for i in range(len(curves))])
    colors = {curve.name: shade for curve, shade in zip(curves, shades, strict=True)}
    for i, curve in enumerate(curves):
        look = {"color": colors[curve.name], "ls": _DASHES[i % len(_DASHES)]}
        over_time.plot(curve.t, curve.positive(), lw=1.2, label=curve.name, **look)
    over_time.axhline(limit, color=LIGHT.quiet, lw=0.8)
    over_time.set(yscale="log", xlabel="time", ylabel="error (rad)")
    over_time.set_title("Error over time")
    over_time.legend(fontsize=8)
    for axes in over_step:
        _draw_convergence(axes, stepped, colors)


def _draw_convergence(
    axes: Axes, curves: Sequence[ErrorCurve], colors: Mapping[str, Array]
) -> None:
    """Draw error over step, with the slopes of the orders 1, 2 and 4 from the coarsest."""
    points = {curve.name: (curve.step or 0.0, curve.compared or 0.0) for curve in curves}
    for i, (name, point) in enumerate(points.items()):
        axes.plot(*point, _MARKS[i % len(_MARKS)], color=colors[name], ms=7)
    step, error = max(points.values())
    finest = min(points.values())[0]
    for order in (1, 2, 4):
        ends = [error, error * (finest / step) ** order]
        axes.plot([step, finest], ends, color=LIGHT.quiet, lw=0.7, ls=":")
        axes.annotate(
            *(f"order {order}", (finest, ends[1])),
            xytext=(2, -9),
            textcoords="offset points",
            fontsize=8,
            color=LIGHT.quiet,
        )
    axes.set(xscale="log", yscale="log", xlabel="step", ylabel="error (rad)")
    steps = sorted({step for step, _ in points.values()})
    axes.set_xticks(steps, [f"{step:g}" for step in steps], rotation=30)
    axes.set_xticks([], minor=True)
    axes.set_title("Convergence")
