"""Angles of many tops at once, in doubles, by SciPy's elliptic functions.

A state is (a, b, theta0, thetadot0, psidot0), with a = 2mgs/A (4,4) and b = C r0/A (4,5).  The spin
angle here is that of a body with C = A, whose r0 is b; another body adds (r0 - b) t.  The angles
are exact to about 1e-11 rad away from the separatrix, far below the noise of any recording.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ellipj, ellipk, ellipkinc, elliprj

from ..arithmetic.types import Array

STATE = ("a", "b", "theta0", "thetadot0", "psidot0")
_TINY = 1e-30


@np.errstate(all="ignore")
def gaps_of(states: Array) -> tuple[Array, Array, Array]:
    """Return u1 - u, u - u2 and u3 - u for states of shape (tops, 5), each of shape (tops, 1).

    The roots of the cubic (4,9) are u2 < u1 < u3, and u = cos(theta0) is the start.  The cubic in
    x = u' - u, divided by a, is x^3 + c2 x^2 + c1 x + c0 with c0 >= 0.  Its largest root is
    Viete's; the other two have the product -c0/x3 and a sum that follows from c1.
    """
    a, b, theta, theta_rate, psi_rate = states.T[..., np.newaxis]
    u, sine = np.cos(theta), np.sin(theta)
    along = psi_rate * sine * sine
    kinetic = theta_rate**2 + along * psi_rate
    c0 = (sine * theta_rate) ** 2 / a
    c1 = 2 * (b * along - u * kinetic) / a - sine * sine
    c2 = 2 * u - (kinetic + b * b) / a
    radius = np.sqrt(np.maximum(c2 * c2 - 3 * c1, 0)) / 3
    turned = (c1 * c2 / 6 - (c2 / 3) ** 3 - c0 / 2) / (radius**3 + _TINY)
    third = 2 * radius * np.cos(np.arccos(np.clip(turned, -1, 1)) / 3) - c2 / 3
    for _ in range(3):  # Newton's method
        slope = (3 * third + 2 * c2) * third + c1
        third = third - (((third + c2) * third + c1) * third + c0) / slope
    product = c0 / third
    half = (c1 + product) / (2 * third)
    larger = np.abs(half) + np.sqrt(half * half + product) + _TINY
    smaller = product / larger
    rising = half > 0
    return np.where(rising, larger, smaller), np.where(rising, smaller, larger), third


@np.errstate(all="ignore")
def angles(states: Array, t: Array) -> Array:
    """Return theta, phi and psi at times t, shape (3, tops, times); NaN if a state has no motion.

    The angles phi and psi begin at 0 and grow without jumps.  With N = beta - b and S = beta + b,
    2 psi' = S/(1 + u) + N/(1 - u) and 2 phi' = S/(1 + u) - N/(1 - u).
    """
    a, b, theta, theta_rate, psi_rate = states.T[..., np.newaxis]
    u, sine = np.cos(theta), np.sin(theta)
    above, below, third = gaps_of(states)
    swing, width = above + below, below + third
    m, speed = swing / width, np.sqrt(a * width) / 2
    quarter = ellipk(m)
    first = np.arctan2(np.sqrt(below), np.sqrt(above))
    first = np.where(theta_rate > 0, -first, first)
    begin = ellipkinc(first, m)
    argument = begin + speed * t
    periods = np.round(argument / (2 * quarter))
    argument = argument - 2 * quarter * periods
    sn, _, _, phase = ellipj(argument, m)
    down, up = 2 * np.sin(theta / 2) ** 2, 2 * np.cos(theta / 2) ** 2  # 1 - u and 1 + u
    momenta = psi_rate * sine**2 + b * np.stack([-down, up])  # N and S
    # 1 - u1 and 1 + u2 may be tiny: the cubic at u = 1 and -1 gives them without a difference
    beyond = np.stack([(down + below) * (third - down), (up + above) * (third + up)])
    near_north, near_south = momenta**2 / (a * beyond) + _TINY
    at_u2, at_u1 = np.stack([down + below, near_south]), np.stack([near_north, up + above])
    n = np.stack([swing, -swing]) / at_u2
    at_end, at_start, at_quarter = (
        third_kind(x, y, m, n, at_u1 / at_u2)
        for x, y in ((phase, argument), (first, begin), (np.pi / 2, quarter))
    )
    grown = at_end - at_start + 2 * periods * at_quarter
    north, south = momenta / at_u2 * grown / (2 * speed)
    tilt = np.arccos(np.clip(u - below + swing * sn * sn, -1, 1))
    return np.stack([tilt, south - north, south + north])


def third_kind(phase: Array | float, first_kind: Array, m: Array, n: Array, rest: Array) -> Array:
    """Return the integral of 1/((1 - n sin^2) sqrt(1 - m sin^2)) up to |phase| <= pi/2.

    Rest is 1 - n > 0, and `first_kind` the integral of the first kind, without the factor with n.
    Carlson's R_J gives the difference.
    """
    s, x = np.sin(phase), np.cos(phase) ** 2
    found: Array = first_kind + n / 3 * s**3 * elliprj(x, 1 - m * s * s, 1.0, x + rest * s * s)
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
    width = north2 * (1 + height)
    m = (u1 - u2) / width
    quarter = ellipk(m)
    a = (4 * quarter / period) ** 2 / width
    south = signs[0] * np.sqrt(a * (1 + u1) * (1 + u2) * (2 + north2 * height))
    north = signs[1] * np.sqrt(a * north1 * north2 * north2 * height)
    ends = (south, u2 - u1, 1 + u1, 1 + u2), (north, u1 - u2, north1, north2)
    grown = sum(p / y * third_kind(np.pi / 2, quarter, m, dx / y, x / y) for p, dx, x, y in ends)
    return a, (south - north) / 2, (south + north) / 2, grown / (2 * quarter)
