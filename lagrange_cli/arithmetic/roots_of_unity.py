"""Polynomials in a cosine of k/n turns, as polynomials P((z + 1/z)/2) in a root of unity z."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction


def _powers(coefficients: Sequence[Fraction], n: int) -> list[Fraction]:
    """Return the coefficients of P((z + 1/z)/2) modulo z^n - 1."""
    cyclic = [Fraction(0)] * n
    for degree, coefficient in enumerate(coefficients):
        for i in range(degree + 1):
            cyclic[(degree - 2 * i) % n] += coefficient * Fraction(math.comb(degree, i), 2**degree)
    return cyclic


def mean_at_roots_of_unity(coefficients: Sequence[Fraction], n: int) -> Fraction:
    """Return the mean of P((z + 1/z)/2) over the primitive n-th roots of unity z.

    The sum of a power of these roots is an integer (Ramanujan's sum).
    """
    primitive = [j for j in range(n) if math.gcd(j, n) == 1]
    total = Fraction(0)
    for i, coefficient in enumerate(_powers(coefficients, n)):
        if coefficient:
            total += coefficient * round(sum(math.cos(math.tau * i * j / n) for j in primitive))
    return total / len(primitive)


def vanishes_at_root_of_unity(coefficients: Sequence[Fraction], n: int) -> bool:
    """Return whether P((z + 1/z)/2) is 0 for a primitive n-th root of unity z.

    For the primes p that divide n, the factors z^(n/p) - 1 vanish at all n-th roots of unity except
    the primitive ones.
    """
    cyclic = _powers(coefficients, n)
    for p in range(2, n + 1):
        if n % p == 0 and all(p % q for q in range(2, p)):
            cyclic = [cyclic[i - n // p] - x for i, x in enumerate(cyclic)]
    return not any(cyclic)
