"""Chrapan's sections 1 to 3, equation by equation: our Z, Omega and Pi against mpmath's thetas."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import partial
from typing import Any, ClassVar

import pytest
from equations import EquationTests, Register, once, slightly_wrong
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

MODULUS = ar.mpf("0.76239")
ALPHA, V, W, J = ar.mpf("0.7543"), ar.mpf("0.41"), ar.mpf("1.13"), ar.mpc(0, 1)
JA = J * ALPHA
NUMBER = {"01": 4, "00": 3, "11": 1, "10": 2}
THIRD = ("01", "00", "11")
MODULI = [ar.mpf("0.3"), MODULUS, ar.mpf("0.97")]


k, COMPLEMENT = MODULUS, ar.sqrt(1 - MODULUS**2)
K, K_PRIME, E = ar.ellipk(k**2), ar.ellipk(1 - k**2), ar.ellipe(k**2)
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


def ratio(value: Any) -> Any:
    """Return exp 2 Omega or exp 2 Pi."""
    return ar.exp(2 * value)


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


def any_modulus() -> Iterator[tuple[Any, ...]]:
    """Yield moduli of each kind, with m and with nome and K by mpmath."""
    for kappa in (ar.mpc("0.6"), ar.mpc(0, "0.8"), ar.mpc("1.5")):
        m = ar.re(kappa**2)
        yield kappa, m, (ar.exp(-ar.pi * ar.ellipk(1 - m) / ar.ellipk(m)), ar.ellipk(m))


def rational_slope(kappa: Any, m: Any) -> tuple[Any, Any]:
    """Return both sides of section 3 e."""
    _, sn, cn, dn = jacobi(ANY, kappa)
    wave = m * ar.ellipfun("sn", ETA, m=m) ** 2
    less, more = (zeta("01", ETA + sign * ANY, kappa) for sign in (-1, 1))
    return zeta("01", ANY, kappa) + less / 2 - more / 2, wave * sn * cn * dn / (1 - wave * sn**2)


chrapan.each(
    any_modulus,
    {
        "section 1 a: argument and modulus of Z may be any numbers": lambda kappa, _, of: [
            (zeta_there(ij, ETA, *of), zeta(ij, ETA, kappa)) for ij in NUMBER
        ],
        "section 2 a: argument, parameter and modulus of Omega may be any numbers": (
            lambda kappa, _, of: [
                (ratio_there(ij, ETA, ANY, *of), ratio(omega(ij, ETA, ANY, kappa))) for ij in THIRD
            ]
        ),
        "section 3 a: argument, parameter and modulus of Pi may be any numbers": (
            lambda kappa, _, of: [
                (pi_there(ij, ETA, ANY, *of), ratio(pi_function(ij, ETA, ANY, kappa)))
                for ij in THIRD
            ]
        ),
        "section 3 e: slope of Pi01 as a rational function of sn, cn, dn": lambda kappa, m, _: [
            rational_slope(kappa, m)
        ],
    },
)


def real_forms() -> Iterator[tuple[Any, Any]]:
    """Yield the forms of Z(i alpha) in section 1 c."""
    line = ar.pi * ALPHA / (2 * K * K_PRIME)
    z, z11 = (zeta_there(ij, ALPHA, *OTHER) for ij in ("01", "11"))
    yield zeta("01", JA, k), J * (S * D / C - line - z)
    for first in (C / (S * D) - z11, C / (S * D) - C * D / S - z, COMPLEMENT**2 * S * C / D - z):
        yield zeta("00", JA, k), J * (first - line)
    for first in (S * D / C - z - D / (S * C), -C * D / S - z):
        yield zeta("11", JA, k), J * (first - line)
    yield zeta("10", JA, k), -J * (line + z)


def legendre(x: Any) -> Iterator[tuple[Any, Any]]:
    """Yield Legendre's relation for a modulus, and K and E by mpmath."""
    (K, E), (K1, E1) = ((quarter_period(y), second_kind(y)) for y in (x, ar.sqrt(1 - x**2)))
    yield E * K1 + E1 * K - K * K1, ar.pi / 2
    yield from ((K, ar.ellipk(x**2)), (E, ar.ellipe(x**2)))


def sum_1_8(sign: int) -> tuple[Any, Any]:
    """Return both sides of (1,8), with a sign before the last term."""
    phi = jacobi(ALPHA, COMPLEMENT)[0]
    curve = incomplete_e(phi, COMPLEMENT) - incomplete_f(phi, COMPLEMENT) * (1 - E / K)
    right = J * COMPLEMENT**2 * S * C / D - J * C * D / S + sign * 2 * J * curve
    return zeta_there("00", JA) + zeta_there("11", JA), right


PHI = ar.mpf("0.7277")
chrapan.each(
    once,
    {
        "(1,1)": lambda: (zeta_there("01", V, *IMAGINARY), STRETCH * zeta("00", V * STRETCH, k)),
        "(1,2)": lambda: (zeta_there("11", V, *IMAGINARY), STRETCH * zeta("11", V * STRETCH, k)),
        "(1,1) and (1,2) of complex arguments": lambda: [
            (zeta(ij, ETA, J * K_BAR), STRETCH * zeta_there(there, ETA * STRETCH))
            for ij, there in (("01", "00"), ("11", "11"))
        ],
        "section 1 c: real forms of Z(i alpha)": real_forms,
        "section 1 d: sum of Z00 and Z11": lambda: (
            zeta("00", JA, k) + zeta("11", JA, k),
            J * (COMPLEMENT**2 * S * C / D - C * D / S - ar.pi * ALPHA / (K * K_PRIME))
            - 2 * J * zeta_there("01", ALPHA, *OTHER),
        ),
        "(1,3)": lambda: (zeta("00", JA, k) - zeta("11", JA, k), J * C / (S * D)),
        "(1,4)": lambda: (zeta("00", JA, k) - zeta("01", JA, k), -J * k**2 * S / (C * D)),
        "(1,5)": lambda: (zeta("11", JA, k) - zeta("10", JA, k), -J * C * D / S),
        "section 1 e: Z(alpha) = E(alpha, k') - E' alpha/K'": lambda: (
            zeta("01", ALPHA, COMPLEMENT),
            ar.quad(lambda x: ar.ellipfun("dn", x, m=1 - k**2) ** 2, [0, ALPHA])
            - ar.ellipe(1 - k**2) / K_PRIME * ALPHA,
        ),
        "(1,6)": lambda: [
            (incomplete_f(PHI, COMPLEMENT), ar.quad(integrand, [0, end]))
            for end, integrand in (
                (PHI, lambda x: 1 / ar.sqrt(1 - (COMPLEMENT * ar.sin(x)) ** 2)),
                (ar.sin(PHI), lambda x: 1 / ar.sqrt((1 - x**2) * (1 - (COMPLEMENT * x) ** 2))),
            )
        ],
        "(1,7)": lambda: (jacobi(ALPHA, COMPLEMENT)[0], ar.asin(S)),
        "(1,8)": lambda: [sum_1_8(-1)],
    },
)
chrapan.each(
    lambda: [(x,) for x in MODULI],
    {
        "section 1 e: Legendre's relation": legendre,
        "(2,4)": lambda x: (nome(x), ar.exp(-ar.pi * ar.ellipk(1 - x**2) / ar.ellipk(x**2))),
    },
)


def arctangents(w: Any) -> tuple[Any, Any]:
    """Return Omega_00 and Omega_11 by the products of theta, with x, y, X, Y of the text."""
    X, Y = ar.pi * w / K, ar.pi * ALPHA / K
    sines, cosines = ar.sin(X) * ar.sinh(Y), ar.cos(X) * ar.cosh(Y)

    def term(n: int, sign: int) -> Any:
        return ar.atan(sign * 2 * Q**n * sines / (1 + Q ** (2 * n) + sign * 2 * Q**n * cosines))

    first = sum(term(2 * h - 1, 1) for h in range(1, 60))
    second = sum(term(2 * h, -1) for h in range(1, 60))
    return J * first, J * second - J * ar.atan(ar.cot(X / 2) * ar.tanh(Y / 2))


def misprinted_2_5() -> tuple[Any, Any]:
    """Return both sides of (2,5) with h in sinh h and cosh h, as the text has it eight times."""
    X, Y = ar.pi * W / K, ar.pi * ALPHA / K
    total = -ar.atan(ar.cot(X / 2) * ar.tanh(Y / 2))
    for h in range(1, 60):
        wave = (-1) ** (h - 1) * 2 * Q**h
        below = wave * ar.cos(X) * ar.cosh(h * Y) + 1 + Q ** (2 * h)
        total += ar.atan(wave * ar.sin(X) * ar.sinh(h * Y) / below)
    return both(omega, 1, W), J * total


def quotient_of(values: Any) -> Any:
    """Return the arctangent in (2,6) of sn, cn, dn."""
    sn, cn, dn = values
    return J * ar.atan(S * D * cn / (C * sn * dn))


chrapan.each(
    once,
    {
        "(2,1)": lambda: (
            ratio_there("01", W, V + J * K_PRIME),
            ratio(omega("11", W, V, k) + J * ar.pi * (W / K + 1) / 2),
        ),
        **{
            f"(2,{number})": lambda ij=ij, there=there: [
                (
                    ratio_there(ij, W, v, *IMAGINARY),
                    ratio(omega(there, W * STRETCH, v * STRETCH, k)),
                )
                for v in (V, J * V)
            ]
            for number, ij, there in ((2, "01", "00"), (3, "11", "11"))
        },
        "(2,5)": lambda: [
            pair
            for w in (V, W)
            for pair in zip(
                (omega("00", w, JA, k), omega("11", w, JA, k)), arctangents(w), strict=True
            )
        ],
        "(2,6)": lambda: (
            ratio(both(omega, -1, W)),
            ratio(quotient_of(ar.ellipfun(f, W, m=k**2) for f in ("sn", "cn", "dn"))),
        ),
        **{
            f"(2,{number})": lambda ij=ij: (
                slope(lambda w: omega(ij, w, JA, k), W),
                (zeta_there(ij, W - JA) - zeta_there(ij, W + JA)) / 2,
            )
            for number, ij in enumerate(THIRD, 7)
        },
        "section 3 a: Pi01 of Jacobi": lambda: (
            ratio(pi_function("01", W, V, k)),
            pi_there("01", W, V),
        ),
        **{
            f"(3,{number})": lambda ij=ij: [
                (ratio(pi_function(ij, W, v, k)), pi_there(ij, W, v)) for v in (V, JA)
            ]
            for number, ij in ((1, "00"), (2, "11"))
        },
        "section 3 d: slopes of Pi": lambda: [
            (
                slope(partial(at_parameter, ij), W),
                zeta_there(ij, JA) + (zeta_there(ij, W - JA) - zeta_there(ij, W + JA)) / 2,
            )
            for ij in THIRD
        ],
        "(3,3)": lambda: (pi_there("01", W, V + J * K_PRIME), -ratio(pi_function("11", W, V, k))),
        **{
            f"(3,{number})": lambda ij=ij, there=there: (
                pi_there(ij, W, J * V, *IMAGINARY),
                ratio(pi_function(there, W * STRETCH, J * V * STRETCH, k)),
            )
            for number, ij, there in ((4, "01", "00"), (5, "11", "11"))
        },
        "(3,8)": lambda: [integral(k**2, V, lambda v: pi_function("01", W, v, k))],
    },
)


def at_parameter(ij: str, w: Any) -> Any:
    """Return Pi_ij(w, i alpha)."""
    return pi_function(ij, w, JA, k)


def slope_3_7(sign: int) -> Any:
    """Return the right side of (3,7)."""
    return -J * k**2 * S / (C * D) - sign * J * C * D / S


def integral(m: Any, v: Any, pi01: Any) -> tuple[Any, Any]:
    """Return both sides of (3,8): the integral up to W by mpmath, and a multiple of Pi01."""
    sn, cn, dn = (ar.ellipfun(name, v, m=m) for name in ("sn", "cn", "dn"))

    def integrand(x: Any) -> Any:
        wave = m * sn**2 * ar.ellipfun("sn", x, m=m) ** 2
        return wave / (1 - wave)

    return ar.quad(integrand, [0, W]), sn / (cn * dn) * pi01(v)


chrapan.each(
    lambda: [(1,), (-1,)],
    {
        "(2,10)": lambda sign: (
            slope(partial(both, omega, sign), 0),
            -zeta_there("00", JA) - sign * zeta_there("11", JA),
        ),
        "(2,11)": lambda sign: (
            slope(partial(both, omega, sign), K),
            -zeta_there("01", JA) - sign * zeta_there("10", JA),
        ),
        "(3,6)": lambda sign: (slope(partial(both, pi_function, sign), 0), 0),
        "(3,7)": lambda sign: (slope(partial(both, pi_function, sign), K), slope_3_7(sign)),
    },
)
chrapan.each(
    lambda: [(V,), (J * V,), (V + J * V,)],
    {
        "(3,8) for the imaginary modulus of section 4": lambda v: [
            integral(-(K_BAR**2), v, lambda v: pi_function("00", W * STRETCH, v * STRETCH, k)),
            integral(-(K_BAR**2), v, lambda v: pi_function("01", W, v, J * K_BAR)),
        ]
    },
)
chrapan.each_as_printed(
    once,
    {
        "(1,1)": lambda: (zeta_there("01", V, *IMAGINARY), zeta("00", V * STRETCH, k)),
        "(1,2)": lambda: (zeta_there("11", V, *IMAGINARY), zeta("11", V * STRETCH, k)),
        "(1,4)": lambda: (
            zeta("00", JA, k) - zeta("01", JA, k),
            -J * COMPLEMENT**2 * S / (C * D),
        ),
        "(1,8)": lambda: sum_1_8(1),
        "(2,5)": misprinted_2_5,
        "(3,7)": lambda: (slope(partial(both, pi_function, 1), k), slope_3_7(1)),
    },
)


class TestChrapan(EquationTests):
    """Tests of sections 1 to 3."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = misprints("Chrapan", 1, 2, 3)

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put wrong functions of ours in place."""
        for function in (
            *(zeta, omega, pi_function, nome, incomplete_e, incomplete_f, jacobi),
            *(quarter_period, second_kind),
        ):
            patch.setattr(sys.modules[__name__], function.__name__, slightly_wrong(function))
