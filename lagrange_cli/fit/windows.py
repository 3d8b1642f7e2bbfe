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

from ..arithmetic.types import Array
from ..errors import LagtopError
from .fit import best_fit
from .noise import CHANCE
from .outcome import GOOD, Outcome
from .problem import Known
from .recording import Recording

_SURE = 3.0
"""Standard deviations from which a decay is significant."""


class Decay(NamedTuple):
    """The exponential decay of r0 or of b."""

    quantity: str
    rate: float
    """The relative rate of decay."""
    rate_std: float
    chi2_dof: float
    """Chi^2 per degree of freedom of the line through the logarithms."""

    @property
    def time(self) -> tuple[float, float] | None:
        """The decay time 1/rate and its standard deviation; None if no decay is significant."""
        if self.rate <= _SURE * self.rate_std:
            return None
        return 1 / self.rate, self.rate_std / self.rate**2


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
    rates, stds = _at_one_torque(good, name)
    t = np.array([x.recording.t_start + x.recording.t[-1] / 2 for x in good])
    weights = np.abs(rates / stds)
    (slope, level), spread = np.polyfit(t, np.log(np.abs(rates)), 1, w=weights, cov="unscaled")
    off = weights * (np.log(np.abs(rates)) - level - slope * t)
    return Decay(name, -float(slope), math.sqrt(spread[0, 0]), float(off @ off) / (len(good) - 2))


def _at_one_torque(outcomes: Sequence[Outcome], name: str) -> tuple[Array, Array]:
    """Return r0 or b of windows, and their standard deviations, at the mean torque of all."""
    values, stds = np.array([x.numbers[name] for x in outcomes]).T
    if not all(("a", name) in x.covariance for x in outcomes):
        return values, stds
    torque, torque_std = np.array([x.numbers["a"] for x in outcomes]).T
    both = np.array([x.covariance["a", name] for x in outcomes])
    slopes = both / torque_std**2
    mean = np.average(torque, weights=torque_std**-2)
    return values + slopes * (mean - torque), np.sqrt(stds**2 - slopes * both)
