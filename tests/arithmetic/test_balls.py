"""Balls, and what each iteration leaves out: cut short on purpose, it still holds the truth.

The truth is Arb's own: agm, Carlson's and Legendre's integrals, Jacobi's theta functions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from flint import acb, arb

from lagrange_cli.arithmetic.balls import OPEN, Ball, Balls, balls
from lagrange_cli.arithmetic.correct_rounding import TooFewDigitsError
from lagrange_cli.elliptic.carlson import carlson_rd, carlson_rf, carlson_rj
from lagrange_cli.elliptic.complete import agm, complete_e, complete_k, nome, period_mean
from lagrange_cli.elliptic.landen import cosine_and_sine, hyperbolic_cosine_and_sine
from lagrange_cli.motion.theta_series import Place, ThetaConstants, circular_series, evaluate
from lagrange_cli.motion.theta_series import hyperbolic_series as hyperbolic

BITS = 400
STOPS = (1, 4, 9, 20, 50, 120, 300)
"""Where iterations are cut short: 2^-stop."""


class Unwidened(Balls):
    """Balls that forget what an iteration leaves out."""

    @staticmethod
    def widened(x: Ball, remainder: Callable[[], Ball]) -> Ball:
        return x


def real(value: acb) -> arb:
    return value.real


def quarter(m: arb) -> arb:
    return real(acb(m).elliptic_k())


def nome_of(m: arb) -> arb:
    return (-arb.pi() * quarter(1 - m) / quarter(m)).exp()


def place(m: arb, s2: arb) -> arb:
    """Return pi u/2K for sn^2(u, k) = s2."""
    amplitude = acb(s2.sqrt().asin())
    return arb.pi() * real(acb.elliptic_f(amplitude, acb(m))) / (2 * quarter(m))


def imaginary_place(m: arb, s2: arb) -> arb:
    """Return pi v/2K for sn^2(v, k') = s2."""
    return place(1 - m, s2) * quarter(1 - m) / quarter(m)


def mean_by_legendre(m: arb, p: arb) -> arb:
    """Return the mean of (3 sn^2 - 2 cn^2)/(cn^2 + p sn^2), by Legendre's Pi of n = 1 - p."""
    K = quarter(m)
    if p == 1:
        sn2 = (1 - real(acb(m).elliptic_e()) / K) / m
        return 5 * sn2 - 2
    share = real(acb.elliptic_pi(acb(1 - p), acb(m))) / K  # the mean of 1/(cn^2 + p sn^2)
    return -2 * share + 5 * (share - 1) / (1 - p)


def landen(function: Callable[..., tuple[Ball, Ball]], part: int) -> Callable[..., Ball]:
    """Return one result of Landen's transformation as a function of k^2 and sn^2."""

    def computed(ar: Balls, m: Ball, s2: Ball) -> Ball:
        return function(ar, m=m, k_prime=ar.sqrt(1 - m), s2=s2, c2=1 - s2)[part]

    return computed


def carlson(function: Callable[..., acb]) -> Callable[..., arb]:
    """Return an integral of Arb as a function of real balls."""
    return lambda *arguments: real(function(*map(acb, arguments)))


MODULI = ["0.003", "0.58", "0.999", "0.9999999"]
PLACES_IN_A_PERIOD = [(m, s2) for m in MODULI for s2 in ("0.000001", "0.3", "0.99999")]
ARGUMENTS = [("1", "2", "3"), ("0", "1", "5"), ("0.001", "4000", "7"), ("2", "2", "3")]
ITERATIONS: dict[str, tuple[Callable[..., Ball], Callable[..., arb], Sequence[Sequence[str]]]] = {
    "agm": (
        lambda ar, m: agm(ar, 1, ar.sqrt(1 - m)),
        lambda m: arb(1).agm((1 - m).sqrt()),
        [(m,) for m in MODULI],
    ),
    "K": (lambda ar, m: complete_k(ar, ar.sqrt(1 - m)), quarter, [(m,) for m in MODULI]),
    "E": (
        lambda ar, m: complete_e(ar, ar.sqrt(1 - m)),
        lambda m: real(acb(m).elliptic_e()),
        [(m,) for m in MODULI],
    ),
    "nome": (
        lambda ar, m: nome(ar, m=m, k_prime=ar.sqrt(1 - m)),
        nome_of,
        [(m,) for m in MODULI],
    ),
    "period_mean": (
        lambda ar, m, p: period_mean(ar, ar.sqrt(1 - m), p, -2, 3),
        mean_by_legendre,
        [(m, p) for m in MODULI for p in ("0.01", "1", "70")],
    ),
    "cos": (landen(cosine_and_sine, 0), lambda *x: place(*x).cos(), PLACES_IN_A_PERIOD),
    "sin": (landen(cosine_and_sine, 1), lambda *x: place(*x).sin(), PLACES_IN_A_PERIOD),
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
"""Each iteration in balls, the truth, and the arguments of both."""


def arguments_of(texts: Sequence[str]) -> list[Ball]:
    return [balls(BITS).convert(Fraction(text)) for text in texts]


@pytest.mark.parametrize("name", ITERATIONS)
def test_an_iteration_cut_short_holds_the_truth(name: str) -> None:
    computed, truth, cases = ITERATIONS[name]
    with balls(BITS).working():
        for texts in cases:
            x = arguments_of(texts)
            exact, whole = truth(*(ball.arb for ball in x)), computed(balls(BITS), *x).arb
            assert whole.overlaps(exact), texts
            assert whole.rad() <= abs(whole) * arb(2) ** (40 - BITS), texts
            for stop in STOPS:
                short = computed(Balls(BITS, stop), *x).arb
                assert short.overlaps(exact), (texts, stop)
                if stop > 9:  # a bound that says nothing would be no bound
                    assert short.rad() <= 40 * abs(exact) * arb(2) ** -stop, (texts, stop)


@pytest.mark.parametrize("name", ITERATIONS)
def test_the_bound_is_needed(name: str) -> None:
    """Without it some of those that are cut short miss the truth."""
    computed, truth, cases = ITERATIONS[name]
    with balls(BITS).working():
        missed = 0
        for texts in cases:
            x = arguments_of(texts)
            exact = truth(*(ball.arb for ball in x))
            short = [computed(Unwidened(BITS, stop), *x).arb for stop in STOPS]
            missed += sum(not ball.overlaps(exact) for ball in short)
    assert missed >= 3


def constants(ar: Balls, k2: str, s_plus: str, s_minus: str) -> ThetaConstants:
    """Return the constants of a series of any modulus and any two parameters."""
    m, mc = ar.convert(Fraction(k2)), ar.convert(1 - Fraction(k2))
    k, k_prime = ar.sqrt(m), ar.sqrt(mc)
    one = ar.convert(1)
    places = [
        Place(ar.convert(Fraction(s2)), ar.convert(1 - Fraction(s2))) for s2 in (s_plus, s_minus)
    ]
    return ThetaConstants(
        period=one,
        quarter=complete_k(ar, k_prime),
        quarter_prime=complete_k(ar, k),
        m=m,
        k=k,
        k_prime=k_prime,
        plus=places[0],
        minus=places[1],
        x_size=one,
        y_size=one,
        sign_plus=1,
        sign_minus=-1,
        offset=0 * one,
        rises=1,
        nutation=one,
    )


def phases_of(ar: Balls, k2: str, places: tuple[str, str], terms: int) -> Iterator[Any]:
    """Yield |X|/|Y| by a series of so many terms and by theta functions, and both attitudes."""
    c = constants(ar, k2, *places)
    series_of = hyperbolic if Fraction(k2) > Fraction("0.5") else circular_series
    short, whole = (series_of(ar, c, count) for count in (terms, 20))
    tau = acb(0, c.quarter_prime.arb / c.quarter.arb)
    heights = [
        real(acb.elliptic_rf(acb(p.c2.arb), acb(1 - (1 - c.m.arb) * p.s2.arb), acb(1)))
        * p.s2.arb.sqrt()
        / (2 * c.quarter.arb)
        for p in (c.plus, c.minus)
    ]
    start = theta_truth(tau, arb(0), heights)[0], theta_truth(tau, arb(1), heights)[1]
    for i, phase in ((0, "-0.5"), (0, "0.31"), (0, "0.75"), (1, "-0.75"), (1, "0.2")):
        at = ar.convert(Fraction(phase))
        x, y = theta_truth(tau, at.arb + i, heights)
        found = [evaluate(ar, series, series.frames[i], at, 1) for series in (short, whole)]
        yield abs(x / start[0]) / abs(y / start[1]), *found


PLACES = [("0.2", "0.7"), ("0.9999", "0.00001"), ("0", "1")]


@pytest.mark.parametrize("terms", [3, 4, 6])
@pytest.mark.parametrize("k2", ["0.1", "0.5", "0.9"])
@pytest.mark.parametrize("places", PLACES)
def test_a_series_cut_short_holds_the_theta_functions(
    terms: int, k2: str, places: tuple[str, str]
) -> None:
    """Moduli and arguments of X and Y about both turning points, to |phase| = 3/4."""
    with balls(BITS).working():
        for ratio, short, full in phases_of(balls(BITS), k2, places, terms):
            assert (short[0] / short[2]).arb.overlaps(ratio)
            assert (full[0] / full[2]).arb.overlaps(ratio)
            for part in (1, 3):
                assert short[part].arb.overlaps(full[part].arb)
                assert full[part].arb.rad() < arb(2) ** -300


def test_the_bound_of_the_series_is_needed() -> None:
    ar = Unwidened(BITS)
    with ar.working():
        found = [x for places in PLACES[:2] for x in phases_of(ar, "0.5", places, 3)]
        assert sum(not (short[0] / short[2]).arb.overlaps(ratio) for ratio, short, _ in found) >= 5
        assert sum(not short[1].arb.overlaps(full[1].arb) for _, short, full in found) >= 5


def theta_truth(tau: acb, phase: arb, heights: list[arb]) -> tuple[acb, acb]:
    """Return theta2(x - i y+) and theta1(x + i y-) at a phase, x = pi phase/2."""
    two = acb.modular_theta(acb(phase / 2, -heights[0]), tau)[1]
    one = acb.modular_theta(acb(phase / 2, heights[1]), tau)[0]
    return two, one


def test_a_comparison_is_true_false_or_open() -> None:
    wide, one = Ball(arb(1, 0.5)), Ball(arb(1))
    assert (one < 2) is True
    assert (one > 2) is False
    assert (one <= 1) is True
    assert (wide < 1) is OPEN
    assert (wide >= one) is OPEN
    assert (Ball(arb("nan")) < 1) is OPEN
    with pytest.raises(TooFewDigitsError):
        bool(wide > 1)
    with pytest.raises(TooFewDigitsError):
        bool(Ball(arb(0, 1)))
    assert not Ball(arb(0))
    assert one


def test_an_open_choice_is_a_ball_about_both() -> None:
    wide = Ball(arb(1, 0.5))
    both = Balls.where(wide < 1, Ball(arb(3)), 7)
    assert both.arb.contains(arb(3))
    assert both.arb.contains(arb(7))
    assert not Balls.where(wide < 2, 3, 7).arb.contains(arb(7))


@pytest.mark.parametrize("digits", [1, 5, 40])
def test_ends_are_outside_the_ball(digits: int) -> None:
    for ball in (arb(1) / 3, -arb(1) / 3, arb(10) ** 50 / 7, arb(10) ** -50 / 7, arb(0, 1e-30)):
        low, high = Ball(ball).ends(digits)
        assert Fraction(low) <= Fraction(high)
        with balls(BITS).working():
            edges = [balls(BITS).convert(Fraction(end)).arb for end in (low, high)]
            assert edges[0] <= ball <= edges[1]
            assert edges[1] - edges[0] <= 4 * ball.rad() + abs(ball.mid()) * arb(10) ** (2 - digits)
    assert Ball(arb("1e-999999999999999")).ends(5)[0] > 0
    assert Ball(arb("0.125")).ends(40) == (Decimal("0.125"), Decimal("0.125"))
    with pytest.raises(TooFewDigitsError):
        Ball(arb("nan")).ends(5)


def test_an_integer_next_to_a_ball() -> None:
    assert Balls.nint(Ball(arb(7.4))) == 7
    assert Balls.nint(Ball(arb(-7.6, 0.1))) == -8
    with balls(BITS).working():
        assert Balls.nint(Ball(arb(10) ** 40 + 1)) == 10**40 + 1
    for ball in (arb(1, 0.3), arb("nan")):
        with pytest.raises(TooFewDigitsError):
            Balls.nint(Ball(ball))
