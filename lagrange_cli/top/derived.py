"""Inputs that are derived from others: A from A_cm, r0 from phidot0, steady precession rates.

The tilt stays constant if A cos(theta) Omega^2 - C r0 Omega + mgs = 0.  With a = 2mgs/A (4,4) and b
= C r0/A (4,5) this is cos(theta) Omega^2 - b Omega + a/2 = 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.angle import Angle
from ..arithmetic.ball import Ball, balls
from ..arithmetic.numbers import Number, R
from ..arithmetic.rounding import equal_digits, nearest_double, rounding_of, settled
from ..arithmetic.text import quoted
from ..errors import LagtopError
from .values import STEADY_WORDS

if TYPE_CHECKING:
    from ..arithmetic.numbers import Arithmetic

EXACT_DIGITS = 1100
"""Digits of a fraction that approximates an irrational number: more than any output shows."""
SLOW, FAST = STEADY_WORDS


def as_solved(inputs: Mapping[str, Number]) -> dict[str, Number]:
    """Return the inputs of a top, with A computed from A_cm and r0 from phidot0.

    Each result is rounded to the nearest double, unless an input is a fraction.  Raises LagtopError
    for a negative A_cm.
    """
    solved = dict(inputs)
    if solved.pop("A_cm", None) is not None:
        solved["A"] = moment(inputs)
    if solved.pop("phidot0", None) is not None:
        solved["r0"] = spin(inputs)
    return solved


def moment(inputs: Mapping[str, Number]) -> Number:
    """Return the moment about the pivot, A = A_cm + m s^2 (Steiner's theorem)."""
    given = [inputs[name] for name in ("A_cm", "m", "s")]
    A_cm, m, s = (Fraction(x) for x in given)
    if A_cm < 0:
        raise LagtopError(f"A_cm must be >= 0, got {float(A_cm)}", "A_cm")
    exact = A_cm + m * s**2
    return exact if any(isinstance(x, Fraction) for x in given) else float(exact)


def spin(inputs: Mapping[str, Number]) -> Number:
    """Return the total rate about the figure axis, r0 = phi' + psi' cos(theta0) (4,1).

    If the cosine is irrational, the fraction has `EXACT_DIGITS` digits.
    """
    names = ("phidot0", "psidot0", "theta0_deg", "theta0_rad")
    given = [x for name in names if (x := inputs.get(name)) is not None]
    keeps = any(isinstance(x, Fraction) and x for x in given)
    phi_rate, psi_rate = Fraction(inputs["phidot0"]), Fraction(inputs["psidot0"])
    tilt = Angle.of(inputs.get("theta0_deg"), inputs.get("theta0_rad"))
    rational = tilt.rational_cosine if psi_rate else Fraction(0)
    if rational is not None:
        exact = phi_rate + psi_rate * rational
        return exact if keeps else float(exact)

    def enclosure(digits: int) -> Ball:
        ar = balls(digits)
        return ar.convert(phi_rate) + ar.convert(psi_rate) * tilt.cosine(ar)

    digits, rounding = 0, nearest_double("r0")
    if keeps:
        digits, rounding = EXACT_DIGITS, rounding_of("r0", EXACT_DIGITS)
    found = settled("r0", enclosure, rounding, digits=digits)
    assert found is not None
    value: Number = Fraction(found.value) if keeps else found.value
    return value


class SteadyRates(NamedTuple):
    """The rates of steady precession of a top at its tilt."""

    a: Fraction
    b: Fraction
    tilt: Angle

    def sign(self, *coefficients: Fraction | int) -> int:
        """Return the sign of a polynomial in the cosine of the tilt, the constant first."""
        inputs = [self.a, self.b, *(x for x in self.tilt if x is not None)]
        return self.tilt.sign(*coefficients, most=equal_digits(inputs))

    @property
    def discriminant(self) -> int:
        """The sign of b^2 - 2 a cos(theta)."""
        return self.sign(self.b * self.b, -2 * self.a)

    def exists(self, word: str) -> bool:
        """Return whether a root is real and finite; at 90 degrees only the slow one is."""
        if not self.sign(0, 1):
            return word == SLOW and bool(self.b)
        return self.discriminant >= 0

    def rate(self, ar: Arithmetic[R], a: R, b: R, cos: R, word: str) -> R:
        """Return an existing root from a, b and the cosine, in the arithmetic `ar`.

        No digits cancel: with q = b + sgn(b) sqrt(b^2 - 2 a cos(theta)) the fast root is q/(2
        cos(theta)) and the slow one a/q.  If r0 = 0, both roots have the same size; the slow root
        is the positive one, as in the limit of small positive r0.
        """
        if not (self.a or self.b):
            return 0 * a
        root = ar.sqrt(b * b - 2 * a * cos) if self.discriminant else 0 * b
        q = b - root if self.b < 0 else b + root
        return q / (2 * cos) if word == FAST else a / q


def rates_of(top: Any) -> SteadyRates:
    """Return the rates of steady precession of a top."""
    m, A, C, s, g, r0 = (Fraction(getattr(top, x)) for x in ("m", "A", "C", "s", "g", "r0"))
    return SteadyRates(2 * m * g * s / A, C * r0 / A, top.angle)


def steady_rate_of(top: Any, word: str) -> float:
    """Return the rate of steady precession that a word names, rounded to the nearest double.

    The top's own rate is not used.

    Raises LagtopError for an unknown word, and for a top that has no such rate.
    """
    rates = rates_of(top)
    if word not in STEADY_WORDS:
        wrong = f"psidot0 must be a real number, steady or steady-fast, got {quoted(word)}"
    elif top.thetadot0:
        wrong = f"thetadot0 must be 0 for psidot0 = {word}, got {float(top.thetadot0)}"
    elif top.pole:
        wrong = f"psidot0 must be 0 if the axis is vertical, got {word} "
        wrong += "(a vertical axis cannot precess)"
    elif not rates.exists(word) and not rates.sign(0, 1):
        why = "the fast rate is infinite" if rates.b else "r0 must not be 0"
        wrong = f"psidot0 cannot be {word}: at 90 degrees {why}"
    elif not rates.exists(word):
        cosine = float(rates.tilt.cosine(balls(40)).middle)
        least = float(top.A / top.C) * math.sqrt(2 * float(rates.a) * cosine)
        why = f"|r0| must be at least {least:.6g} at this tilt, got r0 = {float(top.r0)}"
        wrong = f"psidot0 cannot be {word}: {why}"
    else:

        def enclosure(digits: int) -> Ball:
            ar = balls(digits)
            a, b = ar.convert(rates.a), ar.convert(rates.b)
            return rates.rate(ar, a, b, rates.tilt.cosine(ar), word)

        found = settled("psidot0", enclosure, nearest_double("psidot0"))
        assert found is not None
        return float(found.value)
    raise LagtopError(wrong, wrong.partition(" ")[0])
