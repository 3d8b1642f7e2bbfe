"""Chrapan's sections 4 to 8, equation by equation, for tops of both directions of spin.

On one side stand the angles and the record of the program in 150 digits; on the other definitions:
the rotation matrix, Euler's equations with slopes of those angles, quadratures, and mpmath's
elliptic functions, those of the paper's imaginary modulus too.  mpmath takes this modulus as it is,
in sn, cn, dn, in K, and in the theta functions, whose nome is then negative; so do our own
functions.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property, partial
from itertools import chain
from typing import Any, ClassVar

import pytest
from equations import EquationTests, Register, page
from errata import misprints
from lagtop import Top
from ours import ManyDigits, Ours

from lagrange_cli.solver.columns import DEFAULT_COLUMNS
from lagrange_cli.solver.solve import solve
from lagrange_cli.solver.tables import ProvedTable
from lagrange_cli.top.units import Units

# The tops of the text: the record and the angles of the program in 150 digits, by his names

DIGITS = 150
ar = ManyDigits(DIGITS + 10)
"""Slopes over 1e-45 leave 100 of the digits, second slopes 60."""
ours = Ours(ar)
J, STEP = ar.mpc(0, 1), ar.mpf(10) ** -45


class Motion:
    """A top: the numbers of its record, and its angles over time."""

    def __init__(self, **inputs: float) -> None:
        self.motion = solve(Top(**inputs))
        self._rows: dict[Fraction, tuple[Any, ...]] = {}
        self._table = ProvedTable(self.motion, DEFAULT_COLUMNS, DIGITS, units=Units(radians=True))

    @cached_property
    def numbers(self) -> dict[str, Any]:
        """Numbers of the record, in all the digits."""
        texts = self.motion.record(digits=DIGITS)
        return {key: ar.mpf(x) for key, x in texts.items() if x is not None and x[-1:].isdigit()}

    def angles(self, t: Any) -> tuple[Any, ...]:
        """Return theta, phi, psi, computed once for times that differ by their last digits."""
        exact = Fraction(int(ar.nint(t * 2**500)), 2**500)
        if exact not in self._rows:
            row = self._table.row(exact)[1:]
            self._rows[exact] = tuple(ar.mpf(number.value) for number in row)
        return self._rows[exact]


class SpoiledMotion(Motion):
    """A motion whose record and angles are slightly wrong, each number by a factor of its own."""

    @cached_property
    def numbers(self) -> dict[str, Any]:
        """Numbers of the record, too large."""
        right = super().numbers
        return {key: x * (1 + ar.mpf(i) / 4000) for i, (key, x) in enumerate(right.items(), 1)}

    def angles(self, t: Any) -> tuple[Any, ...]:
        """Return angles that are too large."""
        factors = map(ar.mpf, ("1.001", "1.002", "1.003"))
        return tuple(x * factor for x, factor in zip(super().angles(t), factors, strict=True))


class Moment:
    """A top at a time, by the names of the text: phi is the spin, psi the precession.

    Its other attributes are the numbers of the record.
    """

    def __init__(self, motion: Motion, t: Any) -> None:
        self.motion, self.t, self.now = motion, t, self
        self.T = self.T_nutation
        self.mgs, self.sigma = self.m * self.g * self.s, ar.sign(self.r0)
        self.elementary = self.mgs / (self.C * self.r0)
        self.kappa2 = -(self.u1 - self.u2) / (self.u3 - self.u1)
        self.kappa = J * ar.sqrt(-self.kappa2)
        self.tau, self.tau2 = (t - x * ar.floor(t / x) for x in (self.T, self.T / 2))

    def __getattr__(self, key: str) -> Any:
        """Return a number of the record: `moment.u2`."""
        if key in self.motion.numbers:
            return self.motion.numbers[key]
        raise AttributeError(key)

    def at(self, t: Any) -> Moment:
        """Return the top at another time."""
        return Moment(self.motion, t)

    def d(self, of: Any) -> Any:
        """Return the slope of an attribute, or of a function of a moment: a central difference."""
        later, before = (self.at(self.t + step) for step in (STEP, -STEP))
        if isinstance(of, str):
            return (getattr(later, of) - getattr(before, of)) / (2 * STEP)
        return (of(later) - of(before)) / (2 * STEP)

    theta = property(lambda self: self.motion.angles(self.t)[0])
    phi = property(lambda self: self.motion.angles(self.t)[1])
    psi = property(lambda self: self.motion.angles(self.t)[2])
    dphi = property(lambda self: self.phi - self.mean_spin_rate * self.t)
    dpsi = property(lambda self: self.psi - self.mean_precession_rate * self.t)
    thetadot = property(lambda self: self.d("theta"))
    phidot = property(lambda self: self.d("phi"))
    psidot = property(lambda self: self.d("psi"))
    u = property(lambda self: ar.cos(self.theta))
    w = property(lambda self: ar.sqrt(self.a * (self.u3 - self.u2)) * self.t / 2)
    """The argument (4,30)."""
    eta = property(lambda self: ar.sqrt(self.a * (self.u3 - self.u1)) * self.t / 2)
    """The argument of section 4 g."""
    xi = property(lambda self: ar.re(self.imaginary(self.eta)[0]))
    """sn(eta, kappa) of section 4 g."""

    @property
    def p(self) -> Any:
        """The first rate of (4,1)."""
        around = self.psidot * ar.sin(self.theta)
        return around * ar.sin(self.phi) + self.thetadot * ar.cos(self.phi)

    @property
    def q(self) -> Any:
        """The second rate of (4,1)."""
        around = self.psidot * ar.sin(self.theta)
        return around * ar.cos(self.phi) - self.thetadot * ar.sin(self.phi)

    @cached_property
    def jacobi(self) -> list[Any]:
        """Functions sn, cn, dn of w by mpmath, w reduced by whole periods of the nutation."""
        w = self.at(self.tau).w
        return [ar.ellipfun(name, w, m=self.k**2) for name in ("sn", "cn", "dn")]

    def imaginary(self, v: Any) -> list[Any]:
        """Return sn, cn, dn by mpmath for the imaginary modulus of section 4 g itself."""
        return [ar.ellipfun(name, v, m=self.kappa2) for name in ("sn", "cn", "dn")]

    @property
    def parameters(self) -> tuple[Any, Any]:
        """Parameters alpha1 = i alpha k' and alpha2 = alpha1 + k' (iK' + K) of section 4 j."""
        first = J * self.alpha * self.k_prime
        return first, first + self.k_prime * (J * self.K_prime + self.K)

    @cached_property
    def six(self) -> list[Any]:
        """Functions sn, cn, dn of both parameters for the imaginary modulus."""
        return [*chain(*map(self.imaginary, self.parameters))]

    @property
    def spin_arccot(self) -> Any:
        """The arccot of (6,1), in (0, pi) with the sign of cn w."""
        sn, cn, dn = self.jacobi
        rho = ar.sqrt((self.u3 - self.u2) / (self.u3 + self.u2))
        return ar.atan2(sn * dn, rho * cn)

    @property
    def waves(self) -> Any:
        """The arccot of cot x tanh y, in (0, pi), and the sum S of (7,1), within a period."""
        x, y, q = ar.pi * self.tau / self.T, ar.pi * self.alpha / self.K / 2, self.nome
        sine, cosine = ar.sin(2 * x) * ar.sinh(2 * y), ar.cos(2 * x) * ar.cosh(2 * y)
        total = ar.atan2(ar.sin(x), ar.cos(x) * ar.tanh(y))
        for h in range(1, 250):
            sign = (-1) ** (h - 1) * 2 * q**h
            total += ar.atan(sign * sine / (1 + q ** (2 * h) + sign * cosine))
        return total


SCENES: list[dict[str, float]] = [
    {},
    {"m": 1.0, "A": 1.0, "C": 0.75, "s": 1.0, "g": 1.0, "r0": -2.5, "theta0_deg": 100.0},
    {"m": 1.0, "A": 1.0, "C": 1.5, "s": 0.5, "g": 2.0, "r0": 4.0, "theta0_deg": 40.0},
]
MOTIONS = [Motion(**scene) for scene in SCENES]
SPOILED: list[Motion] = [SpoiledMotion(**scene) for scene in SCENES]
RIGHT, LEFT = MOTIONS[:2]
SLOW = Motion(r0=10.0)
UPRIGHT = Motion(m=1.0, A=1.0, C=0.375, s=1.0, g=1.0, r0=40.0, theta0_deg=1.0)
PARTS = [ar.mpf(x) for x in ("0.13", "0.31", "0.62", "0.87", "1.7", "-0.4")]
FAR = [ar.mpf(x) for x in ("-7.6", "10.3", "1000.8")]


def moments(
    *parts: Any, of: Sequence[Motion] = (), more: Sequence[Motion] = ()
) -> Iterator[Moment]:
    """Yield tops, all of them and more or only some, at times given in their periods."""
    for motion in [*(of or MOTIONS), *more]:
        for part in parts or PARTS:
            yield Moment(motion, part * motion.numbers["T_nutation"])


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
        """Put tops in place whose record and angles are slightly wrong."""
        patch.setattr(sys.modules[__name__], "MOTIONS", SPOILED)
