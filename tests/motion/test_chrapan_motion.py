"""Chrapan's sections 4 to 7, equation by equation, for tops of both directions of spin.

On one side stand our angles and constants in many digits; on the other definitions: the rotation
matrix, Euler's equations with slopes of our angles, mpmath's elliptic functions, quadratures.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest
from equations import Register, Sides

from lagrange_cli import Top
from lagrange_cli.arithmetic.generic import many_digits
from lagrange_cli.elliptic.modulus import modulus
from lagrange_cli.elliptic.theta import pi_function
from lagrange_cli.motion.digits import angles_in
from lagrange_cli.motion.released import released_record

chrapan = Register()
equation, as_printed = chrapan.equation, chrapan.as_printed

ar = many_digits(150)
"""Slopes over 1e-45 leave 80 digits of these."""
J, STEP = ar.mpc(0, 1), ar.mpf(10) ** -45


class Motion:
    """A top under the names of the text: phi is the spin, psi the precession."""

    def __init__(self, **inputs: float) -> None:
        top = Top(**inputs)
        inputs_in_order = (top.m, top.A, top.C, top.s, top.g, top.r0)
        self.m, self.A, self.C, self.s, self.g, self.r0 = map(ar.mpf, inputs_in_order)
        self.mgs, self.sigma = self.m * self.g * self.s, ar.sign(self.r0)
        self.of: Any = released_record(ar, top)
        self.angles = angles_in(ar, top)
        self.T: Any = self.of.T_nutation
        self.y: Any = ar.pi * self.of.alpha / self.of.K / 2

    def rates(self, t: Any) -> list[Any]:
        """Slopes of theta, phi, psi."""
        return [slope(partial(_part, self.angles, i), t) for i in range(3)]

    def u(self, t: Any) -> Any:
        return ar.cos(self.angles(t)[0])

    def w(self, t: Any) -> Any:
        """(4,30)."""
        return ar.sqrt(self.of.a * (self.of.u3 - self.of.u2)) * t / 2

    def jacobi(self, t: Any) -> list[Any]:
        """sn, cn, dn of w by mpmath, w reduced by whole periods of the nutation."""
        w, m = self.w(t - self.T * ar.floor(t / self.T)), self.of.k**2
        return [ar.ellipfun(name, w, m=m) for name in ("sn", "cn", "dn")]

    def body_rates(self, t: Any) -> tuple[Any, Any]:
        """p and q of (4,1)."""
        (theta, phi, *_), (nutation, _, precession) = self.angles(t), self.rates(t)
        around = precession * ar.sin(theta)
        p = around * ar.sin(phi) + nutation * ar.cos(phi)
        return p, around * ar.cos(phi) - nutation * ar.sin(phi)

    def spin_arccot(self, t: Any) -> Any:
        """The arccot of (6,1), in (0, pi) with the sign of cn w."""
        sn, cn, dn = self.jacobi(t)
        rho = ar.sqrt((self.of.u3 - self.of.u2) / (self.of.u3 + self.of.u2))
        return ar.atan2(sn * dn, rho * cn)

    def precession_arccot(self, t: Any) -> Any:
        """arccot(cot x tanh y) of (7,1), in (0, pi)."""
        x = ar.pi * (t / self.T - ar.floor(t / self.T))
        return ar.atan2(ar.sin(x), ar.cos(x) * ar.tanh(self.y))

    def series(self, t: Any) -> Any:
        """S of (7,1)."""
        x2, y2, q = 2 * ar.pi * t / self.T, 2 * self.y, self.of.nome
        sine, cosine = ar.sin(x2) * ar.sinh(y2), ar.cos(x2) * ar.cosh(y2)
        signs = [(-1) ** (h - 1) * 2 * q**h for h in range(1, 400)]
        squares = [1 + q ** (2 * h) for h in range(1, 400)]
        return sum(
            ar.atan(s * sine / (p + s * cosine)) for s, p in zip(signs, squares, strict=True)
        )

    def growth(self) -> Any:
        """E(phi, k'), F(phi, k') and 1 - E/K of (7,1)."""
        phi = ar.asin(ar.sqrt((self.of.u3 - self.of.u2) / (self.of.u3 + 1)))
        m = 1 - self.of.k**2
        return ar.ellipe(phi, m), ar.ellipf(phi, m), 1 - self.of.E / self.of.K


def _part(function: Callable[[Any], Any], i: int, t: Any) -> Any:
    """One of several values."""
    return function(t)[i]


def slope(function: Callable[[Any], Any], x: Any) -> Any:
    """Central difference."""
    return (function(x + STEP) - function(x - STEP)) / (2 * STEP)


RIGHT = Motion()
LEFT = Motion(m=1.0, A=1.0, C=0.75, s=1.0, g=1.0, r0=-2.5, theta0_deg=100.0)
FAST = Motion(m=1.0, A=1.0, C=1.5, s=0.5, g=2.0, r0=4.0, theta0_deg=40.0)
MOTIONS = [RIGHT, LEFT, FAST]
PARTS = [ar.mpf(x) for x in ("0.13", "0.31", "0.62", "0.87", "1.7", "-0.4")]


def moments(*parts: Any) -> Iterator[tuple[Motion, Any]]:
    """Each top at times in periods."""
    for motion in MOTIONS:
        for part in parts or PARTS:
            yield motion, part * motion.T


def rotation(motion: Motion, t: Any) -> Any:
    """From body to space, by turns about z, the line of nodes, and z'."""

    def about_z(angle: Any) -> Any:
        c, s = ar.cos(angle), ar.sin(angle)
        return ar.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    theta, phi, psi, _ = motion.angles(t)
    c, s = ar.cos(theta), ar.sin(theta)
    return about_z(psi) * ar.matrix([[1, 0, 0], [0, c, -s], [0, s, c]]) * about_z(phi)


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
    theta, phi, *_ = motion.angles(t)
    nutation, spin, _ = motion.rates(t)
    p, _ = motion.body_rates(t)
    yield p, spin * ar.sin(theta) * ar.sin(phi) + nutation * ar.cos(phi)


@equation("Euler's equations")
def _() -> Sides:
    for motion, t in moments(*PARTS[:2]):
        theta, phi, *_ = motion.angles(t)
        p, q = motion.body_rates(t)
        p_rate, q_rate = (slope(partial(_part, motion.body_rates, i), t) for i in (0, 1))
        pull = motion.mgs * ar.sin(theta)
        gyro = (motion.C - motion.A) * motion.r0
        yield motion.A * p_rate + gyro * q, pull * ar.cos(phi)
        yield motion.A * q_rate - gyro * p, -pull * ar.sin(phi)


@equation("(4,2)")
def _() -> Sides:
    for motion, t in moments():
        nutation, _, precession = motion.rates(t)
        left = motion.A * (nutation**2 + precession**2 * (1 - motion.u(t) ** 2))
        yield left, 2 * motion.mgs * (motion.of.u1 - motion.u(t))


@as_printed("(4,2)")
def _() -> Sides:
    motion, t = RIGHT, PARTS[0] * RIGHT.T
    nutation, spin, _ = motion.rates(t)
    left = motion.A * (nutation**2 + spin**2 * (1 - motion.u(t) ** 2))
    yield left, 2 * motion.mgs * (motion.of.u1 - motion.u(t))


@equation("(4,3)")
def _() -> Sides:
    for motion, t in moments():
        left = motion.A * (1 - motion.u(t) ** 2) * motion.rates(t)[2]
        yield left, motion.C * motion.r0 * (motion.of.u1 - motion.u(t))


@as_printed("(4,3)")
def _() -> Sides:
    motion, t = RIGHT, PARTS[0] * RIGHT.T
    left = motion.A * (1 - motion.u(t) ** 2) * motion.rates(t)[1]
    yield left, motion.C * motion.r0 * (motion.of.u1 - motion.u(t))


@equation("(4,4)")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.of.a, 2 * motion.mgs / motion.A


@equation("(4,5)")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.of.b, motion.C * motion.r0 / motion.A


@equation("(4,6)")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.of.u1, motion.u(ar.mpf(0))
        yield motion.of.u2, motion.u(motion.T / 2)


@equation("(4,7)")
def _() -> Sides:
    for motion, t in moments():
        u = motion.u(t)
        yield motion.rates(t)[2], motion.of.b * (motion.of.u1 - u) / (1 - u * u)


@as_printed("(4,7)")
def _() -> Sides:
    motion, t = RIGHT, PARTS[0] * RIGHT.T
    u = motion.u(t)
    yield motion.rates(t)[1], motion.of.b * (motion.of.u1 - u) / (1 - u * u)


@equation("(4,8)")
def _() -> Sides:
    for motion, t in moments():
        u = motion.u(t)
        yield motion.rates(t)[1], motion.r0 - motion.of.b * u * (motion.of.u1 - u) / (1 - u * u)


@as_printed("(4,8)")
def _() -> Sides:
    motion, t = RIGHT, PARTS[0] * RIGHT.T
    u = motion.u(t)
    yield motion.rates(t)[2], motion.r0 - motion.of.b * u * (motion.of.u1 - u) / (1 - u * u)


def _cubic(motion: Motion, u: Any) -> Any:
    a, b, u1 = motion.of.a, motion.of.b, motion.of.u1
    return (1 - u * u) * (a * u1 - a * u) - (b * u1 - b * u) ** 2


@equation("(4,9)")
def _() -> Sides:
    for motion, t in moments():
        yield slope(motion.u, t) ** 2, _cubic(motion, motion.u(t))


@equation("(4,10)")
def _() -> Sides:
    for motion in MOTIONS:
        a, b, u1 = motion.of.a, motion.of.b, motion.of.u1
        root = ar.sqrt(b**4 - 4 * a * b**2 * u1 + 4 * a**2)
        for u, ours in zip(
            ((b**2 - root) / (2 * a), (b**2 + root) / (2 * a)), motion.of[5:7], strict=True
        ):
            yield ours, u
            yield -a * ours**2 + b**2 * ours - (b**2 * u1 - a), ar.mpf(0)


ROOTS: dict[str, Callable[..., Any]] = {
    "(4,11)": lambda u1, u2, u3, b: (u3 + u2, b),
    "sum of products": lambda u1, u2, u3, b: (u1 * u2 + u1 * u3 - u2 * u3, 1),
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

for _name, _sides in ROOTS.items():

    @equation(_name)
    def _(sides: Callable[..., Any] = _sides) -> Sides:
        for motion in MOTIONS:
            yield sides(*motion.of[4:7], motion.of.b**2 / motion.of.a)


@equation("(4,19)")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.of[4:7]
        yield motion.of.k, ar.sqrt((u1 - u2) / (u3 - u2))


@equation("(4,20)")
def _() -> Sides:
    for motion, t in moments():
        u1, u2, u3 = motion.of[4:7]
        sn, _, dn = motion.jacobi(t)
        yield motion.u(t), u3 - (u3 - u1) / dn**2
        yield motion.u(t), u1 - (u1 - u2) * (u3 - u1) / (u3 - u2) * (sn / dn) ** 2


@equation("(4,21)")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.of[4:7]
        yield motion.of.k_prime, ar.sqrt((u3 - u1) / (u3 - u2))


@equation("(4,22)")
def _() -> Sides:
    for motion, t in moments():
        u1, _, u3 = motion.of[4:7]
        yield motion.jacobi(t)[2] ** 2, (u3 - u1) / (u3 - motion.u(t))


@equation("(4,23)")
def _() -> Sides:
    for motion, t in moments():
        (u1, u2, u3), u = motion.of[4:7], motion.u(t)
        yield motion.jacobi(t)[0] ** 2, (u1 - u) * (u3 - u2) / ((u3 - u) * (u1 - u2))


@equation("(4,24)")
def _() -> Sides:
    for motion, t in moments():
        (u1, u2, u3), u = motion.of[4:7], motion.u(t)
        yield motion.jacobi(t)[1] ** 2, (u3 - u1) * (u - u2) / ((u3 - u) * (u1 - u2))


@equation("(4,25)")
def _() -> Sides:
    for motion, t in moments():
        (u1, u2, _), u = motion.of[4:7], motion.u(t)
        yield 1 + u, (1 + u1) * (1 - (u1 - u2) * (u1 - u) / (u1 - u2) / (1 + u1))


@equation("(4,26)")
def _() -> Sides:
    for motion, t in moments():
        (u1, u2, _), u = motion.of[4:7], motion.u(t)
        yield 1 - u, (1 - u1) * (1 + (u1 - u2) * (u1 - u) / (u1 - u2) / (1 - u1))


def _quotient(motion: Motion, v: Any) -> Any:
    """sn/(cn dn) for the imaginary modulus i k_bar, v already stretched to the real one."""
    sn, cn, dn = (ar.ellipfun(name, v, m=motion.of.k**2) for name in ("sn", "cn", "dn"))
    return motion.of.k_prime * sn * dn / cn


def _size(motion: Motion, b: Any) -> Any:
    return ar.sqrt(motion.of.a * (motion.of.u3 - motion.of.u1)) / b


@equation("(4,27)")
def _() -> Sides:
    for motion in MOTIONS:
        yield _quotient(motion, J * motion.of.alpha), J * _size(motion, abs(motion.of.b))


@as_printed("(4,27)")
def _() -> Sides:
    yield _quotient(LEFT, J * LEFT.of.alpha), J * _size(LEFT, LEFT.of.b)


@equation("(4,28)")
def _() -> Sides:
    for motion in MOTIONS:
        v = J * motion.of.alpha + J * motion.of.K_prime + motion.of.K
        yield _quotient(motion, v), -J * _size(motion, abs(motion.of.b))


@as_printed("(4,28)")
def _() -> Sides:
    v = J * LEFT.of.alpha + J * LEFT.of.K_prime + LEFT.of.K
    yield _quotient(LEFT, v), -J * _size(LEFT, LEFT.of.b)


def _pi(motion: Motion, t: Any) -> tuple[Any, Any]:
    given = modulus(ar, k=motion.of.k)
    w, parameter = motion.w(t), J * motion.of.alpha
    return pi_function(ar, "00", w, parameter, given), pi_function(ar, "11", w, parameter, given)


@equation("(4,29)")
def _() -> Sides:
    for motion, t in moments():
        even, odd = _pi(motion, t)
        yield motion.angles(t)[2], motion.sigma * J * (even + odd + J * ar.pi / 2)


@as_printed("(4,29)")
def _() -> Sides:
    even, odd = _pi(LEFT, LEFT.T / 3)
    yield LEFT.angles(LEFT.T / 3)[2], J * (even + odd + J * ar.pi / 2)


@equation("(4,30)")
def _() -> Sides:
    for motion, t in moments():
        u1, u2, u3 = motion.of[4:7]
        eta = ar.sqrt(motion.of.a * (u3 - u1)) * t / 2
        yield 2 * motion.of.K * t / motion.T, eta * ar.sqrt((u3 - u2) / (u3 - u1))


@as_printed("(4,30)")
def _() -> Sides:
    t, (u1, u2, u3) = RIGHT.T / 3, RIGHT.of[4:7]
    eta = ar.sqrt(RIGHT.of.a * (u3 - u1)) * t / 2
    yield 2 * RIGHT.of.K * t / RIGHT.T, eta * ar.sqrt((u3 + u2) / (u3 - u2))


def _at_alpha(name: str, numerator: Callable[..., Any]) -> Callable[[], Sides]:
    def sides() -> Sides:
        for motion in MOTIONS:
            u1, u2, u3 = motion.of[4:7]
            left = ar.ellipfun(name, motion.of.alpha, m=1 - motion.of.k**2)
            yield left, ar.sqrt(numerator(u1, u2, u3) / (u3 + 1))

    return sides


equation("(4,31)")(_at_alpha("cn", lambda u1, u2, u3: 1 + u2))
equation("(4,32)")(_at_alpha("sn", lambda u1, u2, u3: u3 - u2))
equation("(4,33)")(_at_alpha("dn", lambda u1, u2, u3: 1 + u1))


@equation("(4,34)")
def _() -> Sides:
    for motion, t in moments():
        even, odd = _pi(motion, t)
        right = motion.r0 * t + motion.sigma * J * (even - odd - J * ar.pi / 2)
        yield motion.angles(t)[1], right


@as_printed("(4,34)")
def _() -> Sides:
    t = LEFT.T / 3
    even, odd = _pi(LEFT, t)
    yield LEFT.angles(t)[1], LEFT.r0 * t + J * (even - odd - J * ar.pi / 2)


@equation("(5,1)")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.of[4:7]

        def inverse_rate(chi: Any, of: Motion = motion) -> Any:
            u1, u2, u3 = of.of[4:7]
            u = u1 - (u1 - u2) * ar.sin(chi) ** 2
            return 4 / ar.sqrt(of.of.a * (u3 - u))

        with ar.workdps(50):
            yield motion.T, ar.quad(inverse_rate, [0, ar.pi / 4, ar.pi / 2])
        yield motion.T, 4 * ar.ellipk((u1 - u2) / (u3 - u2)) / ar.sqrt(motion.of.a * (u3 - u2))


@equation("(5,2)")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.of[4:7]
        for part in (1, 3):
            yield motion.u(part * motion.T / 4), u3 - ar.sqrt((u3 - u1) * (u3 - u2))
        yield motion.of.u_quarter, motion.u(motion.T / 4)


def _nutation_rate(motion: Motion, t: Any) -> Any:
    (u1, u2, u3), u = motion.of[4:7], motion.u(t)
    return ar.sqrt(motion.of.a * (u1 - u) * (u - u2) * (u3 - u) / (1 - u * u))


@equation("(5,3)")
def _() -> Sides:
    for motion, t in moments():
        sign = ar.sign(ar.sin(2 * ar.pi * t / motion.T))
        yield motion.rates(t)[0], sign * _nutation_rate(motion, t)


@as_printed("(5,3)")
def _() -> Sides:
    yield RIGHT.rates(RIGHT.T * 3 / 4)[0], _nutation_rate(RIGHT, RIGHT.T * 3 / 4)


def _quarters(motion: Motion) -> tuple[Any, Any]:
    """How far the tilt goes in the first and in the second quarter of a period."""
    start, middle, end = (motion.angles(part * motion.T / 4)[0] for part in (0, 1, 2))
    return middle - start, end - middle


@equation("section 5: u moves less in the first quarter")
def _() -> Sides:
    for motion in MOTIONS:
        first, second = (motion.of.u1 - motion.of.u_quarter, motion.of.u_quarter - motion.of.u2)
        yield ar.sign(second - first), 1


@as_printed("section 5: so does the tilt")
def _() -> Sides:
    upright = Motion(m=1.0, A=1.0, C=0.375, s=1.0, g=1.0, r0=40.0, theta0_deg=1.0)
    first, second = _quarters(upright)
    yield ar.sign(second - first), 1


def _steady_spin(motion: Motion) -> Any:
    return motion.r0 * (1 - motion.C / (2 * motion.A))


@equation("(6,1)")
def _() -> Sides:
    for motion, t in moments():
        turned = ar.pi * ar.floor(t / motion.T) + motion.spin_arccot(t)
        yield motion.angles(t)[1], _steady_spin(motion) * t + motion.sigma * turned


@as_printed("(6,1)")
def _() -> Sides:
    t, (u1, u2, u3) = RIGHT.T * 3 / 4, RIGHT.of[4:7]
    u = RIGHT.u(t)
    arccot = ar.acot(ar.sqrt((u3 - u) * (u - u2) / ((u3 + u2) * (u1 - u))))
    yield RIGHT.angles(t)[1], _steady_spin(RIGHT) * t + arccot


@equation("(6,2)")
def _() -> Sides:
    for motion in MOTIONS:
        half = motion.r0 - 2 * motion.mgs / (motion.C * motion.r0) * motion.of.u2
        yield motion.rates(motion.T)[1], motion.r0
        yield motion.rates(motion.T / 2)[1], half
        yield motion.of.spin_rate_half, half


@equation("(6,3)")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.angles(motion.T)[1] / motion.T, motion.of.mean_spin_rate
        yield motion.of.mean_spin_rate, _steady_spin(motion) + motion.sigma * ar.pi / motion.T


@as_printed("(6,3)")
def _() -> Sides:
    yield LEFT.of.mean_spin_rate, _steady_spin(LEFT) + ar.pi / LEFT.T


def _spin_remainder(motion: Motion, t: Any, halves: bool) -> Any:
    """(6,5), with the time since the last whole period or, as printed, half period."""
    unit = motion.T / 2 if halves else motion.T
    tau = t - unit * ar.floor(t / unit)
    return motion.sigma * (motion.spin_arccot(tau) - ar.pi * tau / motion.T)


for _number in ("(6,4)", "(6,5)", "(6,6)"):

    @equation(_number)
    def _() -> Sides:
        for motion, t in moments():
            left = motion.angles(t)[1] - motion.of.mean_spin_rate * t
            yield left, _spin_remainder(motion, t, halves=False)


@as_printed("(6,4)")
def _() -> Sides:
    t = RIGHT.T * 5 / 8
    left = RIGHT.angles(t)[1] - RIGHT.of.mean_spin_rate * t
    yield left, _spin_remainder(RIGHT, t, halves=True)


def _precession(motion: Motion, t: Any, growth: Any) -> Any:
    """(7,1) with its bracket."""
    u2, u3 = motion.of[5:7]
    drift = motion.mgs / (motion.C * motion.r0) * (2 - (u3 - u2)) * t
    waves = ar.pi * ar.floor(t / motion.T) + motion.precession_arccot(t) + motion.series(t)
    rate = ar.sqrt(motion.of.a * (u3 - u2))
    return drift + motion.sigma * (rate * t * growth - waves)


@equation("(7,1)")
def _() -> Sides:
    for motion, t in moments():
        E, F, rest = motion.growth()
        yield motion.angles(t)[2], _precession(motion, t, E - F * rest)


@as_printed("(7,1)")
def _() -> Sides:
    t = RIGHT.T / 3
    E, F, rest = RIGHT.growth()
    yield RIGHT.angles(t)[2], _precession(RIGHT, t, (E - F) * rest)


@equation("(7,2)")
def _() -> Sides:
    for motion in MOTIONS:
        u2, u3 = motion.of[5:7]
        amplitude = ar.asin(ar.sqrt((u3 - u2) / (u3 + 1)))
        yield motion.of.amplitude_deg, ar.degrees(amplitude)
        yield motion.of.alpha, ar.ellipf(amplitude, 1 - motion.of.k**2)


@equation("rates of the precession in section 7")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.rates(motion.T)[2], 0
        yield motion.rates(motion.T / 2)[2], 2 * motion.mgs / (motion.C * motion.r0)


def _mean_precession(motion: Motion, sigma: Any) -> Any:
    u2, u3 = motion.of[5:7]
    E, F, rest = motion.growth()
    curve = motion.of.K * (E - F * rest) - ar.pi / 4
    return motion.mgs / (motion.C * motion.r0) * (2 - (u3 - u2)) + sigma * 4 / motion.T * curve


@equation("(7,3)")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.of.mean_precession_rate, _mean_precession(motion, motion.sigma)
        yield motion.of.mean_precession_rate, motion.angles(motion.T)[2] / motion.T


@as_printed("(7,3)")
def _() -> Sides:
    yield LEFT.of.mean_precession_rate, _mean_precession(LEFT, 1)


def _precession_remainder(motion: Motion, t: Any, halves: bool) -> Any:
    """(7,4), with the time since the last whole period or, as printed, half period."""
    unit = motion.T / 2 if halves else motion.T
    tau = t - unit * ar.floor(t / unit)
    waves = motion.precession_arccot(tau) + motion.series(tau)
    return motion.sigma * (ar.pi * tau / motion.T - waves)


for _number in ("(7,4)", "(7,5)"):

    @equation(_number)
    def _() -> Sides:
        for motion, t in moments():
            left = motion.angles(t)[2] - motion.of.mean_precession_rate * t
            yield left, _precession_remainder(motion, t, halves=False)


@as_printed("(7,4)")
def _() -> Sides:
    t = RIGHT.T * 5 / 8
    left = RIGHT.angles(t)[2] - RIGHT.of.mean_precession_rate * t
    yield left, _precession_remainder(RIGHT, t, halves=True)


@pytest.mark.parametrize("number", chrapan.holds)
def test_equation(number: str) -> None:
    chrapan.check(number)


@pytest.mark.parametrize("number", chrapan.fails)
def test_as_printed_it_fails(number: str) -> None:
    chrapan.check_as_printed(number)


def test_the_register_is_complete() -> None:
    last = {4: 34, 5: 3, 6: 6, 7: 5}
    numbers = {f"({part},{i})" for part, end in last.items() for i in range(1, end + 1)}
    assert numbers <= set(chrapan.holds)
