"""Angles that are given exactly, and signs of polynomials in their cosine."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import Any, Generic, NamedTuple

from flint import arb, fmpq

from .ball import Ball, Balls, balls
from .numbers import Number, R, polynomial
from .rounding import sign_of


class Tilt(NamedTuple, Generic[R]):
    """Sines and cosines of an angle from 0 to pi and of half the angle."""

    sin: R
    cos: R
    sin_half: R
    cos_half: R

    def degrees(self, ar: Any) -> R:
        """Return the angle itself, in degrees, in the arithmetic `ar`."""
        angle: R = 360 * ar.atan2(self.sin_half, self.cos_half) / ar.pi
        return angle


class Angle(NamedTuple):
    """An angle from 0 to pi that is given exactly, in degrees or in radians."""

    degrees: Fraction | None
    radians: Fraction | None

    @classmethod
    def of(cls, degrees: Number | None, radians: Number | None) -> Angle:
        """Return the angle that one of two numbers gives, in degrees or in radians."""
        return cls(*(None if x is None else Fraction(x) for x in (degrees, radians)))

    @property
    def rational_cosine(self) -> Fraction | None:
        """The cosine if it is rational (Niven: only at multiples of 60 and 90 degrees) or None."""
        if self.degrees is None:
            return None if self.radians else Fraction(1)
        known = {0: 2, 60: 1, 90: 0, 120: -1, 180: -2}
        return next((Fraction(x, 2) for tilt, x in known.items() if tilt == self.degrees), None)

    def cosine(self, ar: Balls) -> Ball:
        """Return the cosine."""
        return self._sine_and_cosine(ar, 1)[1]

    def tilt(self, ar: Balls) -> Tilt[Ball]:
        """Return sines and cosines of the angle and of its half."""
        whole, half = self._sine_and_cosine(ar, 1), self._sine_and_cosine(ar, 2)
        return Tilt(*whole, *half)

    @lru_cache(maxsize=64)  # noqa: B019 - angles are small values
    def _sine_and_cosine(self, ar: Balls, parts: int) -> tuple[Ball, Ball]:
        """Return the sine and the cosine of the angle divided by a number of parts."""
        with ar.working():
            if self.degrees is None:
                sin_cos = ar.convert((self.radians or Fraction(0)) / parts).x.sin_cos()
            else:
                half_turns = self.degrees / 180 / parts
                ratio = fmpq(half_turns.numerator, half_turns.denominator)
                sin_cos = arb.sin_cos_pi_fmpq(ratio)
        return Ball(sin_cos[0]), Ball(sin_cos[1])

    def sign(self, *coefficients: Fraction | int, most: int) -> int:
        """Return the sign of a polynomial in the cosine, the constant first.

        It is 0 if `most` digits do not show another sign.
        """
        u = self.rational_cosine if any(coefficients[1:]) else Fraction(0)
        if u is not None:
            value = polynomial([Fraction(x) for x in coefficients], u)
            return int(value > 0) - int(value < 0)

        def enclosure(digits: int) -> Ball:
            ar = balls(digits)
            value: Ball = polynomial([ar.convert(x) for x in coefficients], self.cosine(ar))
            return value

        return sign_of(enclosure, most)
