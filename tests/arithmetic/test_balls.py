"""Balls against Arb: every result holds the exact value, and no radius is idle."""

from __future__ import annotations

import random
from collections.abc import Callable
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any

import pytest
from arb_balls import arb_of, exact_arb, holds
from balls.scene import arb_bits
from flint import arb

from lagrange_cli.arithmetic.ball import OPEN, Ball, TooFewDigitsError, UndefinedError
from lagrange_cli.arithmetic.balls import Balls, balls

AR = balls(40)


def random_ball(rng: random.Random, ar: Balls = AR) -> Ball:
    """Return a ball of any size, a fifth of them exact."""
    middle = ar.convert(rng.uniform(-1, 1) * 10.0 ** rng.choice([0, 0, 1, -3, -20, 5])).middle
    share = rng.choice([0, 1e-5, 1e-30, 1e-39, 1e-41, 1])
    return ar.exact(middle).enlarged((ar.exact(middle) * share).greatest)


def point_in(rng: random.Random, ball: Ball) -> arb:
    """Return a number in a ball, often at one of its ends."""
    return exact_arb(ball.middle) + exact_arb(ball.radius) * arb(
        rng.choice([-1, 1, rng.uniform(-1, 1)])
    )


OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "sum": lambda x, y: x + y,
    "difference": lambda x, y: x - y,
    "product": lambda x, y: x * y,
    "quotient": lambda x, y: x / y,
    "with an integer": lambda x, y: 3 - (7 * x + 2) / 5,
}
FUNCTIONS = "sqrt sin cos exp sinh cosh asinh log log1p expm1 tanh sech atanh".split()
DOMAINS: dict[str, Callable[[arb], bool]] = {
    "sqrt": lambda x: x >= 0,
    "log": lambda x: x > 0,
    "log1p": lambda x: x > -1,
    "atanh": lambda x: abs(x) < 1,
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_operations_hold_the_exact_result(name: str) -> None:
    rng, operation = random.Random(name), OPERATIONS[name]
    with arb_bits(600):
        for _ in range(3000):
            x, y = random_ball(rng), random_ball(rng)
            found, exact = operation(x, y), operation(point_in(rng, x), point_in(rng, y))
            assert not exact.is_finite() or holds(found, exact) or name == "quotient"
            if found.radius.is_finite():
                assert holds(found, exact), (x, y)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_hold_the_exact_value(name: str) -> None:
    rng, tried = random.Random(name), 0
    with arb_bits(600):
        for _ in range(2000):
            x = random_ball(rng)
            at = point_in(rng, x)
            if name in DOMAINS and not DOMAINS[name](at):
                continue
            exact = getattr(at, name)()
            found = getattr(AR, name)(x)
            tried += found.radius.is_finite()
            assert not found.radius.is_finite() or holds(found, exact), x
    assert tried > 500


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_of_exact_numbers_have_nearly_all_digits(name: str) -> None:
    """An enclosure that says nothing would hold everything."""
    rng = random.Random(name)
    for digits in (20, 40, 300):
        ar = balls(digits)
        for _ in range(50):
            x = ar.convert(Fraction(rng.randrange(10, 90), 100))
            value = getattr(ar, name)(x)
            assert value.radius <= Decimal(100) * value.greatest * Decimal(10) ** -digits, (name, x)


def test_angles_hold_the_exact_value() -> None:
    rng, bounded = random.Random(2), 0
    with arb_bits(600):
        for _ in range(3000):
            x, y = random_ball(rng), random_ball(rng)
            exact, found = arb.atan2(point_in(rng, y), point_in(rng, x)), AR.atan2(y, x)
            assert holds(found, exact), (y, x)
            bounded += found.radius < 1
    assert bounded > 1500


def test_angles_on_the_cut_are_open() -> None:
    one, about_0 = AR.exact(1), AR.exact(0).enlarged(Decimal("1e-30"))
    assert AR.atan2(about_0, one).radius < Decimal("1e-29")
    assert AR.atan2(about_0, -one).radius > 3
    assert AR.atan2(about_0, about_0).radius > 3
    assert AR.atan2(AR.exact(0), -one).middle == AR.pi.middle
    assert AR.atan2(AR.exact(0), one).middle == 0


def test_large_arguments_are_reduced() -> None:
    with arb_bits(2000):
        for text in ("1e20", "-7e35", "3.25e300"):
            x = AR.convert(Fraction(text))
            assert holds(AR.sin(x), exact_arb(text).sin())
            assert holds(AR.cos(x), exact_arb(text).cos())
            wide = balls(400).convert(Fraction(text))
            assert holds(balls(400).sin(wide), exact_arb(text).sin())
            assert balls(400).sin(wide).radius < Decimal("1e-90")


def test_a_sine_of_too_large_an_argument_is_at_most_1() -> None:
    """Turns of 1e60 are not known in 40 digits; the series of what is left had no end."""
    rng = random.Random(60)
    for _ in range(60):
        x = AR.exact(Decimal(rng.uniform(1, 10)) * Decimal(10) ** rng.choice([39, 40, 41, 60, 300]))
        for value in (AR.sin(x), AR.cos(-x)):
            assert value.greatest <= 2
            with arb_bits(2000):
                assert holds(AR.sin(x), exact_arb(x.middle).sin())


@pytest.mark.parametrize("name", ["atanh", "log1p"])
def test_next_to_minus_1_no_digits_are_lost(name: str) -> None:
    for digits in range(1, 40):
        x = AR.exact(Decimal(f"-0.{'9' * digits}"))
        value = getattr(AR, name)(x)
        assert value.radius <= Decimal("1e-37") * value.greatest
        with arb_bits(400):
            assert holds(value, getattr(exact_arb(x.middle), name)())


def test_an_exact_number_stays_exact() -> None:
    third, half = AR.convert(Fraction(1, 3)), AR.convert(Fraction(1, 2))
    assert third.radius > 0
    for ball, value in (
        (half + half, 1),
        (half * 3 - 1, 0.5),
        (half / 4, 0.125),
        (AR.sqrt(AR.exact(9) / 16), 0.75),
        (0 * third, 0),
        (third * 0, 0),
        (AR.exact(0) * third, 0),
    ):
        assert ball.middle == Decimal(value)
        assert ball.radius == 0
    assert not (half + half - 1)
    with pytest.raises(TooFewDigitsError):
        bool(third * 3 - 1)


def test_a_rounding_is_in_the_radius() -> None:
    """Exact numbers whose sum has more digits than there are."""
    total = AR.exact(1) + AR.exact(Decimal("1e-60"))
    assert Fraction(total.middle) + Fraction(total.radius) >= 1 + Fraction("1e-60")


def test_a_comparison_is_true_false_or_open() -> None:
    wide, one = AR.exact(1).enlarged(Decimal("0.5")), AR.exact(1)
    assert (one < 2) is True
    assert (one > 2) is False
    assert (one <= 1) is True
    assert (one == 1) is True
    assert (wide == 3) is False
    assert (wide == one) is OPEN
    assert (wide < 1) is OPEN
    assert (wide >= one) is OPEN
    assert (wide < 1.5) is OPEN
    assert (wide <= 1.5) is True
    assert (AR.unbounded < 1) is OPEN
    with pytest.raises(TooFewDigitsError):
        bool(wide > 1)
    with pytest.raises(TooFewDigitsError):
        bool(AR.exact(0).enlarged(Decimal(1)))
    assert not AR.exact(0)
    assert one
    assert AR.either(wide > 1) is False


def test_comparisons_are_those_of_all_points() -> None:
    rng = random.Random(8)
    with arb_bits(600):
        for _ in range(3000):
            x, y = random_ball(rng), random_ball(rng)
            ends = [exact_arb(b.middle) + i * exact_arb(b.radius) for b in (x, y) for i in (-1, 1)]
            assert ((x < y) is True) == (ends[1] < ends[2]) or x.radius or y.radius
            if (x < y) is True:
                assert ends[1] < ends[2]
            if (x < y) is False:
                assert ends[0] >= ends[3]


def test_an_open_choice_is_a_ball_about_both() -> None:
    wide = AR.exact(1).enlarged(Decimal("0.5"))
    both = arb_of(AR.where(wide < 1, AR.exact(3), 7))
    assert both.contains(arb(3))
    assert both.contains(arb(7))
    assert AR.where(wide < 2, 3, 7).radius == 0
    assert AR.where(wide < 1, AR.unbounded, 7).radius == AR.unbounded.radius


def test_what_has_no_bounds_raises_only_the_request_for_more_digits() -> None:
    about_0 = AR.exact(0).enlarged(Decimal(1))
    quotient = 1 / about_0
    for ball in (
        quotient,
        quotient * 0 + quotient,
        quotient * about_0,
        AR.exact(0) * quotient,
        quotient - quotient,
        AR.sqrt(quotient),
        AR.sqrt(-AR.exact(1)),
        AR.exp(quotient),
        AR.exp(AR.exact(Decimal("1e19"))),
        AR.log(about_0),
        AR.where(OPEN, quotient, 1),
    ):
        assert not ball.radius.is_finite()
        with pytest.raises(TooFewDigitsError):
            ball.ends()
        assert (ball < 1) is OPEN
    assert AR.sin(quotient).radius == 1


@pytest.mark.parametrize("x", ["1e19", "3e18", "1e300"])
def test_exponentials_below_all_exponents_are_tiny(x: str) -> None:
    """Decimals end at 1e-999999999999999999, and exp(-1e19) is 1e-4342944819032518276."""
    far, tiny = AR.exact(Decimal(x)), Decimal("1e-300000000000000000")
    low, high = AR.exp(-far).middle - AR.exp(-far).radius, AR.exp(-far).greatest
    assert 0 <= low < high <= tiny
    for value, limit in (
        (AR.sech(far), 0),
        (AR.sech(-far), 0),
        (AR.tanh(far), 1),
        (AR.tanh(-far), -1),
        (AR.expm1(-far), -1),
    ):
        assert abs(value - limit).greatest <= (Decimal("1e-38") if limit else tiny)
        assert (value == limit) is not False
    assert (AR.sech(far) * AR.sech(far)).greatest <= tiny


def test_a_quotient_by_an_exact_0_does_not_exist() -> None:
    none = AR.exact(1) / 0
    assert none.is_nan
    for ball in (none + 1, none * 2, 1 / none, none / 2, AR.sqrt(none), -none):
        assert ball.is_nan
    with pytest.raises(UndefinedError):
        bool(none < 1)
    with pytest.raises(TooFewDigitsError):
        none.ends()


def test_the_root_of_a_ball_about_0_is_bounded_by_its_upper_end() -> None:
    root = AR.sqrt(AR.exact(Decimal("1e-50")).enlarged(Decimal("3e-50")))
    with arb_bits(200):
        assert arb_of(root).contains(exact_arb("4e-50").sqrt())
        assert arb_of(root).contains(0)
        assert root.greatest < Decimal("2.001e-25")


@pytest.mark.parametrize("digits", [8, 40])
def test_ends_are_outside_the_ball(digits: int) -> None:
    ar = balls(digits)
    for ball in (
        ar.convert(Fraction(1, 3)),
        ar.convert(Fraction(-(10**50), 7)),
        ar.exact(0).enlarged(Decimal("1e-30")),
    ):
        low, high = map(Fraction, ball.ends())
        middle, radius = Fraction(ball.middle), Fraction(ball.radius)
        assert low <= middle - radius
        assert middle + radius <= high
        assert high - low <= 4 * radius
    eighth = ar.exact(Decimal("0.125"))
    assert eighth.ends() == (Decimal("0.125"), Decimal("0.125"))


def test_an_integer_next_to_a_ball() -> None:
    assert AR.nint(AR.convert(7.4)) == 7
    assert AR.nint(AR.convert(-7.6).enlarged(Decimal("0.1"))) == -8
    assert AR.nint(AR.exact(10**38 + 1)) == 10**38 + 1
    for ball in (AR.exact(1).enlarged(Decimal("0.3")), AR.unbounded):
        with pytest.raises(TooFewDigitsError):
            AR.nint(ball)
    assert AR.ceiling(AR.convert(7.4)) == 8
    assert AR.ceiling(AR.exact(7)) == 7
    with pytest.raises(TooFewDigitsError):
        AR.ceiling(AR.exact(7).enlarged(Decimal("1e-9")))


def test_a_double_is_told_only_if_it_is_the_only_one() -> None:
    assert float(AR.convert(Fraction(1, 3))) == 1 / 3
    with pytest.raises(TooFewDigitsError):
        float(AR.exact(1).enlarged(Decimal("1e-15")))


def test_a_bound_widens_and_one_that_diverges_says_nothing() -> None:
    one = AR.exact(1)
    small = AR.exact(Decimal("-0.25"))
    widened = AR.widened(one, lambda: (small,), lambda x: x / (1 - 2 * x))
    assert widened.radius == Decimal("0.5")
    assert not AR.widened(one, lambda: (3 * small,), lambda x: x / (1 - 2 * x)).radius.is_finite()


def test_balls_do_not_depend_on_the_decimal_context_of_the_host() -> None:
    def numbers(ar: Balls) -> list[str]:
        x = ar.convert(0.7)
        values = [getattr(ar, name)(x / 3) for name in FUNCTIONS]
        return [str(y) for y in (*values, x * x - x / 7, ar.atan2(x, -x), ar.pi)]

    usual = numbers(Balls(30))
    with localcontext() as context:
        context.prec, context.traps = 1, dict.fromkeys(context.traps, True)
        assert numbers(Balls(30)) == usual
