"""Carlson's symmetric elliptic integrals R_F, R_C, R_D, R_J by duplication (DLMF 19.36(i)).

Real arguments as stated, from 1e-100 to 1e100 in doubles, or complex ones off the negative axis in
mpmath.  Each step replaces the arguments by others four times closer to their mean; the rest is a
Taylor series about the mean.  Over forty decades of arguments all four are within 4 eps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce, wraps
from itertools import combinations
from typing import TYPE_CHECKING, Any, cast

from ..arithmetic.numbers import F, R, absolute, in_arithmetic, power, root_of_epsilon

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic, FunctionArithmetic, Value

    Roots = tuple[Value, Value, Value, Value]
    Gain = Callable[[Roots, Value, Value], Value]
    from ..arithmetic.types import Array


_FAR_APART = 1e6
"""Ratio of arguments beyond which the rounding errors of ten steps or more add up."""

_NEAR_ONE, _TINY = 0.01, 1e-17
"""Where R_C(1, 1 - e) = sum e^n/(2n + 1) is used, and what it may leave out."""


def blockwise(function: F) -> F:
    """Return a formula f(ar, *arguments) that is evaluated block by block over long arrays."""

    @in_arithmetic
    @wraps(function)
    def evaluate(ar: Any, *arguments: Any) -> Any:
        if not ar.is_array:
            return function(ar, *arguments)
        return _in_blocks(function, ar, arguments)

    return cast(F, evaluate)


def _in_blocks(function: Callable[..., Any], ar: Any, arguments: tuple[Any, ...]) -> Any:
    import numpy as np

    from ..arithmetic.arrays import BLOCK, blocks
    from ..arithmetic.double_double import DoubleDouble

    if any(isinstance(x, DoubleDouble) for x in arguments):
        return function(ar, *arguments)
    arrays = np.broadcast_arrays(*arguments)
    if arrays[0].size <= BLOCK:
        return function(ar, *arrays)
    flat = [array.ravel() for array in arrays]
    parts = [function(ar, *(x[block] for x in flat)) for block in blocks(flat[0].size)]
    return np.concatenate(parts).reshape(arrays[0].shape)


@blockwise
def carlson_rf(ar: Arithmetic[R], x: R, y: R, z: R) -> R:
    """Return Carlson's R_F(x, y, z) for x, y, z >= 0, at most one of them zero (DLMF 19.36.1).

    F(phi, k) = sin(phi) R_F(cos^2 phi, 1 - k^2 sin^2 phi, 1).

    What the series to order 7 leaves out: about the mean A it is the sum of T_n (1/2)_n/(3/2)_n
    (DLMF 19.19.7), where T_n, a polynomial of order n in dx, dy and dz, is at most r^n (3/2)_n/n!
    if these are at most r in size.  So a term is at most r^n (1/2)_n/n!, of which the factor falls
    and is 0.197 for n = 8, and the rest at most r^8/(5 (1 - r)).
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


@in_arithmetic
def carlson_rc(ar: FunctionArithmetic, x: Value, y: Value) -> Value:
    """Return R_C(x, y) = R_F(x, y, y) for x >= 0, y > 0 (DLMF 19.2.17)."""
    if not ar.is_array:
        return carlson_rf(ar, x, y, y)
    difference, root_x = y - x, ar.sqrt(x)
    root = ar.sqrt(abs(ar.where(difference == 0, 1.0, difference)))
    far = x > 4 * y  # where the quotient of the other form could overflow
    circular = ar.atan2(root, root_x)
    logarithm = ar.log((root_x + root) / ar.sqrt(y))
    near_one = ar.log1p(2 * root * (root_x + root) / ar.where(far, x, y)) / 2
    hyperbolic = ar.where(far, logarithm, near_one)
    integral = ar.where(difference > 0, circular, hyperbolic) / root
    return ar.where(difference == 0, 1 / ar.sqrt(y), integral)


@blockwise
def carlson_rd(ar: FunctionArithmetic, x: Value, y: Value, z: Value) -> Value:
    """Return R_D(x, y, z) for x, y >= 0, at most one of them 0, and z > 0 (DLMF 19.36.2)."""

    def gain(roots: Roots, z: Value, shift: Value) -> Value:
        return 3 / (roots[2] * (z + shift))

    return _duplicated(ar, (x, y, z, z), gain)


@blockwise
def carlson_rj(ar: FunctionArithmetic, x: Value, y: Value, z: Value, p: Value) -> Value:
    """Return R_J(x, y, z, p) for x, y, z >= 0, at most one of them 0, and p > 0 (DLMF 19.36.2).

    Each step adds an R_C(1, 1 + e); 1 + e is formed as a quotient of sums, so that nothing cancels
    where p is much smaller than the other arguments.
    """

    def gain(roots: Roots, p: Value, shift: Value) -> Value:
        root_x, root_y, root_z, root_p = roots
        beta = root_p * (p + shift)
        total = beta + p * (root_x + root_y + root_z) + root_x * root_y * root_z
        return 6 / total * _rc_from_one(ar, 2 * beta / total)

    return _duplicated(ar, (x, y, z, p), gain)


def _spread(ar: Arithmetic[R], mean: R, *arguments: R) -> R:
    """Return the greatest distance from the mean, over the one at which the series is exact."""
    distances = [absolute(mean - x) for x in arguments]
    greatest = reduce(lambda a, b: ar.where(a > b, a, b), distances)
    scale: R = root_of_epsilon(ar, 4, 8)
    return greatest / scale


def _radius(*shares: R) -> R:
    """Return a bound of the size of each of some numbers whose sum is 0: half of all sizes."""
    total: R = reduce(lambda a, b: a + b, map(absolute, shares)) / 2
    return total


def _rc_from_one(ar: FunctionArithmetic, y: Value) -> Value:
    """Return R_C(1, y); that of an array close to 1 is a Taylor series."""
    e = 1 - y
    largest = max(_TINY, float(abs(e).max(initial=0.0))) if ar.is_array else 1.0
    if not largest <= _NEAR_ONE:
        return carlson_rc(ar, ar.sqrt(1), y)
    last = int(math.log(_TINY) / math.log(largest))
    return reduce(lambda value, n: value * e + 1 / (2 * n + 1), range(last, -1, -1), 0 * e)


def _duplicated(ar: FunctionArithmetic, arguments: Roots, gain: Gain) -> Value:
    """Return R_J, or R_D = R_J with p = z, where each step of the duplication adds a `gain`.

    The rounding errors of the arguments add up over the steps; those elements of arrays whose
    arguments are many decades apart, and need many, carry them along.
    """
    far = _far_apart(ar, arguments) if ar.is_array else False
    if not ar.anywhere(far) or ar.everywhere(far):
        return _stepped(ar, arguments, gain, carried=ar.anywhere(far))
    total = 0 * arguments[0]
    for rows, carried in ((far, True), (~far, False)):
        x, y, z, p = (argument[rows] for argument in arguments)
        total[rows] = _stepped(ar, (x, y, z, p), gain, carried=carried)
    return total


def _stepped(ar: FunctionArithmetic, arguments: Roots, gain: Gain, *, carried: bool) -> Value:
    """Return R_J by duplication.

    What remains after n steps is R_J of the new arguments over 4^n: where fewer than half of an
    array need more, they are continued alone.
    """
    x, y, z, p = arguments
    mean, total, weight = (x + y + z + 2 * p) / 5, 0 * p, ar.sqrt(1)
    spread = _spread(ar, mean, x, y, z, p)
    lows, lost = [0 * p] * 4, 0 * p
    while _mostly(ar, unequal := spread > abs(mean)):
        root_x, root_y, root_z = ar.sqrt(x), ar.sqrt(y), ar.sqrt(z)
        shift = root_x * root_y + root_y * root_z + root_z * root_x
        term = gain((root_x, root_y, root_z, ar.sqrt(p)), p, shift) * weight
        if carried:
            from ..arithmetic.double_double import two_sum  # numpy is loaded for arrays only

            total, error = two_sum(total, term)
            lost = lost + error
            (x, y, z, p), lows = _shifted((x, y, z, p), lows)
        else:
            total = total + term
            x, y, z, p = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4, (p + shift) / 4
        weight, spread = weight / 4, spread / 4
        mean = (x + y + z + 2 * p) / 5
    rest = _near_mean(ar, 1 - x / mean, 1 - y / mean, 1 - z / mean) / (mean * ar.sqrt(mean))
    if not ar.everywhere(~unequal if ar.is_array else not unequal):
        rest[unequal] = _duplicated(ar, (x[unequal], y[unequal], z[unequal], p[unequal]), gain)
    return total + (rest * weight + lost)


def _far_apart(ar: FunctionArithmetic, arguments: Roots) -> Any:
    """Return where some arguments, other than zeros, are many decades apart."""
    some = (ar.where(x == 0, math.inf, x) for x in arguments)
    least = reduce(lambda a, b: ar.where(a < b, a, b), some)
    return least * _FAR_APART < sum(arguments)


def _shifted(highs: Roots, lows: list[Array]) -> tuple[Roots, list[Array]]:
    """Return the arguments of the next step from arguments in pairs of doubles, as such pairs."""
    from ..arithmetic.double_double import sqrt_pair, two_product, two_sum

    shift, low = 0 * highs[0], 0 * highs[0]
    roots = [sqrt_pair(high, rest) for high, rest in zip(highs[:3], lows[:3], strict=True)]
    for (a, a_low), (b, b_low) in combinations(roots, 2):
        product, error = two_product(a, b)
        shift, lost = two_sum(shift, product)
        low = low + (error + lost + (a * b_low + b * a_low))
    sums = [two_sum(high, shift) for high in highs]
    rests = [(error + rest + low) / 4 for (_, error), rest in zip(sums, lows, strict=True)]
    pairs = [two_sum(total / 4, rest) for (total, _), rest in zip(sums, rests, strict=True)]
    x, y, z, p = (high for high, _ in pairs)
    return (x, y, z, p), [rest for _, rest in pairs]


def _mostly(ar: FunctionArithmetic, condition: Any) -> bool:
    """Return whether a condition holds, or holds for half of the elements of an array."""
    return 2 * condition.sum() > condition.size if ar.is_array else bool(condition)


def _near_mean(ar: FunctionArithmetic, dx: Value, dy: Value, dz: Value) -> Value:
    """Return the Taylor series of R_J about equal arguments, to seventh order (DLMF 19.36.2).

    What it leaves out, as in `carlson_rf` with 3/2 and 5/2 for 1/2 and 3/2: terms of at most r^n
    (3/2)_n/n!, 3.4 r^8 for n = 8 and then each at most 19 r/18 of the one before, so that all are
    at most 4 r^8/(1 - 2 r).
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
