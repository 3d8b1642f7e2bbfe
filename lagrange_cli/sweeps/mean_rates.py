"""Mean rates of many tops: in doubles, and in pairs of doubles where their parts cancel."""

from __future__ import annotations

import numpy as np

from ..arithmetic.arrays import ARRAYS, PAIRS
from ..arithmetic.double_double import DoubleDouble
from ..arithmetic.types import Array
from ..motion.gaps import Gaps
from ..motion.spin_precession import mean_over

_MOST_SIZE = 2.0
"""Size of the parts of a mean rate, over the rate, up to which doubles are good to ten eps.

In 245 000 random tops the error of a rate was at most 5.2 eps of that size.
"""


class MeanRates:
    """Mean rates of spin and precession of tops that start with any rates.

    Both poles are dealt with together, as two rows.
    """

    def __init__(self, r0: Array, k_prime: Array, gaps: Gaps[DoubleDouble]) -> None:
        places, momenta = ([x.high for x in rows] for rows in _by_pole(gaps))
        means = mean_over(ARRAYS, k_prime, places, momenta)
        # A mean is linear in the momenta, with positive factors: that of their absolute values is
        # the size of what is added up.  It differs where they have both signs.
        sizes, mixed = abs(means), np.flatnonzero(momenta[0][0] * momenta[1][0] < 0)
        if mixed.size:
            some, absolute = ([x[:, mixed] for x in rows] for rows in (places, map(abs, momenta)))
            sizes[:, mixed] = mean_over(ARRAYS, k_prime[mixed], some, absolute)
        size = sizes[0] + sizes[1]
        self.precession: Array = means[0] + means[1]
        self.spin: Array = r0 + means[0] - means[1]
        cancels = size > _MOST_SIZE * abs(self.precession)
        cancels |= size + abs(r0) > _MOST_SIZE * abs(self.spin)
        if cancels.any():
            rows = np.flatnonzero(cancels)
            few = Gaps(*(x[rows] for x in gaps))
            self.precession[rows], self.spin[rows] = _means_in_pairs(r0[rows], few)


def _means_in_pairs(r0: Array, gaps: Gaps[DoubleDouble]) -> tuple[Array, Array]:
    """Return the mean rates of precession and spin, computed in pairs."""
    k_prime = (gaps.a_u3_u1 / gaps.a_u3_u2).sqrt()
    means = mean_over(PAIRS, k_prime, *_by_pole(gaps))
    south, north = means[0], means[1]
    return (south + north).high, (DoubleDouble(r0) + south - north).high


def _by_pole(gaps: Gaps[DoubleDouble]) -> tuple[list[DoubleDouble], list[DoubleDouble]]:
    """Return the distances of u1 and u2 from both poles, and the momenta there, as two rows each.

    The lower pole comes first.
    """
    distances = (gaps.below_u1, gaps.above_u1), (gaps.below_u2, gaps.above_u2)
    momenta = (gaps.momentum_u1, gaps.momentum_u1), (gaps.momentum_u2, gaps.momentum_u2)
    return [DoubleDouble.stacked(x) for x in distances], [DoubleDouble.stacked(x) for x in momenta]
