"""Harmonics and mean rates of a recorded angle.

Sums of harmonics are fitted to an angle, or to the cosine of one.  Frames that differ by a turn
look alike, so rates are known up to whole turns per frame.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..inputs.rotations import within_half_turn

_HARMONICS = 4
_FREQUENCIES = 49
_MANY = 60
"""Number of rows from which a fine series has twice the harmonics."""
_BETTER = 0.9
"""Ratio of noise below which twice the harmonics are accepted."""
_DIPS = 4
"""Number of dips of the residual whose frequencies are refined."""
_AS_GOOD = 1.2
"""Residual of an equally good frequency, over the least; noise causes this difference."""
_MOST_ROWS = 4000
_CELLS, _MOST_CELLS = 4, 1 << 18
"""Cells of a spectrum per frame, and in all, because times need not be evenly spaced."""
_ALIASES = range(-3, 4)
"""Turns per frame that are tried."""


class Harmonics(NamedTuple):
    """A sum of harmonics, with or without linear growth, fitted to data."""

    frequency: float
    order: int
    """The order of the highest harmonic."""
    factors: Array
    grows: bool
    misfit: float
    """Sum of the squares of the residuals."""
    noise: float
    """Standard deviation of the residuals."""

    @property
    def growth(self) -> float:
        """The mean rate of a series with linear growth."""
        return float(self.factors[-1])

    def at(self, t: Array) -> Array:
        """Return the values of the series at times t."""
        values: Array = _basis(t, self.frequency, self.order, grows=self.grows) @ self.factors
        return values


class Signal(NamedTuple):
    """A recorded quantity that is periodic, or periodic except for a mean rate."""

    t: Array
    y: Array
    grows: bool = False
    rate: float = 0.0
    """A rate that was subtracted from the values before their turns were counted."""

    def series(
        self, frequency: float, *, fine: bool = False, weights: Array | None = None
    ) -> Harmonics:
        """Return the series of a frequency that fits best, with `rate` added to its mean rate.

        A `fine` series has the number of harmonics with the least noise.
        """
        order = 2 * self._order if fine and self.t.size > _MANY else self._order
        series = self._fitted(frequency, order, weights)
        while fine and 6 * series.order < self.t.size:
            finer = self._fitted(frequency, 2 * series.order, weights)
            if not finer.noise < _BETTER * series.noise:
                break
            series = finer
        if self.grows:
            series.factors[-1] += self.rate
        return series

    @property
    def _order(self) -> int:
        return int(min(_HARMONICS, max((self.t.size - 3) // 4, 1)))

    def _fitted(self, frequency: float, order: int, weights: Array | None = None) -> Harmonics:
        basis, y = _basis(self.t, frequency, order, grows=self.grows), self.y
        if weights is not None:
            basis, y = basis * weights[:, np.newaxis], y * weights
        factors = np.asarray(np.linalg.lstsq(basis, y, rcond=None)[0], dtype=np.float64)
        left = float(np.sum((y - basis @ factors) ** 2))
        noise = float(np.sqrt(left / max(self.t.size - factors.size, 1)))
        return Harmonics(frequency, order, factors, self.grows, left, noise)

    @property
    def _around(self) -> Array:
        """The values less their mean or, if they grow, less a straight line."""
        return self.y - np.polyval(np.polyfit(self.t, self.y, int(self.grows)), self.t)

    def clearness(self, series: Harmonics) -> float:
        """Return the mean variance that a harmonic explains, over the variance of the noise."""
        explained = (float(np.sum(self._around**2)) - series.misfit) / (2 * series.order)
        return explained / max(series.noise**2, 1e-300)

    def frequency(self) -> float:
        """Return the frequency whose harmonics fit best, near the peak of the spectrum."""
        from scipy.optimize import minimize_scalar

        t, span = self.t, float(self.t[-1] - self.t[0])
        even = np.linspace(t[0], t[-1], min(4 * t.size, 4096))
        values = np.interp(even, t, self._around)
        sizes = np.abs(np.fft.rfft(values - values.mean(), 4 * even.size))
        frequencies = np.fft.rfftfreq(4 * even.size, even[1] - even[0])
        sizes[frequencies < 0.7 / span] = 0.0
        peak = float(frequencies[int(np.argmax(sizes))])

        def left(frequency: float) -> float:
            return self._fitted(frequency, self._order).misfit

        tried = np.linspace(max(peak - 1 / span, 0.8 / span), peak + 1 / span, _FREQUENCIES)
        sums = np.array([left(x) for x in tried.tolist()])
        dips = np.flatnonzero((sums[1:-1] <= sums[:-2]) & (sums[1:-1] <= sums[2:])) + 1
        deepest = dips[np.argsort(sums[dips])][:_DIPS]
        if not deepest.size:
            return float(tried[int(np.argmin(sums))])
        refined = [
            minimize_scalar(left, bounds=(tried[i - 1], tried[i + 1]), method="bounded")
            for i in deepest.tolist()
        ]
        least = min(x.fun for x in refined)
        # a half of the frequency, or a third, explains as much
        return max(float(x.x) for x in refined if x.fun <= _AS_GOOD * least)


def _basis(t: Array, frequency: float, order: int, *, grows: bool) -> Array:
    turns = 2 * np.pi * frequency * t[:, np.newaxis] * np.arange(1, order + 1)
    columns = [np.ones((t.size, 1)), np.cos(turns), np.sin(turns), t[:, np.newaxis]]
    return np.concatenate(columns if grows else columns[:3], axis=1)


def frame_of(t: Array) -> float:
    """Return the time between two frames."""
    steps = np.diff(t)
    return float(np.median(steps[steps > 0]))


def turning_rate(t: Array, angle: Array) -> float:
    """Return the mean rate of an angle in radians, of which NaN is missing."""
    rows = np.flatnonzero(np.isfinite(angle))[:_MOST_ROWS]
    t, turned = t[rows] - t[rows[0]], np.exp(1j * angle[rows])
    frame = frame_of(t)
    cell = frame / _CELLS
    cells = np.zeros(min(int(t[-1] / cell) + 1, _MOST_CELLS), dtype=np.complex128)
    places = np.rint(t / cell).astype(np.intp)
    np.add.at(cells, places[places < cells.size], turned[places < cells.size])
    sums = np.abs(np.fft.fft(cells, 4 * cells.size))
    rates = 2 * math.pi * np.fft.fftfreq(4 * cells.size, cell)
    sums[np.abs(rates) > math.pi / frame] = 0.0
    rate = float(rates[int(np.argmax(sums))])
    left = np.angle(turned * np.exp(-1j * rate * t))
    left = within_half_turn(left - np.angle(np.sum(np.exp(1j * left))))
    return rate + float(np.polyfit(t, left, 1)[0])


def slowest_spin(r0: float, b: float, b_std: float, frame: float) -> float:
    """Return the slowest spin rate that looks like r0 and that a rigid body can have.

    A body has 0 < C/A = b/r0 <= 2; b is taken within two standard deviations.  If no rate is
    possible, r0 is returned.
    """
    alike = [r0 + 2 * math.pi / frame * turns for turns in _ALIASES]
    possible = [x for x in alike if -2 * b_std < b * math.copysign(1, x) <= 2 * abs(x) + 2 * b_std]
    return min(possible, key=abs, default=r0)
