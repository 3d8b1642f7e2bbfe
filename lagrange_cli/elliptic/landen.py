"""Where a place stands in a period, by Landen's descending transformation (DLMF 22.7(i)).

    sn(u, k) = (1 + l) sn(u/(1 + l), l)/(1 + l sn^2(u/(1 + l), l)),    l = k^2/(1 + k')^2

keeps the place u/K, and l falls as a nome that is squared at each step, until sn is a sine.  Every
step adds and multiplies positive numbers only, so that each result keeps its digits, however close
to a zero.  Places are given by numbers s2 : c2 = sn^2 : cn^2, with any common factor.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..arithmetic.blocks import in_arithmetic
from ..arithmetic.numbers import R

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic


@in_arithmetic
def cosine_and_sine(ar: Arithmetic[R], *, m: R, k_prime: R, s2: R, c2: R) -> tuple[R, R]:
    """Return cos x and sin x for x = pi u/2K, where sn^2(u, k) : cn^2(u, k) = s2 : c2.

    0 <= u <= K and m = k^2 < 1.
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
    return ar.sqrt(c2), ar.sqrt(s2)


@in_arithmetic
def hyperbolic_cosine_and_sine(ar: Arithmetic[R], *, m: R, k_prime: R, s2: R, c2: R) -> tuple[R, R]:
    """Return cosh y and sinh y for y = pi v/2K, where sn^2(v, k') : cn^2(v, k') = s2 : c2.

    0 <= v <= K' and m = k^2 < 1: the transformation at imaginary u = iv, sn(iv, k) = i sc(v, k').
    """
    falling = True
    while falling:
        small = m / ((1 + k_prime) * (1 + k_prime))
        root = ar.sqrt((1 + small) * (1 + small) * c2 + 4 * small * s2)
        divisor = ((1 + small) * ar.sqrt(c2) + root) / 2
        s2, c2 = s2 / (divisor * divisor), 0 * s2 + 1
        m, k_prime = small * small, 2 * ar.sqrt(k_prime) / (1 + k_prime)
        falling = ar.anywhere(small * (1 + s2) > ar.eps)
    return ar.sqrt(1 + s2), ar.sqrt(s2)
