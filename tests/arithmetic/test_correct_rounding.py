"""Correct rounding: ties, zeros, numbers that settle late, and digits as text."""

from __future__ import annotations

import random
from collections.abc import Callable
from decimal import Decimal, getcontext, localcontext
from fractions import Fraction

import mpmath
import pytest

from lagrange_cli.arithmetic.correct_rounding import (
    TooFewDigitsError,
    correctly_rounded,
    precisions,
    text_of,
)
from lagrange_cli.errors import LagtopError

ULP = Decimal(2) ** -52


def noisy(exact: str | Decimal | Fraction) -> Callable[[int], Decimal]:
    """Return a computation of a number whose last two digits are wrong at every precision."""
    rng = random.Random(str(exact))

    def value_in(digits: int) -> Decimal:
        with localcontext() as context:
            context.prec = digits
            number = Fraction(exact)
            value = Decimal(number.numerator) / Decimal(number.denominator)
            return value * (1 + rng.randrange(1, 90) * Decimal(10) ** -digits)

    return value_in


@pytest.mark.parametrize(
    ("value", "nearest"),
    [
        (1 + Fraction(1, 2**53), 1.0),
        (1 + Fraction(3, 2**53), 1 + 2.0**-51),
        (-1 - Fraction(1, 2**53), -1.0),
        (1 + Fraction(1, 2**53) + Fraction("1e-200"), 1 + 2.0**-52),
        (1 + Fraction(1, 2**53) - Fraction("1e-200"), 1.0),
        (Fraction(1, 3), 1 / 3),
        (Fraction(2**53 + 1), 2.0**53),
        (Fraction(5, 2) * Fraction(2) ** -1074, 2 * 5e-324),
    ],
)
def test_ties_go_to_even_and_what_is_next_to_them_does_not(value: Fraction, nearest: float) -> None:
    assert correctly_rounded("x", noisy(value), float) == nearest
    assert correctly_rounded("x", noisy(value), float, exactly=lambda: float(value)) == nearest


def test_random_numbers_are_rounded_as_python_rounds_fractions() -> None:
    rng = random.Random(53)
    for _ in range(200):
        value = Fraction(rng.randrange(1, 10**40), rng.randrange(1, 10**40))
        value *= Fraction(10) ** rng.randrange(-300, 260)
        assert correctly_rounded("x", noisy(value), float) == float(value)


def test_a_zero_that_is_not_proved_is_not_believed() -> None:
    def cancels(digits: int) -> Decimal:
        with localcontext() as context:
            context.prec = digits
            return (1 + Decimal("1e-100")) - 1

    assert correctly_rounded("x", cancels, float) == 1e-100
    assert correctly_rounded("x", lambda _: Decimal(0), float, zero_is_proved=True) == 0
    with pytest.raises(LagtopError, match="x cannot be told from 0 or a tie with 2000 digits"):
        correctly_rounded("x", lambda _: Decimal(0), float)
    assert correctly_rounded("x", lambda _: Decimal(0), float, exactly=lambda: 0.0) == 0


def test_precisions_with_too_few_digits_are_passed_over() -> None:
    asked = []

    def late(digits: int) -> Decimal:
        asked.append(digits)
        if digits < 200:
            raise TooFewDigitsError
        return Decimal("0.5")

    assert correctly_rounded("x", late, float) == 0.5
    assert asked == [digits for digits in precisions() if digits <= asked[-1]]
    assert [digits >= 200 for digits in asked][-2:] == [True, True]


def test_what_does_not_exist_is_none() -> None:
    assert correctly_rounded("x", lambda _: None, float) is None


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
        (Fraction(0), 5, "0.0"),
        (Fraction(1), 5, "1.0"),
        (Fraction(-1, 2), 5, "-0.5"),
        (Fraction(5, 2), 1, "2.0"),
        (Fraction(7, 2), 1, "4.0"),
        (Fraction(999999), 3, "1000000.0"),
        (Fraction(10) ** 16, 3, "1.0e+16"),
        (Fraction(10) ** 15, 3, "1000000000000000.0"),
        (Fraction("0.00001234"), 2, "1.2e-5"),
        (Fraction("0.0001234"), 2, "0.00012"),
        (Fraction("-1e-400"), 2, "-1.0e-400"),
    ],
)
def test_digits_of_some_numbers(value: Fraction, digits: int, text: str) -> None:
    assert text_of(value, digits) == text


def test_the_context_of_the_host_is_left_alone() -> None:
    before = getcontext().copy()
    correctly_rounded("x", noisy(Fraction(1, 3)), float)
    text_of(Fraction(1, 3), 30)
    assert str(getcontext()) == str(before)
    with localcontext() as context:
        context.prec = 2
        assert text_of(Fraction(1, 3), 20) == "0." + "3" * 20
        assert text_of(Decimal("0.123456789"), 6) == "0.123457"
