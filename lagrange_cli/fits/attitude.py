"""The attitude at a block of times: spin and precession as mean rates times t plus periodic parts.

The periodic parts of arg X and arg Y (see `samplers`) are small, except next to a pole.  Their sums
and differences therefore lose little accuracy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.ball import Ball
from ..arithmetic.double_double import (
    MANY,
    PI,
    Period,
    fraction_of_product,
    period_of,
    two_product,
    two_sum,
    whole_periods,
)
from ..arithmetic.rounding import Pair, Triple, pair, triple
from ..arithmetic.types import Array


class Times(NamedTuple):
    """A block of times."""

    t: Array
    farthest: float
    """Bound of |t|."""
    space: Array
    """Four work arrays."""


class Growth(NamedTuple):
    """Growth of an angle from 0 at t = 0; constants of one top, or columns for many."""

    start: Pair | None
    """The periodic part at t = 0; None if it is 0."""
    rate: Pair
    """Mean rate of the angle."""
    turn: Period
    """The time of one turn at that rate."""
    turns: Triple
    """The rate in turns as three doubles: the fraction of a turn is accurate at any time."""

    def since_start(self, periodic: Array, at: Times) -> Array:
        """Subtract from a periodic part its value at t = 0, in place."""
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
        """Return the angle in (-pi, pi], as accurate at late times as at early ones.

        Whole turns are subtracted from the time until the sum of both parts is in this interval.
        """
        angle = self.since_start(periodic, at)
        turns = np.multiply(angle, 0.5 / PI.high, out=at.space[3])
        grown, lost = self._within_a_turn(at, turns)
        angle += grown
        angle += lost
        outside = np.abs(angle, out=lost) >= np.pi
        if outside.any():  # because the turns were rounded
            rest = angle[outside]
            rest[rest > np.pi] -= 2.0 * PI.high
            rest[rest <= -np.pi] += 2.0 * PI.high
            angle[outside] = rest
        return angle

    def within_a_quarter(self, periodic: Array, at: Times) -> tuple[Array, Array]:
        """Return the angle minus n half turns, in [-pi/2, pi/2], and (-1)^n."""
        grown, lost = self._within_a_turn(at)
        angle, more = two_sum(self.since_start(periodic, at), grown)
        halves = np.rint(angle / PI.high)
        angle = (angle - halves * PI.high) + (lost + more - halves * PI.middle)
        return angle, 1.0 - 2.0 * (halves % 2.0)

    def _within_a_turn(self, at: Times, more: float | Array = 0.0) -> tuple[Array, Array]:
        """Return the mean rate times t in two parts, reduced by turns to about -`more` turns."""
        whole, grown, lost = whole_periods(at.t, self.turn, 0.0, at.space[:3], more)
        lost *= -self.rate.high
        lost += grown * self.rate.low
        grown *= self.rate.high
        if at.farthest > self.turn.reach:  # the fraction of a turn stays accurate
            far, turns = np.abs(whole) >= MANY, fraction_of_product(at.t, self.turns)
            turns -= np.rint(turns + more)
            product, error = two_product(turns, 2.0 * PI.high)
            np.copyto(grown, product, where=far)
            np.copyto(lost, error + turns * (2.0 * PI.middle), where=far)
        return grown, lost


class Growths(NamedTuple):
    """The growths of spin and of precession."""

    phi: Growth
    psi: Growth
    halves: Callable[[], tuple[Growth, Growth]] | None = None
    """Returns the growths of arg X and arg Y, which few columns need."""


def growths(
    ar: Any, rates: tuple[Ball, Ball], starts: tuple[Ball, Ball] | tuple[int, int] = (0, 0)
) -> Growths:
    """Return the growths of the angles from the mean rates of spin and precession.

    `starts` are the periodic parts of arg X and arg Y at t = 0.  The rates of spin and precession
    are separate arguments, because sums and differences lose a much smaller rate.
    """
    (phi, psi), (x, y) = rates, starts

    def growth(rate: Any, start: Any) -> Growth:
        if not rate.is_known_to(10):  # the sampler's digits do not distinguish it from 0
            rate = ar.convert(0)
        start = ar.convert(start).middle
        turns = triple((rate / (2 * ar.pi)).middle)
        turn = pair((2 * ar.pi / rate).middle) if rate else Pair(0.0, 0.0)
        return Growth(
            pair(start) if start else None,
            pair(rate.middle),
            period_of(turn, float(turns.high)),
            turns,
        )

    @cache
    def halves() -> tuple[Growth, Growth]:
        with ar.working():
            return growth((psi + phi) / 2, x), growth((psi - phi) / 2, y)

    return Growths(growth(phi, x - y), growth(psi, x + y), halves)


class Attitude(NamedTuple):
    """X and Y at a block of times up to a common factor; parts that are not needed are None."""

    growths: Growths
    times: Times
    tilt: Array | None = None
    x2: Array | None = None
    """|X|^2."""
    y2: Array | None = None
    """|Y|^2."""
    arg_x: Array | None = None
    """The periodic part of arg X, that is, without its mean rate times t."""
    arg_y: Array | None = None
    rate: Array | None = None
    """2 (|X|^2 + |Y|^2) |X| |Y| times the nutation rate."""

    def theta(self) -> Array:
        """Return the tilt."""
        return needed(self.tilt)

    def phi(self, *, wrap: bool = False, out: Array | None = None) -> Array:
        """Return the spin, arg X - arg Y."""
        return self._grown(self.growths.phi, np.subtract(*self.args, out=out), wrap)

    def psi(self, *, wrap: bool = False, out: Array | None = None) -> Array:
        """Return the precession, arg X + arg Y."""
        return self._grown(self.growths.psi, np.add(*self.args, out=out), wrap)

    def _grown(self, growth: Growth, periodic: Array, wrap: bool) -> Array:
        return (growth.wrapped if wrap else growth.unwrapped)(periodic, self.times)

    @property
    def args(self) -> tuple[Array, Array]:
        """The periodic parts of arg X and arg Y."""
        return needed(self.arg_x), needed(self.arg_y)


def needed(part: Array | None) -> Array:
    """Return a part of X and Y, which must have been requested."""
    assert part is not None, "a column needs more than its entry says"
    return part


def arguments_of(parts: Array, out: Array) -> Array:
    """Return the arguments of X and Y, whose real parts are not negative, from their parts."""
    arguments: Array = np.divide(parts[1::2], parts[::2], out=out)
    np.arctan(arguments, out=arguments)
    return arguments


def unwound(arguments: Array, slopes: Sequence[Any], argument: Array, spare: Array) -> Array:
    """Add the slopes to arg X and arg Y in place, and return them: their periodic parts."""
    for i, slope in enumerate(slopes):
        arguments[i] += np.multiply(argument, slope, out=spare)
    return arguments


def moduli_of(parts: Array) -> Array:
    """Return |X|^2 and |Y|^2 from the parts of X and Y, which are overwritten."""
    parts *= parts
    parts[::2] += parts[1::2]
    return parts[::2]


def tilt_of(x2: Array, y2: Array, out: Array | None = None) -> Array:
    """Return 2 arctan(|Y|/|X|)."""
    tilt: Array = np.divide(y2, x2, out=out)
    np.sqrt(tilt, out=tilt)
    np.arctan(tilt, out=tilt)
    tilt *= 2.0
    return tilt
