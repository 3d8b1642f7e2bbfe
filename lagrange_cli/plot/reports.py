"""The pictures of reports: errors of compared trajectories, and the data of a fit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import cycle
from typing import TYPE_CHECKING, Any, NamedTuple

from .style import LIGHT, figure_bytes, plain, require_matplotlib, scale, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..arithmetic.types import Array
    from ..fit.outcome import Curve

MOST_RECORDINGS = 3
"""Most recordings on one sheet."""


def report_picture(
    path: str, size: tuple[float, float], title: str, draw: Callable[[Figure], None]
) -> bytes:
    """Return a picture of a size (inches) in the format given by its file name."""
    from matplotlib.figure import Figure

    with styled(LIGHT):
        figure = Figure(figsize=size)
        draw(figure)
        return figure_bytes(figure, path.rpartition(".")[2].lower(), 150, title, title)


def new_figure() -> Figure:
    """Return a new figure of pyplot, which a notebook shows.  Raises UnavailableError."""
    require_matplotlib()
    from matplotlib import pyplot  # only here: files need no pyplot

    return pyplot.figure(layout="constrained")


class ErrorCurve(NamedTuple):
    """Errors of one trajectory."""

    name: str
    t: Array
    error: Array
    """Errors in radians at the times t; NaN where the trajectory is lost."""
    step: float | None = None
    compared: float | None = None
    """Error used in the convergence plot."""


def draw_errors(curves: Sequence[ErrorCurve], limit: float, path: str) -> bytes:
    """Return the picture of errors in the format given by its file name."""
    size = (10.0 if any(curve.step for curve in curves) else 7.5), 4.6
    title = "lagtop compare: error (rad) over time"
    return report_picture(path, size, title, lambda x: draw_error_panels(x, curves, limit))


def draw_error_panels(figure: Figure, curves: Sequence[ErrorCurve], limit: float) -> None:
    """Draw a line over time for each trajectory, and the limit.

    If the trajectories have steps, a second panel shows the error of each over its step.
    """
    import numpy as np

    steps = [(x.step, x.compared) for x in curves if x.step and x.compared and x.compared < np.inf]
    over_time, *over_step = figure.subplots(1, 2 if steps else 1, squeeze=False)[0]
    shades = scale(LIGHT)(np.linspace(0, 1, len(curves)))
    for curve, colour, dashes in zip(curves, shades, cycle(("-", "--", "-.", ":"))):
        positive = np.where(curve.error > 0, curve.error, np.nan)  # 0 and NaN have no logarithm
        name = plain(curve.name)
        over_time.plot(curve.t, positive, lw=1.2, color=colour, ls=dashes, label=name)
    over_time.axhline(limit, color=LIGHT.quiet, lw=0.8, ls=":", label="--max-error")
    over_time.set(yscale="log", xlabel="t (units of the trajectory)", ylabel="error (rad)")
    over_time.set_title("Error over time")
    over_time.legend(loc="upper left", bbox_to_anchor=(0, -0.14), ncols=2)
    for axes in over_step:
        draw_convergence(axes, sorted(steps))


def draw_convergence(axes: Axes, points: Sequence[tuple[float, float]]) -> None:
    """Draw error over step, with the slopes of orders 1, 2 and 4 from the coarsest step."""
    steps, errors = zip(*points, strict=True)
    axes.plot(steps, errors, "o-", color=LIGHT.lines[0], ms=7)
    quiet: dict[str, Any] = {"color": LIGHT.quiet}
    for order in (1, 2, 4):
        end = errors[-1] * (steps[0] / steps[-1]) ** order
        axes.plot([steps[-1], steps[0]], [errors[-1], end], lw=0.7, ls=":", **quiet)
        axes.annotate(
            f"order {order}", (steps[0], end), (2, -9), textcoords="offset points", size=8, **quiet
        )
    axes.set(xscale="log", yscale="log", xlabel="step (units of the trajectory)")
    axes.set(ylabel="error (rad)", title="Convergence")
    axes.set_xticks(steps, [f"{x:g}" for x in steps], rotation=30)
    axes.set_xticks([], minor=True)


def draw_fit(curves: Sequence[Curve], unit: str, path: str, title: str = "") -> bytes:
    """Return the picture of the fits of at most three recordings, in the format of the file name.

    `unit` is that of the angles.
    """
    names = list(dict.fromkeys(curve.name.rpartition(": ")[0] for curve in curves))
    kept = [x for x in curves if x.name.rpartition(": ")[0] in names[:MOST_RECORDINGS]]
    return report_picture(
        path,
        (8.0, 1.0 + 2.8 * len(kept)),
        "lagtop fit: data, fitted motion and residuals",
        lambda figure: draw_fit_panels(figure, kept, unit, title),
    )


def draw_outcome(outcome: Any, figure: Figure | None = None) -> Figure:
    """Draw data, motion and residuals of a fit, on a figure or a new one, and return the figure.

    Angles are in degrees, or in radians if the fit was made so.  Raises UnavailableError without
    matplotlib.

    >>> t = np.linspace(0, 2, 100)
    >>> theta, phi, psi = solve(Top()).angles(t)
    >>> len(draw_outcome(fit(t, theta=theta, psi=psi)).axes)
    4
    """
    figure = figure or new_figure()
    draw_fit_panels(figure, list(outcome.curves()), outcome.angle)
    return figure


def draw_fit_panels(figure: Figure, curves: Sequence[Curve], unit: str, title: str = "") -> None:
    """Draw two panels for each channel: the data with the curve, and the residuals below."""
    panels = figure.subplots(
        2 * len(curves), 1, squeeze=False, sharex="col", height_ratios=[3, 1] * len(curves)
    )[:, 0]
    for curve, above, below in zip(curves, panels[::2], panels[1::2], strict=True):
        recording, _, angle = curve.name.rpartition(": ")
        number = ("theta", "phi", "psi").index(angle)
        symbol, colour = "ϑφψ"[number], LIGHT.lines[number]
        above.plot(curve.t, curve.data, ".", ms=4, color=LIGHT.ink, label="data")
        above.plot(curve.fine_t, curve.curve, lw=1.2, color=colour, label="fit", alpha=0.8)
        above.set(ylabel=f"{symbol} ({unit})", title=plain(recording))
        above.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        below.axhline(0, lw=0.8, color=LIGHT.quiet)
        below.plot(curve.t, curve.residual, ".", ms=3, color=colour)
        below.set(ylabel=f"residual\n({unit})")
    panels[-1].set(xlabel="t (units of the recording)")
    if title:
        figure.suptitle(plain(title), x=0.012, ha="left")
