"""Error against run time, at the same times and over longer spans: rows, front and conclusions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

from ..inputs.names import ANGLES
from ..motion.solve import Motion
from ..output.progress import Progress, silent
from ..output.report import Field, Report, short
from .integrators import STEPS_PER_SECOND
from .measure import (
    DIGITS,
    FEWER_DIGITS,
    RUNS,
    SECONDS_OF_RUNS,
    Task,
    common_conditions,
    measure,
    reference_period,
    task,
)
from .method import OURS, Method, MethodRow, is_done, is_out

SPANS = [10.0**power + 0.3 for power in range(7)]
"""Spans in nutation periods; none ends at a turning point, at which approximations are best."""
_JUDGED_IN_A_SPAN = 21

ROUNDING, LOST = 1e-11, 0.1
"""Errors (rad) between which the order of a method is measured."""
VARIABLE_ORDER = ("LSODA", "Taylor")
"""Methods with variable order."""
METHOD_FIELDS = [
    Field("method", "method", is_text=True, names_the_row=True),
    Field("setting", "setting", names_the_row=True),
    Field("periods"),
    *(Field(f"{angle}_max") for angle in ANGLES),
    *(Field(f"{angle}_end") for angle in ANGLES),
    Field("error_rad", "max error", short),
    Field("error_end", "at the end", short),
    Field("units_max", "units", short),
    Field("evaluations", "evaluations"),
    Field("steps", "steps"),
    Field("jacobians"),
    Field("order", "order", lambda order: f"{order:.1f}"),
    Field("setup_s", "set-up ms", lambda seconds: f"{1000 * seconds:.1f}"),
    Field("ns_min", "ns/sample", lambda ns: f"{ns:.0f}"),
    Field("ns_median", "median", lambda ns: f"{ns:.0f}"),
    Field("runs", "runs"),
    Field("front", "front", lambda front: "*" if front else ""),
    Field("remark", "remark", is_text=True),
]


SPAN_KEYS = "method setting error_rad error_end units_max evaluations ns_min runs remark".split()
SPAN_FIELDS = [
    Field("periods", "periods", lambda periods: f"{periods:.0e}")
    if field.key == "periods"
    else field._replace(heading=field.heading if field.key in SPAN_KEYS else "")
    for field in METHOD_FIELDS
]
"""Fields of the report over spans, with the span and fewer other columns."""


def compare_methods(
    motion: Motion,
    t_max: float,
    count: int,
    methods: dict[str, Method],
    *,
    limit: float,
    progress: Progress = silent,
) -> Report:
    """Return the report on every method at every setting.  Raises LagtopError as `task` does."""
    work = task(motion, t_max, count, progress=progress)
    runs = [(name, method, x) for name, method in methods.items() for x in method.settings]
    found: list[MethodRow] = []
    for name, method, setting in progress(runs, "methods"):
        if not (found and found[-1].method == name and is_out(found[-1])):  # one warning is enough
            found.append(measure(work, name, method, setting))
    rows = with_front(with_order(found))
    return Report(conditions(work, limit), METHOD_FIELDS, rows, list(conclusions(rows, methods)))


def conditions(work: Task, limit: float) -> dict[str, str]:
    """Return all conditions that the figures depend on."""
    motion = work.motion
    return common_conditions() | {
        "scene": motion.top.options(),
        "regime": f"{motion.regime.value}, nutation period {motion.T_nutation}",
        "times": f"{work.times.size} from 0 to {float(work.times[-1])} "
        f"({work.periods:.6g} nutation periods)",
        "reference": f"Legendre's third integral by mpmath, {DIGITS} digits; with {FEWER_DIGITS} "
        f"digits it differs by {work.agreement:.0e} rad at most",
        "setting": "rtol = atol, in radians and in the units of the scene; of RK4 and of engines "
        "without error control, steps per nutation period",
        "order": "fall of the error with the evaluations, between the last two settings with an "
        f"error of {ROUNDING:g} to {LOST:g} rad; none of a method that varies its order",
        "error": f"radians, greatest of the three angles at {len(work.exact)} of the times, the "
        "last among them",
        "units": "the same over eps (max(1, |angle|) + |tau rate|), tau the time since the nearest "
        "whole period",
        "turns": "compared unwrapped, but modulo 2 pi for quaternion forms",
        "time": f"one thread; after a warm-up, of memory too, least and median of up to {RUNS} "
        f"runs (of one where it takes {SECONDS_OF_RUNS} s)",
        "exceptions": f"a run of {limit:g} s fails (of heyoka, one of {limit * STEPS_PER_SECOND:g} "
        "steps); lagtop-digits runs at the judged times only, "
        "set-up included",
    }


def compare_spans(
    motion: Motion, count: int, methods: dict[str, Method], *, limit: float, progress: Progress
) -> Report:
    """Return the report on each method, at its tightest setting, over increasing spans.

    Raises LagtopError as `task` does.
    """
    spans = [
        task(motion, span * reference_period(motion), count, judged=_JUDGED_IN_A_SPAN)
        for span in SPANS
    ]
    runs = [(name, work) for name in methods for work in spans]
    rows: list[MethodRow] = []
    for name, work in progress(runs, "methods and spans"):
        rows.append(_measure(work, name, methods[name], rows))
    last = conditions(spans[-1], limit)
    last["times"] = f"{count} over each span"
    last["reference"] += " over the longest span"
    return Report(last, SPAN_FIELDS, rows, _conclusions(rows))


def _measure(work: Task, name: str, method: Method, before: list[MethodRow]) -> MethodRow:
    """Return the measured row; a method that failed over a shorter span is not run again."""
    setting = method.settings[-1]
    if before and before[-1].method == name and not is_done(before[-1]):
        if is_out(before[-1]):
            return before[-1]._replace(periods=work.periods)
        remark = "not run: it failed over a shorter span"
        return MethodRow(name, setting, work.periods, remark=remark)
    return measure(work, name, method, setting)


def _conclusions(rows: list[MethodRow]) -> list[str]:
    """Return the growth of error and time over the spans of each method, and missing methods."""
    lines = []
    for name in dict.fromkeys(row.method for row in rows):
        done = [row for row in rows if row.method == name and is_done(row)]
        if done:
            first, last = done[0], done[-1]
            growth = growth_of([(row.periods, row.error_rad or 0) for row in done])
            lines.append(
                f"{name}: error in units {first.units_max:.1e} over {first.periods:.0e} periods, "
                f"{last.units_max:.1e} over {last.periods:.0e}"
                + ("" if growth is None else f"; in radians it grows as t^{growth:.1f}")
                + f"; time a sample {(last.ns_min or 0) / (first.ns_min or 1):.1f} times as long"
            )
    return [*lines, *not_compared(rows)]


def growth_of(errors: Sequence[tuple[float, float]]) -> float | None:
    """Return the exponent p of errors that grow as t^p, by least squares; None for fewer than two.

    Each element is a time and an error; errors of 0 or beyond 0.1 rad do not count.
    """
    known = [(math.log(t), math.log(error)) for t, error in errors if 0 < error < LOST]
    if len(known) < 2:
        return None
    middle = sum(x for x, _ in known) / len(known)
    square = sum((x - middle) ** 2 for x, _ in known)
    return sum((x - middle) * y for x, y in known) / square


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
        if len(work) > 1 and not name.startswith(VARIABLE_ORDER):
            (few, large), (many, small) = work[-2:]
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
