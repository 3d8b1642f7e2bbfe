"""Chrapan's sections 1 to 3, equation by equation: our Z, Omega and Pi against mpmath's thetas."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest
from equations import EquationTests, Register, page, slightly_wrong
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


@cache
def integral(m: Any, v: Any) -> Any:
    """Return the integral of (3,8) up to W, over sn/(cn dn) of the parameter."""
    sn, cn, dn = (ar.ellipfun(name, v, m=m) for name in ("sn", "cn", "dn"))

    def integrand(x: Any) -> Any:
        wave = m * sn**2 * ar.ellipfun("sn", x, m=m) ** 2
        return wave / (1 - wave)

    return ar.quad(integrand, [0, W]) / sn * cn * dn


chrapan.enter(page("chrapan-1-to-3"))


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
