"""The place of a point in a period, by Landen's descending transformation (DLMF 22.7(i)).

    sn(u, k) = (1 + l) sn(u/(1 + l), l)/(1 + l sn^2(u/(1 + l), l)),    l = k^2/(1 + k')^2

keeps the place u/K, and l falls as a nome that is squared at each step, until sn is a sine.  Every
step adds and multiplies positive numbers only, so that each result keeps its digits, however close
to a zero.  Points are given by numbers s2 : c2 = sn^2 : cn^2, with any common factor.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..arithmetic.numbers import R, in_arithmetic
from .complete import complete_k

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic


@in_arithmetic
def place(ar: Arithmetic[R], *, m: R, k_prime: R, sn: R, cn2: R) -> R:
    """Return x = pi u/2K from sn(u, k) and cn^2(u, k), for -K <= u <= K and m = k^2 < 1.

    Legendre's F(phi, k) is 2K x/pi, by the sine of phi and the square of its cosine.

    The last step leaves out x - am u.  Since 2K x/pi = F(am u, m), a sum of b_j m^j S_j(am u) where
    S_j is the integral of sin^(2j) and b_j <= 1 its mean, it is pi/2K times the sum of b_j m^j p_j
    where p_j = S_j(phi) - b_j phi has a slope of at most 1.  The powers of m in pi/2K have no
    coefficients larger than those of 1/(1 - m) (see `complete.agm`).  So phi m/(1 - m)^2, and more
    so phi m/(1 - 2 m), bounds it and its derivatives by phi and m.
    """
    m, factor, cn2 = _descended(ar, m, k_prime, cn2)
    amplitude = ar.atan2(sn / factor, ar.sqrt(cn2))
    return ar.widened(amplitude, lambda: (amplitude, m), lambda phi, m: phi * (m / (1 - 2 * m)))


@in_arithmetic
def first_kind(ar: Arithmetic[R], *, m: R, k_prime: R, sn: R, cn2: R) -> R:
    """Return Legendre's F(phi, k), phi up to a quarter turn, from sin phi, cos^2 phi and m = k^2.

    Arrays take Carlson's R_F (DLMF 19.25.5), which rounds less; in many digits it would take a
    hundred times as many steps.
    """
    if ar.is_array:
        from .carlson import carlson_rf

        integral: R = carlson_rf(ar, cn2, cn2 + k_prime * k_prime * (sn * sn), 0 * cn2 + 1)
        return sn * integral
    return 2 * complete_k(ar, k_prime) * place(ar, m=m, k_prime=k_prime, sn=sn, cn2=cn2) / ar.pi


@in_arithmetic
def cosine_and_sine(ar: Arithmetic[R], *, m: R, k_prime: R, s2: R, c2: R) -> tuple[R, R]:
    """Return cos x and sin x for x = pi u/2K, where sn^2(u, k) : cn^2(u, k) = s2 : c2.

    0 <= u <= K and m = k^2 < 1.

    By the series of the amplitude (DLMF 22.16.9), with q <= m (the powers of m in q/m, which is 1
    at m = 1, have no negative coefficients),

        am u - x = sum over n >= 1 of 2 q^n sin(2 n x)/(n (1 + q^(2n))),

    and sin(2 n x) <= n sin 2x in size, am u is within 4 q/(1 - q) |sin x cos x| of x, and sn and cn
    are within that share of sin x and cos x: they are wrong by at most 4 m/(1 - 5 m) of themselves.
    """
    m, factor, last = _descended(ar, m, k_prime, c2 / (s2 + c2))

    def widened(x: R) -> R:
        return ar.widened(
            x, lambda: (x, m), lambda x, m: x * (4 * m / (1 - 5 * m)), values_only=True
        )

    return widened(ar.sqrt(last)), widened(ar.sqrt(s2 / (s2 + c2)) / factor)


def _descended(ar: Arithmetic[R], m: R, k_prime: R, cn2: R) -> tuple[R, R, R]:
    """Return m, the number that sn has been divided by, and cn^2 where m is below eps^2."""
    factor = 0 * cn2 + 1
    falling = True
    while falling:
        small = m / ((1 + k_prime) * (1 + k_prime))
        one_less = 2 * k_prime / (1 + k_prime)
        root = ar.sqrt(one_less * one_less + 4 * small * cn2)
        divisor = (1 + small + root) / 2
        cn2 = (1 + small) * cn2 * (1 + 2 * small / (root + one_less)) / (divisor * divisor)
        factor = factor * divisor
        m, k_prime = small * small, 2 * ar.sqrt(k_prime) / (1 + k_prime)
        falling = ar.anywhere(small > ar.eps)
    return m, factor, cn2


@in_arithmetic
def hyperbolic_cosine_and_sine(ar: Arithmetic[R], *, m: R, k_prime: R, s2: R, c2: R) -> tuple[R, R]:
    """Return cosh y and sinh y for y = pi v/2K, where sn^2(v, k') : cn^2(v, k') = s2 : c2.

    0 <= v <= K' and m = k^2 < 1: the transformation at imaginary u = iv, sn(iv, k) = i sc(v, k').

    With am(iv, k) = i p the series of `cosine_and_sine` gives 0 <= p - y <=
    2 q sinh(2 y)/(1 - q e^(2 y)), as sinh(2 n y) <= n sinh(2 y) e^(2 (n - 1) y).  Since y <= p and
    e^(2 p) <= 4 C^2 with C = cosh p, both results are wrong by at most 4 m C^2/(1 - 4 m C^2) of
    themselves.
    """
    falling = True
    while falling:
        small = m / ((1 + k_prime) * (1 + k_prime))
        root = ar.sqrt((1 + small) * (1 + small) * c2 + 4 * small * s2)
        divisor = ((1 + small) * ar.sqrt(c2) + root) / 2
        s2, c2 = s2 / (divisor * divisor), 0 * s2 + 1
        m, k_prime = small * small, 2 * ar.sqrt(k_prime) / (1 + k_prime)
        falling = ar.anywhere(small * (1 + s2) > ar.eps)

    def widened(x: R) -> R:
        part = 4 * m * (1 + s2)
        return ar.widened(
            x, lambda: (x, part), lambda x, part: x * (part / (1 - part)), values_only=True
        )

    return widened(ar.sqrt(1 + s2)), widened(ar.sqrt(s2))
