"""What a comparison of methods shows: its rows, the Pareto front, and what may be concluded."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ..inputs.names import ANGLES
from ..output.findings import Field, short
from .method import Method

OURS = "lagtop"
NOT_APPLICABLE = "not applicable"


class MethodRow(NamedTuple):
    """The errors and the times of one method at one setting."""

    method: str
    setting: float | str
    periods: float
    theta_max: float | None = None
    """Greatest error of theta over the judged times (rad); then those of phi and psi."""
    phi_max: float | None = None
    psi_max: float | None = None
    theta_end: float | None = None
    phi_end: float | None = None
    psi_end: float | None = None
    error_max: float | None = None
    """Greatest error of the three angles (rad)."""
    error_end: float | None = None
    units_max: float | None = None
    setup_s: float | None = None
    ns_min: float | None = None
    """Nanoseconds per sample: the least and the median of the runs."""
    ns_median: float | None = None
    runs: int | None = None
    front: bool = False
    """Whether no other is both faster and more accurate."""
    remark: str | None = None


FIELDS = [
    Field("method", "method", is_text=True, names_the_row=True),
    Field("setting", "setting", names_the_row=True),
    Field("periods"),
    *(Field(f"{angle}_max") for angle in ANGLES),
    *(Field(f"{angle}_end") for angle in ANGLES),
    Field("error_max", "max error", short),
    Field("error_end", "at the end", short),
    Field("units_max", "units", short),
    Field("setup_s", "set-up ms", lambda seconds: f"{1000 * seconds:.1f}"),
    Field("ns_min", "ns/sample", lambda ns: f"{ns:.0f}"),
    Field("ns_median", "median", lambda ns: f"{ns:.0f}"),
    Field("runs", "runs"),
    Field("front", "front", lambda front: "*" if front else ""),
    Field("remark", "remark", is_text=True),
]


def with_front(rows: Sequence[MethodRow]) -> list[MethodRow]:
    """Return the rows by error, those marked that no other row beats in both error and time."""
    rows = sorted(rows, key=lambda row: math.inf if row.error_max is None else row.error_max)
    return [row._replace(front=is_done(row) and not rivals(row, rows)) for row in rows]


def is_done(row: MethodRow) -> bool:
    """Return whether a row has an error and a time."""
    return row.error_max is not None and row.ns_min is not None


def is_out(row: MethodRow) -> bool:
    """Return whether the method cannot do the scene, at any setting."""
    return (row.remark or "").startswith(NOT_APPLICABLE)


def rivals(row: MethodRow, rows: Iterable[MethodRow]) -> list[MethodRow]:
    """Return the rows that are at least as fast and as accurate, and better in one."""
    mine = (row.error_max, row.ns_min)
    return [
        other
        for other in rows
        if is_done(other)
        and (theirs := (other.error_max, other.ns_min)) != mine
        and all(x <= y for x, y in zip(theirs, mine, strict=True))  # type: ignore[operator]
    ]


def conclusions(rows: Sequence[MethodRow], methods: Mapping[str, Method]) -> Iterator[str]:
    """Yield who beats our closed form in doubles, and by how much, and what was not compared."""
    done = {row.method for row in rows if is_done(row)}
    others = [name for name in methods if name in done and name != OURS]
    outside = any(methods[name].package for name in others)
    for row in rows:
        if row.method == OURS and is_done(row):
            better = rivals(row, rows)
            for other in better:
                yield (
                    f"{other.method} at {other.setting} beats {OURS}: {other.error_max:.1e} rad in "
                    f"{other.ns_min:.0f} ns against {row.error_max:.1e} rad in {row.ns_min:.0f} ns"
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
    """Yield a line with the methods without any result, and their first reasons."""
    done = {row.method for row in rows if is_done(row)}
    reasons = {row.method: row.remark for row in reversed(rows) if row.method not in done}
    if reasons:
        told = (f"{name} ({remark})" for name, remark in sorted(reasons.items()))
        yield f"Not compared: {', '.join(told)}."
