"""Keys on request that are formulas of the inputs, for many tops at once in pairs of doubles.

`motion` declares the same keys with their meanings; `solve` computes a key of a top by itself if
its terms cancel here.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from ..arithmetic.arrays import PAIRS
from ..arithmetic.double_double import DoubleDouble, two_sum
from ..arithmetic.types import Array, Mask
from ..motion.gaps import State
from .top_arrays import PAIR_EPS, TopArrays

_GOOD = 2.0**-54
"""Relative error at which a number is trusted."""
_LEAST, _MOST = 1e-280, 1e280
"""Sizes between which pairs of doubles keep all of their digits."""


class Terms:
    """Numbers of many tops, of which the keys are made."""

    def __init__(self, tops: TopArrays) -> None:
        self.tops, self.unsure = tops, np.zeros(tops.m.shape, dtype=np.bool_)
        """`unsure` are the tops whose number has lost digits."""

    @cached_property
    def constants(self) -> dict[str, DoubleDouble]:
        """The constants of the motion, such as a (4,4) and b (4,5)."""
        return self.tops.constants()

    @property
    def a(self) -> DoubleDouble:
        """2mgs/A (4,4)."""
        return self.constants["a"]

    @property
    def b(self) -> DoubleDouble:
        """C r0/A (4,5)."""
        return self.constants["b"]

    @cached_property
    def start(self) -> State[DoubleDouble]:
        """The constants and the state at t = 0."""
        return self.tops.pair_state()

    @property
    def ratio(self) -> DoubleDouble:
        """A/C."""
        return DoubleDouble(self.tops.A) / DoubleDouble(self.tops.C)

    def total(self, *terms: DoubleDouble, error: Array | float = 0.0) -> DoubleDouble:
        """Return a sum; note the tops for which it loses digits.

        `error` is the size of an error of the terms, in units of PAIR_EPS.
        """
        found, size = terms[0], abs(terms[0].high) + error
        for term in terms[1:]:
            found, size = found + term, size + abs(term.high)
        self.unsure |= ~(PAIR_EPS * size <= _GOOD * abs(found.high))
        return found

    def momentum(self) -> DoubleDouble:
        """Return beta = psi' sin^2 theta0 + b cos theta0 (4,5)."""
        start = self.start
        return self.total(start.momentum, start.b * start.cos, error=abs(start.b.high))

    def energy(self) -> DoubleDouble:
        """Return alpha = theta'^2 + psi'^2 sin^2 theta0 + a cos theta0 (4,4)."""
        start = self.start
        return self.total(start.energy, start.a * start.cos, error=start.a.high)

    def at_pole(self, side: int) -> DoubleDouble:
        """Return f(1) or f(-1) of (4,9), -(beta - b)^2 or -(beta + b)^2, for `side` 1 or -1."""
        start = self.start
        from_b = -start.b * start.above if side > 0 else start.b * start.below
        root = self.total(start.momentum, from_b)
        return -root * root

    def steady_rate(self, *, fast: bool) -> DoubleDouble:
        """Return a rate of steady precession, a root of cos theta0 w^2 - b w + a/2 = 0."""
        a, b, cos = self.start.a, self.start.b, self.start.cos
        self.total(cos, error=1.0)
        square = self.total(b * b, -2.0 * a * cos, error=a.high)
        self.unsure |= square.high == 0
        both = abs(b) + square.sqrt()  # NaN if there is no such rate
        q = DoubleDouble.choose(b.high < 0, -both, both)
        return q / (2.0 * cos) if fast else a / q

    def steady_min(self) -> DoubleDouble:
        """Return the least r0 of a steady precession, 0 from 90 degrees on."""
        cos = self.start.cos
        self.total(cos, error=1.0)
        above = DoubleDouble.choose(cos.high > 0, cos, 0.0)
        return self.ratio * (2.0 * self.a * above).sqrt()


_KEYS: dict[str, Callable[[Terms], DoubleDouble]] = {
    "stability_factor": lambda x: x.b * x.b / (2.0 * x.a),
    "r0_sleeping": lambda x: x.ratio * (2.0 * x.a).sqrt(),
    "r0_steady_min": Terms.steady_min,
    "steady_rate_slow": lambda x: x.steady_rate(fast=False),
    "steady_rate_fast": lambda x: x.steady_rate(fast=True),
    "precession_rate_elementary": lambda x: x.a / (2.0 * x.b),
    "T_nutation_elementary": lambda x: 2.0 * PAIRS.pi / abs(x.b),
    "energy_without_spin": lambda x: DoubleDouble(x.tops.A) * x.energy() / 2.0,
    "energy_constant": Terms.energy,
    "Lz": lambda x: DoubleDouble(x.tops.A) * x.momentum(),
    "momentum_constant": Terms.momentum,
    "f_upright": lambda x: x.at_pole(1),
    "f_hanging": lambda x: x.at_pole(-1),
    "spin_share": lambda x: (
        DoubleDouble(*two_sum(2 * x.tops.A, -x.tops.C)) / (2.0 * DoubleDouble(x.tops.A))
    ),
}
ELEMENTARY = frozenset(_KEYS)
"""The keys that `elementary` computes."""
_ABSENT = {
    "stability_factor": "a",
    "precession_rate_elementary": "b",
    "T_nutation_elementary": "b",
}
"""The divisors without which a key does not exist."""


def elementary(tops: TopArrays, key: str) -> tuple[Array, Mask]:
    """Return a key of ELEMENTARY, NaN if it does not exist, and the tops left for `solve`."""
    with PAIRS.working():
        terms = Terms(tops)
        values: Array = _KEYS[key](terms).high
        values = np.array(np.broadcast_to(values, tops.m.shape))
        size = abs(values)
        left = terms.unsure | (size > 0) & (size < _LEAST) | (size > _MOST)
        if divisor := _ABSENT.get(key):
            absent = terms.constants[divisor].high == 0
            values[absent], left = np.nan, left & ~absent
        values[left] = np.nan
    return values, left
