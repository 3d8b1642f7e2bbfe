"""The arithmetic behind `solve`: 40-digit decimals from the standard library.

A record computed like this and rounded once is right to the last bit, and nothing heavier than
the `decimal` module (which `fractions` loads anyway) has to be imported for it.  In plain doubles
the same formulas were off by up to 5 eps, in about one scene of ten thousand.
"""

from __future__ import annotations

import decimal
from decimal import Decimal
from fractions import Fraction

DIGITS = 40
eps = Decimal(10) ** (1 - DIGITS)
pi = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")


def context() -> decimal.Context:
    """The precision to compute in, with an exponent range that no scene leaves."""
    return decimal.Context(prec=DIGITS, Emin=decimal.MIN_EMIN, Emax=decimal.MAX_EMAX)


def convert(value: float | Fraction) -> Decimal:
    """A number of this arithmetic, rounded once."""
    exact = Fraction(value)
    return Decimal(exact.numerator) / Decimal(exact.denominator)


def sqrt(x: Decimal | int) -> Decimal:
    """Square root of x >= 0."""
    return Decimal(x).sqrt()


def hypot(x: Decimal, y: Decimal) -> Decimal:
    """sqrt(x^2 + y^2)."""
    return (x * x + y * y).sqrt()


def sin(x: Decimal) -> Decimal:
    """Sine by its Taylor series, for |x| <= pi."""
    return _alternating(x, -x * x, 1)


def cos(x: Decimal) -> Decimal:
    """Cosine by its Taylor series, for |x| <= pi."""
    return _alternating(Decimal(1), -x * x, 0)


def atan2(y: Decimal, x: Decimal) -> Decimal:
    """Angle of the point (x, y) in the first quadrant, halved four times before its series."""
    for _ in range(4):
        x = x + hypot(x, y)
    tangent = y / x
    square, power, total, n = -tangent * tangent, tangent, tangent, 1
    while abs(power) > eps * abs(total) / 100:
        power, n = power * square, n + 2
        total += power / n
    return 16 * total


def _alternating(term: Decimal, ratio: Decimal, n: int) -> Decimal:
    """Sum of terms, each ratio/((n + 1)(n + 2)) times the one before."""
    total = term
    while abs(term) > eps * abs(total) / 100:
        term, n = term * ratio / ((n + 1) * (n + 2)), n + 2
        total += term
    return total
