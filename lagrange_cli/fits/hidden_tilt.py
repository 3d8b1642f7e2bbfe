"""Tops behind the spin and the precession alone, if the tilt is not recorded.

Turning points are tried on a grid.  Each pair of them, with the period and the mean precession,
gives tops in closed form.  Their precession and spin over a period are compared with those of the
recording, at whichever phase they are nearest.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.types import Array
from ..elliptic.complete import complete_k
from ..elliptic.jacobi_arrays import jacobi_of_arrays
from ..elliptic.modulus import modulus
from .harmonics import Series
from .turning_points import SIGNS, Candidates, Nutation, candidates

_NEAR = np.array([0.01, 0.03, 0.06, 0.1, 0.17, 0.27, 0.4])
_LEVELS = np.concatenate([_NEAR, np.linspace(0.55, math.pi - 0.55, 15), math.pi - _NEAR[::-1]])
"""Tilts between which an axis may nutate."""
_SWINGS = (0.01, 0.04, 0.15)
"""Differences of the turning points of small nutations, over their distance from a pole."""
_HEIGHTS = 10.0 ** np.linspace(-4, 4, 33)
"""Values of (u3 - 1)/(1 - u2) between which a mean precession is looked for."""
_PHASES = np.arange(128) / 128


class Turns(NamedTuple):
    """The precession and the spin of a recording over a period."""

    psi: Series
    phi: Series
    noise: dict[str, float]
    """Standard deviations of the residuals, of psi and phi."""


def states_behind(turns: Turns) -> Array:
    """Return states at the first row in the order of `model.STATE`, the likeliest first."""
    nutation, tops = _tops(1 / turns.psi.frequency, turns.psi.growth)
    theta, period = _tilts(nutation, tops), nutation.period
    columns = tops.at((slice(None), np.newaxis))
    rate = columns.precession_rate(theta)
    off_psi = _misfit(_wave(rate, period), _seen(turns.psi)) / turns.noise["psi"] ** 2
    off_phi = _misfit(_wave(-np.cos(theta) * rate, period), _seen(turns.phi))
    misfit = off_psi + off_phi / turns.noise["phi"] ** 2
    row, phase = np.arange(len(misfit)), np.argmin(misfit, axis=1)
    ends = Nutation(nutation.theta_min[:, np.newaxis], nutation.theta_max[:, np.newaxis], period)
    falls = np.where(_PHASES < 0.5, -1, 1) * columns.tilt_rate(ends, theta)
    state = [tops.a, tops.b, *(x[row, phase] for x in (theta, falls, rate))]
    return np.stack(state, axis=-1)[np.argsort(misfit[row, phase])]


def _tilts(nutation: Nutation, tops: Candidates) -> Array:
    """Return the tilts of tops over a period from their greatest tilt on, a row for each."""
    to_u1, to_u2 = (x + tops.u3_above for x in nutation.from_top)  # from u3
    k_prime = np.sqrt(to_u1 / to_u2)[:, np.newaxis]
    whole = 2 * complete_k(ARRAYS, k_prime)
    sn = jacobi_of_arrays(whole * _PHASES, modulus(ARRAYS, k_prime=k_prime))[1]
    u2 = nutation.u2[:, np.newaxis]
    tilts: Array = np.arccos(u2 + (nutation.u1[:, np.newaxis] - u2) * sn * sn)
    return tilts


def _tops(period: float, mean_rate: float) -> tuple[Nutation, Candidates]:
    """Return tops with a period and nearly a mean precession, and their turning points."""
    least, greatest = _turning_points()
    parts = []
    for signs in SIGNS:
        pairs = Nutation(least[:, np.newaxis], greatest[:, np.newaxis], period)
        tried = pairs.from_top[1] * _HEIGHTS
        off = candidates(pairs, tried, signs).mean_rate - mean_rate
        row, i = np.nonzero(off[:, :-1] * off[:, 1:] <= 0)
        share = off[row, i] / (off[row, i] - off[row, i + 1])
        height = tried[row, i] ** (1 - share) * tried[row, i + 1] ** share
        one = Nutation(least[row], greatest[row], period)
        parts.append([*one[:2], *candidates(one, height, signs)])
    low, high, *tops = map(np.concatenate, zip(*parts, strict=True))
    return Nutation(low, high, period), Candidates(*tops)


def _turning_points() -> tuple[Array, Array]:
    """Return the least and the greatest tilts that are tried: all pairs, and pairs close by."""
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


def _seen(series: Series) -> Array:
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
