"""Carlson's symmetric elliptic integral R_F by duplication (DLMF 19.36(i)).

Each step replaces the arguments by others four times closer to their mean.  A Taylor series about
the mean gives the integral of the last arguments.  Balls take the function of Arb.
"""

from __future__ import annotations

from functools import reduce

from ..arithmetic.ball import Balls
from ..arithmetic.numbers import Arithmetic, R, absolute, in_arithmetic, root_of_epsilon


@in_arithmetic
def carlson_rf(ar: Arithmetic[R], x: R, y: R, z: R) -> R:
    """Return Carlson's R_F(x, y, z) for x, y, z >= 0, at most one of them 0 (DLMF 19.36.1).

        F(phi, k) = sin(phi) R_F(cos^2 phi, 1 - k^2 sin^2 phi, 1)

    For doubles from 1e-100 to 1e100 the error is at most 4 eps.
    """
    if isinstance(ar, Balls):
        return ar.carlson_rf(x, y, z)
    mean = (x + y + z) / 3
    distances = [absolute(mean - at) for at in (x, y, z)]
    spread: R = reduce(lambda a, b: ar.where(a > b, a, b), distances) / root_of_epsilon(ar, 4, 8)
    while ar.anywhere(spread > abs(mean)):
        root_x, root_y, root_z = ar.sqrt(x), ar.sqrt(y), ar.sqrt(z)
        shift = root_x * root_y + root_y * root_z + root_z * root_x
        x, y, z, spread = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4, spread / 4
        mean = (x + y + z) / 3
    dx, dy = 1 - x / mean, 1 - y / mean
    dz = -dx - dy
    e2, e3 = dx * dy - dz * dz, dx * dy * dz
    square = e2 * e2
    series = -e2 / 10 + e3 / 14 + square / 24 - 3 * e2 * e3 / 44
    series += -5 * e2 * square / 208 + 3 * e3 * e3 / 104 + square * e3 / 16
    return (1 + series) / ar.sqrt(mean)
