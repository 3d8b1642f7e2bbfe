"""Tops with any initial rates: their roots in pairs of doubles, and which tops to trust.

In such a motion some gaps are differences.  Their errors are bounded here, and `solve` computes
the tops whose errors may show in a double.

Let e = 2^-100, which covers a dozen operations on pairs (each is good to 2^-104).  A sum has an
absolute error of e times the sizes of its terms.

- The root.  A step of Newton's method s = f/f' at X is in error by at most (N + s S + s^2 F)/|f'|.
  N is e times the sizes of the terms of f, S the error of f' in doubles, and F = |f''|/2.  This
  bounds the error of D = a (u3 - u0).
- The other roots.  Their sum t = (c1 + a c0/D)/D has the errors of the terms of c1 and of D.  The
  derivative of the larger root by t is at most 1, so that its error is that of t, and that of the
  product c0/D relative to itself.  The smaller root is a quotient: relative errors add.
- A gap is a difference of a root and a number of the start.  Its error is the sum of their errors.
- beta - b u at a root has an error of e times the sizes of its terms, and b times that of the root.

A top is trusted if all gaps are positive and known to 2^-54, and if the signs of beta - b u at u1
and u2 are certain.  Products and roots of the gaps are then good to a few eps.  A mean rate is
linear in beta - b u.  Its error is at most that of the gaps, relative to its size: the same mean
of the sizes of the terms.
"""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np

from ..arithmetic.pairs import DoubleDouble
from ..arithmetic.types import Array
from .formulas import (
    OF_NUTATION,
    Formulas,
    Gaps,
    Motions,
    cubic_of,
    gaps_from_start,
    mean_parts,
    rates_half,
    u2,
)
from .tops import Start, TopArrays

PAIR_EPS = 2.0**-100
"""Relative error of a dozen operations on pairs."""
GOOD = 2.0**-54
"""Relative error at which a number is trusted; a rate, whose bound is wider, at eight times it."""
_SURE = 2.0**-10
"""Relative error at which a sign is trusted."""
_SETTLED = 2.0**-90
"""Relative error at which the largest root is settled."""
_NEWTON_STEPS, _STEPS_IN_PAIRS = 100, 4
_MOST_SIZE = 2.0
"""Size of a mean rate, over the rate, up to which it is computed in doubles.

In 245,000 random tops the error was at most 5.2 eps of that size.
"""


class AnyStart(Motions):
    """Tops with any initial rates, with a torque and off the vertical.

    The gaps and the numbers in which larger ones may cancel are computed in pairs, the others in
    doubles.
    """

    def __init__(self, formulas: Formulas, tops: TopArrays, start: Start) -> None:
        super().__init__(formulas, tops, start)
        cubic = cubic_of(start)
        D, self._of_D = largest_root(start, cubic)
        self.gap_pairs = gaps_from_start(start, cubic, D)
        self.gaps = Gaps(*(x.high for x in self.gap_pairs))
        self._bound_gaps()

    def _bound_gaps(self) -> None:
        """Bound the errors of the gaps and of beta - b u at u1 and u2.

        `noise` bounds the relative error of all gaps.  `known` tells whether they, and the signs of
        beta - b u, can be trusted.
        """
        start, gaps, of_D = self.start, self.gaps, self._of_D
        a, b, D, momentum = start.a, abs(start.b), gaps.a_u3_u0, abs(start.momentum)
        c0, parts = (start.sin * start.theta_rate) ** 2, _sizes(start)[1]
        of_sum = (PAIR_EPS * parts + 2 * of_D * (parts + a * c0 / D)) / D
        x1, x2 = gaps.u1_u0, gaps.u0_u2
        larger, smaller = np.maximum(x1, x2), np.minimum(x1, x2)
        of_larger = of_sum + larger * (of_D + PAIR_EPS)
        of_smaller = smaller * (of_D + PAIR_EPS + of_larger / larger)
        of_x1 = np.where(x1 >= x2, of_larger, of_smaller)
        of_x2 = np.where(x1 >= x2, of_smaller, of_larger)
        errors = (
            (gaps.u1_u2, of_x1 + of_x2),
            (gaps.above_u1, of_x1 + PAIR_EPS * start.above),
            (gaps.above_u2, of_x2 + PAIR_EPS * start.above),
            (gaps.below_u1, of_x1 + PAIR_EPS * start.below),
            (gaps.below_u2, of_x2 + PAIR_EPS * start.below),
            (gaps.a_u3_u1, a * of_x1 + (of_D + PAIR_EPS) * D),
            (gaps.a_u3_above, (of_D + PAIR_EPS) * D),
        )
        worst = reduce(np.maximum, (error / gap for gap, error in errors))
        self.noise: Array = worst + PAIR_EPS
        self.known = (worst < GOOD) & (reduce(np.minimum, (gap for gap, _ in errors)) > 0)
        self._sizes = momentum + b * x1, momentum + b * x2
        ends = (gaps.momentum_u1, of_x1), (gaps.momentum_u2, of_x2)
        for size, (value, of_x) in zip(self._sizes, ends, strict=True):
            self.known &= PAIR_EPS * size + b * of_x < _SURE * abs(value)

    def check_means(self, spin: Array, precession: Array) -> None:
        """Note for which tops the mean rates cannot be trusted.

        As dn^2 lies between k'^2 and 1, the mean of (x cn^2 + y sn^2)/(cn^2 + p sn^2) is at most
        x + y/sqrt(p) for p <= 1.
        """
        gaps, mc = self.gaps, self["k_prime"] * self["k_prime"]
        at_u1, at_u2 = self._sizes

        def size_of(from_u1: Array, from_u2: Array) -> Array:
            root = np.sqrt(np.minimum(mc * from_u2 / from_u1, 1.0))
            size: Array = (at_u1 + at_u2 * mc / root) / from_u1
            return size

        south = size_of(gaps.below_u1, gaps.below_u2)
        size = south + size_of(gaps.above_u1, gaps.above_u2)
        self.known &= self.noise * size < 8 * GOOD * abs(precession)
        self.known &= self.noise * (size + abs(self.start.r0)) < 8 * GOOD * abs(spin)


def paths(of: AnyStart) -> Any:
    """Return the paths of the axis: looping if the precession turns back at u1."""
    sign = np.sign(of.start.b)
    looping = (sign * of.gaps.momentum_u1 < 0) & (sign * of.gaps.momentum_u2 > 0)
    return np.where(looping, "looping", "wavy")


def mean_rates(of: AnyStart) -> tuple[Array, Array]:
    """Return the mean rates of spin (6,3) and precession (7,3).

    They are computed in doubles, or in pairs if their parts cancel.
    """
    south, north = mean_parts(of["k_prime"], of.gaps)
    r0, size = of.start.r0, abs(south) + abs(north)
    mixed = np.flatnonzero(of.gaps.momentum_u1 * of.gaps.momentum_u2 < 0)
    if mixed.size:
        some = Gaps(*(x[mixed] for x in of.gaps))
        sizes = abs(some.momentum_u1), abs(some.momentum_u2)
        size[mixed] = sum(mean_parts(of["k_prime"][mixed], some, sizes))
    spin, precession = r0 + south - north, south + north
    cancels = size > _MOST_SIZE * abs(precession)
    rows = np.flatnonzero(cancels | (size + abs(r0) > _MOST_SIZE * abs(spin)))
    if rows.size:
        few = Gaps(*(x[rows] for x in of.gap_pairs))
        south, north = mean_parts((few.a_u3_u1 / few.a_u3_u2).sqrt(), few)
        precession[rows] = (south + north).high
        spin[rows] = (DoubleDouble(r0[rows]) + south - north).high
    of.check_means(spin, precession)
    return spin, precession


def spin_rate_start(of: AnyStart) -> DoubleDouble:
    """Return the spin rate at the start (4,8)."""
    rate: DoubleDouble = of.pairs.spin_rate
    parts = abs(of.start.r0) + abs(of.start.psi_rate)
    of.known &= PAIR_EPS * parts < 8 * GOOD * abs(rate.high)
    return rate


OF_ANY_START: Formulas = OF_NUTATION | {
    "regime": lambda of: np.where(of.start.r0 == 0, "no spin", "regular"),
    "path": paths,
    "u1": lambda of: of.pairs.cos + of.gap_pairs.u1_u0,
    "u2": lambda of: u2(of.gap_pairs),
    "spin_rate_start": spin_rate_start,
    "half": lambda of: rates_half(of.pairs, of.gap_pairs),
    "spin_rate_half": lambda of: of["half"][0],
    "precession_rate_half": lambda of: of["half"][1],
    "means": mean_rates,
    "mean_spin_rate": lambda of: of["means"][0],
    "mean_precession_rate": lambda of: of["means"][1],
}
"""Formulas of tops with any initial rates, in pairs where larger numbers may cancel."""


def _sizes(start: Start) -> tuple[Array, Array]:
    """Return the sizes of the terms of c2 and of c1 of `cubic_of`, in doubles."""
    a, b, energy, cos = start.a, abs(start.b), start.energy, abs(start.cos)
    of_c1 = 2 * b * abs(start.momentum) + a * start.sin**2 + 2 * cos * energy
    return 2 * a * cos + energy + b * b, of_c1


def largest_root(
    start: Start, cubic: tuple[DoubleDouble, DoubleDouble, DoubleDouble]
) -> tuple[DoubleDouble, Array]:
    """Return D = a (u3 - u0) of tops in pairs, and a bound of its relative error.

    D is the largest root of X^3 + c2 X^2 + a c1 X + a^2 c0.  From a bound above it, Newton's method
    descends in doubles, and ends in pairs.
    """
    c2, c1, c0 = cubic
    c1, c0 = start.a * c1, start.a * (start.a * c0)
    rough = start.in_doubles()
    size2, of_c1 = _sizes(rough)
    size1, size0 = rough.a * of_c1, c0.high
    b2, b1, b0 = c2.high, c1.high, c0.high
    x = rough.energy + rough.b * rough.b + 2 * rough.a
    for _ in range(_NEWTON_STEPS):
        slope = (3 * x + 2 * b2) * x + b1
        step = (((x + b2) * x + b1) * x + b0) / slope
        x = np.where(slope > 0, x - step, x)
        if not (abs(step) > 1e-9 * x).any():
            break
    root, error = DoubleDouble(x), np.full_like(x, np.inf)
    for _ in range(_STEPS_IN_PAIRS):
        value = ((root + c2) * root + c1) * root + c0
        slope = (3 * x + 2 * b2) * x + b1
        step = value.high / slope
        root = root - DoubleDouble(step)
        x, step = root.high, abs(step)
        noise = PAIR_EPS * (((x + size2) * x + size1) * x + size0)
        of_slope = 2.0**-49 * ((3 * x + 2 * abs(b2)) * x + abs(b1))
        error = (noise + step * (of_slope + step * (3 * x + abs(b2)))) / abs(slope) / x
        if not (error > _SETTLED).any():
            break
    return root, error
