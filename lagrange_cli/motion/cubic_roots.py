"""Roots of the cubic (4,9): the largest one by proof, and the other two from it."""

from __future__ import annotations

from decimal import Decimal
from typing import TYPE_CHECKING

from ..arithmetic.ball import Ball, TooFewDigitsError
from ..arithmetic.balls import Balls
from ..arithmetic.decimals import Decimals, decimals
from ..arithmetic.numbers import R

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic


def two_roots(ar: Arithmetic[R], total: R, product: R) -> tuple[R, R]:
    """Return the roots x1 >= 0 >= x2 of x^2 - total x + product, for product <= 0."""
    upward = ar.either(total >= 0)  # next to 0 nothing cancels in either
    larger = (ar.where(upward, total, -total) + ar.sqrt(total * total - 4 * product)) / 2
    smaller = -product / larger
    return ar.where(upward, larger, smaller), -ar.where(upward, smaller, larger)


def largest_root(ar: Balls, c2: Ball, c1: Ball, c0: Ball, above: Ball) -> Ball:
    """Return a ball that holds the largest root of x^3 + c2 x^2 + c1 x + c0, whose roots are real.

    Some root is within 3 |f/f'| of any point p, because f'/f is the sum of 1/(p - root).  If f' and
    f'' are positive in this ball X around p, they are so beyond it: X holds the largest root alone.
    Newton's step p - f(p)/f'(X) then holds it too, by the mean value theorem.  Raises
    TooFewDigitsError if these digits do not prove it.
    """

    def cubic(x: Ball) -> Ball:
        return ((x + c2) * x + c1) * x + c0

    def slope(x: Ball) -> Ball:
        return (3 * x + 2 * c2) * x + c1

    middles = (x.middle for x in (c2, c1, c0, above))
    point = ar.exact(near_largest_root(decimals(ar.digits), *middles))
    around = point.enlarged((3 * cubic(point) / slope(point)).greatest)
    if not (slope(around) > 0 and 3 * around + c2 > 0):
        raise TooFewDigitsError
    return point - cubic(point) / slope(around)


def near_largest_root(
    ar: Decimals, c2: Decimal, c1: Decimal, c0: Decimal, above: Decimal
) -> Decimal:
    """Return a point next to the largest root of x^3 + c2 x^2 + c1 x + c0, all of them real.

    Laguerre's method falls to it from a point above, three times as many digits at each step, but
    for a double root.
    """
    with ar.working():
        x, least = above, 1000 * ar.eps
        for _ in range(4 * ar.digits):
            value, slope = ((x + c2) * x + c1) * x + c0, (3 * x + 2 * c2) * x + c1
            curved = max(4 * slope * slope - 12 * value * (3 * x + c2), Decimal(0))
            divisor = slope + curved.sqrt()
            step = 3 * value / divisor if divisor else divisor
            x -= step
            if not step > least * abs(x):
                break
        return x
