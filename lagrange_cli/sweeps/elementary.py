"""Numbers that are formulas of the inputs, for many tops at once, in pairs of doubles.

They are further keys, which `solver` declares with their meanings, and the numbers of steady tops.
Where the terms of a formula cancel, `solve` computes the number.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arithmetic.pairs import PI, DoubleDouble, two_sum
from ..arithmetic.types import Array, Mask
from .formulas import OF_TORQUE_FREE, Motions, Start, turn_time
from .tops import TopArrays
from .trust import GOOD, PAIR_EPS

_LEAST, _MOST = 1e-280, 1e280
"""Sizes between which pairs of doubles keep all of their digits."""
_LEAST_SQUARE = 2.0**-20
"""Ratio of the discriminant to b^2 from which a steady rate is known well."""
_TURN = DoubleDouble(np.array([2 * PI.high]), np.array([2 * PI.low]))


class Elementary:
    """The keys of many tops."""

    def __init__(self, tops: TopArrays, start: Start) -> None:
        self.start = start
        self.A, self.C = DoubleDouble(tops.A), DoubleDouble(tops.C)
        self.twice_A_C = DoubleDouble(*two_sum(2 * tops.A, -tops.C))
        self.a, self.b, self.cos = self.start.a, self.start.b, self.start.cos
        self.lost = np.zeros(tops.m.shape, dtype=np.bool_)
        """Tops whose present number has lost digits."""

    def number(self, key: str) -> tuple[Array, Mask]:
        """Return a key of ELEMENTARY, NaN if it does not exist, and the tops left to `solve`."""
        self.lost = np.zeros_like(self.lost)
        values = np.array(np.broadcast_to(ELEMENTARY[key](self).high, self.lost.shape))
        size = abs(values)
        left = self.lost | (size > 0) & (size < _LEAST) | (size > _MOST)
        if key in _QUOTIENTS:
            divisor = self.a if key == "stability_factor" else self.b
            left &= divisor.high != 0
            values[divisor.high == 0] = np.nan
        values[left] = np.nan
        return values, left

    def total(self, *terms: DoubleDouble, error: Array | float = 0.0) -> DoubleDouble:
        """Return a sum; note the tops for which it loses digits.

        `error` is an absolute error of the terms, in units of PAIR_EPS.
        """
        found, size = terms[0], abs(terms[0].high) + error
        for term in terms[1:]:
            found, size = found + term, size + abs(term.high)
        self.lost |= ~(PAIR_EPS * size <= GOOD * abs(found.high))
        return found

    def momentum(self) -> DoubleDouble:
        """Return beta = psi' sin^2 theta0 + b cos theta0 (4,5)."""
        return self.total(self.start.momentum, self.b * self.cos, error=abs(self.b.high))

    def energy(self) -> DoubleDouble:
        """Return alpha = theta'^2 + psi'^2 sin^2 theta0 + a cos theta0 (4,4)."""
        return self.total(self.start.energy, self.a * self.cos, error=self.a.high)

    def upright(self) -> DoubleDouble:
        """Return f(1) = -(beta - b)^2 of (4,9)."""
        root = self.total(self.start.momentum, -self.b * self.start.above)
        return -root * root

    def hanging(self) -> DoubleDouble:
        """Return f(-1) = -(beta + b)^2 of (4,9)."""
        root = self.total(self.start.momentum, self.b * self.start.below)
        return -root * root

    def discriminant(self) -> DoubleDouble:
        """Return b^2 - 2 a cos theta0, negative if there is no steady precession."""
        self.total(self.cos, error=1.0)
        found = self.total(self.b * self.b, -2.0 * self.a * self.cos, error=self.a.high)
        self.lost |= found.high == 0
        return found

    def steady(self) -> DoubleDouble:
        """Return q = b +- sqrt(b^2 - 2 a cos theta0), of the sign of b; NaN if there is none."""
        both = abs(self.b) + self.discriminant().sqrt()
        return DoubleDouble.choose(self.b.high < 0, -both, both)

    def steady_min(self) -> DoubleDouble:
        """Return the least r0 of a steady precession, 0 from 90 degrees on."""
        self.total(self.cos, error=1.0)
        above = DoubleDouble.choose(self.cos.high > 0, self.cos, 0.0)
        least: DoubleDouble = self.A / self.C * (2.0 * self.a * above).sqrt()
        return least


ELEMENTARY: dict[str, Callable[[Elementary], DoubleDouble]] = {
    "stability_factor": lambda of: of.b * of.b / (2.0 * of.a),
    "r0_sleeping": lambda of: of.A / of.C * (2.0 * of.a).sqrt(),
    "r0_steady_min": Elementary.steady_min,
    "steady_rate_slow": lambda of: of.a / of.steady(),
    "steady_rate_fast": lambda of: of.steady() / (2.0 * of.cos),
    "precession_rate_elementary": lambda of: of.a / (2.0 * of.b),
    "T_nutation_elementary": lambda of: _TURN / abs(of.b),
    "energy_without_spin": lambda of: of.A * of.energy() / 2.0,
    "energy_constant": Elementary.energy,
    "Lz": lambda of: of.A * of.momentum(),
    "momentum_constant": Elementary.momentum,
    "f_upright": Elementary.upright,
    "f_hanging": Elementary.hanging,
    "spin_share": lambda of: of.twice_A_C / (2.0 * of.A),
}
"""The formula of each key."""
_QUOTIENTS = {"stability_factor", "precession_rate_elementary", "T_nutation_elementary"}
"""Keys that do not exist if their divisor, a or b, is 0."""


class Steady(Motions):
    """Tops whose tilt is kept by a rate of steady precession that a word names.

    The cubic (4,9) has a double root u0, and a (u3 - u0) is a sum: psi'^2 sin^2 plus the
    discriminant b^2 - 2 a u0.  If this is at least 2^-20 of b^2, the rate is good to 2^-80.
    """

    def __init__(self, tops: TopArrays, start: Start) -> None:
        super().__init__(OF_TORQUE_FREE, start.in_doubles())
        of = Elementary(tops, start)
        slow, fast = ELEMENTARY["steady_rate_slow"](of), ELEMENTARY["steady_rate_fast"](of)
        rate = DoubleDouble.choose(tops.steady == 1, slow, fast)
        square, around, along = of.discriminant(), rate * start.sin, rate * of.cos
        D = around * around + square
        spin = of.total(start.r0, -along, error=abs(along.high) / _LEAST_SQUARE)
        self.known = ~of.lost & (square.high > _LEAST_SQUARE * of.b.high**2)
        self |= {"u3": (of.cos + D / of.a).high, "T_nutation": turn_time(np.sqrt(D.high))}
        for key in ("psidot0", "mean_precession_rate", "precession_rate_start"):
            self[key] = rate.high
        self["T_precession"] = turn_time(rate.high)
        self["mean_spin_rate"] = self["spin_rate_start"] = spin.high
