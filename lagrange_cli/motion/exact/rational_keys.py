"""Keys with rational values, rounded from the fraction if enclosures cannot decide.

A computed 0 may be a number too small for the digits.  An enclosure of a number midway between two
doubles cannot be rounded at any precision.  This module decides from the inputs which keys are
exactly 0, or may be such a tie.

Half a period on, sn^2 becomes cn^2/dn^2, so that u(T/2) = (u3 (u1 + u2) - u1 u2 - u0 u3)/(u3 - u0).
By the sums and products of the roots of (4,9) this is N(x)/M(x) with x = u3.  Without torque it is
u1 + u2 - u0.  A rate (4,7), (4,8) has a given value if a polynomial P(x) is 0.  The greatest common
divisor of P and the cubic gives the number of common roots, and enclosures exclude the other roots.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any, cast

from ...arithmetic.ball import Ball, TooFewDigitsError
from ...arithmetic.balls import balls
from ...arithmetic.exact_cosine import Polynomial, U
from ...arithmetic.numbers import polynomial
from ...arithmetic.rounding import FIRST_DIGITS, decided
from ...inputs.stand_ins import rational_root
from ..any_start import largest_root
from ..regime import Exact

_RATE_OF = {"T_spin": "mean_spin_rate", "T_precession": "mean_precession_rate"}
"""The mean rate of each period."""
_SPINS = ("mean_spin_rate", "spin_rate_start")
_ROOTS = ("u1", "u2", "u3")

InU3 = Polynomial
"""A polynomial in u3 whose coefficients are polynomials in cos(theta0)."""


def known_fraction(exact: Exact, name: str, *, radians: bool = False) -> Fraction | None:
    """Return a number of the record of a motion if it is known as a fraction, else None.

    An angle is in degrees or `radians`.  `fraction_in` finds fractions among roots and rates at
    T/2.
    """
    known = rational_keys(exact).get(name)
    if not radians or known == 0:
        return known
    at = {"theta_min_deg": starts_at_u1, "theta_max_deg": starts_at_u2}.get(name)
    return exact.cosine.radians if at is not None and at(exact) else None


def is_endless(exact: Exact, name: str) -> bool:
    """Return whether a key is the period of a mean rate that is exactly 0."""
    return name in _RATE_OF and known_fraction(exact, _RATE_OF[name]) == 0


@lru_cache(maxsize=8)
def rational_keys(exact: Exact) -> dict[str, Fraction]:
    """Return the keys of a record that follow from the inputs as fractions, many of them zeros."""
    facts, r0, b, psi_rate = exact.facts, exact.r0, exact.b, exact.psi_rate
    keys: dict[str, Fraction | None] = {"a": exact.a, "b": b, **_tilts(exact)}
    if psi_rate is None:
        # without torque this is the fast rate, with psi' cos(theta0) = b
        return _known(keys | dict.fromkeys(_SPINS, r0 - b if facts.free else None))
    spin = exact.cosine.fraction(r0 - (0 if facts.pole else psi_rate) * U)
    if facts.steady or not facts.pole:  # on the vertical neither rate is defined
        keys |= {"precession_rate_start": psi_rate, "spin_rate_start": spin}
    if facts.steady:
        return _known(keys | {"mean_precession_rate": psi_rate, "mean_spin_rate": spin})
    if facts.free or (facts.upper_root == 1 and facts.over_bottom):  # half turns about both poles
        # without torque the rate of one turn is the angular momentum over A
        square = exact.cosine.fraction(exact.energy + b * b) if facts.free else None
        turn = None if square is None else rational_root(square)
        means = {"mean_precession_rate": (Fraction(0), 1), "mean_spin_rate": (r0 - b, -1)}
        for name, (rate, sign) in means.items():
            turns = (facts.sign_plus + sign * facts.sign_minus) // 2
            around = None if turn is None else rate + turns * turn
            keys[name] = around if turns else rate
    if facts.drifts:
        keys["mean_spin_rate"] = r0 - b / 2
    if facts.falls and facts.spins and not facts.free:
        keys["precession_rate_half"] = exact.a / b
    if starts_at_u1(exact) and _quarter_is_level(exact):
        keys["u_quarter"] = Fraction(0)
    return _known(keys)


def _known(keys: dict[str, Fraction | None]) -> dict[str, Fraction]:
    """Return the keys that have a value."""
    return {name: value for name, value in keys.items() if value is not None}


def _tilts(exact: Exact) -> dict[str, Fraction]:
    """Return the angles of a record that follow from a start on a turning point.

    Without torque and spin the axis moves round a great circle, and the other turning point is
    opposite.
    """
    facts, tilt = exact.facts, exact.cosine.degrees
    if tilt is None:
        return {}
    keys: dict[str, Fraction] = {}
    ends = ("theta_min_deg", starts_at_u1(exact)), ("theta_max_deg", starts_at_u2(exact))
    for (name, here), (other, _) in (ends, ends[::-1]):
        if here and facts.free and not facts.spins and not facts.steady:
            keys[other] = 180 - tilt
        if here:
            keys[name] = tilt
    if facts.at_rest and facts.regime == "no spin":
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


def cubic(exact: Exact) -> tuple[Polynomial, Polynomial, Polynomial, Polynomial]:
    """Return the coefficients of the cubic (4,9) in u, the constant first."""
    alpha, beta, b = exact.alpha, exact.beta, exact.b
    return alpha - beta * beta, 2 * b * beta - exact.a, -1 * alpha - b * b, Polynomial(exact.a)


def keys_by_u1(exact: Exact, u1: Polynomial) -> dict[str, Polynomial]:
    """Return the slope at u1, a u2 u3 and (a (u3 - u2))^2, from the sums of the other roots."""
    _, pairs, c2, a = cubic(exact)
    along, product = 2 * a * u1 + c2, (a * u1 + c2) * u1 + pairs
    others = along - a * u1
    return {
        "f_slope_u1": along * u1 + product,
        "u2_criterion": product,
        "discriminant": others * others - 4 * a * product,
    }


def _quarter_is_level(exact: Exact) -> bool:
    """Return whether u(T/4) = 0 (5,2), for a start at u1 = u0.

    Then k' = -u1/u2, which is u0 (u3 - u2) = -u2 u3.  Its square is a polynomial in u0.  Without
    torque u(T/4) is the mean of u1 and u2, which is proportional to beta b.
    """
    cosine = exact.cosine
    if exact.facts.free:
        return cosine.vanishes(exact.b * exact.beta)
    _, product, square = keys_by_u1(exact, U).values()
    level = U * U * square - product * product
    return cosine.vanishes(level) and cosine.sign(U) > 0 and cosine.sign(product) < 0


def fraction_in(
    exact: Exact, name: str, enclosure: Callable[[str], Ball | None]
) -> Fraction | None:
    """Return a root of (4,9), a u2 u3 (4,12) or a rate at T/2 if it is a fraction, such as a tie.

    The enclosure of a root must contain no other root of its cubic.  Any fraction in it that is a
    root is then this one.
    """
    at_half = name.endswith("_half") and not exact.facts.steady
    if exact.psi_rate is None or not (at_half or name in {*_ROOTS, "u2_criterion"}):
        return None
    ball = enclosure(name)
    if ball is None:
        return None
    low, high = ball.ends()
    value = _simplest_between(Fraction(low), Fraction(high))
    if at_half:
        return value if _is_half_rate(exact, name, value) else None
    equation = cubic(exact)
    others = [enclosure(other) for other in _ROOTS if other != name]
    if name == "u2_criterion":  # with a u1 u3 and a u1 u2, a root of another cubic
        c0, c1, c2, a = equation
        equation = -1 * a * c0 * c0, c0 * c2, -1 * c1, Polynomial(1)
        a_ball, u1, u2, u3 = (enclosure(x) for x in ("a", *_ROOTS))
        if a_ball is None or u1 is None or u2 is None or u3 is None:
            return None
        others = [a_ball * u1 * u3, a_ball * u1 * u2]
    if any(other is not None and (ball - other).least == 0 for other in others):
        return None
    return value if exact.cosine.vanishes(polynomial(equation, value)) else None


def _simplest_between(low: Fraction, high: Fraction) -> Fraction:
    """Return the fraction with the smallest denominator in an interval."""
    if high < 0:
        return -_simplest_between(-high, -low)
    whole = Fraction(max(math.ceil(low), 0))
    if whole <= high:
        return whole
    return whole - 1 + 1 / _simplest_between(1 / (high - whole + 1), 1 / (low - whole + 1))


def _is_half_rate(exact: Exact, name: str, value: Fraction) -> bool:
    """Return whether a rate at T/2 of a nutating top is exactly a fraction close to it."""
    N, M = _half_cosine(exact)
    momentum = Polynomial(exact.beta) * M + N * -exact.b  # M (beta - b u)
    rate = momentum * M if name == "precession_rate_half" else N * -1 * momentum
    constant = value if name == "precession_rate_half" else value - exact.r0
    digits = 2 * FIRST_DIGITS + value.denominator.bit_length()
    return _is_zero_at_u3(exact, rate - (M * M - N * N) * constant, digits)


def _half_cosine(exact: Exact) -> tuple[InU3, InU3]:
    """Return N and M for u(T/2) = N(u3)/M(u3); they are constants without torque."""
    a, (_, pairs, c2, _) = exact.a, cubic(exact)
    if exact.facts.free:
        return Polynomial(pairs + U * c2), Polynomial(-1 * c2)
    N = Polynomial(-1 * pairs, -2 * c2 - a * U, Polynomial(-2 * a))
    return N, Polynomial(-a * U, Polynomial(a))


def _is_zero_at_u3(exact: Exact, P: InU3, digits: int) -> bool:
    """Return whether P is exactly 0 at the greatest root of the cubic.

    Balls of `digits` digits are tried first: they are cheap, and nearly always prove that P is not
    0.
    """
    if exact.facts.free:
        return exact.cosine.vanishes(P.coefficients[0])
    if not _zeros_possible(exact, P, digits)[0]:
        return False
    shared = _shared_roots(exact, cubic(exact), P.coefficients)
    if not shared:
        return False

    def at_u3(digits: int) -> bool:
        possible = _zeros_possible(exact, P, digits)
        if sum(possible) > shared:
            raise TooFewDigitsError
        return possible[0]

    return decided("a rate at T/2", at_u3)


def _zeros_possible(exact: Exact, P: InU3, digits: int) -> list[bool]:
    """Return whether P may be 0 at u3, and at the other two roots of the cubic."""
    ar = balls(digits)
    terms, (c0, c1, c2, a) = (
        [exact.cosine.at(ar, cast(Any, x)) for x in p] for p in (P.coefficients, cubic(exact))
    )
    c0, c1, c2 = c0 / a, c1 / a, c2 / a
    u3 = largest_root(ar, c2, c1, c0, 1 + abs(c0) + abs(c1) + abs(c2))
    total, product = -c2 - u3, -c0 / u3
    spread = ar.sqrt(total * total - 4 * product)
    values = (polynomial(terms, u) for u in (u3, (total + spread) / 2, (total - spread) / 2))
    return [(abs(value) > 0) is not True for value in values]


def _shared_roots(exact: Exact, *polynomials: Sequence[Polynomial]) -> int:
    """Return the number of common roots: the degree of the greatest common divisor.

    Euclid's algorithm finds the divisor without dividing coefficients.
    """
    p, q = (_trimmed(exact, list(x)) for x in polynomials)
    while q:
        while len(p) >= len(q):
            shifted = [Polynomial(0)] * (len(p) - len(q)) + q
            p = [q[-1] * x - p[-1] * y for x, y in zip(p, shifted, strict=True)][:-1]
            p = _trimmed(exact, p)
        p, q = q, p
    return len(p) - 1


def _trimmed(exact: Exact, coefficients: list[Any]) -> list[Any]:
    """Return coefficients without leading zeros."""
    while coefficients and exact.cosine.vanishes(coefficients[-1]):
        coefficients.pop()
    return coefficients
