"""Where a fit starts: tops in closed form from what a recording shows, and which is nearest."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from .hidden_tilt import Turns, states_behind
from .model import angles_of, kept_off_the_vertical
from .nutation import Shown
from .recording import Recording
from .residuals import residuals
from .turning_points import SIGNS, Candidates, Nutation, candidates, with_mean_rate
from .turning_rate import frame_of, slowest_spin, turning_rate

_MOST_STATES = {False: 12, True: 60}
"""Tops that are tried if the tilt is not recorded, in a narrow and in a wide search."""
_NEAREST = 3
"""Tops that are tried for a mean precession that no top has."""
_HEIGHTS = (1e-4, 0.1, 1.0, 10.0)
"""Values of (u3 - 1)/(1 - u2) that are tried where no mean precession is known."""


class Start(NamedTuple):
    """A top to start a fit from, and how far it is from the recording."""

    state: Array
    """The state, in the order of `model.STATE`."""
    excess: float
    """r0 - b, where the spin is seen."""
    psi_zero: float
    phi_zero: float
    left: float
    """Sum of the squares of the residuals, over the noise of each channel."""


def starts(recording: Recording, shown: Shown | Turns, *, wide: bool = False) -> list[Start]:
    """Return tops that move about as a recording shows, the nearest first.

    They have its nutation and mean precession.  If the search is `wide`, or if psi is not given,
    they have nearly its nutation and any precession.
    """
    if isinstance(shown, Turns):
        states = states_behind(shown)[: _MOST_STATES[wide]]
    else:
        states = _states_shown(shown, wide=wide)
    states = states[np.isfinite(states).all(axis=1)]
    angles = angles_of(states, recording.t)
    made = [_start(recording, shown.noise, state, angles[:, i]) for i, state in enumerate(states)]
    return sorted(made, key=lambda x: x.left)


def _states_shown(shown: Shown, *, wide: bool) -> Array:
    tops = []
    for one in _near(shown) if wide else [shown]:
        if one.mean_rates:
            tops.append(_states(one, _with_mean_rates(one)))
        if wide or not one.mean_rates:
            tops.append(_states(one, _grid(one)))
    return np.concatenate(tops)


def _near(shown: Shown) -> list[Shown]:
    """Return what is shown, and the same with other turning points near the poles."""
    least, greatest, period = shown.nutation
    low, high = shown.seen
    pairs = [(least, greatest), (low, greatest), (low / 3, greatest)]
    pairs += [(least, high), (least, math.pi - (math.pi - high) / 3)]
    return [shown._replace(nutation=Nutation(x, y, period)) for x, y in pairs if x < y]


def _grid(shown: Shown) -> Candidates:
    """Return tops of some moduli, with all signs."""
    tried = shown.nutation.from_top[1] * np.array(_HEIGHTS)
    parts = [candidates(shown.nutation, tried, signs) for signs in SIGNS]
    return Candidates(*(np.concatenate(x) for x in zip(*parts, strict=True)))


def _with_mean_rates(shown: Shown) -> Candidates:
    """Return the tops with the mean precession, or those that come nearest to it."""
    found: list[Candidates] = []
    for rate in shown.mean_rates:
        exact = with_mean_rate(shown.nutation, rate)
        if not exact:
            grid = _grid(shown)
            nearest = np.argsort(np.abs(grid.mean_rate - rate))[:_NEAREST]
            exact = [grid.at(i) for i in nearest.tolist()]
        found += exact
    return Candidates(*(np.array(x) for x in zip(*found, strict=True)))


def _states(shown: Shown, tops: Candidates) -> Array:
    """Return the states at the first row, of tops whose tilt there is known."""
    u = min(max(shown.u_start, shown.nutation.u2), shown.nutation.u1)
    theta = np.full_like(tops.a, math.acos(u))
    falls = shown.falls * tops.tilt_rate(shown.nutation, theta)
    return np.stack([tops.a, tops.b, theta, falls, tops.precession_rate(theta)], axis=-1)


def _start(recording: Recording, noise: Mapping[str, float], state: Array, angles: Array) -> Start:
    """Return a start with the zeros of psi and phi, and the spin rate, that fit it best."""
    theta, phi, psi = angles
    psi_zero, excess, phi_zero = 0.0, 0.0, 0.0
    if "psi" in recording.angles:
        psi_zero = _mean_angle(recording.angles["psi"] - psi, np.sin(theta))
    if "phi" in recording.angles:
        excess = _spin_excess(recording.t, recording.angles["phi"] - phi, float(state[1]))
        phi_zero = _mean_angle(recording.angles["phi"] - phi - excess * recording.t, 1.0)
    moved = np.stack([theta, phi + excess * recording.t + phi_zero, psi + psi_zero])
    sizes = [[noise.get(channel, 1.0)] for channel in recording.channels]
    left = float(np.nansum((residuals(recording, moved).values / sizes) ** 2))
    return Start(state, excess, psi_zero, phi_zero, left)


def _mean_angle(angles: Array, weights: Array | float) -> float:
    return float(np.angle(np.nansum(weights * np.exp(1j * angles))))


def _spin_excess(t: Array, left: Array, b: float) -> float:
    """Return the rate r0 - b at which the residual of phi grows."""
    rate = turning_rate(t, left)
    return slowest_spin(b + rate, b, 0.0, frame_of(t[np.isfinite(left)])) - b


def placed(start: Start) -> Start:
    """Return a start whose tilt is neither upright nor hanging.  Raises LagtopError for no top."""
    if not np.isfinite(start.state).all():
        raise LagtopError("no top moves as the recording shows")
    state = start.state.copy()
    state[2] = kept_off_the_vertical(state[2])
    return start._replace(state=state)
