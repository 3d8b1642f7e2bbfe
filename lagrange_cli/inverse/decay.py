"""Windows of a recording, and the decay of the spin through them.

Friction slows a real top, but the closed form has no friction.  Within a short window the loss is
below the noise.  A line through the logarithms of r0, or of b if r0 is not known, gives the decay
time.  The errors of known inputs are common to all windows, and cancel.  The torque a = 2mgs/A does
not decay: the fits are corrected to the weighted mean of a, with which their errors correlate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arithmetic.text import uncertain_text
from ..errors import LagtopError
from ..top.inputs import BODY, replaced_by
from ..top.units import DEGREES, Units
from .known import Known
from .measured import Measured
from .outcome import GOOD, Outcome
from .residuals import CHANCE
from .search import best_fit

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
    level: float
    """The logarithm of the size at t = 0, and the sign."""
    sign: float

    def value(self, t: float) -> float:
        """Return the quantity at a time."""
        return self.sign * math.exp(self.level - self.rate * t)

    def __str__(self) -> str:
        shown = f"does not decay: its relative rate is {uncertain_text(*self[1:3])}"
        if self.time is not None and self.time_std is not None:
            shown = f"decays with a time of {uncertain_text(self.time, self.time_std)}"
        return f"{self.quantity} {shown}; chi2/dof of the exponential: {self.chi2_dof:.2f}."


def fit_windows(
    recording: Measured, count: int, known: Known, units: Units = DEGREES
) -> list[Outcome]:
    """Return the fits of equal windows of a recording.

    Raises LagtopError for a bad number of windows, or for a known input of one instant.
    """
    for name in [x for x in known if replaced_by(x) not in BODY]:
        key = "psidot0" if name == "steady" else name
        remedy = "leave it out"
        if len(recording.angles) == 1:
            remedy = f"windows need more than {next(iter(recording.angles))}"
        raise LagtopError(f"{key} is not the same in all windows: {remedy}", key)
    return [
        best_fit(part, known, chance=CHANCE / count, units=units)
        for part in recording.windows(count)
    ]


def decay_of(outcomes: Sequence[Outcome], *, is_good: bool = True) -> Decay | None:
    """Return the decay through windows that are good, or all; None of fewer than three."""
    good = [x for x in outcomes if x.verdict == GOOD or not is_good]
    if len(good) < 3:
        return None
    name = "r0" if all("r0" in x.numbers for x in good) else "b"
    values, stds = np.array([(x.numbers[name].value, x.numbers[name].own_std) for x in good]).T
    if all((pair := f"a and {name}") in x.correlations for x in good):
        torque, torque_std = np.array([x.numbers["a"][:2] for x in good]).T
        shared = stds * [x.correlations[pair] for x in good]
        mean = np.average(torque, weights=torque_std**-2)
        values = values + shared / torque_std * (mean - torque)
        stds = np.sqrt(stds**2 - shared**2)
    t = np.array([x.recording.middle for x in good])
    logs, weights = np.log(np.abs(values)), np.abs(values / stds)
    (slope, level), spread = np.polyfit(t, logs, 1, w=weights, cov="unscaled")
    off, rate, std = weights * (logs - level - slope * t), -float(slope), math.sqrt(spread[0, 0])
    time, time_std = (1 / rate, std / rate**2) if rate > _SURE * std else (None, None)
    chi2, sign = float(off @ off) / (len(good) - 2), float(np.sign(values[0]))
    return Decay(name, rate, std, time, time_std, chi2, float(level), sign)


def decay_text(outcomes: Sequence[Outcome]) -> str:
    """Return a sentence on the decay of the spin through windows."""
    return str(decay_of(outcomes) or "Fewer than three windows are good: the decay is not known.")
