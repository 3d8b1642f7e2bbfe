"""The report on a fit, its scene file, and the curves of its picture."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..inputs.input_keys import TILT
from ..inputs.rotations import within_half_turn
from ..motion.quantity import unit_name
from ..motion.record import shown_keys
from ..output.report import Field, Report, uncertain_text, with_unit
from ..output.terminal import one_line
from .model import chi2_bounds
from .record import MUCH_CHI2, Outcome
from .windows import WindowedFit

if TYPE_CHECKING:
    from ..inputs.units import System
_FIELDS = [
    Field("name", "recording", is_text=True, names_the_row=True),
    Field("key", "key", is_text=True),
    Field("value", "value", is_text=True),
    Field("meaning", "meaning", is_text=True),
]
_FINE = 1200
"""Points of a curve."""


class FittedCurve(NamedTuple):
    """One channel of a recording and the fitted motion, in the unit of angles in use."""

    name: str
    """`theta`, `phi` or `psi`; with several recordings, after the name of one and a colon."""
    t: Array
    data: Array
    """Measured values; NaN if missing."""
    fine_t: Array
    curve: Array
    """The motion at the fine times."""
    residual: Array
    """Residuals (data minus motion) at the times t."""


def outcome_units(outcome: Outcome, system: System) -> dict[str, str]:
    """Return the units of the keys in the record of an outcome, in a system of units."""
    units = {"t_start": system.named("time")}
    for product, _ in outcome.products():
        units[product.name] = system.unit_of(product.powers)
    declared = shown_keys(named=system.named, requested=True)
    for key in outcome.record():
        if key.endswith(("_deg", "_rad")):
            units[key] = key[-3:]
        elif key in declared:
            units[key] = declared[key].unit
    return {key: unit for key, unit in units.items() if unit}


def fit_report(outcomes: Sequence[Outcome], source: str, system: System | None) -> Report:
    """Return the report on the outcomes of the recordings of a file.

    If inputs have units, the report names units of `system`.
    """
    lines = [line for outcome in outcomes for line in _lines(outcome, system)]
    fields = _FIELDS if outcomes[0].recording.name else _FIELDS[1:]
    conclusions = [text for outcome in outcomes for text in _conclusions(outcome)]
    return Report(_conditions(outcomes, source, system), fields, lines, conclusions)


def _lines(outcome: Outcome, system: System | None) -> Iterator[SimpleNamespace]:
    name, units = outcome.recording.name, outcome_units(outcome, system) if system else {}
    for key, value, deviation, meaning in outcome.numbers():
        text, shown = uncertain_text(value, deviation), with_unit(key, units.get(key))
        yield SimpleNamespace(name=name, key=shown, value=text, meaning=meaning)


def _conditions(outcomes: Sequence[Outcome], source: str, system: System | None) -> dict[str, str]:
    first = outcomes[0]
    units = outcome_units(first, system) if system else {}

    def text(name: str, value: float) -> str:
        return f"{name} = {value:g} {units.get(name, '')}".rstrip()

    rows = sum(outcome.recording.t.size for outcome in outcomes)
    channels = ", ".join(first.recording.channels)
    certain = {x: y for x, y in first.known.items() if not first.deviations.get(x)}
    scaled = [(*first.shown_as(x), y) for x, y in certain.items()]
    known = ", ".join(text(key, y * scale) for key, scale, y in scaled)
    if first.stds:
        known += f"{'; ' if known else ''}with uncertainty: {', '.join(first.stds)}"
    start = text("t_start", first.recording.t_start).replace("t_start", "t")
    return {
        "data": f"{source}: {rows} rows of {channels}, from {start}",
        "known": known or "nothing",
        "sigma": "as given" if first.fit.sigma_known else "estimated from the residuals",
    }


def _conclusions(outcome: Outcome) -> Iterator[str]:
    """Yield sentences on one recording."""
    name = f"{outcome.recording.name}: " if outcome.recording.name else ""
    if outcome.fit.sigma_known:
        low, high = chi2_bounds(max(outcome.fit.dof, 1))
        bounds = f"{low:.3f} to {high:.3f}"
        yield f"{name}chi2/dof = {outcome.chi2_dof:.3f}, noise {bounds}; {outcome.fit.dof} dof."
    scale = outcome.per_radian
    rest = ", ".join(f"{x} {y.rms * scale:.3g}" for x, y in outcome.residuals.items())
    yield f"{name}RMS residual ({outcome.angle}): {rest}."
    related = ", ".join(f"{x} and {y} {z:.2f}" for x, y, z in outcome.correlations())
    if related:
        yield f"{name}Correlation: {related}."
    for text in [*outcome.notes(), *outcome.undetermined()]:
        yield f"{name}{text}."
    for text in outcome.warnings():
        yield f"{name}Warning: {text}."


def windows_report(found: WindowedFit, source: str, system: System | None) -> Report:
    """Return the report on a fit in windows: a row for each, the body, and the decay."""
    first = found.windows[0].outcome
    name = "r0" if first.fit.parameters.spins else "b"
    columns = [name, "theta0_deg", "T_nutation", "T_precession"]
    columns = [unit_name(x, radians=first.radians) for x in columns]
    units = outcome_units(first, system) if system else {}
    fields = [
        Field("t", with_unit("t", units.get("t_start")), lambda t: f"{t:.6g}"),
        *(Field(x, with_unit(x, units.get(x)), str, is_text=True) for x in columns),
        Field("chi2_dof", "chi2/dof", lambda x: f"{x:.3f}"),
        Field("verdict", "verdict", is_text=True),
    ]
    rows = [window.row() for window in found.windows]
    shown = [dict.fromkeys(columns) | row | _uncertain_texts(row, columns) for row in rows]
    record = found.record()
    body = _uncertain_texts(record, [x for x in record if "decay" not in x])
    conclusions = [f"Body: {', '.join(f'{x} = {y}' for x, y in body.items())}."]
    return Report(
        _conditions([x.outcome for x in found.windows], source, system),
        fields,
        [SimpleNamespace(**row) for row in shown],
        conclusions + list(_windows_conclusions(found)),
    )


def _uncertain_texts(record: Mapping[str, Any], keys: Iterable[str]) -> dict[str, str]:
    """Return the numbers of a record that have a standard deviation, as texts by key."""
    return {x: uncertain_text(record[x], record[f"{x}_std"]) for x in keys if f"{x}_std" in record}


def _windows_conclusions(found: WindowedFit) -> Iterator[str]:
    decay, outcome = found.decay, found.windows[0].outcome
    if not found.is_described:
        yield "No window is described, so no decay is known: use shorter windows."
    elif decay.chi2_dof > MUCH_CHI2:
        shown = f"chi2/dof of the exponential: {decay.chi2_dof:.3g}"
        yield f"{decay.quantity} does not change exponentially; {shown}."
    elif decay.time is None:
        shown = uncertain_text(decay.rate, decay.rate_std)
        yield f"{decay.quantity} does not decay: its relative rate of decay is {shown}."
    else:
        time = uncertain_text(*decay.time)
        yield (
            f"{decay.quantity} decays with a time of {time}; "
            f"chi2/dof of the exponential: {decay.chi2_dof:.2f}."
        )
    count = len(found.windows)
    good = sum(window.verdict == "good" for window in found.windows)
    yield f"The closed form describes {good} of {count} windows; chi2/dof {outcome.chi2_dof:.3f}."
    for text in [*outcome.notes(), *outcome.failures()]:
        yield f"{text[0].upper()}{text[1:]}."


def scene_text(outcome: Outcome, source: str, system: System | None = None) -> str:
    """Return a scene file of the motion, with units if a `system` is given."""
    lines = [
        f"# Found by `lagtop fit` from {one_line(source)}: the start is its first row, at "
        f"t = {outcome.recording.t_start!r}.",
        *(f"# {text}: one of them is assumed." for text in outcome.undetermined()),
        *(f"# Warning: {text}." for text in outcome.warnings()),
    ]
    stds, _ = _spread_of_inputs(outcome)
    units = {} if system is None else outcome_units(outcome, system)
    for name, value in outcome.inputs().items():
        unit = "" if name.startswith(TILT) else units.get(name, "")  # the key of a tilt names it
        shown = f"{value!r} +/- {stds[name]!r}" if name in stds else repr(value)
        text = f"{shown} {unit}".rstrip()
        lines.append(f"{name} = {text}" if text == repr(value) else f'{name} = "{text}"')
    return "".join(f"{line}\n" for line in lines)


def _spread_of_inputs(outcome: Outcome) -> tuple[dict[str, float], Array]:
    """Return the standard deviations of uncertain inputs, and the matrix of correlations.

    Each input is a product of powers of the quantities: a doubled quantity shows its power.
    """
    inputs = {name: x for name, x in outcome.inputs().items() if x}
    slopes = np.zeros((len(inputs), len(outcome.labels)))
    for i, (name, value) in enumerate(outcome.values.items()):
        if value and outcome.deviations[name]:
            twice = outcome.inputs(outcome.values | {name: 2 * value})
            powers = np.log2([twice[x] / y for x, y in inputs.items()])
            slopes[:, i] = powers * [*inputs.values()] / value
    covariance = slopes @ outcome.covariance @ slopes.T
    known = np.flatnonzero(np.diag(covariance))
    deviations = np.sqrt(np.diag(covariance))[known]
    stds = {[*inputs][i]: std for i, std in zip(known, deviations.tolist(), strict=True)}
    correlations = covariance[np.ix_(known, known)] / np.outer(deviations, deviations)
    return stds, np.clip(correlations, -1.0, 1.0)


def curves_of(outcome: Outcome) -> Iterator[FittedCurve]:
    """Yield the curves of one recording, in the unit of angles in use.

    The measured angles are shifted by whole turns to the fitted motion.
    """
    recording, scale = outcome.recording, outcome.per_radian
    t, fine, start = recording.t, np.linspace(0, recording.t[-1], _FINE), recording.t_start
    at_rows, at_fine = outcome.angles(t), outcome.angles(fine)
    for name in [x for x in ("theta", "psi", "phi") if x in recording.angles]:
        left = within_half_turn(recording.angles[name] - at_rows[name])
        data = (at_rows[name] + left) * scale
        label = f"{recording.name}: {name}" if recording.name else name
        yield FittedCurve(label, t + start, data, fine + start, at_fine[name] * scale, left * scale)
