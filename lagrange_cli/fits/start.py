"""Where a fit starts: tops in closed form from what a recording shows, and which is nearest."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.rotations import within_half_turn
from .model import angles_of, kept_off_the_vertical
from .nutation import Shown
from .recording import Recording
from .residuals import residuals
from .turning_points import SIGNS, Candidates, Nutation, candidates, heights, with_mean_rate

_NEAREST = 3
"""Tops that are tried for a mean precession that no top has."""
_MOST_ROWS = 4000
_CELLS, _MOST_CELLS = 4, 1 << 18
"""Cells per frame of a spectrum, and in all: times need not be even."""


class Start(NamedTuple):
    """A top to start a fit from, and how far it is from the recording."""

    state: Array
    """The state, in the order of `model.STATE`."""
    excess: float
    """r0 - b, where the spin is seen."""
    psi_zero: float
    phi_zero: float
    left: float
    """Sum of the squares of what is left, in radians."""


def starts(recording: Recording, shown: Shown, *, wide: bool = False) -> list[Start]:
    """Return tops that move about as a recording shows, the nearest first.

    They have its nutation and mean precession, or, where the search is to be `wide`, nearly its
    nutation and any precession.
    """
    if wide or not shown.mean_rates:
        states = np.concatenate([_states(one, _grid(one)) for one in _near(shown)])
    else:
        states = _states(shown, _with_mean_rates(shown))
    states = states[np.isfinite(states).all(axis=1)]
    angles = angles_of(states, recording.t)
    made = [_start(recording, state, angles[:, i]) for i, state in enumerate(states)]
    return sorted(made, key=lambda x: x.left)


def _near(shown: Shown) -> list[Shown]:
    """Return what is shown, and the same with other turning points near the poles."""
    least, greatest, period = shown.nutation
    pairs = [
        (least * scale, math.pi - (math.pi - greatest) * other)
        for scale, other in ((1, 1), (0.5, 1), (0.1, 1), (1, 0.5), (1, 0.1))
    ]
    return [shown._replace(nutation=Nutation(x, y, period)) for x, y in pairs]


def _grid(shown: Shown) -> Candidates:
    """Return tops of many moduli, with all signs."""
    tried = heights(shown.nutation, 25, 1e-8, 1e3, 1)
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
    nutation, a = shown.nutation, tops.a
    u = min(max(shown.u_start, nutation.u2), nutation.u1)
    theta = np.full_like(a, math.acos(u))
    between = max((nutation.u1 - u) * (u - nutation.u2), 0.0)
    nutation_rate = shown.falls * np.sqrt(a * between * (1 - u + tops.u3_above)) / np.sin(theta)
    return np.stack([a, tops.b, theta, nutation_rate, tops.precession_rate(theta)], axis=-1)


def _start(recording: Recording, state: Array, angles: Array) -> Start:
    """Return a start with the zeros of psi and phi, and the spin rate, that fit it best."""
    theta, phi, psi = angles
    psi_zero, excess, phi_zero = 0.0, 0.0, 0.0
    if "psi" in recording.angles:
        psi_zero = _mean_angle(recording.angles["psi"] - psi, np.sin(theta))
    if "phi" in recording.angles:
        excess = _spin_excess(recording.t, recording.angles["phi"] - phi, float(state[1]))
        phi_zero = _mean_angle(recording.angles["phi"] - phi - excess * recording.t, 1.0)
    moved = np.stack([theta, phi + excess * recording.t + phi_zero, psi + psi_zero])
    left = float(np.nansum(residuals(recording, moved).values ** 2))
    return Start(state, excess, psi_zero, phi_zero, left)


def _mean_angle(angles: Array, weights: Array | float) -> float:
    return float(np.angle(np.nansum(weights * np.exp(1j * angles))))


def _spin_excess(t: Array, left: Array, b: float) -> float:
    """Return the rate r0 - b at which what is left of phi grows.

    It is known within a turn per frame; of the rates that a rigid body can have, where b/r0 = C/A
    is in (0, 2], the slowest one is taken.
    """
    rows = np.flatnonzero(np.isfinite(left))[:_MOST_ROWS]
    t, turned = t[rows] - t[rows[0]], np.exp(1j * left[rows])
    frame = float(np.median(np.diff(t)[np.diff(t) > 0]))
    cell = frame / _CELLS
    cells = np.zeros(min(int(t[-1] / cell) + 1, _MOST_CELLS), dtype=np.complex128)
    places = np.rint(t / cell).astype(np.intp)
    np.add.at(cells, places[places < cells.size], turned[places < cells.size])
    sums = np.abs(np.fft.fft(cells, 4 * cells.size))
    rates = 2 * math.pi * np.fft.fftfreq(4 * cells.size, cell)
    highest = math.pi / frame
    sums[np.abs(rates) > highest] = 0.0
    rate = _refined(t, turned, float(rates[int(np.argmax(sums))]))
    aliases = [rate + 2 * highest * i for i in range(-3, 4)]
    bodies = [x for x in aliases if b + x and 0 < b / (b + x) <= 2]
    return min(bodies, key=lambda x: abs(b + x), default=rate)


def _refined(t: Array, turned: Array, rate: float) -> float:
    """Return a rate made better by a line through the angles that it leaves."""
    left = np.angle(turned * np.exp(-1j * rate * t))
    left = within_half_turn(left - np.angle(np.sum(np.exp(1j * left))))
    return rate + float(np.polyfit(t, left, 1)[0])


def placed(start: Start) -> Start:
    """Return a start whose tilt is neither upright nor hanging.  Raises LagtopError for no top."""
    if not np.isfinite(start.state).all():
        raise LagtopError("no top moves as the recording shows")
    state = start.state.copy()
    state[2] = kept_off_the_vertical(state[2])
    return start._replace(state=state)
