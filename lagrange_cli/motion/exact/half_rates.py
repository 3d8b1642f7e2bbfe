"""Decide in fractions which rates at T/2 are exactly 0, or midway between two roundings.

Half a period on, sn^2 becomes cn^2/dn^2, so that u(T/2) = (u3 (u1 + u2) - u1 u2 - u0 u3)/(u3 - u0).
By the sums and products of the roots of (4,9) this is N(x)/M(x) with x = u3.  Without torque it is
u1 + u2 - u0.  A rate (4,7), (4,8) is 0 if a polynomial P(x) is 0.  The greatest common divisor of P
and the cubic gives the number of common roots, and enclosures exclude the other roots.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import Any, cast

from ...arithmetic.ball import TooFewDigitsError
from ...arithmetic.balls import balls
from ...arithmetic.exact_cosine import Polynomial, U
from ...arithmetic.numbers import polynomial
from ...arithmetic.rounding import FIRST_DIGITS, decided
from ..any_start import largest_root
from ..regime import Exact

HALF_RATES = ("spin_rate_half", "precession_rate_half")

InU3 = Polynomial
"""A polynomial in u3 whose coefficients are polynomials in cos(theta0)."""


@lru_cache(maxsize=8)
def vanishing_half_rates(exact: Exact) -> dict[str, Fraction]:
    """Return the rates at T/2 that are 0 for a nutating top."""
    facts = exact.facts
    if facts.steady or (facts.pole and not facts.free):
        return {}
    zero = Fraction(0)
    return {key: zero for key in HALF_RATES if is_half_rate(exact, key, zero)}


def is_half_rate(exact: Exact, name: str, value: Fraction) -> bool:
    """Return whether a rate at T/2 of a nutating top is exactly a fraction close to it."""
    N, M = _half_cosine(exact)
    momentum = Polynomial(exact.beta) * M + N * -exact.b  # M (beta - b u)
    rate = momentum * M if name == "precession_rate_half" else N * -1 * momentum
    constant = value if name == "precession_rate_half" else value - exact.r0
    return _is_zero_at_u3(exact, rate - (M * M - N * N) * constant)


def _half_cosine(exact: Exact) -> tuple[InU3, InU3]:
    """Return N and M for u(T/2) = N(u3)/M(u3); they are constants without torque."""
    a, (pairs, total) = exact.a, _sums(exact)
    if exact.facts.free:
        return Polynomial(pairs - U * total), Polynomial(total)
    N = Polynomial(-1 * pairs, 2 * total - a * U, Polynomial(-2 * a))
    return N, Polynomial(-a * U, Polynomial(a))


def _sums(exact: Exact) -> tuple[Polynomial, Polynomial]:
    """Return a times the sums of products of two roots, and of the roots."""
    return 2 * exact.b * exact.beta - exact.a, exact.alpha + exact.b * exact.b


def _is_zero_at_u3(exact: Exact, P: InU3) -> bool:
    """Return whether P is exactly 0 at the greatest root of the cubic.

    Balls are tried first: they are cheap, and nearly always prove that P is not 0.
    """
    if exact.facts.free:
        return exact.cosine.vanishes(P.coefficients[0])
    pairs, total = _sums(exact)
    product = exact.alpha - exact.beta * exact.beta
    cubic = Polynomial(product, pairs, -1 * total, Polynomial(exact.a))
    if not _zeros_possible(exact, P, cubic, FIRST_DIGITS)[0]:
        return False
    shared = _shared_roots(exact, cubic, P)
    if not shared:
        return False

    def at_u3(digits: int) -> bool:
        possible = _zeros_possible(exact, P, cubic, digits)
        if sum(possible) > shared:
            raise TooFewDigitsError
        return possible[0]

    return decided("a rate at T/2", at_u3)


def _zeros_possible(exact: Exact, P: InU3, cubic: InU3, digits: int) -> list[bool]:
    """Return whether P may be 0 at u3, and at the other two roots of the cubic."""
    ar = balls(digits)
    terms, (c0, c1, c2, a) = (
        [exact.cosine.at(ar, cast(Any, x)) for x in p.coefficients] for p in (P, cubic)
    )
    c0, c1, c2 = c0 / a, c1 / a, c2 / a
    u3 = largest_root(ar, c2, c1, c0, 1 + abs(c0) + abs(c1) + abs(c2))
    total, product = -c2 - u3, -c0 / u3
    spread = ar.sqrt(total * total - 4 * product)
    values = (polynomial(terms, u) for u in (u3, (total + spread) / 2, (total - spread) / 2))
    return [(abs(value) > 0) is not True for value in values]


def _shared_roots(exact: Exact, *polynomials: InU3) -> int:
    """Return the number of common roots: the degree of the greatest common divisor.

    Euclid's algorithm finds the divisor without dividing coefficients.
    """
    p, q = (_trimmed(exact, list(x.coefficients)) for x in polynomials)
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
