"""Pictures of the reports, by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..output.report import Report

LEAST_ERROR = 1e-17
"""Least error (rad) that is drawn."""
MARKS = "os^Dv<>pP*Xhd"
COLOURS = {"lagtop": "black", "scipy.special": "#005000", "Taylor": "#7828a0", "RK4": "#c8a000"}
"""Colours by method; others take matplotlib's."""


def methods_figure(report: Report) -> Figure:
    """Return a panel for each scene: error against time, or against the span if there are several.

    A grey step marks the front: no other method is both faster and more accurate.
    """
    from matplotlib.figure import Figure

    rows = [row for row in report.rows if row.error_rad is not None]
    scenes = list(dict.fromkeys(row.scene for row in report.rows))
    names = list(dict.fromkeys(row.method for row in rows))
    is_long = len({row.periods for row in report.rows}) > 1
    wide = min(2, len(scenes))
    size = 5 * wide + 2, 4 * -(-len(scenes) // wide)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(
        -(-len(scenes) // wide), wide, squeeze=False, sharex=True, sharey=True
    ).flat
    for axes, scene in zip(panels, scenes, strict=False):
        mine = [row for row in rows if row.scene == scene]
        front = sorted((r.error_rad, r.ns_per_sample) for r in mine if r.front)
        if front and not is_long:
            x, y = zip(*front, strict=True)
            axes.step(x, y, where="post", color="0.85", lw=6, label="front")
        for name in names:
            points = [
                (r.periods, drawn(r.error_rad))
                if is_long
                else (drawn(r.error_rad), r.ns_per_sample)
                for r in mine
                if r.method == name
            ]
            axes.plot(
                *zip(*sorted(points), strict=True) if points else ([], []), **look(names, name)
            )
        labels = ("span (nutation periods)", "greatest error (rad)")
        if not is_long:
            labels = ("greatest error (rad)", "time per sample (ns)")
        axes.set(xscale="log", yscale="log", title=scene, xlabel=labels[0], ylabel=labels[1])
        axes.grid(True, color="0.9")
    for empty in list(panels):
        empty.set_axis_off()
    handles, texts = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside right upper", fontsize="small")
    return figure


def stability_figure(report: Report) -> Figure:
    """Return a panel for each span: the error of each method by kind, over the input rounding."""
    from matplotlib.figure import Figure

    kinds = list(dict.fromkeys(row.kind for row in report.rows))
    names = list(dict.fromkeys(row.method for row in report.rows))
    spans = sorted({row.periods for row in report.rows})
    figure = Figure(figsize=(6 * len(spans) + 1, 5), layout="constrained")
    panels = figure.subplots(1, len(spans), squeeze=False, sharey=True)[0]
    for axes, span in zip(panels, spans, strict=True):
        mine = [row for row in report.rows if row.periods == span]
        bars = [max(r.input_rounding for r in mine if r.kind == kind) for kind in kinds]
        axes.bar(kinds, bars, color="0.85", label="input rounding")
        for i, name in enumerate(names):
            found = [r for r in mine if r.method == name and r.error_rad is not None]
            x = [kinds.index(r.kind) + 0.12 * (i - len(names) / 2) for r in found]
            y = [drawn(r.error_rad) for r in found]
            axes.plot(x, y, **look(names, name) | {"ls": "none"})
        axes.set(yscale="log", ylim=(LEAST_ERROR, 10), ylabel="greatest error (rad)")
        axes.set_title(f"span of {span:g} T")
        axes.set_xticks(range(len(kinds)), kinds, rotation=40, ha="right")
    handles, texts = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside right upper", fontsize="small")
    return figure


def drawn(error: float) -> float:
    """Return an error that a logarithmic axis can show."""
    return max(error, LEAST_ERROR)


def look(names: list[str], name: str) -> dict[str, Any]:
    """Return the arguments of matplotlib's `plot` for a method."""
    found = {"label": name, "marker": MARKS[names.index(name) % len(MARKS)], "ms": 5}
    return found | ({"color": COLOURS[name]} if name in COLOURS else {})
