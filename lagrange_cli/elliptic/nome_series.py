"""The nome series of Aksenov (3.1.4) to (3.1.8), as endless partial sums.

For 0 < k < 1 and real u, or complex u with |Im u| < K'; `ar` is an mpmath context.  They show how a
series converges; `jacobi` and `complete_k` are the way to compute.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate, count

from ..arithmetic.protocol import FunctionArithmetic, Value
from .complete import complete_k, nome
from .modulus import Modulus


def sn_sums(ar: FunctionArithmetic, u: Value, modulus: Modulus) -> Iterator[Value]:
    """Yield sums of sn u = 2 pi/(k K) sum q^(n-1/2)/(1 - q^(2n-1)) sin (2n-1) pi u/2K  (3.1.4)."""
    q, angle, scale = _parts(ar, u, modulus)
    odd = (2 * n - 1 for n in count(1))
    return accumulate(scale * ar.sqrt(q) ** n / (1 - q**n) * ar.sin(n * angle) for n in odd)


def cn_sums(ar: FunctionArithmetic, u: Value, modulus: Modulus) -> Iterator[Value]:
    """Yield sums of cn u = 2 pi/(k K) sum q^(n-1/2)/(1 + q^(2n-1)) cos (2n-1) pi u/2K  (3.1.5)."""
    q, angle, scale = _parts(ar, u, modulus)
    odd = (2 * n - 1 for n in count(1))
    return accumulate(scale * ar.sqrt(q) ** n / (1 + q**n) * ar.cos(n * angle) for n in odd)


def am_sums(ar: FunctionArithmetic, u: Value, modulus: Modulus) -> Iterator[Value]:
    """Yield the sums of am u = pi u/2K + sum (2/n) q^n/(1 + q^2n) sin 2n pi u/2K  (3.1.7)."""
    q, angle, _ = _parts(ar, u, modulus)
    terms = (2 * q**n / (n * (1 + q ** (2 * n))) * ar.sin(2 * n * angle) for n in count(1))
    return accumulate(terms, initial=angle)


def k_sums(ar: FunctionArithmetic, modulus: Modulus) -> Iterator[Value]:
    """Yield the sums of K = pi/2 {1 + (1/2)^2 k^2 + (1 3/2 4)^2 k^4 + ...}  (3.1.8)."""
    m = modulus.k * modulus.k
    factors = (((2 * n - 1) / ar.convert(2 * n)) ** 2 * m for n in count(1))
    terms = accumulate(factors, lambda term, factor: term * factor, initial=ar.pi / 2)
    return accumulate(terms)


def _parts(ar: FunctionArithmetic, u: Value, modulus: Modulus) -> tuple[Value, Value, Value]:
    """Return the nome (3.1.6), pi u/2K and 2 pi/(k K)."""
    K = complete_k(ar, modulus.k_prime)
    q = nome(ar, m=modulus.k * modulus.k, k_prime=modulus.k_prime)
    return q, ar.pi * u / (2 * K), 2 * ar.pi / (modulus.k * K)
