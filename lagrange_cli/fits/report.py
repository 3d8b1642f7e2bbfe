"""The report on a fit: what was found of each recording, and what may be concluded."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ..output.findings import Field, Findings
from ..output.uncertain_text import uncertain_text
from .quality import chi2_bounds
from .record import MEANINGS, Outcome


class Line(NamedTuple):
    """A number of one recording."""

    name: str
    key: str
    value: str
    meaning: str


_FIELDS = [
    Field("name", "recording", is_text=True, names_the_row=True),
    Field("key", "key", is_text=True),
    Field("value", "value", is_text=True),
    Field("meaning", "meaning", is_text=True),
]


def report(outcomes: Sequence[Outcome], source: str) -> Findings:
    """Return the report on the outcomes of the recordings of a file."""
    lines = [line for outcome in outcomes for line in _lines(outcome)]
    fields = _FIELDS if outcomes[0].recording.name else _FIELDS[1:]
    conclusions = [text for outcome in outcomes for text in _conclusions(outcome)]
    return Findings(_conditions(outcomes, source), fields, lines, conclusions)


def _lines(outcome: Outcome) -> Iterator[Line]:
    name = outcome.recording.name
    for key, value, deviation in outcome.found():
        scale = outcome.scale(key)
        text = uncertain_text(value * scale, deviation * scale)
        yield Line(name, outcome.unit(key), text, MEANINGS[key])
    for told, deviation in outcome.products():
        single = len(told.powers) == 1
        meaning = "" if single else "not to be told apart"
        yield Line(name, told.name, uncertain_text(told.value, deviation), meaning)


def _conditions(outcomes: Sequence[Outcome], source: str) -> dict[str, str]:
    first = outcomes[0]
    rows = sum(outcome.recording.t.size for outcome in outcomes)
    channels = ", ".join(first.recording.channels)
    known = ", ".join(f"{first.unit(x)} = {y * first.scale(x):g}" for x, y in first.known.items())
    return {
        "data": f"{source}: {rows} rows of {channels}, from t = {first.recording.t_start:g}",
        "known": known or "nothing",
        "sigma": "as given" if first.fit.sigma_known else "that of what is left",
    }


def _conclusions(outcome: Outcome) -> Iterator[str]:
    """Yield sentences on one recording."""
    name = f"{outcome.recording.name}: " if outcome.recording.name else ""
    solution = outcome.fit.solution
    if outcome.fit.sigma_known:
        low, high = chi2_bounds(max(solution.dof, 1))
        bounds = f"{low:.3f} to {high:.3f}"
        yield f"{name}chi2/dof = {outcome.chi2_dof:.3f}, noise {bounds}; {solution.dof} dof."
    unit, scale = ("rad", 1.0) if outcome.radians else ("deg", 180 / math.pi)
    rest = ", ".join(f"{x} {y.rms * scale:.3g}" for x, y in outcome.remainders.items())
    yield f"{name}Left, rms in {unit}: {rest}."
    related = ", ".join(f"{x} and {y} {z:.2f}" for x, y, z in outcome.correlations())
    if related:
        yield f"{name}Correlation: {related}."
    for text in [*outcome.notes(), *outcome.untold()]:
        yield f"{name}{text}."
    for text in outcome.warnings():
        yield f"{name}Warning: {text}."
