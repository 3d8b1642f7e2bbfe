"""Pairs of doubles, checked by fractions."""

from __future__ import annotations

import operator
from fractions import Fraction

import numpy as np

from lagrange_cli.arithmetic.bounded import PAIR_EPS, Bounded
from lagrange_cli.arithmetic.pairs import DoubleDouble


def exact(x: DoubleDouble | float) -> list[Fraction]:
    """Return the exact values of a hundred numbers."""
    if isinstance(x, DoubleDouble):
        return [Fraction(a) + Fraction(b) for a, b in zip(x.high, x.low, strict=True)]
    return [Fraction(x)] * 100


def test_an_operation_on_pairs_is_good_to_half_its_bound() -> None:
    rng, most = np.random.default_rng(30), Fraction(PAIR_EPS) / 2
    x, y = (
        DoubleDouble(rng.choice([-1, 1], 100) * rng.uniform(1, 2, 100), rng.normal(0, 2e-17, 100))
        for _ in range(2)
    )
    for compute in (operator.add, operator.sub, operator.mul, operator.truediv):
        for one, other in ((x, y), (x, 0.3), (0.3, y), (x, 0.25)):
            for a, b, found in zip(
                exact(one), exact(other), exact(compute(one, other)), strict=True
            ):
                size = abs(a) + abs(b) if compute in {operator.add, operator.sub} else compute(a, b)
                assert abs(compute(a, b) - found) <= most * abs(size)
    for a, root in zip(exact(abs(x)), exact(abs(x).sqrt()), strict=True):
        assert abs(a - root * root) <= 2 * most * a


def test_a_quotient_by_zero_is_no_number() -> None:
    """Its reciprocal would be exactly 0."""
    with np.errstate(all="ignore"):
        twice = 1.0 / (1.0 / Bounded(np.array([0.0, 2.0])))
    assert np.isnan(twice.value).tolist() == [True, False]
    assert (twice.relative or 0) < 1e-15
