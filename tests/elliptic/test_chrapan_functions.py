"""Chrapan's sections 1 to 3, equation by equation: our Z, Omega and Pi against mpmath's thetas."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest
from equations import EquationTests, Register, slightly_wrong
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

chrapan = Register(__name__)

MODULUS = ar.mpf("0.76239")
ALPHA, V, W, J = ar.mpf("0.7543"), ar.mpf("0.41"), ar.mpf("1.13"), ar.mpc(0, 1)
JA = J * ALPHA
NUMBER = {"01": 4, "00": 3, "11": 1, "10": 2}
THIRD = ("01", "00", "11")
MODULI = [ar.mpf("0.3"), MODULUS, ar.mpf("0.97")]


k, COMPLEMENT = MODULUS, ar.sqrt(1 - MODULUS**2)
K, K_PRIME, E, E_PRIME = (f(x) for f in (ar.ellipk, ar.ellipe) for x in (k**2, 1 - k**2))
Q, K_BAR, STRETCH = ar.exp(-ar.pi * K_PRIME / K), k / COMPLEMENT, 1 / COMPLEMENT
S, C, D = (ar.ellipfun(name, ALPHA, m=1 - k**2) for name in ("sn", "cn", "dn"))
IMAGINARY, OTHER = (-Q, COMPLEMENT * K), (ar.exp(-ar.pi * K / K_PRIME), K_PRIME)
"""Nome and K of the modulus i K_BAR, and of k'."""


def theta_there(ij: str, v: Any, *of: Any, order: int = 0) -> Any:
    """Return Theta_ij(v) or a derivative by mpmath, for another modulus by its nome and K."""
    q, quarter = of or (Q, K)
    scale = ar.pi / (2 * quarter)
    return scale**order * ar.jtheta(NUMBER[ij], scale * v, q, order)


def zeta_there(ij: str, v: Any, *of: Any) -> Any:
    """Return Z_ij(v) by mpmath."""
    return theta_there(ij, v, *of, order=1) / theta_there(ij, v, *of)


def ratio_there(ij: str, eta: Any, v: Any, *of: Any) -> Any:
    """Return exp 2 Omega_ij(eta, v) by mpmath, in which the multiples of i pi are gone."""
    return theta_there(ij, eta - v, *of) / theta_there(ij, eta + v, *of)


def pi_there(ij: str, eta: Any, v: Any, *of: Any) -> Any:
    """Return exp 2 Pi_ij by mpmath."""
    return ar.exp(2 * eta * zeta_there(ij, v, *of)) * ratio_there(ij, eta, v, *of)


Z01, Z11 = (zeta_there(ij, ALPHA, *OTHER) for ij in ("01", "11"))


def slope(function: Any, x: Any) -> Any:
    """Return the central difference of a function, computed with 140 digits."""
    with ar.workdps(140):
        h = ar.mpf(10) ** -30
        return (function(x + h) - function(x - h)) / (2 * h)


def both(function: Any, sign: int, w: Any) -> Any:
    """Return the 00 function of w and i alpha plus or minus the 11 function."""
    return function("00", w, JA, k) + sign * function("11", w, JA, k)


ETA, ANY = ar.mpc("0.3", "0.7"), ar.mpc("-1.9", "1.3")
"""An argument and a parameter that are neither real nor imaginary."""


def any_modulus() -> Iterator[SimpleNamespace]:
    """Yield moduli of each kind, with m and with nome and K by mpmath."""
    for kappa in (ar.mpc("0.6"), ar.mpc(0, "0.8"), ar.mpc("1.5")):
        m = ar.re(kappa**2)
        of = ar.exp(-ar.pi * ar.ellipk(1 - m) / ar.ellipk(m)), ar.ellipk(m)
        yield SimpleNamespace(kappa=kappa, m=m, of=of)


def moduli() -> list[Any]:
    """Return real moduli with their complements."""
    return [SimpleNamespace(x=x, y=ar.sqrt(1 - x**2)) for x in MODULI]


def signs() -> list[Any]:
    """Return both signs."""
    return [SimpleNamespace(sign=1), SimpleNamespace(sign=-1)]


def parameters() -> list[Any]:
    """Return a real, an imaginary and a complex parameter."""
    return [SimpleNamespace(v=v) for v in (V, J * V, V + J * V)]


def rational_slope(kappa: Any, m: Any) -> Any:
    """Return the right side of section 3 e."""
    _, sn, cn, dn = jacobi(ANY, kappa)
    wave = m * ar.ellipfun("sn", ETA, m=m) ** 2
    return wave * sn * cn * dn / (1 - wave * sn**2)


LINE = ar.pi * ALPHA / (2 * K * K_PRIME)


def curve() -> Any:
    """Return E(phi, k') - F(phi, k') (1 - E/K) of (1,8) by our functions."""
    phi = jacobi(ALPHA, COMPLEMENT)[0]
    return incomplete_e(phi, COMPLEMENT) - incomplete_f(phi, COMPLEMENT) * (1 - E / K)


PHI = ar.mpf("0.7277")


def arctangents(w: Any) -> tuple[Any, Any]:
    """Return Omega_00 and Omega_11 by the products of theta, with x, y, X, Y of the text."""
    X, Y = ar.pi * w / K, ar.pi * ALPHA / K
    sines, cosines = ar.sin(X) * ar.sinh(Y), ar.cos(X) * ar.cosh(Y)

    def term(n: int, sign: int) -> Any:
        return ar.atan(sign * 2 * Q**n * sines / (1 + Q ** (2 * n) + sign * 2 * Q**n * cosines))

    first = sum(term(2 * h - 1, 1) for h in range(1, 60))
    second = sum(term(2 * h, -1) for h in range(1, 60))
    return J * first, J * second - J * ar.atan(ar.cot(X / 2) * ar.tanh(Y / 2))


def misprinted_2_5() -> Any:
    """Return (2,5) with h in sinh h and cosh h, as the text has it eight times."""
    X, Y = ar.pi * W / K, ar.pi * ALPHA / K
    total = -ar.atan(ar.cot(X / 2) * ar.tanh(Y / 2))
    for h in range(1, 60):
        wave = (-1) ** (h - 1) * 2 * Q**h
        below = wave * ar.cos(X) * ar.cosh(h * Y) + 1 + Q ** (2 * h)
        total += ar.atan(wave * ar.sin(X) * ar.sinh(h * Y) / below)
    return J * total


def integral(m: Any, v: Any) -> Any:
    """Return the integral of (3,8) up to W, over sn/(cn dn) of the parameter."""
    sn, cn, dn = (ar.ellipfun(name, v, m=m) for name in ("sn", "cn", "dn"))

    def integrand(x: Any) -> Any:
        wave = m * sn**2 * ar.ellipfun("sn", x, m=m) ** 2
        return wave / (1 - wave)

    return ar.quad(integrand, [0, W]) / sn * cn * dn


chrapan.enter("""
# any_modulus
section 1 a: argument and modulus of Z may be any numbers
    | [zeta_there(x, ETA, *of) for x in NUMBER] = [zeta(x, ETA, kappa) for x in NUMBER]
section 2 a: argument, parameter and modulus of Omega may be any numbers
    | [ratio_there(x, ETA, ANY, *of) for x in THIRD] = [exp(2*omega(x, ETA, ANY, kappa)) for x in
      THIRD]
section 3 a: argument, parameter and modulus of Pi may be any numbers
    | [pi_there(x, ETA, ANY, *of) for x in THIRD] = [exp(2*pi_function(x, ETA, ANY, kappa)) for x in
      THIRD]
section 3 e: slope of Pi01 as a rational function of sn, cn, dn
    | zeta('01', ANY, kappa) + zeta('01', ETA - ANY, kappa)/2 - zeta('01', ETA + ANY, kappa)/2 =
      rational_slope(kappa, m)
# once
(1,1) | zeta_there('01', V, *IMAGINARY) = STRETCH*zeta('00', V*STRETCH, k)
(1,2) | zeta_there('11', V, *IMAGINARY) = STRETCH*zeta('11', V*STRETCH, k)
(1,1) and (1,2) of complex arguments
    | zeta('01', ETA, J*K_BAR) = STRETCH*zeta_there('00', ETA*STRETCH)
    | zeta('11', ETA, J*K_BAR) = STRETCH*zeta_there('11', ETA*STRETCH)
section 1 c: real forms of Z(i alpha) | zeta('01', JA, k) = J*(S*D/C - LINE - Z01)
    | 3*[zeta('00', JA, k)] = [J*(x - LINE) for x in (C/(S*D) - Z11, C/(S*D) - C*D/S - Z01,
      COMPLEMENT**2*S*C/D - Z01)]
    | 2*[zeta('11', JA, k)] = [J*(x - LINE) for x in (S*D/C - Z01 - D/(S*C), -C*D/S - Z01)]
    | zeta('10', JA, k) = -J*(LINE + Z01)
section 1 d: sum of Z00 and Z11
    | zeta('00', JA, k) + zeta('11', JA, k) = J*(COMPLEMENT**2*S*C/D - C*D/S - 2*LINE) - 2*J*Z01
(1,3) | zeta('00', JA, k) - zeta('11', JA, k) = J*C/(S*D)
(1,4) | zeta('00', JA, k) - zeta('01', JA, k) = -J*k**2*S/(C*D)
(1,5) | zeta('11', JA, k) - zeta('10', JA, k) = -J*C*D/S
section 1 e: Z(alpha) = E(alpha, k') - E' alpha/K'
    | zeta('01', ALPHA, COMPLEMENT) = quad(lambda x: ellipfun('dn', x, m=1 - k**2)**2, [0, ALPHA]) -
      E_PRIME/K_PRIME*ALPHA
(1,6)
    | 2*[incomplete_f(PHI, COMPLEMENT)] = [quad(lambda x: 1/sqrt(1 - (COMPLEMENT*sin(x))**2), [0,
      PHI]), quad(lambda x: 1/sqrt((1 - x**2)*(1 - (COMPLEMENT*x)**2)), [0, sin(PHI)])]
(1,7) | jacobi(ALPHA, COMPLEMENT)[0] = asin(S)
(1,8) | zeta_there('00', JA) + zeta_there('11', JA) = J*COMPLEMENT**2*S*C/D - J*C*D/S - 2*J*curve()
# moduli
section 1 e: Legendre's relation
    | second_kind(x)*quarter_period(y) + second_kind(y)*quarter_period(x) -
      quarter_period(x)*quarter_period(y) = pi/2 | quarter_period(x) = ellipk(x**2)
    | second_kind(x) = ellipe(x**2)
(2,4) | nome(x) = exp(-pi*ellipk(1 - x**2)/ellipk(x**2))
# once
(2,1) | ratio_there('01', W, V + J*K_PRIME) = exp(2*omega('11', W, V, k) + J*pi*(W/K + 1))
(2,2)
    | [ratio_there('01', W, v, *IMAGINARY) for v in (V, J*V)] = [exp(2*omega('00', W*STRETCH,
      v*STRETCH, k)) for v in (V, J*V)]
(2,3)
    | [ratio_there('11', W, v, *IMAGINARY) for v in (V, J*V)] = [exp(2*omega('11', W*STRETCH,
      v*STRETCH, k)) for v in (V, J*V)]
(2,5)
    | [omega(x, w, JA, k) for w in (V, W) for x in ('00', '11')] = [*arctangents(V),
      *arctangents(W)]
(2,6)
    | exp(2*both(omega, -1, W)) = exp(2*J*atan(S*D/C*ellipfun('cn', W, m=k**2)/(ellipfun('sn', W,
      m=k**2)*ellipfun('dn', W, m=k**2))))
(2,7)
    | slope(lambda w: omega('01', w, JA, k), W) = (zeta_there('01', W - JA) - zeta_there('01', W +
      JA))/2
(2,8)
    | slope(lambda w: omega('00', w, JA, k), W) = (zeta_there('00', W - JA) - zeta_there('00', W +
      JA))/2
(2,9)
    | slope(lambda w: omega('11', w, JA, k), W) = (zeta_there('11', W - JA) - zeta_there('11', W +
      JA))/2
section 3 a: Pi01 of Jacobi | exp(2*pi_function('01', W, V, k)) = pi_there('01', W, V)
(3,1)
    | [exp(2*pi_function('00', W, v, k)) for v in (V, JA)] = [pi_there('00', W, v) for v in (V, JA)]
(3,2)
    | [exp(2*pi_function('11', W, v, k)) for v in (V, JA)] = [pi_there('11', W, v) for v in (V, JA)]
section 3 d: slopes of Pi
    | [slope(lambda w: pi_function(x, w, JA, k), W) for x in THIRD] = [zeta_there(x, JA) +
      (zeta_there(x, W - JA) - zeta_there(x, W + JA))/2 for x in THIRD]
(3,3) | pi_there('01', W, V + J*K_PRIME) = -exp(2*pi_function('11', W, V, k))
(3,4) | pi_there('01', W, J*V, *IMAGINARY) = exp(2*pi_function('00', W*STRETCH, J*V*STRETCH, k))
(3,5) | pi_there('11', W, J*V, *IMAGINARY) = exp(2*pi_function('11', W*STRETCH, J*V*STRETCH, k))
(3,8) | integral(k**2, V) = pi_function('01', W, V, k)
# signs
(2,10)
    | slope(lambda w: both(omega, sign, w), 0) = -zeta_there('00', JA) - sign*zeta_there('11', JA)
(2,11)
    | slope(lambda w: both(omega, sign, w), K) = -zeta_there('01', JA) - sign*zeta_there('10', JA)
(3,6) | slope(lambda w: both(pi_function, sign, w), 0) = 0
(3,7) | slope(lambda w: both(pi_function, sign, w), K) = -J*k**2*S/(C*D) - sign*J*C*D/S
# parameters
(3,8) for the imaginary modulus of section 4
    | integral(-K_BAR**2, v) = pi_function('00', W*STRETCH, v*STRETCH, k)
    | integral(-K_BAR**2, v) = pi_function('01', W, v, J*K_BAR)
# once: as printed
(1,1) | zeta_there('01', V, *IMAGINARY) = zeta('00', V*STRETCH, k)
(1,2) | zeta_there('11', V, *IMAGINARY) = zeta('11', V*STRETCH, k)
(1,4) | zeta('00', JA, k) - zeta('01', JA, k) = -J*COMPLEMENT**2*S/(C*D)
(1,8) | zeta_there('00', JA) + zeta_there('11', JA) = J*COMPLEMENT**2*S*C/D - J*C*D/S + 2*J*curve()
(2,5) | both(omega, 1, W) = misprinted_2_5()
(3,7) | slope(lambda w: both(pi_function, 1, w), k) = -J*k**2*S/(C*D) - J*C*D/S
""")


class TestChrapan(EquationTests):
    """Tests of sections 1 to 3."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = misprints("Chrapan", 1, 2, 3)

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put wrong functions of ours in place."""
        here = sys.modules[__name__]
        functions = zeta, omega, pi_function, nome, incomplete_e, incomplete_f, jacobi
        for name, function in [*vars(here).items()]:
            if function in (*functions, quarter_period, second_kind):
                patch.setattr(here, name, slightly_wrong(function))
