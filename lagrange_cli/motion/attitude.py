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
    """Return the growth of the four angles from that of spin and precession.

    `starts` are arg X and arg Y at t = 0.  Spin and precession come in by themselves: where one
    of them is much the larger, sums and differences would lose the other.
    """
    (phi, psi), (phi_slope, psi_slope), (x, y) = steps, slopes, starts

    def growth(step: Real, slope: Real, start: Real) -> Growth:
        return Growth(pair(step), pair(step / (2 * ar.pi)), float(slope), float(start))

    return Growths(
        phi=growth(phi, phi_slope, x - y),
        psi=growth(psi, psi_slope, x + y),
        arg_x=growth((psi + phi) / 2, (psi_slope + phi_slope) / 2, x),
        arg_y=growth((psi - phi) / 2, (psi_slope - phi_slope) / 2, y),
    )
