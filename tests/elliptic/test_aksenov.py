"""Aksenov's sections 3.1 and 3.2, equation by equation, and eta(tau) against its quadrature."""

from __future__ import annotations

import sys
from fractions import Fraction
from itertools import islice
from typing import Any, ClassVar

import pytest
from equations import EquationTests, Register, Sides, slightly_wrong
from errata import misprints
from ours import ar, fraction, incomplete_f, jacobi, nome, ours, quarter_period

from lagrange_cli.arithmetic.points import ListedPoints
from lagrange_cli.elliptic.eta import EtaConstants, EtaTable, Quadrature, eta_constants
from lagrange_cli.elliptic.nome_series import k_series, nome_series

aksenov = Register()
equation, as_printed = aksenov.equation, aksenov.as_printed
misreading = aksenov.misreading

MODULI = [ar.mpf(x) for x in ("0.03", "0.5", "0.9", "0.9999")]
ARGUMENTS = [ar.mpf(x) for x in ("-2.3", "0.4", "1.7", "11")]


def _cross_ratios(roots: list[Any]) -> list[Any]:
    """Return the six values that k^2 may have after a linear-fractional substitution."""
    a, b, c, d = roots
    x = (a - b) * (c - d) / ((a - c) * (b - d))
    return [x, 1 / x, 1 - x, 1 / (1 - x), 1 - 1 / x, x / (x - 1)]


@equation("section 3.1: a linear-fractional substitution")
def _() -> Sides:
    a, b, c, d = roots = [ar.mpf(x) for x in ("2.1", "0.4", "-0.9", "-3")]
    m, y = _cross_ratios(roots)[0], ar.mpf("1.3")
    phi = ar.asin(ar.sqrt((a - c) * (y - b) / ((a - b) * (y - c))))

    def integrand(z: Any) -> Any:  # with x = b + z^2 under the root of (a - x)(x - b)(x - c)(x - d)
        x = b + z * z
        return 2 / ar.sqrt((a - x) * (x - c) * (x - d))

    there = ar.quad(integrand, [0, ar.sqrt(y - b)])
    factor = 2 / ar.sqrt((a - c) * (b - d))
    yield factor * incomplete_f(phi, ar.sqrt(m)), there
    pairs = [ar.mpc("0.3", x) for x in (1, -1)] + [ar.mpc("-0.8", x) for x in ("1.7", "-1.7")]
    yield from ((ar.im(x), 0) for x in _cross_ratios(pairs))


@as_printed("section 3.1: a linear-fractional substitution")
def _() -> Sides:
    """Show that two real roots and two complex ones have no real modulus."""
    roots = [ar.mpf(2), ar.mpf(-1), ar.mpc("0.5", "1.7"), ar.mpc("0.5", "-1.7")]
    yield from ((ar.im(x), 0) for x in _cross_ratios(roots))


@equation("(3.1.1)")
def _() -> Sides:
    for k in MODULI:
        x, m = ar.mpf("0.7"), k**2
        integral = ar.quad(lambda t: 1 / ar.sqrt((1 - t * t) * (1 - m * t * t)), [0, x])  # noqa: B023
        yield jacobi(integral, k)[1], x


@equation("(3.1.2)")
def _() -> Sides:
    for k in MODULI:
        for phi in (ar.mpf("0.7"), ar.mpf("4.4")):
            yield incomplete_f(phi, k), ar.ellipf(phi, k**2)
        yield quarter_period(k), ar.ellipk(k**2)


@equation("(3.1.3)")
def _() -> Sides:
    for k in MODULI:
        for u in ARGUMENTS:
            yield ar.ellipf(jacobi(u, k)[0], k**2), u


@equation("section 3.1: definitions of sn, cn, dn")
def _() -> Sides:
    for k in MODULI:
        for u in ARGUMENTS:
            am, sn, cn, dn = jacobi(u, k)
            yield sn, ar.sin(am)
            yield cn, ar.cos(am)
            yield dn, ar.sqrt(1 - k**2 * ar.sin(am) ** 2)
            yield sn, ar.ellipfun("sn", u, m=k**2)


@equation("section 3.1: property 1")
def _() -> Sides:
    for k in MODULI:
        K = ar.ellipk(k**2)
        for u in ARGUMENTS:
            here, half = jacobi(u, k), jacobi(u + 2 * K, k)
            yield from zip(half, (here[0] + ar.pi, -here[1], -here[2], here[3]), strict=True)
            yield from zip(jacobi(u + 4 * K, k)[1:], here[1:], strict=True)


@equation("section 3.1: property 2")
def _() -> Sides:
    for k in MODULI:
        K = ar.ellipk(k**2)
        values = [jacobi(i * K / 2, k) for i in range(-5, 6)]
        for extreme in (min, max):
            sign = 1 if extreme is max else -1
            yield extreme(value[1] for value in values), sign
            yield extreme(value[2] for value in values), sign
        yield min(value[3] for value in values), ar.sqrt(1 - k**2)
        yield max(value[3] for value in values), 1


@equation("section 3.1: table 2")
def _() -> Sides:
    for k in MODULI:
        K, less = ar.ellipk(k**2), ar.sqrt(1 - k**2)
        table = [(0, 1, 1), (1, 0, less), (0, -1, 1), (-1, 0, less), (0, 1, 1)]
        for quarter, values in enumerate(table):
            yield from zip(jacobi(quarter * K, k)[1:], values, strict=True)


@equation("section 3.1: property 3")
def _() -> Sides:
    for k in MODULI:
        for u in ARGUMENTS:
            here, there = jacobi(u, k), jacobi(-u, k)
            yield from zip(there, (-here[0], -here[1], here[2], here[3]), strict=True)


@equation("section 3.1: property 4")
def _() -> Sides:
    for k in MODULI:
        for u in ARGUMENTS:
            _, sn, cn, dn = jacobi(u, k)
            m = k**2
            yield sn**2 + cn**2, 1
            yield dn**2 + m * sn**2, 1
            yield dn**2 - m * cn**2 + m, 1


@as_printed("section 3.1: property 4")
def _() -> Sides:
    _, sn, _, dn = jacobi(ARGUMENTS[1], MODULI[1])
    yield dn**2 + MODULI[1] ** 2 * sn**2, -1


@equation("section 3.1: property 5")
def _() -> Sides:
    for u in ARGUMENTS:
        yield from zip(jacobi(u, 0), (u, ar.sin(u), ar.cos(u), 1), strict=True)
        limit = jacobi(u, 1)
        yield from zip(limit[1:], (ar.tanh(u), ar.sech(u), ar.sech(u)), strict=True)


@equation("section 3.1: property 5, next terms")
def _() -> Sides:
    for u in ARGUMENTS[:3]:
        small = ar.mpf(10) ** -12
        circular = -ar.cos(u) * (u - ar.sin(u) * ar.cos(u)) / 4
        yield (jacobi(u, small)[1] - ar.sin(u)) / small**2 * 1, circular
        hyperbolic = (ar.sinh(u) * ar.cosh(u) - u) / ar.cosh(u) ** 2 / 4
        near_one = jacobi(u, ar.sqrt(1 - small**2))[1]
        yield (near_one - ar.tanh(u)) / small**2, hyperbolic


def partial_sum(name: str, k: Any, u: Any = 0, terms: int = 250) -> Any:
    """Return the sum of so many terms of the series of K, am, sn or cn."""

    def compute() -> Any:
        modulus = ours.modulus(k)
        series = k_series(modulus) if name == "K" else nome_series(ours.ball(u), modulus)[name]
        return next(islice(series.sums, terms, None))

    return ours.evaluated(compute)


@equation("(3.1.4)")
def _() -> Sides:
    for k in MODULI:
        for u in ARGUMENTS:
            yield partial_sum("sn", k, u), ar.ellipfun("sn", u, m=k**2)


@equation("(3.1.5)")
def _() -> Sides:
    for k in MODULI:
        for u in ARGUMENTS:
            yield partial_sum("cn", k, u), ar.ellipfun("cn", u, m=k**2)


@equation("(3.1.6)")
def _() -> Sides:
    for k in MODULI:
        m = k**2
        there = ar.exp(-ar.pi * ar.ellipk(1 - m) / ar.ellipk(m))
        yield nome(k), there


@as_printed("(3.1.6)")
def _() -> Sides:
    m = MODULI[1] ** 2
    left = nome(MODULI[1])
    yield left, ar.exp(ar.pi * ar.ellipk(1 - m) / ar.ellipk(m))


@equation("(3.1.7)")
def _() -> Sides:
    for k in MODULI:
        for u in ARGUMENTS:
            yield ar.ellipf(partial_sum("am", k, u), k**2), u


@equation("(3.1.8)")
def _() -> Sides:
    for k in MODULI[:3]:
        yield partial_sum("K", k, terms=600), ar.ellipk(k**2)


# Section 3.2 on a generic quadrature: the integral, and each constant by the text's own formula.

LOWER, UPPER, P, Q, G = (Fraction(x) for x in ("-0.5", "0.6", "0.1", "1.4", "2.5"))
NESTED = Quadrature(LOWER, UPPER, (P - Q, P + Q), G)
C = EtaConstants(*ours.evaluated(lambda: tuple(eta_constants(NESTED))))
TABLE = EtaTable(ListedPoints([]), NESTED)
DELTA, DELTA_STAR, P_, Q_, G_ = (
    ar.mpf(x.numerator) / x.denominator for x in (UPPER, LOWER, P, Q, G)
)
K1 = ar.ellipk(C.k1**2)


def eta_at(tau: Any) -> Any:
    """Return eta at a time since it was at delta*."""
    return ours.evaluated(lambda: TABLE.columns(fraction(tau), TABLE.constants())["eta"])


TAUS = [C.period * x for x in (ar.mpf("0.07"), ar.mpf("0.21"), ar.mpf("0.44"))]


@equation("(3.2.1)")
def _() -> Sides:
    middle, half = (DELTA + DELTA_STAR) / 2, (DELTA - DELTA_STAR) / 2
    for tau in TAUS:
        angle = ar.asin((eta_at(tau) - middle) / half)  # takes the root at delta* away

        def integrand(x: Any) -> Any:
            return 1 / ar.sqrt(Q_**2 - (middle + half * ar.sin(x) - P_) ** 2)

        yield ar.quad(integrand, [-ar.pi / 2, angle]), ar.sqrt(G_) * tau


def xi(tau: Any) -> Any:
    """Return sn(h1, k1) of (3.2.11)."""
    return ar.ellipfun("sn", C.sigma1 * tau - K1, m=C.k1**2)


@equation("(3.2.2)")
def _() -> Sides:
    less, more = C.m1 - C.m2, C.m1 + C.m2
    for tau in TAUS:
        fraction = (less - more * xi(tau)) / (less * xi(tau) - more)
        yield eta_at(tau), (DELTA + DELTA_STAR) / 2 + (DELTA - DELTA_STAR) / 2 * fraction


@equation("(3.2.3)")
def _() -> Sides:
    yield C.m1, ar.sqrt(Q_**2 - (DELTA - P_) ** 2)
    yield C.m2, ar.sqrt(Q_**2 - (DELTA_STAR - P_) ** 2)


@equation("(3.2.4)")
def _() -> Sides:
    for tau in TAUS:
        angle = ar.asin(xi(tau))
        integral = ar.quad(lambda x: 1 / ar.sqrt(1 + C.k**2 * ar.cos(x) ** 2), [-ar.pi / 2, angle])
        yield integral, ar.sqrt(G_ * C.m1 * C.m2) * tau


def _k2(sign: int) -> Any:
    """Return the right side of (3.2.5) with a sign between the two squares."""
    return ((DELTA - DELTA_STAR) ** 2 + sign * (C.m1 - C.m2) ** 2) / (4 * C.m1 * C.m2)


@equation("(3.2.5)")
def _() -> Sides:
    yield C.k**2, _k2(1)


@misreading("(3.2.5) as printed, the plus read as a minus")
def _() -> Sides:
    share = 4 * C.m1 * C.m2 / (C.m1 - C.m2) ** 2
    yield share * C.k**2, share * _k2(-1)


@equation("(3.2.6)")
def _() -> Sides:
    for tau in TAUS:
        theta = ar.asin(xi(tau))
        yield eta_at(tau), (C.gamma + C.s * ar.sin(theta)) / (1 + C.d * ar.sin(theta))


@equation("(3.2.7)")
def _() -> Sides:
    for tau in TAUS:
        theta = ar.asin(xi(tau))
        integral = ar.quad(lambda x: 1 / ar.sqrt(1 - (C.k1 * ar.sin(x)) ** 2), [-ar.pi / 2, theta])
        yield integral, C.sigma1 * tau
        yield ar.ellipf(theta, C.k1**2) + K1, C.sigma1 * tau


@equation("(3.2.8)")
def _() -> Sides:
    k2 = _k2(1)
    yield C.k1**2, k2 / (1 + k2)
    yield C.sigma1, ar.sqrt(G_ * C.m1 * C.m2 * (1 + k2))
    yield C.k1_prime**2, 1 - C.k1**2


@equation("(3.2.9)")
def _() -> Sides:
    for tau in TAUS:
        h1 = C.sigma1 * tau - K1
        theta = jacobi(h1, C.k1)[0]
        yield eta_at(tau), (C.gamma + C.s * ar.sin(theta)) / (1 + C.d * ar.sin(theta))


@equation("(3.2.10)")
def _() -> Sides:
    yield eta_at(ar.mpf(0)), DELTA_STAR
    yield eta_at(2 * K1 / C.sigma1), DELTA
    yield C.period, 4 * K1 / C.sigma1


@misreading("(3.2.10) as printed, the minus read as a plus")
def _() -> Sides:
    sn = ar.ellipfun("sn", C.sigma1 * TAUS[0] + K1, m=C.k1**2)
    yield eta_at(TAUS[0]), (C.gamma + C.s * sn) / (1 + C.d * sn)


@equation("(3.2.11)")
def _() -> Sides:
    for tau in TAUS:
        yield eta_at(tau), (C.gamma + C.s * xi(tau)) / (1 + C.d * xi(tau))


@equation("(3.2.12)")
def _() -> Sides:
    total = C.m1 + C.m2
    yield C.s, -(C.m1 * DELTA_STAR - C.m2 * DELTA) / total
    yield C.d, -(C.m1 - C.m2) / total
    yield C.gamma, (C.m1 * DELTA_STAR + C.m2 * DELTA) / total
    yield C.gamma + C.s, DELTA * (1 + C.d)
    yield C.gamma - C.s, DELTA_STAR * (1 - C.d)


class TestAksenov(EquationTests):
    """Tests of sections 3.1 and 3.2."""

    register: ClassVar[Register] = aksenov
    errata: ClassVar[set[str]] = misprints("Aksenov", 3)
    tolerances: ClassVar[dict[str, float]] = {"section 3.1: property 5, next terms": 1e-22}

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put wrong functions and constants of ours in place."""
        here = sys.modules[__name__]
        for name in ("jacobi", "incomplete_f", "quarter_period", "nome", "eta_at", "partial_sum"):
            patch.setattr(here, name, slightly_wrong(getattr(here, name)))
        wrong = [x * (1 + ar.mpf(i) / 100) for i, x in enumerate(C, 1)]
        patch.setattr(here, "C", type(C)(*wrong))
