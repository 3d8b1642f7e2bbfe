"""The report on a fit, or on the fits of the windows of a recording."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from types import SimpleNamespace

from ..errors import Message, joined, marked
from ..output.report import Field, Report
from .decay import decay_text
from .outcome import PERCENT, Number, Outcome

_COLUMNS = ("r0", "b", "theta0_deg", "theta0_rad", "T_nutation", "mean_precession_rate")
"""Numbers in the rows of windows."""


def fit_report(
    outcomes: Sequence[Outcome], source: str, system: str, *, omits_first: bool = False
) -> Report:
    """Return the report on the fit of a file, or on its windows: a row for each of them.

    `system` is the one of the known inputs.  `omits_first` leaves out its first failure.
    """
    recording, known = outcomes[0].recording, outcomes[0].known
    read = recording.source.source
    count, channels = sum(x.recording.t.size for x in outcomes), ", ".join(recording.channels)
    units = outcomes[0].units

    def shown(name: str, value: float, std: float) -> str:
        """Return a known input as it was typed."""
        if name == "steady":
            return "psidot0 = steady"
        size, unit = (units.radian, f" {units.angle}") if name == "theta0" else (1.0, "")
        return f"{name} = {Number(float(f'{value * size:.15g}'), std * size, '')}{unit}"

    conditions = {
        "data": f"{source}: {count} rows of {channels}, from t = {recording.t_start:g}",
        **({"read": [*read.lines]} if read.lines else {}),
        **({"not read": ", ".join(read.unused)} if read.unused else {}),
        "known": (", ".join(shown(name, *x) for name, x in known.items()) or "nothing") + system,
        "sigma": "as given" if recording.sigma else "estimated from the residuals",
    }
    if len(outcomes) > 1:
        keys = [x for x in _COLUMNS if any(x in outcome.numbers for outcome in outcomes)]
        fields = [Field(x, x, is_text=True) for x in ("t", *keys, "verdict")]
        rows = []
        for x in outcomes:
            cells = {y: str(x.numbers[y]) if y in x.numbers else "" for y in keys}
            cells |= {"t": f"{x.recording.middle:.6g}", "verdict": x.verdict}
            rows.append(SimpleNamespace(**cells))
        reasons = [x.failure() for x in outcomes if x.failures()]
        words = [*_model(outcomes[0]), decay_text(outcomes), *_failed(reasons[omits_first:])]
        return Report(conditions, fields, rows, words)
    fields = [Field(x, x, is_text=True) for x in ("key", "value", "meaning")]
    numbers = outcomes[0].numbers
    errors = {x: y * abs(numbers[x].value) for x, y in outcomes[0].model_errors.items()}
    fields[2:2] = [Field("model", "model", is_text=True)] * bool(errors)
    doubt = "not determined: " * (outcomes[0].is_open and outcomes[0].inputs is not None)
    rows = [
        SimpleNamespace(
            key=key,
            value=str(x),
            model=f"{errors[key]:.2g}" if key in errors else "",
            meaning=doubt + x.meaning,
        )
        for key, x in numbers.items()
        if not key.endswith(PERCENT)
    ]
    failed: list[str] = [*outcomes[0].failures()]
    failed[:1] = [joined([*failed[:1], *outcomes[0].hints])] if failed else []
    conclusions = [*_conclusions(outcomes[0]), *_failed(failed[omits_first:])]
    return Report(conditions, fields, rows, conclusions)


def _failed(reasons: Sequence[str]) -> Iterator[str]:
    """Yield a sentence for each reason of a failure."""
    return (Message(f"Failed: {marked(text)}.") for text in reasons)


def _conclusions(outcome: Outcome) -> Iterator[str]:
    """Yield sentences on one recording."""
    yield f"Verdict: {outcome.verdict}."
    if outcome.chi2_dof is not None:
        low, high = outcome.chi2_bounds
        bounds = f"({low:.3f} to {high:.3f} expected), {outcome.dof} degrees of freedom"
        yield f"chi2/dof = {outcome.chi2_dof:.3f} {bounds}."
    scale, unit = outcome.units.radian, outcome.units.angle
    rest = ", ".join(f"{x} {y.rms * scale:.3g}" for x, y in outcome.residuals.items())
    yield f"RMS residual ({unit}): {rest}."
    if pairs := ", ".join(f"{x} {y:.2f}" for x, y in outcome.correlations.items()):
        yield f"Correlation: {pairs}."
    yield from (Message(f"Note: {marked(text)}.") for text in outcome.remarks)
    yield from _model(outcome)


def _model(outcome: Outcome) -> Iterator[str]:
    """Yield a sentence on what the recording cannot show, if its fit is good."""
    if outcome.untested and not outcome.failed:
        part = f" of {outcome.recording.name}" if outcome.recording.name else ""
        yield f"Model errors{part}: {outcome.untested}."
