"""The nutation that a recording shows: signals without whole turns, their period and their noise.

The cosine of the tilt is periodic, and so are spin and precession apart from a mean rate.
Harmonics of one frequency describe all of them.  Long recordings are averaged, never cut.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from ..arithmetic.types import Array
from .measured import ANGLE_OF, LEAST_ROWS, Measured, are_whole

_MOST_ROWS = 700
"""Rows of the search for a frequency."""
_STEP = 0.12
"""Its step, over the inverse duration."""
_ROWS_PER_PERIOD = 2.2
"""Rows per period at which it ends."""
_CELLS = 8
"""Cells per frame for the spectrum of an angle at uneven times."""
_MOST_CELLS = 1 << 20
"""Their greatest number."""
_CLEAR = (9.0, 5.5)
"""Gain of the log-likelihood by harmonics, and more per angle, from which a nutation is visible.

Noise exceeds it at the best of all frequencies about once in 370 times.
"""
_TIED = 0.3
"""Loss of the log of the noise, per angle, up to which a higher frequency is preferred."""
_ROWS_OF_NOISE = 2000
"""Means of rows to which harmonics of one frequency are fitted."""
_NEAR_POLE = 0.1
"""Distance from a pole, in radians, below which the axis may pass over it or begin on it."""
_WITHOUT_LARGEST = 0.623
"""Mean square of normal numbers without the largest tenth."""


class Signal(NamedTuple):
    """cos(theta), or spin or precession without turns, from which a mean rate was subtracted."""

    t: Array
    y: Array
    grows: bool
    rate: float = 0.0

    def averaged(self, most: int) -> Signal:
        """Return at most about `most` means of equally many rows."""
        size = -(-self.t.size // most)
        starts = np.arange(0, self.t.size, size)
        counts = np.diff(starts, append=self.t.size)
        t, y = (np.add.reduceat(x, starts) / counts for x in (self.t, self.y))
        return self if size == 1 else self._replace(t=t, y=y)

    def basis(self, t: Array, frequencies: Array, order: int) -> Array:
        """Return 1, t if the signal grows, and harmonics, shape (frequencies, columns, times)."""
        wave = np.exp(2j * np.pi * frequencies[:, np.newaxis] * t)
        powers = wave[:, np.newaxis] ** np.arange(1, order + 1)[:, np.newaxis]
        trend = np.stack([np.ones(t.size), t / self.t[-1]])[: 1 + self.grows]
        trends = np.broadcast_to(trend, (frequencies.size, *trend.shape))
        return np.concatenate([trends, powers.real, powers.imag], axis=1)

    def harmonics(self, frequencies: Array, order: int) -> tuple[Array, Array]:
        """Return the best factors of the basis for each frequency, and the noise that remains."""
        basis = self.basis(self.t, frequencies, order)
        gram = basis @ basis.transpose(0, 2, 1) + 1e-10 * self.y.size * np.eye(basis.shape[1])
        factors = np.linalg.solve(gram, (basis @ self.y)[..., np.newaxis])
        rest = self.y - np.sum(factors * basis, axis=1)
        dof = max(self.y.size - basis.shape[1], 1)
        noise: Array = np.sqrt(np.sum(rest**2, axis=1) / dof) + 1e-9
        return np.asarray(factors[..., 0], float), noise

    def finest(self, frequency: float) -> tuple[Array, float]:
        """Return the same at one frequency for as many harmonics as rows show, noise of a row."""
        few = self.averaged(_ROWS_OF_NOISE)
        order = 8 if few.y.size > 100 else 4 if few.y.size > 20 else 1
        factors, noise = few.harmonics(np.array([frequency]), order)
        return factors[0], float(noise[0]) * math.sqrt(self.y.size / few.y.size)


def passes_pole(tilt: Signal) -> bool:
    """Return whether the axis comes so near to a pole that spin and precession may jump there."""
    distance = math.pi / 2 - np.abs(np.arcsin(tilt.y))
    return bool(distance.min() < min(_NEAR_POLE, distance.max() / 5))


def signals_in(recording: Measured) -> dict[str, Signal]:
    """Return the signals of a recording by angle."""
    found = {}
    for name, values in recording.angles.items():
        rows = np.isfinite(values)
        t, y = recording.t[rows], values[rows]
        if name == "theta":
            found[name] = Signal(t, np.cos(y), grows=False)
        else:
            rate = mean_rate(t, y, recording.frame)
            found[name] = Signal(t, np.unwrap(y - rate * t), grows=True, rate=rate)
    return found


def mean_rate(t: Array, y: Array, frame: float) -> float:
    """Return the rate, below half a turn per frame, at the peak of the spectrum of exp(i y)."""
    finest = frame if are_whole(t / frame) else frame / _CELLS
    cell = max(finest, float(t[-1]) / _MOST_CELLS)
    at = np.round(t / cell).astype(int)
    sums = np.bincount(at, np.cos(y)) + 1j * np.bincount(at, np.sin(y))
    size = 1 << int(4 * sums.size - 1).bit_length()
    spectrum, rates = np.abs(np.fft.fft(sums, size)), 2 * np.pi * np.fft.fftfreq(size, cell)
    spectrum[np.abs(rates) > math.pi / frame * 1.000001] = 0
    return float(rates[np.argmax(spectrum)])


def oscillation_in(signals: Mapping[str, Signal]) -> tuple[float, bool]:
    """Return the frequency of the nutation, up to half a period per row, and if it is visible.

    It is the frequency at which harmonics describe the signals best: that of the tilt alone, if
    the axis may pass over a pole.
    """
    if "theta" in signals and passes_pole(signals["theta"]):
        signals = {"theta": signals["theta"]}
    rows = max(x.t.size for x in signals.values())
    best = _best_frequency([x.averaged(_MOST_ROWS) for x in signals.values()])
    if rows <= _MOST_ROWS or (best[1] > 0 and best[0] * best[2] < _MOST_ROWS / 8):
        return best[0], best[1] > 0
    # the nutation may be faster than averages show: search a part at the full rate
    longest = max(signals.values(), key=lambda x: x.t.size).t
    begin, end = longest[[(rows - _MOST_ROWS) // 2, (rows + _MOST_ROWS) // 2 - 1]]
    fast = []
    for x in signals.values():
        part = (x.t >= begin) & (x.t <= end)
        if part.sum() >= LEAST_ROWS:
            fast.append(Signal(x.t[part] - begin, x.y[part], x.grows))
    found = _best_frequency(fast)
    if not found[1] > max(best[1], 0):
        return best[0], best[1] > 0
    whole = [x.averaged(8 * _MOST_ROWS) for x in signals.values()]
    near = found[0] + np.linspace(-0.6, 0.6, 241) / found[2]
    noise = np.log([x.harmonics(near, 2)[1] for x in whole]).sum(axis=0)
    return float(near[np.argmin(noise)]), True


def _best_frequency(used: list[Signal]) -> tuple[float, float, float]:
    """Return the frequency, the gain of the log-likelihood above the visible one, the duration."""
    span, count = max(x.t[-1] for x in used), min(x.t.size for x in used)
    steps = np.diff(used[0].t)
    frames = steps / np.median(steps[steps > 0])
    most = frames.sum() / _ROWS_PER_PERIOD if are_whole(frames) else count * 1.0
    orders = min(4, max((count - 3) // 4, 1))

    def noise(frequencies: Array | float, order: int) -> Array:
        tried = np.atleast_1d(frequencies)
        found: Array = np.log([x.harmonics(tried, order)[1] for x in used]).sum(axis=0)
        return found

    def order_at(frequency: float) -> int:
        return min(orders, max(int(most / (frequency * span)), 1))

    tried = np.arange(0.8, max(most, 2.0), _STEP) / span
    blocks = np.array_split(tried, tried.size // 64 + 1)
    found = np.concatenate([noise(x, order_at(float(x[-1]))) for x in blocks])
    dips = np.flatnonzero((found[1:-1] <= found[:-2]) & (found[1:-1] <= found[2:])) + 1
    refined = []
    for i in dips[np.argsort(found[dips])][:4].tolist():
        how = {"bounds": (tried[i - 1], tried[i + 1]), "args": (order_at(float(tried[i + 1])),)}
        exact = {"method": "bounded", "options": {"xatol": 1e-5 / span}}
        refined.append(minimize_scalar(lambda *at: noise(*at)[0], **how, **exact))
    if not refined:
        return 1 / span, -1.0, span
    least = min(float(x.fun) for x in refined)
    # half of the frequency, or a third of it, leaves as little noise
    best = max(float(x.x) for x in refined if x.fun < least + _TIED * len(used))
    gain = (float(noise(1 / span, 0)[0]) - least) * count  # over constant tilt and rates
    return best, gain - (_CLEAR[0] + _CLEAR[1] * len(used)), span


def noise_of(
    signals: Mapping[str, Signal], frequency: float, recording: Measured
) -> dict[str, float]:
    """Return the noise of each channel in radians, as harmonics of the nutation leave it."""
    found = {name: x.finest(frequency)[1] for name, x in signals.items()}
    if "theta" in found:
        sine = np.sin(recording.angles["theta"])
        found["theta"] /= max(math.sqrt(float(np.nanmean(sine * sine))), 1e-3)
    return {x: found.get(ANGLE_OF[x], 0.01) for x in recording.channels}


def neighbour_noise(y: Array) -> float:
    """Return the noise of smooth data from differences of neighbours, of the best order.

    Von Neumann's estimate takes first differences; higher orders suppress the motion.  The largest
    tenth does not count, as outliers make it.
    """
    found = [math.inf]
    for order in range(1, min(7, y.size // 4)):
        squares = np.sort(np.diff(y, order) ** 2)
        usual = float(np.mean(squares[: -(squares.size // 10) or None])) / _WITHOUT_LARGEST
        found.append(math.sqrt(usual / math.comb(2 * order, order)))
    return min(found)


def step_between(y: Array) -> float:
    """Return the least difference between different values, 0 if all values are equal."""
    values = np.unique(np.round(y, 12))
    steps = np.diff(values)
    steps = steps[steps > 1e-9]
    return float(steps.min()) if steps.size else 0.0
