"""The roots of the cubic (4,9): the largest one is enclosed by proof."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from lagrange_cli.arithmetic.ball import TooFewDigitsError, balls
from lagrange_cli.solver.any_start import largest_root


def test_the_largest_root_is_enclosed_or_too_few_digits_are_said() -> None:
    """Cubics with known roots and coefficients of any accuracy, often nearly double."""
    rng, found, refused = random.Random("largest root"), 0, 0
    for _ in range(400):
        ar = balls(rng.choice([8, 12, 20]))
        top = Fraction(rng.randrange(-9, 10), 10)
        middle = top - Fraction(10) ** rng.randrange(-9, 1)
        roots = (top, middle, middle - rng.randrange(3))
        exact = (
            -sum(roots),
            roots[0] * roots[1] + roots[0] * roots[2] + roots[1] * roots[2],
            -roots[0] * roots[1] * roots[2],
        )
        blur = Fraction(10) ** rng.randrange(-14, -2) * rng.randrange(2)
        with ar:
            c2, c1, c0 = (ar.between(ar.convert(x - blur), ar.convert(x + blur / 3)) for x in exact)
            try:
                root = largest_root(ar, c2, c1, c0, ar.convert(max(roots) + 3))
            except TooFewDigitsError:
                refused += 1
                continue
        found += 1
        low, high = map(Fraction, root.ends())
        assert low <= top <= high, roots
    assert min(found, refused) > 60


@pytest.mark.parametrize(("above", "proved"), [(100, True), (5.0001, True), (2, False), (1, False)])
def test_the_root_is_proved_to_be_the_largest(above: float, proved: bool) -> None:
    """Start from a point next to another root of (x - 1)(x - 2)(x - 5)."""
    with balls(60) as ar:
        cubic = [ar.convert(x) for x in (-8, 17, -10, above)]
        if proved:
            assert largest_root(ar, *cubic).x.contains(5)
        else:
            with pytest.raises(TooFewDigitsError):
                largest_root(ar, *cubic)
