"""What a recording shows of the nutation: its period, its turning points and the mean precession.

The cosine of the tilt is periodic, and so is the precession but for its growth: both are fitted by
a few harmonics, whose frequency is searched for around the peak of the spectrum.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.types import Array
from ..errors import DataError
from .recording import Recording
from .turning_points import Nutation

_MOST_ROWS = 3000
"""Rows that are enough to start from; of more, so many are drawn."""
_HARMONICS = 4
_FREQUENCIES = 49
_MANY = 60
"""Rows from which on twice the harmonics are fitted."""
_LEAST_F = 8.0
"""How many times the noise, per harmonic, a nutation must explain: what noise does by chance in the
best of all frequencies is less.
"""
_DIPS = 4
"""Frequencies that are looked at closely, where what is left has a dip."""
_AS_GOOD = 1.2
"""How much more than the least a frequency may leave that is as good: noise makes that much."""
_EDGE = 1e-4
"""Least distance of a turning point from a pole."""


class Shown(NamedTuple):
    """What a recording shows of a nutation."""

    nutation: Nutation
    u_start: float
    """The cosine of the tilt in the first row."""
    falls: float
    """1 where the tilt grows there, else -1."""
    noise: float
    """What the harmonics leave of the cosine, as a standard deviation."""
    mean_rates: list[float]
    """Mean precession rates that go with the angles, which are known within whole turns; the first
    one is the likeliest.  Empty where psi is not given.
    """


def shown_by(recording: Recording, where: str) -> Shown:
    """Return what a recording shows.  Raises DataError where it shows no nutation."""
    rows = _some_rows(recording)
    t, theta = recording.t[rows], recording.angles["theta"][rows]
    u = np.cos(theta)
    span = float(t[-1] - t[0])
    if not np.ptp(theta) > 1e-12:
        raise DataError(f"{where}: theta must vary, got {math.degrees(theta[0]):g} in all rows")
    frequency = _frequency(t, u)
    count = _harmonics(t)
    count *= 2 if t.size > _MANY else 1  # the turning points want more than the frequency
    series = _fit(t, u, frequency, count, grows=False)
    noise = series.left / max(t.size - 2 * count - 1, 1)
    explained = (np.sum((u - u.mean()) ** 2) - series.left) / (2 * count)
    if frequency * span < 1:
        raise DataError(
            f"{where}: a recording must last for a period of the nutation, got {span:g}"
        )
    if not explained > _LEAST_F * noise:
        raise DataError(f"{where}: theta must nod beyond its noise; no period explains it")
    phases = np.linspace(0, 1, 721)[:-1]
    wave = series.at(phases / frequency)
    least, greatest = np.arccos(np.clip(wave.max(), -1, 1)), np.arccos(np.clip(wave.min(), -1, 1))
    nutation = Nutation(max(least, _EDGE), min(greatest, math.pi - _EDGE), 1 / frequency)
    first, then = series.at(np.array([0.0, 1e-4 / frequency])).tolist()
    falls = 1.0 if then < first else -1.0
    return Shown(nutation, first, falls, math.sqrt(noise), _mean_rates(recording, frequency))


def _some_rows(recording: Recording, name: str = "theta") -> NDArray[np.intp]:
    """Return rows that have an angle, in their order, and not too many."""
    rows = np.flatnonzero(np.isfinite(recording.angles[name]))
    if rows.size > _MOST_ROWS:
        drawn = np.random.default_rng(0).choice(rows[1:-1], _MOST_ROWS - 2, replace=False)
        rows = np.concatenate([rows[:1], np.sort(drawn), rows[-1:]])
    return rows.astype(np.intp)


def _harmonics(t: Array) -> int:
    return int(min(_HARMONICS, max((t.size - 3) // 4, 1)))


class _Series(NamedTuple):
    """A sum of harmonics, and maybe a growth, that fits data."""

    frequency: float
    factors: Array
    grows: bool
    left: float
    """Sum of the squares that are left."""

    def at(self, t: Array) -> Array:
        """Return its values."""
        count = (self.factors.size - 1 - self.grows) // 2
        values: Array = _basis(t, self.frequency, count, self.grows) @ self.factors
        return values


def _basis(t: Array, frequency: float, count: int, grows: bool) -> Array:
    turns = 2 * np.pi * frequency * t[:, np.newaxis] * np.arange(1, count + 1)
    columns = [np.ones((t.size, 1)), np.cos(turns), np.sin(turns)]
    if grows:
        columns.append(t[:, np.newaxis])
    return np.concatenate(columns, axis=1)


def _fit(
    t: Array, y: Array, frequency: float, count: int, *, grows: bool, weights: Array | None = None
) -> _Series:
    basis = _basis(t, frequency, count, grows)
    if weights is not None:
        basis, y = basis * weights[:, np.newaxis], y * weights
    factors = np.asarray(np.linalg.lstsq(basis, y, rcond=None)[0], dtype=np.float64)
    left = float(np.sum((y - basis @ factors) ** 2))
    return _Series(frequency, factors, grows, left)


def _frequency(t: Array, u: Array) -> float:
    """Return the frequency whose harmonics leave least: near the peak of the spectrum."""
    from scipy.optimize import minimize_scalar

    span = float(t[-1] - t[0])
    even = np.linspace(t[0], t[-1], min(4 * t.size, 4096))
    values = np.interp(even, t, u)
    sizes = np.abs(np.fft.rfft(values - values.mean(), 4 * even.size))
    frequencies = np.fft.rfftfreq(4 * even.size, even[1] - even[0])
    sizes[frequencies < 0.7 / span] = 0.0
    peak = float(frequencies[int(np.argmax(sizes))])
    count = _harmonics(t)

    def left(frequency: float) -> float:
        return _fit(t, u, frequency, count, grows=False).left

    tried = np.linspace(max(peak - 1 / span, 0.8 / span), peak + 1 / span, _FREQUENCIES)
    sums = np.array([left(float(x)) for x in tried])
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


def _mean_rates(recording: Recording, frequency: float) -> list[float]:
    """Return mean precession rates, whose turns per period are not known next to a pole."""
    if "psi" not in recording.angles:
        return []
    rows = _some_rows(recording, "psi")
    t, psi = recording.t[rows], np.unwrap(recording.angles["psi"][rows])
    theta = recording.angles["theta"][rows]
    weights = np.where(np.isfinite(theta), np.abs(np.sin(theta)), 0.0) + 0.05
    rate = float(_fit(t, psi, frequency, 1, grows=True, weights=weights).factors[-1])
    turn = 2 * math.pi * frequency
    return [rate, rate - turn, rate + turn]
