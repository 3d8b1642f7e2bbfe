"""Our balls beside those of Arb, which judges them."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
from flint import arb, fmpq

from lagrange_cli.arithmetic.ball import Ball


def exact_arb(value: Decimal | Fraction | float | str) -> arb:
    """Return an exact number in Arb."""
    fraction = Fraction(value)
    return arb(fmpq(fraction.numerator, fraction.denominator))


def many_digits(ball: arb) -> Any:
    """Return the middle of a ball of Arb as a number of mpmath, to 60 digits."""
    with mpmath.workdps(60):
        return mpmath.mpf(ball.mid().str(60, radius=False))


def arb_of(ball: Ball) -> arb:
    """Return a ball of ours as one of Arb that holds it."""
    if not ball.radius.is_finite():
        return arb("nan")
    return exact_arb(ball.middle) + arb(0, exact_arb(ball.radius).abs_upper())


def holds(ball: Ball, truth: Any) -> bool:
    """Return whether a ball may hold a number that Arb encloses: whether the two overlap."""
    return bool(arb_of(ball).overlaps(truth))
