"""Checks of a fit: why it has failed, in order, and how noisy and correlated the residuals are.

A wrong motion leaves residuals above the noise, or residuals with structure.  Noise may be
correlated from row to row, as a tracker smooths it, but only within a small part of a period.
Residuals of an encoder follow its steps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc, gammaincinv, ndtri

from ..arithmetic.types import Array, Mask
from .reasons import Kind, Reason

CHANCE = 0.0027
"""Probability that noise fails a test, as for three standard deviations."""
LARGEST = 0.2
"""Largest rms residual of a channel in radians."""
_OF_RANGE = 1 / 3
"""Largest rms residual over the range of the data."""
_OF_NOISY_RANGE = 1 / 2
"""The same if they are as large as the noise of neighbours."""
_AS_NOISY = 1.5
"""Rms residual over the noise of neighbours that is noise."""
_ABOVE = 3.0
"""Largest rms residual over the noise of neighbours."""
_SMOOTHED = 2.0
"""How many times larger it may be if a filter explains how residuals correlate."""
ROUNDING = 1e-10
"""Rms of rounding errors in radians."""
_OUTLIER = 15.0
"""Least residual of an outlier, over the standard deviation of the
others, which the median estimates."""
_ROWS_PER_LAG = 2.0
"""Least number of rows per period over the reach of a correlation."""
_LAGS = 12
"""Longest reach of noise that correlates, in rows."""
_LOBE = 0.5
"""Negative correlation, over that of neighbours, that only an oscillation makes, not noise."""
_WITHIN = 0.75
"""Largest 95 % quantile of the residuals of an encoder, over its step."""


class Noise(NamedTuple):
    """What the data of a channel show of their noise, in radians."""

    step: float = 0.0
    """The least step between values."""
    neighbours: float = math.inf
    """The noise, from differences of neighbours."""
    range: float = math.inf
    """The range of the motion and the noise, of 95 % of the rows."""


@dataclass
class Residuals:
    """The residuals of a channel at times t, in radians."""

    t: Array
    y: Array
    step: float = 0.0
    """The least step between values of the channel."""
    neighbours: float = math.inf
    """The noise of the data, from differences of neighbours."""
    range: float = math.inf
    """The range of 95 % of the data, without a mean rate."""

    @property
    def is_large(self) -> bool:
        """Whether the residuals are so large that the motion describes nothing."""
        is_noise = self.rms <= _AS_NOISY * self.neighbours < math.inf
        share = _OF_NOISY_RANGE if is_noise else _OF_RANGE
        return self.rms > min(LARGEST, max(self.range * share, 2 * self.step, ROUNDING))

    @cached_property
    def rms(self) -> float:
        """The root mean square."""
        return float(np.sqrt(np.mean(self.y**2)))

    @property
    def is_white(self) -> bool:
        """Whether residuals are as small as the noise of neighbouring rows, and not correlated."""
        return self.rms <= _AS_NOISY * self.neighbours and self.widening() == 1

    @property
    def is_coarse(self) -> bool:
        """Whether the steps of an encoder explain the residuals."""
        return float(np.quantile(np.abs(self.y), 0.95)) <= _WITHIN * self.step

    @property
    def outliers(self) -> Mask:
        """Whether a residual is one that no noise has."""
        return self.beyond(_OUTLIER)

    def beyond(self, least: float) -> Mask:
        """Return which residuals are larger than this many standard deviations of the others."""
        sizes = np.abs(self.y)
        usual = max(float(np.median(sizes)) / float(ndtri(0.75)), self.step, ROUNDING)
        return np.asarray(sizes > least * usual)

    @cached_property
    def correlations(self) -> Array:
        """The correlations of residuals with those some rows later, by the number of rows."""
        if self.rms < ROUNDING:
            return np.asarray(np.arange(self.y.size) == 0, float)
        power = np.abs(np.fft.rfft(self.y, 1 << (2 * self.y.size).bit_length())) ** 2
        found = np.fft.irfft(power)[: self.y.size]
        return np.asarray(found / found[0])

    @property
    def autocorrelation(self) -> float:
        """The correlation of residuals with the next ones."""
        return float(self.correlations[1])

    @cached_property
    def reach(self) -> int:
        """The number of rows after which residuals do not correlate, 1 for white noise.

        They may not correlate for as many rows again: an oscillation passes through 0.
        """
        rest = self.correlations[1 : max(self.y.size // 4, 2)]
        rest = np.maximum(rest, np.where(rest < -_LOBE * rest[0], -rest, 0.0))
        nearer = np.cumsum(rest[:_LAGS] ** 2) - rest[:_LAGS] ** 2  # as in Bartlett's formula
        nearer = np.pad(nearer, (0, rest.size - nearer.size), mode="edge")
        large = rest >= 2.5 * np.sqrt((1 + 2 * nearer) / self.y.size)
        found = (n for n in range(1, rest.size + 1) if not large[n - 1 : 2 * n - 1].any())
        return next(found, self.y.size)

    @property
    def is_smoothed(self) -> bool:
        """Whether a filter explains how neighbours correlate.

        The correlation with the second next row is r^2 after a filter that forgets, and 2 r - 1
        after a mean of rows.  White noise and a slow oscillation together have almost r.
        """
        r, later = self.correlations[1:3]
        return bool(later < max(r * r, 2 * r - 1) + 3 * (1 - r * r) / math.sqrt(self.y.size))

    def widening(self, chance: float = CHANCE) -> float:
        """Return the factor of standard deviations for correlated noise, at least 1.

        Its square is 1 + 2 times the sum of the correlations as long as they fall and are above
        0; later correlations are noise.  The square is (1 + r)/(1 - r) if they are r^n.
        """
        if not self.is_coarse and abs(self.autocorrelation) <= _bound(self.y.size, chance):
            return 1.0
        near = self.correlations[: self.y.size // 4]
        is_noise = (near <= 0) | (np.diff(near, prepend=1.0) > 0)
        ends = int(np.argmax(is_noise)) if is_noise.any() else near.size
        return math.sqrt(1 + 2 * float(near[1:ends].sum()))

    def lost(self, frequency: float) -> float:
        """Return the share of an oscillation that a filter with these correlations takes away.

        A filter of variance v, in rows^2, multiplies it by 1 - w^2 v/2, and the correlations of
        white noise have the variance 2 v after it.
        """
        if self.is_coarse:
            return 0.0
        rows, found = np.arange(1, min(self.reach, self.y.size // 4)), self.correlations
        near = found[1 : rows.size + 1]
        variance = float(rows**2 @ near) / max(1 + 2 * float(near.sum()), 0.1)
        step = float(self.t[-1] - self.t[0]) / self.y.size
        return max((2 * math.pi * frequency * step) ** 2 * variance / 2, 0.0)

    def structure(self, frequency: float, chance: float = CHANCE) -> tuple[float, float]:
        """Return how much a drifting oscillation exceeds noise, and the probability of noise.

        An F test of three harmonics of a frequency, times 1, t and t^2, against the rest, which
        may be correlated from row to row.  Harmonics describe much of the noise of few rows, too:
        if a filter explains all residuals better, their correlation counts instead.
        """
        if self.rms < max(ROUNDING, self.step / 100):
            return 1.0, 1.0
        size = -(-self.t.size // 4000)
        t, y = (x[: x.size // size * size].reshape(-1, size).mean(1) for x in (self.t, self.y))
        x, whole = 2 * t / max(float(t[-1]), 1e-300) - 1, Residuals(t, y, self.step)
        waves = np.exp(2j * np.pi * frequency * np.outer(t, range(4)))
        drifting = waves[..., np.newaxis] * x[:, np.newaxis, np.newaxis] ** range(3)
        basis = np.stack([drifting.real, drifting.imag], axis=-1).reshape(x.size, -1)
        basis = basis[:, basis.any(axis=0)][:, : max(x.size // 3, 1)]
        wide = whole.widening(chance) ** 2 if whole.filter_beats(basis) else 1.0
        basis = basis[:, : max(int(x.size / wide / 3), 1)]
        factors, _, count, _ = np.linalg.lstsq(basis, y, rcond=1e-6)
        shown = basis @ factors
        explained, rest = float(shown @ shown), Residuals(t, y - shown, self.step)
        dof = max(x.size / max(wide, rest.widening(chance) ** 2) - count, 1.0)
        noise = max(float(rest.y @ rest.y), 1e-12 * explained) / dof
        ratio = explained / count / noise
        return ratio, float(fdtrc(count, dof, ratio))

    def filter_beats(self, basis: Array) -> bool:
        """Return whether a filter explains the residuals better than some columns of a basis.

        The filter has one parameter, r, which multiplies the likelihood by (1 - r^2)^(-n/2).
        """
        count, r = self.y.size, self.autocorrelation
        parts = (np.linalg.qr(basis)[0].T @ self.y) ** 2 / float(self.y @ self.y)
        left = np.log(np.maximum(1 - np.cumsum(parts), 1e-12))
        others = count * left + math.log(count) * np.arange(parts.size)
        return self.is_smoothed and count * math.log(1 - r * r + 1e-12) < others.min()

    def faults(self, name: str, frequency: float, chance: float) -> Iterator[Reason]:
        """Yield why the residuals are not noise."""
        for text in self._faults(name, frequency, chance):
            yield Reason(Kind.RESIDUALS, text)

    def _faults(self, name: str, frequency: float, chance: float) -> Iterator[str]:
        """Yield the same in words.

        A wrong motion leaves neighbours alike, unless it oscillates from row to row.
        """
        if self.is_coarse:
            return
        shown, correlation = f"the residuals of {name} are not noise", self.autocorrelation
        bound = _bound(self.y.size, chance)
        alike = f"{shown}: neighbours correlate by {correlation:.2f}"
        rows_per_period = self.y.size / max(frequency * float(self.t[-1]), 1.0)
        is_far = correlation > bound and self.reach > min(rows_per_period / _ROWS_PER_LAG, _LAGS)
        above = _ABOVE * (_SMOOTHED if correlation > bound and self.is_smoothed else 1.0)
        if self.rms > above * max(self.neighbours, self.step / math.sqrt(12), ROUNDING):
            times = self.rms / max(self.neighbours, ROUNDING)
            yield f"{shown}: they are {times:.3g} times the differences between neighbours"
        elif correlation < -2 * bound:
            yield alike
        elif is_far or (correlation > 2 * bound and not self.is_smoothed):
            yield f"{alike}, noise by at most {bound:.2f}"
        elif self.structure(frequency, chance)[1] < chance:
            yield f"{shown}: they drift or oscillate"


def _bound(count: int, chance: float) -> float:
    """Return the correlation of neighbours that noise exceeds with a probability."""
    return -float(ndtri(chance / 2)) / math.sqrt(count)


def chi2_bounds(freedom: float, chance: float = CHANCE) -> tuple[float, float]:
    """Return the bounds that chi^2 per degree of freedom of noise exceeds with this probability."""
    half = max(freedom, 1) / 2
    low, high = (float(gammaincinv(half, p)) / half for p in (chance / 2, 1 - chance / 2))
    return low, high
