"""Numbers that are formulas of the inputs, for many tops at once, in pairs of doubles.

They are further keys, which `solver` declares with their meanings, and the numbers of steady tops.
Where the terms of a formula cancel, `solve` computes the top.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

import numpy as np

from ..arithmetic.pairs import PI, DoubleDouble, two_sum
from ..arithmetic.types import Array
from .formulas import OF_TORQUE_FREE, Formulas, Motions, turn_time
from .tops import Doubles
from .trust import GOOD, PAIR_EPS

_LEAST_SQUARE = 2.0**-20
"""Ratio of the discriminant to b^2 from which a steady rate is known well."""
_TURN = DoubleDouble(np.array([2 * PI.high]), np.array([2 * PI.low]))


def total(of: Motions, *terms: Doubles, error: Array | float = 0.0) -> Doubles:
    """Return a sum; the tops for which it loses digits are no longer known.

    `error` is an absolute error of the terms, in units of PAIR_EPS.
    """
    size: Array = sum(abs(term.high) for term in terms) + error
    found: Doubles = sum(terms[1:], terms[0])
    of.known &= PAIR_EPS * size <= GOOD * abs(found.high)
    return found


def momentum(of: Motions) -> Doubles:
    """Return beta = psi' sin^2 theta0 + b cos theta0 (4,5)."""
    return total(of, of.pairs.momentum, of.pairs.b * of.pairs.cos, error=abs(of.pairs.b.high))


def energy(of: Motions) -> Doubles:
    """Return alpha = theta'^2 + psi'^2 sin^2 theta0 + a cos theta0 (4,4)."""
    return total(of, of.pairs.energy, of.pairs.a * of.pairs.cos, error=of.pairs.a.high)


def at_pole(of: Motions, b_from_pole: Doubles) -> Doubles:
    """Return f(1) = -(beta - b)^2 or f(-1) = -(beta + b)^2 of (4,9), from b (u0 -+ 1)."""
    root = total(of, of.pairs.momentum, b_from_pole)
    return -root * root


def discriminant(of: Motions) -> Doubles:
    """Return b^2 - 2 a cos theta0, negative if there is no steady precession."""
    a, b, cos = of.pairs.a, of.pairs.b, total(of, of.pairs.cos, error=1.0)
    found = total(of, b * b, -2.0 * a * cos, error=a.high)
    of.known &= found.high != 0
    return found


def steady(of: Motions) -> Doubles:
    """Return q = b +- sqrt(b^2 - 2 a cos theta0), of the sign of b; NaN if there is none."""
    both = abs(of.pairs.b) + discriminant(of).sqrt()
    return DoubleDouble.choose(of.pairs.b.high < 0, -both, both)


def spin_of(of: Motions, square: Doubles) -> Doubles:
    """Return the r0 for which b^2 is `square`, 0 if that is negative."""
    root = DoubleDouble.choose(square.high > 0, square, 0.0).sqrt()
    return DoubleDouble(of.tops.A) / DoubleDouble(of.tops.C) * root


ELEMENTARY: Formulas = {
    "stability_factor": lambda of: of.pairs.b * of.pairs.b / (2.0 * of.pairs.a),
    "r0_sleeping": lambda of: spin_of(of, 2.0 * of.pairs.a),
    "r0_steady_min": lambda of: spin_of(of, 2.0 * of.pairs.a * total(of, of.pairs.cos, error=1.0)),
    "steady_rate_slow": lambda of: of.pairs.a / steady(of),
    "steady_rate_fast": lambda of: steady(of) / (2.0 * of.pairs.cos),
    "precession_rate_elementary": lambda of: of.pairs.a / (2.0 * of.pairs.b),
    "T_nutation_elementary": lambda of: _TURN / abs(of.pairs.b),
    "energy_without_spin": lambda of: DoubleDouble(of.tops.A) * energy(of) / 2.0,
    "energy_constant": energy,
    "Lz": lambda of: DoubleDouble(of.tops.A) * momentum(of),
    "momentum_constant": momentum,
    "f_upright": lambda of: at_pole(of, -of.pairs.b * of.pairs.above),
    "f_hanging": lambda of: at_pole(of, of.pairs.b * of.pairs.below),
    "spin_share": lambda of: (
        DoubleDouble(*two_sum(2 * of.tops.A, -of.tops.C)) / (2.0 * DoubleDouble(of.tops.A))
    ),
}
"""The formula of each key; a number is NaN where its divisor is 0."""


def steady_motion(of: Motions) -> tuple[Doubles, Doubles, Doubles]:
    """Return the rate of the steady precession that a word names, a (u3 - u0) and the spin rate.

    The cubic (4,9) has a double root u0, and a (u3 - u0) is a sum: psi'^2 sin^2 plus the
    discriminant b^2 - 2 a u0.  If this is at least 2^-20 of b^2, the rate is good to 2^-80.
    """
    start, square = of.pairs, discriminant(of)
    slow, fast = (ELEMENTARY[f"steady_rate_{word}"](of) for word in ("slow", "fast"))
    rate = DoubleDouble.choose(of.tops.steady == 1, slow, fast)
    around, along = rate * start.sin, rate * start.cos
    spin = total(of, start.r0, -along, error=abs(along.high) / _LEAST_SQUARE)
    of.known &= square.high > _LEAST_SQUARE * start.b.high**2
    return rate, around * around + square, spin


OF_STEADY: Formulas = OF_TORQUE_FREE | {
    "steady": steady_motion,
    **dict.fromkeys(
        ("psidot0", "mean_precession_rate", "precession_rate_start"), lambda of: of["steady"][0]
    ),
    **dict.fromkeys(("mean_spin_rate", "spin_rate_start"), lambda of: of["steady"][2]),
    "u3": lambda of: of.pairs.cos + of["steady"][1] / of.pairs.a,
    "T_nutation": lambda of: turn_time(np.sqrt(of["steady"][1].high)),
    "T_precession": lambda of: turn_time(of["mean_precession_rate"]),
}
"""Formulas of tops whose tilt is kept by a rate of steady precession that a word names."""
