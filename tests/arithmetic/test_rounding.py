"""Proved rounding: ties, zeros, numbers that settle late, radii, and digits as text."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from decimal import Decimal, getcontext, localcontext
from fractions import Fraction

import mpmath
import pytest

from lagrange_cli.arithmetic.ball import Ball, TooFewDigitsError, balls
from lagrange_cli.arithmetic.rounding import (
    Rounded,
    decided,
    nearest_double,
    precisions,
    rounded,
    settled,
    sign_of,
    text_of,
)
from lagrange_cli.errors import LagtopError, OutOfRangeError


def noisy(exact: str | Decimal | Fraction | float) -> Callable[[int], Ball]:
    """Return balls of a number whose middles are off by most of their radius."""
    rng = random.Random(str(exact))

    def enclosure(digits: int) -> Ball:
        ar = balls(digits)
        ball = ar.convert(Fraction(exact))
        off = ball * rng.uniform(-80, 80) * (100 * ar.eps)
        return ar.between(ball - off, ball + 3 * off)

    return enclosure


def hidden(digits: int) -> Ball:
    """Return a ball around 0 that never proves it."""
    ar = balls(digits)
    return ar.between(-ar.eps, 2 * ar.eps)


def value_of(found: Rounded | None) -> float:
    assert found is not None
    value: float = found.value
    return value


TIES = [
    (1 + Fraction(1, 2**53), 1.0),
    (1 + Fraction(3, 2**53), 1 + 2.0**-51),
    (-1 - Fraction(1, 2**53), -1.0),
    (Fraction(2**53 + 1), 2.0**53),
    (Fraction(5, 2) * Fraction(2) ** -1074, 2 * 5e-324),
]


@pytest.mark.parametrize(("value", "nearest"), TIES)
def test_what_most_digits_leave_open_is_the_simplest_fraction(
    value: Fraction, nearest: float
) -> None:
    found = settled("x", noisy(value), float, most=1400)
    assert found is not None
    assert (found.value, found.exact) == (nearest, value)


def test_a_ball_that_stays_wide_holds_no_tie() -> None:
    ar = balls(20)
    wide = ar.between(ar.convert(1), ar.convert(1 + 2.0**-52))
    with pytest.raises(LagtopError, match="x cannot be distinguished from 0 or a tie with 300 dig"):
        settled("x", lambda _: wide, float, most=300)


@pytest.mark.parametrize("sign", [1, -1])
def test_next_to_a_tie_digits_decide(sign: int) -> None:
    value = 1 + Fraction(1, 2**53) + sign * Fraction("1e-200")
    assert value_of(settled("x", noisy(value), float)) == (1 + 2.0**-52 if sign > 0 else 1.0)


def test_zero_is_returned_only_to_most_digits() -> None:
    def cancels(digits: int) -> Ball:
        one = balls(digits).convert(1)
        return (one + balls(digits).convert(Fraction("1e-100"))) - one

    assert value_of(settled("x", cancels, nearest_double("x"))) == 1e-100
    assert value_of(settled("x", lambda digits: balls(digits).convert(0), float)) == 0
    assert value_of(settled("x", hidden, float, most=300)) == 0
    assert settled("x", lambda _: None, float) is None
    assert sign_of(cancels, 1200) == 1
    assert [sign_of(noisy(x), 100) for x in (-1e-300, 3)] == [-1, 1]
    assert sign_of(hidden, 1200) == sign_of(lambda _: None, 1200) == 0


def test_a_derivative_may_be_0_by_its_size() -> None:
    """An enclosure of all that round to 0 is enough, and NaN says that there is none."""
    assert rounded("x", hidden) == 0
    assert rounded("x", noisy("0.1")) == 0.1
    assert rounded("x", lambda digits: balls(digits).nan) != 0


def test_precisions_with_too_few_digits_are_passed_over() -> None:
    asked = []

    def late(digits: int) -> Ball:
        asked.append(digits)
        if digits < 200:
            raise TooFewDigitsError
        return balls(digits).convert(0.5)

    assert value_of(settled("x", late, float)) == 0.5
    assert asked == [digits for digits in precisions() if digits <= asked[-1]]
    assert [digits >= 200 for digits in asked][-2:] == [False, True]
    assert decided("x", lambda digits: digits, 90, 16) == 116


@pytest.mark.parametrize(("value", "word"), [("1e309", "within"), ("-1e-330", "at least 5e-324")])
def test_a_number_beyond_the_doubles_is_an_error(value: str, word: str) -> None:
    with pytest.raises(OutOfRangeError, match=f"^x must be .*{word}"):
        settled("x", noisy(value), nearest_double("x"))


@pytest.mark.parametrize(
    ("value", "shown"), [(10**309, "1.000e+309"), (Fraction(-1, 3 * 10**329), "-3.333e-330")]
)
def test_a_fraction_beyond_the_doubles_is_named(value: Fraction, shown: str) -> None:
    with pytest.raises(OutOfRangeError, match=rf"got {re.escape(shown)}: "):
        nearest_double("x")(Fraction(value))


def test_a_wide_enclosure_is_not_out_of_range() -> None:
    """The lower end may be smaller than all doubles, and the number is not."""

    def enclosure(digits: int) -> Ball:
        ar = balls(digits)
        return ar.between(ar.convert(0), ar.convert(0.7)) if digits < 40 else ar.convert(0.5)

    assert value_of(settled("x", enclosure, nearest_double("x"))) == 0.5


@pytest.mark.parametrize("value", ["0.1", "1e300", "-1e-300", "0.3333333333333333333333"])
@pytest.mark.parametrize("digits", [None, 1, 12])
def test_the_exact_value_is_within_the_radius(value: str, digits: int | None) -> None:
    rounding = nearest_double("x") if digits is None else lambda x: text_of(x, digits)
    found = settled("x", noisy(value), rounding, digits=digits or 0)
    assert found is not None
    away, size = abs(Fraction(value) - Fraction(found.value)), abs(Fraction(value))
    assert away <= Fraction(float(found.radius)) <= size * Fraction(10) ** -((digits or 16) - 1)
    assert Rounded(0.5, Fraction(1, 2)).radius == "0.0"


def test_digits_are_those_of_mpmath() -> None:
    """Numbers of any size, whose digits and exponents look like those of mpmath.nstr."""
    rng = random.Random(17)
    with mpmath.workdps(120):
        for _ in range(400):
            digits, size = rng.choice([1, 2, 5, 17, 40]), rng.choice([-300, -20, -5, 0, 5, 20, 300])
            fraction = Fraction(rng.randrange(-(10**60), 10**60), 10**60) * Fraction(10) ** size
            exact = mpmath.mpf(fraction.numerator) / fraction.denominator
            shown = mpmath.nstr(exact, digits, min_fixed=-5, max_fixed=16)
            assert text_of(fraction, digits) == shown
            with localcontext() as context:
                context.prec = 100
                decimal = Decimal(fraction.numerator) / Decimal(fraction.denominator)
            assert text_of(decimal, digits) == shown


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        *(("0", 5, "0.0"), ("1", 5, "1.0"), ("-1/2", 5, "-0.5"), ("5/2", 1, "2.0")),
        *(("7/2", 1, "4.0"), ("999999", 3, "1000000.0"), ("1e16", 3, "1.0e+16")),
        *(("1e15", 3, "1000000000000000.0"), ("0.00001234", 2, "1.2e-5")),
        *(("0.0001234", 2, "0.00012"), ("-1e-400", 2, "-1.0e-400")),
    ],
)
def test_digits_of_some_numbers(value: str, digits: int, text: str) -> None:
    assert text_of(Fraction(value), digits) == text


def test_the_context_of_the_host_is_left_alone() -> None:
    before = getcontext().copy()
    settled("x", noisy(Fraction(1, 3)), float)
    text_of(Fraction(1, 3), 30)
    assert str(getcontext()) == str(before)
    with localcontext() as context:
        context.prec = 2
        assert text_of(Fraction(1, 3), 20) == "0." + "3" * 20
        assert text_of(Decimal("0.123456789"), 6) == "0.123457"
