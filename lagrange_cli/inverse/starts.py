"""Starts of a fit: tops in closed form that nutate as a recording does.

The period and the turning points are those of the recorded tilt.  If the tilt is not recorded,
turning points are tried on a grid.  Both, with the mean precession rate, give tops.  Those that
leave the least noise in some rows of the recording are the starts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache

import numpy as np

from ..arithmetic.types import Array
from .measured import Measured
from .motions import angles, nutating, states_of
from .signals import Signal, passes_pole

_HEIGHTS = np.concatenate([[1e-6], 10.0 ** np.linspace(-4, 8, 73)])
"""Values of (u3 - 1)/(1 - u2) between which a mean precession rate is searched for."""
_NEAR_POLE = np.array([0.01, 0.03, 0.06, 0.1, 0.17, 0.27, 0.4])
_TILTS = np.concatenate([_NEAR_POLE, np.linspace(0.55, np.pi - 0.55, 15), np.pi - _NEAR_POLE[::-1]])
"""If the tilt is not recorded: turning points to try."""
_SWINGS = (0.01, 0.04, 0.15)
"""The same: small nutations, over their distance from a pole."""
_PHASES = np.sin(np.linspace(0, np.pi / 2, 9)) ** 2
"""The same: places of the start between the turning points."""
_POLE = 1e-4
"""Least distance of a start from a pole, in radians."""
_ROWS = (12, 50)
"""Rows at which all starts are compared, then the best."""
_KEPT = 800
"""Starts that are compared at more rows, and at once."""
_ALIKE = 0.02
"""Difference of a and b, over 1 + their size in units of the period, of starts that are alike."""


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
        tops = nutating(*pair, 1.0, _HEIGHTS, signs) if shown else _tops_on_grid(signs)
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


@cache
def _tops_on_grid(signs: tuple[int, int]) -> tuple[Array, Array, Array, Array]:
    """Return the tops of all pairs of turning points, which are the same for every recording."""
    least, greatest = _grid()
    return nutating(least[:, np.newaxis], greatest[:, np.newaxis], 1.0, _HEIGHTS, signs)


def _turning_points(tilt: Signal) -> tuple[Array, Array, Array]:
    """Return pairs of turning points, of the harmonics or recorded, and the cosine at the start."""
    factors, _ = tilt.finest(1.0)
    phases, order = np.linspace(0, 1, 720), factors.size // 2
    wave = factors @ tilt.basis(phases, np.array([1.0]), order)[0]
    ends = np.clip([[wave.max(), tilt.y.max()], [wave.min(), tilt.y.min()]], -1, 1)
    pairs = np.stack(np.meshgrid(*np.arccos(ends))).reshape(2, -1)
    least, greatest = np.clip(pairs, _POLE, math.pi - _POLE)
    inside = least < greatest
    return least[inside], greatest[inside], wave[:1]


def _grid() -> tuple[Array, Array]:
    """Return turning points to try: all pairs of a grid, and close pairs."""
    one, other = np.triu_indices(_TILTS.size, 1)
    room = np.minimum(_TILTS, math.pi - _TILTS)
    least = np.concatenate([_TILTS[one], *(_TILTS - swing * room for swing in _SWINGS)])
    return least, np.concatenate([_TILTS[other], *[_TILTS] * len(_SWINGS)])


def best_starts(
    recording: Measured,
    signals: Mapping[str, Signal],
    sizes: Array,
    known: Mapping[str, float],
    most: int,
) -> tuple[Array, Array]:
    """Return the best states that differ in a or b, and psi, phi and r0 of each in the first row.

    They leave the least logarithm of the noise, summed over the channels.  A known start and the
    sign of a known r0 restrict them.
    """
    states = starts(signals, known.get("theta0"))
    sign = known.get("r0", float(not known.get("psidot0", 1.0)))  # released, b and -b look alike
    states = states[states[:, 1] * sign >= 0]
    for rows in _ROWS if len(states) > _KEPT else _ROWS[1:]:
        few = recording.thinned(rows)
        blocks = np.array_split(states, len(states) // _KEPT + 1)
        found = [_scored(few, x, signals.get("phi"), sizes) for x in blocks]
        noise, zeros = (np.concatenate(x, axis=-1) for x in zip(*found, strict=True))
        order = np.argsort(noise)[:_KEPT]
        states, zeros = states[order], zeros[:, order]
    kept = distinct(states, noise[order], most)
    return states[kept], zeros[:, kept]


def distinct(tops: Array, sizes: Array, most: int) -> list[int]:
    """Return the tops of least finite size that differ in a or b, the first two columns."""
    kept: list[int] = []
    for i in np.argsort(sizes)[: np.isfinite(sizes).sum()].tolist():
        near = np.abs(tops[kept, :2] - tops[i, :2]) < _ALIKE * (1 + np.abs(tops[i, :2]))
        if len(kept) < most and not near.all(axis=1).any():
            kept.append(i)
    return kept


def _scored(
    recording: Measured, states: Array, spin: Signal | None, sizes: Array
) -> tuple[Array, Array]:
    """Return the logarithm of the noise that states leave, and their best psi, phi and r0."""
    theta, phi, psi = angles(states_of(*states.T), recording.t)
    turned = zero = rate = np.zeros(len(states))
    if spin is not None:
        rate = _spin_rates(recording, phi, spin)
        phi = phi + np.outer(rate, recording.t)
        zero = _mean_angle(recording.angles["phi"] - phi)
    if "psi" in recording.angles:
        turned = _mean_angle(recording.angles["psi"] - psi, np.sin(theta))
    rest = recording.residuals(theta, phi + zero[:, np.newaxis], psi + turned[:, np.newaxis])
    seen = np.maximum(np.isfinite(rest).sum(axis=-1), 1)
    noise = np.log(np.nansum(rest**2, axis=-1) / seen + sizes**2).sum(axis=-1)
    return np.nan_to_num(noise, nan=np.inf), np.stack([turned, zero, rate + states[:, 1]])


def _spin_rates(recording: Measured, phi: Array, spin: Signal) -> Array:
    """Return the rates to add to phi; next to a pole the axis passes it on either side."""
    t, seen = recording.t, recording.angles["phi"]
    around = t - t.mean()
    shown = np.interp(t, spin.t, spin.y) + spin.rate * t
    rates = (shown - phi) @ around / (around @ around) + 2 * math.pi * np.array([[0.0], [1], [-1]])
    waves = (np.exp(1j * (seen - phi - np.outer(x, t))) for x in rates)
    fits = [np.abs(np.nansum(x, axis=1)) * (1.05 if not i else 1.0) for i, x in enumerate(waves)]
    return np.asarray(rates[np.argmax(fits, axis=0), np.arange(len(phi))])


def _mean_angle(turned: Array, weights: Array | float = 1.0) -> Array:
    return np.asarray(np.angle(np.nansum(weights * np.exp(1j * turned), axis=1)))
