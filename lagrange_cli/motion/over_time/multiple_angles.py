"""Sines and cosines of multiples of x as polynomials in s = sin^2 x, with factors S and C.

S is sin x and C is cos x: cos 2nx is such a polynomial, cos(2n+1)x is C times one, sin(2n+1)x is S
times one, and sin 2nx is S C times one.  One recurrence gives all four families; sinh and cosh are
the same with s -> -sinh^2.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from ...arithmetic.protocol import Value

Coefficients = list[Any]
"""Coefficients in s, the lowest power first."""

Family = tuple[tuple[int, ...], tuple[int, ...]]
"""The first two of a family of polynomials in s, which give the others."""
COS_ODD, SIN_ODD = ((1,), (1, -4)), ((1,), (3, -4))
COS_EVEN, SIN_EVEN = ((1,), (1, -2)), ((0,), (2,))


def summed(family: Family, curvature: int, unit: Value, weights: list[Value]) -> Coefficients:
    """Return a weighted sum of the polynomials of a family, times a unit.

    The curvature is 1 for sines and cosines, -1 for hyperbolic ones.
    """
    total: Coefficients = [0 * unit] * len(weights)
    for weight, coefficients in zip(weights, _polynomials(family, len(weights)), strict=True):
        for i, coefficient in enumerate(coefficients):
            total[i] += weight * coefficient
    return [unit * x if i % 2 == 0 else curvature * unit * x for i, x in enumerate(total)]


@lru_cache(maxsize=64)
def _polynomials(family: Family, count: int) -> list[list[int]]:
    """Return the first polynomials in s of a family, P(n+1) = (2 - 4 s) P(n) - P(n-1)."""
    found = [list(polynomial) for polynomial in family]
    while len(found) < count:
        found.append(_next(*found[-2:]))
    return found[:count]


def _next(previous: list[int], current: list[int]) -> list[int]:
    twice, shifted = [2 * c for c in current] + [0], [0] + [4 * c for c in current]
    padded = previous + [0] * (len(twice) - len(previous))
    return [a - b - c for a, b, c in zip(twice, shifted, padded, strict=True)]


def alternated(terms: list[Value]) -> list[Value]:
    """Return terms with every second sign changed, the first one kept."""
    return [-term if n % 2 else term for n, term in enumerate(terms)]


def doubled(cos: Value, sin: Value, curvature: int) -> tuple[Value, Value]:
    """Return cosine and sine of twice an angle, or the hyperbolic ones for a curvature of -1."""
    return 1 - 2 * curvature * sin * sin, 2 * sin * cos


def multiples(
    first: tuple[Value, Value], step: tuple[Value, Value], curvature: int, count: int
) -> tuple[list[Value], list[Value]]:
    """Return cosines and sines of first, first + step, first + 2 step ..., by those of both.

    A factor that all the sines, or all the cosines, have in common keeps its digits.
    """
    cosines, sines = [first[0]], [first[1]]
    for _ in range(count - 1):
        c, s = cosines[-1], sines[-1]
        cosines.append(c * step[0] - curvature * s * step[1])
        sines.append(s * step[0] + c * step[1])
    return cosines, sines
