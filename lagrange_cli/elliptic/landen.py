"""Where a place stands in a period, by Landen's descending transformation (DLMF 22.7(i)).

    sn(u, k) = (1 + l) sn(u/(1 + l), l)/(1 + l sn^2(u/(1 + l), l)),    l = k^2/(1 + k')^2

keeps the place u/K, and l falls as a nome that is squared at each step, until sn is a sine.  Every
step adds and multiplies positive numbers only, so that each result keeps its digits, however close
to a zero.  Places are given by numbers s2 : c2 = sn^2 : cn^2, with any common factor.

What the last step leaves out follows from the series of the amplitude (DLMF 22.16.9), with x =
pi u/2K and q <= m (q/m, whose powers of m have no negative coefficients, is 1 at m = 1):

    am u - x = sum over n >= 1 of 2 q^n sin(2 n x)/(n (1 + q^(2n))).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..arithmetic.formulas import in_arithmetic
from ..arithmetic.numbers import R

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic


@in_arithmetic
def cosine_and_sine(ar: Arithmetic[R], *, m: R, k_prime: R, s2: R, c2: R) -> tuple[R, R]:
    """Return cos x and sin x for x = pi u/2K, where sn^2(u, k) : cn^2(u, k) = s2 : c2.

    0 <= u <= K and m = k^2 < 1.

    As sin(2 n x) <= n sin 2x in size, am u is within 4 q/(1 - q) |sin x cos x| of x, and sn and cn
    are within that share of sin x and cos x: they are wrong by at most 4 m/(1 - 5 m) of themselves.
    """
    s2, c2 = s2 / (s2 + c2), c2 / (s2 + c2)
    falling = True
    while falling:
        small = m / ((1 + k_prime) * (1 + k_prime))
        root = ar.sqrt((1 - small) * (1 - small) + 4 * small * c2)
        divisor = (1 + small + root) / 2
        divisor = divisor * divisor
        c2 = (1 + small) * c2 * (1 + 2 * small / (root + (1 - small))) / divisor
        s2 = s2 / divisor
        m, k_prime = small * small, 2 * ar.sqrt(k_prime) / (1 + k_prime)
        falling = ar.anywhere(small > ar.eps)
    cosine, sine = ar.sqrt(c2), ar.sqrt(s2)

    def share() -> R:
        return 4 * m / (1 - 5 * m)

    return ar.widened(cosine, lambda: cosine * share()), ar.widened(sine, lambda: sine * share())


@in_arithmetic
def hyperbolic_cosine_and_sine(ar: Arithmetic[R], *, m: R, k_prime: R, s2: R, c2: R) -> tuple[R, R]:
    """Return cosh y and sinh y for y = pi v/2K, where sn^2(v, k') : cn^2(v, k') = s2 : c2.

    0 <= v <= K' and m = k^2 < 1: the transformation at imaginary u = iv, sn(iv, k) = i sc(v, k').

    With am(iv, k) = i p the series gives 0 <= p - y <= 2 q sinh(2 y)/(1 - q e^(2 y)), as
    sinh(2 n y) <= n sinh(2 y) e^(2 (n - 1) y).  Since y <= p and e^(2 p) <= 4 C^2 with C = cosh p,
    both results are wrong by at most 4 m C^2/(1 - 4 m C^2) of themselves.
    """
    falling = True
    while falling:
        small = m / ((1 + k_prime) * (1 + k_prime))
        root = ar.sqrt((1 + small) * (1 + small) * c2 + 4 * small * s2)
        divisor = ((1 + small) * ar.sqrt(c2) + root) / 2
        s2, c2 = s2 / (divisor * divisor), 0 * s2 + 1
        m, k_prime = small * small, 2 * ar.sqrt(k_prime) / (1 + k_prime)
        falling = ar.anywhere(small * (1 + s2) > ar.eps)
    cosh, sinh = ar.sqrt(1 + s2), ar.sqrt(s2)

    def share() -> R:
        part = 4 * m * (1 + s2)
        return part / (1 - part)

    return ar.widened(cosh, lambda: cosh * share()), ar.widened(sinh, lambda: sinh * share())
