"""Jacobi's am, sn, cn, dn (Aksenov section 3.1): of numbers of many digits, or of arrays."""

from __future__ import annotations

from typing import NamedTuple

from ..arithmetic.formulas import in_arithmetic
from ..arithmetic.protocol import FunctionArithmetic, Value
from .complete import complete_k
from .modulus import Modulus
from .periods import Periods, whole_and_rest
from .theta import ThetaSeries, series_for, theta_at


class Jacobi(NamedTuple):
    """am u, unwrapped; its sine and its cosine; and dn u, the derivative of am u."""

    am: Value
    sn: Value
    cn: Value
    dn: Value


@in_arithmetic
def jacobi(ar: FunctionArithmetic, u: Value, modulus: Modulus) -> Jacobi:
    """Return am, sn, cn, dn of u (3.1.3), for k in [0, 1].

    numpy: real u and a modulus of shapes that broadcast; the worst error seen, also at 1e12 K and
    at 1 - k^2 = 1e-300, was 1.2 units of eps (max(1, |f|) + |u df/du|), u less the nearest multiple
    of 2K.  mpmath: u real or complex (am then only within |Im u| < K'), to a few eps and what
    |u|/K costs.
    """
    if ar.is_array:
        from .jacobi_arrays import jacobi_of_arrays

        return Jacobi(*jacobi_of_arrays(u, modulus))
    u = ar.convert(u)
    if not modulus.k_prime:
        am = 2 * ar.atan(ar.tanh(u / 2))
        return Jacobi(am, ar.tanh(u), 1 / ar.cosh(u), 1 / ar.cosh(u))
    if not modulus.k:
        return Jacobi(u, ar.sin(u), ar.cos(u), 1 + 0 * u)
    x = whole_and_rest(ar, u / (2 * complete_k(ar, modulus.k_prime)))
    return _by_theta(ar, x, modulus, series_for(ar, modulus))


@in_arithmetic
def jacobi_at(
    ar: FunctionArithmetic, x: Periods, modulus: Modulus, series: ThetaSeries | None = None
) -> Jacobi:
    """Return the functions at x = u/2K, given with all its digits, for one modulus k < 1.

    At whole quarters of arrays sn, cn, dn are 0, 1, -1 and k' exactly, as in Aksenov's table 2.
    In many digits the series of the modulus may be given.
    """
    if ar.is_array:
        from .jacobi_arrays import jacobi_of_places

        return Jacobi(*jacobi_of_places(x, modulus))
    if not modulus.k:
        return jacobi(ar, ar.pi * (x.turns + x.rest), modulus)
    return _by_theta(ar, x, modulus, series or series_for(ar, modulus))


def _by_theta(ar: FunctionArithmetic, x: Periods, modulus: Modulus, series: ThetaSeries) -> Jacobi:
    """Return the functions at x = u/2K by quotients of theta functions, for 0 < k < 1."""
    within = x._replace(turns=0 * x.turns)
    theta = {ij: theta_at(ar, ij, within, series) for ij in ("11", "10", "00", "01")}
    k, k_prime, below = modulus.k, modulus.k_prime, theta["01"]
    sn = theta["11"] / (ar.sqrt(k) * below)
    cn = ar.sqrt(k_prime / k) * theta["10"] / below
    dn = ar.sqrt(k_prime) * theta["00"] / below
    am = ar.atan2(sn, cn) if ar.im(x.rest) == 0 else -1j * ar.log(cn + 1j * sn)
    sign = -1 if x.turns % 2 else 1
    return Jacobi(x.turns * ar.pi + am, sign * sn, sign * cn, dn)
