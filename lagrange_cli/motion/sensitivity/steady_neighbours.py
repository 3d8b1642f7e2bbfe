"""Motions next to a steady precession: small nutations about a tilt next to it.

Let u = cos(theta) = u0 + x.  To first order in x, the derivative of (4,9) by t is x'' = c1/2 - D x.
At the steady precession itself c1 = 0 and D = a (u3 - u0).
"""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np

from ...arithmetic.double_double import reduce_phase
from ...arithmetic.duals import Dual
from ...arithmetic.points import MAX_PERIODS
from ...arithmetic.rounding import Pair, pair
from ...arithmetic.types import Array
from ..any_start import cubic
from ..gaps import State
from .neighbourhood import PARAMETERS, Neighbourhood

_SMALL = 0.5


class SteadyDerivatives:
    """Angles of a steady precession over time, and their derivatives by `PARAMETERS`."""

    def __init__(self, near: Neighbourhood) -> None:
        ar = near.ar.middles
        with ar.working():
            state = State(*(x.middle for x in near.moved))
            _, c1, c2 = cubic(state)
            self.force = _partials(c1) / 2
            frequency = ar.plain.sqrt(-c2.value)
            self.frequency = float(frequency)
            self.turns = pair(frequency / (2 * ar.plain.pi))
            self.sine, self.cosine, self.psi_rate, self.b = (
                float(x.value) for x in (state.sin, state.cos, state.psi_rate, state.b)
            )
            self.tilt = 2 * math.atan2(float(state.sin_half.value), float(state.cos_half.value))
            self.tilts = -_partials(state.cos) / self.sine
            self.speeds = -self.sine * _partials(state.theta_rate)
            self.r0s, self.psi_rates = _partials(state.r0), _partials(state.psi_rate)
            self.spin_rate = float((state.r0 - state.psi_rate * state.cos).value)
        rate = max(abs(self.spin_rate), abs(self.psi_rate), self.frequency)
        self.max_time = int(MAX_PERIODS) / rate if rate else math.inf

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return tilt, spin and precession at times, and their derivatives by the parameters.

        The shapes are (3, times) and (3, parameters, times).
        """
        sine, one_less_cosine, rest = oscillation(self.frequency, self.turns, t)
        x = np.outer(self.force, one_less_cosine) + np.outer(self.speeds, sine)
        passed = np.outer(self.force, rest) + np.outer(self.speeds, one_less_cosine)
        answer = (2 * self.cosine * self.psi_rate - self.b) / self.sine**2  # of psi' to x
        psi = np.outer(self.psi_rates, t) + answer * passed
        turned = passed - np.outer(self.sine * self.tilts, t)  # the integral of the change of u
        phi = np.outer(self.r0s, t) - self.psi_rate * turned - self.cosine * psi
        angles = np.array([np.full_like(t, self.tilt), self.spin_rate * t, self.psi_rate * t])
        return angles, np.array([self.tilts[:, None] - x / self.sine, phi, psi])


def oscillation(frequency: float, turns: Pair, t: Array) -> tuple[Array, Array, Array]:
    """Return sin(wt)/w, (1 - cos(wt))/w^2 and (wt - sin(wt))/w^3, or their limits for w = 0.

    `turns` is w/2 pi as a pair of doubles, so that whole turns are subtracted exactly.
    """
    if not frequency:
        return t, t * t / 2, t**3 / 6
    x = frequency * t
    within = 2 * np.pi * reduce_phase(t, turns)[1]
    sine, half = np.sin(within), np.sin(within / 2)
    rest = x - sine
    near = np.abs(x) < _SMALL
    square = x[near] ** 2
    series = np.ones_like(square)
    for n in (14, 12, 10, 8, 6, 4):
        series = 1 - square / (n * (n + 1)) * series
    rest[near] = x[near] ** 3 / 6 * series
    return sine / frequency, 2 * half * half / frequency**2, rest / frequency**3


def _partials(x: Dual) -> Array:
    return np.array([float(y) for y in x.partials or [Decimal(0)] * len(PARAMETERS)])
