"""Our balls beside those of Arb, which judges them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from decimal import Decimal
from fractions import Fraction
from typing import Any

from flint import arb, ctx, fmpq

from lagrange_cli.arithmetic.ball import Ball


@contextmanager
def arb_bits(bits: int) -> Iterator[None]:
    """Let Arb work with so many bits for a while."""
    before, ctx.prec = ctx.prec, bits
    try:
        yield
    finally:
        ctx.prec = before


def exact_arb(value: Decimal | Fraction | float | str) -> arb:
    """Return an exact number in Arb."""
    fraction = Fraction(value)
    return arb(fmpq(fraction.numerator, fraction.denominator))


def arb_of(ball: Ball) -> arb:
    """Return a ball of ours as one of Arb that holds it."""
    if not ball.radius.is_finite():
        return arb("nan")
    return exact_arb(ball.middle) + arb(0, exact_arb(ball.radius).abs_upper())


def holds(ball: Ball, truth: Any) -> bool:
    """Return whether a ball may hold a number that Arb encloses: whether the two overlap."""
    return bool(arb_of(ball).overlaps(truth))
