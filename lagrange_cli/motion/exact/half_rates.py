"""Rates half a period after a start with rates that are exactly 0, decided in fractions.

Half a period on, sn^2 becomes cn^2/dn^2, so that u(T/2) = (u3 (u1 + u2) - u1 u2 - u0 u3)/(u3 - u0).
With x = u3 and the sums and products of the roots of (4,9) this is N(x)/M(x), and a rate (4,7),
(4,8) is 0 where a polynomial P(x) is.  The number of roots of the cubic at which it is 0 follows
from the rank of a matrix of polynomials in cos(theta0), and enclosures exclude the other roots.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from ...arithmetic.ball import TooFewDigitsError
from ...arithmetic.balls import balls
from ...arithmetic.exact_cosine import Polynomial, U
from ...arithmetic.numbers import polynomial
from ...arithmetic.rounding import FIRST_DIGITS, decided
from ..any_start import largest_root
from ..regime import Exact

HALF_RATES = ("spin_rate_half", "precession_rate_half")

InU3 = list[Polynomial]
"""A polynomial in u3, the lowest power first, with polynomials in cos(theta0) as coefficients."""


@lru_cache(maxsize=8)
def vanishing_half_rates(exact: Exact) -> dict[str, Fraction]:
    """Return the rates at T/2 that are 0 for a top with torque that does not start at rest."""
    if exact.facts.free or exact.facts.at_rest or exact.facts.steady or exact.facts.pole:
        return {}
    a, b = exact.a, exact.b
    alpha, beta = exact.energy + a * U, exact.momentum + b * U
    pairs, total = 2 * b * beta - a, exact.energy + b * b
    cubic = [alpha - beta * beta, pairs, -1 * total, Polynomial(a)]
    N = [-1 * pairs, 2 * total - a * U, Polynomial(-2 * a)]
    M = [-a * U, Polynomial(a)]
    momentum = _sum(_product([beta], M), _product([Polynomial(-b)], N))  # M (beta - b u)
    spin = _sum(
        _product([Polynomial(exact.r0)], _sum(_product(M, M), _product([Polynomial(-1)], N, N))),
        _product([Polynomial(-1)], N, momentum),
    )
    found = zip(HALF_RATES, (spin, momentum), strict=True)
    return {key: Fraction(0) for key, P in found if _is_zero_at_u3(exact, P, cubic)}


def _is_zero_at_u3(exact: Exact, P: InU3, cubic: InU3) -> bool:
    """Return whether P is exactly 0 at the greatest root of a cubic that begins with a rational.

    Balls come first: they are cheap, and nearly always prove that it is not.  P is 0 at as many
    roots as the products of P with 1, x and x^2, reduced by the cubic, lack in rank.
    """
    if not _zeros_possible(exact, P, cubic, FIRST_DIGITS)[0]:
        return False
    shared = _shared_roots(exact, [_reduced([Polynomial(0)] * i + P, cubic) for i in range(3)])
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
    c0, c1, c2, a = (exact.cosine.at(ar, x) for x in cubic)
    c0, c1, c2 = c0 / a, c1 / a, c2 / a
    u3 = largest_root(ar, c2, c1, c0, 1 + abs(c0) + abs(c1) + abs(c2))
    total, product = -c2 - u3, -c0 / u3
    spread = ar.sqrt(total * total - 4 * product)
    terms = [exact.cosine.at(ar, x) for x in P]
    values = (polynomial(terms, u) for u in (u3, (total + spread) / 2, (total - spread) / 2))
    return [(abs(value) > 0) is not True for value in values]


def _shared_roots(exact: Exact, rows: list[InU3]) -> int:
    """Return how much the rank of a matrix of three rows is less than three."""
    minors = [
        [p[i] * q[j] - p[j] * q[i] for i, j in ((1, 2), (2, 0), (0, 1))]
        for p, q in ((rows[1], rows[2]), (rows[2], rows[0]), (rows[0], rows[1]))
    ]
    determinant = sum((x * y for x, y in zip(rows[0], minors[0], strict=True)), Polynomial(0))
    if not exact.cosine.vanishes(determinant):
        return 0
    if not all(exact.cosine.vanishes(minor) for row in minors for minor in row):
        return 1
    return 2 if any(not exact.cosine.vanishes(x) for row in rows for x in row) else 3


def _product(*factors: InU3) -> InU3:
    total = [Polynomial(1)]
    for factor in factors:
        longer = [Polynomial(0)] * (len(total) + len(factor) - 1)
        for i, x in enumerate(total):
            for j, y in enumerate(factor):
                longer[i + j] += x * y
        total = longer
    return total


def _sum(p: InU3, q: InU3) -> InU3:
    zero = [Polynomial(0)]
    size = max(len(p), len(q))
    p, q = p + zero * (size - len(p)), q + zero * (size - len(q))
    return [x + y for x, y in zip(p, q, strict=True)]


def _reduced(P: InU3, cubic: InU3) -> InU3:
    """Return the remainder of P by a cubic whose leading coefficient is rational."""
    rest, a = list(P), Fraction(cubic[3].coefficients[0])
    while len(rest) > 3:
        factor = rest.pop() * (1 / a)
        for i in range(3):
            rest[len(rest) - 3 + i] -= factor * cubic[i]
    return rest + [Polynomial(0)] * (3 - len(rest))
