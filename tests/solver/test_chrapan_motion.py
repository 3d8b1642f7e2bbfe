"""Chrapan's sections 4 to 8, equation by equation, for tops of both directions of spin.

On one side stand the angles and the record of the program in 150 digits; on the other definitions:
the rotation matrix, Euler's equations with slopes of those angles, quadratures, and mpmath's
elliptic functions, those of the paper's imaginary modulus too.  mpmath takes this modulus as it is,
in sn, cn, dn, in K, and in the theta functions, whose nome is then negative; so do our own
functions.
"""

from __future__ import annotations

from functools import partial
from typing import Any, ClassVar

import pytest
from chrapan_top import FAR, LEFT, PARTS, RIGHT, SLOW, UPRIGHT, J, Moment, ar, moments, ours, spoil
from equations import EquationTests, Register, page
from errata import misprints

chrapan = Register(__name__, ar)
tops, right = partial(moments, 0), partial(moments, 0, of=[RIGHT])
upright = partial(moments, 0, of=[UPRIGHT])
tops_and_slow, tops_and_upright = (partial(tops, more=[x]) for x in (SLOW, UPRIGHT))
first_half, first_period = (partial(moments, *PARTS[:i]) for i in (2, 4))
some, far = partial(moments, *PARTS[::2][:2], PARTS[5]), partial(moments, *FAR)
early_and_far = partial(moments, *PARTS[2:], *FAR)
half_periods = partial(moments, *(ar.mpf(i) / 2 for i in (-3, 1, 2, 5)))
right_early, right_at_a_third, right_in_second_half = (
    partial(moments, x, of=[RIGHT]) for x in (PARTS[0], ar.mpf(1) / 3, ar.mpf(5) / 8)
)
left_at_a_third = partial(moments, ar.mpf(1) / 3, of=[LEFT])


# Mechanics


def rotation(now: Moment) -> Any:
    """Return the matrix from body to space: turns about z, the line of nodes, and z'."""

    def about_z(angle: Any) -> Any:
        c, s = ar.cos(angle), ar.sin(angle)
        return ar.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    c, s = ar.cos(now.theta), ar.sin(now.theta)
    return about_z(now.psi) * ar.matrix([[1, 0, 0], [0, c, -s], [0, s, c]]) * about_z(now.phi)


def spin(now: Moment) -> list[Any]:
    """Return p, q and r from the derivative of the rotation."""
    found = rotation(now).T * now.d(rotation)
    return [found[2, 1], found[0, 2], found[1, 0]]


def turning(now: Moment) -> list[Any]:
    """Return omega in space, from the derivative of the rotation."""
    found = now.d(rotation) * rotation(now).T
    return [found[2, 1], found[0, 2], found[1, 0]]


def nodes(angle: Any) -> list[Any]:
    """Return i cos + j sin, the coordinates of a direction in the plane (x, y)."""
    return [ar.cos(angle), ar.sin(angle), ar.mpf(0)]


def momentum(now: Moment) -> Any:
    """Return the angular momentum in space."""
    return rotation(now) * ar.matrix([now.A * now.p, now.A * now.q, now.C * now.r0])


def velocity(now: Moment, angle: Any, rate: Any) -> list[Any]:
    """Return omega of section 4 b in space, with the angle that stands for the precession."""
    axis, along, around = rotation(now)[:, 2], nodes(angle), [0, 0, rate]
    return [now.thetadot * along[i] + around[i] + now.phidot * axis[i] for i in range(3)]


def across(now: Moment) -> tuple[Any, Any]:
    """Return p sin phi + q cos phi and p cos phi - q sin phi, from the derivative of rotation."""
    (p, q, _), sine, cosine = spin(now), ar.sin(now.phi), ar.cos(now.phi)
    return p * sine + q * cosine, p * cosine - q * sine


# The cubic and its roots


def cubic(now: Moment, u: Any) -> Any:
    """Return f(u) from the roots of the record."""
    return now.a * (now.u1 - u) * (u - now.u2) * (now.u3 - u)


def start(now: Moment) -> Any:
    """Return u1 of the start."""
    return ar.cos(ar.radians(now.motion.motion.top.theta0_deg))


def discriminant(now: Moment) -> Any:
    """Return b^4 - 4 a b^2 u1 + 4 a^2 with u1 of the start."""
    return now.b**4 - 4 * now.a * now.b**2 * start(now) + 4 * now.a**2


# Parameters, precession and spin


def pole(now: Moment, i: int) -> Any:
    """Return x/(1 - x), x = kappa^2 sn^2 xi^2 at a parameter."""
    x = now.kappa2 * now.six[3 * i] ** 2 * now.xi**2
    return x / (1 - x)


def printed_six(now: Moment) -> list[Any]:
    """Return sn, cn, dn of alpha1, then of alpha2, as section 4 i prints them."""
    u1, u2, u3 = now.u1, now.u2, now.u3
    south = [J * ar.sqrt(u3 - u1), ar.sqrt(u3 + 1), ar.sqrt(1 + u2)]
    north = [ar.sqrt(u3 - u1), J * ar.sqrt(u3 - 1), ar.sqrt(1 - u2)]
    return [x / ar.sqrt(1 + u1) for x in south] + [x / ar.sqrt(1 - u1) for x in north]


def quotient(now: Moment, v: Any) -> Any:
    """Return sn/(cn dn) for the imaginary modulus, v already stretched to the real one."""
    sn, cn, dn = (ar.ellipfun(name, v, m=now.k**2) for name in ("sn", "cn", "dn"))
    return now.k_prime * sn * dn / cn


def pi00_11(now: Moment, sign: int) -> Any:
    """Return Pi00 of section 4 j, plus or minus Pi11 + i pi/2."""
    even, odd = (ours.pi_function(x, now.w, J * now.alpha, now.k) for x in ("00", "11"))
    return even + sign * (odd + J * ar.pi / 2)


def pi01(now: Moment) -> list[Any]:
    """Return our Pi01(eta, alpha1, kappa) and Pi01(eta, alpha2, kappa), continuous in t."""
    return [ours.pi_function("01", now.eta, v, now.kappa) for v in now.parameters]


def pi01_there(now: Moment, v: Any) -> Any:
    """Return exp 2 Pi01(eta, v, kappa) by its definition and mpmath's theta with nome -q."""
    q, scale = -now.nome, ar.pi / (2 * ar.ellipk(now.kappa2))
    zeta = scale * ar.jtheta(4, scale * v, q, 1) / ar.jtheta(4, scale * v, q)
    less, more = (ar.jtheta(4, scale * (now.eta + sign * v), q) for sign in (-1, 1))
    return ar.exp(2 * now.eta * zeta) * less / more


def weighted(now: Moment) -> list[Any]:
    """Return sn/(cn dn) times Pi01 of each parameter, over sqrt(a (u3 - u1))/b."""
    size, six = now.b / ar.sqrt(now.a * (now.u3 - now.u1)), now.six
    return [
        size * six[i] / (six[i + 1] * six[i + 2]) * x
        for i, x in zip((0, 3), pi01(now), strict=True)
    ]


def own_sn(now: Moment) -> Any:
    """Return our sn(eta, kappa)."""
    return ours.jacobi(now.eta, now.kappa)[1]


# Sections 5 to 8: nutation, spin and precession


def period_by_quadrature(now: Moment) -> Any:
    """Return (5,1) as an integral over chi with u = u1 - (u1 - u2) sin^2 chi."""

    def inverse_rate(chi: Any) -> Any:
        u = now.u1 - (now.u1 - now.u2) * ar.sin(chi) ** 2
        return 4 / ar.sqrt(now.a * (now.u3 - u))

    with ar.workdps(50):
        return ar.quad(inverse_rate, [0, ar.pi / 4, ar.pi / 2])


def steady(now: Moment) -> Any:
    """Return the first term of (6,1)."""
    return now.r0 * (1 - now.C / (2 * now.A)) * now.t


def arccot(now: Moment, sign: Any = 1) -> Any:
    """Return the arccot of (6,1) from u, its roots positive as the text has them.

    In (6,4) they are negative in the second half of a period.
    """
    above, below = (now.u3 - now.u) * (now.u - now.u2), (now.u3 + now.u2) * (now.u1 - now.u)
    return ar.atan2(ar.sqrt(below), sign * ar.sqrt(above))


def drift(now: Moment) -> Any:
    """Return the first term of (7,1) over t."""
    return now.elementary * (2 - (now.u3 - now.u2))


def curve(now: Moment, wrong: int = 0) -> Any:
    """Return the bracket of (7,1), or as it is printed."""
    phi, m = ar.asin(ar.sqrt((now.u3 - now.u2) / (now.u3 + 1))), 1 - now.k**2
    E, F, rest = ar.ellipe(phi, m), ar.ellipf(phi, m), 1 - now.E / now.K
    return E - F * rest + wrong * F * (1 - rest)


def precession(now: Moment, bracket: Any, waves: Any, sigma: Any = 1) -> Any:
    """Return (7,1) with a bracket and with waves, for a direction of spin."""
    rate = ar.sqrt(now.a * (now.u3 - now.u2))
    return drift(now) * now.t + sigma * (rate * now.t * bracket - waves)


chrapan.enter(page("chrapan-4-to-8"))


class TestChrapan(EquationTests):
    """Tests of the register."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = misprints("Chrapan", 4, 5, 6, 7, 8)
    tolerances: ClassVar[dict[str, float]] = {"section 8: rates of the precession": 2e-4}

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put tops in place whose record and angles are wrong."""
        spoil(patch)
