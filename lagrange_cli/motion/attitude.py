"""How spin and precession grow: at a mean rate, and by a series within each half period."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.double_double import (
    Pair,
    Triple,
    fraction_of_product,
    pair,
    triple,
    two_product,
    two_sum,
)
from ..arithmetic.numbers import R
from ..arithmetic.protocol import Arithmetic
from ..arithmetic.types import Array


class Growth(NamedTuple):
    """How an angle grows with time, beside its series."""

    rate: Pair
    """Mean rate of the angle."""
    turns: Triple
    """Mean rate in turns, good enough for the fraction of a turn after any time."""
    slope: Pair
    """What has to be added per step of the phase, since the series winds by itself."""
    start: Pair
    """The value of the series at t = 0."""

    def unwrapped(self, t: Array, since: Array, series: Array) -> Array:
        """Return the angle, counted on from 0 at t = 0; `series` is overwritten."""
        series = self._within(t, since, series)
        series += t * self.rate.low
        series += t * self.rate.high
        return series

    def wrapped(self, t: Array, since: Array, series: Array) -> Array:
        """Return the angle in (-pi, pi], as exact far away as near; `series` is overwritten."""
        series = self._within(t, since, series)
        series += fraction_of_product(t, self.turns) * (2.0 * np.pi)
        series -= np.ceil(series / (2.0 * np.pi) - 0.5) * (2.0 * np.pi)
        series[series <= -np.pi] = np.pi
        return np.minimum(series, np.pi, out=series)

    def remainder(self, t: Array, since: Array, series: Array) -> Array:
        """Return the angle less its mean growth (6,4), (7,4), which is 0 at t = 0.

        Neither the angle nor the growth is formed, so that nothing is lost far away; the slope and
        the winding of the series may cancel, so that their sum keeps what rounding takes from it.
        """
        ramp, lost = two_product(since, self.slope.high)
        total, lost_there = two_sum(series, ramp)
        total, lost_at_start = two_sum(total, -self.start.high)
        lost += lost_there
        lost += lost_at_start
        lost += since * self.slope.low - self.start.low
        total += lost
        if self.start.high:
            total[t == 0] = 0.0
        return total

    def _within(self, t: Array, since: Array, series: Array) -> Array:
        if self.start.high:
            series -= self.start.high
        if self.slope.high:
            series += since * self.slope.high
        if self.start.high:
            series[t == 0] = 0.0
        return series


class Growths(NamedTuple):
    """Growth of spin and precession and of arg X and arg Y, their half sum and difference."""

    phi: Growth
    psi: Growth
    arg_x: Growth
    arg_y: Growth


def growths(
    ar: Arithmetic[R],
    rates: tuple[R, R],
    slopes: tuple[R | int, R | int] = (0, 0),
    starts: tuple[R | int, R | int] = (0, 0),
) -> Growths:
    """Return the growth of the four angles from that of spin and precession.

    `starts` are arg X and arg Y at t = 0.  Spin and precession come in by themselves: where one
    of them is much the larger, sums and differences would lose the other.
    """
    (phi, psi), (phi_slope, psi_slope), (x, y) = rates, slopes, starts

    def growth(rate: Any, slope: Any, start: Any) -> Growth:
        turns = triple(rate / (2 * ar.pi))
        return Growth(pair(rate), turns, pair(slope), pair(start))

    return Growths(
        phi=growth(phi, phi_slope, x - y),
        psi=growth(psi, psi_slope, x + y),
        arg_x=growth((psi + phi) / 2, (psi_slope + phi_slope) / 2, x),
        arg_y=growth((psi - phi) / 2, (psi_slope - phi_slope) / 2, y),
    )
