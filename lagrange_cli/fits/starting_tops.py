"""Starts of a fit: tops in closed form from the nutation in a recording, the nearest first.

If the tilt is not recorded, turning points are tried on a grid.  Each pair of them, with the period
and the mean precession, gives tops in closed form.  Their precession and spin over a period are
compared with the recording, at the best phase.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.types import Array
from ..elliptic.complete import complete_k
from ..elliptic.jacobi_arrays import jacobi_of_arrays, modulus_of_complement
from .harmonics import Harmonics, frame_of, slowest_spin, turning_rate
from .invert import SIGNS, Candidates, TurningPoints, candidates, with_mean_rate
from .model import STATE, as_recorded, motion_angles, residuals
from .nutation import Shown, Turns
from .recording import Recording

_MOST_STATES = {False: 12, True: 60}
"""Number of tops tried if the tilt is not recorded, in a narrow and in a wide search."""
_NEAREST = 3
"""Number of tops tried for a mean precession that no top has."""
_HEIGHTS = (1e-4, 0.1, 1.0, 10.0)
"""Values of (u3 - 1)/(1 - u2) that are tried if no mean precession is known."""
_LEAST_TILT = 1e-9
"""Least distance of a start from the vertical, at which psi is undefined."""
_NEAR = np.array([0.01, 0.03, 0.06, 0.1, 0.17, 0.27, 0.4])
_LEVELS = np.concatenate([_NEAR, np.linspace(0.55, math.pi - 0.55, 15), math.pi - _NEAR[::-1]])
"""Tilts between which an axis may nutate."""
_SWINGS = (0.01, 0.04, 0.15)
"""Differences of turning points of small nutations, over their distance from a pole."""
_MODULI = 10.0 ** np.linspace(-4, 4, 33)
"""Values of (u3 - 1)/(1 - u2) between which a mean precession is searched for."""
_PHASES = np.arange(128) / 128
_TILT_OFF = 0.02
"""Largest difference of the tilt of a start from the known tilt, in radians."""


class FitStart(NamedTuple):
    """The start of a fit of one recording."""

    recording: Recording
    """The recording, with psi counted in one direction."""
    noise: Mapping[str, float]
    """Noise by channel, in radians, estimated by a fit of plain harmonics."""
    values: dict[str, float]
    """The state, in the order of `model.STATE`, the spin rate and the zeros, by name."""


def starting_tops(
    recording: Recording, shown: Shown | Turns, tilt: float | None = None, *, wide: bool = False
) -> list[tuple[float, FitStart]]:
    """Return starts of a fit that move approximately as a recording shows, the nearest first.

    Each has the sum of the squares of its residuals, over the noise of each channel.
    `tilt` is the tilt in the first row, if it is known but not recorded.  The tops have the
    nutation and the mean precession of the recording.  If the search is `wide`, or if psi is not
    given, they have nearly its nutation and any precession.
    """
    if isinstance(shown, Turns):
        states = _states_behind(shown, tilt)[: _MOST_STATES[wide]]
    else:
        states = _states_shown(shown, wide=wide)
    states = states[np.isfinite(states).all(axis=1)]
    states[:, 2] = np.clip(states[:, 2], _LEAST_TILT, math.pi - _LEAST_TILT)
    angles = motion_angles(states, recording.t)
    made = [_start(recording, shown.noise, state, angles[:, i]) for i, state in enumerate(states)]
    return sorted(made, key=lambda x: x[0])


def _states_shown(shown: Shown, *, wide: bool) -> Array:
    states = []
    for one in _near(shown) if wide else [shown]:
        if one.mean_rates:
            states.append(_states(one, _with_mean_rates(one)))
        if wide or not one.mean_rates:
            states.append(_states(one, _grid(one)))
    return np.concatenate(states)


def _near(shown: Shown) -> list[Shown]:
    """Return a nutation, and variants with other turning points near the poles."""
    least, greatest, period = shown.nutation
    low, high = shown.seen
    pairs = [(least, greatest), (low, greatest), (low / 3, greatest)]
    pairs += [(least, high), (least, math.pi - (math.pi - high) / 3)]
    return [shown._replace(nutation=TurningPoints(x, y, period)) for x, y in pairs if x < y]


def _grid(shown: Shown) -> Candidates:
    """Return tops of some moduli, with all signs."""
    tried = shown.nutation.from_top[1] * np.array(_HEIGHTS)
    return Candidates.joined(candidates(shown.nutation, tried, signs) for signs in SIGNS)


def _with_mean_rates(shown: Shown) -> Candidates:
    """Return the tops with the mean precession, or the tops nearest to it."""
    found = []
    for rate in shown.mean_rates:
        tops = with_mean_rate(shown.nutation, rate)
        if not tops.a.size:
            grid = _grid(shown)
            tops = grid.at(np.argsort(np.abs(grid.mean_rate - rate))[:_NEAREST])
        found.append(tops)
    return Candidates.joined(found)


def _states(shown: Shown, tops: Candidates) -> Array:
    """Return the states of tops at the first row, whose tilt is known."""
    u = min(max(shown.u_start, shown.nutation.u2), shown.nutation.u1)
    theta = np.full_like(tops.a, math.acos(u))
    falls = shown.falls * tops.tilt_rate(shown.nutation, theta)
    return np.stack([tops.a, tops.b, theta, falls, tops.precession_rate(theta)], axis=-1)


def _start(
    recording: Recording, noise: Mapping[str, float], state: Array, angles: Array
) -> tuple[float, FitStart]:
    """Return a start with the best zeros of psi and phi, and the best spin rate."""
    (theta, phi, psi), t = angles, recording.t
    values = dict(zip(STATE, state.tolist(), strict=True))
    values |= {"r0": values["b"], "psi_zero": 0.0, "phi_zero": 0.0}
    if "psi" in recording.angles:
        values["psi_zero"] = _mean_angle(recording.angles["psi"] - psi, np.sin(theta))
    if "phi" in recording.angles:
        left = recording.angles["phi"] - phi  # grows at the rate r0 - b
        frame = frame_of(t[np.isfinite(left)])
        b = values["b"]
        excess = slowest_spin(b + turning_rate(t, left), b, 0.0, frame) - b
        values |= {"r0": b + excess, "phi_zero": _mean_angle(left - excess * t, 1.0)}
    off = residuals(recording, as_recorded(angles, values, t)).values
    sizes = [[noise.get(channel, 1.0)] for channel in recording.channels]
    return float(np.nansum((off / sizes) ** 2)), FitStart(recording, noise, values)


def _mean_angle(angles: Array, weights: Array | float) -> float:
    return float(np.angle(np.nansum(weights * np.exp(1j * angles))))


def _states_behind(turns: Turns, tilt: float | None) -> Array:
    """Return states at the first row in the order of `model.STATE`, the likeliest first."""
    nutation, tops = _tops(1 / turns.psi.frequency, turns.psi.growth)
    theta, period = _tilts(nutation, tops), nutation.period
    rate = tops.precession_rate(theta)
    misfit = _misfit(_wave(rate, period), _seen(turns.psi)) / turns.noise["psi"] ** 2
    if turns.phi is not None:
        off_phi = _misfit(_wave(-np.cos(theta) * rate, period), _seen(turns.phi))
        misfit += off_phi / turns.noise["phi"] ** 2
    if tilt is not None:
        misfit += ((theta - tilt) / _TILT_OFF) ** 2
    row, phase = np.arange(len(misfit)), np.argmin(misfit, axis=1)
    falls = np.where(_PHASES < 0.5, -1, 1) * tops.tilt_rate(nutation, theta)
    states = [tops.a[:, 0], tops.b[:, 0], *(x[row, phase] for x in (theta, falls, rate))]
    return np.stack(states, axis=-1)[np.argsort(misfit[row, phase])]


def _tilts(nutation: TurningPoints, tops: Candidates) -> Array:
    """Return the tilts of tops over a period from their greatest tilt on, a row for each."""
    to_u1, to_u2 = (x + tops.u3_above for x in nutation.from_top)  # from u3
    k_prime = np.sqrt(to_u1 / to_u2)
    whole = 2 * complete_k(ARRAYS, k_prime)
    sn = jacobi_of_arrays(whole * _PHASES, modulus_of_complement(k_prime))[1]
    tilts: Array = np.arccos(nutation.u2 + (nutation.u1 - nutation.u2) * sn * sn)
    return tilts


def _tops(period: float, mean_rate: float) -> tuple[TurningPoints, Candidates]:
    """Return tops with a period and approximately a mean precession, and their turning points.

    All arrays are columns, of shape (tops, 1).
    """
    least, greatest = _turning_points()
    parts = []
    for signs in SIGNS:
        pairs = TurningPoints(least[:, np.newaxis], greatest[:, np.newaxis], period)
        tried = pairs.from_top[1] * _MODULI
        off = candidates(pairs, tried, signs).mean_rate - mean_rate
        row, i = np.nonzero(off[:, :-1] * off[:, 1:] <= 0)
        share = off[row, i] / (off[row, i] - off[row, i + 1])
        height = tried[row, i] ** (1 - share) * tried[row, i + 1] ** share
        one = TurningPoints(least[row], greatest[row], period)
        parts.append([*one[:2], *candidates(one, height, signs)])
    low, high, *tops = (np.concatenate(x)[:, np.newaxis] for x in zip(*parts, strict=True))
    return TurningPoints(low, high, period), Candidates(*tops)


def _turning_points() -> tuple[Array, Array]:
    """Return the least and the greatest tilts to try: all pairs of a grid, and close pairs."""
    near, far = np.triu_indices(_LEVELS.size, 1)
    room = np.minimum(_LEVELS, math.pi - _LEVELS)
    close = [_LEVELS - swing * room for swing in _SWINGS]
    least = np.concatenate([_LEVELS[near], *close])
    return least, np.concatenate([_LEVELS[far], *[_LEVELS] * len(_SWINGS)])


def _wave(rate: Array, period: float) -> Array:
    """Return the periodic part of an angle from its rates over a period."""
    steps = (rate + np.roll(rate, -1, axis=1)) / 2
    steps = steps - steps.mean(axis=1, keepdims=True)
    angle = np.roll(np.cumsum(steps, axis=1), 1, axis=1) * (period / rate.shape[1])
    wave: Array = angle - angle.mean(axis=1, keepdims=True)
    return wave


def _seen(series: Harmonics) -> Array:
    """Return the periodic part of a recorded angle."""
    t = _PHASES / series.frequency
    wave: Array = series.at(t) - series.growth * t
    wave -= wave.mean()
    return wave


def _misfit(waves: Array, seen: Array) -> Array:
    """Return the mean square differences, for each phase of a wave in the first row."""
    both = np.fft.ifft(np.fft.fft(waves) * np.conj(np.fft.fft(seen))).real
    size = (waves * waves).sum(axis=1, keepdims=True) + (seen * seen).sum()
    misfit: Array = (size - 2 * both) / waves.shape[1]
    return misfit
