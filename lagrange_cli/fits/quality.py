"""How good a fit is: chi^2 per degree of freedom, and whether what is left looks like noise."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array

_BEYOND = 0.00135
"""Probability beyond each bound of chi^2: that of three standard deviations."""
_DEVIATIONS = 3.0
"""Standard deviations, 1/sqrt(n), that the autocorrelation of noise keeps within."""
_ROUNDING = 1e-11
"""Radians that are left of data without noise."""


class Remainder(NamedTuple):
    """What is left of one channel."""

    rows: int
    rms: float
    """Root of the mean square, in radians."""
    lag1: float
    """Correlation of what is left with itself a row later."""

    @property
    def is_noise(self) -> bool:
        """Whether the correlation is within three standard deviations of 0; roundings count too."""
        return self.rms < _ROUNDING or abs(self.lag1) <= _DEVIATIONS / math.sqrt(max(self.rows, 1))


def remainder(left: list[Array]) -> Remainder:
    """Return what is left of one channel in some recordings, of which NaN is missing."""
    known = [x[np.isfinite(x)] for x in left]
    count = sum(x.size for x in known)
    total = float(sum(np.sum(x * x) for x in known))
    product = float(sum(np.sum(x[1:] * x[:-1]) for x in known))
    rms = math.sqrt(total / count) if count else 0.0
    return Remainder(count, rms, product / total if total else 0.0)


def chi2_bounds(dof: int) -> tuple[float, float]:
    """Return the bounds that chi^2/dof keeps within but for one time in 370."""
    from scipy.special import gammaincinv

    half = dof / 2
    low, high = (float(gammaincinv(half, p)) / half for p in (_BEYOND, 1 - _BEYOND))
    return low, high
