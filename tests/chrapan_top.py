"""Tops of Chrapan's text: the record and the angles of the program in 150 digits, by his names."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import chain
from typing import Any

import pytest
from lagtop import Top
from ours import ManyDigits, Ours

from lagrange_cli.solver.columns import DEFAULT_COLUMNS
from lagrange_cli.solver.solve import solve
from lagrange_cli.solver.tables import ProvedTable
from lagrange_cli.top.units import Units

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


def spoil(patch: pytest.MonkeyPatch) -> None:
    """Put tops in place whose record and angles are slightly wrong."""
    patch.setattr(sys.modules[__name__], "MOTIONS", SPOILED)
