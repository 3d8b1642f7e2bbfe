"""A recording in equal windows, each fitted for itself, and the decay of the spin through them.

Friction slows a real top, but the closed form has no friction.  Within a short window the loss is
below the noise.  A line through the logarithms of r0, or of b if the spin is not recorded, gives
the decay time.  The torque a = 2mgs/A does not decay: for this line, the fits are corrected to the
weighted mean of a, with which their errors of b and r0 correlate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..errors import LagtopError
from ..output.report import uncertain_text
from .fit import best_fit
from .noise import CHANCE
from .outcome import GOOD, Outcome
from .problem import Known
from .recording import Recording

_SURE = 3.0
"""Standard deviations from which a decay is significant."""


class Decay(NamedTuple):
    """The exponential decay of r0 or of b, and its relative rate."""

    quantity: str
    rate: float
    rate_std: float
    time: float | None
    """The decay time 1/rate and its standard deviation; None if no decay is significant."""
    time_std: float | None
    chi2_dof: float
    """Chi^2 per degree of freedom of the line through the logarithms."""

    def __str__(self) -> str:
        quality = f"chi2/dof of the exponential: {self.chi2_dof:.2f}"
        if self.time is None or self.time_std is None:
            shown = f"does not decay: its relative rate is {uncertain_text(*self[1:3])}"
        else:
            shown = f"decays with a time of {uncertain_text(self.time, self.time_std)}"
        return f"{self.quantity} {shown}; {quality}."


def fit_windows(
    recording: Recording, count: int, known: Known, *, radians: bool = False
) -> list[Outcome]:
    """Return the fits of equal windows of a recording.

    Raises LagtopError for a bad number of windows, or for a known input of one instant.
    """
    for name in known.keys() & {"r0", "theta0", "thetadot0", "psidot0"}:
        raise LagtopError(f"{name} is not the same in all windows: leave it out", name)
    return [
        best_fit(part, known, radians=radians, chance=CHANCE / count, helpful=False)
        for part in recording.windows(count)
    ]


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
    t = np.array([x.middle for x in good])
    logs, weights = np.log(np.abs(values)), np.abs(values / stds)
    (slope, level), spread = np.polyfit(t, logs, 1, w=weights, cov="unscaled")
    off, rate, std = weights * (logs - level - slope * t), -float(slope), math.sqrt(spread[0, 0])
    time = (1 / rate, std / rate**2) if rate > _SURE * std else (None, None)
    return Decay(name, rate, std, time[0], time[1], float(off @ off) / (len(good) - 2))
