"""The roots of the cubic (4,9): the largest one is enclosed by proof."""

from __future__ import annotations

import random
from decimal import Decimal
from fractions import Fraction

from lagrange_cli.arithmetic.ball import TooFewDigitsError
from lagrange_cli.arithmetic.balls import balls
from lagrange_cli.motion.any_start import largest_root


def test_the_largest_root_is_enclosed_or_too_few_digits_are_said() -> None:
    """Cubics with known roots and coefficients of any accuracy, often nearly double."""
    rng, found, refused = random.Random("largest root"), 0, 0
    for _ in range(3000):
        ar = balls(rng.choice([8, 12, 20]))
        top = Fraction(rng.randrange(-9, 10), 10)
        middle = top - Fraction(10) ** rng.randrange(-9, 1)
        roots = (top, middle, middle - rng.randrange(3))
        exact = (
            -sum(roots),
            roots[0] * roots[1] + roots[0] * roots[2] + roots[1] * roots[2],
            -roots[0] * roots[1] * roots[2],
        )
        blur = Decimal(10) ** rng.randrange(-14, -2)
        c2, c1, c0 = (ar.convert(x).enlarged(blur * rng.randrange(2)) for x in exact)
        try:
            root = largest_root(ar, c2, c1, c0, ar.convert(max(roots) + 3))
        except TooFewDigitsError:
            refused += 1
            continue
        found += 1
        low, high = map(Fraction, root.ends())
        assert low <= top <= high, roots
    assert min(found, refused) > 500
