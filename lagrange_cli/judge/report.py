"""The report on trajectories: a row for each, and conclusions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from ..inputs.files import shown_path
from ..inputs.names import ANGLES
from ..motion.solve import Motion
from ..output.report import Field, Report, short
from ..output.terminal import one_line
from .compare import (
    ANOTHER,
    DRIFTS,
    FINE,
    LEAST_ORDER,
    LOST,
    OFF,
    RATES,
    Comparison,
    ComparisonRequest,
)
from .judgement import JUDGEMENT_KEYS, LIMIT, Judgement

_SHOWN: dict[str, tuple[str, Callable[[Any], str]]] = {
    "file": ("file", one_line),
    "step": ("step", lambda step: f"{step:g}"),
    "verdict": ("verdict", str),
    "rows": ("rows", str),
    "error_max": ("max error", short),
    "attitude_error_final": ("at the end", short),
    "theta_error_max": ("theta", short),
    "phi_error_max": ("phi", short),
    "psi_error_max": ("psi", short),
    "theta_drift": ("theta drift", short),
    "phi_drift": ("phi drift", short),
    "psi_drift": ("psi drift", short),
    "norm_drift": ("norm", short),
    "energy_drift": ("energy", short),
    "Lz_drift": ("Lz", short),
    "t_past_1e_3": ("past 1e-3 at", lambda t: f"{t:.4g}"),
    "lost_at": ("lost at", lambda t: f"{t:.4g}"),
}
"""The columns of the table, with their headings and formats."""
_TEXTS = {"file", "verdict", "judged", "explained_by", "quaternion_order"}
_FIELDS = [
    Field(
        key,
        *_SHOWN.get(key, ("", str)),
        is_text=key in _TEXTS,
        names_the_row=key == "file",
    )
    for key in JUDGEMENT_KEYS
]


def comparison_report(motion: Motion, comparison: Comparison, request: ComparisonRequest) -> Report:
    """Return the report on trajectories."""
    shown = {
        key for key in _SHOWN if any(getattr(x, key) is not None for x in comparison.judgements)
    }
    fields = [field if field.key in shown else field._replace(heading="") for field in _FIELDS]
    conclusions = list(_conclusions(comparison))
    return Report(
        _conditions(motion, comparison, request), fields, comparison.judgements, conclusions
    )


def failures(findings: Report) -> list[str]:
    """Return the trajectories that are not fine, with reasons."""
    return [
        f"{_name(x)}: {_sentence(x).removesuffix('.')}" for x in findings.rows if x.verdict != FINE
    ]


def _conditions(
    motion: Motion, comparison: Comparison, request: ComparisonRequest
) -> dict[str, str]:
    period = comparison.judgements[0].period
    conditions = {
        "scene": motion.top.options(),
        "regime": f"{motion.regime}, period {period}",
        "errors": f"radians, greatest of all rows; fine up to {request.limit or LIMIT:g}",
        "drift": "growth of the difference per period, by a fitted line",
    }
    if orders := {x.quaternion_order for x in comparison.judgements if x.quaternion_order}:
        conditions["quaternion"] = f"{' or '.join(sorted(orders))}, as the first row proves"
    return conditions


def _conclusions(comparison: Comparison) -> Iterator[str]:
    for judgement in comparison.judgements:
        yield f"{_name(judgement)}: {_sentence(judgement)}"
    found = comparison.convergence
    if found is not None:
        if not found.falls and all(x.verdict in {FINE, RATES} for x in comparison.judgements):
            yield "The error does not fall with the step: the numbers may have been rounded."
        elif not found.falls:
            yield "The error does not fall with the step: this is the motion of another top."
        elif found.order is None:
            yield "The errors are too small or too large to show an order of convergence."
        elif found.order < LEAST_ORDER:
            yield "The error depends on the step, but shows no order: give runs of one method."
        else:
            yield f"The error falls with the step; the order of convergence is {found.order:.2f}."
    if found is None or not found.falls:
        yield from _explanations(comparison.judgements)


def _name(judgement: Judgement) -> str:
    return one_line(shown_path(judgement.file or ""))


def _sentence(judgement: Judgement) -> str:
    error = judgement.error_max
    unit = "of the rates" if judgement.judged == "rates" else "rad"
    most = "" if error is None else f"at most {error:.1e} {unit} off"
    told = {
        FINE: f"fine, {most}",
        RATES: f"its angular velocities are {_rates(judgement)} off, its attitude {most}",
        DRIFTS: f"drifts, {most}{_drift(judgement)}",
        OFF: f"off from the start by {judgement.error_start:.1e} {unit}, {most}",
        ANOTHER: f"moves like another top, {most}",
        LOST: f"lost at t = {judgement.lost_at}" + (f", {most} elsewhere" if most else ""),
    }
    return told[judgement.verdict] + "."


def _rates(judgement: Judgement) -> str:
    return f"{judgement.rate_error_max or 0.0:.1e} rad per unit of time"


def _drift(judgement: Judgement) -> str:
    seen = [key for key in ANGLES if getattr(judgement, f"{key}_error_max") is not None]
    drifts = {key: getattr(judgement, f"{key}_drift") for key in seen}
    known = {key: x for key, x in drifts.items() if x is not None}
    if judgement.rows > 2 and len(known) < len(seen):
        uncounted = " and ".join(key for key in seen if key not in known)
        return f"; rows are too far apart to count whole turns of {uncounted}"
    if not known:
        return ""
    worst = max(known, key=lambda key: abs(known[key]))
    return f"; {worst} drifts by {known[worst]:.1e} rad per period"


def _explanations(judgements: Sequence[Judgement]) -> Iterator[str]:
    """Yield the most likely cause of the errors, from the trajectory that it explains best."""
    explained = [x for x in judgements if x.explained_by is not None]
    if explained:
        best = min(explained, key=lambda x: x.explained_error or 0.0)
        yield (
            f"Most likely cause: {best.explained_by}. If that is corrected, the error of "
            f"{_name(best)} is at most {best.explained_error:.1e} rad."
        )
    elif any(x.verdict in {ANOTHER, DRIFTS, OFF} for x in judgements):
        yield "None of the common mistakes explains it."
