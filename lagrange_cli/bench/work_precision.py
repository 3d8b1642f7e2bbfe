"""Error against run time, for every method at the same times: rows, front and conclusions."""

from __future__ import annotations

import math
import operator
import platform
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..names import check_names
from ..output.report import Field, Report, short
from ..output.terminal import Progress, silent
from ..solver.facts import Regime
from ..solver.solve import Motion
from .methods import METHODS, SlowError, attitudes
from .reference import Attitude, Reference, inputs_of, rotation_angle

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PERIODS = 20.3
"""Default span in nutation periods.  It does not end at a turning point, where errors are least."""
CHECKED = 51
"""Number of times that are compared with the reference, the last one among them."""
RUNS, SECONDS_OF_RUNS, LIMIT = 9, 0.3, 3.0
"""Most warm runs, the CPU seconds after which they end, and the limit of one run."""
ROUNDING, LOST = 1e-11, 0.1
"""Errors (rad) between which an order of convergence is measured."""


ERROR = "greatest error (rad)"
LOOKS = {
    name: {"label": name, "marker": mark, "ms": 5, "color": f"C{i}"}
    for i, (name, mark) in enumerate(zip(METHODS, "os^Dv<>pP*", strict=True))
}
"""The arguments of matplotlib's `plot` for each method."""


class Row(NamedTuple):
    """One method at one setting, in one scene and over one span."""

    scene: str
    method: str
    setting: float | str
    periods: float
    error_rad: float | None = None
    """Greatest rotation from the exact to the computed attitude."""
    ns_per_sample: float | None = None
    """The least CPU time of warm runs, without the set-up."""
    setup_ms: float | None = None
    """CPU time until the first sample of a new top can be computed."""
    evaluations: int | None = None
    order: float | None = None
    """Observed order of a method with fixed steps, between this setting and the one before it."""
    front: bool = False
    """Whether no other row of the scene and span is both faster and more accurate."""
    remark: str | None = None


FIELDS = [
    Field("scene", "scene", is_text=True),
    Field("method", "method", is_text=True),
    Field("setting", "setting"),
    Field("periods", "periods", "{:g}".format),
    Field("error_rad", "error", short),
    Field("ns_per_sample", "ns/sample", "{:.0f}".format),
    Field("setup_ms", "set-up ms", "{:.1f}".format),
    Field("evaluations", "evaluations"),
    Field("order", "order", "{:.1f}".format),
    Field("front", "front", lambda front: "*" if front else ""),
    Field("remark", "remark", is_text=True),
]


class Task(NamedTuple):
    """Times of one scene, and the exact attitudes at some of them."""

    scene: str
    motion: Motion
    periods: float
    times: Array
    exact: dict[int, Attitude]
    """The exact attitudes, by the index of their time."""


def bench(
    scenes: Mapping[str, Motion],
    methods: Sequence[str] | None = None,
    spans: Sequence[float] = (PERIODS,),
    count: int = 10_000,
    progress: Progress = silent,
) -> Report:
    """Compare methods at `count` times over spans in nutation periods.

    Each method runs at all of its settings, or at its tightest one if there are several spans.
    Raises LagtopError for an unknown method, and for a scene that does not nutate.
    """
    names = list(METHODS) if methods is None else check_names("methods", methods, METHODS)
    tasks = [task_of(scene, x, span, count) for scene, x in scenes.items() for span in spans]
    first = 0 if len(spans) == 1 else -1
    runs = [(x, name, y) for x in tasks for name in names for y in METHODS[name].settings[first:]]
    found = [measure(*run) for run in progress(runs, "methods")]
    each = len(found) // len(tasks)
    rows = [row for i in range(0, len(found), each) for row in marked(found[i : i + each])]
    return Report(conditions(tasks), FIELDS, rows, [*conclusions(rows, len(spans) > 1)])


def exact_motion(motion: Motion) -> Reference:
    """Return the reference of a motion; raise LagtopError if it cannot check the motion."""
    if motion.regime not in (Regime.REGULAR, Regime.NO_SPIN):
        raise LagtopError(f"the scene must nutate, got {motion.regime.value}")
    try:
        return Reference(inputs_of(motion.top))
    except ZeroDivisionError:
        raise LagtopError("the axis must not pass exactly through the vertical") from None


def task_of(scene: str, motion: Motion, periods: float, count: int) -> Task:
    """Return `count` times from 0 over a span (only its end if 1), with exact attitudes."""
    reference = exact_motion(motion)
    end = periods * float(reference.T)
    times = np.linspace(0.0, end, count) if count > 1 else np.array([end])
    checked = np.linspace(0, count - 1, min(CHECKED, count)).round().astype(int).tolist()
    return Task(scene, motion, periods, times, {i: reference.attitude(times[i]) for i in checked})


def measure(
    task: Task, name: str, setting: float | str, limit: float = LIMIT, runs: int = RUNS
) -> Row:
    """Return the error and the times of one method; a remark states why it has none."""
    row, method = Row(task.scene, name, setting, task.periods), METHODS[name]
    checked = list(task.exact)
    times = task.times[checked] if method.has_fixed_steps else task.times
    setups, seconds = list[float](), list[float]()
    try:
        with np.errstate(all="ignore"):  # numbers that are not finite have an infinite error
            while len(setups) < min(2, runs):  # the first one may import
                begun = time.process_time()
                sample = method.prepare(task.motion, setting)
                setups.append(time.process_time() - begun)
            while not seconds or (len(seconds) <= runs and sum(seconds) <= SECONDS_OF_RUNS):
                begun = time.process_time()
                columns, evaluations = sample(times, limit)
                seconds.append(time.process_time() - begun)
            found = attitudes(columns)
    except SlowError:
        return row._replace(remark=f"too slow: more than {limit:g} s")
    except ImportError as failure:
        return row._replace(remark=f"not installed: pip install {failure.name}")
    except (LagtopError, ArithmeticError, ValueError) as failure:
        return row._replace(remark=f"failed: {failure}")
    at_checked = found if method.has_fixed_steps else found[checked]
    error = max(map(rotation_angle, at_checked.tolist(), task.exact.values()))
    if not math.isfinite(error):
        return row._replace(remark="failed: numbers are not finite")
    return row._replace(
        error_rad=error,
        ns_per_sample=min(seconds[1:] or seconds) / task.times.size * 1e9,
        setup_ms=min(setups) * 1e3,
        evaluations=evaluations,
    )


def marked(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of a task with orders and front, the most accurate method first."""
    best = {
        name: min(costs(x) for x in rows if x.method == name)
        for name in {row.method for row in rows}
    }
    found = [
        row._replace(
            front=row.error_rad is not None and not any(beats(x, row) for x in rows),
            order=order_between(before, row),
        )
        for before, row in zip([rows[0], *rows], rows, strict=False)
    ]
    return sorted(found, key=lambda x: (best[x.method], x.method, costs(x)))


def costs(row: Row) -> tuple[float, float]:
    """Return the error and the time per sample, infinite without a result."""
    error, ns = row.error_rad, row.ns_per_sample
    return math.inf if error is None else error, math.inf if ns is None else ns


def beats(other: Row, row: Row) -> bool:
    """Return whether another row is both faster and more accurate than a row."""
    return all(map(operator.lt, costs(other), costs(row)))


def order_between(before: Row, row: Row) -> float | None:
    """Return the exponent by which the error of fixed steps falls with their number."""
    large, small = costs(before)[0], costs(row)[0]
    has_steps = before.method == row.method and METHODS[row.method].has_fixed_steps
    if not (has_steps and ROUNDING < small < large < LOST):
        return None
    return math.log(large / small) / math.log(float(row.setting) / float(before.setting))


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


def machine() -> dict[str, str]:
    """Return the processor with its vector instructions, and the versions of all packages."""
    names, versions = ["unknown processor"], [f"Python {platform.python_version()}"]
    with suppress(OSError), open("/proc/cpuinfo", encoding="utf-8") as lines:
        names += [line.partition(":")[2].strip() for line in lines if "model name" in line]
    vector = np.show_config(mode="dicts").get("SIMD Extensions", {}).get("found", [])
    for name in ("lagtop", "numpy", "scipy", "mpmath", "heyoka", "mujoco"):
        try:
            versions.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            versions.append(f"no {name}")
    system = f"{platform.system()} {platform.machine()}"
    parts = names[-1], system, *(vector or ["unknown vector instructions"])[-1:]
    return {"machine": ", ".join(parts), "versions": ", ".join(versions)}


def conditions(tasks: Sequence[Task]) -> dict[str, str]:
    """Return what the figures depend on."""
    scenes = dict.fromkeys(f"{x.scene}: {x.motion.top.options()}" for x in tasks)
    spans = dict.fromkeys(f"{x.periods:g}" for x in tasks)
    return machine() | {
        "scenes": "; ".join(scenes),
        "times": f"{tasks[0].times.size} from 0 over {', '.join(spans)} nutation periods",
        "error": "greatest rotation (rad) from the exact to the computed attitude, at "
        f"{len(tasks[0].exact)} of the times; the reference is Legendre's third integral "
        "in 50 digits of mpmath",
        "setting": "rtol = atol in the units of the scene; of fixed steps, their number per "
        "nutation period",
        "time": f"CPU, least of up to {RUNS} warm runs, without the set-up; a run of more than "
        f"{LIMIT:g} s is ended. RK4 and MuJoCo are sampled at the checked times only",
        "compiled": "Taylor (heyoka) and MuJoCo; SciPy and RK4 call a right-hand side in Python",
        "not timed": "energy, conversion of lagtop's angles to attitudes, imports",
    }


def methods_figure(report: Report) -> Figure:
    """Return a panel for each scene: error against time, or against the span if there are several.

    A grey step marks the front: no other method is both faster and more accurate.
    """
    scenes = list(dict.fromkeys(row.scene for row in report.rows))
    is_long = len({row.periods for row in report.rows}) > 1
    wide = min(2, len(scenes))
    figure, panels = panels_of(-(-len(scenes) // wide), wide, 5 * wide + 2, 4)
    for axes, scene in zip(panels, scenes, strict=False):
        rows = [x for x in report.rows if x.scene == scene and x.error_rad is not None]
        front = sorted((row.error_rad, row.ns_per_sample) for row in rows if row.front)
        if front and not is_long:
            axes.step(*zip(*front, strict=True), where="post", color="0.85", lw=6, label="front")
        for name, look in LOOKS.items():
            mine = sorted((x.periods, drawn(x), x.ns_per_sample) for x in rows if x.method == name)
            if mine:
                spans, errors, times = zip(*mine, strict=True)
                axes.plot(*((spans, errors) if is_long else (errors, times)), **look)
        labels = ("span (nutation periods)", ERROR) if is_long else (ERROR, "time per sample (ns)")
        axes.set(xscale="log", yscale="log", title=scene, xlabel=labels[0], ylabel=labels[1])
        axes.grid(True, color="0.9")
    for empty in panels[len(scenes) :]:
        empty.set_axis_off()
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
    return figure


def panels_of(rows: int, columns: int, width: float, height: float) -> tuple[Figure, list[Any]]:
    """Return a figure, `width` inches wide, with panels of a height that share their axes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height * rows), layout="constrained")
    return figure, [*figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).flat]


def drawn(row: Any) -> float:
    """Return the error of a row, or the least error that is drawn."""
    return float(max(row.error_rad, 1e-17))
