"""Complete elliptic integrals and the nome, by the arithmetic-geometric mean.

Every loop adds and multiplies positive numbers only, so each result is good to a few eps.
"""

from __future__ import annotations

from ..arithmetic.generic import anywhere, epsilon, root_of_epsilon, where
from ..arithmetic.protocol import Arithmetic, R


def agm(ar: Arithmetic[R], a: R | int, b: R) -> R:
    """Arithmetic-geometric mean of a > 0 and b > 0 (quadratic convergence, DLMF 19.8.1)."""
    tolerance = ar.sqrt(epsilon(ar))
    while anywhere(abs(a - b) > tolerance * a):
        a, b = (a + b) / 2, ar.sqrt(a * b)
    return (a + b) / 2


def complete_k(ar: Arithmetic[R], k_prime: R) -> R:
    """K = F(pi/2, k), the quarter period, from the complement k' in (0, 1] (DLMF 19.8.5)."""
    return ar.pi / (2 * agm(ar, 1, k_prime))


def period_mean(ar: Arithmetic[R], k_prime: R, p: R | int, a: R | int, b: R | int) -> R:
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
        close = not anywhere(abs(mean - geometric) > tolerance * mean)
        mean, geometric = (mean + geometric) / 2, ar.sqrt(product)
    return (a * mean + b) / (mean + p)


def complete_e(ar: Arithmetic[R], k_prime: R) -> R:
    """E = E(pi/2, k), the complete integral of the second kind, from k' in (0, 1]."""
    return complete_k(ar, k_prime) * period_mean(ar, k_prime, 1, 1, k_prime * k_prime)


def nome(ar: Arithmetic[R], *, m: R, k_prime: R) -> R:
    """q = exp(-pi K'/K), equation (2,4), to a few eps however small q is (parameter m = k^2 < 1).

    The exponential would lose log(1/q) digits.  Instead: along the AGM of (1, k') the nome is
    squared at each step, until the series q = e + 2 e^5 + 15 e^9 ... (DLMF 19.5.5) is short.
    """
    tolerance = 2 * root_of_epsilon(epsilon(ar), 20910, 20)
    a, b = (1 + k_prime) / 2, ar.sqrt(k_prime)
    c, squarings = m / (4 * a), []
    while anywhere(c > tolerance * a):
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
