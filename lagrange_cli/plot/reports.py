"""The pictures of reports: errors of compared trajectories, and the data of a fit."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..inverse.decay import decay_of, decay_text
from ..inverse.outcome import Outcome
from ..solver.keys import shown_keys
from .pictures import scale
from .style import LIGHT, plain

FAILED = "#b00020"
"""The colour of the title of a failed fit."""


def draw_errors(
    results: Sequence[Any],
    limit: float,
    errors: Sequence[float | None] = (),
    figure: Figure | None = None,
) -> Figure:
    """Draw the error of each comparison over time, and the limit, and return the figure.

    If the comparisons have steps, a second panel shows the `errors` over them.
    """
    pairs = zip(results, errors, strict=False)
    steps = [(x.step, error) for x, error in pairs if x.step and error and error < np.inf]
    figure = figure or Figure(figsize=(10.0 if steps else 7.5, 4.6))
    over_time, *over_step = figure.subplots(1, 2 if steps else 1, squeeze=False)[0]
    shades = scale(LIGHT)(np.linspace(0, 1, len(results)))
    for x, colour, dashes in zip(results, shades, cycle(("-", "--", "-.", ":"))):
        shown = np.where(x.error > 0, x.error, np.nan)  # 0 and NaN have no logarithm
        name = plain(str(x.file or "trajectory"))
        over_time.plot(x.t, shown, lw=1.2, color=colour, ls=dashes, label=name)
    positive = [x.error[x.error > 0] for x in results]
    if least := [np.quantile(x, 0.05) for x in positive if x.size]:
        over_time.set_ylim(bottom=0.1 * min(least))  # not down to the rounding errors of a row
    over_time.axhline(limit, color=LIGHT.quiet, lw=0.8, ls=":", label="limit")
    over_time.set(yscale="log", xlabel="t (units of the trajectory)", ylabel="error (rad)")
    over_time.set_title("Error over time")
    over_time.legend(loc="upper left", bbox_to_anchor=(0, -0.14), ncols=2)
    for axes in over_step:
        draw_convergence(axes, sorted(steps))
    return figure


def draw_convergence(axes: Axes, points: Sequence[tuple[float, float]]) -> None:
    """Draw error over step, with the slopes of orders 1, 2 and 4 from the coarsest step."""
    steps, errors = zip(*points, strict=True)
    axes.plot(steps, errors, "o-", color=LIGHT.lines[0], ms=7)
    quiet: dict[str, Any] = {"color": LIGHT.quiet}
    for order in (1, 2, 4):
        end = errors[-1] * (steps[0] / steps[-1]) ** order
        axes.plot([steps[-1], steps[0]], [errors[-1], end], lw=0.7, ls=":", **quiet)
        place = (steps[0], end), (2, -9)
        axes.annotate(f"order {order}", *place, textcoords="offset points", size=8, **quiet)
    axes.set(xscale="log", yscale="log", xlabel="step (units of the trajectory)")
    axes.set(ylabel="error (rad)", title="Convergence")
    axes.set_xticks(steps, [f"{x:g}" for x in steps], rotation=30)
    axes.set_xticks([], minor=True)


def time_label(outcome: Outcome) -> str:
    """Return the label of the times of a recording, in seconds if known inputs have units."""
    return f"t ({'s' if outcome.units.si else outcome.recording.time_unit})"


def result_of(outcome: Outcome) -> str:
    """Return the verdict of a fit and its main numbers, with units if known inputs have them."""
    found = {x: outcome.numbers[x] for x in ("a", "b", "r0", "A", "C") if x in outcome.numbers}
    shown = {x: number for x, number in found.items() if x in "AC" or not {"A", "C"} <= {*found}}
    units = shown_keys(outcome.units)
    named = [
        f"{x} = {number} {units[x].unit if outcome.units.si else ''}".rstrip()
        for x, number in (shown | {x: found[x] for x in found if x == "r0"}).items()
    ]
    return ",  ".join([outcome.title, *named])


def draw_fit(outcome: Outcome, figure: Figure | None = None) -> Figure:
    """Draw each channel of a recording with the fit, and its residuals below.

    The title is the result.  That of a failed fit is red, and its curve is dashed.
    """
    curves, is_good = [*outcome.curves()], not outcome.failures()
    rows, unit = len(curves), outcome.units.angle
    figure = figure or Figure(figsize=(8.0, 1.0 + 2.8 * rows))
    fit, dashes = ("fit", "-") if is_good else ("failed fit", (0, (4, 3)))
    grid = figure.subplots(2 * rows, squeeze=False, sharex="col", height_ratios=[3, 1] * rows)
    for curve, above, below in zip(curves, grid[::2, 0], grid[1::2, 0], strict=True):
        number = ("theta", "phi", "psi").index(curve.name)
        symbol, colour = "ϑφψ"[number], LIGHT.lines[number]
        above.plot(curve.t, curve.data, ".", ms=4, color=LIGHT.ink, label="data")
        above.plot(curve.fine_t, curve.curve, lw=1.2, color=colour, label=fit, ls=dashes, alpha=0.8)
        above.set(ylabel=f"{symbol} ({unit})")
        above.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        below.axhline(0, lw=0.8, color=LIGHT.quiet)
        below.plot(curve.t, curve.residual, ".", ms=3, color=colour)
        below.set(ylabel=f"residual\n({unit})")
    grid[-1, 0].set_xlabel(time_label(outcome))
    colour = LIGHT.ink if is_good else FAILED
    figure.suptitle(plain(result_of(outcome)), x=0.012, ha="left", color=colour, wrap=True)
    return figure


def draw_decay(outcomes: Sequence[Outcome]) -> Figure:
    """Draw the spin of each window that is good, and the exponential through them."""
    figure, decay = Figure(figsize=(7.5, 4.6)), decay_of(outcomes)
    axes = figure.subplots()
    name = decay.quantity if decay else "b"
    found = [(x.recording.middle, *x.numbers[name][:2]) for x in outcomes if name in x.numbers]
    t, values, stds = zip(*found, strict=True) if found else ((), (), ())
    axes.errorbar(t, values, stds, fmt="o", ms=4, color=LIGHT.ink, label="windows")
    if decay:
        curve = [decay.value(x) for x in t]
        axes.plot(t, curve, lw=1.2, color=LIGHT.lines[1], label="exponential")
    axes.set_xlabel(time_label(outcomes[0]))
    axes.set_ylabel(f"{name} ({'rad/s' if outcomes[0].units.si else 'rad per unit of time'})")
    axes.set_title(plain(decay_text(outcomes)), loc="left", size=9)
    axes.legend()
    return figure
