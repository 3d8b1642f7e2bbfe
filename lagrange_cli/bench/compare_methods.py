"""Error against run time, at the same times and over longer spans: rows, front and conclusions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ..motion.solve import Motion
from ..output.report import Field, Report, fields_of, short
from ..output.terminal import Progress, silent
from .integrators import STEPS_PER_SECOND
from .measure import (
    JUDGED,
    RUNS,
    SECONDS_OF_RUNS,
    Task,
    common_conditions,
    measure,
    reference_period,
    task,
)
from .method import OURS, Method, MethodRow, is_done, is_out

PERIODS = 20.3
"""Default span in nutation periods."""
SPANS = [10.0**power + 0.3 for power in range(7)]
"""Growing spans.  None ends at a turning point, at which approximations are best."""
_JUDGED_IN_A_SPAN = 21

ROUNDING, LOST = 1e-11, 0.1
"""Errors (rad) between which the order of a method is measured."""
VARIABLE_ORDER = ("LSODA", "Taylor")
"""Methods with variable order."""
METHOD_FIELDS = fields_of(
    MethodRow._fields,
    Field("scene", "scene", is_text=True, names_the_row=True),
    Field("method", "method", is_text=True, names_the_row=True),
    Field("setting", "setting", names_the_row=True),
    Field("periods", "periods", lambda periods: f"{periods:.0e}"),
    Field("error_rad", "max error", short),
    Field("error_end", "at the end", short),
    Field("units_max", "units", short),
    Field("evaluations", "evaluations"),
    Field("steps", "steps"),
    Field("order", "order", lambda order: f"{order:.1f}"),
    Field("setup_s", "set-up ms", lambda seconds: f"{1000 * seconds:.1f}"),
    Field("ns_min", "ns/sample", lambda ns: f"{ns:.0f}"),
    Field("ns_median", "median", lambda ns: f"{ns:.0f}"),
    Field("runs", "runs"),
    Field("front", "front", lambda front: "*" if front else ""),
    Field("remark", "remark", is_text=True),
)
_ONLY_OF_ONE_SPAN = {"steps", "order", "setup_s", "ns_median", "front"}
"""Columns of a table that the report over growing spans leaves out."""


def compare_methods(
    scenes: Mapping[str | None, Motion],
    methods: dict[str, Method],
    count: int,
    *,
    t_max: float | None = None,
    limit: float,
    is_long: bool = False,
    progress: Progress = silent,
) -> Report:
    """Return the report on every method at every setting, or at its tightest one over long spans.

    Raises LagtopError as `task` does.
    """
    spans, judged = (SPANS, _JUDGED_IN_A_SPAN) if is_long else ([PERIODS], JUDGED)
    how: dict[str, Any] = {"judged": judged, "progress": progress}
    tasks = []
    for scene, motion in scenes.items():
        ends = [x * reference_period(motion) for x in spans] if t_max is None else [t_max]
        tasks.append([task(motion, end, count, scene=scene, **how) for end in ends])
    rows, lines, hidden = [], [], _ONLY_OF_ONE_SPAN if is_long else {"periods"}
    for scene, of_scene in zip(scenes, tasks, strict=True):
        found = _rows(of_scene, methods, is_long, progress)
        if not is_long:
            found = with_front(with_order(found))
        rows += found
        said = _growth(found) if is_long else conclusions(found, methods)
        lines += [line if len(scenes) == 1 else f"{scene}: {line}" for line in said]
    if len(scenes) == 1:
        hidden = {*hidden, "scene"}
    fields = [x._replace(heading="") if x.key in hidden else x for x in METHOD_FIELDS]
    return Report(conditions([of_scene[-1] for of_scene in tasks], limit), fields, rows, lines)


def _rows(
    tasks: Sequence[Task], methods: dict[str, Method], is_long: bool, progress: Progress
) -> list[MethodRow]:
    """Return the measured rows of a scene; a method that fails in a span is run in no longer one.

    A method that does not apply has one row.
    """
    runs = [
        (name, work, setting)
        for name, method in methods.items()
        for work in tasks
        for setting in (method.settings[-1:] if is_long else method.settings)
    ]
    rows: list[MethodRow] = []
    for name, work, setting in progress(runs, "methods"):
        before = rows[-1] if rows and rows[-1].method == name else None
        if before and is_out(before.remark):
            continue
        if is_long and before and not is_done(before):
            remark = "not run: it failed over a shorter span"
            rows.append(MethodRow(work.scene, name, setting, work.periods, remark=remark))
        else:
            rows.append(measure(work, name, methods[name], setting))
    return rows


def conditions(tasks: Sequence[Task], limit: float) -> dict[str, str]:
    """Return all conditions that the figures depend on, from the last task of each scene."""

    def each(text: Callable[[Task], str]) -> str:
        named = len(tasks) > 1
        return "; ".join(f"{x.scene}: {text(x)}" if named else text(x) for x in tasks)

    return common_conditions(max(x.agreement for x in tasks)) | {
        "scene": each(lambda x: x.motion.top.options()),
        "regime": each(lambda x: f"{x.motion.regime.value}, nutation period {x.motion.T_nutation}"),
        "times": each(
            lambda x: (
                f"{x.times.size} from 0 to {float(x.times[-1])} ({x.periods:.6g} nutation periods)"
            )
        ),
        "setting": "rtol = atol, in radians and in the units of the scene; of RK4 and of engines "
        "without error control, steps per nutation period",
        "order": "fall of the error with the evaluations, between the last two settings with an "
        f"error of {ROUNDING:g} to {LOST:g} rad; none of a method that varies its order",
        "error": f"radians, greatest of the three angles at {len(tasks[0].exact)} of the times, "
        "the last among them",
        "units": "the same over eps (max(1, |angle|) + |tau rate|), tau the time since the nearest "
        "whole period",
        "turns": "compared unwrapped, but modulo 2 pi for quaternion forms",
        "time": f"one thread; after a warm-up, of memory too, least and median of up to {RUNS} "
        f"runs (of one where it takes {SECONDS_OF_RUNS} s)",
        "exceptions": f"a run of {limit:g} s fails (of heyoka, one of {limit * STEPS_PER_SECOND:g} "
        "steps); lagtop-digits runs at the judged times only, "
        "set-up included",
    }


def _growth(rows: Sequence[MethodRow]) -> Iterator[str]:
    """Yield the growth of error and time over the spans of each method, and missing methods."""
    for name in dict.fromkeys(row.method for row in rows):
        done = [row for row in rows if row.method == name and is_done(row)]
        if done:
            first, last = done[0], done[-1]
            growth = growth_of([(row.periods, row.error_rad or 0) for row in done])
            yield (
                f"{name}: error in units {first.units_max:.1e} over {first.periods:.0e} periods, "
                f"{last.units_max:.1e} over {last.periods:.0e}"
                + ("" if growth is None else f"; in radians it grows as t^{growth:.1f}")
                + f"; time a sample {(last.ns_min or 0) / (first.ns_min or 1):.1f} times as long"
            )
    yield from not_compared(rows)


def growth_of(errors: Sequence[tuple[float, float]]) -> float | None:
    """Return the exponent p of errors that grow as t^p, by least squares; None for fewer than two.

    Each element is a time and an error; errors of 0 or beyond 0.1 rad do not count.
    """
    known = np.log([(t, error) for t, error in errors if 0 < error < LOST])
    return float(np.polyfit(known[:, 0], known[:, 1], 1)[0]) if len(known) > 1 else None


def with_order(rows: Sequence[MethodRow]) -> list[MethodRow]:
    """Return the rows with the observed order of each method whose evaluations are known."""
    orders: dict[str, float] = {}
    for name in dict.fromkeys(row.method for row in rows):
        work = [
            (math.log(row.evaluations), math.log(error))
            for row in rows
            if row.method == name and row.evaluations
            if ROUNDING < (error := row.error_rad or 0) < LOST
        ]
        (few, large), (many, small) = work[-2:] if len(work) > 1 else [(0.0, 0.0)] * 2
        if many > few and not name.startswith(VARIABLE_ORDER):
            orders[name] = (large - small) / (many - few)
    return [row._replace(order=orders.get(row.method)) for row in rows]


def with_front(rows: Sequence[MethodRow]) -> list[MethodRow]:
    """Return the rows by method and error, with the Pareto front of error and time marked.

    The method with the least error is the first.
    """

    def error(row: MethodRow) -> float:
        return math.inf if row.error_rad is None else row.error_rad

    best = {
        name: min(error(x) for x in rows if x.method == name) for name in {x.method for x in rows}
    }
    rows = sorted(rows, key=lambda row: (best[row.method], row.method, error(row)))
    return [row._replace(front=is_done(row) and not rivals(row, rows)) for row in rows]


def rivals(row: MethodRow, rows: Iterable[MethodRow]) -> list[MethodRow]:
    """Return the rows at least as fast and accurate as a row, and better in one of both."""
    mine = (row.error_rad, row.ns_min)
    return [
        other
        for other in rows
        if is_done(other)
        and (theirs := (other.error_rad, other.ns_min)) != mine
        and all(x <= y for x, y in zip(theirs, mine, strict=True))  # type: ignore[operator]
    ]


def conclusions(rows: Sequence[MethodRow], methods: Mapping[str, Method]) -> Iterator[str]:
    """Yield sentences on methods that beat lagtop in doubles, and on missing methods."""
    done = {row.method for row in rows if is_done(row)}
    others = [name for name in methods if name in done and name != OURS]
    outside = any(methods[name].package for name in others)
    for row in rows:
        if row.method == OURS and is_done(row):
            better = rivals(row, rows)
            for other in better:
                yield (
                    f"{other.method} at {other.setting} beats {OURS}: {other.error_rad:.1e} rad in "
                    f"{other.ns_min:.0f} ns against {row.error_rad:.1e} rad in {row.ns_min:.0f} ns"
                )
            if others and not better:
                yield f"None of {', '.join(others)} is both faster and more accurate than {OURS}."
            if not others:
                yield f"{OURS} was compared with nothing."
            elif not outside:
                yield "Nothing from outside this package was compared."
    yield from not_compared(rows)
    failed = sum(not is_done(row) for row in rows if row.method in done)
    if failed:
        yield f"Settings without a result: {failed} (see the remarks)."


def not_compared(rows: Sequence[MethodRow]) -> Iterator[str]:
    """Yield a line with the methods without any result, each with its first reason."""
    done = {row.method for row in rows if is_done(row)}
    reasons = {row.method: row.remark for row in reversed(rows) if row.method not in done}
    if reasons:
        told = (f"{name} ({remark})" for name, remark in sorted(reasons.items()))
        yield f"Not compared: {', '.join(told)}."
