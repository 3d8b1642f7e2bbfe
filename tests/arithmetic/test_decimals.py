"""The functions of the decimals against mpmath."""

from __future__ import annotations

import random
from collections.abc import Callable
from decimal import Decimal
from typing import Any

import mpmath
import pytest

from lagrange_cli.arithmetic.decimals import decimals, pi_to


def between(low: float, high: float, *exponents: int) -> Callable[[random.Random], Decimal]:
    """Return a function that draws numbers, some of them times small or large powers of 10."""
    return lambda rng: Decimal(rng.uniform(low, high)) * Decimal(10) ** rng.choice(exponents)


SMALL, TINY = (0, 0, 0, -3, -30), (-1, -10, -100, -1000)
ERRORS: dict[tuple[str, Callable[[random.Random], Decimal]], tuple[int, int]] = {
    ("sin", between(0, 3, *SMALL)): (100, 0),
    ("sin", between(3, 6.3, 0)): (0, 200),  # the terms of its series reach 86
    ("sin", between(7, 7, *TINY)): (10, 0),
    ("cos", between(0, 1.5, *SMALL)): (100, 0),
    ("exp", between(-300, 300, *SMALL)): (100, 0),
    ("sinh", between(-40, 40, *SMALL)): (100, 0),
    ("sinh", between(7, 7, *TINY)): (10, 0),
    ("cosh", between(-40, 40, *SMALL)): (100, 0),
    ("asinh", between(-1, 1, 0, 3, 30, -3, -20)): (5, 5),
    ("asinh", between(0, 0, 0)): (10, 0),
}
"""Largest errors in the last digit: relative to the value, and absolute."""


def exact(value: Decimal) -> Any:
    """Return a decimal in mpmath."""
    return mpmath.mpf(str(value))


@pytest.mark.parametrize("digits", [10, 40, 55, 56, 60, 61, 150, 1000])
def test_pi(digits: int) -> None:
    with mpmath.workdps(digits + 20):
        for value in (pi_to(digits), decimals(digits).pi):
            assert abs(exact(value) / mpmath.pi - 1) < mpmath.mpf(10) ** (1 - digits)


@pytest.mark.parametrize("digits", [30, 200])
@pytest.mark.parametrize(("case", "units"), ERRORS.items(), ids=[name for name, _ in ERRORS])
def test_errors(
    case: tuple[str, Callable[[random.Random], Decimal]], units: tuple[int, int], digits: int
) -> None:
    (name, draw), (relative, absolute) = case, units
    rng, ar = random.Random(5), decimals(digits)
    ours: Callable[[Decimal], Decimal] = getattr(ar, name)
    with ar.working(), mpmath.workdps(digits + 20):
        for _ in range(60):
            x = draw(rng)
            true = getattr(mpmath, name)(exact(x))
            most = (relative * abs(true) + absolute) * exact(ar.eps)
            assert abs(exact(ours(x)) - true) <= most, x


@pytest.mark.parametrize("digits", [30, 200])
def test_atan2_in_four_quadrants_and_on_the_axes(digits: int) -> None:
    rng, ar = random.Random(4), decimals(digits)
    with ar.working(), mpmath.workdps(digits + 20):
        points = [(rng.uniform(-1, 1), rng.uniform(-1, 1) ** 9) for _ in range(60)]
        points += [(y, x) for y in (-2, 0, 2) for x in (-3, 0, 3) if x or y]
        points += [(y * 1e-200, x) for y in (-1, 1) for x in (-1, 1)]
        for y, x in points:
            true = mpmath.atan2(mpmath.mpf(y), mpmath.mpf(x))
            angle = exact(ar.atan2(Decimal(y), Decimal(x)))
            assert abs(angle - true) <= 100 * abs(true) * exact(ar.eps), (y, x)


def test_nearest_integers() -> None:
    ar = decimals(30)
    with ar.working():
        assert [ar.nint(Decimal(x)) for x in ("0.5", "1.5", "-2.5", "2.51", "1e40")] == [
            *(0, 2, -2, 3),
            10**40,
        ]
