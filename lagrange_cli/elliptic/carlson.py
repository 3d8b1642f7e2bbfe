"""Carlson's symmetric elliptic integrals R_F, R_C, R_D, R_J by duplication (DLMF 19.36(i)).

Arguments are real, within the limits that each function states, and from 1e-100 to 1e100 in
doubles.  In mpmath they may also be complex, off the negative axis.

Each step replaces the arguments by others four times closer to their mean.  A Taylor series about
the mean gives the integral of the last arguments.  Over forty decades of arguments the errors of
all four functions are at most 4 eps.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce, wraps
from typing import TYPE_CHECKING, Any, cast

from ..arithmetic.numbers import F, R, absolute, in_arithmetic, power, root_of_epsilon

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic, FunctionArithmetic, Numeric

    Roots = tuple[Numeric, Numeric, Numeric, Numeric]
    Gain = Callable[[Roots, Numeric, Numeric], Numeric]


def blockwise(function: F) -> F:
    """Return the formula f(ar, *arguments), evaluated block by block over long arrays."""

    @in_arithmetic
    @wraps(function)
    def evaluate(ar: Any, *arguments: Any) -> Any:
        if not ar.is_array:
            return function(ar, *arguments)
        import numpy as np

        from ..arithmetic.arrays import BLOCK, blocks  # start-up
        from ..arithmetic.double_double import DoubleDouble  # start-up

        if any(isinstance(x, DoubleDouble) for x in arguments):
            return function(ar, *arguments)
        arrays = np.broadcast_arrays(*arguments)
        if arrays[0].size <= BLOCK:
            return function(ar, *arrays)
        flat = [array.ravel() for array in arrays]
        parts = [function(ar, *(x[block] for x in flat)) for block in blocks(flat[0].size)]
        return np.concatenate(parts).reshape(arrays[0].shape)

    return cast(F, evaluate)


def in_pairs(function: F) -> F:
    """Return the formula f(ar, *arguments), evaluated in pairs of doubles for arrays.

    The rounding errors of many steps then do not add up.
    """

    @blockwise
    @wraps(function)
    def evaluate(ar: Any, *arguments: Any) -> Any:
        if not ar.is_array or ar.magnitude < -20:
            return function(ar, *arguments)
        from ..arithmetic.arrays import PAIRS  # NumPy is loaded for arrays only
        from ..arithmetic.double_double import DoubleDouble  # start-up

        pairs = function(PAIRS, *(DoubleDouble(x.astype(float)) for x in arguments))
        return pairs.high.reshape(arguments[0].shape)[()]

    return cast(F, evaluate)


@blockwise
def carlson_rf(ar: Arithmetic[R], x: R, y: R, z: R) -> R:
    """Return Carlson's R_F(x, y, z) for x, y, z >= 0, at most one of them zero (DLMF 19.36.1).

        F(phi, k) = sin(phi) R_F(cos^2 phi, 1 - k^2 sin^2 phi, 1)

    The truncation error of the series to order 7 is bounded as follows.  About the mean A, the
    series is the sum of T_n (1/2)_n/(3/2)_n (DLMF 19.19.7).  T_n is a polynomial of order n in dx,
    dy and dz.  If these are at most r in size, |T_n| <= r^n (3/2)_n/n!, and each term is at most
    r^n (1/2)_n/n!.  The factor (1/2)_n/n! decreases with n and is 0.197 for n = 8, so the error is
    at most r^8/(5 (1 - r)).
    """
    mean = (x + y + z) / 3
    spread = _spread(ar, mean, x, y, z)
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
    series = ar.widened(
        1 + series,
        lambda: (_radius(dx, dy, dz),),
        lambda r: power(r, 8) / (5 * (1 - r)),
        values_only=True,
    )
    return series / ar.sqrt(mean)


@in_pairs
def carlson_rc(ar: FunctionArithmetic, x: Numeric, y: Numeric) -> Numeric:
    """Return R_C(x, y) = R_F(x, y, y) for x >= 0, y > 0 (DLMF 19.2.17)."""
    return carlson_rf(ar, x, y, y)


@blockwise
def carlson_rd(ar: FunctionArithmetic, x: Numeric, y: Numeric, z: Numeric) -> Numeric:
    """Return R_D(x, y, z) for x, y >= 0, at most one of them 0, and z > 0 (DLMF 19.36.2)."""
    if ar.is_array:
        from scipy.special import elliprd  # for arrays only

        return elliprd(x, y, z)

    def gain(roots: Roots, z: Numeric, shift: Numeric) -> Numeric:
        return 3 / (roots[2] * (z + shift))

    return _duplicated(ar, (x, y, z, z), gain)


@in_pairs
def carlson_rj(ar: FunctionArithmetic, x: Numeric, y: Numeric, z: Numeric, p: Numeric) -> Numeric:
    """Return R_J(x, y, z, p) for x, y, z >= 0, at most one of them 0, and p > 0 (DLMF 19.36.2).

    Each step adds an R_C(1, 1 + e).  A quotient of sums gives 1 + e, so that nothing cancels if p
    is much smaller than the other arguments.
    """

    def gain(roots: Roots, p: Numeric, shift: Numeric) -> Numeric:
        root_x, root_y, root_z, root_p = roots
        beta = root_p * (p + shift)
        total = beta + p * (root_x + root_y + root_z) + root_x * root_y * root_z
        return 6 / total * carlson_rc(ar, 1 + 0 * p, 2 * beta / total)

    return _duplicated(ar, (x, y, z, p), gain)


def _spread(ar: Arithmetic[R], mean: R, *arguments: R) -> R:
    """Return the greatest distance from the mean, divided by the tolerance of the series."""
    distances = [absolute(mean - x) for x in arguments]
    greatest = reduce(lambda a, b: ar.where(a > b, a, b), distances)
    scale: R = root_of_epsilon(ar, 4, 8)
    return greatest / scale


def _radius(*shares: R) -> R:
    """Return a bound on the sizes of numbers whose sum is 0: half the sum of their sizes."""
    total: R = reduce(lambda a, b: a + b, map(absolute, shares)) / 2
    return total


def _duplicated(ar: FunctionArithmetic, arguments: Roots, gain: Gain) -> Numeric:
    """Return R_J, or R_D = R_J with p = z, where each step of the duplication adds a `gain`."""
    x, y, z, p = arguments
    mean, total, weight = (x + y + z + 2 * p) / 5, 0 * p, 1 + 0 * p
    spread = _spread(ar, mean, x, y, z, p)
    while ar.anywhere(spread > abs(mean)):
        root_x, root_y, root_z = ar.sqrt(x), ar.sqrt(y), ar.sqrt(z)
        shift = root_x * root_y + root_y * root_z + root_z * root_x
        total = total + gain((root_x, root_y, root_z, ar.sqrt(p)), p, shift) * weight
        x, y, z, p = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4, (p + shift) / 4
        weight, spread = weight / 4, spread / 4
        mean = (x + y + z + 2 * p) / 5
    rest = _near_mean(ar, 1 - x / mean, 1 - y / mean, 1 - z / mean) / (mean * ar.sqrt(mean))
    return total + rest * weight


def _near_mean(ar: FunctionArithmetic, dx: Numeric, dy: Numeric, dz: Numeric) -> Numeric:
    """Return the Taylor series of R_J about equal arguments, to seventh order (DLMF 19.36.2).

    The truncation error is bounded as in `carlson_rf`, with 3/2 and 5/2 in place of 1/2 and 3/2.
    The terms from order 8 on are at most r^n (3/2)_n/n!.  This bound is 3.4 r^8 for n = 8 and grows
    by a factor of at most 19 r/18 per order.  The sum is at most 4 r^8/(1 - 2 r).
    """
    dp = -(dx + dy + dz) / 2
    xyz, p2 = dx * dy * dz, dp * dp
    e2 = dx * dy + dy * dz + dz * dx - 3 * p2
    e3 = xyz + 2 * e2 * dp + 4 * p2 * dp
    e4 = (2 * xyz + e2 * dp + 3 * p2 * dp) * dp
    e5 = xyz * p2
    square = e2 * e2
    series = 1 - 3 * e2 / 14 + e3 / 6 + 9 * square / 88 - 3 * e4 / 22 - 9 * e2 * e3 / 52
    series = series + 3 * e5 / 26 - e2 * square / 16 + 3 * e3 * e3 / 40 + 3 * e2 * e4 / 20
    series = series + 45 * square * e3 / 272 - 9 * (e3 * e4 + e2 * e5) / 68
    return ar.widened(
        series,
        lambda: (_radius(dx, dy, dz, dp, dp),),
        lambda r: 4 * power(r, 8) / (1 - 2 * r),
        values_only=True,
    )
