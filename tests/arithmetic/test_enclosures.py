"""Proved rounding (ties, zeros, radii, digits as text), and the precision of Arb."""

from __future__ import annotations

import ast
import math
import os
import random
import re
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from decimal import Decimal, localcontext
from fractions import Fraction

import flint
import mpmath
import pytest
from conftest import ROOT
from flint import arb
from lagtop import Top, solve

from lagrange_cli.arithmetic.enclosures import (
    Rounded,
    TooFewDigitsError,
    at_precision,
    decided,
    ends_of,
    exact,
    kept,
    nearest,
    root,
    settled,
    sign,
    sign_to,
    simplest_between,
    text_of,
)
from lagrange_cli.errors import LagtopError, OutOfRangeError


def between(low: float | Fraction, high: float | Fraction) -> arb:
    """Return a ball that holds two numbers, and little more."""
    return exact(low).union(exact(high))


def noisy(value: str | Decimal | Fraction | float) -> Callable[[int], arb]:
    """Return balls of a number whose middles are off by most of their radius."""
    rng = random.Random(str(value))

    def ball(digits: int) -> arb:
        found = exact(Fraction(value))
        off = found * exact(rng.uniform(-80, 80)) * arb(10) ** (3 - digits)
        return (found - off).union(found + 3 * off)

    return ball


def hidden(digits: int) -> arb:
    """Return a ball around 0 that never proves it."""
    size = arb(10) ** (1 - digits)
    return (-size).union(2 * size)


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
    found = settled("x", noisy(value), None, 1400)
    assert found is not None
    assert (found.value, found.exact) == (nearest, value)


def test_a_ball_that_stays_wide_holds_no_tie() -> None:
    wide = between(1, 1 + 2.0**-52)
    with pytest.raises(LagtopError, match="x cannot be distinguished from 0 or a tie with 300 dig"):
        settled("x", lambda _: wide, None, 300)


@pytest.mark.parametrize("side", [1, -1])
def test_next_to_a_tie_digits_decide(side: int) -> None:
    value = 1 + Fraction(1, 2**53) + side * Fraction("1e-200")
    assert value_of(settled("x", noisy(value), None, 1200)) == (1 + 2.0**-52 if side > 0 else 1.0)


def test_zero_is_returned_only_to_most_digits() -> None:
    def cancels(_: int) -> arb:
        return (exact(1) + exact(Fraction("1e-100"))) - 1

    assert value_of(settled("x", cancels, None, 1200)) == 1e-100
    assert value_of(settled("x", lambda _: exact(0), None, 1200)) == 0
    assert value_of(settled("x", hidden, None, 300)) == 0
    assert settled("x", lambda _: None, None, 300) is None
    assert sign_to(cancels, 1200) == 1
    assert [sign_to(noisy(x), 100) for x in (-1e-300, 3)] == [-1, 1]
    assert sign_to(hidden, 1200) == 0


def test_questions_ask_for_more_digits_only_if_they_are_open() -> None:
    for question in (sign, nearest):
        with pytest.raises(TooFewDigitsError):
            question(between(-1, 1))
    assert [sign(exact(x)) for x in (-2, 0, Fraction(1, 3))] == [-1, 0, 1]
    assert [nearest(exact(x)) for x in (-0.75, 7, Fraction("2.4"))] == [-1, 7, 2]
    assert root(between(Fraction("-1e-50"), Fraction("4e-50"))) < Fraction("3e-25").__float__()
    assert root(exact(4)) == 2


def test_precisions_with_too_few_digits_are_passed_over() -> None:
    asked = []

    def late(digits: int) -> arb:
        asked.append(digits)
        if digits < 200:
            raise TooFewDigitsError
        return exact(0.5)

    found = settled("x", lambda digits: arb(0.5, 2.0 ** -(60 * digits // 38)), None, 1200)
    assert found is not None
    assert isinstance(found.exact, arb)
    assert found.bits == 85 <= found.exact.rel_accuracy_bits()
    assert value_of(settled("x", late, None, 1200)) == 0.5
    assert asked == sorted(asked)
    assert [digits >= 200 for digits in asked][-2:] == [False, True]
    assert decided(lambda digits: digits, 1200, digits=90, lost=16) == 128
    with pytest.raises(LagtopError, match=r"^a sign cannot be .* with 300 digits"):
        sign_to(lambda _: between(-1, 1), 300)


def test_a_wide_enclosure_is_not_out_of_range() -> None:
    """The lower end may be smaller than all doubles, and the number is not."""

    def ball(digits: int) -> arb:
        return between(0, 0.7) if digits < 40 else exact(0.5)

    assert value_of(settled("x", ball, None, 1200)) == 0.5


@pytest.mark.parametrize("value", ["0.1", "1e300", "-1e-300", "0.3333333333333333333333"])
@pytest.mark.parametrize("digits", [None, 1, 12])
def test_the_exact_value_is_within_the_radius(value: str, digits: int | None) -> None:
    found = settled("x", noisy(value), digits, 1200)
    assert found is not None
    away, size = abs(Fraction(value) - Fraction(found.value)), abs(Fraction(value))
    assert away <= Fraction(float(found.radius)) <= size * Fraction(10) ** -((digits or 16) - 1)
    assert Rounded(0.5, Fraction(1, 2)).radius == "0.0"


def test_a_radius_does_not_rest_on_the_middle_of_a_wide_ball() -> None:
    """The first ball, 1 within 2^-62, is enough for the double but not for the radius."""
    value = 1 + Fraction(1, 2**60)

    def ball(digits: int) -> arb:
        off = Fraction(1, 2 ** (24 + digits))
        return between(value - 2 * off, value)

    found = settled("x", ball, None, 1200)
    assert found is not None
    assert found.value == 1
    assert Fraction(1, 2**60) <= Fraction(float(found.radius)) < Fraction(11, 10 * 2**60)


def test_digits_are_those_of_mpmath() -> None:
    """Numbers of any size, whose digits and exponents look like those of mpmath.nstr."""
    rng = random.Random(17)
    with mpmath.workdps(120):
        for _ in range(400):
            digits, size = rng.choice([1, 2, 5, 17, 40]), rng.choice([-300, -20, -5, 0, 5, 20, 300])
            fraction = Fraction(rng.randrange(-(10**60), 10**60), 10**60) * Fraction(10) ** size
            number = mpmath.mpf(fraction.numerator) / fraction.denominator
            shown = mpmath.nstr(number, digits, min_fixed=-5, max_fixed=16)
            assert text_of(fraction, digits) == shown
            with localcontext() as context:
                context.prec = 100
                decimal = Decimal(fraction.numerator) / Decimal(fraction.denominator)
            assert text_of(decimal, digits) == shown


def test_ends_are_decimals_outside_the_ball() -> None:
    for digits in (8, 40, 6000):
        ball = at_precision(digits, lambda: exact(Fraction(-(10**50), 7)))
        low, high = map(Fraction, ends_of(ball))
        assert low <= Fraction(-(10**50), 7) <= high
        assert high - low < Fraction(10) ** (52 - digits)
    assert ends_of(exact(0.125)) == (Decimal("0.125"), Decimal("0.125"))
    with pytest.raises(OutOfRangeError, match="990000000000000000"):
        ends_of(exact(2) ** (2**62))


def test_the_simplest_fraction_has_the_smallest_denominator() -> None:
    rng = random.Random(5)
    for _ in range(300):
        low = Fraction(rng.randrange(-500, 500), rng.randrange(1, 90))
        high = low + Fraction(rng.randrange(1, 9), rng.randrange(1, 500))
        first = next(q for q in range(1, 10**4) if math.ceil(low * q) <= high * q)
        found = simplest_between(low, high)
        assert low <= found <= high
        assert found.denominator == first


def fails(error: type[BaseException]) -> None:
    raise error


@pytest.mark.parametrize("error", [KeyboardInterrupt, ZeroDivisionError, TooFewDigitsError])
def test_the_precision_of_the_host_is_restored(error: type[BaseException]) -> None:
    with flint.ctx.workprec(77):
        inner: list[int] = []

        def nested() -> int:
            at_precision(100, lambda: inner.append(flint.ctx.prec))
            return flint.ctx.prec

        assert at_precision(20, nested) < inner[0]
        assert flint.ctx.prec == 77
        with pytest.raises(error):
            at_precision(20, lambda: at_precision(30, lambda: fails(error)))
        assert flint.ctx.prec == 77


def test_a_disturbed_result_is_not_kept() -> None:
    asked: list[int] = []

    def disturbed(digits: int) -> arb:
        asked.append(digits)
        if len(asked) == 1:
            flint.ctx.prec = 53
        return arb(2).sqrt()

    with flint.ctx.workprec(77):
        known = kept(disturbed)
        accuracies = [at_precision(100, lambda: known(100)).rel_accuracy_bits() for _ in range(2)]
    assert min(accuracies) > 300
    assert asked == [100, 100]


@pytest.mark.parametrize("is_open", [False, True])
def test_a_disturbed_computation_is_repeated_and_the_wish_of_the_host_kept(is_open: bool) -> None:
    with flint.ctx.workprec(77):
        seen: list[int] = []

        def disturbed() -> arb:
            seen.append(flint.ctx.prec)
            if len(seen) == 1:
                flint.ctx.prec = 60
                if is_open:  # only because of the disturbance
                    raise TooFewDigitsError
            return arb(2).sqrt()

        def wished() -> None:
            flint.ctx.prec = 61
            fails(ZeroDivisionError)

        found = at_precision(50, disturbed)
        assert len(seen) == 2
        assert len(set(seen)) == 1
        assert found.rel_accuracy_bits() > 160
        assert flint.ctx.prec == 60
        with pytest.raises(ZeroDivisionError):
            at_precision(50, wished)
        assert flint.ctx.prec == 61


@pytest.mark.parametrize("taken_back", [False, True])
def test_no_decision_rests_on_a_disturbed_computation(taken_back: bool) -> None:
    """The host lowers the precision in two of three computations; 1 + 1e-400 - 1 is not 0."""
    calls: list[int] = []

    def disturbed(compute: Callable[[], arb]) -> arb:
        calls.append(1)
        before = flint.ctx.prec
        flint.ctx.prec = 70 if len(calls) % 3 else before
        found = compute()
        flint.ctx.prec = before if taken_back else flint.ctx.prec
        return found

    def root_of_2(_: int) -> arb:
        return arb(2).sqrt()

    alone = settled("x", root_of_2, None, 1200)
    with flint.ctx.workprec(53):
        assert sign_to(lambda _: disturbed(lambda: 1 + exact(Fraction(1, 10**400)) - 1), 1200) == 1
        beside = settled("x", lambda _: disturbed(lambda: root_of_2(0)), None, 1200)
    assert alone
    assert beside
    assert (beside.value, beside.radius) == (alone.value, alone.radius)


@pytest.mark.filterwarnings("ignore:.*fork")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
def test_a_child_process_has_the_precision_of_the_host() -> None:
    started, done = threading.Event(), threading.Event()

    def slow() -> None:
        started.set()
        done.wait(0.05)

    with ThreadPoolExecutor(1) as pool, flint.ctx.workprec(77):
        running = pool.submit(at_precision, 500, slow)
        started.wait()
        child = os.fork()
        if not child:
            os._exit(0 if flint.ctx.prec == 77 and at_precision(9, lambda: 5) == 5 else 1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        done.set()
        running.result()
        assert flint.ctx.prec == 77


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="the system has no such timer")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # by Hypothesis' gc
def test_an_exception_of_a_signal_handler_leaves_the_precision_as_it_was() -> None:
    """3,000 at random moments: the lock is free, and the precision is that of the host."""

    def interrupt(*_: object) -> None:
        raise TimeoutError

    def solved() -> object:
        return solve(Top(r0=40.25)).T_nutation

    rng, alone, before = random.Random(3), solved(), signal.signal(signal.SIGALRM, interrupt)
    interrupted = 0
    try:
        with ThreadPoolExecutor(1) as pool, flint.ctx.workprec(77):
            while interrupted < 3000:
                try:
                    signal.setitimer(signal.ITIMER_REAL, rng.uniform(1e-6, 1e-3))
                    solved()
                    signal.setitimer(signal.ITIMER_REAL, 0)
                except TimeoutError:
                    interrupted += 1
                assert flint.ctx.prec == 77
                if interrupted % 100 == 1:
                    assert pool.submit(solved).result(timeout=10) == alone
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


WITH_BALLS = ["solver/facts", "solver/numbers", "solver/attitude"]
WITH_BALLS += [f"elliptic/{name}" for name in ("functions", "function_table", "legendre", "eta")]
ORDER = ast.Lt | ast.LtE | ast.Gt | ast.GtE | ast.Eq | ast.NotEq
EXACT = re.compile(
    r"(self\.|_)?sign\(.*\)|len\(.*\)|float\(.*\)|facts\.inputs\[.*\]|word|name|'.*'|n % 2( == 0)?"
    r"|(.*\.)?(turning|spin|over|minus|plus|pole|fall|falls|inside|past|within)"
    r"|(.*\.)?(real|imag|upper|lower|g|square|n)|q \* square"
)
"""Signs, counts, words and exact inputs: they may be compared, also with 0."""


@pytest.mark.parametrize("name", WITH_BALLS)
def test_no_code_acts_on_an_undecided_comparison_of_balls(name: str) -> None:
    tree = ast.parse((ROOT / "lagrange_cli" / f"{name}.py").read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare) and any(isinstance(x, ORDER) for x in node.ops):
            sides = [ast.unparse(x) for x in (node.left, *node.comparators)]
            assert any(map(EXACT.fullmatch, sides)), f"line {node.lineno}: ask sign()"
