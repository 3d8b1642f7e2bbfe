"""The closed form in plain doubles, for many tops at once, as well as doubles allow.

A state is (a, b, sine, cosine, p, q): a = 2mgs/A (4,4), b = C r0/A (4,5), the sine and cosine of
half the tilt, and the rates p = theta' and q = psi' sin(theta) about the line of nodes and across
it.  Nothing in it is singular if the axis starts upright.  The spin angle is that of a body with
C = A, whose r0 is b; another body adds (r0 - b) t.

No number here is a difference of close numbers, except where the state itself is one: next to a
steady precession, and next to the unstable upright position.  Angles are in error by some roundings
of the phase, so that errors grow with the number of periods.  SciPy's `ellipj` takes m = k^2, which
is 1 next to the separatrix: there sn and cn are counted from the nearer quarter period.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipj, ellipkm1, elliprc, elliprf, elliprj

from ..arithmetic.types import Array

_TINY = 1e-30


def states_of(
    a: ArrayLike, b: ArrayLike, theta: ArrayLike, theta_rate: ArrayLike, psi_rate: ArrayLike
) -> Array:
    """Return states of shape (..., 6) from tilts and rates of any common shape."""
    half = np.asarray(theta) / 2
    sine = np.sin(theta)
    columns = a, b, np.sin(half), np.cos(half), theta_rate, np.multiply(psi_rate, sine)
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


@np.errstate(all="ignore")
def gaps_of(states: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return u1 - u, u - u2, 1 - u1, u3 - 1 and u3 - u1 for states of shape (tops, 6).

    Each has the shape (tops, 1).  The roots of the cubic (4,9) are u2 < u1 < u3, and u = cos(theta)
    is the start.  The cubic in x = u' - u, divided by a, is x^3 + c2 x^2 + c1 x + c0 with c0 >= 0.
    The root that lies apart from the other two is Viete's.  If it is u3, the other two have the
    product -c0/x and a sum that follows from c1.  The distances 1 - u1 and u3 - 1 have the product
    (beta - b)^2/(a (1 - u2)), by f(1), and a difference that follows from f'(1).
    """
    a, b, half_sine, half_cosine, p, q = states.T[..., np.newaxis]
    down, sine = 2 * half_sine**2, 2 * half_sine * half_cosine
    u = (half_cosine - half_sine) * (half_cosine + half_sine)
    kinetic, north = p * p + q * q, _passing(q * sine - b * down, a)
    c0 = (sine * p) ** 2 / a
    c1 = 2 * (b * q * sine - u * kinetic) / a - sine * sine
    c2 = 2 * u - (kinetic + b * b) / a
    radius = np.sqrt(np.maximum(c2 * c2 - 3 * c1, 0)) / 3
    turned = (c1 * c2 / 6 - (c2 / 3) ** 3 - c0 / 2) / (radius**3 + _TINY)
    angle, is_far = np.arccos(np.clip(turned, -1, 1)) / 3, turned > 0  # u3 lies apart, or u2
    x = 2 * radius * np.cos(np.where(is_far, angle, angle + 2 * np.pi / 3)) - c2 / 3
    for _ in range(4):  # Newton's method
        x = x - (((x + c2) * x + c1) * x + c0) / ((3 * x + 2 * c2) * x + c1)
    above, below = _pair((c1 + c0 / x) / (2 * x), c0 / x)
    below = np.where(is_far, below, -x)
    y2 = down + below
    product = north**2 / (a * y2)
    over, y1 = _pair((((kinetic - b * north) / a - down) - product / 2) / y2, product)
    apart = np.where(y1 < down / 2, down - y1, c0 / (below * (down + over)))
    return np.where(is_far, above, apart), below, y1, over, over + y1


def _passing(momentum: Array, a: Array) -> Array:
    """Return beta - b or beta + b; instead of 0, a number so small that the axis meets the pole."""
    return np.where(momentum == 0, 1e-18 * np.sqrt(a), momentum)


def _pair(half: Array, product: Array) -> tuple[Array, Array]:
    """Return the two numbers >= 0 with the difference 2 half and a product."""
    larger = np.abs(half) + np.sqrt(half * half + product) + _TINY
    smaller = product / larger
    return np.where(half > 0, larger, smaller), np.where(half > 0, smaller, larger)


@np.errstate(all="ignore")
def angles(states: Array, t: Array) -> Array:
    """Return theta, phi and psi at times t, shape (3, tops, times); NaN if a state has no motion.

    The angles phi and psi begin at 0 and grow without jumps, except over a pole.  With N = beta - b
    and S = beta + b, 2 psi' = S/(1 + u) + N/(1 - u) and 2 phi' = S/(1 + u) - N/(1 - u).  A start on
    the vertical has the angles of the limit after it, or before it if the axis leaves 0 to 180
    degrees.
    """
    a, b, half_sine, half_cosine, p, q = states.T[..., np.newaxis]
    above, below, y1, over, gap = gaps_of(states)
    down, up, sine = 2 * half_sine**2, 2 * half_cosine**2, 2 * half_sine * half_cosine
    momenta = _passing(q * sine + b * np.stack([-down, up]), a)  # N and S
    y2, z1, swing = down + below, up + above, above + below  # 1 - u2, 1 + u1, u1 - u2
    width = y2 + over
    z2 = momenta[1] ** 2 / (a * z1 * (2 + over))  # 1 + u2, by the cubic at u = -1
    m, rest, speed = swing / width, gap / width, np.sqrt(a * width) / 2
    quarter = ellipkm1(rest)
    s, c = np.where(p > 0, -1.0, 1.0) * np.sqrt(below / swing), np.sqrt(above / swing)
    begin = s * np.where(c == 0, quarter, elliprf(c * c, c * c + rest * s * s, 1.0))
    argument = begin + speed * t
    periods = np.round(argument / (2 * quarter))
    argument = argument - 2 * quarter * periods
    late = np.abs(argument) > quarter / 2  # sn and cn from the nearer quarter period
    sn, cn, dn, _ = ellipj(np.where(late, quarter - np.abs(argument), argument), m)
    sn, cn = (
        np.where(late, np.sign(argument) * cn / dn, sn),
        np.where(late, np.sqrt(rest) * sn / dn, cn),
    )
    at_u2, at_u1 = np.stack([y2, z2]), np.stack([y1, z1])
    n, ratio = np.stack([swing, -swing]) / at_u2, at_u1 / at_u2
    at_end, at_start, at_quarter = (
        third_kind((x, y), first, (m, rest), n, ratio)
        for x, y, first in ((sn, cn, argument), (s, c, begin), (1.0, 0.0, quarter))
    )
    grown = at_end - at_start + 2 * periods * at_quarter
    north, south = momenta / at_u2 * grown / (2 * speed)
    pole = np.where(down == 0, 1.0, np.where(up == 0, -1.0, 0.0))
    turn = np.where(t == 0, 0.0, -np.sign(pole * p) * np.pi / 2)  # half of the jump over the pole
    tilt = 2 * np.arctan2(np.sqrt(y1 + swing * cn * cn), np.sqrt(z2 + swing * sn * sn))
    return np.stack([tilt, south - north - pole * turn, south + north + turn])


def third_kind(
    sine: tuple[ArrayLike, ArrayLike],
    first_kind: Array,
    m: tuple[Array, Array],
    n: Array,
    rest: Array,
) -> Array:
    """Return the integral of 1/((1 - n sin^2) sqrt(1 - m sin^2)) up to an angle.

    `sine` is its sine and cosine, `m` is m and 1 - m, rest is 1 - n > 0, and `first_kind` the
    integral without the factor with n.  Carlson's R_J gives the difference.  If n < 0, the change
    of parameter DLMF 19.21.12 makes all terms positive.
    """
    s, c = map(np.asarray, sine)
    squared, x = np.square(s), np.square(c)
    y, end = x + m[1] * squared, x + rest * squared
    excess = np.where(n < 0, m[0] * squared / np.where(n < 0, -n, 1.0), 0.0)
    difference = elliprj(x, y, 1.0, np.where(n < 0, 1.0 + excess, end)) / 3
    found: Array = np.where(
        n < 0,
        s * (elliprc(x * y, end * (1.0 + excess)) + excess * difference),
        first_kind + n * s * squared * difference,
    )
    return found


@np.errstate(all="ignore")
def nutating(
    least: Array, greatest: Array, period: float, height: Array, signs: tuple[int, int]
) -> tuple[Array, Array, Array, Array]:
    """Return the tops with turning points at two tilts, in radians, and u3 = 1 + height (1 - u2).

    They are a, b, the momentum beta = psi' sin^2(theta) + b cos(theta), and the mean precession.
    `signs` are those of S = beta + b and N = beta - b.  The cubic (4,9) at u = 1 and -1 gives their
    squares, and (4,19) with (5,1) gives a.  Arguments broadcast.
    """
    u1, u2 = np.cos(least), np.cos(greatest)
    north1, north2 = 2 * np.sin(least / 2) ** 2, 2 * np.sin(greatest / 2) ** 2
    swing, width = u1 - u2, north2 * (1 + height)
    m, rest = swing / width, (north1 + north2 * height) / width
    quarter = ellipkm1(rest)
    a = (4 * quarter / period) ** 2 / width
    south = signs[0] * np.sqrt(a * (1 + u1) * (1 + u2) * (2 + north2 * height))
    north = signs[1] * np.sqrt(a * north1 * north2 * north2 * height)
    ends = (south, -swing, 1 + u1, 1 + u2), (north, swing, north1, north2)
    grown = sum(
        p / y * third_kind((1.0, 0.0), quarter, (m, rest), dx / y, x / y) for p, dx, x, y in ends
    )
    return a, (south - north) / 2, (south + north) / 2, grown / (2 * quarter)
