"""What the theta series of the attitude leave out: cut short, balls still hold theta functions.

The truth is Arb's own theta functions.
"""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from arb_balls import arb_of, exact_arb, holds
from balls.scene import arb_bits
from flint import acb, arb

from lagrange_cli.arithmetic.ball import Ball
from lagrange_cli.arithmetic.balls import Balls
from lagrange_cli.elliptic.complete import complete_k
from lagrange_cli.motion.over_time.series_constants import evaluate
from lagrange_cli.motion.over_time.theta_series import (
    SquaredRatio,
    ThetaConstants,
    circular_series,
)
from lagrange_cli.motion.over_time.theta_series import hyperbolic_series as hyperbolic

DIGITS = 120


class Unwidened(Balls):
    """Balls that forget what a series leaves out."""

    def widened(self, x: Ball, *_: Any, **__: Any) -> Ball:
        return x


def constants(ar: Balls, k2: str, s_plus: str, s_minus: str) -> ThetaConstants:
    """Return the constants of a series of any modulus and any two parameters."""
    m, mc = ar.convert(Fraction(k2)), ar.convert(1 - Fraction(k2))
    k, k_prime = ar.sqrt(m), ar.sqrt(mc)
    one = ar.convert(1)
    places = [
        SquaredRatio(ar.convert(Fraction(s2)), ar.convert(1 - Fraction(s2)))
        for s2 in (s_plus, s_minus)
    ]
    return ThetaConstants(
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
        nutation=one,
    )


def heights(m: arb, *squares: str) -> list[arb]:
    """Return pi v/2K for sn^2(v, k'), over pi."""
    K = acb(m).elliptic_k().real
    return [
        acb.elliptic_f(acb(exact_arb(s2).sqrt().asin()), acb(1 - m)).real / (2 * K)
        for s2 in squares
    ]


def phases_of(ar: Balls, k2: str, places: tuple[str, str], terms: int) -> Iterator[Any]:
    """Yield |X|/|Y| by a series of so many terms and by theta functions, and both attitudes."""
    c, m = constants(ar, k2, *places), exact_arb(k2)
    series_of = hyperbolic if Fraction(k2) > Fraction("0.5") else circular_series
    short, whole = (series_of(ar, c, count) for count in (terms, 12))
    tau = acb(0, acb(1 - m).elliptic_k().real / acb(m).elliptic_k().real)
    both = heights(m, *places)
    start = theta_truth(tau, arb(0), both)[0], theta_truth(tau, arb(1), both)[1]
    for i, phase in ((0, "-0.5"), (0, "0.31"), (0, "0.75"), (1, "-0.75"), (1, "0.2")):
        x, y = theta_truth(tau, exact_arb(phase) + i, both)
        at = ar.convert(Fraction(phase))
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
    with arb_bits(600):
        for ratio, short, full in phases_of(Balls(DIGITS), k2, places, terms):
            assert holds(short[0] / short[2], ratio)
            assert holds(full[0] / full[2], ratio)
            for part in (1, 3):
                assert holds(short[part], arb_of(full[part]))
                assert full[part].radius < Decimal("1e-60")


def test_the_bound_of_the_series_is_needed() -> None:
    ar = Unwidened(DIGITS)
    with arb_bits(600):
        found = [x for places in PLACES[:2] for x in phases_of(ar, "0.5", places, 3)]
        assert sum(not holds(short[0] / short[2], ratio) for ratio, short, _ in found) >= 5
        assert sum(not holds(short[1], arb_of(full[1])) for _, short, full in found) >= 5


def theta_truth(tau: acb, phase: arb, both: list[arb]) -> tuple[acb, acb]:
    """Return theta2(x - i y+) and theta1(x + i y-) at a phase, x = pi phase/2."""
    two = acb.modular_theta(acb(phase / 2, -both[0]), tau)[1]
    one = acb.modular_theta(acb(phase / 2, both[1]), tau)[0]
    return two, one
