"""Tests of residuals: whether they are noise, without structure in time."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc, gammaincinv, ndtri

from ..arithmetic.types import Array

CHANCE = 0.0027
"""Probability that noise fails a test, as for three standard deviations."""
_HARMONICS = 3
_DRIFTS = 3
_ROUNDING = 1e-10
"""Residuals in radians below which they are rounding errors."""


class Residuals(NamedTuple):
    """The residuals of a channel at times t, in radians."""

    t: Array
    y: Array

    @property
    def rms(self) -> float:
        """The root mean square."""
        return float(np.sqrt(np.mean(self.y**2)))

    @property
    def autocorrelation(self) -> float:
        """The correlation of residuals with the next ones."""
        if self.rms < _ROUNDING or self.y.size < 2:
            return 0.0
        return float(self.y[1:] @ self.y[:-1] / (self.y @ self.y))

    def structure(self, frequency: float) -> float:
        """Return the probability that noise resembles a drifting oscillation as much.

        The description is harmonics of a frequency, times 1, t and t^2: an F test compares how much
        of the residuals it explains with the rest.
        """
        x = 2 * self.t / max(float(self.t[-1]), 1e-300) - 1
        turns = 2 * np.pi * frequency * self.t[:, np.newaxis] * np.arange(1, _HARMONICS + 1)
        waves = np.concatenate([np.ones((x.size, 1)), np.cos(turns), np.sin(turns)], axis=1)
        basis = (waves[:, :, np.newaxis] * x[:, np.newaxis, np.newaxis] ** range(_DRIFTS)).reshape(
            x.size, -1
        )
        basis = basis[:, : max(x.size // 3, 1)]
        space, sizes, _ = np.linalg.svd(basis, full_matrices=False)
        space = space[:, sizes > 1e-6 * sizes[0]]
        count, free = space.shape[1], x.size - space.shape[1]
        explained = float(np.sum((space.T @ self.y) ** 2))
        rest = float(self.y @ self.y) - explained
        if free < 1 or self.rms < _ROUNDING:
            return 1.0
        return float(fdtrc(count, free, explained / count / (rest / free)))

    def faults(self, name: str, frequency: float, chance: float) -> list[str]:
        """Return why the residuals are not noise, as sentences.

        A wrong motion leaves neighbours alike, unless it oscillates from row to row.
        """
        bound = -float(ndtri(chance / 2)) / math.sqrt(self.y.size)
        if not -2 * bound < self.autocorrelation < bound:
            return [
                f"the residuals of {name} are not noise: neighbours correlate by "
                f"{self.autocorrelation:.2f}, noise by at most {bound:.2f}"
            ]
        if self.structure(frequency) < chance:
            return [f"the residuals of {name} are not noise: they drift or oscillate"]
        return []


def chi2_bounds(freedom: int, chance: float = CHANCE) -> tuple[float, float]:
    """Return the bounds that chi^2 per degree of freedom of noise exceeds with this probability."""
    half = max(freedom, 1) / 2
    low, high = (float(gammaincinv(half, p)) / half for p in (chance / 2, 1 - chance / 2))
    return low, high
