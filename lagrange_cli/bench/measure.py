"""The error and the run time of one method in one scene: tasks, rows and their columns."""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from importlib.metadata import distributions
from itertools import cycle
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError, install
from ..output.report import Field, Report, fields_of, short
from ..plot.style import LIGHT, plain
from ..solver.solve import Motion
from .methods import METHODS, SlowError, attitudes
from .reference import Quaternion, exact_motion, rotation_angle

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CHECKED = 51
"""Number of times that are compared with the reference, the last one among them."""
RUNS, SECONDS_OF_RUNS, SLOW = 9, 0.3, 3.0
"""Most warm runs, the CPU seconds after which they end, and the limit of one run."""
ERROR = "greatest error (rad)"


class Row(NamedTuple):
    """One method at one setting, in one scene and over one span; None is an unknown number."""

    scene: str
    """The name of the scene, or its kind."""
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
    front: bool = False
    """Whether no other row of the scene and span is both faster and more accurate."""
    input_rounding: float | None = None
    """Greatest rotation (rad) that half an ulp of each input causes, added over the inputs."""
    verdict: str | None = None
    inputs: str | None = None
    """The inputs of the scene, if `scene` is a kind."""
    remark: str | None = None


COLUMNS = (
    *(Field(x, x, is_text=True) for x in ("scene", "method", "verdict", "remark")),
    Field("setting", "setting"),
    Field("periods", "periods", "{:g}".format),
    Field("error_rad", "error", short),
    Field("ns_per_sample", "ns/sample", "{:.0f}".format),
    Field("setup_ms", "set-up ms", "{:.1f}".format),
    Field("evaluations", "evaluations"),
    Field("front", "front", lambda front: "*" if front else ""),
    Field("input_rounding", "input rounding", short),
)
"""The columns of both tables; other keys are in CSV and JSON only."""


def report_of(
    conditions: dict[str, str], keys: str, checked: int, rows: Sequence[Row], said: Iterable[str]
) -> Report:
    """Return a report with some columns of the rows, whose errors are those at `checked` times."""
    error = (
        f"greatest rotation (rad) from the exact to the computed attitude, at {checked} of the "
        "times; the reference is Legendre's third integral in 50 digits of mpmath"
    )
    about = machine() | conditions | {"error": error}
    return Report(about, fields_of(keys.split(), *COLUMNS), rows, [*said])


class Task(NamedTuple):
    """Times of one scene, and the exact attitudes at some of them."""

    scene: str
    motion: Motion
    periods: float
    times: Array
    exact: dict[int, Quaternion]
    """The exact attitudes, by the index of their time."""


def task_of(scene: str, motion: Motion, periods: float, count: int) -> Task:
    """Return `count` times from 0 over a span (only its end if 1), with exact attitudes."""
    reference = exact_motion(motion)
    end = periods * float(reference.T)
    times = np.linspace(0.0, end, count) if count > 1 else np.array([end])
    checked = np.linspace(0, count - 1, min(CHECKED, count)).round().astype(int).tolist()
    return Task(scene, motion, periods, times, {i: reference.attitude(times[i]) for i in checked})


def measure(
    task: Task, name: str, setting: float | str, limit: float = SLOW, runs: int = RUNS
) -> Row:
    """Return the error and the times of one method; a remark states why it has none."""
    row, method = Row(task.scene, name, setting, task.periods), METHODS[name]
    checked = list(task.exact)
    times = task.times[checked] if method.has_fixed_steps else task.times
    setups, seconds = list[float](), list[float]()

    def ended(verdict: str, why: object) -> Row:
        return row._replace(verdict=verdict, remark=f"{verdict}: {why}")

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
        return ended("too slow", f"more than {limit:g} s")
    except ImportError as failure:
        remedy = install("bench") if failure.name == "heyoka" else f"pip install {failure.name}"
        return ended("not installed", remedy)
    except (LagtopError, ArithmeticError, ValueError) as failure:
        return ended("failed", failure)
    at_checked = found if method.has_fixed_steps else found[checked]
    error = max(map(rotation_angle, at_checked.tolist(), task.exact.values()))
    if not math.isfinite(error):
        return ended("failed", "numbers are not finite")
    return row._replace(
        error_rad=error,
        ns_per_sample=min(seconds[1:] or seconds) / task.times.size * 1e9,
        setup_ms=min(setups) * 1e3,
        evaluations=evaluations,
    )


def machine() -> dict[str, str]:
    """Return the processor with its vector instructions, and the versions of all packages."""
    names, versions = ["unknown processor"], [f"Python {platform.python_version()}"]
    with suppress(OSError), open("/proc/cpuinfo", encoding="utf-8") as lines:
        names += [line.partition(":")[2].strip() for line in lines if "model name" in line]
    vector = np.show_config(mode="dicts").get("SIMD Extensions", {}).get("found", [])
    found = {x.name: x.version for x in distributions()}
    for name in ("lagtop", "numpy", "scipy", "mpmath", "heyoka", "mujoco"):
        versions.append(f"{name} {found[name]}" if name in found else f"no {name}")
    system = f"{platform.system()} {platform.machine()}"
    parts = names[-1], system, *(vector or ["unknown vector instructions"])[-1:]
    return {"machine": ", ".join(parts), "versions": ", ".join(versions)}


def looks() -> dict[str, dict[str, Any]]:
    """Return the arguments of matplotlib's `plot` for each method."""
    colours = cycle((*LIGHT.lines, LIGHT.ink, LIGHT.quiet))
    each = zip(METHODS, cycle("os^Dv<>pP*"), colours, strict=False)
    return {x: {"label": plain(x), "marker": y, "color": z, "ms": 5, "lw": 1.2} for x, y, z in each}


def panels_of(rows: int, columns: int, width: float, height: float) -> tuple[Figure, list[Any]]:
    """Return a figure, `width` inches wide, with panels of a height that share their axes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height * rows), layout="constrained")
    panels = [*figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).flat]
    for axes in panels:
        axes.grid(visible=True, color=LIGHT.faint)
        axes.tick_params(labelbottom=True)
    return figure, panels
