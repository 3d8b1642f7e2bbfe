"""Keys with rational values, rounded from the fraction if enclosures cannot decide.

A computed 0 may be a number too small for the digits.  An enclosure of a number midway between two
doubles cannot be rounded at any precision.  This module decides from the inputs which keys are
exactly 0, or may be such a tie.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import lru_cache

from ...arithmetic.ball import Ball
from ...arithmetic.exact_cosine import Polynomial, U
from ..regime import Exact
from .half_rates import HALF_RATES, is_half_rate, vanishing_half_rates

_RATE_OF = {"T_spin": "mean_spin_rate", "T_precession": "mean_precession_rate"}
"""The mean rate of each period."""


def known_fraction(exact: Exact, name: str, *, radians: bool = False) -> Fraction | None:
    """Return a number of the record of a motion if it is known as a fraction, else None.

    An angle is in degrees or `radians`.
    """
    keys = rational_keys(exact)
    if name in HALF_RATES and name not in keys and not _half_over_pole(exact):
        keys = keys | vanishing_half_rates(exact)
    known = keys.get(name)
    if not radians or known == 0:
        return known
    at = {"theta_min_deg": starts_at_u1, "theta_max_deg": starts_at_u2}.get(name)
    return exact.cosine.radians if at is not None and at(exact) else None


def is_endless(exact: Exact, name: str) -> bool:
    """Return whether a key is the period of a mean rate that is exactly 0."""
    return name in _RATE_OF and known_fraction(exact, _RATE_OF[name]) == 0


@lru_cache(maxsize=8)
def rational_keys(exact: Exact) -> dict[str, Fraction]:
    """Return the keys of a record that are known as fractions, mostly zeros.

    `half_rates` decides the zeros of the rates at T/2 after a start with rates, which takes longer.
    """
    keys = {"a": exact.a, "b": exact.b}
    facts = exact.facts
    keys |= _tilt_keys(exact)
    if exact.psi_rate is None:
        # without torque this is the fast rate, with psi' cos(theta0) = b
        rates = dict.fromkeys(("mean_spin_rate", "spin_rate_start"), exact.r0 - exact.b)
        return keys | (rates if facts.free else {})
    spin = exact.cosine.fraction(exact.r0 - (0 if facts.pole else exact.psi_rate) * U)
    if facts.steady or not facts.pole:  # on the vertical neither rate is defined
        keys["precession_rate_start"] = exact.psi_rate
        keys |= {} if spin is None else {"spin_rate_start": spin}
    if facts.steady:
        keys["mean_precession_rate"] = exact.psi_rate
        return keys | ({} if spin is None else {"mean_spin_rate": spin})
    if facts.free or (facts.upper_root == 1 and facts.over_bottom):  # half turns about both poles
        turn = _turn_rate(exact) if facts.free else None
        if facts.sign_plus == facts.sign_minus:
            keys["mean_spin_rate"] = exact.r0 - exact.b
            keys |= {} if turn is None else {"mean_precession_rate": facts.sign_plus * turn}
        else:
            keys["mean_precession_rate"] = Fraction(0)
            drift = exact.r0 - exact.b
            keys |= {} if turn is None else {"mean_spin_rate": drift + facts.sign_plus * turn}
    if facts.drifts:
        keys["mean_spin_rate"] = exact.r0 - exact.b / 2
    return keys | _zeros_of_roots(exact) | _half_rates(exact)


def _turn_rate(exact: Exact) -> Fraction | None:
    """Return the size of the angular momentum over A of a torque-free top, if it is a fraction."""
    square = exact.cosine.fraction(exact.energy + exact.b * exact.b)
    if square is None:
        return None
    rate = Fraction(math.isqrt(square.numerator), math.isqrt(square.denominator))
    return rate if rate * rate == square else None


def _tilt_keys(exact: Exact) -> dict[str, Fraction]:
    """Return the keys that follow from a start on a turning point: its tilt and perhaps its cosine.

    Without torque and spin the axis moves round a great circle, and the other turning point is
    opposite.
    """
    facts, cosine, tilt = exact.facts, exact.cosine.rational, exact.cosine.degrees
    opposite = facts.free and not facts.spins and not facts.steady
    keys: dict[str, Fraction] = {}
    ends = (
        ("u1", "theta_min_deg", starts_at_u1(exact)),
        ("u2", "theta_max_deg", starts_at_u2(exact)),
    )
    for (u, theta, here), (other_u, other_theta, _) in (ends, ends[::-1]):
        if here and cosine is not None:
            keys |= {u: cosine} | ({other_u: -cosine} if opposite else {})
        if here and tilt is not None:
            keys |= {theta: tilt} | ({other_theta: 180 - tilt} if opposite else {})
    if facts.at_rest and facts.regime == "no spin" and tilt is not None:
        keys["modular_angle_deg"] = 90 - tilt / 2
    return keys


def starts_at_u1(exact: Exact) -> bool:
    """Return whether the start is the upper turning point."""
    return _starts_at(exact, 1)


def starts_at_u2(exact: Exact) -> bool:
    """Return whether the start is the lower turning point."""
    return _starts_at(exact, -1)


def _starts_at(exact: Exact, side: int) -> bool:
    facts = exact.facts
    if facts.pole:
        return facts.pole == side
    return facts.steady or (not exact.theta_rate and exact.cosine.sign(exact.fall) == -side)


def rational_u(exact: Exact, name: str, enclosure: Callable[[str], Ball | None]) -> Fraction | None:
    """Return a root of the cubic (4,9) if it is a fraction, such as a tie between doubles.

    The enclosure contains only this root, so that any fraction in it that is a root is this one.
    """
    if exact.psi_rate is None:
        return None
    roots = {root: enclosure(root) for root in ("u1", "u2", "u3")}

    def cubic(u: Fraction) -> Polynomial:
        around = exact.beta - exact.b * u
        return (1 - u * u) * (exact.alpha - exact.a * u) - around * around

    return _rational_root(exact, cubic, roots.pop(name), roots.values())


def rational_criterion(exact: Exact, enclosure: Callable[[str], Ball | None]) -> Fraction | None:
    """Return a u2 u3, the criterion of (4,12), if it is a fraction, such as a tie.

    With it, a u1 u3 and a u1 u2 are the roots of a cubic, whose coefficients follow from (4,9).
    """
    if exact.psi_rate is None:
        return None
    a, u1, u2, u3 = (enclosure(key) for key in ("a", "u1", "u2", "u3"))
    if a is None or u1 is None or u2 is None or u3 is None:
        return None
    square, pairs = exact.alpha + exact.b * exact.b, 2 * exact.b * exact.beta - exact.a
    level = exact.alpha - exact.beta * exact.beta

    def cubic(w: Fraction) -> Polynomial:
        return ((w - pairs) * w - level * square) * w - exact.a * level * level

    others = (a * u1 * u3, a * u1 * u2)
    return _rational_root(exact, cubic, enclosure("u2_criterion"), others)


def _rational_root(
    exact: Exact,
    equation: Callable[[Fraction], Polynomial],
    ball: Ball | None,
    others: Iterable[Ball | None],
) -> Fraction | None:
    """Return the root of an equation in a ball if it is a fraction and apart from the others."""
    if ball is None or any(other is not None and (ball - other).least == 0 for other in others):
        return None
    value = _simplest(ball)
    return value if exact.cosine.vanishes(equation(value)) else None


def rational_half_rate(exact: Exact, name: str, ball: Ball | None) -> Fraction | None:
    """Return a rate at T/2 in an enclosure if it is a fraction, such as a tie between doubles."""
    if ball is None or exact.facts.steady:
        return None
    value = _simplest(ball)
    return value if is_half_rate(exact, name, value) else None


def _simplest(ball: Ball) -> Fraction:
    """Return the fraction with the smallest denominator in a ball."""
    low, high = ball.ends()
    return _simplest_between(Fraction(low), Fraction(high))


def _simplest_between(low: Fraction, high: Fraction) -> Fraction:
    if high < 0:
        return -_simplest_between(-high, -low)
    whole = Fraction(max(math.ceil(low), 0))
    if whole <= high:
        return whole
    return whole - 1 + 1 / _simplest_between(1 / (high - whole + 1), 1 / (low - whole + 1))


def _zeros_of_roots(exact: Exact) -> dict[str, Fraction]:
    """Return u1 = 0 or u2 = 0 if f(0) = alpha - beta^2 (4,9) is 0, and u(T/4) = 0 if it holds."""
    keys: dict[str, Fraction] = {}
    if exact.cosine.vanishes(exact.alpha - exact.beta * exact.beta):
        sign = exact.cosine.sign(U)
        if sign:
            keys["u2" if sign > 0 else "u1"] = Fraction(0)
        else:  # the start is horizontal, and at u1 or u2
            keys["u1" if starts_at_u1(exact) else "u2"] = Fraction(0)
    if starts_at_u1(exact) and _quarter_is_level(exact):
        keys["u_quarter"] = Fraction(0)
    return keys


def _quarter_is_level(exact: Exact) -> bool:
    """Return whether u(T/4) = 0 (5,2), for a start at u1 = u0.

    Then k' = -u1/u2, which is u0 (u3 - u2) = -u2 u3.  By x2 + x3 = -c2/a and x2 x3 = c1/a, its
    square is a polynomial in u0.  Without torque u(T/4) is the mean of u1 and u2, which is
    proportional to beta b.
    """
    a, b, energy, momentum = exact.a, exact.b, exact.energy, exact.momentum
    if exact.facts.free:
        return exact.cosine.vanishes(b * exact.beta)
    c2 = 2 * a * U - energy - b * b
    c1 = 2 * b * momentum - a * (1 - U * U) - 2 * (U * energy)
    product = a * (U * U) - U * c2 + c1  # a u2 u3
    level = (U * U) * (c2 * c2 - 4 * a * c1) - product * product
    return (
        exact.cosine.vanishes(level) and exact.cosine.sign(U) > 0 and exact.cosine.sign(product) < 0
    )


def _half_over_pole(exact: Exact) -> bool:
    """Return whether the axis is on a pole at T/2, where no rate is defined."""
    below = exact.facts.over_bottom and starts_at_u1(exact)
    return below or (exact.facts.upper_root == 1 and starts_at_u2(exact))


def _half_rates(exact: Exact) -> dict[str, Fraction]:
    """Return the rates at T/2 that are known as fractions."""
    facts = exact.facts
    if _half_over_pole(exact):
        return {}
    if facts.plane:
        return {"precession_rate_half": Fraction(0), "spin_rate_half": exact.r0}
    if facts.cusp and starts_at_u2(exact):
        return {"precession_rate_half": Fraction(0)}
    falls = facts.at_rest and facts.spins and not facts.free
    return {"precession_rate_half": exact.a / exact.b} if falls else {}
