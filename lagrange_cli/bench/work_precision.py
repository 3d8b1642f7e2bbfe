"""Error against run time, for every method at the same times: rows, front and conclusions."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..names import check_names
from ..output.report import Report
from ..output.terminal import with_progress
from ..plot.style import LIGHT, plain
from ..solver.solve import Motion
from .measure import ERROR, RUNS, SLOW, Row, Task, looks, measure, panels_of, report_of, task_of
from .methods import METHODS
from .points import COSTS, Point

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PERIODS = 20.3
"""Default span in nutation periods.  It does not end at a turning point, where errors are least."""
LOST = 0.1
"""Error (rad) above which a method no longer follows the motion."""
LEAST = 2.0**-54
"""Error (rad) that stands for 0 in a picture, which has a logarithmic scale."""
SHOWN = "scene method setting periods error_rad ns_per_sample setup_ms evaluations front remark"


def bench(
    scenes: Mapping[str, Motion],
    methods: Sequence[str] | None = None,
    spans: Sequence[float] = (PERIODS,),
    count: int = 10_000,
) -> Report:
    """Compare methods at `count` times over spans in nutation periods.

    Each method runs at all of its settings, or at its tightest one if there are several spans.
    Raises LagtopError for an unknown method, and for a scene that does not nutate.
    """
    names = list(METHODS) if methods is None else check_names("methods", methods, METHODS)
    tasks = [task_of(scene, x, span, count) for scene, x in scenes.items() for span in spans]
    first = 0 if len(spans) == 1 else -1
    runs = [(x, name, y) for x in tasks for name in names for y in METHODS[name].settings[first:]]
    found = [measure(*run) for run in with_progress(runs, "methods")]
    each = len(found) // len(tasks)
    rows = [row for i in range(0, len(found), each) for row in marked(found[i : i + each])]
    said, checked = conclusions(rows, len(spans) > 1), len(tasks[0].exact)
    return report_of(conditions(tasks), SHOWN, checked, rows, said)


def marked(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of a task with its front, the most accurate method first."""
    best = {
        name: min(costs(x) for x in rows if x.method == name)
        for name in {row.method for row in rows}
    }
    found = [
        x._replace(front=x.error_rad is not None and not any(beats(y, x) for y in rows))
        for x in rows
    ]
    return sorted(found, key=lambda x: (best[x.method], x.method, costs(x)))


def costs(row: Row) -> tuple[float, float]:
    """Return the error and the time per sample, infinite without a result."""
    error, ns = row.error_rad, row.ns_per_sample
    return math.inf if error is None else error, math.inf if ns is None else ns


def beats(other: Row, row: Row) -> bool:
    """Return whether another row is both faster and more accurate than a row."""
    return all(map(operator.lt, costs(other), costs(row)))


def conclusions(rows: Sequence[Row], is_long: bool) -> Iterator[str]:
    """Yield the rivals of lagtop, or the growth of errors with the span; and the missing methods.

    Rivals are faster and more accurate.  The exponent of the growth is by least squares.
    """
    for row in rows if not is_long else ():
        if row.method == "lagtop" and row.error_rad is not None:
            others = [x for x in rows if x.scene == row.scene and x.method != "lagtop"]
            names = [f"{x.method} at {x.setting}" for x in others if beats(x, row)]
            said = f"{row.scene}: faster and more accurate than lagtop's {row.setting}"
            yield f"{said}: {', '.join(names) or 'no other method'}."
    for scene, name in dict.fromkeys((row.scene, row.method) for row in rows):
        mine = [x for x in rows if (x.scene, x.method) == (scene, name) and 0 < costs(x)[0] < LOST]
        if is_long and len(mine) > 1:
            x, y = np.log([(x.periods, costs(x)[0]) for x in mine]).T
            yield f"{scene}: the error of {name} grows as span^{np.polyfit(x, y, 1)[0]:.1f}."
    done = {row.method for row in rows if row.error_rad is not None}
    reasons = {row.method: row.remark for row in reversed(rows) if row.method not in done}
    if reasons:
        yield f"Not compared: {', '.join(f'{x} ({y})' for x, y in sorted(reasons.items()))}."


def conditions(tasks: Sequence[Task]) -> dict[str, str]:
    """Return what the figures depend on."""
    scenes = dict.fromkeys(f"{x.scene}: {x.motion.top.as_text()}" for x in tasks)
    spans = [f"{x:g}" for x in dict.fromkeys(x.periods for x in tasks)]
    return {
        "scenes": "; ".join(scenes),
        "times": f"{tasks[0].times.size} from 0 over {', '.join(spans)} nutation "
        f"period{'s' * (spans != ['1'])}",
        "setting": "rtol = atol in the units of the scene; for fixed steps, their number per "
        "nutation period",
        "time": f"CPU, least of up to {RUNS} warm runs, without the set-up; a run of more than "
        f"{SLOW:g} s is ended. RK4 and MuJoCo are sampled at the checked times only",
        "compiled": "Taylor (heyoka) and MuJoCo; SciPy and RK4 call a right-hand side in Python",
        "not timed": "energy, conversion of angles to attitudes, imports",
    }


def methods_figure(
    report: Report, cost: str = "ns_per_sample", points: Sequence[Point] = ()
) -> Figure:
    """Return a panel for each scene: error against cost, or against the span if there are several.

    A line joins the settings of one method.  A grey step marks the front: no other method is both
    faster and more accurate.  Hollow marks are `points` of other programs.  An error of 0 is drawn
    as that of half an ulp of 1.
    """
    scenes = list(dict.fromkeys(row.scene for row in report.rows))
    is_long = len({row.periods for row in report.rows}) > 1
    pair = ("periods", "error_rad") if is_long else ("error_rad", cost)
    wide = min(2, len(scenes))
    figure, panels = panels_of(-(-len(scenes) // wide), wide, 5 * wide + 2, 4)
    for axes, scene in zip(panels, scenes, strict=False):
        rows = [
            row._replace(error_rad=max(row.error_rad, LEAST))
            for row in report.rows
            if row.scene == scene and row.error_rad is not None and getattr(row, cost) is not None
        ]
        front = sorted((row.error_rad, row.ns_per_sample) for row in rows if row.front)
        if front and not is_long and cost == "ns_per_sample":
            steps: dict[str, object] = {"color": LIGHT.faint, "lw": 7, "zorder": 0}
            axes.step(*zip(*front, strict=True), where="post", label="front", **steps)
        for name in dict.fromkeys(x.method for x in rows):
            mine = [x for x in rows if x.method == name]
            pairs = sorted(map(operator.attrgetter(*pair), mine))
            joined = is_long or not isinstance(mine[0].setting, str)
            axes.plot(*zip(*pairs, strict=True), ls="-" if joined else "", **looks()[name])
        for name in dict.fromkeys(x.method for x in points if not is_long):
            others = sorted((max(x.error, LEAST), x.cost) for x in points if x.method == name)
            axes.plot(*zip(*others, strict=True), "o-", mfc="none", lw=0.8, label=plain(name))
        labels = ("span (nutation periods)", ERROR) if is_long else (ERROR, COSTS[cost])
        axes.set(xscale="log", yscale="log", xlabel=labels[0], ylabel=labels[1])
        axes.set_title(plain(scene))
    for empty in panels[len(scenes) :]:
        empty.set_axis_off()
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
    return figure
