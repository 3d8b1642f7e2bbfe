"""Starts of a fit: the nutation that a recording shows, and tops that nutate in this way.

The cosine of the tilt is periodic; spin and precession are periodic but for a mean rate.  Harmonics
of one frequency give the period and the turning points.  If the tilt is not recorded, turning
points are tried on a grid.  Both, with the mean precession rate, give tops in closed form.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from ..arithmetic.types import Array
from .motions import nutating
from .recording import Recording

_HEIGHTS = np.concatenate([[1e-6], 10.0 ** np.linspace(-4, 8, 73)])
"""Values of (u3 - 1)/(1 - u2) between which a mean precession rate is searched for."""
_NEAR_POLE = np.array([0.01, 0.03, 0.06, 0.1, 0.17, 0.27, 0.4])
_TILTS = np.concatenate([_NEAR_POLE, np.linspace(0.55, np.pi - 0.55, 15), np.pi - _NEAR_POLE[::-1]])
_SWINGS = (0.01, 0.04, 0.15)
_PHASES = np.sin(np.linspace(0, np.pi / 2, 9)) ** 2
"""If the tilt is not recorded: turning points to try, small nutations over their distance from a
pole, and places of the start between the turning points."""
_POLE = 1e-4
"""Least distance of a start from a pole, in radians."""
_MOST_ROWS, _STEP, _ROWS_PER_PERIOD = 600, 0.12, 2.2
"""Rows of the search for a frequency, its step over the inverse duration, and its end."""
_UNEVEN = 0.05
"""Mean deviation of steps in time from whole frames, from which frequencies beyond half a period
per frame are visible."""
_CLEAR = (9.0, 5.5)
"""Gain of the log-likelihood by harmonics, and more per angle, from which a nutation is visible.

Noise exceeds it at the best of all frequencies about once in 370 times.
"""
_TIED = 0.3
"""Loss of the log of the noise, per angle, up to which a higher frequency is preferred."""


class Signal(NamedTuple):
    """cos(theta), or spin or precession without turns, from which a mean rate was subtracted."""

    t: Array
    y: Array
    grows: bool
    rate: float = 0.0

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
        """Return the same at one frequency, for the order that leaves the least noise."""
        orders = (4, 8, 16) if self.y.size > 100 else (4,) if self.y.size > 20 else (1,)
        found = (self.harmonics(np.array([frequency]), x) for x in orders)
        factors, noise = min(found, key=lambda x: x[1])
        return factors[0], float(noise[0])


def signals_in(recording: Recording) -> dict[str, Signal]:
    """Return the signals of a recording by angle."""
    found = {}
    for name, values in recording.angles.items():
        rows = np.isfinite(values)
        t, y = recording.t[rows], values[rows]
        if name == "theta":
            found[name] = Signal(t, np.cos(y), grows=False)
            continue
        few = slice(0, _MOST_ROWS)
        rates = np.linspace(-1, 1, 4 * t[few].size) * math.pi / recording.frame
        turned = np.exp(1j * (y[few] - rates[:, np.newaxis] * t[few]))
        rate = float(rates[np.argmax(np.abs(turned.sum(axis=1)))])
        found[name] = Signal(t, np.unwrap(y - rate * t), grows=True, rate=rate)
    return found


def oscillation_in(signals: dict[str, Signal]) -> tuple[float, bool]:
    """Return the frequency of the nutation, up to half a period per row, and if it is visible.

    It is the frequency at which harmonics describe the signals best.
    """
    used = [x._replace(t=x.t[:_MOST_ROWS], y=x.y[:_MOST_ROWS]) for x in signals.values()]
    span, count = max(x.t[-1] for x in used), min(x.t.size for x in used)
    steps = np.diff(used[0].t)
    frames = steps / np.median(steps[steps > 0])
    even = np.mean(np.abs(frames - np.round(frames))) < _UNEVEN
    most = frames.sum() / _ROWS_PER_PERIOD if even else count * 1.0
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
        refined.append(minimize_scalar(lambda *at: noise(*at)[0], method="bounded", **how))
    if not refined:
        return 1 / span, False
    least = min(float(x.fun) for x in refined)
    # half of the frequency, or a third of it, leaves as little noise
    best = max(float(x.x) for x in refined if x.fun < least + _TIED * len(used))
    gain = (float(noise(1 / span, 0)[0]) - least) * count  # over constant tilt and rates
    return best, gain > _CLEAR[0] + _CLEAR[1] * len(used)


def noise_of(
    signals: dict[str, Signal], frequency: float, recording: Recording
) -> dict[str, float]:
    """Return the noise of each channel in radians, as harmonics of the nutation leave it."""
    found = {name: x.finest(frequency)[1] for name, x in signals.items()}
    if "theta" in found:
        sine = np.sin(recording.angles["theta"])
        found["theta"] /= max(math.sqrt(float(np.nanmean(sine * sine))), 1e-3)
    alias = {"across": "psi", "along": "phi"}
    return {x: found.get(alias.get(x, x), 0.01) for x in recording.channels}


def starts(signals: dict[str, Signal], frequency: float, tilt: float | None) -> Array:
    """Return states of tops, shape (tops, 5), that nutate as the signals do.

    `tilt` is the tilt in the first row, if it is known.
    """
    period, shown = 1 / frequency, signals.get("theta")
    least, greatest, at_start = _turning_points(shown, frequency) if shown else (*_grid(), None)
    rates: list[float] = []
    if "psi" in signals:
        spin = signals["psi"]
        mean = spin.rate + spin.finest(frequency)[0][1] / spin.t[-1]
        turns = (0, -1, 1) if shown else (0,)  # unknown if the axis passes next to a pole
        rates = [mean + i * 2 * math.pi * frequency for i in turns]
    found: list[Array] = []
    pair = least[:, np.newaxis], greatest[:, np.newaxis]
    for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        tops = nutating(*pair, period, _HEIGHTS, signs)
        for rate in rates:
            off = tops[3] - rate
            row, i = np.nonzero(off[:, :-1] * off[:, 1:] <= 0)
            share = off[row, i] / (off[row, i] - off[row, i + 1])
            height = _HEIGHTS[i] ** (1 - share) * _HEIGHTS[i + 1] ** share
            ends = least[row], greatest[row]
            found.append(np.stack([*ends, *nutating(*ends, period, height, signs)[:3]]))
        if not rates:
            found.append(np.stack(np.broadcast_arrays(*pair, *tops[:3])).reshape(5, -1))
    low, high, a, b, beta = np.concatenate(found, axis=1)
    u1, u2 = np.cos(low), np.cos(high)
    u = (u2 + (u1 - u2) * _PHASES[:, np.newaxis]) if at_start is None else np.clip(at_start, u2, u1)
    if tilt is not None:
        near = (u1 + 0.02 > math.cos(tilt)) & (math.cos(tilt) > u2 - 0.02)
        u = np.where(near, math.cos(tilt), np.nan)
    square = np.maximum(1 - u * u, _POLE**2)
    psi_rate = (beta - b * u) / square
    energy = (beta - b * u2) ** 2 / np.maximum(1 - u2 * u2, _POLE**2) + a * u2
    theta_rate = np.sqrt(np.maximum(energy - a * u - psi_rate**2 * square, 0))
    theta = np.clip(np.arccos(np.clip(u, -1, 1)), _POLE, math.pi - _POLE)
    states = [
        np.stack(np.broadcast_arrays(a, b, theta, rate, psi_rate), axis=-1).reshape(-1, 5)
        for rate in (theta_rate, -theta_rate)
    ]
    both: Array = np.concatenate(states)
    return np.asarray(both[np.isfinite(both).all(axis=1)])


def _turning_points(tilt: Signal, frequency: float) -> tuple[Array, Array, float]:
    """Return pairs of turning points near those of the harmonics, and the cosine at the start."""
    factors, _ = tilt.finest(frequency)
    phases, order = np.linspace(0, 1 / frequency, 720), factors.size // 2
    wave = factors @ tilt.basis(phases, np.array([frequency]), order)[0]
    ends = np.arccos(np.clip([wave.max(), wave.min()], -1, 1))
    seen = np.arccos([tilt.y.max(), tilt.y.min()])
    lows = np.array([ends[0], seen[0], seen[0] / 3])
    highs = np.array([ends[1], seen[1], math.pi - (math.pi - seen[1]) / 3])
    pairs = np.stack(np.meshgrid(lows, highs)).reshape(2, -1)
    least, greatest = np.clip(pairs, _POLE, math.pi - _POLE)
    inside = least < greatest
    return least[inside], greatest[inside], float(wave[0])


def _grid() -> tuple[Array, Array]:
    """Return turning points to try: all pairs of a grid, and close pairs."""
    one, other = np.triu_indices(_TILTS.size, 1)
    room = np.minimum(_TILTS, math.pi - _TILTS)
    least = np.concatenate([_TILTS[one], *(_TILTS - swing * room for swing in _SWINGS)])
    return least, np.concatenate([_TILTS[other], *[_TILTS] * len(_SWINGS)])
