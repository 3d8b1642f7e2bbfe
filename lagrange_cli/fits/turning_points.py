"""The top behind its turning points, its period and its mean precession: a and b.

With the roots u2 < u1 < u3 of (4,9) and k^2 = (u1 - u2)/(u3 - u2), (4,19) and (5,1) give

    a = (4 K/T)^2 k^2/(u1 - u2),    u3 = u2 + (u1 - u2)/k^2,

and the cubic at u = 1 and -1 gives the momenta at the poles but for their signs:

    (beta - b)^2 = a (1 - u1)(1 - u2)(u3 - 1),    (beta + b)^2 = a (1 + u1)(1 + u2)(u3 + 1).

The mean precession, by complete integrals of the third kind, then decides about k.  Equation
numbers are Chrapan's.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arithmetic.angles import per_radian
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.top import Top

SIGNS = ((1, 1), (1, -1), (-1, 1), (-1, -1))
"""Signs of beta + b and of beta - b."""


class Nutation(NamedTuple):
    """What is seen of a nutation: tilts in radians, and the period."""

    theta_min: float
    theta_max: float
    period: float

    def checked(self, *, radians: bool = False) -> Nutation:
        """Return the nutation.

        Raises LagtopError for one that no top has, with its tilts in degrees or in radians.
        """
        if not 0 < self.theta_min < self.theta_max < math.pi:
            most, unit = "pi" if radians else "180 degrees", per_radian(radians=radians)
            raise LagtopError(
                f"theta_min and theta_max must be 0 < theta_min < theta_max < {most}, "
                f"got {self.theta_min * unit:g} and {self.theta_max * unit:g}"
            )
        if not 0 < self.period < math.inf:
            raise LagtopError(f"T_nutation must be > 0, got {self.period:g}")
        return self

    @property
    def u1(self) -> float:
        """cos(theta_min)."""
        return math.cos(self.theta_min)

    @property
    def u2(self) -> float:
        """cos(theta_max)."""
        return math.cos(self.theta_max)

    @property
    def swing(self) -> float:
        """u1 - u2, without a difference of cosines."""
        half_sum = (self.theta_max + self.theta_min) / 2
        return 2 * math.sin(half_sum) * math.sin((self.theta_max - self.theta_min) / 2)

    @property
    def most_m(self) -> float:
        """The k^2 of u3 = 1."""
        return self.swing / (1 - self.u2)


class Candidates(NamedTuple):
    """Tops that have one nutation, an array each, or a number each of one top."""

    m: Array
    """k^2."""
    a: Array
    b: Array
    beta: Array
    """The constant of (4,5)."""
    mean_rate: Array
    """The mean precession rate."""

    def at(self, index: int) -> Candidates:
        """Return one of them."""
        return Candidates(*(x[index] for x in self))


def shares(inner: int, low: float, high: float, per_decade: int) -> Array:
    """Return where k^2 is looked for, as shares of its greatest value, from `low` to 1 - `high`.

    Fast tops are next to 0 and slow ones next to 1: outside the `inner` shares there are so many
    per power of ten.
    """
    middle = (1 - np.cos(np.linspace(0, math.pi, inner + 2)[1:-1])) / 2
    ends = [
        10.0 ** np.arange(math.log10(end), math.log10(middle[0]), 1 / per_decade)
        for end in (low, high)
    ]
    return np.concatenate([ends[0], middle, 1 - ends[1][::-1]])


def candidates(nutation: Nutation, m: Array, signs: tuple[int, int]) -> Candidates:
    """Return the tops with these moduli; `signs` are those of beta + b and of beta - b."""
    from scipy.special import ellipk

    u1, u2, swing = nutation.u1, nutation.u2, nutation.swing
    K = ellipk(m)
    a = (4 * K / nutation.period) ** 2 * m / swing
    below, above = (1 + u1) * (1 + u2), (1 - u1) * (1 - u2)
    u3_above = np.maximum(swing / m - (1 - u2), 0.0)
    plus = signs[0] * np.sqrt(a * below * (u3_above + 2))
    minus = signs[1] * np.sqrt(a * above * u3_above)
    south = plus / 2 * _mean_inverse(m, K, 1 + u2, 1 + u1)
    north = minus / 2 * _mean_inverse(m, K, 1 - u2, 1 - u1)
    return Candidates(m, a, (plus - minus) / 2, (plus + minus) / 2, south + north)


def _mean_inverse(m: Array, K: Array, at_u2: float, at_u1: float) -> Array:
    """Return the mean of 1/p over a period, for p linear in u, by its values at u2 and u1.

    From u2 on, u = u2 + (u1 - u2) sn^2 w; the mean is Pi(n, m)/(K p2) with 1 - n = p1/p2.
    """
    from scipy.special import elliprf, elliprj

    n = 1 - at_u1 / at_u2
    third = elliprf(0, 1 - m, 1) + n / 3 * elliprj(0, 1 - m, 1, 1 - n)
    mean: Array = third / K / at_u2
    return mean


def with_mean_rate(nutation: Nutation, mean_rate: float) -> list[Candidates]:
    """Return the tops that have a nutation and a mean precession rate."""
    from scipy.optimize import brentq

    found: list[Candidates] = []
    moduli = nutation.most_m * shares(399, 1e-20, 1e-14, 2)
    for signs in SIGNS:

        def off(m: float, signs: tuple[int, int] = signs) -> float:
            return float(candidates(nutation, np.array(m), signs).mean_rate) - mean_rate

        rates = candidates(nutation, moduli, signs).mean_rate - mean_rate
        for i in np.flatnonzero(rates[:-1] * rates[1:] <= 0).tolist():
            m = brentq(off, moduli[i], moduli[i + 1], xtol=1e-300, rtol=1e-15)
            found.append(candidates(nutation, np.array(m), signs))
    return sorted(found, key=lambda x: float(x.m))


def top_of(nutation: Nutation, found: Candidates, mean_spin: float | None = None) -> Top:
    """Return a top that starts at u1, in units of A = 1 and m = s = 1.

    C is A as long as nobody knows the spin rate; a mean spin rate tells it.  Raises LagtopError
    where no body has it.
    """
    a, b, beta = float(found.a), float(found.b), float(found.beta)
    start = {
        "theta0_rad": nutation.theta_min,
        "psidot0": (beta - b * nutation.u1) / math.sin(nutation.theta_min) ** 2,
    }
    body = {"m": 1.0, "s": 1.0, "g": a / 2, "A": 1.0}
    top = Top(**body, **start, C=1.0, r0=b)
    if mean_spin is None:
        return top
    from ..motion.solve import solve

    r0 = mean_spin + b - solve(top).mean_spin_rate
    if not 0 < b / r0 <= 2:
        raise LagtopError(f"mean_spin_rate must be one with 0 < C/A <= 2, got C/A = {b / r0:.6g}")
    return top.replace(C=b / r0, r0=r0)
