"""The attitude at a block of times: spin and precession grow by a mean rate and a series.

Whatever is computed goes to arrays of a workspace (see `arithmetic.workspace`): it has to be copied
before the next block.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.double_double import fraction_of_product, two_product, two_sum
from ..arithmetic.numbers import R
from ..arithmetic.protocol import Arithmetic
from ..arithmetic.sums_of_doubles import Pair, Triple, pair, triple
from ..arithmetic.types import Array
from ..arithmetic.workspace import Workspace


class Growth(NamedTuple):
    """How an angle grows with time, beside its series; of one top, or of many as columns."""

    rate: Pair
    """Mean rate of the angle."""
    turns: Triple
    """Mean rate in turns, good enough for the fraction of a turn after any time."""
    slope: Pair
    """What has to be added per step of the phase, since the series winds by itself."""
    start: Pair
    """The value of the series at t = 0."""

    def unwrapped(self, t: Array, since: Array, series: Array, space: Workspace) -> Array:
        """Return the angle, counted on from 0 at t = 0; `series` is overwritten.

        A start has one term more than 4 units leave room for: what rounding takes is kept then.
        """
        if np.any(self.start.high):
            total, lost = self._remainder(since, series, space)
            grown, lost_of_growth = two_product(t, self.rate.high, space)
            total, lost_there = two_sum(total, grown)
            total += lost + (lost_there + (lost_of_growth + t * self.rate.low))
            total[t == 0] = 0.0
            return total
        series = self._within(t, since, series, space)
        grown = space.new()
        series += np.multiply(t, self.rate.low, out=grown)
        series += np.multiply(t, self.rate.high, out=grown)
        space.free(grown)
        return series

    def wrapped(self, t: Array, since: Array, series: Array, space: Workspace) -> Array:
        """Return the angle in (-pi, pi], as exact far away as near; `series` is overwritten."""
        series = self._within(t, since, series, space)
        turns = fraction_of_product(t, self.turns, space)
        turns *= 2.0 * np.pi
        series += turns
        whole = np.divide(series, 2.0 * np.pi, out=turns)
        whole -= 0.5
        whole = np.ceil(whole, out=whole)
        whole *= 2.0 * np.pi
        series -= whole
        space.free(turns)
        series[series <= -np.pi] = np.pi
        return np.minimum(series, np.pi, out=series)

    def remainder(self, t: Array, since: Array, series: Array, space: Workspace) -> Array:
        """Return the angle less its mean growth (6,4), (7,4), which is 0 at t = 0.

        Neither the angle nor the growth is formed, so that nothing is lost far away; the slope and
        the winding of the series may cancel, so that their sum keeps what rounding takes from it.
        """
        total, lost = self._remainder(since, series, space)
        total += lost
        if np.any(self.start.high):
            total[t == 0] = 0.0
        return total

    def _remainder(self, since: Array, series: Array, space: Workspace) -> tuple[Array, Array]:
        """Return the angle less its mean growth, and what rounding takes from it."""
        ramp, lost = two_product(since, self.slope.high, space)
        total, lost_there = two_sum(series, ramp)
        total, lost_at_start = two_sum(total, -self.start.high)
        lost += lost_there
        lost += lost_at_start
        lost += since * self.slope.low - self.start.low
        return total, lost

    def _within(self, t: Array, since: Array, series: Array, space: Workspace) -> Array:
        """Add what the series lacks within a step."""
        if np.any(self.start.high):
            return self.remainder(t, since, series, space)
        if np.any(self.slope.high):
            ramp = np.multiply(since, self.slope.high, out=space.new())
            series += ramp
            space.free(ramp)
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


class Spinor(NamedTuple):
    """X and Y about their turning point, up to a common positive factor; None is not asked for."""

    x2: Array | None = None
    """|X|^2."""
    y2: Array | None = None
    """|Y|^2."""
    arg_x: Array | None = None
    arg_y: Array | None = None
    rate: Array | None = None
    """2 (|X|^2 + |Y|^2) |X| |Y| times the nutation rate."""
    tilt: Array | None = None
    """The tilt, where it is known beforehand."""


class Attitude(NamedTuple):
    """The attitude at a block of times, in the order of its phases."""

    growths: Growths
    space: Workspace
    order: Any
    """The index that puts times in the order of the phases: `out[order] = theta()`."""
    t: Array
    """The times in the order of the phases; as they were given where no argument is needed."""
    since: Array
    """The part of a step that has passed since the whole ones."""
    spinor: Spinor

    def theta(self) -> Array:
        """Return the tilt."""
        if self.spinor.tilt is not None:
            return self.spinor.tilt
        x2, y2 = needed(self.spinor.x2), needed(self.spinor.y2)
        tangent: Array = np.divide(y2, x2, out=self.space.new())
        theta: Array = np.arctan(np.sqrt(tangent, out=tangent), out=tangent)
        theta *= 2.0
        return theta

    def phi(self, *, wrap: bool = False) -> Array:
        """Return the spin, arg X - arg Y."""
        return self._grown(self.growths.phi, self._phi_series(), wrap)

    def psi(self, *, wrap: bool = False) -> Array:
        """Return the precession, arg X + arg Y."""
        return self._grown(self.growths.psi, self._psi_series(), wrap)

    def phi_remainder(self) -> Array:
        """Return the spin less its mean growth (6,4)."""
        return self.growths.phi.remainder(self.t, self.since, self._phi_series(), self.space)

    def psi_remainder(self) -> Array:
        """Return the precession less its mean growth (7,4)."""
        return self.growths.psi.remainder(self.t, self.since, self._psi_series(), self.space)

    def args(self) -> tuple[Array, Array]:
        """Return (psi + phi)/2 and (psi - phi)/2, each in (-pi, pi]."""
        x, y = (np.positive(arg, out=self.space.new()) for arg in self._args())
        return (
            self._grown(self.growths.arg_x, x, wrap=True),
            self._grown(self.growths.arg_y, y, wrap=True),
        )

    def _grown(self, growth: Growth, series: Array, wrap: bool) -> Array:
        grow = growth.wrapped if wrap else growth.unwrapped
        return grow(self.t, self.since, series, self.space)

    def _phi_series(self) -> Array:
        return np.subtract(*self._args(), out=self.space.new())

    def _psi_series(self) -> Array:
        return np.add(*self._args(), out=self.space.new())

    def _args(self) -> tuple[Array, Array]:
        return needed(self.spinor.arg_x), needed(self.spinor.arg_y)


def needed(part: Array | None) -> Array:
    """Return a part of X and Y that was asked for."""
    assert part is not None, "a column needs more than its entry says"
    return part
