"""The functions of the decimals against mpmath."""

from __future__ import annotations

import random
from collections.abc import Callable
from decimal import Decimal
from typing import Any

import mpmath
import pytest

from lagrange_cli.arithmetic.decimals import decimals, pi_to

FUNCTIONS: dict[str, tuple[float, float]] = {
    "sin": (0, 6.3),
    "cos": (0, 1.5),
    "exp": (-300, 300),
    "sinh": (-40, 40),
    "cosh": (-40, 40),
}
"""Functions whose relative error is small, and where they are tried."""


def exact(value: Decimal) -> Any:
    """Return a decimal in mpmath."""
    return mpmath.mpf(str(value))


@pytest.mark.parametrize("digits", [10, 40, 55, 56, 60, 61, 150, 1000])
def test_pi(digits: int) -> None:
    with mpmath.workdps(digits + 20):
        for value in (pi_to(digits), decimals(digits).pi):
            assert abs(exact(value) / mpmath.pi - 1) < mpmath.mpf(10) ** (1 - digits)


@pytest.mark.parametrize("digits", [30, 200])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_relative_errors(name: str, digits: int) -> None:
    """Within a hundred units of the last digit: relatively, next to the zeros of the sine too."""
    rng, ar = random.Random(name), decimals(digits)
    low, high = FUNCTIONS[name]
    ours: Callable[[Decimal], Decimal] = getattr(ar, name)
    with ar.working(), mpmath.workdps(digits + 20):
        for _ in range(60):
            x = Decimal(rng.uniform(low, high)) * Decimal(10) ** rng.choice([0, 0, 0, -3, -30])
            true = getattr(mpmath, name)(exact(x))
            assert abs(exact(ours(x)) - true) <= 100 * abs(true) * exact(ar.eps) + (
                exact(ar.eps) if name == "sin" else 0
            ), x


@pytest.mark.parametrize("digits", [30, 200])
def test_small_arguments_of_sinh_and_sin_keep_their_digits(digits: int) -> None:
    ar = decimals(digits)
    with ar.working(), mpmath.workdps(digits + 20):
        for exponent in (-1, -10, -100, -1000):
            x = Decimal(7) * Decimal(10) ** exponent
            for name in ("sin", "sinh"):
                true = getattr(mpmath, name)(exact(x))
                assert abs(exact(getattr(ar, name)(x)) / true - 1) <= 10 * exact(ar.eps)


@pytest.mark.parametrize("digits", [30, 200])
def test_asinh(digits: int) -> None:
    """The error is absolute: it counts digits behind the point."""
    rng, ar = random.Random(5), decimals(digits)
    with ar.working(), mpmath.workdps(digits + 20):
        for _ in range(60):
            x = Decimal(rng.uniform(-1, 1)) * Decimal(10) ** rng.choice([0, 3, 30, -3, -20])
            true = mpmath.asinh(exact(x))
            assert abs(exact(ar.asinh(x)) - true) <= 10 * exact(ar.eps) * max(1, abs(true))
        assert ar.asinh(Decimal(0)) == 0


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
