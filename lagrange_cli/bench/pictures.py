"""Pictures of the reports, by matplotlib: work and precision, long spans, error by stratum.

A family of methods has one hue, and each method has its own mark.  A search has maximised the
distances of the hues from each other, from black and from white.  It covers normal, protan, deutan
and tritan vision, and a test simulates these.  Marks distinguish methods within a family, and all
methods in prints without colour.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..output.destination import write_bytes
from ..output.report import Report
from ..plot.files import About, figure_bytes
from ..plot.style import LIGHT, head, styled
from .closed_forms import CLOSED_FORMS
from .measure import all_methods
from .method import OURS, is_done

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEAST_ERROR = 1e-17
"""Least error (rad) that is drawn; smaller errors are written at the edge."""
MOST_ERROR = 3.2
"""Half a turn, the greatest possible error of an attitude."""
LETTERS = 0.85
"""Font size relative to that of `lagtop plot`."""
HUES = {
    OURS: LIGHT.ink,
    "closed forms": "#005000",
    "scipy": "#c8a000",
    "heyoka": "#7828a0",
    "mujoco": "#2800eb",
    "exudyn": "#eb5078",
    "pybullet": "#00c8eb",
    "drake": "#780050",
}
"""Colours of the families, in the order of the legend."""
SHAPES = "os^Dv<>pP*Xhd"
"""Marks, used first filled, then empty."""


def draw_work_precision(findings: Report, path: str) -> None:
    """Draw error on x and time on y, both as logarithms, a line for each method, and the front."""
    with styled(LIGHT, LETTERS):
        figure, (axes,) = _figure(1)
        rows = [row for row in findings.rows if is_done(row)]
        front = sorted((row.error_rad, row.ns_min) for row in rows if row.front)
        if front:
            x, y = _drawable(front)
            label = "front: none is faster\nand more accurate"
            axes.step(x, y, where="post", color="0.85", lw=6, zorder=1, label=label)
        for name, look in method_looks(row.method for row in sorted(rows, key=_by_error)).items():
            points = sorted((row.error_rad, row.ns_min) for row in rows if row.method == name)
            _line(axes, name, look, points)
        axes.set(xlabel="greatest error (rad)", ylabel="time per sample (ns)")
        _save(figure, path, "Error against run time", findings)


def draw_long_spans(findings: Report, path: str) -> None:
    """Draw error and time against the span."""
    with styled(LIGHT, LETTERS):
        figure, (above, below) = _figure(2)
        rows = [row for row in findings.rows if is_done(row)]
        for name, look in method_looks(row.method for row in rows).items():
            mine = [row for row in rows if row.method == name]
            _line(above, name, look, [(row.periods, row.error_rad) for row in mine])
            _line(below, name, look, [(row.periods, row.ns_min) for row in mine])
        above.set(xlabel="nutation periods", ylabel="greatest error (rad)")
        below.set(xlabel="nutation periods", ylabel="time per sample (ns)")
        _save(figure, path, "Error and time against the span", findings)


def draw_stability(findings: Report, path: str) -> None:
    """Draw error against time, a panel for each stratum, with the condition as a grey band."""
    import numpy as np
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    with styled(LIGHT, LETTERS):
        strata = list(dict.fromkeys(row.stratum for row in findings.rows))
        columns = min(len(strata), 3)
        lines = -(-len(strata) // columns)
        figure = Figure(figsize=(3.2 * columns + 1, 2.4 * lines + 1.4), layout="constrained")
        grid = figure.subplots(lines, columns, squeeze=False, sharex=True, sharey=True).flat
        looks = method_looks(dict.fromkeys(row.method for row in findings.rows))
        for axes, name in zip(grid, strata, strict=False):
            runs = [x.run for x in findings.rows if x.stratum == name and x.run]
            for run in runs:
                points = [(t, min(max(x, LEAST_ERROR), MOST_ERROR)) for t, x in run.points]
                if points:
                    axes.plot(*zip(*points, strict=True), **looks[run.method].look())
            if runs:
                t, bound = zip(*runs[0].bounds, strict=True)
                axes.fill_between(t, LEAST_ERROR, np.minimum(bound, MOST_ERROR), color="0.85")
            axes.set(xscale="log", yscale="log", ylim=(LEAST_ERROR, 2 * MOST_ERROR))
            axes.set_title(name, fontsize="medium")
        for i, axes in enumerate(figure.axes):
            axes.set_visible(i < len(strata))
            if i >= len(strata) - columns:
                axes.set_xlabel("nutation periods")
                axes.tick_params(labelbottom=True)
        lines_of = [Line2D([], [], label=name, **look.look()) for name, look in looks.items()]
        band = Patch(color="0.85", label="condition")
        figure.legend(handles=[*lines_of, band], loc="outside lower center", ncols=4)
        figure.supylabel("error of the attitude (rad)")
        _save(figure, path, "Error against time by stratum", findings)


def _by_error(row: Any) -> float:
    """Return the error by which methods are sorted within their family."""
    return float(row.error_rad)


def _figure(panels: int) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 1 + 4 * panels), layout="constrained")
    axes = figure.subplots(panels, 1, squeeze=False)[:, 0]
    for each in axes:
        each.set(xscale="log", yscale="log")
        each.grid(True, which="major", linewidth=0.4, color="0.85")
    return figure, axes


def _drawable(points: Sequence[tuple[float, float]]) -> list[list[float]]:
    """Return the x and the y of points, with values below the least drawn ones raised to them."""
    return [[max(value, LEAST_ERROR) for value in axis] for axis in zip(*points, strict=True)]


def _line(axes: Axes, name: str, look: MethodLook, points: Sequence[tuple[float, float]]) -> None:
    """Draw the line of a method; errors beyond the left edge are written at the edge."""
    x, y = _drawable(points)
    axes.plot(x, y, label=name, **look.look())
    beyond = [point for point in points if point[0] < LEAST_ERROR]
    if beyond:
        errors = ", ".join(f"{error:.0e}" for error, _ in sorted(beyond))
        place = LEAST_ERROR, max(height for _, height in beyond)
        how: dict[str, Any] = {"textcoords": "offset points", "size": "small"}
        axes.annotate(f"← {errors}: beyond this edge", place, (-6, 7), **how)


def _save(figure: Figure, path: str, title: str, findings: Report) -> None:
    """Write the figure with its legend; the same findings give the same file."""
    head(figure, title)
    if times := findings.conditions.get("times"):
        axes = figure.axes[0]
        axes.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1, 1))
        axes.set_title(f"times: {times}", fontsize="small", color=LIGHT.quiet)
    text = "; ".join(f"{name}: {line}" for name, line in findings.conditions.items())
    about = About(f"lagtop: {title}", text)
    write_bytes(path, lambda: figure_bytes(figure, Path(path).suffix.lower()[1:], 150, about))


class MethodLook(NamedTuple):
    """The look of the line of a method."""

    family: str
    mark: str
    is_filled: bool
    is_dashed: bool

    def look(self) -> dict[str, Any]:
        """Return the arguments of matplotlib's `plot`."""
        color = HUES.get(self.family, LIGHT.quiet)
        return {
            "color": color,
            "marker": self.mark,
            "markerfacecolor": color if self.is_filled else LIGHT.paper,
            "ls": "--" if self.is_dashed else "-",
            "lw": 2 if self.family == OURS else 1,
            "ms": 5,
        }


def method_looks(names: Iterable[str]) -> dict[str, MethodLook]:
    """Return the look of each method, by name, in the order of the legend.

    The two forms of an integrator share a mark; the line of the form in Euler angles is dashed.
    """
    order = [*HUES, ""]
    listed = sorted(names, key=lambda name: order.index(_family(name)))
    marks = {stem: i for i, stem in enumerate(dict.fromkeys(map(_stem, listed)))}
    found = {}
    for name in listed:
        again, shape = divmod(marks[_stem(name)], len(SHAPES))
        is_dashed = _stem(name) != name and name.endswith("-euler")
        found[name] = MethodLook(_family(name), SHAPES[shape], not again, is_dashed)
    return found


def _family(name: str) -> str:
    """Return the family of a method; "" for an unknown method."""
    method = all_methods(1.0).get(name)
    if name.startswith(OURS):
        return OURS
    if name in CLOSED_FORMS:
        return "closed forms"
    if not method:
        return ""
    return method.engine or method.package.partition(".")[0] or "scipy"  # RK4 is also in Python


def _stem(name: str) -> str:
    """Return the name of an integrator without its form, and any other name as it is."""
    if _family(name) not in {"scipy", "heyoka", ""}:
        return name
    return name.removesuffix("-euler").removesuffix("-quaternion")
