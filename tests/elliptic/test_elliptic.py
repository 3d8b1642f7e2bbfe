"""Elliptic integrals and the nome against mpmath's, which share no code with ours."""

from __future__ import annotations

import random

import mpmath
import numpy as np
import pytest
from scenes import EPS

from lagrange_cli.arithmetic.arrays import ARRAYS
from lagrange_cli.arithmetic.numbers import DOUBLES
from lagrange_cli.elliptic.carlson import carlson_rf
from lagrange_cli.elliptic.complete import complete_e, complete_k, nome, period_mean
from lagrange_cli.elliptic.many_digits import ManyDigits

_RANDOM = random.Random(4)
COMPLEMENTS = [10 ** _RANDOM.uniform(-14, 0) for _ in range(100)] + [
    _RANDOM.uniform(0.01, 1) for _ in range(100)
]


def error(value: float, true: mpmath.mpf) -> float:
    return float(abs(mpmath.mpf(value) / true - 1) / EPS)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["K", "E", "third"])
def test_complete_integrals(kind: str) -> None:
    """Worst seen in 20 000: K 2.5, E 4.7, third kind over K 3.7 eps."""
    rng = random.Random(kind)
    with mpmath.workdps(40):
        for k_prime in COMPLEMENTS:
            m = 1 - mpmath.mpf(k_prime) ** 2
            p = 10 ** rng.uniform(-8, 8)
            if kind == "K":
                assert error(complete_k(DOUBLES, k_prime), mpmath.ellipk(m)) <= 2.5
            elif kind == "E":
                assert error(complete_e(DOUBLES, k_prime), mpmath.ellipe(m)) <= 4.7
            else:
                true = mpmath.elliprj(0, 1 - m, 1, p) / 3 / mpmath.ellipk(m)
                assert error(period_mean(DOUBLES, k_prime, p, 0, 1), true) <= 3.7


def test_nome() -> None:
    """Worst seen: 2.2 eps, from q = 1e-29 to 0.9."""
    with mpmath.workdps(80):
        for k in COMPLEMENTS:
            m = mpmath.mpf(k * k)
            if m < 1:
                true = mpmath.exp(-mpmath.pi * mpmath.ellipk(1 - m) / mpmath.ellipk(m))
                assert error(nome(DOUBLES, m=k * k, k_prime=float(mpmath.sqrt(1 - m))), true) <= 2.2


def test_arrays_give_what_floats_give() -> None:
    k_prime = np.array(COMPLEMENTS)
    for function in (complete_k, complete_e):
        alone = [function(DOUBLES, x) for x in COMPLEMENTS]
        np.testing.assert_allclose(function(ARRAYS, k_prime), alone, rtol=4 * EPS)


def test_a_hundred_digits() -> None:
    ar = ManyDigits(100)
    k_prime = ar.mpf("0.3")
    m = 1 - k_prime**2
    assert abs(complete_k(ar, k_prime) / ar.ellipk(m) - 1) < ar.mpf(10) ** -98
    assert abs(complete_e(ar, k_prime) / ar.ellipe(m) - 1) < ar.mpf(10) ** -98
    assert (
        abs(carlson_rf(ar, ar.mpf(1), ar.mpf(2), ar.mpf(5)) / ar.elliprf(1, 2, 5) - 1)
        < ar.mpf(10) ** -98
    )
    assert mpmath.mp.dps == 15  # nobody else's precision was touched
