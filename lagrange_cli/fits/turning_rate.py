"""The rate of an angle that is known within whole turns: the peak of a spectrum.

Frames that are a turn apart look alike, so rates are known within whole turns per frame.
"""

from __future__ import annotations

import math

import numpy as np

from ..arithmetic.types import Array
from ..inputs.rotations import within_half_turn

_MOST_ROWS = 4000
_CELLS, _MOST_CELLS = 4, 1 << 18
"""Cells per frame of a spectrum, and in all: times need not be even."""
_ALIASES = range(-3, 4)
"""Turns per frame that are tried."""


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
    return _refined(t, turned, float(rates[int(np.argmax(sums))]))


def _refined(t: Array, turned: Array, rate: float) -> float:
    """Return a rate made better by a line through the angles that it leaves."""
    left = np.angle(turned * np.exp(-1j * rate * t))
    left = within_half_turn(left - np.angle(np.sum(np.exp(1j * left))))
    return rate + float(np.polyfit(t, left, 1)[0])


def slowest_spin(r0: float, b: float, b_std: float, frame: float) -> float:
    """Return the slowest of the spin rates that look alike and that a rigid body can have.

    A body has 0 < C/A = b/r0 <= 2; b is known to two standard deviations.  If no rate is possible
    r0 stays.
    """
    alike = [r0 + 2 * math.pi / frame * turns for turns in _ALIASES]
    possible = [
        x
        for x in alike
        if max(b * math.copysign(1, x) + 2 * b_std, 0) > 0
        and b * math.copysign(1, x) - 2 * b_std <= 2 * abs(x)
    ]
    return min(possible, key=abs, default=r0)
