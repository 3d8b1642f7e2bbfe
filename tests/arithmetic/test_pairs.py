"""Pairs of doubles and whole periods, checked by fractions, and the order of a parity."""

from __future__ import annotations

import math
import operator
import random
from fractions import Fraction

import numpy as np
import pytest

from lagrange_cli.arithmetic.arrays import order_by_parity, placed, taken
from lagrange_cli.arithmetic.pairs import (
    DoubleDouble,
    Pair,
    Period,
    fraction_of_product,
    pair,
    period_of,
    triple,
    whole_periods,
)
from lagrange_cli.arithmetic.types import Array


def exact(x: DoubleDouble | float) -> list[Fraction]:
    """Return the exact values of ten numbers."""
    if isinstance(x, DoubleDouble):
        return [Fraction(a) + Fraction(b) for a, b in zip(x.high, x.low, strict=True)]
    return [Fraction(x)] * 10


def test_pairs_of_doubles_compute_in_30_digits() -> None:
    rng = np.random.default_rng(30)
    x, y = (
        DoubleDouble(rng.choice([-1, 1], 10) * rng.uniform(1, 2, 10), rng.normal(size=10) / 2**55)
        for _ in range(2)
    )
    for compute in (operator.add, operator.sub, operator.mul, operator.truediv):
        for one, other in ((x, y), (x, 0.3), (0.3, y)):
            pairs = zip(exact(one), exact(other), exact(compute(one, other)), strict=True)
            assert all(abs(compute(a, b) - found) < Fraction(1, 2**100) for a, b, found in pairs)
    roots = zip(exact(abs(x)), exact(abs(x).sqrt()), strict=True)
    assert all(abs(a - root * root) < Fraction(1, 2**100) for a, root in roots)
    beside = DoubleDouble(x.high, np.where(rng.random(10) < 0.4, x.low, -x.low))
    for compare in (operator.lt, operator.le, operator.gt, operator.ge):
        for other in (y, beside):
            assert [*compare(x, other)] == [*map(compare, exact(x), exact(other))]


def random_period(rng: random.Random) -> tuple[Fraction, Period]:
    """Return a length with more digits than two doubles have, and the period."""
    exact = Fraction(rng.getrandbits(200) + 1, 2 ** rng.randrange(100, 300))
    return exact, period_of(pair(exact), float(1 / exact))


def times_at(rng: random.Random, exact: Fraction, power: float) -> list[float]:
    """Return times up to 2^power periods away: any, next to whole periods and next to halves."""
    found = []
    for _ in range(20):
        n = int(2 ** rng.uniform(0, power))
        for part in (Fraction(rng.random()), Fraction(0), Fraction(1, 2)):
            t = rng.choice([-1, 1]) * float((n + part) * exact)
            found += [t, math.nextafter(t, math.inf)]
    return found


def counted(t: Array, period: Period, offset: float | None = None) -> tuple[Array, ...]:
    farthest = float(np.abs(t).max())
    return whole_periods(t, period, farthest, np.empty((3, t.size)), offset)


@pytest.mark.parametrize("power", [3, 20, 25.9, 40, 51])
@pytest.mark.parametrize("offset", [None, -0.5, 0.31])
def test_whole_periods_are_taken_off_exactly(power: float, offset: float | None) -> None:
    """What is left has an error of 2^-100 of the time, and of 2^-52 of itself; n is the nearest."""
    rng = random.Random(f"{power} {offset}")
    for _ in range(10):
        exact, period = random_period(rng)
        t = np.array(times_at(rng, exact, power))
        whole, rest, lost = counted(t, period, offset)
        for time, n, left in zip(t.tolist(), whole.tolist(), (rest - lost).tolist(), strict=True):
            true = Fraction(time) - int(n) * exact
            assert abs(Fraction(left) - true) <= abs(true) / 2**52 + abs(Fraction(time)) / 2**100
            assert abs(true / exact + Fraction(offset or 0)) <= Fraction(1, 2) + Fraction(1, 2**19)


def test_a_far_time_does_not_change_a_near_one() -> None:
    rng = random.Random(26)
    for _ in range(20):
        exact, period = random_period(rng)
        near = np.array(times_at(rng, exact, 25.9))
        both = np.append(near, float(exact) * 2.0**45)
        for alone, beside in zip(
            counted(near, period, 0.2), counted(both, period, 0.2), strict=True
        ):
            np.testing.assert_array_equal(alone, beside[:-1])


@pytest.mark.parametrize("length", [Pair(0.0, 0.0), Pair(math.inf, 0.0)])
def test_a_period_without_end_leaves_times_alone(length: Pair) -> None:
    t = np.array([-3.0, 0.0, 1e200])
    whole, rest, lost = counted(t, period_of(length, 0.0))
    np.testing.assert_array_equal(whole, 0 * t)
    np.testing.assert_array_equal(rest - lost, t)


def test_fractions_of_turns_are_right_for_any_number_of_them() -> None:
    rng = random.Random(28)
    for _ in range(300):
        exact = Fraction(rng.getrandbits(300), 2 ** rng.randrange(290, 320))
        t = rng.choice([-1, 1]) * 10 ** rng.uniform(-3, 20)
        (found,) = fraction_of_product(np.array([t]), triple(exact)).tolist()
        away = (Fraction(found) - Fraction(t) * exact) % 1
        assert min(away, 1 - away) <= Fraction(1, 2**52)
        assert abs(found) <= 0.5


@pytest.mark.parametrize("step", [1, 7, 300, 4000])
@pytest.mark.parametrize("count", [0, 1, 2, 1000, 5000])
def test_the_order_of_a_parity(step: int, count: int) -> None:
    """One by one where parities change fast, and in runs where they do not."""
    values = np.arange(count, dtype=float)
    whole = -np.floor((values + 3) / step)
    even, order = order_by_parity(whole)
    odd = whole % 2 == 1
    assert even == count - np.count_nonzero(odd)
    if order is None:
        assert even in {0, count}
        return
    assert isinstance(order, list) == (step >= 300)
    ordered = taken(values, order, np.empty(count))
    np.testing.assert_array_equal(ordered, np.concatenate([values[~odd], values[odd]]))
    np.testing.assert_array_equal(placed(ordered, order, np.empty(count)), values)
