"""Jacobi's am, sn, cn, dn of arrays of real u.

For |u| <= K/2 they come from tan(am u) = sn u/cn u, a quotient of two theta series without
cancellation.  For larger |u|, sn(K - u) : cn(K - u) = cn u : k' sn u.  Up to k = k' the series run
in q.  For larger k they run in q' = exp(-pi K/K') (Jacobi's imaginary transformation).  The nome is
then at most exp(-pi), and four terms are enough, however close k is to 1.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.arrays import ARRAYS, PAIRS, blocks
from ..arithmetic.double_double import DoubleDouble, reduce_phase, sqrt_pair, two_product, two_sum
from ..arithmetic.numbers import polynomial
from ..arithmetic.rounding import Pair
from ..arithmetic.types import Array
from .complete import agm, nome

_LARGEST_ARGUMENT = 350.0
"""Greatest argument of sinh; beyond it, for k' = 0 only, cn and dn are exponentials."""
_SMALL = 1e-290
"""Size below which q' = (k'/4)^2 loses digits, being close to the end of the range."""


Powers = tuple[Any, ...]
"""Coefficients of powers, the lowest power first."""
JacobiArrays = tuple[Array, Array, Array, Array]
"""am, sn, cn, dn."""


class Modulus(NamedTuple):
    """k and its complement k', arrays of doubles, each good to an ulp."""

    k: Any
    k_prime: Any
    rest: Any = 0.0
    """The part of k' lost to rounding; the period needs it far away from 0."""


def modulus_of_complement(k_prime: Array) -> Modulus:
    """Return the modulus of a complement k' in [0, 1]."""
    square, rest = two_product(k_prime, k_prime)
    difference, error = two_sum(1.0, -square)
    return Modulus(sqrt_pair(*two_sum(difference, error - rest))[0], k_prime, 0 * k_prime)


def jacobi_of_arrays(u: Any, modulus: Modulus) -> JacobiArrays:
    """Return the functions of arguments and moduli that broadcast."""
    u = np.asarray(u, dtype=float)
    if all(np.ndim(part) == 0 for part in modulus):
        series = _series(modulus)
        parts = [_of_arguments(u.ravel()[block], series) for block in blocks(u.size)]
        am, sn, cn, dn = (np.concatenate(f).reshape(u.shape) for f in zip(*parts, strict=True))
        return am, sn, cn, dn
    u, *moduli = np.broadcast_arrays(u, *modulus)
    flat = [np.ravel(part) for part in (u, *moduli)]
    results = np.empty((4, u.size))
    circular = flat[1] <= flat[2]
    for family in (np.flatnonzero(circular), np.flatnonzero(~circular)):
        for block in blocks(family.size):
            index = family[block]
            series = _series(Modulus(*(part[index] for part in flat[1:])))
            results[:, index] = _of_arguments(flat[0][index], series)
    am, sn, cn, dn = results.reshape(4, *u.shape)
    return am, sn, cn, dn


class _Series(NamedTuple):
    """The coefficients of tan(am u) = f(y) P(x)/Q(x), for one modulus or one per element.

    In the circular family f = tan and x = sin^2 y; in the hyperbolic one f = sinh and x = q' sinh^2
    y.
    """

    circular: bool
    k_prime: Any
    rate: Pair
    """Half periods per unit of u, 1/(2K)."""
    stretch: Any
    """Argument y per half period."""
    above: Powers
    below: Powers
    q: Any
    """The nome in use."""


def _series(modulus: Modulus) -> _Series:
    """Return the coefficients for moduli that are all circular or all hyperbolic."""
    k, k_prime = modulus.k, modulus.k_prime
    finite = np.where(k_prime > 0, k_prime, 1.0)
    rate = rate_of_half_periods(finite, modulus.rest)
    if np.all(k <= k_prime):
        q = nome(ARRAYS, m=k * k, k_prime=k_prime)
        return _Series(True, k_prime, rate, np.pi, *_circular(q, np.sqrt(k_prime)), q)
    q = nome(ARRAYS, m=k_prime * k_prime, k_prime=k)
    usual = q > _SMALL
    stretch = -np.where(usual, np.log(np.where(usual, q, 1.0)), 2 * np.log(finite / 4))  # pi K/K'
    return _Series(False, k_prime, rate, stretch, *_hyperbolic(q), q)


def rate_of_half_periods(k_prime: Any, rest: Any) -> Pair:
    """Return agm(1, k')/pi = 1/(2K), the rate of half periods, for k' in (0, 1], to 30 digits."""
    parts = np.broadcast_arrays(np.asarray(k_prime, dtype=float), rest)
    rate = agm(PAIRS, 1, DoubleDouble(*parts)) / PAIRS.pi
    return Pair(*(part.reshape(np.shape(k_prime)) for part in (rate.high, rate.low)))


def _circular(q: Any, root: Any) -> tuple[Powers, Powers]:
    """Return theta1 and theta2 in powers of sin^2, up to a factor; `root` is sqrt(k')."""
    q2 = q * q
    q6 = q2 * q2 * q2
    above = 1 - 3 * q2 + 5 * q6, 4 * q2 - 20 * q6, 16 * q6
    below = 1 + q2 + q6, -4 * q2 - 12 * q6, 16 * q6
    return above, tuple(root * c for c in below)


def _hyperbolic(q: Any) -> tuple[Powers, Powers]:
    """Return theta1 and theta4 of an imaginary argument in powers of q sinh^2, up to a factor."""
    q2 = q * q
    q4 = q2 * q2
    q8 = q4 * q4
    above = (
        1 - 3 * q2 + 5 * q2 * q4 - 7 * q4 * q8,
        -4 * q + 20 * q * q4 - 56 * q * q2 * q8,
        16 * q4 - 112 * q2 * q8,
        -64 * q * q8,
    )
    below = (
        1 - 2 * q + 2 * q4 - 2 * q * q8,
        -4 + 16 * q * q2 - 36 * q8,
        16 * q2 - 96 * q * q2 * q4,
        -64 * q2 * q4,
    )
    scale = (1 + q2 + q2 * q4 + q4 * q8) / (1 + 2 * q + 2 * q4 + 2 * q * q8)  # theta2/theta3
    return above, tuple(scale * c for c in below)


def _of_arguments(u: Array, series: _Series) -> JacobiArrays:
    """Return the functions of one block of arguments."""
    return _evaluate(*reduce_phase(u, series.rate), u, series)


def _evaluate(halves: Array, since: Array, u: Any, series: _Series, low: Any = 0.0) -> JacobiArrays:
    """Return the functions at `halves` + `since` periods 2K, or at u itself if k' = 0.

    `low` is the part of `since` lost to rounding.
    """
    k_prime = series.k_prime
    far = abs(since) > 0.25
    side = np.copysign(1.0, since)
    y = np.where(far, (0.5 * side - since) - low, since) * series.stretch
    if np.any(k_prime == 0):  # k = 1 has no period
        endless = np.broadcast_to(k_prime == 0, halves.shape)
        halves, far = np.where(endless, 0.0, halves), far & ~endless
        y = np.where(endless, u, y)
    above, below = _tangent(y, series)
    if np.any(k_prime == 0):
        below = below * np.exp(np.minimum(_LARGEST_ARGUMENT - abs(y), 0.0))
    sine = np.where(far, side * below, above)
    cosine = np.where(far, side * (k_prime * above), below)
    am = halves * np.pi + np.arctan2(sine, cosine)
    size = np.sqrt(sine * sine + cosine * cosine)
    sine /= size
    cosine /= size
    dn = np.hypot(cosine, k_prime * sine)
    pairs = halves / 2
    sign = 1.0 - 4.0 * abs(pairs - np.rint(pairs))  # (-1)^halves
    return am, sign * sine, sign * cosine, dn


def _tangent(y: Array, series: _Series) -> tuple[Array, Array]:
    """Return the numerator and denominator of tan(am u)."""
    if series.circular:
        f = np.tan(y)
        square = f * f
        x = square / (1.0 + square)
    else:
        f = np.sinh(np.clip(y, -_LARGEST_ARGUMENT, _LARGEST_ARGUMENT))
        x = series.q * f * f
    return f * polynomial(series.above, x), polynomial(series.below, x)
