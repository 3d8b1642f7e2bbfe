"""Complete elliptic integrals, Carlson's R_F and the nome, written once for every arithmetic.

Convention: modulus k with its complement k' = sqrt(1 - k^2) *passed in beside it*; 1 - k^2 is
never formed, so nothing is lost as k -> 1.  Every function takes the arithmetic as its first
argument: our module `decimals` (40 digits), an mpmath context (any number of digits), the module
`math` (floats) or `numpy` (arrays).  All spell sqrt, sin, cos, atan2, hypot and pi alike.

Every loop adds and multiplies positive numbers only, so each result is good to a few eps.
"""

from __future__ import annotations

import sys
from typing import Any

Arithmetic = Any
"""`decimals`, an mpmath context, `math` or `numpy`."""

Real = Any
"""A number of the arithmetic in use: Decimal, mpf, float or float64 array."""


def epsilon(ar: Arithmetic) -> Real:
    """Distance from 1 to the next number of the arithmetic."""
    return getattr(ar, "eps", sys.float_info.epsilon)


def everywhere(condition: Any) -> bool:
    """Whether a condition holds, or holds for every element of an array."""
    return condition.all() if hasattr(condition, "all") else bool(condition)


def where(condition: Any, yes: Real, no: Real) -> Real:
    """Choose between two numbers, or element by element between two arrays."""
    if hasattr(condition, "all"):
        import numpy as np

        return np.where(condition, yes, no)
    return yes if condition else no


def agm(ar: Arithmetic, a: Real, b: Real) -> Real:
    """Arithmetic-geometric mean of a > 0 and b > 0 (quadratic convergence, DLMF 19.8.1)."""
    tolerance = ar.sqrt(epsilon(ar))
    while not everywhere(abs(a - b) <= tolerance * a):
        a, b = (a + b) / 2, ar.sqrt(a * b)
    return (a + b) / 2


def complete_k(ar: Arithmetic, k_prime: Real) -> Real:
    """K = F(pi/2, k), the quarter period, from the complement k' in (0, 1] (DLMF 19.8.5)."""
    return ar.pi / (2 * agm(ar, 1, k_prime))


def period_mean(ar: Arithmetic, k_prime: Real, p: Real, a: Real, b: Real) -> Real:
    """Mean over a period of (a cn^2 + b sn^2) / (cn^2 + p sn^2), for k', p > 0 and a, b >= 0.

    Bulirsch's complete integral cel(k', p, a, b) is K times this mean (DLMF 19.2.11), so
    E = K period_mean(k', 1, 1, k'^2)  and  R_J(0, k'^2, 1, p) = 3 K period_mean(k', p, 0, 1).
    """
    tolerance = ar.sqrt(epsilon(ar))
    mean, geometric, p = k_prime * 0 + 1, k_prime, ar.sqrt(p)
    b = b / p
    close = False
    while not close:
        product = mean * geometric
        a, b = (a + b / p) / 2, (b + a * (product / p)) / 2
        p = (p + product / p) / 2
        close = everywhere(abs(mean - geometric) <= tolerance * mean)
        mean, geometric = (mean + geometric) / 2, ar.sqrt(product)
    return (a * mean + b) / (mean + p)


def complete_e(ar: Arithmetic, k_prime: Real) -> Real:
    """E = E(pi/2, k), the complete integral of the second kind, from k' in (0, 1]."""
    return complete_k(ar, k_prime) * period_mean(ar, k_prime, 1, 1, k_prime * k_prime)


def nome(ar: Arithmetic, *, m: Real, k_prime: Real) -> Real:
    """q = exp(-pi K'/K), equation (2,4), to a few eps however small q is (parameter m = k^2 < 1).

    The exponential would lose log(1/q) digits.  Instead: along the AGM of (1, k') the nome is
    squared at each step, until the series q = e + 2 e^5 + 15 e^9 ... (DLMF 19.5.5) is short.
    """
    tolerance = 2 * (epsilon(ar) / 20910) ** (ar.sqrt(1) / 20)
    a, b = (1 + k_prime) / 2, ar.sqrt(k_prime)
    c, squarings = m / (4 * a), []
    while not everywhere(c <= tolerance * a):
        far = c > tolerance * a
        squarings.append(far)
        mean = (a + b) / 2
        a, b = where(far, mean, a), where(far, ar.sqrt(a * b), b)
        c = where(far, c * (c / (4 * mean)), c)
    e = c / (2 * (a + b))
    e4 = (e * e) * (e * e)
    q = e * (1 + e4 * (2 + e4 * (15 + e4 * (150 + e4 * 1707))))
    for far in reversed(squarings):
        q = where(far, ar.sqrt(q), q)
    return q


def carlson_rf(ar: Arithmetic, x: Real, y: Real, z: Real) -> Real:
    """Carlson's R_F(x, y, z) for x, y, z >= 0, at most one of them zero (DLMF 19.36.1).

    F(phi, k) = sin(phi) R_F(cos^2 phi, 1 - k^2 sin^2 phi, 1).
    """
    tolerance = (epsilon(ar) / 4) ** (ar.sqrt(1) / 8)
    while True:
        mean = (x + y + z) / 3
        dx, dy = 1 - x / mean, 1 - y / mean
        dz = -dx - dy
        if everywhere((abs(dx) < tolerance) & (abs(dy) < tolerance) & (abs(dz) < tolerance)):
            break
        root_x, root_y, root_z = ar.sqrt(x), ar.sqrt(y), ar.sqrt(z)
        shift = root_x * root_y + root_y * root_z + root_z * root_x
        x, y, z = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4
    e2, e3 = dx * dy - dz * dz, dx * dy * dz
    series = -e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44
    series += -5 * e2 * e2 * e2 / 208 + 3 * e3 * e3 / 104 + e2 * e2 * e3 / 16
    return (1 + series) / ar.sqrt(mean)
