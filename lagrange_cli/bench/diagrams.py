"""Pictures of the reports, by matplotlib: work and precision, long spans, error by stratum."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..output.findings import Findings
from ..output.write import write_bytes
from ..plot.style import figure_bytes
from .battery import CONTRACT
from .front import is_done
from .series import Series, series

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEAST_ERROR = 1e-17
LEAST_UNITS = 1e-2
"""Least values that are drawn; an error of 0 stands there."""


def draw_work_precision(findings: Findings, path: str) -> None:
    """Draw error on x and time on y, both as logarithms, a line for each method, and the front."""
    figure, (axes,) = _figure(1)
    rows = [row for row in findings.rows if is_done(row)]
    front = sorted((row.error_max, row.ns_min) for row in rows if row.front)
    if front:
        x, y = _drawable(front)
        axes.step(x, y, where="post", color="0.8", lw=6, zorder=1, label="front")
    for name, look in series(row.method for row in sorted(rows, key=_by_error)).items():
        points = sorted((row.error_max, row.ns_min) for row in rows if row.method == name)
        _line(axes, name, look, points)
    axes.set(xlabel="greatest error (rad)", ylabel="time per sample (ns)")
    axes.set_title(f"Error against run time\ntimes: {findings.conditions['times']}", fontsize=9)
    _save(figure, path)


def draw_long_spans(findings: Findings, path: str) -> None:
    """Draw error and time against the span."""
    figure, (above, below) = _figure(2)
    rows = [row for row in findings.rows if is_done(row)]
    for name, look in series(row.method for row in rows).items():
        mine = [row for row in rows if row.method == name]
        _line(above, name, look, [(row.periods, row.units_max) for row in mine])
        _line(below, name, look, [(row.periods, row.ns_min) for row in mine])
    above.set(xlabel="nutation periods", ylabel="greatest error (units)")
    below.set(xlabel="nutation periods", ylabel="time per sample (ns)")
    title = f"Error and time against the span\ntimes: {findings.conditions['times']}"
    above.set_title(title, fontsize=9)
    _save(figure, path)


def draw_stability(findings: Findings, path: str) -> None:
    """Draw the worst error of each stratum in units, ours and the others'."""
    figure, (axes,) = _figure(1)
    strata = [row.stratum for row in findings.rows]
    axes.set(yscale="linear", yticks=range(len(strata)))
    marks = {
        "lagtop": ("o", "black", [row.angle_units for row in findings.rows]),
        "scipy.special": ("s", "C0", [row.scipy_units for row in findings.rows]),
        "DOP853": ("^", "C1", [row.dop853_units for row in findings.rows]),
    }
    for name, (marker, color, units) in marks.items():
        known = [(max(x, LEAST_UNITS), i) for i, x in enumerate(units) if x is not None]
        if known:
            axes.plot(*zip(*known, strict=True), marker, color=color, label=name)
    axes.axvline(CONTRACT, color="0.5", lw=0.8, label="contract")
    axes.set(xlim=(LEAST_UNITS / 2, None), xlabel="worst error (units)")
    axes.set_yticklabels(strata)
    axes.invert_yaxis()
    axes.set_title(
        f"Error by stratum\nscenes: {findings.conditions['scenes'].partition(';')[0]}", fontsize=9
    )
    _save(figure, path)


def _by_error(row: Any) -> float:
    """Return the error by which methods are sorted within their family."""
    return float(row.error_max)


def _figure(panels: int) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 1 + 4 * panels), layout="constrained")
    axes = figure.subplots(panels, 1, squeeze=False)[:, 0]
    for each in axes:
        each.set(xscale="log", yscale="log")
        each.grid(True, which="major", linewidth=0.4, color="0.85")
    return figure, axes


def _drawable(points: Sequence[tuple[float, float]]) -> list[list[float]]:
    """Return the x and the y of points, none so small that it is not drawn."""
    return [[max(value, LEAST_ERROR) for value in axis] for axis in zip(*points, strict=True)]


def _line(axes: Axes, name: str, look: Series, points: Sequence[tuple[float, float]]) -> None:
    """Draw the line of a method."""
    x, y = _drawable(points)
    axes.plot(x, y, label=name, **look.look())


def _save(figure: Figure, path: str) -> None:
    """Write the figure with its legend; the same findings give the same file."""
    for axes in figure.axes[:1]:
        axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1, 0.5))
    write_bytes(path, lambda: figure_bytes(figure, Path(path).suffix.lower()[1:], 150))
