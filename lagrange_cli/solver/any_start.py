"""The gaps of a top that does not start at rest: the roots of the cubic (4,9) as distances.

Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..arithmetic.ball import Ball, Balls, TooFewDigitsError
from ..arithmetic.numbers import Arithmetic, R
from .gaps import Gaps, State, zero_gaps
from .regime import Facts

FindRoot = Callable[..., R]
"""A function of an arithmetic, c2, c1, c0 and an upper bound; see `gaps_from_start`."""


def gaps_from_start(
    ar: Arithmetic[R], start: State[R], facts: Facts, find_root: FindRoot[R] | None = None
) -> Gaps[R]:
    """Return the gaps of any start.

    In x = u - u0 the cubic (4,9) is a x^3 + c2 x^2 + c1 x + c0.  Its largest root times a is D = a
    (u3 - u0).  The other two roots solve a quadratic equation whose discriminant is a sum of
    positive terms.  A gap that is exactly 0 is set to 0.  `find_root` (default: `largest_root`)
    returns the largest root of x^3 + c2 x^2 + c1 x + c0 from c2, c1, c0 and an upper bound.
    """
    a, b, u0, above, below = start.a, start.b, start.cos, start.above, start.below
    zero = 0 * u0
    momentum, (c0, c1, c2) = start.momentum, cubic(start)
    a_c0 = a * c0
    separatrix = facts.regime == "separatrix"
    if separatrix or facts.upper_root == 3:
        D = a * above
    elif facts.steady:
        D = -c2
    else:
        solver: Any = find_root or largest_root
        D = solver(ar, c2, a * c1, a * a_c0, start.energy + b * b + 2 * a)
    if facts.steady:
        x1, x2 = zero, zero
    elif separatrix:
        x1, x2 = above, -c0 / (D * above)
    else:
        x1, x2 = two_roots(ar, (c1 + a_c0 / D) / D, -c0 / D)
    x1 = above if facts.upper_root == 1 else x1
    x2 = -below if facts.over_bottom else x2
    gaps = Gaps(
        u1_u=x1,
        u_u2=-x2,
        u1_u2=x1 - x2,
        below_u1=below + x1,
        below_u2=below + x2,
        above_u1=above - x1,
        above_u2=above - x2,
        a_u3_u=D,
        a_u3_u1=D - a * x1,
        a_u3_u2=D - a * x2,
        a_u3_above=D - a * above,
        a_below_u3=D + a * below,
        momentum_u1=momentum - b * x1,
        momentum_u2=momentum - b * x2,
        beta_plus_b=below * (start.psi_rate * above + b),
        beta_minus_b=above * (start.psi_rate * below - b),
    )
    return gaps._replace(**dict.fromkeys(zero_gaps(facts), zero))


def cubic(start: State[R]) -> tuple[R, R, R]:
    """Return c0, c1, c2 of the cubic (4,9), a x^3 + c2 x^2 + c1 x + c0 in x = u - u0."""
    a, b, u0, energy = start.a, start.b, start.cos, start.energy
    along = start.sin * start.theta_rate
    c1 = 2 * b * start.momentum - a * start.sin * start.sin - 2 * u0 * energy
    return along * along, c1, 2 * a * u0 - energy - b * b


def two_roots(ar: Arithmetic[R], total: R, product: R) -> tuple[R, R]:
    """Return the roots x1 >= 0 >= x2 of x^2 - total x + product, for product <= 0."""
    upward = ar.either(total >= 0)  # next to 0 no digits cancel in either
    larger = (ar.where(upward, total, -total) + ar.sqrt(total * total - 4 * product)) / 2
    smaller = -product / larger
    return ar.where(upward, larger, smaller), -ar.where(upward, smaller, larger)


def largest_root(ar: Balls, c2: Ball, c1: Ball, c0: Ball, above: Ball) -> Ball:
    """Return a ball with the largest root of x^3 + c2 x^2 + c1 x + c0, whose roots are real.

    Laguerre's method descends to the root from a point `above`.  Each step triples the number of
    correct digits, except at a double root.

    Some root is within 3 |f/f'| of any point p, because f'/f is the sum of 1/(p - root).  If f' and
    f'' are positive in this ball X around p, they are positive above it too: X contains the largest
    root and no other.  By the mean value theorem, Newton's step p - f(p)/f'(X) then contains the
    root too.  Raises TooFewDigitsError if the working digits do not prove it.
    """

    def cubic(x: Ball) -> Ball:
        return ((x + c2) * x + c1) * x + c0

    def slope(x: Ball) -> Ball:
        return (3 * x + 2 * c2) * x + c1

    point, least = above.middle, 1000 * ar.eps
    for _ in range(4 * ar.digits):
        value, down = cubic(point), slope(point)
        step = (
            3 * value / (down + ar.sqrt(4 * down * down - 12 * value * (3 * point + c2)))
        ).middle
        point = (point - step).middle
        if (step > least * abs(point)) is not True:
            break
    away = (3 * cubic(point) / slope(point)).greatest
    around = ar.between(point - away, point + away)
    if not (slope(around) > 0 and 3 * around + c2 > 0):
        raise TooFewDigitsError
    return point - cubic(point) / slope(around)
