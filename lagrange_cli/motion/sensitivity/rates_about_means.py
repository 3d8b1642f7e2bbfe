"""The rates of spin and precession of a nutating top less their means, at arrays of phases."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arithmetic.arrays import ARRAYS
from ...arithmetic.duals import Dual
from ...arithmetic.types import Array
from ...elliptic.jacobi import jacobi
from ...elliptic.modulus import Modulus
from ..kinds import Nutating


class RatesAboutMeans(NamedTuple):
    """The rates of spin and precession about their means, by how far u is from u1 and u2."""

    modulus: Modulus
    quarter: float
    """K."""
    south: float
    """(beta + b)/2 (u1 - u2)/(1 + u1), over 1 + u the part of the precession rate beyond u1."""
    north: float
    south_at_u1: float
    """(beta + b)/2/(1 + u1) less the mean of (beta + b)/2/(1 + u)."""
    north_at_u2: float
    first_is_upper: bool
    """Whether the turning point of the even steps is u1."""

    @classmethod
    def of(
        cls, motion: Nutating[Dual], means: Nutating[Dual], *, first_is_upper: bool
    ) -> RatesAboutMeans:
        """Return the constants of a motion, rounded from many digits."""
        gaps = motion.gaps
        plus, minus = gaps.beta_plus_b.value / 2, gaps.beta_minus_b.value / 2
        drift = means.mean_spin_rate.value - motion.state.pole_drift.value
        precession, width = means.mean_precession_rate.value, gaps.u1_u2.value
        south, north = plus / gaps.below_u1.value, minus / gaps.above_u2.value
        return cls(
            Modulus(float(motion.k.value), float(motion.k_prime.value)),
            quarter=float(motion.K.value),
            south=float(south * width),
            north=float(north * width),
            south_at_u1=float(south - (precession + drift) / 2),
            north_at_u2=float(north - (precession - drift) / 2),
            first_is_upper=first_is_upper,
        )

    def at(
        self, phase: Array, odd: Array, below: Array, above: Array
    ) -> tuple[Array, Array, Array]:
        """Return both rates less their means, and the size of the parts of which both are sums.

        `below` and `above` are 1 + u and 1 - u.
        """
        _, sn, cn, dn = jacobi(ARRAYS, phase * self.quarter, self.modulus)
        away = sn * sn  # (u - u2)/(u1 - u2) about u2, and cn^2 the rest
        mirrored = (self.modulus.k_prime * sn / dn) ** 2
        upper = odd != self.first_is_upper
        under_u1 = np.where(upper, mirrored, cn * cn)
        over_u2 = np.where(upper, (cn / dn) ** 2, away)
        south, north = self.south * under_u1 / below, self.north * over_u2 / above
        size = abs(south) + abs(north) + abs(self.south_at_u1) + abs(self.north_at_u2)
        south, north = south + self.south_at_u1, north + self.north_at_u2
        return south - north, south + north, size
