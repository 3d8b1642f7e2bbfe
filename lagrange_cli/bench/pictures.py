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
ERROR, TIME, SPAN = "greatest error (rad)", "time per sample (ns)", "span (nutation periods)"


def methods_figure(report: Report) -> Figure:
    """Return a panel for each scene: error against time, or against the span if there are several.

    A grey step marks the front: no other method is both faster and more accurate.
    """
    rows = [row for row in report.rows if row.error_rad is not None]
    scenes = list(dict.fromkeys(row.scene for row in report.rows))
    is_long = len({row.periods for row in report.rows}) > 1
    wide = min(2, len(scenes))
    figure, panels = panels_of(-(-len(scenes) // wide), wide, 5 * wide + 2, 4)
    for axes, scene in zip(panels, scenes, strict=False):
        mine = [row for row in rows if row.scene == scene]
        front = sorted((r.error_rad, r.ns_per_sample) for r in mine if r.front)
        if front and not is_long:
            axes.step(*zip(*front, strict=True), where="post", color="0.85", lw=6, label="front")
        for name, look in looks(rows):
            found = [r for r in mine if r.method == name]
            errors = [max(r.error_rad, LEAST_ERROR) for r in found]
            spans, times = [r.periods for r in found], [r.ns_per_sample for r in found]
            points = sorted(zip(*((spans, errors) if is_long else (errors, times)), strict=True))
            axes.plot([x for x, _ in points], [y for _, y in points], **look)
        axes.set(xscale="log", yscale="log", title=scene)
        axes.set(xlabel=SPAN if is_long else ERROR, ylabel=ERROR if is_long else TIME)
        axes.grid(True, color="0.9")
    for empty in panels[len(scenes) :]:
        empty.set_axis_off()
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
    return figure


def stability_figure(report: Report) -> Figure:
    """Return a panel for each span: the error of each method by kind, over the input rounding."""
    kinds = list(dict.fromkeys(row.kind for row in report.rows))
    spans = sorted({row.periods for row in report.rows})
    figure, panels = panels_of(1, len(spans), 6 * len(spans) + 1, 5)
    for axes, span in zip(panels, spans, strict=True):
        mine = [row for row in report.rows if row.periods == span]
        bars = [max(r.input_rounding for r in mine if r.kind == kind) for kind in kinds]
        axes.bar(kinds, bars, color="0.85", label="input rounding")
        for i, (name, look) in enumerate(looks(report.rows)):
            found = [r for r in mine if r.method == name and r.error_rad is not None]
            x = [kinds.index(r.kind) + 0.12 * (i - 2.5) for r in found]
            axes.plot(x, [max(r.error_rad, LEAST_ERROR) for r in found], ls="none", **look)
        axes.set(yscale="log", ylim=(LEAST_ERROR, 10), ylabel=ERROR, title=f"span of {span:g} T")
        axes.set_xticks(range(len(kinds)), kinds, rotation=40, ha="right")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
    return figure


def panels_of(rows: int, columns: int, width: float, height: float) -> tuple[Figure, list[Any]]:
    """Return a figure, `width` inches wide, with panels of a height that share their axes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height * rows), layout="constrained")
    return figure, [*figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).flat]


def looks(rows: Any) -> list[tuple[str, dict[str, Any]]]:
    """Return the methods of some rows, each with its arguments of matplotlib's `plot`."""
    names = dict.fromkeys(row.method for row in rows)
    found = [(x, {"label": x, "marker": y, "ms": 5}) for x, y in zip(names, MARKS, strict=False)]
    return [(x, y | ({"color": COLOURS[x]} if x in COLOURS else {})) for x, y in found]
