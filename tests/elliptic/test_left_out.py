"""Truncated iterations and series: cut short on purpose, their balls still hold the truth.

The truth is Arb's own: agm, Carlson's and Legendre's integrals, Jacobi's theta functions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import partial
from typing import Any
from unittest.mock import patch

import pytest
from arb_balls import exact_arb, holds
from balls.scene import arb_bits
from flint import acb, arb

import lagrange_cli.elliptic.third_kind as third_kinds
from lagrange_cli.arithmetic.ball import Ball
from lagrange_cli.arithmetic.balls import Balls
from lagrange_cli.arithmetic.complex_balls import ComplexBalls
from lagrange_cli.elliptic.carlson import carlson_rd, carlson_rf, carlson_rj
from lagrange_cli.elliptic.complete import (
    agm,
    complete_e,
    complete_k,
    cosine_and_sine,
    first_kind,
    hyperbolic_cosine_and_sine,
    nome,
    period_mean,
    place,
)
from lagrange_cli.elliptic.complex_theta import sums_in_cell
from lagrange_cli.elliptic.modulus import exact_modulus, modulus
from lagrange_cli.elliptic.periods import whole_and_rest
from lagrange_cli.elliptic.theta import series_for, theta_at, zeta_at

DIGITS = 120
STOPS = (1, 2, 3, 6, 15, 36, 90)
"""Where iterations are cut short: 10^-stop."""
SERIES_STOPS = STOPS[2:]
"""Where series are cut short: their steepness has to be known."""

FULL = ComplexBalls(DIGITS)
"""Constants of series have all digits: their bounds would hide those of the series."""


class Unwidened(ComplexBalls):
    """Balls that forget what an iteration leaves out."""

    def widened(self, x: Ball, *_: Any, **__: Any) -> Ball:
        return x


def missed(
    compute: Callable[[Balls], Sequence[Ball]],
    exact: Sequence[arb],
    sharp: Callable[[int, Decimal], bool],
    stops: Sequence[int] = STOPS,
) -> int:
    """Return how often results that are cut short miss the truth without the bound.

    With it they hold the truth, and `sharp` says whether their largest radius is small enough.
    """
    for stop in stops:
        found = compute(ComplexBalls(DIGITS, stop))
        assert all(map(holds, found, exact)), stop
        assert sharp(stop, max(x.radius for x in found)), stop  # or the bound would be no bound
    short = (compute(Unwidened(DIGITS, stop)) for stop in stops)
    return sum(not all(map(holds, found, exact)) for found in short)


def within(share: int, first: int) -> Callable[[int, Decimal], bool]:
    """Return whether a radius is at most 10^(share - stop), from some stop on."""
    return lambda stop, radius: stop < first or radius < Decimal(10) ** (share - stop)


def real(value: acb) -> arb:
    return value.real


def quarter(m: arb) -> arb:
    return real(acb(m).elliptic_k())


def nome_of(m: arb) -> arb:
    return (-arb.pi() * quarter(1 - m) / quarter(m)).exp()


def first_kind_of(m: arb, s2: arb) -> arb:
    return real(acb.elliptic_f(acb(s2.sqrt().asin()), acb(m)))


def place_of(m: arb, s2: arb) -> arb:
    """Return pi u/2K for sn^2(u, k) = s2."""
    return arb.pi() * first_kind_of(m, s2) / (2 * quarter(m))


def imaginary_place(m: arb, s2: arb) -> arb:
    """Return pi v/2K for sn^2(v, k') = s2."""
    return place_of(1 - m, s2) * quarter(1 - m) / quarter(m)


def mean_by_legendre(m: arb, p: arb) -> arb:
    """Return the mean of (2 cn^2 + 3 sn^2)/(cn^2 + p sn^2), by Legendre's Pi of n = 1 - p."""
    K = quarter(m)
    if p == 1:
        return 2 + (1 - real(acb(m).elliptic_e()) / K) / m
    whole = real(acb.elliptic_pi(acb(1 - p), acb(m))) / K  # the mean of 1/(cn^2 + p sn^2)
    sines = (whole - 1) / (1 - p)  # of sn^2/(cn^2 + p sn^2)
    return 2 * (whole - sines) + 3 * sines


def landen(function: Callable[..., tuple[Ball, Ball]], part: int) -> Callable[..., Ball]:
    """Return one result of Landen's transformation as a function of k^2 and sn^2."""

    def computed(ar: Any, m: Ball, s2: Ball) -> Ball:
        return function(ar, m=m, k_prime=ar.sqrt(1 - m), s2=s2, c2=1 - s2)[part]

    return computed


def by_place(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of a place as one of k^2 and sn^2."""

    def computed(ar: Any, m: Any, s2: Any) -> Any:
        return function(ar, m=m, k_prime=ar.sqrt(1 - m), sn=ar.sqrt(s2), cn2=1 - s2)

    return computed


def carlson(function: Callable[..., acb]) -> Callable[..., arb]:
    """Return an integral of Arb as a function of real balls."""
    return lambda *arguments: real(function(*map(acb, arguments)))


MODULI = ["0.003", "0.58", "0.999", "0.9999999"]
PLACES_IN_A_PERIOD = [(m, s2) for m in MODULI for s2 in ("0.000001", "0.3", "0.99999")]
ARGUMENTS = [("1", "2", "3"), ("0", "1", "5"), ("0.001", "4000", "7"), ("2", "2", "3")]
ONE = [(m,) for m in MODULI]
SMOOTH: dict[str, tuple[Callable[..., Any], Callable[..., arb], Sequence[Sequence[str]]]] = {
    "agm": (lambda ar, m: agm(ar, 1, ar.sqrt(1 - m)), lambda m: arb(1).agm((1 - m).sqrt()), ONE),
    "K": (lambda ar, m: complete_k(ar, ar.sqrt(1 - m)), quarter, ONE),
    "E": (
        lambda ar, m: complete_e(ar, ar.sqrt(1 - m)),
        lambda m: real(acb(m).elliptic_e()),
        ONE,
    ),
    "nome": (lambda ar, m: nome(ar, m=m, k_prime=ar.sqrt(1 - m)), nome_of, ONE),
    "period_mean": (
        lambda ar, m, p: period_mean(ar, ar.sqrt(1 - m), p, 2, 3),
        mean_by_legendre,
        [(m, p) for m in MODULI for p in ("0.01", "1", "70")],
    ),
    "place": (by_place(place), place_of, PLACES_IN_A_PERIOD),
    "first kind": (by_place(first_kind), first_kind_of, PLACES_IN_A_PERIOD),
}
"""Iterations whose bounds hold for derivatives too: in balls, the truth, and arguments of both."""
ITERATIONS = SMOOTH | {
    "cos": (landen(cosine_and_sine, 0), lambda *x: place_of(*x).cos(), PLACES_IN_A_PERIOD),
    "sin": (landen(cosine_and_sine, 1), lambda *x: place_of(*x).sin(), PLACES_IN_A_PERIOD),
    "cosh": (
        landen(hyperbolic_cosine_and_sine, 0),
        lambda *x: imaginary_place(*x).cosh(),
        PLACES_IN_A_PERIOD,
    ),
    "sinh": (
        landen(hyperbolic_cosine_and_sine, 1),
        lambda *x: imaginary_place(*x).sinh(),
        PLACES_IN_A_PERIOD,
    ),
    "R_F": (carlson_rf, carlson(acb.elliptic_rf), ARGUMENTS),
    "R_D": (carlson_rd, carlson(acb.elliptic_rd), ARGUMENTS),
    "R_J": (carlson_rj, carlson(acb.elliptic_rj), [(*x, "0.4") for x in ARGUMENTS]),
}


def theta_at_complex(ij: str, z: acb, k: Fraction) -> acb:
    """Return theta_ij(z) by Arb."""
    m = exact_arb(k) ** 2
    one, two, three, four = acb.modular_theta(z, acb(0, quarter(1 - m) / quarter(m)))
    return {"11": one, "10": two, "00": three, "01": four}[ij]


def theta_of(ij: str, x: arb, k: Fraction) -> arb:
    """Return theta_ij(x) by Arb."""
    return real(theta_at_complex(ij, acb(x), k))


def along(function: Callable[..., arb], point: list[arb], i: int, x: arb) -> arb:
    """Return a function where coordinate i of a point is x."""
    return function(*point[:i], x, *point[i + 1 :])


def slope_of(function: Callable[[arb], arb], x: arb) -> arb:
    """Return a derivative by a central difference, with its error."""
    h = arb(10) ** -100
    slope = (function(x + h) - function(x - h)) / (2 * h)
    return slope + arb(0, (abs(slope) + 1) * arb(10) ** -150)


def zeta_of(ij: str, x: arb, k: Fraction) -> arb:
    """Return Z_ij(2Kx) by Arb."""
    logarithm = slope_of(lambda y: abs(theta_of(ij, y, k)).log(), x)
    return logarithm / (2 * quarter(exact_arb(k) ** 2))


def omega_of(ij: str, x: arb, y: arb, k: Fraction) -> arb:
    """Return Omega_ij of a real parameter, in periods."""
    return (abs(theta_of(ij, x - y, k)) / abs(theta_of(ij, x + y, k))).log() / 2


def imaginary_omega_of(ij: str, x: arb, y: arb, k: Fraction) -> arb:
    """Return the tangent of Omega_ij/i of an imaginary parameter, in periods."""
    value = theta_at_complex(ij, acb(x, -y), k)
    return value.imag / value.real


SERIES = [("0.4", "0.23"), ("0.4", "-0.49"), ("0.9", "0.001"), ("0.999", "0.31"), ("0.999", "0.45")]


@pytest.mark.parametrize("ij", ["01", "00", "11", "10"])
@pytest.mark.parametrize("name", ["theta", "zeta"])
def test_a_theta_series_cut_short_holds_the_truth(name: str, ij: str) -> None:
    """Without the bound the series misses the truth."""
    function, truth = (theta_at, theta_of) if name == "theta" else (zeta_at, zeta_of)

    def computed(ar: Balls, k: str, x: str) -> list[Ball]:
        series = series_for(FULL, exact_modulus(FULL, Fraction(k)))
        return [function(ar, ij, whole_and_rest(ar, ar.convert(Fraction(x))), series)]

    count = 0
    with arb_bits(2000):
        for k, x in SERIES:
            exact = truth(ij, exact_arb(x), Fraction(k))
            sharp = within(5, 4) if exact.is_finite() else lambda *_: True
            count += missed(partial(computed, k=k, x=x), [exact], sharp, SERIES_STOPS)
    assert count >= 3


IN_CELL = {
    "01": {"alternating": True},
    "00": {},
    "11": {"odd": True, "sines": True},
    "10": {"odd": True},
}
"""The four sums of theta functions in a cell."""


@pytest.mark.parametrize("ij", IN_CELL)
def test_a_series_of_complex_arguments_cut_short_holds_the_truth(ij: str) -> None:
    """Without the bounds, the value and the slope miss the truth."""
    counts = [0, 0]
    with arb_bits(2000):
        for t in ("3.3", "9"):
            tau = acb(0, exact_arb(t) / arb.pi())
            for phase, height in (
                ("0.1", "0.2"),
                ("-0.45", "0.03"),
                ("0.3", "0"),
                ("0.37", "0.24"),
            ):
                z = acb(exact_arb(phase), exact_arb(height) * tau.imag)
                size = (exact_arb(t) * (exact_arb(height) - exact_arb("0.25"))).exp()
                for order in (0, 1):

                    def compute(
                        ar: Any, x: str = phase, y: str = height, t: str = t, order: int = order
                    ) -> list[Ball]:
                        at = [ar.convert(Fraction(part)) for part in (x, y, t)]
                        found = sums_in_cell(ar, *at, **IN_CELL[ij])[order]
                        return [found.real, found.imag]

                    value = z.modular_theta(tau, order)[("11", "10", "00", "01").index(ij)]
                    value = value / (size if ij[0] == "1" else 1)
                    sharp = within(6, 6)
                    exact = [value.real, value.imag]
                    counts[order] += missed(compute, exact, sharp, SERIES_STOPS)
    assert min(counts) >= 3


def kind_at(ar: Balls, ij: str, k: str, y: str, *, imaginary: bool) -> Any:
    exact = exact_modulus(FULL, Fraction(k))
    v = FULL.convert(Fraction(y)) * 2 * complete_k(FULL, exact.k_prime)
    series = series_for(FULL, exact)
    with patch.object(third_kinds, "series_for", lambda *_: series):
        return third_kinds.third_kind(ar, ij, v, exact, imaginary=imaginary)


@pytest.mark.parametrize("imaginary", [False, True])
@pytest.mark.parametrize("ij", ["01", "00", "11"])
@pytest.mark.parametrize("k", ["0.5", "0.95"])
def test_omega_cut_short_holds_the_truth(k: str, ij: str, imaginary: bool) -> None:
    """Without the bound the series misses the truth."""
    truth, count = imaginary_omega_of if imaginary else omega_of, 0

    def computed(ar: Balls, x: str, y: str) -> list[Ball]:
        given = kind_at(ar, ij, k, y, imaginary=imaginary)
        found = given.omega(ar, whole_and_rest(ar, ar.convert(Fraction(x))))
        return [ar.sin(found) / ar.cos(found) if imaginary else found]

    with arb_bits(1000):
        for y in ("0.05", "0.17") if imaginary else ("0.05", "0.31", "-0.2"):
            for x in ("0.1", "0.37", "-0.45"):
                exact = truth(ij, exact_arb(x), exact_arb(y), Fraction(k))
                compute = partial(computed, x=x, y=y)
                count += missed(compute, [exact], within(6, 36), SERIES_STOPS)
    assert count >= 3


@pytest.mark.parametrize("imaginary", [False, True])
@pytest.mark.parametrize("ij", ["01", "00", "11"])
@pytest.mark.parametrize("k", ["0.5", "0.95"])
def test_what_pi_grows_by_in_a_period_holds_the_truth(k: str, ij: str, imaginary: bool) -> None:
    """The growth is 2K Z(v), and half a turn of the odd function of an imaginary v."""
    with arb_bits(2000):
        for y in ("0.05", "0.17"):
            for stop in SERIES_STOPS:
                ar = Balls(DIGITS, stop)
                kind = kind_at(ar, ij, k, y, imaginary=imaginary)
                found = kind.growth * kind.sign
                if imaginary:
                    at = exact_arb(y)
                    exact = slope_of(lambda h: _log_size(ij, h, k), at)
                    exact = -exact + (arb.pi() if ij[0] == "1" else 0)
                else:
                    K = quarter(exact_arb(Fraction(k)) ** 2)
                    exact = zeta_of(ij, exact_arb(y), Fraction(k)) * 2 * K
                assert holds(found, exact), (y, stop)
                assert stop < 36 or found.radius < Decimal(10) ** (6 - stop)


def _log_size(ij: str, y: arb, k: str) -> arb:
    """Return the logarithm of |theta_ij(iy)|, whose derivative by y is -2K Z(iy)/i."""
    return abs(theta_at_complex(ij, acb(0, y), Fraction(k))).log()


@pytest.mark.parametrize("q", ["0.01", "0.04", "0.3", "0.9"])
def test_the_modulus_of_a_nome_cut_short_holds_the_truth(q: str) -> None:
    """k = theta2^2/theta3^2 at tau = log q/(i pi); without the bound it is missed."""
    with arb_bits(1000):
        tau = acb(0, -exact_arb(q).log() / arb.pi())
        _, two, three, four = acb.modular_theta(acb(0), tau)
        exact = real((two / three) ** 2), real((four / three) ** 2)
        count = missed(lambda ar: modulus(ar, q=ar.convert(Fraction(q)))[:2], exact, within(3, 6))
    assert count >= 2


def balls_of(ar: Any, texts: Sequence[str]) -> list[Ball]:
    return [ar.convert(Fraction(text)) for text in texts]


@pytest.mark.parametrize("name", ITERATIONS)
def test_an_iteration_cut_short_holds_the_truth(name: str) -> None:
    """Without the bound some of those that are cut short miss the truth."""
    computed, truth, cases = ITERATIONS[name]
    count = 0
    with arb_bits(1000):
        for texts in cases:
            ar = Balls(DIGITS)
            exact, whole = truth(*map(exact_arb, texts)), computed(ar, *balls_of(ar, texts))
            size = whole.greatest
            assert holds(whole, exact), texts
            assert whole.radius <= size * Decimal(10) ** (12 - DIGITS), texts

            def compute(ar: Balls) -> list[Ball]:
                return [computed(ar, *balls_of(ar, texts))]  # noqa: B023

            def sharp(stop: int, radius: Decimal) -> bool:
                return stop <= 3 or radius <= 40 * size * Decimal(10) ** (1 - stop)  # noqa: B023

            count += missed(compute, [exact], sharp)
    assert count >= 3
