"""Balls against mpmath: every result holds the exact value, and balls are narrow."""

from __future__ import annotations

import random
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import arb, ctx

from lagrange_cli.arithmetic.ball import (
    OPEN,
    Ball,
    Balls,
    TooFewDigitsError,
    UndefinedError,
    balls,
    pi_to,
    simplest_between,
)
from lagrange_cli.errors import OutOfRangeError

AR = balls(40)
MP = mpmath.MPContext()
MP.dps = 120


def ball(low: float | Fraction, high: float | Fraction) -> Ball:
    """Return a ball that holds two numbers, and little more."""
    return AR.between(AR.convert(Fraction(low)), AR.convert(Fraction(high)))


def holds(found: Ball, exact: Any) -> bool:
    """Return whether a ball holds a number of mpmath."""
    low, high = (
        MP.mpf(Fraction(end).numerator) / Fraction(end).denominator for end in found.ends()
    )
    return bool(low <= exact <= high)


FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    "sum, difference and product": (3, lambda _, x, y, z: x * y + y - z),
    "quotient and powers": (2, lambda _, x, y: x / y + x**3 - y**-2),
    "with an integer": (1, lambda _, x: 3 - (7 * x + 2) / 5),
    **{
        name: (count, lambda ar, *x, name=name: getattr(ar, name)(*x))
        for count, names in ((1, "sin cos exp sinh cosh asinh tanh sech"), (2, "agm atan2"))
        for name in names.split()
    },
    "sqrt": (1, lambda ar, x: ar.sqrt(x**2)),
    **{
        name: (3, lambda ar, *x, name=name: getattr(ar, name)(*map(abs, x)))
        for name in ("carlson_rf", "carlson_rd")
    },
}
"""How many numbers a function takes, and the function for balls or for mpmath."""
MP.carlson_rf, MP.carlson_rd = MP.elliprf, MP.elliprd


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_hold_the_exact_value_in_nearly_all_digits(name: str) -> None:
    rng, (count, function) = random.Random(name), FUNCTIONS[name]
    with AR:
        for _ in range(60):
            numbers = [
                Fraction(rng.uniform(0.01, 9) * 10 ** rng.choice([0, 0, 1, -3]))
                for _ in range(count)
            ]
            exact = function(MP, *(MP.mpf(x.numerator) / x.denominator for x in numbers))
            found = function(AR, *map(AR.convert, numbers))
            assert holds(found, exact), numbers
            assert found.is_known_to(30), numbers
            wide = [ball(x, x * (1 + Fraction(1, 10**9))) for x in numbers]
            assert holds(function(AR, *wide), exact), numbers


def test_a_comparison_is_true_false_or_open() -> None:
    wide, one = ball(0.5, 1.5), AR.convert(1)
    assert [one < 2, one <= 1, one == 1, wide <= 1.75] == [True] * 4
    assert [one > 2, wide == 3] == [False] * 2
    for question in (wide == one, wide < 1, wide >= one, AR.unbounded < 1, 1 / ball(-1, 1) < 1):
        assert question is OPEN
        with pytest.raises(TooFewDigitsError):
            bool(question)
    with pytest.raises(TooFewDigitsError):
        bool(ball(-1, 1))
    assert not AR.convert(0)
    assert one
    assert AR.either(wide > 1) is False
    both = AR.where(wide < 1, AR.convert(3), 7)
    assert both.x.contains(3)
    assert both.x.contains(7)
    assert AR.where(wide < 2, 3, 7) == 3


def test_a_quotient_by_0_does_not_exist_and_by_a_ball_about_0_is_open() -> None:
    none, open_ = AR.convert(1) / 0, 1 / ball(-1, 1)
    for value in (none, none + 1, 1 / none, none / 2, AR.sqrt(none), none / ball(-1, 1)):
        assert value.is_nan
    with pytest.raises(UndefinedError):
        bool(none < 1)
    for value in (open_, open_ * 0 + open_, open_ - open_, AR.sqrt(open_), AR.sqrt(-AR.convert(1))):
        assert not value.is_nan
        with pytest.raises(TooFewDigitsError):
            value.ends()


def test_the_root_of_a_ball_about_0_is_bounded_by_its_upper_end() -> None:
    root = AR.sqrt(ball(Fraction("-1e-50"), Fraction("4e-50")))
    assert root.x.contains(0)
    assert holds(root, MP.mpf("2e-25"))
    assert root <= Fraction("3e-25").__float__()


def test_a_number_is_rounded_only_if_all_numbers_in_the_ball_round_alike() -> None:
    with AR:
        assert float(AR.convert(Fraction(1, 3))) == 1 / 3
    tie = Fraction(1) + Fraction(2) ** -53
    assert float(AR.convert(Fraction(5e-324) / 2)) == 0
    assert float(AR.convert(3 * Fraction(5e-324) / 2)) == 1e-323
    with balls(20):
        assert float(Ball(arb(1) + arb(2) ** -53)) == float(tie) == 1
    with pytest.raises(TooFewDigitsError):
        float(ball(1, 1 + Fraction("1e-15")))


def test_ends_are_decimals_outside_the_ball() -> None:
    for digits in (8, 40, 6000):
        with balls(digits) as ar:
            low, high = map(Fraction, ar.convert(Fraction(-(10**50), 7)).ends())
            assert low <= Fraction(-(10**50), 7) <= high
            assert high - low < Fraction(10) ** (52 - digits)
            assert ar.convert(0.125).ends() == (Decimal("0.125"), Decimal("0.125"))


def test_a_number_beyond_the_exponents_of_decimals_is_refused() -> None:
    with AR:
        small = AR.exp(AR.convert(-(10**18)))
        assert small.ends()[0].adjusted() == -434294481903251828
        for far in (-(10**19), 10**25):
            with pytest.raises(OutOfRangeError, match="limits of --digits"):
                AR.exp(AR.convert(far)).ends()


def test_an_integer_next_to_a_ball() -> None:
    assert [AR.nint(AR.convert(x)) for x in (7.4, -7.5, 2.5, 10**38 + 1)] == [7, -8, 2, 10**38 + 1]
    assert AR.nint(ball(6.9, 7.3)) == 7
    assert AR.ceiling(AR.convert(7.4)) == 8
    assert AR.ceiling(AR.convert(7)) == 7
    for ask, open_ in ((AR.nint, ball(6, 7)), (AR.ceiling, ball(7, 7.1))):
        with pytest.raises(TooFewDigitsError):
            ask(open_)


def test_the_simplest_fraction_of_a_ball() -> None:
    assert simplest_between(Fraction("0.33"), Fraction("0.34")) == Fraction(1, 3)
    with balls(2000) as ar:
        third = ar.convert(Fraction(-22, 7)) - ar.sqrt(ar.convert(2)) + ar.sqrt(ar.convert(2))
        assert third.simplest() == Fraction(-22, 7)
        assert (third - third).simplest() == 0
        assert ar.sqrt(ar.convert(2)).simplest().denominator > 10**990
    with pytest.raises(TooFewDigitsError):
        AR.unbounded.simplest()


def test_pi_to_many_digits() -> None:
    for digits in (5, 50, 5000):
        with mpmath.workdps(digits + 20):
            exact = mpmath.mpf(pi_to(digits).numerator) / pi_to(digits).denominator
            assert abs(exact - mpmath.pi) < mpmath.mpf(10) ** -digits


def test_the_precision_of_the_host_survives_in_every_thread() -> None:
    def third(digits: int) -> str:
        with balls(digits) as ar:
            text = str(ar.convert(Fraction(1, 3)).ends())
            with Balls(10):
                pass
            assert text == str(ar.convert(Fraction(1, 3)).ends())
        return text

    before, ctx.prec = ctx.prec, 77
    try:
        serial = [third(20 + 7 * i) for i in range(40)]
        with ThreadPoolExecutor(8) as pool:
            assert list(pool.map(third, (20 + 7 * i for i in range(40)))) == serial
        assert ctx.prec == 77
    finally:
        ctx.prec = before
