"""Chrapan's section 4, equation by equation, for tops of both directions of spin.

On one side stand the angles and the record of the program in 150 digits; on the other definitions:
the rotation matrix, Euler's equations with slopes of those angles, and mpmath's elliptic functions,
those of the paper's imaginary modulus too.  mpmath takes this modulus as it is, in sn, cn, dn, in
K, and in the theta functions, whose nome is then negative; so do our own functions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import chain
from typing import Any, ClassVar

import pytest
from chrapan_top import (
    LEFT,
    PARTS,
    RIGHT,
    SLOW,
    STEP,
    J,
    Motion,
    ar,
    moments,
    nth_value,
    slope,
    spoil,
    tops,
)
from equations import EquationTests, Pairs, Register, pairs
from errata import misprints
from ours import Ours

chrapan = Register()
ours = Ours(ar)
few = partial(moments, *PARTS[:2])


def rotation(top: Motion, t: Any) -> Any:
    """Return the matrix from body to space: turns about z, the line of nodes, and z'."""

    def about_z(angle: Any) -> Any:
        c, s = ar.cos(angle), ar.sin(angle)
        return ar.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    theta, phi, psi = top.angles(t)
    c, s = ar.cos(theta), ar.sin(theta)
    return about_z(psi) * ar.matrix([[1, 0, 0], [0, c, -s], [0, s, c]]) * about_z(phi)


def change(top: Motion, t: Any) -> Any:
    """Return the derivative of the rotation."""
    return (rotation(top, t + STEP) - rotation(top, t - STEP)) / (2 * STEP)


def spin(top: Motion, t: Any) -> list[Any]:
    """Return p, q and r from the derivative of the rotation."""
    found = rotation(top, t).T * change(top, t)
    return [found[2, 1], found[0, 2], found[1, 0]]


def turning(top: Motion, t: Any) -> list[Any]:
    """Return omega in space, from the derivative of the rotation."""
    found = change(top, t) * rotation(top, t).T
    return [found[2, 1], found[0, 2], found[1, 0]]


def nodes(angle: Any) -> list[Any]:
    """Return i cos + j sin, the coordinates of a direction in the plane (x, y)."""
    return [ar.cos(angle), ar.sin(angle), ar.mpf(0)]


def moment(top: Motion, t: Any) -> list[Any]:
    """Return the derivative of the angular momentum in space, over that of the weight's size."""

    def momentum(i: int, at: Any) -> Any:
        p, q = top.body_rates(at)
        return (rotation(top, at) * ar.matrix([top.A * p, top.A * q, top.C * top.r0]))[i]

    size = top.mgs * ar.sin(top.angles(t)[0])
    return [slope(partial(momentum, i), t) / size for i in range(3)]


def velocity(top: Motion, t: Any, precession: int) -> list[Any]:
    """Return omega of section 4 b in space, with the angle that stands for the precession."""
    angles, rates = top.angles(t), top.rates(t)
    axis, along = rotation(top, t)[:, 2], nodes(angles[precession])
    around = [0, 0, rates[precession]]
    return [rates[0] * along[i] + around[i] + rates[1] * axis[i] for i in range(3)]


def line_of_nodes(top: Motion, t: Any) -> Pairs:
    """Return the line of nodes, and the direction of the moment, with i cos psi + j sin psi."""
    _, phi, psi = top.angles(t)
    found = rotation(top, t) * ar.matrix([ar.cos(phi), -ar.sin(phi), 0])
    return pairs(found, nodes(psi)) + pairs(moment(top, t), nodes(psi))


def around_axis(top: Motion, t: Any) -> Any:
    """Return p sin phi + q cos phi."""
    (p, q), phi = top.body_rates(t), top.angles(t)[1]
    return p * ar.sin(phi) + q * ar.cos(phi)


def solved_rates(top: Motion, t: Any) -> Pairs:
    """Return the rates of precession, spin and nutation with (4,1) solved for them."""
    theta, phi, _ = top.angles(t)
    p, q, _ = spin(top, t)
    around, (nutation, own, precession) = p * ar.sin(phi) + q * ar.cos(phi), top.rates(t)
    return [
        (precession, around / ar.sin(theta)),
        (own, top.r0 - around * ar.cot(theta)),
        (nutation, p * ar.cos(phi) - q * ar.sin(phi)),
    ]


def euler(top: Motion, t: Any) -> Pairs:
    """Return both sides of Euler's equations."""
    (theta, phi, _), (p, q) = top.angles(t), top.body_rates(t)
    p_rate, q_rate = (slope(partial(nth_value, top.body_rates, i), t) for i in (0, 1))
    pull, gyro = top.mgs * ar.sin(theta), (top.C - top.A) * top.r0
    return [
        (top.A * p_rate + gyro * q, pull * ar.cos(phi)),
        (top.A * q_rate - gyro * p, -pull * ar.sin(phi)),
    ]


def power(top: Motion, t: Any) -> tuple[Any, Any]:
    """Return the change of the energy of rotation, and the power of the weight."""
    rates = (slope(partial(nth_value, top.body_rates, i), t) for i in (0, 1))
    change = sum(x * rate for x, rate in zip(top.body_rates(t), rates, strict=True))
    return top.A * change, top.mgs * ar.sin(top.angles(t)[0]) * top.rates(t)[0]


def squares(top: Motion, t: Any, precession: int) -> Pairs:
    """Return section 4 d's p and q by the rates, with the angle that stands for the precession."""
    (p, q), rates, u = top.body_rates(t), top.rates(t), top.u(t)
    return [
        (p**2 + q**2, rates[0] ** 2 + (1 - u**2) * rates[precession] ** 2),
        (around_axis(top, t), ar.sin(top.angles(t)[0]) * rates[precession]),
    ]


def fallen(top: Motion, t: Any) -> tuple[Any, Any]:
    """Return the energy that the weight has given, and that of rotation by the rates."""
    return 2 * top.mgs * (top.u1 - top.u(t)) / top.A, squares(top, t, 2)[0][1]


MECHANICS = {
    "section 4 b: the angular velocity": lambda top, t: [
        *pairs(turning(top, t), velocity(top, t, 2)),
        (ar.fdot(zip(velocity(top, t, 2), rotation(top, t)[:, 2], strict=True)), top.r0),
    ],
    "(4,1)": lambda top, t: pairs([*top.body_rates(t), top.r0], spin(top, t)),
    "(4,1) solved for the rates": solved_rates,
    "section 4 d: c1 and c2": lambda top, t: [
        (
            top.A / 2 * sum(x**2 for x in top.body_rates(t)) + top.mgs * top.u(t),
            top.mgs * top.u1,
        ),
        (
            top.A * ar.sin(top.angles(t)[0]) * around_axis(top, t) + top.C * top.r0 * top.u(t),
            top.C * top.r0 * top.u1,
        ),
    ],
    "section 4 d: p and q by the rates": lambda top, t: [*squares(top, t, 2), fallen(top, t)],
}
chrapan.each(moments, MECHANICS)
chrapan.each(
    few,
    {
        "section 4 a: the line of nodes": line_of_nodes,
        "section 4 c: Euler's equations": euler,
        "section 4 d: power of the weight": power,
    },
)


def printed_p(top: Motion, t: Any) -> tuple[Any, Any]:
    """Return p and (4,1) as printed."""
    (theta, phi, _), (nutation, own, _) = top.angles(t), top.rates(t)
    right = own * ar.sin(theta) * ar.sin(phi) + nutation * ar.cos(phi)
    return top.body_rates(t)[0], right


chrapan.each_as_printed(
    lambda: [(RIGHT, PARTS[0] * RIGHT.T)],
    {
        "section 4 a: the line of nodes": lambda top, t: pairs(
            moment(top, t)[:2], nodes(top.angles(t)[1])[:2]
        ),
        "(4,1)": printed_p,
    },
)
chrapan.each_as_printed(
    lambda: [(RIGHT, RIGHT.T / 3)],
    {
        "section 4 b: the angular velocity": lambda top, t: pairs(
            turning(top, t), velocity(top, t, 1)
        ),
        "(4,1) solved for the rates": lambda top, t: (
            top.rates(t)[1],
            around_axis(top, t) / ar.sin(top.angles(t)[0]),
        ),
        "section 4 d: p and q by the rates": lambda top, t: squares(top, t, 1),
    },
)


def with_rate(rate: int, *only: Any) -> Iterator[tuple[Motion, Any, Any]]:
    """Yield each top and time, or one of each, with a rate."""
    for top, t in [only] if only else moments():
        yield top, t, top.rates(t)[rate]


OF_PRECESSION = {
    "(4,2)": lambda top, t, rate: (
        top.A * (top.rates(t)[0] ** 2 + rate**2 * (1 - top.u(t) ** 2)),
        2 * top.mgs * (top.u1 - top.u(t)),
    ),
    "(4,3)": lambda top, t, rate: (
        top.A * (1 - top.u(t) ** 2) * rate,
        top.C * top.r0 * (top.u1 - top.u(t)),
    ),
    "(4,7)": lambda top, t, rate: (rate, top.b * (top.u1 - top.u(t)) / (1 - top.u(t) ** 2)),
}
OF_SPIN = {
    "(4,8)": lambda top, t, rate: (
        rate,
        top.r0 - top.b * top.u(t) * (top.u1 - top.u(t)) / (1 - top.u(t) ** 2),
    )
}
"""Sides with a rate; printed is that of the other angle."""

for _sides, _right, _printed in ((OF_PRECESSION, 2, 1), (OF_SPIN, 1, 2)):
    chrapan.each(partial(with_rate, _right), _sides)
    chrapan.each_as_printed(partial(with_rate, _printed, RIGHT, PARTS[0] * RIGHT.T), _sides)


def cubic(top: Motion, u: Any) -> Any:
    """Return f(u) of (4,9)."""
    a, b, u1 = top.a, top.b, top.u1
    return (1 - u * u) * (a * u1 - a * u) - (b * u1 - b * u) ** 2


def factored(top: Motion, u: Any) -> Any:
    """Return f(u) from the roots of the record."""
    u1, u2, u3 = top.roots
    return top.a * (u1 - u) * (u - u2) * (u3 - u)


def discriminant(top: Motion) -> Any:
    """Return b^4 - 4 a b^2 u1 + 4 a^2 with u1 of the start."""
    a, b, u1 = top.a, top.b, ar.cos(ar.radians(top.top.theta0_deg))
    return b**4 - 4 * a * b**2 * u1 + 4 * a**2


def roots(top: Motion) -> Pairs:
    """Return u2 and u3 by (4,10), and the quadratic equation at both."""
    a, b2, root = top.a, top.b**2, ar.sqrt(discriminant(top))
    found = pairs(top.roots[1:], [(b2 - root) / (2 * a), (b2 + root) / (2 * a)])
    return found + [(-a * u**2 + b2 * u - (b2 * top.u1 - a), 0) for u in top.roots[1:]]


def slopes_of_f(top: Motion) -> Pairs:
    """Return f at both poles, and its slope at u1."""
    u1 = ar.cos(ar.radians(top.top.theta0_deg))
    found = [(factored(top, ar.mpf(x)), -((top.b * (u1 - x)) ** 2)) for x in (1, -1)]
    return [*found, (slope(partial(factored, top), u1), -top.a * (1 - u1**2))]


CONSTANTS = {
    "(4,4)": lambda top: (top.a, 2 * top.mgs / top.A),
    "(4,5)": lambda top: (top.b, top.C * top.r0 / top.A),
    "(4,6)": lambda top: pairs([top.u1, top.u2], [top.u(ar.mpf(0)), top.u(top.T / 2)]),
    "(4,10)": roots,
    "(4,19)": lambda top: (top.k, ar.sqrt((top.u1 - top.u2) / (top.u3 - top.u2))),
    "(4,21)": lambda top: (top.k_prime, ar.sqrt((top.u3 - top.u1) / (top.u3 - top.u2))),
    "section 4 e: the discriminant": lambda top: [
        ((2 * top.a * (top.u3 - top.u2) / 2) ** 2, discriminant(top)),
        (ar.sign(discriminant(top) - (top.b**2 - 2 * top.a) ** 2), 1),
    ],
    "section 4 e: f and its slope at 1, -1 and u1": slopes_of_f,
}
"""Sides without time."""

chrapan.each(tops, CONSTANTS)
chrapan.each(
    lambda: [*tops(), (SLOW,)],
    {
        "section 4 e: sign of u2": lambda top: [
            (top.a * top.u3 * top.u(top.T / 2), top.b**2 * top.u1 - top.a),
            (ar.sign(top.u3 - 1), 1),
        ]
    },
)


ROOTS: dict[str, Callable[..., Any]] = {
    "(4,11)": lambda u1, u2, u3, b: (u3 + u2, b),
    "section 4 f: sum of products": lambda u1, u2, u3, b: (u1 * u2 + u1 * u3 - u2 * u3, 1),
    "(4,12)": lambda u1, u2, u3, b: (u2 * u3, b * u1 - 1),
    "(4,13)": lambda u1, u2, u3, b: (1 - u1**2, (u1 - u2) * (u3 - u1)),
    "(4,14)": lambda u1, u2, u3, b: (1 - u2**2, (u1 - u2) * (u3 + u2)),
    "(4,14), second": lambda u1, u2, u3, b: (u3**2 - 1, (u3 - u1) * (u3 + u2)),
    "(4,15)": lambda u1, u2, u3, b: ((1 + u1) * (1 - u2), (u3 + 1) * (u1 - u2)),
    "(4,15), second": lambda u1, u2, u3, b: ((1 - u1) * (1 + u2), (u3 - 1) * (u1 - u2)),
    "(4,15), third": lambda u1, u2, u3, b: ((1 + u1) * (u3 - 1), (1 + u2) * (u3 - u1)),
    "(4,16)": lambda u1, u2, u3, b: ((1 - u1) * (u3 + 1), (1 - u2) * (u3 - u1)),
    "(4,17)": lambda u1, u2, u3, b: ((1 + u2) * (u3 + 1), (1 + u1) * (u3 + u2)),
    "(4,18)": lambda u1, u2, u3, b: ((1 - u2) * (u3 - 1), (1 - u1) * (u3 + u2)),
}
"""Identities between the roots and b^2/a."""

chrapan.each(lambda: ((*top.roots, top.b**2 / top.a) for (top,) in tops()), ROOTS)


def states() -> Iterator[tuple[Any, ...]]:
    """Yield each top and time with u, xi^2 and the three roots."""
    for top, t in moments():
        yield top, t, top.u(t), top.xi(t) ** 2, *top.roots


STATES = {
    "(4,9)": lambda top, t, u, xi2, u1, u2, u3: (slope(top.u, t) ** 2, cubic(top, u)),
    "(4,20)": lambda top, t, u, xi2, u1, u2, u3: [
        (u, u3 - (u3 - u1) / top.jacobi(t)[2] ** 2),
        (u, u1 - (u1 - u2) * (u3 - u1) / (u3 - u2) * (top.jacobi(t)[0] / top.jacobi(t)[2]) ** 2),
    ],
    "(4,22)": lambda top, t, u, xi2, u1, u2, u3: (top.jacobi(t)[2] ** 2, (u3 - u1) / (u3 - u)),
    "(4,23)": lambda top, t, u, xi2, u1, u2, u3: (
        top.jacobi(t)[0] ** 2,
        (u1 - u) * (u3 - u2) / ((u3 - u) * (u1 - u2)),
    ),
    "(4,24)": lambda top, t, u, xi2, u1, u2, u3: (
        top.jacobi(t)[1] ** 2,
        (u3 - u1) * (u - u2) / ((u3 - u) * (u1 - u2)),
    ),
    "(4,25)": lambda top, t, u, xi2, u1, u2, u3: (
        *(1 + u, (1 + u1) * (1 - (u1 - u2) / (1 + u1) * xi2)),
    ),
    "(4,26)": lambda top, t, u, xi2, u1, u2, u3: (
        *(1 - u, (1 - u1) * (1 + (u1 - u2) / (1 - u1) * xi2)),
    ),
    "section 4 g: u by the imaginary modulus": lambda top, t, u, xi2, u1, u2, u3: pairs(
        [u1 - u, u - u2, u3 - u],
        [(u1 - u2) * xi2, (u1 - u2) * (1 - xi2), (u3 - u1) * (1 - top.kappa2 * xi2)],
    ),
}
"""Sides at a time, with u, xi^2 and the roots."""

chrapan.each(states, STATES)


def at_poles(top: Motion, t: Any) -> list[Any]:
    """Return kappa^2 sn^2 xi^2 at both parameters."""
    return [top.kappa2 * sn**2 * top.xi(t) ** 2 for sn, _, _ in top.at_parameters]


def precession_rate(top: Motion, t: Any, power: int) -> Any:
    """Return the rate of section 4 ch, with the power of kappa in its first numerator."""
    first, second = at_poles(top, t)
    kappa = ar.sqrt(top.kappa2)
    return top.b / 2 * (kappa ** (power - 2) * first / (1 - first) - second / (1 - second))


def spin_rate(top: Motion, t: Any) -> tuple[Any, Any]:
    """Return the spin rate and section 4 k."""
    waves = sum(x / (1 - x) for x in at_poles(top, t))
    return top.rates(t)[1], top.r0 + top.b / 2 * waves


def printed_at_parameters(top: Motion) -> list[Any]:
    """Return sn, cn, dn of alpha1, then of alpha2, as section 4 i prints them."""
    u1, u2, u3 = top.roots
    south = [J * ar.sqrt(u3 - u1), ar.sqrt(u3 + 1), ar.sqrt(1 + u2)]
    north = [ar.sqrt(u3 - u1), J * ar.sqrt(u3 - 1), ar.sqrt(1 - u2)]
    return [x / ar.sqrt(1 + u1) for x in south] + [x / ar.sqrt(1 - u1) for x in north]


def at_parameters(top: Motion, signs: tuple[int, ...]) -> Pairs:
    """Return sn, cn, dn of both parameters with their squares, and with signs, as printed."""
    ours, printed = list(chain(*top.at_parameters)), printed_at_parameters(top)
    signed = [sign * x for sign, x in zip(signs, printed, strict=True)]
    return pairs([x**2 for x in ours], [x**2 for x in printed]) + pairs(ours, signed)


def quotient(top: Motion, v: Any) -> Any:
    """Return sn/(cn dn) for the imaginary modulus, v already stretched to the real one."""
    sn, cn, dn = (ar.ellipfun(name, v, m=top.k**2) for name in ("sn", "cn", "dn"))
    return top.k_prime * sn * dn / cn


def before_4_27(top: Motion, sign: int) -> Pairs:
    """Return the line before (4,27) with u3 - u1, or with a sign of 1 u3 + u1, by both values."""
    u1, u2, u3 = top.roots
    right = J * ar.sqrt((u3 + sign * u1) * (1 + u1) / ((u3 + 1) * (1 + u2)))
    sn, cn, dn = top.at_parameters[0]
    return [(sn / (cn * dn), right), (quotient(top, J * top.alpha), right)]


def pi(top: Motion, t: Any) -> tuple[Any, Any]:
    """Return Pi00 and Pi11 of section 4 j."""
    place = top.w(t), J * top.alpha, top.k
    return ours.pi_function("00", *place), ours.pi_function("11", *place)


def precession(top: Motion, t: Any, sigma: Any) -> tuple[Any, Any]:
    """Return the precession and (4,29) for a direction of spin."""
    even, odd = pi(top, t)
    return top.angles(t)[2], sigma * J * (even + odd + J * ar.pi / 2)


def own_spin(top: Motion, t: Any, sigma: Any) -> tuple[Any, Any]:
    """Return the spin and (4,34) for a direction of spin."""
    even, odd = pi(top, t)
    return top.angles(t)[1], top.r0 * t + sigma * J * (even - odd - J * ar.pi / 2)


def argument(top: Motion, t: Any, stretch: Any) -> tuple[Any, Any]:
    """Return w of (4,30), and eta times a factor that should be sqrt(1 + k_bar^2)."""
    return 2 * top.K * t / top.T, top.eta(t) * stretch


def of_w(top: Motion, t: Any, part: int) -> tuple[Any, Any]:
    """Return dn^2 w and its value by section 4 l, where w has the factor 1/part."""
    w = ar.sqrt(top.a * (top.u3 - top.u2)) * t / part
    return ar.ellipfun("dn", w, m=top.k**2) ** 2, (top.u3 - top.u1) / (top.u3 - top.u(t))


def at_alpha(top: Motion, sign: int, b: Any) -> tuple[Any, Any]:
    """Return both sides of (4,27), or with sign = -1 of (4,28)."""
    v = J * top.alpha + (0 if sign == 1 else J * top.K_prime + top.K)
    return quotient(top, v), sign * J * ar.sqrt(top.a * (top.u3 - top.u1)) / b


def of_alpha(top: Motion, name: str, numerator: Any) -> tuple[Any, Any]:
    """Return a function of alpha for k', and its value by the roots."""
    value = ar.ellipfun(name, top.alpha, m=1 - top.k**2)
    return value, ar.sqrt(numerator / (top.u3 + 1))


chrapan.each(
    moments,
    {
        "section 4 ch: rate of precession": lambda top, t: (
            top.rates(t)[2],
            precession_rate(top, t, 2),
        ),
        "section 4 k: rate of spin": spin_rate,
        "(4,29)": lambda top, t: precession(top, t, top.sigma),
        "(4,30)": lambda top, t: [
            argument(top, t, ar.sqrt((top.u3 - top.u2) / (top.u3 - top.u1))),
            argument(top, t, ar.sqrt(1 - top.kappa2)),
            (2 * top.K * t / top.T, top.w(t)),
        ],
        "section 4 l: w": lambda top, t: of_w(top, t, 2),
        "(4,34)": lambda top, t: own_spin(top, t, top.sigma),
    },
)
chrapan.each(
    tops,
    {
        "section 4 i: sn, cn, dn of the parameters": lambda top: at_parameters(
            top, (1, 1, 1, -1, 1, -1)
        ),
        "line before (4,27)": lambda top: before_4_27(top, -1),
        "(4,27)": lambda top: at_alpha(top, 1, abs(top.b)),
        "(4,28)": lambda top: at_alpha(top, -1, abs(top.b)),
        "(4,31)": lambda top: of_alpha(top, "cn", 1 + top.u2),
        "(4,32)": lambda top: of_alpha(top, "sn", top.u3 - top.u2),
        "(4,33)": lambda top: of_alpha(top, "dn", 1 + top.u1),
    },
)
chrapan.each_as_printed(
    tops,
    {
        "section 4 i: sn, cn, dn of the parameters": lambda top: at_parameters(top, (1,) * 6)[9::2],
        "line before (4,27)": lambda top: before_4_27(top, 1),
    },
)
chrapan.each_as_printed(
    lambda: [(RIGHT, RIGHT.T / 3)],
    {
        "section 4 ch: rate of precession as printed, the power": lambda top, t: (
            top.rates(t)[2],
            precession_rate(top, t, 3),
        ),
        "section 4 ch: rate of precession as printed, the left side": lambda top, t: (
            top.rates(t)[1],
            precession_rate(top, t, 2),
        ),
        "(4,30) as printed, the roots": lambda top, t: argument(
            top, t, ar.sqrt((top.u3 + top.u2) / (top.u3 - top.u2))
        ),
        "(4,30) as printed, the modulus": lambda top, t: argument(top, t, ar.sqrt(1 + top.k**2)),
        "section 4 l: w": lambda top, t: of_w(top, t, 3),
    },
)
chrapan.each_as_printed(
    lambda: [(LEFT, LEFT.T / 3)],
    {
        "(4,27)": lambda top, _: at_alpha(top, 1, top.b),
        "(4,28)": lambda top, _: at_alpha(top, -1, top.b),
        "(4,29)": lambda top, t: precession(top, t, 1),
        "(4,34)": lambda top, t: own_spin(top, t, 1),
    },
)


def here(top: Motion, v: Any) -> list[Any]:
    """Return our sn, cn and dn for the imaginary modulus."""
    return list(ours.jacobi(v, top.kappa)[1:])


def squares_at_parameters(top: Motion) -> list[Any]:
    """Return the squares of sn, cn, dn at alpha1 and at alpha2, from the roots (4 i)."""
    u1, u2, u3 = top.roots
    south = [x / (1 + u1) for x in (u1 - u3, u3 + 1, 1 + u2)]
    return south + [x / (1 - u1) for x in (u3 - u1, 1 - u3, 1 - u2)]


def pi01(top: Motion, t: Any) -> list[Any]:
    """Return our Pi01(eta, alpha1, kappa) and Pi01(eta, alpha2, kappa), continuous in t."""
    return [ours.pi_function("01", top.eta(t), v, top.kappa) for v in top.parameters]


def pi01_there(top: Motion, t: Any, v: Any) -> Any:
    """Return exp 2 Pi01(eta, v, kappa) by its definition and mpmath's theta with nome -q."""
    q, scale = -top.nome, ar.pi / (2 * ar.ellipk(top.kappa2))
    zeta = scale * ar.jtheta(4, scale * v, q, 1) / ar.jtheta(4, scale * v, q)
    less, more = (ar.jtheta(4, scale * (top.eta(t) + sign * v), q) for sign in (-1, 1))
    return ar.exp(2 * top.eta(t) * zeta) * less / more


def weighted(top: Motion, t: Any) -> list[Any]:
    """Return sn/(cn dn) times Pi01 of each parameter, from the roots, over sqrt(a (u3 - u1))/b."""
    size = top.b / ar.sqrt(top.a * (top.u3 - top.u1))
    places = zip(top.at_parameters, pi01(top, t), strict=True)
    return [size * sn / (cn * dn) * value for (sn, cn, dn), value in places]


def rates_of_xi(top: Motion, t: Any) -> list[tuple[Any, Any]]:
    """Return f and the rate of xi = sn(eta, kappa) with their formulas."""
    (u1, u2, u3), xi = top.roots, here(top, top.eta(t))[0]
    rest = (1 - xi**2) * (1 - top.kappa2 * xi**2)
    return [
        (slope(top.u, t) ** 2, top.a * (u1 - u2) ** 2 * (u3 - u1) * xi**2 * rest),
        (slope(lambda at: here(top, top.eta(at))[0], t) ** 2, top.a * (u3 - u1) / 4 * rest),
    ]


chrapan.each(
    tops,
    {
        "section 4 g: the modulus, and its complement greater than 1": lambda top: pairs(
            [top.kappa, ar.sqrt((top.u3 - top.u2) / (top.u3 - top.u1)), ar.sqrt(1 - top.kappa2)],
            [J * top.k / top.k_prime, 1 / top.k_prime, 1 / top.k_prime],
        ),
        "section 4 h: quarter periods of the imaginary modulus": lambda top: pairs(
            [top.k_prime * top.K, top.k_prime * (top.K_prime - J * top.K)],
            [ar.ellipk(top.kappa2), ar.ellipk(1 / top.k_prime**2)],
        ),
        "section 4 i: squares of sn, cn, dn at both parameters": lambda top: pairs(
            [x**2 for v in top.parameters for x in here(top, v)], squares_at_parameters(top)
        ),
        "section 4 g: sn, cn, dn of the imaginary modulus anywhere": lambda top: [
            (x, ar.ellipfun(name, top.alpha * (3 + 4 * J) / 10, m=-((top.k / top.k_prime) ** 2)))
            for name, x in zip(
                "sn cn dn".split(), here(top, top.alpha * (3 + 4 * J) / 10), strict=True
            )
        ],
        "section 4 j: the second parameter is iK' further, the product is 1": lambda top: [
            (top.parameters[1] - top.parameters[0], J * ar.ellipk(1 / top.k_prime**2)),
            (top.kappa2 * ar.fprod(top.imaginary(v)[0] for v in top.parameters) ** 2, 1),
            (top.kappa2 * squares_at_parameters(top)[0] * squares_at_parameters(top)[3], 1),
        ],
        "section 4 j: sn, cn, dn of i alpha for the real modulus": lambda top: pairs(
            [x**2 for x in ours.jacobi(J * top.alpha, top.k)[1:]],
            [x / (1 + top.u2) for x in (top.u2 - top.u3, top.u3 + 1, 1 + top.u1)],
        ),
    },
)
chrapan.each(
    moments,
    {
        "section 4 g: u by sn of the imaginary modulus": lambda top, t: [
            (top.u(t), top.u1 - (top.u1 - top.u2) * side(top, top.eta(t))[0] ** 2)
            for side in (here, Motion.imaginary)
        ],
        "section 4 i: precession by Pi01": lambda top, t: (
            top.sigma * J * sum(pi01(top, t)),
            top.angles(t)[2],
        ),
        "section 4 l: spin by Pi01": lambda top, t: (
            top.r0 * t + top.sigma * J * (pi01(top, t)[0] - pi01(top, t)[1]),
            top.angles(t)[1],
        ),
    },
)
chrapan.each(
    partial(moments, PARTS[0], PARTS[2], PARTS[5]),
    {
        "section 4 g: f and the rate of xi": rates_of_xi,
        "section 4 i: Pi01 of both parameters": lambda top, t: pairs(
            [ar.exp(2 * value) for value in pi01(top, t)],
            [pi01_there(top, t, v) for v in top.parameters],
        ),
        "section 4 i: precession by Pi01 and the values at its parameters": lambda top, t: (
            weighted(top, t)[0] - weighted(top, t)[1],
            top.angles(t)[2],
        ),
        "section 4 l: spin by Pi01 and the values at its parameters": lambda top, t: (
            top.r0 * t + sum(weighted(top, t)),
            top.angles(t)[1],
        ),
    },
)


class TestChrapan(EquationTests):
    """Tests of the register."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = misprints("Chrapan", 4)

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put tops in place whose record and angles are wrong."""
        spoil(patch)
