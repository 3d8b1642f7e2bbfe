"""The reports on fits: the numbers of each recording, or a row for each window, and conclusions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from types import SimpleNamespace

from ..arithmetic.numbers import angle_unit
from ..output.report import Field, Report, uncertain_text
from .noise import chi2_bounds
from .nutation import PERCENT
from .outcome import Outcome
from .windows import decay_of

_COLUMNS = ("r0", "b", "theta0_deg", "theta0_rad", "T_nutation", "mean_precession_rate")
"""Numbers in the rows of windows."""


def fit_report(outcomes: Sequence[Outcome], source: str, units: str) -> Report:
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


def windows_report(outcomes: Sequence[Outcome], source: str, units: str) -> Report:
    """Return the report on a fit in windows: a row for each, and the decay of the spin."""
    keys = [x for x in _COLUMNS if any(x in outcome.numbers for outcome in outcomes)]
    fields = [Field(x, x, is_text=True) for x in ("t", *keys, "verdict")]
    rows = []
    for x in outcomes:
        cells = {y: uncertain_text(*x.numbers[y]) if y in x.numbers else "" for y in keys}
        rows.append(SimpleNamespace(t=f"{x.middle:.6g}", verdict=x.verdict, **cells))
    return Report(_conditions(outcomes, source, units), fields, rows, [decay_text(outcomes)])


def decay_text(outcomes: Sequence[Outcome]) -> str:
    """Return a sentence on the decay of the spin through windows."""
    return str(decay_of(outcomes) or "Fewer than three windows are good: the decay is not known.")


def _conditions(outcomes: Sequence[Outcome], source: str, units: str) -> dict[str, str]:
    recording, known = outcomes[0].recording, outcomes[0].known
    rows, channels = sum(x.recording.t.size for x in outcomes), ", ".join(recording.channels)
    shown = [
        f"{name} = {uncertain_text(x, known.stds.get(name, 0.0))}{' rad' * (name == 'theta0')}"
        for name, x in known.items()
    ]
    return {
        "data": f"{source}: {rows} rows of {channels}, from t = {recording.t_start:g}",
        "known": (", ".join(shown) or "nothing") + units,
        "sigma": "as given" if recording.sigma else "estimated from the residuals",
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
    yield from (f"{name}Note: {text}." for text in outcome.notes)
    yield from (f"{name}Failed: {text}." for text in [*outcome.failures(), *outcome.hints])
