"""Arrays of tops with any initial rates: gaps in pairs of doubles, and which to trust.

The formulas are those of `motion.gaps`.  Each gap has an error bound, found from the sizes of the
numbers that were subtracted.  If such a difference costs too many digits, the top is not trusted,
and `solve` computes it by itself.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property, reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.arrays import ARRAYS, PAIRS
from ..arithmetic.pairs import DoubleDouble
from ..arithmetic.types import Array, Mask
from ..solver.any_start import gaps_from_start
from ..solver.gaps import Gaps
from ..solver.regime import Facts, Regime
from ..solver.spin_precession import Nutating, mean_over
from .top_arrays import PAIR_EPS, TopArrays

_SETTLED = 2.0**-90
"""Relative error at which the largest root is settled."""
_GOOD = 2.0**-54
"""Relative error at which a gap is trusted; a rate, whose bound is wider, at eight times it."""
_SURE = 2.0**-10
"""Relative error at which a sign is trusted."""
FACTS = Facts(regime=Regime.REGULAR, at_rest=False, steady=False, free=False, spins=True)
_NEWTON_STEPS = 50
_STEPS_IN_PAIRS = 4
_MOST_SIZE = 2.0
"""Size of the parts of a mean rate, over the rate, up to which doubles are within ten eps.

In 245 000 random tops the error of a rate was at most 5.2 eps of that size.
"""
_MEANS = {"mean_spin_rate": 0, "mean_precession_rate": 1, "T_spin": 0, "T_precession": 1}
"""The keys of the mean rates, and their positions."""
_DIFFERENCES = frozenset("u1 u2 spin_rate_start spin_rate_half precession_rate_half".split())
"""Keys in which larger numbers may cancel, so that they are computed in pairs."""


class MovingTops:
    """Motions of many tops with a torque, off the poles."""

    def __init__(self, tops: TopArrays) -> None:
        with PAIRS.working():  # results of an overflow or a division by zero are not trusted
            state, errors = tops.pair_state(), []

            def find_root(_: Any, *cubic_and_bound: DoubleDouble) -> DoubleDouble:
                root, error = _largest_root(*cubic_and_bound)
                errors.append(error)
                return root

            gaps = gaps_from_start(PAIRS, state, FACTS, find_root)
            self.fine = Nutating(PAIRS, FACTS, state, gaps)
            self.rough = Nutating(ARRAYS, FACTS, _rounded(state), _rounded(gaps))
            self._bound_errors(errors[0])

    def _bound_errors(self, error: Array) -> None:
        """Bound the errors of the gaps, from the relative `error` of the largest root.

        `noise` bounds the relative errors of the gaps and of numbers computed from them.  `small`
        is True if all gaps and the signs of beta - b u at u1 and u2 are certain.  `_momenta` are
        the sizes of the terms of beta - b u at these roots.
        """
        start, gaps = self.rough.state, self.rough.gaps
        a, b, above, below = start.a, start.b, start.above, start.below
        D, x1, x2 = gaps.a_u3_u, gaps.u1_u, gaps.u_u2
        momentum = start.momentum
        c0 = (start.sin * start.theta_rate) ** 2
        c1_parts = abs(2 * b * momentum) + a * start.sin**2 + abs(2 * start.cos * start.energy)
        of_total = (PAIR_EPS * c1_parts + 2 * error * (c1_parts + a * c0 / D)) / D
        larger, smaller = np.maximum(x1, x2), np.minimum(x1, x2)
        of_larger = of_total + larger * (error + PAIR_EPS)
        of_smaller = smaller * (error + PAIR_EPS + of_larger / larger)
        of_x1 = np.where(x1 >= x2, of_larger, of_smaller)
        of_x2 = np.where(x1 >= x2, of_smaller, of_larger)
        of_D = error * D
        bounds = (
            (of_x1 + of_x2, gaps.u1_u2),
            (PAIR_EPS * above + of_x1, gaps.above_u1),
            (PAIR_EPS * above + of_x2, gaps.above_u2),
            (PAIR_EPS * below + of_x1, gaps.below_u1),
            (PAIR_EPS * below + of_x2, gaps.below_u2),
            (of_D + PAIR_EPS * D + a * of_x1, gaps.a_u3_u1),
            (of_D + PAIR_EPS * D, gaps.a_u3_above),
        )
        worst = reduce(np.maximum, (bound / gap for bound, gap in bounds))
        self.noise: Array = worst + PAIR_EPS
        self.small: Mask = (worst < _GOOD) & (reduce(np.minimum, (x for _, x in bounds)) > 0)
        self._momenta = abs(momentum) + abs(b) * x1, abs(momentum) + abs(b) * x2
        at_ends = (of_x1, gaps.momentum_u1), (of_x2, gaps.momentum_u2)
        for size, (of_x, value) in zip(self._momenta, at_ends, strict=True):
            self.small &= PAIR_EPS * size + abs(b) * of_x < _SURE * abs(value)

    def trusted(self, keys: Collection[str]) -> Mask:
        """Return which tops can be trusted for some keys."""
        with PAIRS.working():
            if not {*_MEANS, "spin_rate_start"} & set(keys):
                return self.small
            return self.small & self._rates_are_sure()

    def number(self, key: str) -> Array | None:
        """Return the numbers of a key, an array over all tops; None if no top has one."""
        with PAIRS.working():
            if key in Nutating.lacks:
                return None
            if key in _MEANS:
                mean = self._means[_MEANS[key]]
                return 2 * np.pi / abs(mean) if key.startswith("T_") else mean
            if key in _DIFFERENCES:
                value: Any = getattr(self.fine, key)
                return None if value is None else value.high
            rough: Array | None = getattr(self.rough, key)
            return rough

    def paths(self) -> NDArray[np.object_]:
        """Return the paths of the axis."""
        b, gaps = np.sign(self.rough.b), self.rough.gaps
        looping = (b * gaps.momentum_u1 < 0) & (b * gaps.momentum_u2 > 0)
        names = np.array(["wavy", "looping"], dtype=object)
        paths: NDArray[np.object_] = names[looping.astype(np.intp)]
        return paths

    @cached_property
    def _means(self) -> tuple[Array, Array]:
        """The mean rates of spin and precession, in doubles, or in pairs if their parts cancel."""
        gaps, r0, k_prime = self.fine.gaps, self.rough.r0, self.rough.k_prime
        places, momenta = ([x.high for x in rows] for rows in _by_pole(gaps))
        means = mean_over(ARRAYS, k_prime, places, momenta)
        # A mean is linear in the momenta, with positive factors.  That of their absolute values is
        # the size of its terms, and differs from the mean if the momenta have both signs.
        sizes, mixed = abs(means), np.flatnonzero(momenta[0][0] * momenta[1][0] < 0)
        if mixed.size:
            some, absolute = ([x[:, mixed] for x in rows] for rows in (places, map(abs, momenta)))
            sizes[:, mixed] = mean_over(ARRAYS, k_prime[mixed], some, absolute)
        size = sizes[0] + sizes[1]
        precession: Array = means[0] + means[1]
        spin: Array = r0 + means[0] - means[1]
        cancels = size > _MOST_SIZE * abs(precession)
        rows = np.flatnonzero(cancels | (size + abs(r0) > _MOST_SIZE * abs(spin)))
        if rows.size:
            few = Gaps(*(x[rows] for x in gaps))
            south, north = mean_over(PAIRS, (few.a_u3_u1 / few.a_u3_u2).sqrt(), *_by_pole(few))
            precession[rows] = (south + north).high
            spin[rows] = (DoubleDouble(r0[rows]) + south - north).high
        return spin, precession

    @cached_property
    def precession_size(self) -> Array:
        """Size of the mean precession rate if nothing in it cancelled: a mean <= 1/sqrt(p)."""
        rough, gaps = self.rough, self.rough.gaps
        mc = rough.k_prime * rough.k_prime
        at_u1, at_u2 = self._momenta

        def size_of_part(from_u1: Array, from_u2: Array) -> Array:
            root = np.sqrt(np.minimum(mc * from_u2 / from_u1, 1.0))
            part: Array = at_u1 / from_u1 + at_u2 * mc / (from_u1 * root)
            return part

        south = size_of_part(gaps.below_u1, gaps.below_u2)
        return south + size_of_part(gaps.above_u1, gaps.above_u2)

    def _rates_are_sure(self) -> Mask:
        """Return which tops have mean rates to the digits of a double, despite cancellation."""
        rough, size = self.rough, self.precession_size
        spin, precession = self._means
        at_start: Any = self.fine.spin_rate_start
        sure: Mask = self.noise * size < 8 * _GOOD * abs(precession)
        sure &= self.noise * (size + abs(rough.r0)) < 8 * _GOOD * abs(spin)
        parts = abs(rough.r0) + abs(rough.state.psi_rate)
        sure &= PAIR_EPS * parts < 8 * _GOOD * abs(at_start.high)
        return sure


def _by_pole(gaps: Gaps[DoubleDouble]) -> tuple[list[DoubleDouble], list[DoubleDouble]]:
    """Return distances of u1 and u2 from both poles, and momenta at the poles, as two rows each.

    The lower pole comes first.
    """
    distances = (gaps.below_u1, gaps.above_u1), (gaps.below_u2, gaps.above_u2)
    momenta = (gaps.momentum_u1, gaps.momentum_u1), (gaps.momentum_u2, gaps.momentum_u2)
    return [DoubleDouble.stacked(x) for x in distances], [DoubleDouble.stacked(x) for x in momenta]


def _largest_root(
    c2: DoubleDouble, c1: DoubleDouble, c0: DoubleDouble, bound: DoubleDouble
) -> tuple[DoubleDouble, Array]:
    """Return the largest root of x^3 + c2 x^2 + c1 x + c0, and a bound of its relative error.

    Viete's formula gives a start; Newton's method refines it in doubles, then in pairs.  The error
    after a step is bounded by the noise of the value, the noise of the slope, and the curvature.
    """
    b2, b1, b0 = c2.high, c1.high, c0.high
    size2, size1, size0 = abs(b2), abs(b1), abs(b0)
    x = np.fmin(bound.high, _vieta(b2, b1, b0))
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
        steep = 2.0**-49 * ((3 * x + 2 * size2) * x + size1)
        error = (noise + step * (steep + step * (3 * x + size2))) / abs(slope) / x
        if not (error > _SETTLED).any():
            break
    return root, error


def _vieta(b2: Array, b1: Array, b0: Array) -> Array:
    """Return an estimate of the largest root of x^3 + b2 x^2 + b1 x + b0, whose roots are real."""
    square = (b2 * b2 - 3 * b1) / 9
    radius = np.sqrt(square)
    cosine = ((9 * b1 - 2 * b2 * b2) * b2 - 27 * b0) / (54 * square * radius)
    root: Array = 2 * radius * np.cos(np.arccos(np.clip(cosine, -1, 1)) / 3) - b2 / 3
    return root


def _rounded(pairs: Any) -> Any:
    """Return values with pairs of doubles rounded to doubles."""
    return type(pairs)(*(x.high for x in pairs))
