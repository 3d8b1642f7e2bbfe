"""Aksenov's sections 3.1 and 3.2, equation by equation, and eta(tau) against its quadrature."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest
from equations import EquationTests, Register, page, slightly_wrong
from errata import misprints
from ours import ar, fraction, incomplete_f, jacobi, nome, ours, quarter_period

from lagrange_cli.elliptic.eta import EtaConstants, Quadrature, eta_columns, eta_constants
from lagrange_cli.elliptic.functions import Functions

aksenov = Register(__name__)
MODULI = [ar.mpf(x) for x in ("0.03", "0.5", "0.9", "0.9999")]
ARGUMENTS = [ar.mpf(x) for x in ("-2.3", "0.4", "1.7", "11")]


def moduli() -> Iterator[SimpleNamespace]:
    """Yield k, k^2, k' and K."""
    for k in MODULI:
        yield SimpleNamespace(k=k, m=k**2, k1=ar.sqrt(1 - k**2), K=ar.ellipk(k**2))


def smaller_moduli() -> list[Any]:
    """Return those for which the series of K ends soon."""
    return list(moduli())[:3]


def points() -> Iterator[SimpleNamespace]:
    """Yield k, k^2, u, and our am, sn, cn, dn."""
    for k, u in product(MODULI, ARGUMENTS):
        own = zip(("am", "sn", "cn", "dn"), jacobi(u, k), strict=True)
        yield SimpleNamespace(k=k, m=k**2, u=u, **dict(own))


def theirs(u: Any, m: Any) -> list[Any]:
    """Return sn, cn, dn by mpmath."""
    return [ar.ellipfun(name, u, m=m) for name in ("sn", "cn", "dn")]


def series(name: str, k: Any, u: Any = 0, terms: int = 250) -> Any:
    """Return a partial sum of the series of K (3.1.8), sn (3.1.4), cn (3.1.5) or am (3.1.7)."""
    if name == "K":
        term = total = ar.pi / 2
        for n in range(1, terms):
            term *= (k * (2 * n - 1) / (2 * n)) ** 2
            total += term
        return total
    q, x, scale = nome(k), ar.pi * u / (2 * quarter_period(k)), 2 * ar.pi / (k * quarter_period(k))
    if name == "am":
        return x + sum(
            2 * q**n / (n * (1 + q ** (2 * n))) * ar.sin(2 * n * x) for n in range(1, terms)
        )
    sign, wave = (-1, ar.sin) if name == "sn" else (1, ar.cos)
    return scale * sum(
        ar.sqrt(q) ** n / (1 + sign * q**n) * wave(n * x) for n in range(1, 2 * terms, 2)
    )


def first_kind(x: Any, m: Any) -> Any:
    """Return the integral (3.1.1) by quadrature."""
    return ar.quad(lambda t: 1 / ar.sqrt((1 - t * t) * (1 - m * t * t)), [0, x])


def cross_ratios(roots: list[Any]) -> list[Any]:
    """Return the six values that k^2 may have after a linear-fractional substitution."""
    a, b, c, d = roots
    x = (a - b) * (c - d) / ((a - c) * (b - d))
    return [x, 1 / x, 1 - x, 1 / (1 - x), 1 - 1 / x, x / (x - 1)]


def substituted() -> list[Any]:
    """Return pairs: the integral between four real roots, and the moduli of two complex pairs."""
    a, b, c, d = roots = [ar.mpf(x) for x in ("2.1", "0.4", "-0.9", "-3")]
    m, y = cross_ratios(roots)[0], ar.mpf("1.3")
    phi = ar.asin(ar.sqrt((a - c) * (y - b) / ((a - b) * (y - c))))

    def integrand(z: Any) -> Any:  # with x = b + z^2 under the root of (a - x)(x - b)(x - c)(x - d)
        x = b + z * z
        return 2 / ar.sqrt((a - x) * (x - c) * (x - d))

    factor = 2 / ar.sqrt((a - c) * (b - d))
    complex_roots = [ar.mpc(x, sign * y) for x, y in ((0.3, 1), (-0.8, 1.7)) for sign in (1, -1)]
    found = [factor * incomplete_f(phi, ar.sqrt(m)), ar.quad(integrand, [0, ar.sqrt(y - b)])]
    return found + [x for ratio in cross_ratios(complex_roots) for x in (ar.im(ratio), 0)]


def at_quarters(k: Any, count: int) -> list[list[Any]]:
    """Return our sn, cn, dn at -count K/2, ..., count K/2."""
    K = ar.ellipk(k**2)
    return [list(jacobi(i * K / 2, k)[1:]) for i in range(-count, count + 1)]


# Section 3.2 on a generic quadrature: the integral, and each constant by the text's own formula.

LOWER, UPPER, P, Q, G = (Fraction(x) for x in ("-0.5", "0.6", "0.1", "1.4", "2.5"))
NESTED = Quadrature(LOWER, UPPER, (P - Q, P + Q), G)
C = EtaConstants(*ours.evaluated(lambda: tuple(eta_constants(NESTED))))
DELTA, DELTA_STAR, P_, Q_, G_ = (
    ar.mpf(x.numerator) / x.denominator for x in (UPPER, LOWER, P, Q, G)
)
MIDDLE, HALF = (DELTA + DELTA_STAR) / 2, (DELTA - DELTA_STAR) / 2
K1 = ar.ellipk(C.k1**2)
TAUS = [C.period * x for x in (ar.mpf("0.07"), ar.mpf("0.21"), ar.mpf("0.44"))]


def eta_at(tau: Any) -> Any:
    """Return eta at a time since it was at delta*."""

    def compute() -> Any:
        constants = eta_constants(NESTED)
        functions = Functions(constants.modulus(NESTED))
        return eta_columns(fraction(tau), NESTED, constants, functions)["eta"]

    return ours.evaluated(compute)


def times() -> Iterator[SimpleNamespace]:
    """Yield tau, eta, and xi = sn(h1, k1) of (3.2.11) with its amplitude."""
    for tau in TAUS:
        xi = ar.ellipfun("sn", C.sigma1 * tau - K1, m=C.k1**2)
        yield SimpleNamespace(tau=tau, eta=eta_at(tau), xi=xi, theta=ar.asin(xi))


def to(angle: Any, integrand: Callable[[Any], Any]) -> Any:
    """Return the integral from -pi/2 to an angle of an even function over the root of another."""
    return ar.quad(lambda x: 1 / ar.sqrt(integrand(x)), [-ar.pi / 2, angle])


def fractional(sine: Any) -> Any:
    """Return the right side of (3.2.6), (3.2.9) and (3.2.11)."""
    return (C.gamma + C.s * sine) / (1 + C.d * sine)


def k2(sign: int) -> Any:
    """Return the right side of (3.2.5) with a sign between the two squares."""
    return ((DELTA - DELTA_STAR) ** 2 + sign * (C.m1 - C.m2) ** 2) / (4 * C.m1 * C.m2)


TWO_REAL = [ar.mpf(2), ar.mpf(-1), ar.mpc("0.5", "1.7"), ar.mpc("0.5", "-1.7")]
"""Roots for which there is no real modulus."""

aksenov.enter(page("aksenov-3"))


class TestAksenov(EquationTests):
    """Tests of sections 3.1 and 3.2."""

    register: ClassVar[Register] = aksenov
    errata: ClassVar[set[str]] = misprints("Aksenov", 3)

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put wrong functions and constants of ours in place."""
        here = sys.modules[__name__]
        for name in ("jacobi", "incomplete_f", "quarter_period", "nome", "eta_at"):
            patch.setattr(here, name, slightly_wrong(getattr(here, name)))
        wrong = [x * (1 + ar.mpf(i) / 100) for i, x in enumerate(C, 1)]
        patch.setattr(here, "C", type(C)(*wrong))
