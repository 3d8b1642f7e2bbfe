"""Exact numbers in Arb, and its numbers in mpmath."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
from flint import arb, fmpq


def exact_arb(value: Decimal | Fraction | float | str) -> arb:
    """Return an exact number in Arb."""
    fraction = Fraction(value)
    return arb(fmpq(fraction.numerator, fraction.denominator))


def many_digits(ball: arb) -> Any:
    """Return the middle of a ball of Arb as a number of mpmath, to 60 digits."""
    with mpmath.workdps(60):
        return mpmath.mpf(ball.mid().str(60, radius=False))
