"""The reports on fits, and the decay of the spin through windows of a recording.

Friction slows a real top, but the closed form has no friction.  Within a short window the loss is
below the noise.  A line through the logarithms of r0, or of b if the spin is not recorded, gives
the decay time.  The torque a = 2mgs/A does not decay: for this line, the fits are corrected to the
weighted mean of a, with which their errors of b and r0 correlate.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from ..arithmetic.numbers import angle_unit
from ..output.report import Field, Report, uncertain_text
from .nutation import PERCENT
from .outcome import GOOD, Outcome, chi2_bounds

_COLUMNS = ("r0", "b", "theta0_deg", "theta0_rad", "T_nutation", "mean_precession_rate")
"""Numbers in the rows of windows."""
_SURE = 3.0
"""Standard deviations from which a decay is significant."""


class Decay(NamedTuple):
    """The exponential decay of r0 or of b, with chi^2 of the line through the logarithms."""

    quantity: str
    rate: float
    """The relative rate."""
    rate_std: float
    time: float | None
    """The decay time 1/rate; None if no decay is significant."""
    time_std: float | None
    chi2_dof: float

    def __str__(self) -> str:
        shown = f"does not decay: its relative rate is {uncertain_text(*self[1:3])}"
        if self.time is not None and self.time_std is not None:
            shown = f"decays with a time of {uncertain_text(self.time, self.time_std)}"
        return f"{self.quantity} {shown}; chi2/dof of the exponential: {self.chi2_dof:.2f}."


def decay_of(outcomes: Sequence[Outcome]) -> Decay | None:
    """Return the decay through windows, or None if fewer than three of them are good."""
    good = [x for x in outcomes if x.verdict == GOOD]
    if len(good) < 3:
        return None
    name = "r0" if all("r0" in x.numbers for x in good) else "b"
    values, stds = np.array([x.numbers[name] for x in good]).T
    if all(("a", name) in x.covariance for x in good):
        torque, torque_std = np.array([x.numbers["a"] for x in good]).T
        both = np.array([x.covariance["a", name] for x in good])
        mean = np.average(torque, weights=torque_std**-2)
        values = values + both / torque_std**2 * (mean - torque)
        stds = np.sqrt(stds**2 - (both / torque_std) ** 2)
    t = np.array([x.recording.middle for x in good])
    logs, weights = np.log(np.abs(values)), np.abs(values / stds)
    (slope, level), spread = np.polyfit(t, logs, 1, w=weights, cov="unscaled")
    off, rate, std = weights * (logs - level - slope * t), -float(slope), math.sqrt(spread[0, 0])
    time, time_std = (1 / rate, std / rate**2) if rate > _SURE * std else (None, None)
    return Decay(name, rate, std, time, time_std, float(off @ off) / (len(good) - 2))


def decay_text(outcomes: Sequence[Outcome]) -> str:
    """Return a sentence on the decay of the spin through windows."""
    return str(decay_of(outcomes) or "Fewer than three windows are good: the decay is not known.")


def fit_report(
    outcomes: Sequence[Outcome], source: str, units: str, *, is_windows: bool = False
) -> Report:
    """Return the report on the recordings of a file, or on its windows: a row for each of them.

    `units` are those of the known inputs.
    """
    recording, known = outcomes[0].recording, outcomes[0].known
    count, channels = sum(x.recording.t.size for x in outcomes), ", ".join(recording.channels)
    shown = [
        f"{name} = {uncertain_text(x, known.stds.get(name, 0.0))}{' rad' * (name == 'theta0')}"
        for name, x in known.items()
    ]
    conditions = {
        "data": f"{source}: {count} rows of {channels}, from t = {recording.t_start:g}",
        "known": (", ".join(shown) or "nothing") + units,
        "sigma": "as given" if recording.sigma else "estimated from the residuals",
    }
    if is_windows:
        keys = [x for x in _COLUMNS if any(x in outcome.numbers for outcome in outcomes)]
        fields = [Field(x, x, is_text=True) for x in ("t", *keys, "verdict")]
        rows = []
        for x in outcomes:
            cells = {y: uncertain_text(*x.numbers[y]) if y in x.numbers else "" for y in keys}
            cells |= {"t": f"{x.recording.middle:.6g}", "verdict": x.verdict}
            rows.append(SimpleNamespace(**cells))
        return Report(conditions, fields, rows, [decay_text(outcomes)])
    fields = [Field(x, x, is_text=True) for x in ("key", "value", "meaning")]
    if any(x.recording.name for x in outcomes):
        fields = [Field("name", "recording", is_text=True, names_the_row=True), *fields]
    rows = [
        SimpleNamespace(
            name=x.recording.name, key=key, value=uncertain_text(*number), meaning=x.meanings[key]
        )
        for x in outcomes
        for key, number in x.numbers.items()
        if not key.endswith(PERCENT)
    ]
    conclusions = [x.recording.named(line) for x in outcomes for line in _conclusions(x)]
    return Report(conditions, fields, rows, conclusions)


def _conclusions(outcome: Outcome) -> Iterator[str]:
    """Yield sentences on one recording."""
    yield f"Verdict: {outcome.verdict}."
    if outcome.chi2_dof is not None:
        low, high = chi2_bounds(outcome.dof)
        bounds = f"noise {low:.3f} to {high:.3f}; {outcome.dof} dof"
        yield f"chi2/dof = {outcome.chi2_dof:.3f}, {bounds}."
    scale, unit = angle_unit(radians=outcome.radians)
    rest = ", ".join(f"{x} {y.rms * scale:.3g}" for x, y in outcome.residuals.items())
    yield f"RMS residual ({unit}): {rest}."
    if pairs := ", ".join(f"{x} {y:.2f}" for x, y in outcome.correlations.items()):
        yield f"Correlation: {pairs}."
    yield from (f"Note: {text}." for text in outcome.notes)
    yield from (f"Failed: {text}." for text in [*outcome.failures(), *outcome.hints])
