"""Jacobi's am, sn, cn, dn (Aksenov section 3.1) of numbers with many digits and of arrays.

Complex arguments use the addition theorem (DLMF 22.8(i), 22.6.1).  It combines functions of the
real part, of modulus k, and of the imaginary part, of modulus k'.  All sums have terms of like
sign, so nothing cancels.  An imaginary modulus takes the functions of the real part a quarter
period further on.  A modulus above 1 exchanges cn and dn.
"""

from __future__ import annotations

from typing import NamedTuple

from ..arithmetic.numbers import in_arithmetic
from ..arithmetic.protocol import ComplexArithmetic, FunctionArithmetic, Numeric
from .any_modulus import AnyModulus, ModulusKind, reduced_modulus
from .complete import complete_k
from .modulus import Modulus
from .periods import Complex, Periods, reduced, whole_and_rest
from .theta import ThetaSeries, series_for, theta_at


class Jacobi(NamedTuple):
    """am u, unwrapped; its sine and its cosine; and dn u, the derivative of am u."""

    am: Numeric
    sn: Numeric
    cn: Numeric
    dn: Numeric


@in_arithmetic
def jacobi(ar: FunctionArithmetic, u: Numeric, modulus: Modulus) -> Jacobi:
    """Return am, sn, cn, dn of u (3.1.3), for k in [0, 1].

    - numpy: u is real and broadcasts with the modulus.  The worst error seen is 1.2 units of eps
      (max(1, |f|) + |u df/du|), with u less the nearest multiple of 2K.  Tests include u = 1e12 K
      and 1 - k^2 = 1e-300.
    - mpmath: u is real or complex, and am is defined for |Im u| < K' only.  Results are good to a
      few eps, less the digits that |u|/K costs.
    """
    if ar.is_array:
        from .jacobi_arrays import jacobi_of_arrays  # start-up

        return Jacobi(*jacobi_of_arrays(u, modulus))
    u = ar.convert(u)
    if ar.im(u):
        return complex_jacobi(ar, u, reduced_modulus(ar, ModulusKind.UNIT, modulus))
    u = ar.re(u)
    if not modulus.k_prime:
        am = 2 * ar.atan2(ar.tanh(u / 2), 1 + 0 * u)
        return Jacobi(am, ar.tanh(u), ar.sech(u), ar.sech(u))
    if not modulus.k:
        return Jacobi(u, ar.sin(u), ar.cos(u), 1 + 0 * u)
    x = whole_and_rest(ar, u / (2 * complete_k(ar, modulus.k_prime)))
    return _by_theta(ar, x, modulus, series_for(ar, modulus))


@in_arithmetic
def jacobi_at(
    ar: FunctionArithmetic, x: Periods, modulus: Modulus, series: ThetaSeries | None = None
) -> Jacobi:
    """Return the functions at x = u/2K, given with all its digits, for one modulus k < 1.

    At whole quarter periods, arrays of sn, cn and dn are exactly 0, 1, -1 or k', as in Aksenov's
    table 2.  In many digits, pass the `series` of the modulus to use it again.
    """
    if ar.is_array:
        from .jacobi_arrays import jacobi_of_places  # start-up

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
    sign = -1 if x.turns % 2 else 1
    return Jacobi(x.turns * ar.pi + ar.atan2(sn, cn), sign * sn, sign * cn, dn)


@in_arithmetic
def complex_jacobi(ar: ComplexArithmetic, u: Complex, given: AnyModulus) -> Jacobi:
    """Return am, sn, cn, dn of complex u for one modulus; for arrays, pass `given.rounded()`.

    Beyond its branch points, the poles next to the real axis, am is NaN.  For a modulus in [0, 1]
    this means |Im u| > K'.  For k < 1 and imaginary k, am is unwrapped.  For k > 1 its real part
    stays within a quarter of a turn.
    """
    k, k_prime, _ = given.modulus
    (am, s, c, d), _ = _real(ar, ar.re(u), given.modulus, given.scale)
    (_, s1, c1, d1), turns = _real(ar, ar.im(u), Modulus(k_prime, k), given.across)
    if given.kind is ModulusKind.IMAGINARY:
        s, c, d = c / d, -k_prime * s / d, k_prime / d
    slant, ratio = k * s * s1, d1 / c1
    lift = slant / c1
    below = c1 + lift * slant  # all divided by cn of the imaginary part
    sn = ar.mpc(s * ratio, c * d * s1) / below
    cn = ar.mpc(c, -s * d * s1 * ratio) / below
    dn = ar.mpc(d * d1, -k * c * lift) / below
    size = ar.sqrt(c1 * c1 + slant * slant)
    rise, above = d * s1 / size, abs(c1)  # where am is defined, c1 > 0
    if given.kind is ModulusKind.LARGE:
        angle, rise = ar.atan2(k * s, d * above), k * c * s1 / size
        sn, cn, dn = sn * k, dn, cn
    elif given.kind is ModulusKind.IMAGINARY:
        angle = _near(ar, ar.atan2(-c * above, s * d1), am)
        sn, cn, dn = -cn, sn, dn / k_prime
    else:
        angle = _near(ar, ar.atan2(s * d1, c * above), am)
    am = ar.where(turns == 0, ar.mpc(angle, ar.asinh(rise)), ar.mpc(ar.nan, ar.nan))
    return Jacobi(am, sn, cn, dn)


def _real(
    ar: ComplexArithmetic, u: Numeric, modulus: Modulus, rate: Numeric
) -> tuple[Jacobi, Numeric]:
    """Return the functions of real numbers, and the number of whole periods; see `AnyModulus`."""
    if not ar.is_array and ar.either(u == 0):  # exactly, as the signs of zeros decide
        return Jacobi(u, u, 1 + u, 1 + u), 0 * u
    if not rate:
        return jacobi(ar, u, modulus), 0 * u
    x = reduced(u, rate) if ar.is_array else whole_and_rest(ar, u * rate)
    return jacobi_at(ar, x, modulus), x.turns


def _near(ar: ComplexArithmetic, angle: Numeric, am: Numeric) -> Numeric:
    """Return an angle with the whole turns added that bring it next to am of the real part."""
    return angle + 2 * ar.pi * ar.nint((am - angle) / (2 * ar.pi))
