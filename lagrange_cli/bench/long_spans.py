"""Error and run time against the time span: what integrators lose on the way."""

from __future__ import annotations

from ..motion.solve import Motion
from ..output.findings import Field, Findings
from .front import FIELDS, MethodRow, is_done, is_out, not_compared
from .method import Method, Steps
from .work_precision import Task, conditions, measure, nutation_period, task

SPANS = [10.0**power + 0.3 for power in range(7)]
"""Spans in nutation periods; none ends at a turning point, where approximations do best."""
JUDGED = 21

SHOWN = ("method", "setting", "error_max", "error_end", "units_max", "ns_min", "runs", "remark")


def compare_spans(
    motion: Motion, count: int, methods: dict[str, Method], *, limit: float, steps: Steps
) -> Findings:
    """Return the report on each method at its tightest setting over longer and longer spans.

    Raises LagtopError as `task` does.
    """
    spans = [task(motion, span * nutation_period(motion), count, judged=JUDGED) for span in SPANS]
    runs = [(name, work) for name in methods for work in spans]
    rows: list[MethodRow] = []
    for name, work in steps(runs, "methods and spans"):
        rows.append(_measure(work, name, methods[name], rows))
    last = conditions(spans[-1], limit)
    last["times"] = f"{count} over each span"
    last["reference"] += " over the longest span"
    return Findings(last, [_field(field) for field in FIELDS], rows, _conclusions(rows))


def _field(field: Field) -> Field:
    """Return a field of the report of one span, with the span shown and less of the rest."""
    if field.key == "periods":
        return Field("periods", "periods", lambda periods: f"{periods:.0e}")
    return field if field.key in SHOWN else field._replace(heading="")


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
    """Return how error and time grow over the spans of each method, and what was not compared."""
    lines = []
    for name in dict.fromkeys(row.method for row in rows):
        done = [row for row in rows if row.method == name and is_done(row)]
        if done:
            first, last = done[0], done[-1]
            lines.append(
                f"{name}: error in units {first.units_max:.1e} over {first.periods:.0e} periods, "
                f"{last.units_max:.1e} over {last.periods:.0e}; time a sample "
                f"{(last.ns_min or 0) / (first.ns_min or 1):.1f} times as long"
            )
    return [*lines, *not_compared(rows)]
