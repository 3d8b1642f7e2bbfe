"""Inversion of turning points, period and mean precession: a and b of the top, for `find`.

The roots u2 < u1 < u3 of (4,9) are known except for h = u3 - 1 > 0. (4,19) and (5,1) give

    k^2 = (u1 - u2)/(1 - u2 + h),   k'^2 = (1 - u1 + h)/(1 - u2 + h),   a = (4 K/T)^2/(1 - u2 + h),

and the cubic at u = 1 and -1 gives the momenta at the poles up to their signs:

    (beta - b)^2 = a (1 - u1)(1 - u2) h,    (beta + b)^2 = a (1 + u1)(1 + u2)(2 + h).

The mean precession, by complete integrals of the third kind, then determines h.  No difference of
nearly equal numbers is formed, however near to a pole the axis turns.  Equation numbers are
Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from ..elliptic.complete import complete_k, period_mean
from ..errors import LagtopError
from ..inputs.top import Top
from ..motion.solve import solve

if TYPE_CHECKING:
    pass

_SEEN = ("theta_min_deg", "theta_max_deg", "T_nutation", "mean_precession_rate")
_SPIN = "mean_spin_rate"
_MIDDLE = np.tan(np.linspace(0, math.pi / 2, 401)[1:-1]) ** 2
_HEIGHTS = np.concatenate([np.geomspace(1e-40, 1e-5, 71), _MIDDLE, np.geomspace(1e5, 1e20, 31)])
"""Values of (u3 - 1)/(1 - u2) between which a mean precession is searched for.  Fast tops have
large values, slow tops small ones.
"""
_BISECTIONS = 56
"""Halvings that bring neighbouring heights to neighbouring doubles."""
SIGNS = ((1, 1), (1, -1), (-1, 1), (-1, -1))
"""Signs of beta + b and of beta - b."""


class TurningPoints(NamedTuple):
    """Observed turning points, tilts in radians or arrays of them, and the observed period."""

    theta_min: Any
    theta_max: Any
    period: float

    def checked(self, *, radians: bool = False) -> TurningPoints:
        """Return the turning points after a check.

        Raises LagtopError for values that no top has, with tilts in degrees or in radians.
        """
        if not 0 < self.theta_min < self.theta_max < math.pi:
            most = "pi" if radians else "180 degrees"
            unit, _ = angle_unit(radians=radians)
            raise LagtopError(
                f"theta_min and theta_max must satisfy 0 < theta_min < theta_max < {most}, "
                f"got {self.theta_min * unit:g} and {self.theta_max * unit:g}"
            )
        if not 0 < self.period < math.inf:
            raise LagtopError(f"T_nutation must be > 0, got {self.period:g}")
        return self

    @property
    def u1(self) -> Any:
        """Cosine of the least tilt."""
        return np.cos(self.theta_min)

    @property
    def u2(self) -> Any:
        """Cosine of the greatest tilt."""
        return np.cos(self.theta_max)

    @property
    def from_top(self) -> tuple[Any, Any]:
        """Distances 1 - u1 and 1 - u2 from the upper pole."""
        return 2 * np.sin(self.theta_min / 2) ** 2, 2 * np.sin(self.theta_max / 2) ** 2

    @property
    def from_bottom(self) -> tuple[Any, Any]:
        """Distances 1 + u1 and 1 + u2 from the lower pole."""
        return 2 * np.cos(self.theta_min / 2) ** 2, 2 * np.cos(self.theta_max / 2) ** 2


class Candidates(NamedTuple):
    """Tops that share a nutation: an array for each quantity, or a number for a single top."""

    u3_above: Array
    """The difference u3 - 1 > 0."""
    a: Array
    plus: Array
    """The momentum at the lower pole, beta + b, with beta of (4,5)."""
    minus: Array
    """The momentum at the upper pole, beta - b."""
    mean_rate: Array
    """The mean precession rate."""

    @property
    def b(self) -> Array:
        """The constant C r0/A of (4,5)."""
        return (self.plus - self.minus) / 2

    def precession_rate(self, theta: Array | float) -> Array:
        """Return the precession rate, by (4,5), at a tilt in radians."""
        rate: Array = self.plus / np.cos(theta / 2) ** 2 + self.minus / np.sin(theta / 2) ** 2
        return rate / 4

    def tilt_rate(self, nutation: TurningPoints, theta: Array | float) -> Array:
        """Return the size of the nutation rate, by (4,9), at a tilt between the turning points."""
        u = np.cos(theta)
        between = np.maximum((nutation.u1 - u) * (u - nutation.u2), 0.0)
        rate: Array = np.sqrt(self.a * between * (1 - u + self.u3_above)) / np.sin(theta)
        return rate

    def at(self, index: Any) -> Candidates:
        """Return some of the tops."""
        return Candidates(*(x[index] for x in self))

    @classmethod
    def joined(cls, parts: Iterable[Candidates]) -> Candidates:
        """Return several groups of tops as one."""
        return cls(*map(np.concatenate, zip(*parts, strict=True)))


def candidates(nutation: TurningPoints, u3_above: Array, signs: tuple[int, int]) -> Candidates:
    """Return the tops with these u3 - 1; `signs` are the signs of beta + b and beta - b."""
    north, south = nutation.from_top, nutation.from_bottom
    u3_above_u2 = north[1] + u3_above
    k_prime = np.sqrt((north[0] + u3_above) / u3_above_u2)
    a = (4 * complete_k(ARRAYS, k_prime) / nutation.period) ** 2 / u3_above_u2
    plus = signs[0] * np.sqrt(a * south[0] * south[1] * (2 + u3_above))
    minus = signs[1] * np.sqrt(a * north[0] * north[1] * u3_above)
    mean_rate = (plus * mean_inverse(k_prime, *south) + minus * mean_inverse(k_prime, *north)) / 2
    return Candidates(u3_above, a, plus, minus, mean_rate)


def mean_inverse(k_prime: Array, at_u1: Any, at_u2: Any) -> Array:
    """Return the mean of 1/p over a period, for p > 0 linear in u, from p at u1 and u2.

    With u = u2 + (u1 - u2) sn^2 w it is the mean of 1/(p(u2) cn^2 + p(u1) sn^2).
    """
    mean: Array = period_mean(ARRAYS, k_prime, at_u1 / at_u2, 1, 1) / at_u2
    return mean


def with_mean_rate(nutation: TurningPoints, mean_rate: float) -> Candidates:
    """Return the tops with a given nutation and mean precession rate, the fastest first."""
    grid, found = nutation.from_top[1] * _HEIGHTS, []
    for signs in SIGNS:
        high_at = candidates(nutation, grid, signs).mean_rate > mean_rate
        i = np.flatnonzero(high_at[:-1] != high_at[1:])
        low, high = grid[i], grid[i + 1]
        for _ in range(_BISECTIONS):
            middle = np.sqrt(low * high)
            below = (candidates(nutation, middle, signs).mean_rate > mean_rate) == high_at[i]
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        found.append(candidates(nutation, high, signs))
    tops = Candidates.joined(found)
    return tops.at(np.argsort(-tops.u3_above, kind="stable"))


def top_of(nutation: TurningPoints, found: Candidates, mean_spin: float | None = None) -> Top:
    """Return a top that starts at u1, in units of A = 1 and m = s = 1.

    C = A if no mean spin rate is given; a mean spin rate determines C.  Raises LagtopError if no
    body has it.
    """
    a, b = float(found.a), float(found.b)
    start = {
        "theta0_rad": nutation.theta_min,
        "psidot0": float(found.precession_rate(nutation.theta_min)),
    }
    body = {"m": 1.0, "s": 1.0, "g": a / 2, "A": 1.0}
    top = Top(**body, **start, C=1.0, r0=b)
    if mean_spin is None:
        return top
    r0 = mean_spin + b - solve(top).mean_spin_rate
    if not 0 < b / r0 <= 2:
        raise LagtopError(f"mean_spin_rate must give 0 < C/A <= 2, got C/A = {b / r0:.6g}")
    return top.replace(C=b / r0, r0=r0)
