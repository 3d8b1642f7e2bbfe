"""Chrapan's section 4, equation by equation, for tops of both directions of spin.

On one side stand the angles and the record of the program in 150 digits; on the other definitions:
the rotation matrix, Euler's equations with slopes of those angles, and mpmath's elliptic functions,
those of the paper's imaginary modulus too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, ClassVar

import pytest
from chrapan_top import (
    LEFT,
    MOTIONS,
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
from equations import EquationTests, Register, Sides
from errata import misprints
from ours import Ours

chrapan = Register()
equation, as_printed = chrapan.equation, chrapan.as_printed
pi_function = Ours(ar).pi_function


def rotation(motion: Motion, t: Any) -> Any:
    """Return the matrix from body to space: turns about z, the line of nodes, and z'."""

    def about_z(angle: Any) -> Any:
        c, s = ar.cos(angle), ar.sin(angle)
        return ar.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    theta, phi, psi = motion.angles(t)
    c, s = ar.cos(theta), ar.sin(theta)
    return about_z(psi) * ar.matrix([[1, 0, 0], [0, c, -s], [0, s, c]]) * about_z(phi)


def _nodes(angle: Any) -> list[Any]:
    """Return i cos + j sin, the coordinates of a direction in the plane (x, y)."""
    return [ar.cos(angle), ar.sin(angle), ar.mpf(0)]


def _moment(motion: Motion, t: Any) -> list[Any]:
    """Return the derivative of the angular momentum in space, over that of the weight's size."""

    def momentum(i: int, at: Any) -> Any:
        p, q = motion.body_rates(at)
        own = ar.matrix([motion.A * p, motion.A * q, motion.C * motion.r0])
        return (rotation(motion, at) * own)[i]

    size = motion.mgs * ar.sin(motion.angles(t)[0])
    return [slope(partial(momentum, i), t) / size for i in range(3)]


@equation("section 4 a: the line of nodes")
def _() -> Sides:
    for motion, t in moments(*PARTS[:2]):
        _, phi, psi = motion.angles(t)
        nodes = rotation(motion, t) * ar.matrix([ar.cos(phi), -ar.sin(phi), 0])
        yield from zip(nodes, _nodes(psi), strict=True)
        yield from zip(_moment(motion, t), _nodes(psi), strict=True)


@as_printed("section 4 a: the line of nodes")
def _() -> Sides:
    t = RIGHT.T * PARTS[0]
    yield from zip(_moment(RIGHT, t)[:2], _nodes(RIGHT.angles(t)[1])[:2], strict=True)


def _velocity(motion: Motion, t: Any, precession: int) -> list[Any]:
    """Return omega of section 4 b in space, with the angle that stands for the precession."""
    angles, rates = motion.angles(t), motion.rates(t)
    axis = rotation(motion, t)[:, 2]
    nodes, around = _nodes(angles[precession]), [0, 0, rates[precession]]
    return [rates[0] * nodes[i] + around[i] + rates[1] * axis[i] for i in range(3)]


def _turning(motion: Motion, t: Any) -> list[Any]:
    """Return omega in space, from the derivative of the rotation."""
    change = (rotation(motion, t + STEP) - rotation(motion, t - STEP)) / (2 * STEP)
    spin = change * rotation(motion, t).T
    return [spin[2, 1], spin[0, 2], spin[1, 0]]


@equation("section 4 b: the angular velocity")
def _() -> Sides:
    for motion, t in moments():
        velocity = _velocity(motion, t, 2)
        yield from zip(_turning(motion, t), velocity, strict=True)
        yield (
            sum(x * y for x, y in zip(velocity, rotation(motion, t)[:, 2], strict=True)),
            motion.r0,
        )


@as_printed("section 4 b: the angular velocity")
def _() -> Sides:
    t = RIGHT.T / 3
    yield from zip(_turning(RIGHT, t), _velocity(RIGHT, t, 1), strict=True)


@equation("(4,1)")
def _() -> Sides:
    for motion, t in moments():
        turning = (rotation(motion, t + STEP) - rotation(motion, t - STEP)) / (2 * STEP)
        spin = rotation(motion, t).T * turning
        p, q = motion.body_rates(t)
        yield p, spin[2, 1]
        yield q, spin[0, 2]
        yield motion.r0, spin[1, 0]


@as_printed("(4,1)")
def _() -> Sides:
    motion, t = RIGHT, PARTS[0] * RIGHT.T
    theta, phi, _ = motion.angles(t)
    nutation, spin, _ = motion.rates(t)
    p, _ = motion.body_rates(t)
    yield p, spin * ar.sin(theta) * ar.sin(phi) + nutation * ar.cos(phi)


@equation("(4,1) solved for the rates")
def _() -> Sides:
    for motion, t in moments():
        theta, phi, _ = motion.angles(t)
        turning = (rotation(motion, t + STEP) - rotation(motion, t - STEP)) / (2 * STEP)
        spin = rotation(motion, t).T * turning
        p, q = spin[2, 1], spin[0, 2]
        around = p * ar.sin(phi) + q * ar.cos(phi)
        nutation, own, precession = motion.rates(t)
        yield precession, around / ar.sin(theta)
        yield own, motion.r0 - around * ar.cot(theta)
        yield nutation, p * ar.cos(phi) - q * ar.sin(phi)


@as_printed("(4,1) solved for the rates")
def _() -> Sides:
    theta, phi, _ = RIGHT.angles(RIGHT.T / 3)
    p, q = RIGHT.body_rates(RIGHT.T / 3)
    yield RIGHT.rates(RIGHT.T / 3)[1], (p * ar.sin(phi) + q * ar.cos(phi)) / ar.sin(theta)


@equation("section 4 c: Euler's equations")
def _() -> Sides:
    for motion, t in moments(*PARTS[:2]):
        theta, phi, _ = motion.angles(t)
        p, q = motion.body_rates(t)
        p_rate, q_rate = (slope(partial(nth_value, motion.body_rates, i), t) for i in (0, 1))
        pull = motion.mgs * ar.sin(theta)
        gyro = (motion.C - motion.A) * motion.r0
        yield motion.A * p_rate + gyro * q, pull * ar.cos(phi)
        yield motion.A * q_rate - gyro * p, -pull * ar.sin(phi)


def with_rate(rate: int, *only: Any) -> Iterator[tuple[Motion, Any, Any]]:
    """Yield each top and time, or one of each, with a rate."""
    for motion, t in [only] if only else moments():
        yield motion, t, motion.rates(t)[rate]


RATES: dict[str, tuple[Callable[[Motion, Any, Any], tuple[Any, Any]], int, int]] = {
    "(4,2)": (
        lambda top, t, rate: (
            top.A * (top.rates(t)[0] ** 2 + rate**2 * (1 - top.u(t) ** 2)),
            2 * top.mgs * (top.u1 - top.u(t)),
        ),
        *(2, 1),
    ),
    "(4,3)": (
        lambda top, t, rate: (
            top.A * (1 - top.u(t) ** 2) * rate,
            top.C * top.r0 * (top.u1 - top.u(t)),
        ),
        *(2, 1),
    ),
    "(4,7)": (
        lambda top, t, rate: (rate, top.b * (top.u1 - top.u(t)) / (1 - top.u(t) ** 2)),
        *(2, 1),
    ),
    "(4,8)": (
        lambda top, t, rate: (
            rate,
            top.r0 - top.b * top.u(t) * (top.u1 - top.u(t)) / (1 - top.u(t) ** 2),
        ),
        *(1, 2),
    ),
}
"""Sides with a rate of spin (1) or precession (2): the right side, and the printed one."""

for _name, (_sides, _right, _printed) in RATES.items():
    chrapan.each(partial(with_rate, _right), {_name: _sides})
    chrapan.each_as_printed(
        partial(with_rate, _printed, RIGHT, PARTS[0] * RIGHT.T), {_name: _sides}
    )


@equation("section 4 d: power of the weight")
def _() -> Sides:
    for motion, t in moments(*PARTS[:2]):
        p, q = motion.body_rates(t)
        p_rate, q_rate = (slope(partial(nth_value, motion.body_rates, i), t) for i in (0, 1))
        theta, nutation = motion.angles(t)[0], motion.rates(t)[0]
        yield motion.A * (p * p_rate + q * q_rate), motion.mgs * ar.sin(theta) * nutation


@equation("section 4 d: c1 and c2")
def _() -> Sides:
    for motion, t in moments():
        u, (p, q) = motion.u(t), motion.body_rates(t)
        theta, phi, _ = motion.angles(t)
        around = motion.A * ar.sin(theta) * (p * ar.sin(phi) + q * ar.cos(phi))
        yield motion.A / 2 * (p**2 + q**2) + motion.mgs * u, motion.mgs * motion.u1
        yield around + motion.C * motion.r0 * u, motion.C * motion.r0 * motion.u1


def _squares(motion: Motion, t: Any, precession: int) -> tuple[Any, Any]:
    """Return p^2 + q^2 and section 4 d's sum, with the angle that stands for the precession."""
    (p, q), rates = motion.body_rates(t), motion.rates(t)
    return p**2 + q**2, rates[0] ** 2 + (1 - motion.u(t) ** 2) * rates[precession] ** 2


def _around(motion: Motion, t: Any, precession: int) -> tuple[Any, Any]:
    """Return p sin + q cos and the sine times the rate that stands for the precession."""
    (p, q), (theta, phi, _) = motion.body_rates(t), motion.angles(t)
    around = p * ar.sin(phi) + q * ar.cos(phi)
    return around, ar.sin(theta) * motion.rates(t)[precession]


@equation("section 4 d: p and q by the rates")
def _() -> Sides:
    for motion, t in moments():
        yield _squares(motion, t, 2)
        yield _around(motion, t, 2)
        fallen = 2 * motion.mgs * (motion.u1 - motion.u(t)) / motion.A
        yield fallen, _squares(motion, t, 2)[1]


@as_printed("section 4 d: p and q by the rates")
def _() -> Sides:
    yield _squares(RIGHT, RIGHT.T / 3, 1)
    yield _around(RIGHT, RIGHT.T / 3, 1)


@equation("(4,6)")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.u1, motion.u(ar.mpf(0))
        yield motion.u2, motion.u(motion.T / 2)


def _cubic(motion: Motion, u: Any) -> Any:
    """Return f(u) of (4,9)."""
    a, b, u1 = motion.a, motion.b, motion.u1
    return (1 - u * u) * (a * u1 - a * u) - (b * u1 - b * u) ** 2


@equation("(4,10)")
def _() -> Sides:
    for motion in MOTIONS:
        a, b, u1 = motion.a, motion.b, motion.u1
        root = ar.sqrt(b**4 - 4 * a * b**2 * u1 + 4 * a**2)
        for u, ours in zip(
            ((b**2 - root) / (2 * a), (b**2 + root) / (2 * a)), motion.roots[1:], strict=True
        ):
            yield ours, u
            yield -a * ours**2 + b**2 * ours - (b**2 * u1 - a), ar.mpf(0)


@equation("section 4 e: the discriminant")
def _() -> Sides:
    for motion in MOTIONS:
        a, b, u1 = motion.a, motion.b, ar.cos(ar.radians(motion.top.theta0_deg))
        discriminant = b**4 - 4 * a * b**2 * u1 + 4 * a**2
        yield (2 * a * (motion.u3 - motion.u2) / 2) ** 2, discriminant
        yield ar.sign(discriminant - (b**2 - 2 * a) ** 2), 1


@equation("section 4 e: f and its slope at 1, -1 and u1")
def _() -> Sides:
    for motion in MOTIONS:
        factored = partial(_factored_cubic, motion)
        u1 = ar.cos(ar.radians(motion.top.theta0_deg))
        for pole in (1, -1):
            yield factored(ar.mpf(pole)), -((motion.b * (u1 - pole)) ** 2)
        yield slope(factored, u1), -motion.a * (1 - u1**2)


def _factored_cubic(motion: Motion, u: Any) -> Any:
    """Return f(u) from the roots of the record."""
    u1, u2, u3 = motion.roots
    return motion.a * (u1 - u) * (u - u2) * (u3 - u)


@equation("section 4 e: sign of u2")
def _() -> Sides:
    for motion in [*MOTIONS, SLOW]:
        lowest = motion.u(motion.T / 2)
        yield motion.a * motion.u3 * lowest, motion.b**2 * motion.u1 - motion.a
        yield ar.sign(motion.u3 - 1), 1


CONSTANTS: dict[str, Callable[[Motion], tuple[Any, Any]]] = {
    "(4,4)": lambda top: (top.a, 2 * top.mgs / top.A),
    "(4,5)": lambda top: (top.b, top.C * top.r0 / top.A),
    "(4,19)": lambda top: (top.k, ar.sqrt((top.u1 - top.u2) / (top.u3 - top.u2))),
    "(4,21)": lambda top: (top.k_prime, ar.sqrt((top.u3 - top.u1) / (top.u3 - top.u2))),
    "section 4 j: product of the two sn": lambda top: (
        top.kappa2 * top.at_parameter(1)[0] ** 2 * top.at_parameter(2)[0] ** 2,
        1,
    ),
}
"""Sides without time."""

chrapan.each(tops, CONSTANTS)


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

chrapan.each(lambda: ((*top.roots, top.b**2 / top.a) for top in MOTIONS), ROOTS)


@equation("(4,20)")
def _() -> Sides:
    for motion, t in moments():
        u1, u2, u3 = motion.roots
        sn, _, dn = motion.jacobi(t)
        yield motion.u(t), u3 - (u3 - u1) / dn**2
        yield motion.u(t), u1 - (u1 - u2) * (u3 - u1) / (u3 - u2) * (sn / dn) ** 2


def states() -> Iterator[tuple[Motion, Any, Any, Any]]:
    """Yield each top and time with u and xi^2."""
    for motion, t in moments():
        yield motion, t, motion.u(t), motion.xi(t) ** 2


STATES: dict[str, Callable[[Motion, Any, Any, Any], tuple[Any, Any]]] = {
    "(4,9)": lambda top, t, u, _: (slope(top.u, t) ** 2, _cubic(top, u)),
    "(4,22)": lambda top, t, u, _: (top.jacobi(t)[2] ** 2, (top.u3 - top.u1) / (top.u3 - u)),
    "(4,23)": lambda top, t, u, _: (
        top.jacobi(t)[0] ** 2,
        (top.u1 - u) * (top.u3 - top.u2) / ((top.u3 - u) * (top.u1 - top.u2)),
    ),
    "(4,24)": lambda top, t, u, _: (
        top.jacobi(t)[1] ** 2,
        (top.u3 - top.u1) * (u - top.u2) / ((top.u3 - u) * (top.u1 - top.u2)),
    ),
    "(4,25)": lambda top, t, u, xi2: (
        1 + u,
        (1 + top.u1) * (1 - (top.u1 - top.u2) / (1 + top.u1) * xi2),
    ),
    "(4,26)": lambda top, t, u, xi2: (
        1 - u,
        (1 - top.u1) * (1 + (top.u1 - top.u2) / (1 - top.u1) * xi2),
    ),
}
"""Sides at a time, with u and xi^2."""

chrapan.each(states, STATES)


@equation("section 4 g: u by the imaginary modulus")
def _() -> Sides:
    for motion, t in moments():
        u1, u2, u3 = motion.roots
        u, xi2 = motion.u(t), motion.xi(t) ** 2
        yield u1 - u, (u1 - u2) * xi2
        yield u - u2, (u1 - u2) * (1 - xi2)
        yield u3 - u, (u3 - u1) * (1 - motion.kappa2 * xi2)


def _precession_rate(motion: Motion, t: Any, power: int) -> Any:
    """Return the rate of section 4 ch, with the power of kappa in its first numerator."""
    xi2, kappa = motion.xi(t) ** 2, ar.sqrt(motion.kappa2)
    first, second = (motion.kappa2 * motion.at_parameter(i)[0] ** 2 * xi2 for i in (1, 2))
    return motion.b / 2 * (kappa ** (power - 2) * first / (1 - first) - second / (1 - second))


@equation("section 4 k: rate of spin")
def _() -> Sides:
    for motion, t in moments():
        xi2 = motion.xi(t) ** 2
        first, second = (motion.kappa2 * motion.at_parameter(i)[0] ** 2 * xi2 for i in (1, 2))
        waves = first / (1 - first) + second / (1 - second)
        yield motion.rates(t)[1], motion.r0 + motion.b / 2 * waves


def _printed_at_parameters(motion: Motion) -> list[Any]:
    """Return sn, cn, dn of alpha1, then of alpha2, as section 4 i prints them."""
    u1, u2, u3 = motion.roots
    south = [J * ar.sqrt(u3 - u1), ar.sqrt(u3 + 1), ar.sqrt(1 + u2)]
    north = [ar.sqrt(u3 - u1), J * ar.sqrt(u3 - 1), ar.sqrt(1 - u2)]
    return [x / ar.sqrt(1 + u1) for x in south] + [x / ar.sqrt(1 - u1) for x in north]


@equation("section 4 i: sn, cn, dn of the parameters")
def _() -> Sides:
    for motion in MOTIONS:
        ours = motion.at_parameter(1) + motion.at_parameter(2)
        printed = _printed_at_parameters(motion)
        yield from zip([x**2 for x in ours], [x**2 for x in printed], strict=True)
        signs = (1, 1, 1, -1, 1, -1)
        yield from zip(
            ours, [sign * x for sign, x in zip(signs, printed, strict=True)], strict=True
        )


@as_printed("section 4 i: sn, cn, dn of the parameters")
def _() -> Sides:
    for motion in MOTIONS:
        sn, _, dn = motion.at_parameter(2)
        _, _, _, printed_sn, _, printed_dn = _printed_at_parameters(motion)
        yield sn, printed_sn
        yield dn, printed_dn


def _quotient(motion: Motion, v: Any) -> Any:
    """Return sn/(cn dn) for the imaginary modulus, v already stretched to the real one."""
    sn, cn, dn = (ar.ellipfun(name, v, m=motion.k**2) for name in ("sn", "cn", "dn"))
    return motion.k_prime * sn * dn / cn


@equation("line before (4,27)")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.roots
        right = J * ar.sqrt((u3 - u1) * (1 + u1) / ((u3 + 1) * (1 + u2)))
        sn, cn, dn = motion.at_parameter(1)
        yield sn / (cn * dn), right


@as_printed("line before (4,27)")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.roots
        right = J * ar.sqrt((u3 + u1) * (1 + u1) / ((u3 + 1) * (1 + u2)))
        yield _quotient(motion, J * motion.alpha), right


def _pi(motion: Motion, t: Any) -> tuple[Any, Any]:
    """Return Pi00 and Pi11 of section 4 j."""
    place = motion.w(t), J * motion.alpha, motion.k
    return pi_function("00", *place), pi_function("11", *place)


def _precession(motion: Motion, t: Any, sigma: Any) -> tuple[Any, Any]:
    """Return the precession and (4,29) for a direction of spin."""
    even, odd = _pi(motion, t)
    return motion.angles(t)[2], sigma * J * (even + odd + J * ar.pi / 2)


def _spin(motion: Motion, t: Any, sigma: Any) -> tuple[Any, Any]:
    """Return the spin and (4,34) for a direction of spin."""
    even, odd = _pi(motion, t)
    return motion.angles(t)[1], motion.r0 * t + sigma * J * (even - odd - J * ar.pi / 2)


def _argument(motion: Motion, t: Any, stretch: Any) -> tuple[Any, Any]:
    """Return w of (4,30), and eta times a factor that should be sqrt(1 + k_bar^2)."""
    eta = ar.sqrt(motion.a * (motion.u3 - motion.u1)) * t / 2
    return 2 * motion.K * t / motion.T, eta * stretch


def _of_w(motion: Motion, t: Any, part: int) -> tuple[Any, Any]:
    """Return dn^2 w and its value by section 4 l, where w has the factor 1/part."""
    w = ar.sqrt(motion.a * (motion.u3 - motion.u2)) * t / part
    value = (motion.u3 - motion.u1) / (motion.u3 - motion.u(t))
    return ar.ellipfun("dn", w, m=motion.k**2) ** 2, value


def _at_parameter(motion: Motion, sign: int, b: Any) -> tuple[Any, Any]:
    """Return both sides of (4,27), or with sign = -1 of (4,28)."""
    v = J * motion.alpha + (0 if sign == 1 else J * motion.K_prime + motion.K)
    return _quotient(motion, v), sign * J * ar.sqrt(motion.a * (motion.u3 - motion.u1)) / b


def _at_alpha(motion: Motion, name: str, numerator: Any) -> tuple[Any, Any]:
    """Return a function of alpha for k', and its value by the roots."""
    value = ar.ellipfun(name, motion.alpha, m=1 - motion.k**2)
    return value, ar.sqrt(numerator / (motion.u3 + 1))


@equation("(4,30)")
def _() -> Sides:
    for motion, t in moments():
        u1, u2, u3 = motion.roots
        yield _argument(motion, t, ar.sqrt((u3 - u2) / (u3 - u1)))
        yield _argument(motion, t, ar.sqrt(1 - motion.kappa2))
        yield 2 * motion.K * t / motion.T, motion.w(t)


chrapan.each(
    moments,
    {
        "section 4 ch: rate of precession": lambda top, t: (
            top.rates(t)[2],
            _precession_rate(top, t, 2),
        ),
        "(4,29)": lambda top, t: _precession(top, t, top.sigma),
        "section 4 l: w": lambda top, t: _of_w(top, t, 2),
        "(4,34)": lambda top, t: _spin(top, t, top.sigma),
    },
)
chrapan.each(
    tops,
    {
        "(4,27)": lambda top: _at_parameter(top, 1, abs(top.b)),
        "(4,28)": lambda top: _at_parameter(top, -1, abs(top.b)),
        "(4,31)": lambda top: _at_alpha(top, "cn", 1 + top.u2),
        "(4,32)": lambda top: _at_alpha(top, "sn", top.u3 - top.u2),
        "(4,33)": lambda top: _at_alpha(top, "dn", 1 + top.u1),
    },
)
chrapan.each_as_printed(
    lambda: [(RIGHT, RIGHT.T / 3)],
    {
        "section 4 ch: rate of precession as printed, the power": lambda top, t: (
            top.rates(t)[2],
            _precession_rate(top, t, 3),
        ),
        "section 4 ch: rate of precession as printed, the left side": lambda top, t: (
            top.rates(t)[1],
            _precession_rate(top, t, 2),
        ),
        "(4,30) as printed, the roots": lambda top, t: _argument(
            top, t, ar.sqrt((top.u3 + top.u2) / (top.u3 - top.u2))
        ),
        "(4,30) as printed, the modulus": lambda top, t: _argument(top, t, ar.sqrt(1 + top.k**2)),
        "section 4 l: w": lambda top, t: _of_w(top, t, 3),
    },
)
chrapan.each_as_printed(
    lambda: [(LEFT, LEFT.T / 3)],
    {
        "(4,27)": lambda top, _: _at_parameter(top, 1, top.b),
        "(4,28)": lambda top, _: _at_parameter(top, -1, top.b),
        "(4,29)": lambda top, t: _precession(top, t, 1),
        "(4,34)": lambda top, t: _spin(top, t, 1),
    },
)


class TestChrapan(EquationTests):
    """Tests of the register."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = misprints("Chrapan", 4)

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put tops in place whose record and angles are wrong."""
        spoil(patch, __name__)
