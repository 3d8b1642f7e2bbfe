"""Error and run time against the time span: what integrators lose on the way."""

from __future__ import annotations

from ..motion.solve import Motion
from ..output.findings import Field, Findings
from .method import Method
from .work_precision import (
    FIELDS,
    Row,
    Steps,
    Task,
    conditions,
    is_done,
    is_out,
    measure,
    period_of,
    task,
)

SPANS = [10.0**power + 0.3 for power in range(7)]
"""In nutation periods; none ends at a turning point, where approximations are at their best."""
JUDGED = 21

SHOWN = ("method", "setting", "error_max", "error_end", "units_max", "ns_min", "runs", "remark")


def report(
    motion: Motion, count: int, methods: dict[str, Method], *, limit: float, steps: Steps
) -> Findings:
    """Each method at its tightest setting over longer and longer spans.

    Raises LagtopError as `bench.task` does.
    """
    spans = [task(motion, span * period_of(motion), count, judged=JUDGED) for span in SPANS]
    runs = [(name, work) for name in methods for work in spans]
    rows: list[Row] = []
    for name, work in steps(runs, "methods and spans"):
        rows.append(_measure(work, name, methods[name], rows))
    last = conditions(spans[-1], limit)
    last["times"] = f"{count} over each span"
    last["reference"] += " over the longest span"
    return Findings(last, [_field(field) for field in FIELDS], rows, _conclusions(rows))


def _field(field: Field) -> Field:
    """As in a report of one span, with the span and without what matters less here."""
    if field.key == "periods":
        return Field("periods", "periods", lambda periods: f"{periods:.0e}")
    return field if field.key in SHOWN else field._replace(heading="")


def _measure(work: Task, name: str, method: Method, before: list[Row]) -> Row:
    """As `measure`, but for a method that has failed over a shorter span."""
    setting = method.settings[-1]
    if before and before[-1].method == name and not is_done(before[-1]):
        if is_out(before[-1]):
            return before[-1]._replace(periods=work.periods)
        remark = "not run: it failed over a shorter span"
        return Row(name, setting, work.periods, remark=remark)
    return measure(work, name, method, setting)


def _conclusions(rows: list[Row]) -> list[str]:
    """Growth of error and of time over all the spans a method could do."""
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
    return lines
