"""How spin and precession grow: so much with each step of the phase, and a series within it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arithmetic.double_double import Pair, pair, reduce_phase
from ..arithmetic.generic import Arithmetic, Real
from ..arithmetic.types import Array


class Growth(NamedTuple):
    """How an angle grows: per step, in turns per step and within a step; its series at t = 0."""

    step: Pair
    turns: Pair
    slope: float
    start: float

    def unwrapped(self, step: Array, since: Array, series: Array) -> Array:
        """The angle, counted on from 0 at t = 0; `series` is overwritten."""
        if self.start:
            series -= self.start
        series += since * self.slope
        series += step * self.step.low
        series += step * self.step.high
        return series

    def wrapped(self, step: Array, since: Array, series: Array) -> Array:
        """The same in (-pi, pi], as exact far away as near; `series` is overwritten."""
        _, turns = reduce_phase(step, self.turns)
        if self.start:
            series -= self.start
        series += since * self.slope
        series += turns * (2.0 * np.pi)
        series -= np.ceil(series / (2.0 * np.pi) - 0.5) * (2.0 * np.pi)
        series[series <= -np.pi] = np.pi
        return np.minimum(series, np.pi, out=series)


class Growths(NamedTuple):
    """Growth of spin and precession and of arg X and arg Y, their half sum and difference."""

    phi: Growth
    psi: Growth
    arg_x: Growth
    arg_y: Growth


def growths(
    ar: Arithmetic,
    steps: tuple[Real, Real],
    slopes: tuple[Real, Real] = (0, 0),
    starts: tuple[Real, Real] = (0, 0),
) -> Growths:
    """Growth of the four angles from those of arg X and arg Y."""

    def growth(x: int, y: int) -> Growth:
        step, slope, start = (x * p + y * q for p, q in (steps, slopes, starts))
        return Growth(pair(step), pair(step / (2 * ar.pi)), float(slope), float(start))

    return Growths(phi=growth(1, -1), psi=growth(1, 1), arg_x=growth(1, 0), arg_y=growth(0, 1))
