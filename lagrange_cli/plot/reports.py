"""The pictures of reports: errors of compared trajectories, and the data of a fit."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import CannotWriteError, LagtopError, check_type
from .style import LIGHT, About, figure_bytes, require_matplotlib, scale, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..arithmetic.types import Array
    from ..fits.record import Outcome
    from ..fits.report import FittedCurve

REPORT_KINDS = (".svg", ".png")
"""File types of the pictures of reports."""


def report_bytes(figure: Figure, path: str, about: About) -> bytes:
    """Return the figure of a report in the format given by its file name."""
    return figure_bytes(figure, Path(path).suffix.lower()[1:], 150, about)


def check_plot(path: str | None, output: str) -> None:
    """Raise LagtopError for an unsupported file type, or for the file of the report itself.

    Raises UnavailableError if matplotlib is missing, and CannotWriteError if the directory does not
    exist.
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


def _report(
    path: str, size: tuple[float, float], about: About, draw: Callable[[Figure], None]
) -> bytes:
    """Return a picture of a size (inches) in the format given by its file name."""
    from matplotlib.figure import Figure

    with styled(LIGHT, 0.9):
        figure = Figure(figsize=size, layout="constrained")
        draw(figure)
        return report_bytes(figure, path, about)


def _names(curves: Sequence[ErrorCurve] | Sequence[FittedCurve]) -> str:
    return ", ".join(curve.name for curve in curves)


class ErrorCurve(NamedTuple):
    """Errors of one trajectory."""

    name: str
    t: Array
    error: Array
    """Errors in radians at the times t; NaN where the trajectory is lost."""
    step: float | None = None
    compared: float | None = None
    """Error used in the convergence plot."""

    @property
    def has_step(self) -> bool:
        """Whether there is a positive error at a positive step, as a logarithmic plot needs."""
        return bool(self.step and self.compared and math.isfinite(self.compared))


def draw_errors(curves: Sequence[ErrorCurve], limit: float, path: str) -> bytes:
    """Return the picture of errors in the format given by its file name."""
    size = 10 if any(curve.has_step for curve in curves) else 7.5, 4.6
    about = About("lagtop compare: error over time", f"Errors of {_names(curves)} in radians.")
    return _report(path, size, about, lambda figure: draw_error_panels(figure, curves, limit))


def draw_error_panels(figure: Figure, curves: Sequence[ErrorCurve], limit: float) -> None:
    """Draw a line over time for each trajectory, the first ones darker, and the limit.

    If the trajectories have steps, a second panel shows the error of each over its step.
    """
    import numpy as np

    stepped = [curve for curve in curves if curve.has_step]
    over_time, *over_step = figure.subplots(1, 2 if stepped else 1, squeeze=False)[0]
    shades = scale(LIGHT)([i / max(len(curves) - 1, 1) for i in range(len(curves))])
    colors = {curve.name: shade for curve, shade in zip(curves, shades, strict=True)}
    for curve, dashes in zip(curves, cycle(("-", "--", "-.", ":"))):
        positive = np.where(curve.error > 0, curve.error, np.nan)  # 0 and NaN have no logarithm
        colour = colors[curve.name]
        over_time.plot(curve.t, positive, lw=1.2, label=curve.name, color=colour, ls=dashes)
    over_time.axhline(limit, color=LIGHT.quiet, lw=0.8)
    over_time.set(yscale="log", xlabel="time", ylabel="error (rad)")
    over_time.set_title("Error over time")
    over_time.legend(fontsize=8)
    for axes in over_step:
        _draw_convergence(axes, stepped, colors)


def _draw_convergence(
    axes: Axes, curves: Sequence[ErrorCurve], colors: Mapping[str, Array]
) -> None:
    """Draw error over step, with the slopes of orders 1, 2 and 4 from the coarsest step."""
    how: dict[str, Any] = {"textcoords": "offset points", "fontsize": 8, "color": LIGHT.quiet}
    points = {curve.name: (curve.step or 0.0, curve.compared or 0.0) for curve in curves}
    for (name, point), mark in zip(points.items(), cycle("os^Dv<>pP*X")):
        axes.plot(*point, mark, color=colors[name], ms=7)
    step, error = max(points.values())
    finest = min(points.values())[0]
    for order in (1, 2, 4):
        ends = [error, error * (finest / step) ** order]
        axes.plot([step, finest], ends, color=LIGHT.quiet, lw=0.7, ls=":")
        axes.annotate(f"order {order}", (finest, ends[1]), (2, -9), **how)
    axes.set(xscale="log", yscale="log", xlabel="step", ylabel="error (rad)")
    steps = sorted({step for step, _ in points.values()})
    axes.set_xticks(steps, [f"{step:g}" for step in steps], rotation=30)
    axes.set_xticks([], minor=True)
    axes.set_title("Convergence")


def draw_fit(curves: Sequence[FittedCurve], unit: str, path: str) -> bytes:
    """Return the picture of a fit in the format given by its file name."""
    size = 7.5, 1.0 + 3.0 * len(curves)
    about = About("lagtop fit", f"Data, fitted motion and residuals: {_names(curves)}")
    return _report(path, size, about, lambda figure: draw_fit_panels(figure, curves, unit))


def draw_outcome(outcome: Outcome, figure: Figure | None = None) -> Figure:
    """Draw data, motion and residuals of a fit, on a figure or a new one, and return the figure.

    Angles are in degrees, or in radians if the fit was made so.  Raises UnavailableError without
    matplotlib.

    >>> t = np.linspace(0, 2, 100)
    >>> theta, phi, psi = solve(Top()).angles(t)
    >>> len(draw_outcome(fit(t, theta=theta, psi=psi)).axes)
    4
    """
    from ..fits.record import Outcome  # start-up
    from ..fits.report import curves_of  # start-up

    check_type("outcome", outcome, Outcome)
    figure = figure or new_figure()
    draw_fit_panels(figure, list(curves_of(outcome)), outcome.angle)
    return figure


def new_figure() -> Figure:
    """Return a new figure of pyplot, which a notebook shows.  Raises UnavailableError."""
    require_matplotlib()
    from matplotlib import pyplot  # only here: files need no pyplot

    return pyplot.figure(layout="constrained")


def draw_fit_panels(figure: Figure, curves: Sequence[FittedCurve], unit: str) -> None:
    """Draw two panels for each channel: the data with the curve, and the residuals below."""
    panels = figure.subplots(
        2 * len(curves), 1, squeeze=False, sharex=True, height_ratios=[3, 1] * len(curves)
    )[:, 0]
    for i, curve in enumerate(curves):
        above, below = panels[2 * i], panels[2 * i + 1]
        recording, _, angle = curve.name.rpartition(": ")
        number = ("theta", "phi", "psi").index(angle)
        symbol, colour = "ϑφψ"[number], LIGHT.lines[number]
        above.plot(curve.fine_t, curve.curve, lw=1.2, color=colour, label="fit")
        above.plot(curve.t, curve.data, ".", ms=3, color=LIGHT.ink, label="data")
        above.set(ylabel=f"{symbol} ({unit})", title=recording)
        below.axhline(0, lw=0.8, color=LIGHT.quiet)
        below.plot(curve.t, curve.residual, ".", ms=3, color=colour)
        below.set(ylabel="residual")
    panels[0].legend(fontsize=8, ncols=2)
    panels[-1].set(xlabel="time")
