"""Tops of Chrapan's text: the record and the angles of the program in 150 digits, by his names."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cached_property, partial
from typing import Any

import pytest
from lagtop import Top
from ours import ManyDigits

from lagrange_cli.solver.columns import DEFAULT_COLUMNS
from lagrange_cli.solver.solve import solve
from lagrange_cli.solver.tables import ProvedTable


def rows_of(
    top: Top, times: Sequence[Any], digits: int, *, wrap: bool = False, radians: bool = False
) -> list[list[Any]]:
    """Return rows of t and the three angles with `digits` digits."""
    table = ProvedTable(solve(top), DEFAULT_COLUMNS, digits, wrap=wrap, radians=radians)
    return [[number.value for number in table.row(Fraction(t))] for t in times]


DIGITS = 150
ar = ManyDigits(DIGITS + 10)
"""Slopes over 1e-45 leave 100 of the digits, second slopes 60."""
J, STEP = ar.mpc(0, 1), ar.mpf(10) ** -45


class Motion:
    """A top under the names of the text: phi is the spin, psi the precession."""

    def __init__(self, **inputs: float) -> None:
        self.top = top = Top(**inputs)
        inputs_in_order = (top.m, top.A, top.C, top.s, top.g, top.r0)
        self.m, self.A, self.C, self.s, self.g, self.r0 = map(ar.mpf, inputs_in_order)
        self.mgs, self.sigma = self.m * self.g * self.s, ar.sign(self.r0)
        self._rows: dict[Fraction, tuple[Any, Any, Any]] = {}
        self._table = ProvedTable(solve(top), DEFAULT_COLUMNS, DIGITS, radians=True)

    @cached_property
    def numbers(self) -> dict[str, Any]:
        """Numbers of the record, in all the digits."""
        texts = solve(self.top).record(digits=DIGITS)
        return {key: ar.mpf(text) for key, text in texts.items() if _is_number(text)}

    def __getattr__(self, key: str) -> Any:
        """Return a number of the record: `motion.u2`."""
        try:
            return self.numbers[key]
        except KeyError:
            raise AttributeError(key) from None

    @property
    def T(self) -> Any:
        """Nutation period."""
        return self.T_nutation

    @property
    def roots(self) -> tuple[Any, Any, Any]:
        """Roots u1, u2, u3 of the cubic."""
        return self.u1, self.u2, self.u3

    @property
    def y(self) -> Any:
        """pi alpha/2K, as in (7,1)."""
        return ar.pi * self.alpha / self.K / 2

    def angles(self, t: Any) -> tuple[Any, Any, Any]:
        """Return theta, phi, psi at a time, computed once."""
        exact = _fraction(t)
        if exact not in self._rows:
            theta, phi, psi = (ar.mpf(number.value) for number in self._table.row(exact)[1:])
            self._rows[exact] = theta, phi, psi
        return self._rows[exact]

    def rates(self, t: Any) -> list[Any]:
        """Return the slopes of theta, phi, psi."""
        return [slope(partial(nth_value, self.angles, i), t) for i in range(3)]

    def u(self, t: Any) -> Any:
        """Return the cosine of the tilt."""
        return ar.cos(self.angles(t)[0])

    def w(self, t: Any) -> Any:
        """Return the argument (4,30)."""
        return ar.sqrt(self.a * (self.u3 - self.u2)) * t / 2

    def jacobi(self, t: Any) -> list[Any]:
        """Return sn, cn, dn of w by mpmath, w reduced by whole periods of the nutation."""
        w, m = self.w(t - self.T * ar.floor(t / self.T)), self.k**2
        return [ar.ellipfun(name, w, m=m) for name in ("sn", "cn", "dn")]

    @property
    def kappa2(self) -> Any:
        """Square of the imaginary modulus of section 4 g."""
        return -(self.u1 - self.u2) / (self.u3 - self.u1)

    @property
    def kappa(self) -> Any:
        """Imaginary modulus of section 4 g."""
        return J * ar.sqrt(-self.kappa2)

    def eta(self, t: Any) -> Any:
        """Return the argument of section 4 g."""
        return ar.sqrt(self.a * (self.u3 - self.u1)) * t / 2

    def imaginary(self, v: Any) -> list[Any]:
        """Return sn, cn, dn by mpmath for the imaginary modulus itself."""
        return [ar.ellipfun(name, v, m=self.kappa2) for name in ("sn", "cn", "dn")]

    def xi(self, t: Any) -> Any:
        """Return sn(eta, kappa) of section 4 g."""
        return ar.re(self.imaginary(self.eta(t))[0])

    @property
    def parameters(self) -> tuple[Any, Any]:
        """Parameters alpha1 = i alpha k' and alpha2 = alpha1 + k' (iK' + K) of section 4 j."""
        first = J * self.alpha * self.k_prime
        return first, first + self.k_prime * (J * self.K_prime + self.K)

    @cached_property
    def at_parameters(self) -> list[list[Any]]:
        """Functions sn, cn, dn of both parameters for the imaginary modulus."""
        return [self.imaginary(v) for v in self.parameters]

    def body_rates(self, t: Any) -> tuple[Any, Any]:
        """Return p and q of (4,1)."""
        (theta, phi, _), (nutation, _, precession) = self.angles(t), self.rates(t)
        around = precession * ar.sin(theta)
        p = around * ar.sin(phi) + nutation * ar.cos(phi)
        return p, around * ar.cos(phi) - nutation * ar.sin(phi)

    def spin_arccot(self, t: Any) -> Any:
        """Return the arccot of (6,1), in (0, pi) with the sign of cn w."""
        sn, cn, dn = self.jacobi(t)
        rho = ar.sqrt((self.u3 - self.u2) / (self.u3 + self.u2))
        return ar.atan2(sn * dn, rho * cn)

    def precession_arccot(self, t: Any) -> Any:
        """Return arccot(cot x tanh y) of (7,1), in (0, pi)."""
        x = ar.pi * (t / self.T - ar.floor(t / self.T))
        return ar.atan2(ar.sin(x), ar.cos(x) * ar.tanh(self.y))

    def series(self, t: Any) -> Any:
        """Return the sum S of (7,1)."""
        x2, y2, q = 2 * ar.pi * t / self.T, 2 * self.y, self.nome
        sine, cosine = ar.sin(x2) * ar.sinh(y2), ar.cos(x2) * ar.cosh(y2)
        signs = [(-1) ** (h - 1) * 2 * q**h for h in range(1, 250)]
        squares = [1 + q ** (2 * h) for h in range(1, 250)]
        return sum(
            ar.atan(s * sine / (p + s * cosine)) for s, p in zip(signs, squares, strict=True)
        )

    def growth(self) -> Any:
        """Return E(phi, k'), F(phi, k') and 1 - E/K of (7,1)."""
        phi = ar.asin(ar.sqrt((self.u3 - self.u2) / (self.u3 + 1)))
        m = 1 - self.k**2
        return ar.ellipe(phi, m), ar.ellipf(phi, m), 1 - self.E / self.K


class SpoiledMotion(Motion):
    """A motion whose record and angles are slightly wrong, each number by a factor of its own."""

    @cached_property
    def numbers(self) -> dict[str, Any]:
        """Numbers of the record, too large."""
        right = super().numbers
        return {key: x * (1 + ar.mpf(i) / 4000) for i, (key, x) in enumerate(right.items(), 1)}

    def angles(self, t: Any) -> tuple[Any, Any, Any]:
        """Return angles that are too large."""
        theta, phi, psi = super().angles(t)
        return theta * ar.mpf("1.001"), phi * ar.mpf("1.002"), psi * ar.mpf("1.003")


def _is_number(text: Any) -> bool:
    """Return whether an entry of the record is a number."""
    return text is not None and text[-1:].isdigit()


def _fraction(t: Any) -> Fraction:
    """Return a time as a fraction, the same one for times that differ by their last digits."""
    return Fraction(int(ar.nint(t * 2**500)), 2**500)


def nth_value(function: Callable[[Any], Any], i: int, t: Any) -> Any:
    """Return one of several values of a function."""
    return function(t)[i]


def slope(function: Callable[[Any], Any], x: Any) -> Any:
    """Return the central difference of a function."""
    return (function(x + STEP) - function(x - STEP)) / (2 * STEP)


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
HALF = PARTS[:2]
FIRST = PARTS[:4]
FAR = [ar.mpf(x) for x in ("-7.6", "10.3", "1000.8")]


def moments(*parts: Any) -> Iterator[tuple[Motion, Any]]:
    """Yield each top with times given in its periods."""
    for motion in MOTIONS:
        for part in parts or PARTS:
            yield motion, part * motion.T


def tops() -> Iterator[tuple[Motion]]:
    """Yield each top."""
    return ((motion,) for motion in MOTIONS)


def spoil(patch: pytest.MonkeyPatch) -> None:
    """Put tops in place whose record and angles are slightly wrong."""
    patch.setattr(sys.modules[__name__], "MOTIONS", SPOILED)
