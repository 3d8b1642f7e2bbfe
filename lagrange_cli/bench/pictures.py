"""Pictures of the reports, by matplotlib: work and precision, long spans, error by stratum.

A family of methods has one hue, and each method has its own mark.  A search has maximised the
distances of the hues from each other, from black and from white.  It covers normal, protan, deutan
and tritan vision, and a test simulates these.  Marks distinguish methods within a family, and all
methods in prints without colour.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from ..output.destination import write_bytes
from ..output.report import Report
from ..plot.reports import report_bytes
from ..plot.style import LIGHT, About, head, styled
from .closed_forms import CLOSED_FORMS
from .measure import all_methods
from .method import OURS, is_done

if TYPE_CHECKING:
    from matplotlib.artist import Artist
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

_LABELS = {
    "error_rad": "greatest error (rad)",
    "ns_min": "time per sample (ns)",
    "periods": "nutation periods",
}
_AT_ONCE, _OVER_SPANS = [("error_rad", "ns_min")], [("periods", "error_rad"), ("periods", "ns_min")]
"""Columns on x and y of the panels of a scene."""
_NOTE: dict[str, Any] = {"va": "top", "fontsize": "x-small", "linespacing": 1.1}


def draw_methods(findings: Report, path: str, *, is_long: bool = False) -> None:
    """Draw error and time against each other, with the front, or both against the span.

    Each scene has a panel, or two.
    """
    from matplotlib.lines import Line2D

    rows = sorted((row for row in findings.rows if is_done(row)), key=lambda row: row.error_rad)
    scenes = dict.fromkeys(row.scene for row in findings.rows)
    pairs = _OVER_SPANS if is_long else _AT_ONCE
    panels = [(scene, *pair) for scene in scenes for pair in pairs]
    front = Line2D([], [], color="0.85", lw=6, label="front: none is faster\nand more accurate")
    with styled(LIGHT, LETTERS):
        figure, grid = _panels(len(panels), min(2, len(panels)), (5.5, 4.5), kinds=len(pairs))
        looks = method_looks(row.method for row in rows)
        for axes, (scene, x, y) in zip(grid, panels, strict=True):
            mine = [row for row in rows if row.scene == scene]
            best = [(row.error_rad, row.ns_min) for row in mine if row.front]
            if best:
                axes.step(*_drawable(best), where="post", color="0.85", lw=6, zorder=1)
            for name, look in looks.items():
                points = [(getattr(r, x), getattr(r, y)) for r in mine if r.method == name]
                _line(axes, look, sorted(points))
            title = scene if len(scenes) > 1 else f"times: {findings.conditions['times']}"
            axes.set_title(title, fontsize="small", color=LIGHT.quiet)
            axes.grid(True, which="major", linewidth=0.4, color="0.85")
            axes.set(xlabel=_LABELS[x], ylabel=_LABELS[y])
        title = "Error and time against the span" if is_long else "Error against run time"
        _save(figure, path, title, findings, looks, *([] if is_long else [front]))


def draw_stability(findings: Report, path: str) -> None:
    """Draw error against time, a panel for each stratum, with the condition as a grey band."""
    from matplotlib.patches import Patch

    strata = list(dict.fromkeys(row.stratum for row in findings.rows))
    with styled(LIGHT, LETTERS):
        figure, grid = _panels(len(strata), min(3, len(strata)), (3.2, 2.4))
        looks = method_looks(dict.fromkeys(row.method for row in findings.rows))
        for axes, name in zip(grid, strata, strict=True):
            runs = [row.run for row in findings.rows if row.stratum == name and row.run]
            for run in runs:
                _line(axes, looks[run.method], [(t, min(x, MOST_ERROR)) for t, x in run.points])
            if runs:
                t, bound = zip(*runs[0].bounds, strict=True)
                most = [min(x, MOST_ERROR) for x in bound]
                axes.fill_between(t, LEAST_ERROR, most, color="0.85")
            lost = [_stem(run.method) for run in runs if run.verdict == "lost"]
            words = "\n".join(["lost:", *lost]) if lost else ""
            axes.text(0.03, 0.96, words, transform=axes.transAxes, **_NOTE)
            axes.set_title(name, fontsize="medium")
            axes.minorticks_off()
            axes.set(ylim=(LEAST_ERROR, 2 * MOST_ERROR), xlabel=_LABELS["periods"])
        figure.supylabel("error of the attitude (rad)")
        band = Patch(color="0.85", label="condition")
        _save(figure, path, "Error against time by stratum", findings, looks, band)


def _panels(
    count: int, columns: int, size: tuple[float, float], *, kinds: int = 1
) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels of a size (inches), with logarithmic axes.

    Every panel shares its axes with those of its kind; kinds take turns.
    """
    from matplotlib.figure import Figure

    lines = -(-count // columns)
    figure = Figure(figsize=(size[0] * columns + 2.5, size[1] * lines + 1), layout="constrained")
    grid: list[Axes] = []
    for i in range(count):
        first = grid[i % kinds] if i >= kinds else None
        grid.append(figure.add_subplot(lines, columns, i + 1, sharex=first, sharey=first))
        grid[-1].set(xscale="log", yscale="log")
    return figure, grid


def _drawable(points: Sequence[tuple[float, float]]) -> list[list[float]]:
    """Return the x and the y of points, with values below the least drawn ones raised to them."""
    return [[max(value, LEAST_ERROR) for value in axis] for axis in zip(*points, strict=True)]


def _line(axes: Axes, look: MethodLook, points: Sequence[tuple[float, float]]) -> None:
    """Draw the line of a method; errors beyond the left edge are written at the edge."""
    if points:
        axes.plot(*_drawable(points), **look.look())
    beyond = [point for point in points if point[0] < LEAST_ERROR]
    if beyond:
        errors = ", ".join(f"{error:.0e}" for error, _ in sorted(beyond))
        place = LEAST_ERROR, max(height for _, height in beyond)
        how: dict[str, Any] = {"textcoords": "offset points", "size": "small"}
        axes.annotate(f"← {errors}: beyond this edge", place, (-6, 7), **how)


def _save(
    figure: Figure,
    path: str,
    title: str,
    findings: Report,
    looks: Mapping[str, MethodLook],
    *others: Artist,
) -> None:
    """Write the figure with its legend; the same findings give the same file."""
    from matplotlib.lines import Line2D

    head(figure, title)
    lines = [Line2D([], [], label=name, **look.look()) for name, look in looks.items()]
    figure.legend(handles=[*lines, *others], loc="outside right upper", fontsize="small")
    text = "; ".join(f"{name}: {line}" for name, line in findings.conditions.items())
    about = About(f"lagtop: {title}", text)
    write_bytes(path, lambda: report_bytes(figure, path, about))


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
