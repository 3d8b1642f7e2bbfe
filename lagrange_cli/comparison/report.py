"""The report on trajectories."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np

from ..arithmetic.text import shortened
from ..errors import Message, arg, joined, marked
from ..file_bytes import shown_path
from ..output.report import Field, Report, fields_of, short
from ..output.terminal import one_line
from ..solver.solve import Motion
from .compare import COMPARISON_KEYS, LIMIT, Comparison
from .convergence import Convergence

_WRONG_NORM, _FEW = 1e-6, 0.03
"""The least distance of a norm from 1 that is said, and the largest share of rows that are few."""
_COLUMNS = (
    Field("file", "file", one_line, is_text=True),
    Field("step", "step", "{:g}".format),
    Field("verdict", "verdict", is_text=True),
    Field("rows", "rows"),
    Field("error_max", "max error", short),
    Field("error_final", "at the end", short),
    Field("order_error", "for the order", short),
    Field("energy_drift", "energy", short),
)
"""The columns of the table."""


def comparison_report(
    motion: Motion,
    results: Sequence[Comparison],
    found: Convergence | None,
    limit: float = LIMIT,
    *,
    scene: str | None = None,
    overrides: Collection[str] = (),
) -> Report:
    """Return the report on trajectories of a top, which a scene and `overrides` of it may name."""
    shown = [x for x in _COLUMNS if any(getattr(row, x.key) is not None for row in results)]
    inputs = (x.split("=", 1) for x in motion.top.as_text().split())
    given = [x for x in inputs if not scene or x[0].startswith((*overrides,))]
    conditions = {
        "scene": joined([*([scene] if scene else ()), *(arg(x, y) for x, y in given)], " "),
        "regime": motion.regime,
        "errors": f"in radians, relative for rates; greatest over all rows; fine up to {limit:g}",
    }
    lines = [y for x in results for y in _conclusions(x, limit, is_right=found and found.converges)]
    if found is not None:
        lines.append(found.sentence)
    return Report(conditions, fields_of([*COMPARISON_KEYS], *shown), results, lines)


def _conclusions(x: Comparison, limit: float, *, is_right: bool | None) -> Iterator[str]:
    """Yield what was read, the verdict, and why; the error of a right top falls with the step."""
    if x.columns:
        yield f"Columns: {x.columns}." + f" Not used: {x.unused}." * bool(x.unused)
        yield from (f"Read {line}." for line in (x.read or "").split("; "))
    yield f"{sentence(x)}."
    if x.rows_missing:
        yield f"{x.rows_missing} of {x.rows} rows have empty cells."
    if x.compared == "attitude" and (x.norm_error or 0.0) > _WRONG_NORM:
        yield f"The norm of its quaternion or matrix differs from 1 by up to {x.norm_error:.1e}."
    if (slip := x.pivot_slip or 0.0) > limit:
        yield f"The pivot slips: its distance from the centre of mass changes by up to {slip:.1%}."
    is_unexplained = x.exceeds(limit) and not is_right
    if x.cause is not None:
        remedy = f" ({marked(x.remedy)})" if x.remedy else ""
        error = f"With that corrected, the error is at most {x.cause_error:.1e}"
        yield Message(f"{_capital(_cause(x))}{remedy}. {error}.")
    elif rows := _few_rows(x, limit):
        yield rows
    elif is_unexplained:
        yield from _channels(x, limit)
        if x.a_ratio is None and x.b_ratio is None:
            yield _hint(x)
    if x.numbers is not None and is_unexplained:
        yield f"{_capital(x.numbers)}."


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]


def _cause(x: Comparison) -> str:
    return f"{'most likely' if x.explained == 'most likely' else 'probable'} cause: {x.cause}"


def _hint(x: Comparison) -> Message:
    """Return what to check if no top explains the motion."""
    known = {"align": x.axis_error_max, "quaternion_order": x.attitude_error_max}
    known["rates_frame"] = x.rates_error_max
    names = ", ".join(arg(name) for name, y in known.items() if y is not None)
    others = f", and other conventions of the attitude and the rates ({names})" if names else ""
    if x.verdict == "drifts":
        others = ", and runs with other step sizes"
    return Message(f"None of the known causes explains the error: check the inputs{others}.")


def _channels(x: Comparison, limit: float) -> Iterator[str]:
    """Yield which quantities agree if only some are wrong."""
    names = {"theta": "theta", "phi": "phi", "psi": "psi", "rates": "the rates"}
    known = {key: y for key in names if (y := getattr(x, f"{key}_error_max")) is not None}
    right, wrong = ([key for key in known if (known[key] > limit) == y] for y in (False, True))
    if not right or not wrong:
        return
    most = max(known[key] for key in right)
    agree = f"{joined([names[x] for x in right], ' and ')} agree{'s' * (len(right) == 1)}"
    drift = getattr(x, f"{wrong[0]}_drift", None) if len(wrong) == 1 else None
    verb = f"drifts, by {drift:.3g} rad per unit of time" if drift else "differs"
    verb = verb if len(wrong) == 1 else "differ"
    only = joined([names[x] for x in wrong], " and ")
    yield f"{_capital(agree)} to {most:.1e}; only {only} {verb}."


def _few_rows(x: Comparison, limit: float) -> str:
    """Return which rows are off if they are few and the last row is not among them."""
    wrong = np.flatnonzero(x.error > limit)
    if not 0 < wrong.size <= _FEW * x.rows or not x.error[-1] <= limit:
        return ""
    shown = shortened(", ".join(f"{t:.6g}" for t in x.t[wrong]))
    return f"The limit is exceeded in only {wrong.size} of {x.rows} rows, at t = {shown}."


def failure(x: Comparison) -> str:
    """Return the verdict on a trajectory with its errors, and what explains them."""
    return "; ".join(filter(None, (sentence(x), _cause(x) if x.cause else x.numbers)))


def sentence(x: Comparison) -> str:
    """Return the verdict on a trajectory with its errors."""
    verdict = f"lost at t = {x.lost_at}" if x.verdict == "lost" else x.verdict
    unit = "of the rates" if x.compared == "rates" else "rad"
    errors = [] if x.error_max is None else [f"at most {x.error_max:.1e} {unit} off"]
    if x.rates_error_max is not None and x.compared != "rates":
        errors.append(f"its rates by {x.rates_error_max:.1e} (relative)")
    return ", ".join([f"{one_line(shown_path(x.file or ''))}: {verdict}", *errors])
