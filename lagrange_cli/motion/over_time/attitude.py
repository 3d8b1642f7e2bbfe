"""The attitude at a block of times: spin and precession are a mean growth and periodic parts.

The periodic parts are those of the arguments of X and Y (see `samplers`), which are small but where
the axis passes next to a pole.  So little is lost where they are added up.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ...arithmetic.double_double import (
    MANY,
    PI,
    Period,
    fraction_of_product,
    period_of,
    two_product,
    two_sum,
    whole_periods,
)
from ...arithmetic.numbers import R
from ...arithmetic.protocol import Arithmetic
from ...arithmetic.rounding import Pair, Triple, pair, triple
from ...arithmetic.types import Array


class Times(NamedTuple):
    """A block of times."""

    t: Array
    farthest: float
    """Bound of |t|."""
    space: Array
    """Four arrays for the steps of a computation."""


class Growth(NamedTuple):
    """How an angle grows from 0 at t = 0; the constants are of one top, or columns for many."""

    start: Pair | None
    """The periodic part at t = 0; None if it is 0."""
    rate: Pair
    """Mean rate of the angle."""
    turn: Period
    """The time of one turn at that rate."""
    turns: Triple
    """The rate in turns, to three doubles: the fraction of a turn is right at any time."""

    def since_start(self, periodic: Array, at: Times) -> Array:
        """Subtract from a periodic part that at t = 0, in place."""
        if self.start is not None:
            periodic -= self.start.high
            periodic -= self.start.low
            start = at.t == 0.0
            if start.any():
                periodic[start] = 0.0
        return periodic

    def unwrapped(self, periodic: Array, at: Times) -> Array:
        """Return the angle from its periodic part, which is overwritten."""
        angle = self.since_start(periodic, at)
        angle += np.multiply(at.t, self.rate.low, out=at.space[0])
        angle += np.multiply(at.t, self.rate.high, out=at.space[0])
        return angle

    def wrapped(self, periodic: Array, at: Times) -> Array:
        """Return the same in (-pi, pi], as exact far away as near.

        As many turns are taken off the time as leave the sum of both parts in that interval.
        """
        angle = self.since_start(periodic, at)
        turns = np.multiply(angle, 0.5 / PI.high, out=at.space[3])
        grown, lost = self._within_a_turn(at, turns)
        angle += grown
        angle += lost
        outside = np.abs(angle, out=lost) >= np.pi
        if outside.any():  # by what the rounding of many turns has taken
            rest = angle[outside]
            rest[rest > np.pi] -= 2.0 * PI.high
            rest[rest <= -np.pi] += 2.0 * PI.high
            angle[outside] = rest
        return angle

    def within_a_quarter(self, periodic: Array, at: Times) -> tuple[Array, Array]:
        """Return the angle less half turns, in [-pi/2, pi/2], and (-1)^n for n of them."""
        grown, lost = self._within_a_turn(at)
        angle, more = two_sum(self.since_start(periodic, at), grown)
        halves = np.rint(angle / PI.high)
        angle = (angle - halves * PI.high) + (lost + more - halves * PI.middle)
        return angle, 1.0 - 2.0 * (halves % 2.0)

    def _within_a_turn(self, at: Times, more: float | Array = 0.0) -> tuple[Array, Array]:
        """Return the mean growth as a sum, less as many turns as leave it next to -`more` turns."""
        whole, grown, lost = whole_periods(at.t, self.turn, 0.0, at.space[:3], more)
        lost *= -self.rate.high
        lost += grown * self.rate.low
        grown *= self.rate.high
        if at.farthest > self.turn.reach:  # the fraction of a turn is known for any number of them
            far, turns = np.abs(whole) >= MANY, fraction_of_product(at.t, self.turns)
            turns -= np.rint(turns + more)
            product, error = two_product(turns, 2.0 * PI.high)
            np.copyto(grown, product, where=far)
            np.copyto(lost, error + turns * (2.0 * PI.middle), where=far)
        return grown, lost


class Growths(NamedTuple):
    """Mean growth of spin and precession."""

    phi: Growth
    psi: Growth
    halves: Callable[[], tuple[Growth, Growth]] | None = None
    """Returns those of arg X and arg Y, their half sum and difference: few columns need them."""


def growths(
    ar: Arithmetic[R], rates: tuple[R, R], starts: tuple[R, R] | tuple[int, int] = (0, 0)
) -> Growths:
    """Return the growths of the angles from the mean rates of spin and precession.

    `starts` are the periodic parts of arg X and arg Y at t = 0.  Spin and precession come in by
    themselves: if one is much the larger, sums and differences lose the other.
    """
    (phi, psi), (x, y) = rates, starts

    def growth(rate: Any, start: Any) -> Growth:
        turns = triple(rate / (2 * ar.pi))
        turn = pair(2 * ar.pi / rate) if rate else Pair(0.0, 0.0)
        return Growth(
            pair(start) if start else None, pair(rate), period_of(turn, float(turns.high)), turns
        )

    @cache
    def halves() -> tuple[Growth, Growth]:
        with ar.working():
            return growth((psi + phi) / 2, x), growth((psi - phi) / 2, y)

    return Growths(growth(phi, x - y), growth(psi, x + y), halves)


class Spinor(NamedTuple):
    """X and Y up to a common positive factor; None is not asked for."""

    tilt: Array | None = None
    x2: Array | None = None
    """|X|^2."""
    y2: Array | None = None
    """|Y|^2."""
    arg_x: Array | None = None
    """The periodic part of arg X: less its mean growth."""
    arg_y: Array | None = None
    rate: Array | None = None
    """2 (|X|^2 + |Y|^2) |X| |Y| times the nutation rate."""


class Attitude(NamedTuple):
    """The attitude at a block of times."""

    growths: Growths
    times: Times
    spinor: Spinor

    def theta(self) -> Array:
        """Return the tilt."""
        return needed(self.spinor.tilt)

    def phi(self, *, wrap: bool = False, out: Array | None = None) -> Array:
        """Return the spin, arg X - arg Y."""
        return self._grown(self.growths.phi, np.subtract(*self._args(), out=out), wrap)

    def psi(self, *, wrap: bool = False, out: Array | None = None) -> Array:
        """Return the precession, arg X + arg Y."""
        return self._grown(self.growths.psi, np.add(*self._args(), out=out), wrap)

    def phi_remainder(self) -> Array:
        """Return the spin less its mean growth (6,4)."""
        return self.growths.phi.since_start(np.subtract(*self._args()), self.times)

    def psi_remainder(self) -> Array:
        """Return the precession less its mean growth (7,4)."""
        return self.growths.psi.since_start(np.add(*self._args()), self.times)

    def quarters(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Return arg X and arg Y, each less half turns, and the sign that these give X or Y."""
        x, y = (arg.copy() for arg in self._args())
        assert self.growths.halves is not None
        of_x, of_y = self.growths.halves()
        return of_x.within_a_quarter(x, self.times), of_y.within_a_quarter(y, self.times)

    def _grown(self, growth: Growth, periodic: Array, wrap: bool) -> Array:
        return (growth.wrapped if wrap else growth.unwrapped)(periodic, self.times)

    def _args(self) -> tuple[Array, Array]:
        return needed(self.spinor.arg_x), needed(self.spinor.arg_y)


def needed(part: Array | None) -> Array:
    """Return a part of X and Y that was asked for."""
    assert part is not None, "a column needs more than its entry says"
    return part
