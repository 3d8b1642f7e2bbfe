"""Rates half a period after a start with rates that are exactly 0, decided in fractions.

Half a period on, sn^2 becomes cn^2/dn^2, so that u(T/2) = (u3 (u1 + u2) - u1 u2 - u0 u3)/(u3 - u0).
With x = u3 and the sums and products of the roots of (4,9) this is N(x)/M(x), and a rate (4,7),
(4,8) is 0 where a polynomial P(x) is.  It is 0 at some root of the cubic just if the product of its
values at all three is 0, which is a polynomial in cos(theta0); digits tell first whether it may be
0 at u3.
"""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from functools import lru_cache

from ..arithmetic.decimals import Decimals, decimals
from ..arithmetic.exact_cosine import Polynomial, U, value_at
from .gaps import largest_root
from .regime import Exact

HALF_RATES = ("spin_rate_half", "precession_rate_half")
_DIGITS, _ZERO = 80, Decimal("1e-60")

InU3 = list[Polynomial]
"""A polynomial in u3, the lowest power first, with polynomials in cos(theta0) as coefficients."""


@lru_cache(maxsize=8)
def vanishing_half_rates(exact: Exact) -> dict[str, Fraction]:
    """Return the rates at T/2 that are 0 for a top with torque that does not start at rest."""
    if exact.facts.free or exact.facts.at_rest or exact.facts.steady or exact.facts.pole:
        return {}
    a, b, psi, sin2 = exact.a, exact.b, exact.psi_rate, 1 - U * U
    beta = psi * sin2 + b * U
    energy = exact.theta_rate**2 + psi * psi * sin2 + b * b
    pairs = 2 * b * beta - a
    cubic = [energy - b * b + a * U - beta * beta, pairs, -1 * energy, Polynomial(a)]
    N = [-1 * pairs, 2 * energy - a * U, Polynomial(-2 * a)]
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

    Digits come first: they are cheap, and nearly always see that it is not.
    """
    ar = decimals(_DIGITS)
    with ar.working():
        values, terms = (_in_digits(exact, ar, y) for y in (cubic, P))
        c0, c1, c2, one = (c / values[3] for c in values)
        root = largest_root(ar, c2, c1, c0, 1 + max(map(abs, (c0, c1, c2, one))))
        size = sum(abs(c) * abs(root) ** i for i, c in enumerate(terms))
        if abs(value_at(terms, root)) > _ZERO * size:
            return False
    (p, q, r), (s, t, u), (v, w, x) = (
        _reduced([Polynomial(0)] * shift + P, cubic) for shift in range(3)
    )
    return exact.cosine.vanishes(p * (t * x - u * w) - q * (s * x - u * v) + r * (s * w - t * v))


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


def _in_digits(exact: Exact, ar: Decimals, P: InU3) -> list[Decimal]:
    cosine = exact.cosine.value(ar)
    return [value_at([ar.convert(Fraction(x)) for x in y.coefficients], cosine) for y in P]
