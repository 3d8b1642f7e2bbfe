"""The formulas of the paper for many tops at once, in forms that avoid cancellation.

Numbers are arrays of doubles, or pairs of doubles (`DoubleDouble`) where differences cancel.
`solver` evaluates the formulas as they are printed, in enclosures that show lost digits.  Arrays
cannot show them.  Each formula here is therefore a sum of positive terms, a product or a quotient
wherever the printed one subtracts nearly equal numbers.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.special import ellipe, ellipkm1, elliprf

from ..arithmetic.pairs import DoubleDouble
from ..arithmetic.types import Array, Mask
from ..solver.keys import degree_name
from .tops import Doubles, Start, TopArrays

_LEAST, _MOST = 1e-280, 1e280
"""Sizes between which pairs of doubles keep all of their digits."""


def sqrt(x: Doubles) -> Doubles:
    """Return the square roots of numbers >= 0."""
    return x.sqrt() if isinstance(x, DoubleDouble) else np.sqrt(x)


def where(condition: Mask, yes: Doubles, no: Doubles) -> Doubles:
    """Choose between two numbers, element by element."""
    choose: Any = DoubleDouble.choose if isinstance(yes, DoubleDouble) else np.where
    return choose(condition, yes, no)


class Gaps(NamedTuple):
    """Distances between the roots u2 <= u1 <= 1 <= u3 of (4,9), the poles and the start u0.

    Every later formula needs only these.  Distances from u3 have the factor a, so that they stay
    finite without a torque.
    """

    u1_u0: Doubles
    u0_u2: Doubles
    u1_u2: Doubles
    below_u1: Doubles  # 1 + u1
    below_u2: Doubles
    above_u1: Doubles  # 1 - u1
    above_u2: Doubles
    a_u3_u0: Doubles
    a_u3_u1: Doubles
    a_u3_u2: Doubles
    a_u3_above: Doubles  # a (u3 - 1)
    momentum_u1: Doubles  # beta - b u1, the momentum psi' (1 - u^2) of (4,7) at u1
    momentum_u2: Doubles


def gaps_from_rest(start: Start) -> Gaps:
    """Return the gaps after release from rest, where u1 = u0, from (4,11)-(4,18).

    The roots are at u0 and at the zeros of a quadratic with discriminant rho^2.  Subtracting its
    zeros would lose digits.  Let S and Q be sin^2 and cos^2 of theta0/2.  The products

        a (u3 - u1) (u1 - u2) = 4 a S Q,   a (u3 - 1) (1 - u2) = 2 b^2 S,
        a (u3 + 1) (1 + u2) = 2 b^2 Q

    each have one factor that is a sum of positive terms; the other factor is the quotient.
    """
    a, b, sleep, above, below = start.a, start.b, start.sleep, start.above, start.below
    # half of a (u3 - u1) - a (u1 - u2), in the form that adds above and the one that adds below 0
    x = np.where(above <= below, sleep + a * above, b * b / 2 + a - a * below)
    a_sin = a * start.sin
    rho = np.sqrt(x * x + a_sin * a_sin)
    more = rho + abs(x)
    less = a_sin * (a_sin / more)
    u1_u2 = np.where(x >= 0, start.sin * (a_sin / more), more / a)
    a_u3_u1 = np.where(x >= 0, more, less)
    more_1 = rho + abs(sleep)
    less_1 = b * b * (above / more_1)
    zero = 0 * a
    return Gaps(
        u1_u0=zero,
        u0_u2=u1_u2,
        u1_u2=u1_u2,
        below_u1=below,
        below_u2=b * b * below / (b * b / 2 + a + rho),
        above_u1=above,
        above_u2=np.where(sleep >= 0, less_1, more_1 / a),
        a_u3_u0=a_u3_u1,
        a_u3_u1=a_u3_u1,
        a_u3_u2=2 * rho,
        a_u3_above=np.where(sleep >= 0, more_1, a * less_1),
        momentum_u1=zero,
        momentum_u2=b * u1_u2,
    )


def cubic_of(start: Start) -> tuple[Doubles, Doubles, Doubles]:
    """Return c2, c1, c0 of the cubic (4,9), a x^3 + c2 x^2 + c1 x + c0 in x = u - u0."""
    energy, along = start.energy, start.sin * start.theta_rate
    c2 = 2 * start.a * start.cos - energy - start.b * start.b
    c1 = 2 * start.b * start.momentum - start.a * start.sin * start.sin - 2 * start.cos * energy
    return c2, c1, along * along


def gaps_from_start(start: Start, cubic: tuple[Doubles, Doubles, Doubles], D: Doubles) -> Gaps:
    """Return the gaps of any start from its cubic and D = a (u3 - u0), its largest root times a.

    The other two roots x1 >= 0 >= x2 solve a quadratic equation with a negative last coefficient,
    so that its discriminant is a sum.  The smaller root is the quotient of that coefficient and the
    larger root.  Gaps between a root and a pole are still differences: `trust` bounds their errors.
    """
    a, b = start.a, start.b
    _, c1, c0 = cubic
    total, product = (c1 + a * c0 / D) / D, c0 / D  # x1 + x2 and -x1 x2
    larger = (abs(total) + sqrt(total * total + 4 * product)) / 2
    smaller = product / larger
    up = where(total >= 0, larger, smaller)  # x1
    down = where(total >= 0, smaller, larger)  # -x2
    return Gaps(
        u1_u0=up,
        u0_u2=down,
        u1_u2=up + down,
        below_u1=start.below + up,
        below_u2=start.below - down,
        above_u1=start.above - up,
        above_u2=start.above + down,
        a_u3_u0=D,
        a_u3_u1=D - a * up,
        a_u3_u2=D + a * down,
        a_u3_above=D - a * start.above,
        momentum_u1=start.momentum - b * up,
        momentum_u2=start.momentum + b * down,
    )


def u2(gaps: Gaps) -> Doubles:
    """Return the lower turning point (4,9) from its distance to the nearer pole."""
    return where(gaps.above_u2 < gaps.below_u2, 1 - gaps.above_u2, gaps.below_u2 - 1)


def rates_half(start: Start, gaps: Gaps) -> tuple[Doubles, Doubles]:
    """Return the rates of spin and precession at T/2, (4,8) and (4,7).

    The axis is then at u = u2 + (u1 - u0)(u3 - u2)/(u3 - u0).
    """
    from_u2 = gaps.u1_u0 * (gaps.a_u3_u2 / gaps.a_u3_u0)
    from_u1 = gaps.u0_u2 * (gaps.a_u3_u1 / gaps.a_u3_u0)
    below, above = gaps.below_u2 + from_u2, gaps.above_u1 + from_u1
    precession = (gaps.momentum_u2 - start.b * from_u2) / below / above
    return start.r0 - (below - above) / 2 * precession, precession


def mean_parts(
    k_prime: Doubles, gaps: Gaps, momenta: tuple[Doubles, Doubles] | None = None
) -> tuple[Doubles, Doubles]:
    """Return the means over a period of the partial fractions of psi' (4,7) at both poles,

        south = (beta - b u)/(2 (1 + u)),    north = (beta - b u)/(2 (1 - u)).

    Then psi' = south + north, and phi' = r0 + south - north.  `momenta` replace the values of
    beta - b u at u1 and u2.
    """
    at_u1, at_u2 = momenta or (gaps.momentum_u1, gaps.momentum_u2)
    mc = k_prime * k_prime

    def half_mean(from_u1: Doubles, from_u2: Doubles) -> Doubles:
        mean = period_mean(k_prime, from_u2 * mc / from_u1, at_u1, at_u2 * mc)
        return mean / from_u1 / 2

    return half_mean(gaps.below_u1, gaps.below_u2), half_mean(gaps.above_u1, gaps.above_u2)


def period_mean(k_prime: Doubles, p: Doubles, x: Doubles, y: Doubles) -> Doubles:
    """Return the mean over a period of (x cn^2 + y sn^2)/(cn^2 + p sn^2), for k', p > 0.

    It is Bulirsch's cel(k', p, x, y)/K (DLMF 19.2.11).  Each step is Bartky's transformation
    (Bulirsch 1969), which keeps the mean and squares the distance of m from g.  If x and y have
    one sign, the steps only add numbers of one sign.  Otherwise the error is relative to the mean
    of the absolute values.
    """
    close_to = 2.0**-52 if isinstance(k_prime, DoubleDouble) else 2.0**-26
    m, g, p = 0 * k_prime + 1, k_prime, sqrt(p)
    y = y / p
    while True:
        product = m * g
        quotient = product / p
        x, y, p = (x + y / p) / 2, (y + x * quotient) / 2, (p + quotient) / 2
        is_last = not np.any(abs(m - g) > close_to * m)
        m, g = (m + g) / 2, sqrt(product)
        if is_last:
            return (x * m + y) / (m + p)


_NOME = (48555069, 3567400, 268616, 20910, 1707, 150, 15, 2, 1)
"""Coefficients of the nome over e, a series in e^4 (DLMF 19.5.5)."""


def nome(of: Motions) -> Doubles:
    """Return the nome q = exp(-pi K'/K) (2,4).

    The exponential loses log(1/q) digits.  Small nomes are therefore a series in
    e = (1 - sqrt(k'))/2(1 + sqrt(k')), whose first difference is a quotient of k^2.
    """
    root = np.sqrt(of["k_prime"])
    e = of["m"] / (2 * (1 + of["k_prime"]) * (1 + root) ** 2)
    by_exponential = np.exp(-np.pi * of["K_prime"] / of["K"])
    return np.where(e < 0.2, e * np.polyval(_NOME, e**4), by_exponential)


def tilt_deg(above: Array, below: Array) -> Doubles:
    """Return a tilt in degrees from 1 - u and 1 + u: near the poles acos(u) would lose digits."""
    return np.degrees(2 * np.arctan2(np.sqrt(above), np.sqrt(below)))


def turn_time(rate: Array) -> Doubles:
    """Return the time of one turn at a rate (section 8), NaN if the rate is 0."""
    return 2 * np.pi / np.where(rate == 0, np.nan, abs(rate))


class Motions(dict[str, Any]):
    """The numbers and texts of many tops by key; None if the tops lack one.

    Each is computed once, by a formula that takes the motions.  `known` tells for which tops no
    formula so far has lost digits.  Angles are in degrees or radians.
    """

    def __init__(self, formulas: Formulas, tops: TopArrays, start: Start) -> None:
        """Take some tops with their start in pairs of doubles."""
        super().__init__()
        self.formulas, self.tops = formulas, tops
        self.pairs, self.start = start, start.in_doubles()
        self.known: Mask = np.ones(tops.m.shape, dtype=np.bool_)

    @cached_property
    def gaps(self) -> Gaps:
        """The gaps of the motions, here after release from rest."""
        return gaps_from_rest(self.start)

    def __missing__(self, key: str) -> Any:
        value: Any = None
        if key in self.formulas:
            value = self.formulas[key](self)
        elif (name := degree_name(key)) != key and self[name] is not None:
            value = np.radians(self[name])
        if isinstance(value, DoubleDouble):
            value, size = value.high, abs(value.high)
            self.known &= ~((size > 0) & (size < _LEAST) | (size > _MOST))
        self[key] = value
        return value


Formulas = dict[str, Callable[[Any], Any]]
"""A formula for each key; those that only other formulas use are not keys of the record."""


def alpha(of: Any) -> Doubles:
    """Return alpha = F(amplitude, k') (1,6), by Carlson's integral (DLMF 19.25.5).

    Its sn^2 = (1 - u1)(u3 - u2)/((u3 - u1)(1 - u2)) and cn^2 are products.
    """
    gaps, scale = of.gaps, of.gaps.a_u3_u1 * of.gaps.above_u2
    sn2, cn2 = gaps.above_u1 * gaps.a_u3_u2 / scale, gaps.a_u3_above * gaps.u1_u2 / scale
    return np.sqrt(sn2) * elliprf(cn2, cn2 + of["m"] * sn2, 1.0)


def u_quarter(of: Any) -> Array:
    """Return cos(theta) at T/4 after a start at u1 (5,2), as a difference from u1; else NaN."""
    fall = of.gaps.u1_u2 * (of["k_prime"] / (1 + of["k_prime"]))
    return np.where(of.gaps.u1_u0 <= 0, of.start.cos - fall, np.nan)


_START_TILT: Formulas = {  # with all of its digits in both units
    "theta_min_deg": lambda of: of.tops.tilt_in(radians=False),
    "theta_min_rad": lambda of: of.tops.tilt_in(radians=True),
}
_OF_ALL: Formulas = {
    "a": lambda of: of.start.a,  # (4,4)
    "b": lambda of: of.start.b,  # (4,5)
    "T_spin": lambda of: turn_time(of["mean_spin_rate"]),
    "spin_rate_start": lambda of: of.start.spin_rate,
}
OF_VERTICAL: Formulas = _OF_ALL | {
    **_START_TILT,
    "theta_max_deg": lambda of: of["theta_min_deg"],
    "theta_max_rad": lambda of: of["theta_min_rad"],
    **dict.fromkeys(("u1", "u2"), lambda of: of.start.cos),
    **dict.fromkeys(("mean_spin_rate", "spin_rate_start"), lambda of: of.start.r0),
}
"""Formulas of tops released on the vertical."""
OF_TORQUE_FREE: Formulas = OF_VERTICAL | {
    **dict.fromkeys(("k", "modular_angle_deg", "nome"), lambda _: 0.0),
    "k_prime": lambda _: 1.0,
    **dict.fromkeys(("K", "E"), lambda _: np.pi / 2),
    "T_nutation": lambda of: turn_time(of.start.b),
    **dict.fromkeys(
        ("mean_precession_rate", "precession_rate_start"), lambda of: of.start.psi_rate
    ),
}
"""Formulas of tops released without a torque."""
OF_NUTATION: Formulas = _OF_ALL | {
    "u1": lambda of: of.start.cos + of.gaps.u1_u0,  # (4,9)
    "u2": lambda of: u2(of.gaps),  # (4,9)
    "u3": lambda of: (of.start.a + of.gaps.a_u3_above) / of.start.a,
    "m": lambda of: of.start.a * of.gaps.u1_u2 / of.gaps.a_u3_u2,  # k^2 (4,19)
    "k": lambda of: np.sqrt(of["m"]),
    "mc": lambda of: of.gaps.a_u3_u1 / of.gaps.a_u3_u2,  # k'^2 (4,21); not 1 - m
    "k_prime": lambda of: np.sqrt(of["mc"]),
    "modular_angle_deg": lambda of: np.degrees(np.arctan2(of["k"], of["k_prime"])),
    "nome": nome,
    "K": lambda of: ellipkm1(of["mc"]),
    "K_prime": lambda of: ellipkm1(of["m"]),
    "E": lambda of: ellipe(1 - of["mc"]),  # not of m: near 1, E needs 1 - m
    "T_nutation": lambda of: 4 * of["K"] / np.sqrt(of.gaps.a_u3_u2),  # (5,1)
    "T_precession": lambda of: turn_time(of["mean_precession_rate"]),
    "u_quarter": u_quarter,
    "theta_min_deg": lambda of: tilt_deg(of.gaps.above_u1, of.gaps.below_u1),
    "theta_max_deg": lambda of: tilt_deg(of.gaps.above_u2, of.gaps.below_u2),
    "precession_rate_start": lambda of: of.start.psi_rate,
}
"""Formulas of all nutations."""
OF_PENDULUMS: Formulas = OF_NUTATION | {
    **_START_TILT,
    "k_squared": lambda of: of["m"],
    "comodular_angle_deg": lambda of: np.degrees(np.arctan2(of["k_prime"], of["k"])),
    "amplitude_deg": lambda of: np.degrees(  # (7,2), from its tangent
        np.arctan2(np.sqrt(of.gaps.a_u3_u2), np.sqrt(of.start.a * of.gaps.below_u2))
    ),
    "alpha": alpha,
    "mean_spin_rate": lambda of: (  # (6,3), a drift and a turn, a sum of one sign
        of.start.spin_drift + np.where(of.start.r0 < 0, -np.pi, np.pi) / of["T_nutation"]
    ),
    "mean_precession_rate": lambda of: np.pi / of["T_nutation"],  # a half turn at the bottom
}
"""Formulas of tops released from rest without spin."""
OF_RELEASED: Formulas = OF_PENDULUMS | {
    "mean_precession_rate": lambda of: sum(mean_parts(of["k_prime"], of.gaps)),  # (7,3)
    "half": lambda of: rates_half(of.start, of.gaps),
    "spin_rate_half": lambda of: of["half"][0],
    "precession_rate_half": lambda of: of["half"][1],
}
"""Formulas of tops released from rest with a spin."""
