"""Gaps of many motions: distances between the roots of the cubic (4,9), the poles and the start.

The cubic is a x^3 + c2 x^2 + c1 x + c0 in x = u - u0.  Its largest root X = a (u3 - u0) leaves a
quadratic with a negative last coefficient, so that its discriminant is a sum, and its smaller root
is a quotient.  Distances to a pole are differences, or quotients by f(1) = -(beta - b)^2 and
f(-1) = -(beta + b)^2.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.bounded import EPS, LOST, Bounded, best, choose, known, relative_errors, sqrt
from ..arithmetic.pairs import DoubleDouble

_RELEASED, _FROM_PAIRS = 64 * EPS, 8 * EPS
"""Relative errors up to which the gaps of tops are good enough, released ones and others."""
_NEWTON_STEPS, _STEPS_IN_PAIRS = 100, 2


class Gaps(NamedTuple):
    """Distances between the roots u2 <= u1 <= 1 <= u3 of (4,9), the poles and the start u0."""

    rise: Bounded  # u1 - u0
    fall: Bounded  # u0 - u2
    far: Bounded  # a (u3 - u0)
    above_u1: Bounded  # 1 - u1
    above_u2: Bounded
    below_u1: Bounded  # 1 + u1
    below_u2: Bounded
    a_above_u3: Bounded  # a (u3 - 1)


def gaps_of(of: Any) -> Gaps:
    """Return the gaps of motions that nutate, or keep their tilt, from their `ArrayNumbers`."""
    if of.finer:
        return Gaps(*(known(x.rounded(), _FROM_PAIRS) for x in of.finer["gaps"]))
    a, b, u0, above, below = (of[x] for x in ("a", "b", "u0", "above_u0", "below_u0"))
    sine, zero = of["theta0"][0], Bounded(0.0, positive=True)
    if of.steady:
        around = of["psidot0"] * sine
        far = _root(of, around * around + of["square_of_steady"])
        return Gaps(zero, zero, far, above, above, below, below, far - a * above)
    if of.plane:
        return _gaps_of_pendulums(of)
    if of.regime is None:
        return _gaps_of_any_start(of)
    # u0 is a root: the others are those of X^2 - 2 half X - (a sin)^2 in X = a (u - u0)
    half, a_sine, square = 0.5 * (b * b) - a * u0, a * sine, b * b
    more = sqrt(half * half + a_sine * a_sine) + abs(half)
    far = _root(of, choose(half.doubles >= 0, more, a_sine * a_sine / more))
    fall = a_sine * sine / far
    above_u2, below_u2 = above + fall, square * below / (far + a * below)
    a_above_u3 = square * above / above_u2
    return Gaps(zero, fall, far, above, above_u2, below, below_u2, a_above_u3)


def _gaps_of_pendulums(of: Any) -> Gaps:
    """Return the gaps if b = beta = 0: two roots are -1 and 1, and `over` is a (u - 1) at the
    third one, u."""
    a, above, below, swing = (of[x] for x in ("a", "above_u0", "below_u0", "swing"))
    zero, two = Bounded(0.0, positive=True), Bounded(2.0, positive=True)
    turns, past = of.over_top, _root(of, abs(of["over"]))
    return Gaps(
        rise=choose(turns, above, swing / a),
        fall=below,
        far=choose(turns, swing, a * above),
        above_u1=choose(turns, zero, past / a),
        above_u2=two,
        below_u1=choose(turns, two, below + swing / a),
        below_u2=zero,
        a_above_u3=choose(turns, past, zero),
    )


def _root(of: Any, x: Bounded) -> Bounded:
    return x if of.pairs else known(x, _RELEASED)


def _gaps_of_any_start(of: Any) -> Gaps:
    """Return the gaps from the cubic in u - u0 or, next to the separatrix, in 1 - u."""
    a, b, u0, above, below = (of[x] for x in ("a", "b", "u0", "above_u0", "below_u0"))
    sine, momentum = of["theta0"][0], of["momentum"]
    north, south = of["beta_minus_b"], of["beta_plus_b"]
    around, along = of["psidot0"] * sine, sine * of["thetadot0"]
    energy, square = of["thetadot0"] * of["thetadot0"] + around * around, along * along
    c1 = 2.0 * (b * momentum - u0 * energy) - a * (sine * sine)
    far, rise, fall = roots_of_cubic(a, 2.0 * (a * u0) - energy - b * b, c1, square)
    below_u1, above_u2 = below + rise, above + fall
    a_above_u3 = far - a * above
    above_u1 = best(above - rise, lambda: north * north / (above_u2 * a_above_u3))
    a_above_u3 = best(a_above_u3, lambda: north * north / (above_u1 * above_u2))
    below_u2 = best(below - fall, lambda: south * south / (below_u1 * (far + a * below)))
    found = Gaps(rise, fall, far, above_u1, above_u2, below_u1, below_u2, a_above_u3)
    lost = ~(relative_errors(above_u1) + relative_errors(a_above_u3) <= LOST)
    if not lost.any():
        return found
    past = energy - a * above  # alpha - a
    c1 = 2.0 * (b * north - past)
    wide, above_u1, past_pole = roots_of_cubic(a, past + b * b - 2.0 * a, c1, north * north)
    above_u2, a_above_u3 = wide / a, a * past_pole
    far, rise, fall = a_above_u3 + a * above, above - above_u1, above_u2 - above
    rise = best(rise, lambda: square / (far * fall))
    fall = best(fall, lambda: square / (far * rise))
    below_u1 = 2.0 - above_u1
    below_u2 = best(2.0 - above_u2, lambda: south * south / (below_u1 * (far + a * below)))
    other = Gaps(rise, fall, far, above_u1, above_u2, below_u1, below_u2, a_above_u3)
    lost &= relative_errors(a_above_u3) <= relative_errors(found.a_above_u3)
    return Gaps(*(choose(lost, y, x) for x, y in zip(found, other, strict=True)))


def roots_of_cubic(
    a: Bounded, c2: Bounded, c1: Bounded, c0: Bounded
) -> tuple[Bounded, Bounded, Bounded]:
    """Return a X, Y and Z from a x^3 + c2 x^2 + c1 x + c0 with c0 >= 0 and the roots X, Y and -Z,
    where X is the largest, and Y and Z are not negative.
    """
    largest = largest_root(c2, a * c1, a * (a * c0))
    total, product = (c1 + a * c0 / largest) / largest, c0 / largest
    larger = (abs(total) + sqrt(total * total + 4.0 * product)) * 0.5
    smaller = product / larger
    upward = total.doubles >= 0
    return largest, choose(upward, larger, smaller), choose(upward, smaller, larger)


def largest_root(c2: Bounded, c1: Bounded, c0: Bounded) -> Bounded:
    """Return the largest root of X^3 + c2 X^2 + c1 X + c0 with c0 >= 0, which has three real ones.

    Newton's method descends to it from the larger root of X^2 + c2 X + c1, where the cubic is c0.
    If f' changes by at most 1 % within 2 |f/f'|, the root is within 1.01 |f/f'|.
    """
    b2, b1, b0 = c2.doubles, c1.doubles, c0.doubles
    x = 0.5 * (np.sqrt(np.maximum(b2 * b2 - 4 * b1, 0.0)) - b2)
    x = np.where(b2 < 0, x, np.maximum(x, b1 / np.minimum(-b2 - x, -1e-300))) * (1 + 2.0**-24)
    going = np.ones(x.shape, dtype=np.bool_)  # until the step of a top itself is small
    for _ in range(_NEWTON_STEPS):
        slope = (3 * x + 2 * b2) * x + b1
        step = (((x + b2) * x + b1) * x + b0) / slope
        x = np.where(going & (slope > 0), x - step, x)
        going &= abs(step) > 1e-9 * x
        if not going.any():
            break
    pairs = isinstance(c2.value, DoubleDouble)
    root: Any = DoubleDouble(x) if pairs else x
    for _ in range(_STEPS_IN_PAIRS if pairs else 1):
        value = ((root + c2.value) * root + c1.value) * root + c0.value
        root = root - value / ((3 * x + 2 * b2) * x + b1)
        x = Bounded(root).doubles
    exact = Bounded(root)
    value = ((exact + c2) * exact + c1) * exact + c0
    slope = (3 * x + 2 * b2) * x + b1
    of_slope = ((3 * x + 2 * abs(b2)) * x + abs(b1)) * 2.0**-49 + 2 * c2.error * x + c1.error
    error = (value.size + value.error) / slope
    changes = 2 * error * (6 * x + 2 * abs(b2) + 12 * error) + of_slope
    certain = (slope > 0) & (changes <= 0.01 * slope)
    return Bounded(root, np.where(certain, 1.02 * error, np.inf), positive=True)
