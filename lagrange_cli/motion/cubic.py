"""The cubic (4,9) of any start: its coefficients, and its roots in many digits.

Apart from `roots`, which the paper's case needs alone and `lagtop solve` loads at every start-up.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from ..arithmetic.generic import Arithmetic, Real, number
from ..inputs.top import Top
from .roots import Roots, invariants


class Start(NamedTuple):
    """The state at t = 0 and the constants of the motion, for a general start."""

    a: Real
    b: Real
    r0: Real
    psi_rate: Real
    theta_rate: Real
    u: Real
    """cos(theta0)."""
    alpha: Real
    """thetadot0^2 + psidot0^2 sin^2 theta0 + a cos theta0 (4,4): energy without the spin's."""
    beta: Real
    """psidot0 sin^2 theta0 + b cos theta0 (4,5): angular momentum about the vertical, over A."""
    beta_plus_b: Real
    beta_minus_b: Real
    drift: Real
    """r0 - b, the spin rate less what the poles add to it."""


def start(ar: Arithmetic, top: Top) -> Start:
    """The start of a top, whatever its rates (ar: an mpmath context with digits to spare)."""
    inv, tilt = invariants(ar, top), top.tilt(ar)
    theta_rate, psi_rate = number(ar, top.thetadot0), number(ar, top.psidot0)
    around = psi_rate * tilt.sin
    beta = around * tilt.sin + inv.b * tilt.cos
    return Start(
        a=inv.a,
        b=inv.b,
        r0=number(ar, top.r0),
        psi_rate=psi_rate,
        theta_rate=theta_rate,
        u=tilt.cos,
        alpha=theta_rate**2 + around**2 + inv.a * tilt.cos,
        beta=beta,
        beta_plus_b=beta + inv.b,
        beta_minus_b=beta - inv.b,
        drift=number(ar, top.r0) - inv.b,
    )


class Place(NamedTuple):
    """Gaps between u at t = 0 and the roots."""

    u1_u: Real
    u_u2: Real
    u3_u: Real
    """1 without torque, as in `Roots`."""
    momentum_u1: Real
    """beta - b u of (4,7) at u1."""
    momentum_u2: Real
    """And at u2."""


def roots_from_start(ar: Arithmetic, begin: Start) -> tuple[Roots, Place]:
    """Roots of (4,9) for a general start, and where among them it lies.

    The gaps are differences, and those below a third of the digits are taken for exact zeros (a
    double root comes out split by half of them): the context must have digits to spare.
    """
    u3 = None
    if begin.a == 0:
        u2, u1 = _quadratic_roots(ar, begin)
    else:
        u2, u1, u3 = _cubic_roots(ar, begin)
    to_u3 = ar.mpf(1) if u3 is None else _gap(ar, u3, begin.u)
    momenta = (begin.beta - begin.b * u for u in (u1, u2))
    place = Place(_gap(ar, u1, begin.u), _gap(ar, begin.u, u2), to_u3, *momenta)
    return _gaps(ar, u1, u2, u3), place


def _quadratic_roots(ar: Arithmetic, begin: Start) -> tuple[Real, Real]:
    """Without torque: (alpha + b^2) u^2 - 2 beta b u + beta^2 - alpha = 0."""
    alpha, beta, b = begin.alpha, begin.beta, begin.b
    total = alpha + b * b
    if not total:  # nothing moves
        return begin.u, begin.u
    radical = ar.sqrt(max(alpha * (total - beta * beta), 0 * alpha))
    return (beta * b - radical) / total, (beta * b + radical) / total


def _cubic_roots(ar: Arithmetic, begin: Start) -> list[Real]:
    """u^3 - c2 u^2 + c1 u - c0 = 0, one root split off, the other two by the quadratic formula."""
    a, b, alpha, beta = begin.a, begin.b, begin.alpha, begin.beta
    c2, c1, c0 = (alpha + b * b) / a, 2 * b * beta / a - 1, (beta * beta - alpha) / a
    root = _lowest_root(ar, c2, c1, c0) if begin.theta_rate else begin.u
    middle = (c2 - root) / 2
    radical = ar.sqrt(max(middle * middle - c1 + root * (c2 - root), 0 * root))
    upper = middle + radical
    lower = (c1 - root * (c2 - root)) / upper if middle > 0 else middle - radical
    return sorted([root, lower, upper])


def _lowest_root(ar: Arithmetic, c2: Real, c1: Real, c0: Real) -> Real:
    """Newton's method from u = -1, below all three roots, where it is monotonic."""
    u = ar.mpf(-1)
    for _ in range(100 * ar.dps):
        value = ((u - c2) * u + c1) * u - c0
        slope = (3 * u - 2 * c2) * u + c1
        following = u - value / slope if slope > 0 else u
        if not following > u:
            return u
        u = following
    raise AssertionError("Newton's method did not settle")


def _gap(ar: Arithmetic, larger: Real, smaller: Real) -> Real:
    difference = larger - smaller
    tiny = ar.mpf(10) ** (-(ar.dps // 3)) * max(abs(larger), 1)
    return difference if difference > tiny else ar.mpf(0)


def _gaps(ar: Arithmetic, u1: Real, u2: Real, u3: Real | None) -> Roots:
    gap, one = partial(_gap, ar), ar.mpf(1)
    return Roots(
        u1=u1,
        u2=u2,
        u3=u3,
        u1_u2=gap(u1, u2),
        u3_u1=one if u3 is None else gap(u3, u1),
        u3_u2=one if u3 is None else gap(u3, u2),
        below_u1=gap(u1, -one),
        below_u2=gap(u2, -one),
        below_u3=one if u3 is None else gap(u3, -one),
        above_u1=gap(one, u1),
        above_u2=gap(one, u2),
        u3_above=one if u3 is None else gap(u3, one),
    )
