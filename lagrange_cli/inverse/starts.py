"""Starts of a fit: tops in closed form that nutate as a recording does.

The period and the turning points are those of the recorded tilt.  If the tilt is not recorded,
turning points are tried on a grid.  Both, with the mean precession rate, give tops.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..arithmetic.types import Array
from .motions import nutating
from .signals import NEAR_POLE, Signal, passes_pole

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


def starts(signals: Mapping[str, Signal], tilt: float | None) -> Array:
    """Return states of tops, shape (tops, 5), that nutate as the signals do, with the period 1.

    `tilt` is the tilt in the first row, if it is known.
    """
    shown = signals.get("theta")
    least, greatest, at_start = _turning_points(shown) if shown else (*_grid(), None)
    jumps = shown is not None and passes_pole(shown)
    rates: list[float] = []
    if "psi" in signals:
        spin = signals["psi"]
        mean = spin.rate + spin.finest(1.0)[0][1] / spin.t[-1]
        turns = (0, -1, 1) if shown else (0,)  # unknown if the axis passes next to a pole
        rates = [mean + i * 2 * math.pi for i in turns]
    found: list[Array] = []
    pair = least[:, np.newaxis], greatest[:, np.newaxis]
    for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        tops = nutating(*pair, 1.0, _HEIGHTS, signs)
        for rate in rates:
            off = tops[3] - rate
            row, i = np.nonzero(off[:, :-1] * off[:, 1:] <= 0)
            share = off[row, i] / (off[row, i] - off[row, i + 1])
            height = _HEIGHTS[i] ** (1 - share) * _HEIGHTS[i + 1] ** share
            ends = least[row], greatest[row]
            found.append(np.stack([*ends, *nutating(*ends, 1.0, height, signs)[:3]]))
        if not rates or jumps:
            found.append(np.stack(np.broadcast_arrays(*pair, *tops[:3])).reshape(5, -1))
    low, high, a, b, beta = np.concatenate(found, axis=1)
    u1, u2 = np.cos(low), np.cos(high)
    if at_start is None:
        u = u2 + (u1 - u2) * _PHASES[:, np.newaxis]
    else:
        u = np.clip(at_start[:, np.newaxis], u2, u1)
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


def _turning_points(tilt: Signal) -> tuple[Array, Array, Array]:
    """Return pairs of turning points near those of the harmonics, and cosines at the start.

    An axis that comes near a pole may pass over it, and begin beside it.
    """
    factors, _ = tilt.finest(1.0)
    phases, order = np.linspace(0, 1, 720), factors.size // 2
    wave = factors @ tilt.basis(phases, np.array([1.0]), order)[0]
    ends = np.arccos(np.clip([wave.max(), wave.min()], -1, 1))
    seen = np.arccos([tilt.y.max(), tilt.y.min()])
    room = math.pi - seen[1]
    lows, highs = [ends[0], seen[0], seen[0] / 3], [ends[1], seen[1], math.pi - room / 3]
    start = [math.acos(np.clip(wave[0], -1, 1))]
    if passes_pole(tilt):
        lows.append(0.0)
        highs.append(math.pi)
        start += [x for x in (10 * _POLE, math.pi - 10 * _POLE) if abs(x - start[0]) < NEAR_POLE]
    pairs = np.stack(np.meshgrid(lows, highs)).reshape(2, -1)
    least, greatest = np.clip(pairs, _POLE, math.pi - _POLE)
    inside = least < greatest
    return least[inside], greatest[inside], np.cos(start)


def _grid() -> tuple[Array, Array]:
    """Return turning points to try: all pairs of a grid, and close pairs."""
    one, other = np.triu_indices(_TILTS.size, 1)
    room = np.minimum(_TILTS, math.pi - _TILTS)
    least = np.concatenate([_TILTS[one], *(_TILTS - swing * room for swing in _SWINGS)])
    return least, np.concatenate([_TILTS[other], *[_TILTS] * len(_SWINGS)])
