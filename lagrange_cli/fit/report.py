"""The reports on fits: the numbers of each recording, or a row for each window, and conclusions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from types import SimpleNamespace
from typing import Any

from ..arithmetic.numbers import angle_unit
from ..motion.quantity import unit_name
from ..output.report import Field, Report, uncertain_text
from .noise import chi2_bounds
from .nutation import PERCENT
from .outcome import FAILED, Outcome
from .windows import decay_of

_COLUMNS = ("r0", "b", "theta0_deg", "T_nutation", "mean_precession_rate")


def fit_report(outcomes: Sequence[Outcome], source: str, units: str = "") -> Report:
    """Return the report on the recordings of a file; `units` are those of the known inputs."""
    rows = [
        SimpleNamespace(
            name=x.recording.name, key=key, value=uncertain_text(*number), meaning=x.meanings[key]
        )
        for x in outcomes
        for key, number in x.numbers.items()
        if not key.endswith(PERCENT)
    ]
    fields = [Field(x, x, is_text=True) for x in ("key", "value", "meaning")]
    if any(x.recording.name for x in outcomes):
        fields = [Field("name", "recording", is_text=True, names_the_row=True), *fields]
    conclusions = [line for x in outcomes for line in _conclusions(x)]
    return Report(_conditions(outcomes, source, units), fields, rows, conclusions)


def windows_report(outcomes: Sequence[Outcome], source: str, units: str = "") -> Report:
    """Return the report on a fit in windows: a row for each, and the decay of the spin."""
    keys = [unit_name(x, radians=outcomes[0].radians) for x in _COLUMNS]
    keys = [x for x in keys if any(x in outcome.numbers for outcome in outcomes)]
    fields = [
        Field("t", "t", lambda t: f"{t:.6g}"),
        *(Field(x, x, is_text=True) for x in keys),
        Field("verdict", "verdict", is_text=True),
    ]
    rows = []
    for x in outcomes:
        cells: dict[str, Any] = dict.fromkeys(keys)
        cells |= {y: uncertain_text(*x.numbers[y]) for y in keys if y in x.numbers}
        rows.append(SimpleNamespace(t=middle_of(x), verdict=x.verdict, **cells))
    return Report(_conditions(outcomes, source, units), fields, rows, [decay_text(outcomes)])


def middle_of(outcome: Outcome) -> float:
    """Return the time of the middle of a recording."""
    return outcome.recording.t_start + float(outcome.recording.t[-1]) / 2


def decay_text(outcomes: Sequence[Outcome]) -> str:
    """Return a sentence on the decay of the spin through windows."""
    decay = decay_of(outcomes)
    if decay is None:
        return "Fewer than three windows are good, so the decay is not known."
    quality = f"chi2/dof of the exponential: {decay.chi2_dof:.2f}"
    if decay.time is None:
        shown = uncertain_text(decay.rate, decay.rate_std)
        return f"{decay.quantity} does not decay: its relative rate of decay is {shown}; {quality}."
    return f"{decay.quantity} decays with a time of {uncertain_text(*decay.time)}; {quality}."


def windows_record(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Return the decay and the records of all windows by key."""
    decay = decay_of(outcomes)
    time = (decay and decay.time) or (None, None)
    return {
        "decay_of": decay and decay.quantity,
        "decay_time": time[0],
        "decay_time_std": time[1],
        "decay_rate": decay and decay.rate,
        "decay_rate_std": decay and decay.rate_std,
        "decay_chi2_dof": decay and decay.chi2_dof,
        "verdict": FAILED if any(x.verdict == FAILED for x in outcomes) else "good",
        "windows": [{"t": middle_of(x), **x.record()} for x in outcomes],
    }


def _conditions(outcomes: Sequence[Outcome], source: str, units: str) -> dict[str, str]:
    first = outcomes[0]
    rows = sum(x.recording.t.size for x in outcomes)
    channels = ", ".join(first.recording.channels)
    start = f"{first.recording.t_start:g}"
    known, (per_radian, unit) = [], angle_unit(radians=first.radians)
    for name, value in first.known.items():
        scale, key = (per_radian, f"{name}_{unit}") if name == "theta0" else (1, name)
        std = first.known.stds.get(name, 0.0) * scale
        shown = uncertain_text(value * scale, std) if std else f"{value * scale:g}"
        known.append(f"{key} = {shown}")
    return {
        "data": f"{source}: {rows} rows of {channels}, from t = {start}",
        "known": (", ".join(known) or "nothing") + units,
        "sigma": "as given" if first.recording.sigma else "estimated from the residuals",
    }


def _conclusions(outcome: Outcome) -> Iterator[str]:
    """Yield sentences on one recording."""
    name = f"{outcome.recording.name}: " if outcome.recording.name else ""
    yield f"{name}Verdict: {outcome.verdict}."
    if outcome.recording.sigma:
        low, high = chi2_bounds(outcome.dof)
        bounds = f"noise {low:.3f} to {high:.3f}; {outcome.dof} dof"
        yield f"{name}chi2/dof = {outcome.chi2_dof:.3f}, {bounds}."
    scale, unit = angle_unit(radians=outcome.radians)
    rest = ", ".join(f"{x} {y.rms * scale:.3g}" for x, y in outcome.residuals.items())
    yield f"{name}RMS residual ({unit}): {rest}."
    if pairs := ", ".join(f"{x} {y:.2f}" for x, y in outcome.correlations.items()):
        yield f"{name}Correlation: {pairs}."
    for text in outcome.notes:
        yield f"{name}Note: {text}."
    for text in [*outcome.failures(), *outcome.hints]:
        yield f"{name}Failed: {text}."
