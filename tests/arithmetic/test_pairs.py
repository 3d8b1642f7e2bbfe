"""Pairs of doubles, checked by fractions."""

from __future__ import annotations

import operator
from fractions import Fraction

import numpy as np

from lagrange_cli.arithmetic.bounded import Bounded
from lagrange_cli.arithmetic.pairs import DoubleDouble


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
        for one, other in ((x, y), (x, 0.3), (0.3, y), (x, 0.25)):
            pairs = zip(exact(one), exact(other), exact(compute(one, other)), strict=True)
            assert all(abs(compute(a, b) - found) < Fraction(1, 2**100) for a, b, found in pairs)
    roots = zip(exact(abs(x)), exact(abs(x).sqrt()), strict=True)
    assert all(abs(a - root * root) < Fraction(1, 2**100) for a, root in roots)


def test_a_quotient_by_zero_is_no_number() -> None:
    """Its reciprocal would be exactly 0."""
    with np.errstate(all="ignore"):
        twice = 1.0 / (1.0 / Bounded(np.array([0.0, 2.0])))
    assert np.isnan(twice.value).tolist() == [True, False]
    assert (twice.relative or 0) < 1e-15
