"""Chrapan's sections 1 to 3, equation by equation: our Z, Omega and Pi against mpmath's thetas."""

from __future__ import annotations

import sys
from functools import partial
from typing import Any, ClassVar

import pytest
from equations import EquationTests, Register, Sides, slightly_wrong
from errata import misprints
from ours import (
    ar,
    incomplete_e,
    incomplete_f,
    jacobi,
    nome,
    omega,
    pi_function,
    quarter_period,
    second_kind,
    zeta,
)

chrapan = Register()
equation, as_printed = chrapan.equation, chrapan.as_printed

MODULUS, SMALLER = ar.mpf("0.76239"), ar.mpf("0.3")
"""Moduli above and below their complements, for which our functions have other series."""
ALPHA, V, W, J = ar.mpf("0.7543"), ar.mpf("0.41"), ar.mpf("1.13"), ar.mpc(0, 1)
NUMBER = {"01": 4, "00": 3, "11": 1, "10": 2}
MODULI = [SMALLER, MODULUS, ar.mpf("0.97")]


def named(k: Any) -> list[Any]:
    """Return what the equations call by the NAMES, for a modulus."""
    m, k_prime = k**2, ar.sqrt(1 - k**2)
    first, other = ar.ellipk(m), ar.ellipk(1 - m)
    k_bar, q = k / k_prime, ar.exp(-ar.pi * other / first)
    return [
        *(k, k_prime, first, other, ar.ellipe(m), q, k_bar),
        ar.sqrt(1 + k_bar**2),
        *(ar.ellipfun(f, ALPHA, m=1 - m) for f in ("sn", "cn", "dn")),
        {"q": -q, "quarter": k_prime * first},
    ]


NAMES = "k COMPLEMENT K K_PRIME E Q K_BAR STRETCH S C D IMAGINARY".split()
k, COMPLEMENT, K, K_PRIME, E, Q, K_BAR, STRETCH, S, C, D, IMAGINARY = named(MODULUS)
# An imaginary modulus i k_bar turns the nome into -q and K into k' K.


def theta_there(ij: str, v: Any, q: Any = None, quarter: Any = None) -> Any:
    """Return Theta_ij(v) by mpmath."""
    return ar.jtheta(NUMBER[ij], ar.pi * v / (2 * (quarter or K)), q or Q)


def zeta_there(ij: str, v: Any, q: Any = None, quarter: Any = None) -> Any:
    """Return Z_ij(v) by mpmath, for another modulus too where its q and K are passed."""
    q, quarter = q or Q, quarter or K
    angle, scale = ar.pi * v / (2 * quarter), ar.pi / (2 * quarter)
    return scale * ar.jtheta(NUMBER[ij], angle, q, 1) / ar.jtheta(NUMBER[ij], angle, q)


def ratio_there(ij: str, eta: Any, v: Any, q: Any = None, quarter: Any = None) -> Any:
    """Return exp 2 Omega_ij(eta, v), in which the multiples of i pi are gone."""
    less, more = (theta_there(ij, eta + sign * v, q, quarter) for sign in (-1, 1))
    return less / more


def ratio(value: Any) -> Any:
    """Return exp 2 Omega or exp 2 Pi."""
    return ar.exp(2 * value)


@equation("(1,1)")
def _() -> Sides:
    yield zeta_there("01", V, **IMAGINARY), STRETCH * zeta("00", V * STRETCH, k)


@as_printed("(1,1)")
def _() -> Sides:
    yield zeta_there("01", V, **IMAGINARY), zeta("00", V * STRETCH, k)


@equation("(1,2)")
def _() -> Sides:
    yield zeta_there("11", V, **IMAGINARY), STRETCH * zeta("11", V * STRETCH, k)


@as_printed("(1,2)")
def _() -> Sides:
    yield zeta_there("11", V, **IMAGINARY), zeta("11", V * STRETCH, k)


ANYWHERE = ar.mpc("0.3", "0.7"), ar.mpc("-1.9", "1.3")
"""An argument and a parameter that are neither real nor imaginary."""


def definitions(kappa: complex) -> tuple[Any, Any]:
    """Return the nome and K of a modulus, by mpmath."""
    m = ar.convert(kappa) ** 2
    first = ar.ellipk(ar.re(m))
    return ar.exp(-ar.pi * ar.ellipk(1 - ar.re(m)) / first), first


@equation("section 1 a: argument and modulus of Z may be any numbers")
def _() -> Sides:
    for kappa in (0.6 + 0j, 0.8j, 1.5 + 0j):
        q, quarter = definitions(kappa)
        for ij in NUMBER:
            yield zeta_there(ij, ANYWHERE[0], q, quarter), zeta(ij, ANYWHERE[0], kappa)


@equation("(1,1) and (1,2) of complex arguments")
def _() -> Sides:
    for ij, there in (("01", "00"), ("11", "11")):
        right = STRETCH * zeta_there(there, ANYWHERE[0] * STRETCH)
        yield zeta(ij, ANYWHERE[0], ar.mpc(0, K_BAR)), right


@equation("section 2 a: argument, parameter and modulus of Omega may be any numbers")
def _() -> Sides:
    for kappa in (0.6 + 0j, 0.8j, 1.5 + 0j):
        q, quarter = definitions(kappa)
        for ij in ("01", "00", "11"):
            left = ratio_there(ij, *ANYWHERE, q, quarter)
            yield left, ratio(omega(ij, *ANYWHERE, kappa))


@equation("section 3 a: argument, parameter and modulus of Pi may be any numbers")
def _() -> Sides:
    for kappa in (0.6 + 0j, 0.8j, 1.5 + 0j):
        q, quarter = definitions(kappa)
        for ij in ("01", "00", "11"):
            left = pi_there(ij, *ANYWHERE, q=q, quarter=quarter)
            yield left, ratio(pi_function(ij, *ANYWHERE, kappa))


@equation("section 3 e: slope of Pi01 as a rational function of sn, cn, dn")
def _() -> Sides:
    for kappa in (0.6 + 0j, 0.8j, 1.5 + 0j):
        eta, v = ANYWHERE
        m = ar.re(ar.convert(kappa) ** 2)
        _, sn, cn, dn = jacobi(v, kappa)
        wave = m * ar.ellipfun("sn", eta, m=m) ** 2
        less, more = (zeta("01", eta + sign * v, kappa) for sign in (-1, 1))
        left = zeta("01", v, kappa) + less / 2 - more / 2
        yield left, wave * sn * cn * dn / (1 - wave * sn**2)


@equation("section 1 c: real forms of Z(i alpha)")
def _() -> Sides:
    line = ar.pi * ALPHA / (2 * K * K_PRIME)
    q, quarter = ar.exp(-ar.pi * K / K_PRIME), K_PRIME
    z, z11 = (zeta_there(ij, ALPHA, q, quarter) for ij in ("01", "11"))
    yield zeta("01", J * ALPHA, k), J * (S * D / C - line - z)
    for first in (C / (S * D) - z11, C / (S * D) - C * D / S - z, COMPLEMENT**2 * S * C / D - z):
        yield zeta("00", J * ALPHA, k), J * (first - line)
    for first in (S * D / C - z - D / (S * C), -C * D / S - z):
        yield zeta("11", J * ALPHA, k), J * (first - line)
    yield zeta("10", J * ALPHA, k), -J * (line + z)


@equation("section 1 d: sum of Z00 and Z11")
def _() -> Sides:
    z = zeta_there("01", ALPHA, ar.exp(-ar.pi * K / K_PRIME), K_PRIME)
    rest = ar.pi * ALPHA / (K * K_PRIME) + 2 * z
    both = zeta("00", J * ALPHA, k) + zeta("11", J * ALPHA, k)
    yield both, J * (COMPLEMENT**2 * S * C / D - C * D / S - rest)


@equation("(1,3)")
def _() -> Sides:
    yield zeta("00", J * ALPHA, k) - zeta("11", J * ALPHA, k), J * C / (S * D)


@equation("(1,4)")
def _() -> Sides:
    yield zeta("00", J * ALPHA, k) - zeta("01", J * ALPHA, k), -J * k**2 * S / (C * D)


@as_printed("(1,4)")
def _() -> Sides:
    right = -J * COMPLEMENT**2 * S / (C * D)
    yield zeta("00", J * ALPHA, k) - zeta("01", J * ALPHA, k), right


@equation("(1,5)")
def _() -> Sides:
    yield zeta("11", J * ALPHA, k) - zeta("10", J * ALPHA, k), -J * C * D / S


@equation("section 1 e: Z(alpha) = E(alpha, k') - E' alpha/K'")
def _() -> Sides:
    squared = ar.quad(lambda x: ar.ellipfun("dn", x, m=1 - k**2) ** 2, [0, ALPHA])
    yield zeta("01", ALPHA, COMPLEMENT), squared - ar.ellipe(1 - k**2) / K_PRIME * ALPHA


@equation("section 1 e: Legendre's relation")
def _() -> Sides:
    for x in MODULI:
        first, second = (
            [function(y) for y in (x, ar.sqrt(1 - x**2))]
            for function in (quarter_period, second_kind)
        )
        yield second[0] * first[1] + second[1] * first[0] - first[0] * first[1], ar.pi / 2
        yield from zip((first[0], second[0]), (ar.ellipk(x**2), ar.ellipe(x**2)), strict=True)


@equation("(1,6)")
def _() -> Sides:
    phi = ar.mpf("0.7277")
    m = 1 - k**2
    left = incomplete_f(phi, COMPLEMENT)
    yield left, ar.quad(lambda x: 1 / ar.sqrt(1 - m * ar.sin(x) ** 2), [0, phi])
    yield left, ar.quad(lambda x: 1 / ar.sqrt((1 - x * x) * (1 - m * x * x)), [0, ar.sin(phi)])


@equation("(1,7)")
def _() -> Sides:
    yield jacobi(ALPHA, COMPLEMENT)[0], ar.asin(S)


def _sum_1_8(sign: int) -> tuple[Any, Any]:
    """Return both sides of (1,8), with a sign before the last term."""
    phi = jacobi(ALPHA, COMPLEMENT)[0]
    curve = incomplete_e(phi, COMPLEMENT) - incomplete_f(phi, COMPLEMENT) * (1 - E / K)
    right = J * COMPLEMENT**2 * S * C / D - J * C * D / S + sign * 2 * J * curve
    return zeta_there("00", J * ALPHA) + zeta_there("11", J * ALPHA), right


@equation("(1,8)")
def _() -> Sides:
    yield _sum_1_8(-1)


@as_printed("(1,8)")
def _() -> Sides:
    yield _sum_1_8(1)


@equation("(2,1)")
def _() -> Sides:
    right = omega("11", W, V, k) + J * ar.pi * W / (2 * K) + J * ar.pi / 2
    yield ratio_there("01", W, V + J * K_PRIME), ratio(right)


@equation("(2,2)")
def _() -> Sides:
    for v in (V, J * V):
        right = ratio(omega("00", W * STRETCH, v * STRETCH, k))
        yield ratio_there("01", W, v, **IMAGINARY), right


@equation("(2,3)")
def _() -> Sides:
    for v in (V, J * V):
        right = ratio(omega("11", W * STRETCH, v * STRETCH, k))
        yield ratio_there("11", W, v, **IMAGINARY), right


@equation("(2,4)")
def _() -> Sides:
    for x in MODULI:
        yield nome(x), ar.exp(-ar.pi * ar.ellipk(1 - x**2) / ar.ellipk(x**2))


def _arctangents(w: Any) -> tuple[Any, Any]:
    """Return Omega_00 and Omega_11 by the products of theta, with x, y, X, Y of the text."""
    X, Y = ar.pi * w / K, ar.pi * ALPHA / K
    sines, cosines = ar.sin(X) * ar.sinh(Y), ar.cos(X) * ar.cosh(Y)

    def term(n: int, sign: int) -> Any:
        return ar.atan(sign * 2 * Q**n * sines / (1 + Q ** (2 * n) + sign * 2 * Q**n * cosines))

    first = sum(term(2 * h - 1, 1) for h in range(1, 60))
    second = sum(term(2 * h, -1) for h in range(1, 60))
    return J * first, J * second - J * ar.atan(ar.cot(X / 2) * ar.tanh(Y / 2))


@equation("(2,5)")
def _() -> Sides:
    for w in (V, W):
        even, odd = _arctangents(w)
        yield omega("00", w, J * ALPHA, k), even
        yield omega("11", w, J * ALPHA, k), odd
        both = omega("00", w, J * ALPHA, k) + omega("11", w, J * ALPHA, k)
        yield both, even + odd


@as_printed("(2,5)")
def _() -> Sides:
    """Read h in sinh h and cosh h, as the text has it eight times."""
    X, Y = ar.pi * W / K, ar.pi * ALPHA / K
    terms = 0
    for h in range(1, 60):
        wave = (-1) ** (h - 1) * 2 * Q**h
        below = wave * ar.cos(X) * ar.cosh(h * Y) + 1 + Q ** (2 * h)
        terms += ar.atan(wave * ar.sin(X) * ar.sinh(h * Y) / below)
    first = -ar.atan(ar.cot(X / 2) * ar.tanh(Y / 2))
    both = omega("00", W, J * ALPHA, k) + omega("11", W, J * ALPHA, k)
    yield both, J * (first + terms)


@equation("(2,5), continued over all w")
def _() -> Sides:
    z = ar.exp(-ar.pi * ALPHA / K)
    for w in (-3 * W, W, 5 * W):
        x = ar.pi * w / (2 * K)
        _, odd = _arctangents(w)
        arctangent = ar.atan(ar.cot(x) * ar.tanh(ar.pi * ALPHA / (2 * K)))
        wave = ar.atan(z * ar.sin(2 * x) / (1 - z * ar.cos(2 * x)))
        right = odd + J * arctangent - J * (ar.pi / 2 - x - wave)
        yield omega("11", w, J * ALPHA, k), right


@equation("(2,6)")
def _() -> Sides:
    sn, cn, dn = (ar.ellipfun(f, W, m=k**2) for f in ("sn", "cn", "dn"))
    right = J * ar.atan(S * D * cn / (C * sn * dn))
    left = omega("00", W, J * ALPHA, k) - omega("11", W, J * ALPHA, k)
    yield ratio(left), ratio(right)


def slope(function: Any, x: Any) -> Any:
    """Return the central difference of a function, computed with 140 digits."""
    with ar.workdps(140):
        h = ar.mpf(10) ** -30
        return (function(x + h) - function(x - h)) / (2 * h)


for _index, _kind in enumerate(("01", "00", "11"), 7):

    @equation(f"(2,{_index})")
    def _(ij: str = _kind) -> Sides:
        right = (zeta_there(ij, W - J * ALPHA) - zeta_there(ij, W + J * ALPHA)) / 2
        yield slope(lambda w: omega(ij, w, J * ALPHA, k), W), right


@equation("(2,10)")
def _() -> Sides:
    for sign in (1, -1):
        left = slope(partial(_sum, omega, sign), ar.mpf(0))
        yield left, -(zeta_there("00", J * ALPHA) + sign * zeta_there("11", J * ALPHA))


@equation("(2,11)")
def _() -> Sides:
    for sign in (1, -1):
        left = slope(partial(_sum, omega, sign), K)
        yield left, -(zeta_there("01", J * ALPHA) + sign * zeta_there("10", J * ALPHA))


def _sum(function: Any, sign: int, w: Any) -> Any:
    """Return the 00 function of w and i alpha plus or minus the 11 function."""
    return function("00", w, J * ALPHA, k) + sign * function("11", w, J * ALPHA, k)


@equation("section 3 a: Pi01 of Jacobi")
def _() -> Sides:
    left = pi_function("01", W, V, k)
    yield ratio(left), ar.exp(2 * W * zeta_there("01", V)) * ratio_there("01", W, V)


for _index, _kind in enumerate(("00", "11"), 1):

    @equation(f"(3,{_index})")
    def _(ij: str = _kind) -> Sides:
        for parameter in (V, J * ALPHA):
            left = pi_function(ij, W, parameter, k)
            right = ar.exp(2 * W * zeta_there(ij, parameter)) * ratio_there(ij, W, parameter)
            yield ratio(left), right


@equation("section 3 d: slopes of Pi")
def _() -> Sides:
    for ij in ("01", "00", "11"):
        waves = zeta_there(ij, W - J * ALPHA) - zeta_there(ij, W + J * ALPHA)
        left = slope(lambda w, ij=ij: pi_function(ij, w, J * ALPHA, k), W)
        yield left, zeta_there(ij, J * ALPHA) + waves / 2


def pi_there(ij: str, eta: Any, v: Any, **of_modulus: Any) -> Any:
    """Return exp 2 Pi_ij by mpmath."""
    return ar.exp(2 * eta * zeta_there(ij, v, **of_modulus)) * ratio_there(ij, eta, v, **of_modulus)


@equation("(3,3)")
def _() -> Sides:
    yield pi_there("01", W, V + J * K_PRIME), -ratio(pi_function("11", W, V, k))


@equation("(3,4)")
def _() -> Sides:
    right = ratio(pi_function("00", W * STRETCH, J * V * STRETCH, k))
    yield pi_there("01", W, J * V, **IMAGINARY), right


@equation("(3,5)")
def _() -> Sides:
    right = ratio(pi_function("11", W * STRETCH, J * V * STRETCH, k))
    yield pi_there("11", W, J * V, **IMAGINARY), right


@equation("(3,6)")
def _() -> Sides:
    for sign in (1, -1):
        yield slope(partial(_sum, pi_function, sign), ar.mpf(0)), ar.mpf(0)


def _sides_3_7(point: Any) -> Sides:
    """Yield both sides of (3,7), the slope taken at a point."""
    for sign in (1, -1):
        right = -J * k**2 * S / (C * D) - sign * J * C * D / S
        yield slope(partial(_sum, pi_function, sign), point), right


@equation("(3,7)")
def _() -> Sides:
    yield from _sides_3_7(K)


@as_printed("(3,7)")
def _() -> Sides:
    yield from _sides_3_7(k)


def _integral(m: Any, v: Any) -> tuple[Any, Any]:
    """Return the integral in (3,8) up to W and the factor of Pi01, by mpmath."""
    sn, cn, dn = (ar.ellipfun(name, v, m=m) for name in ("sn", "cn", "dn"))
    product = m * sn**2

    def integrand(x: Any) -> Any:
        wave = product * ar.ellipfun("sn", x, m=m) ** 2
        return wave / (1 - wave)

    return ar.quad(integrand, [0, W]), sn / (cn * dn)


@equation("(3,8)")
def _() -> Sides:
    left, factor = _integral(k**2, V)
    yield left, factor * pi_function("01", W, V, k)


@equation("(3,8) for the imaginary modulus of section 4")
def _() -> Sides:
    for v in (V, J * V, V + J * V):
        left, factor = _integral(-(K_BAR**2), v)
        yield left, factor * pi_function("00", W * STRETCH, v * STRETCH, k)
        yield left, factor * pi_function("01", W, v, ar.mpc(0, K_BAR))


class TestChrapan(EquationTests):
    """Tests of sections 1 to 3."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = misprints("Chrapan", 1, 2, 3)

    def test_equation_below_the_complement(
        self, number: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        for name, value in zip(NAMES, named(SMALLER), strict=True):
            monkeypatch.setattr(sys.modules[__name__], name, value)
        self.test_equation(number)

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put wrong functions of ours in place."""
        here = sys.modules[__name__]
        for function in (zeta, omega, pi_function, nome, incomplete_e, incomplete_f, jacobi):
            patch.setattr(here, function.__name__, slightly_wrong(function))
        for function in (quarter_period, second_kind):
            patch.setattr(here, function.__name__, slightly_wrong(function))
