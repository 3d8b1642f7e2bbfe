"""Signs and zeros of polynomials in the cosine of a given angle, decided exactly.

The inputs of a scene are rational numbers.  Most questions about its motion ("is the precession
steady?", "does the axis meet the pole?") therefore ask for the sign of a polynomial with rational
coefficients at u = cos(theta0).  Enough digits reveal a sign other than 0, but a zero needs a
proof.

The cosine of an angle of k/n turns is algebraic of known degree, and the polynomial becomes one of
a root of unity.  The cosine of any other angle in radians is transcendental (Lindemann), so that
only the zero polynomial vanishes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

from .ball import Ball
from .balls import Balls, balls
from .decimals import pi_to
from .numbers import R, polynomial
from .rounding import decided
from .values import Over, Values

if TYPE_CHECKING:
    from .protocol import Arithmetic

_CERTAIN = 1e-12
"""A bound above the rounding error of a value if the sizes of the coefficients add up to 1."""
_SMALL = 1e-250
"""Sum of the coefficients' sizes below which some may be out of the range of doubles."""


class Polynomial:
    """A polynomial with rational coefficients, or with polynomials as coefficients.

    The lowest power is first.  The other operand of a sum or product is a polynomial or a rational
    number.
    """

    __slots__ = ("coefficients",)

    def __init__(self, *coefficients: Any) -> None:
        self.coefficients = coefficients

    def __call__(self, x: Any, convert: Callable[[Fraction], Any] = Fraction) -> Any:
        """Return the value at x, with the coefficients converted to the type of x."""
        return polynomial([convert(Fraction(c)) for c in self.coefficients], x)

    def __add__(self, other: object) -> Polynomial:
        return Polynomial(*map(sum, zip_longest(self.coefficients, _terms(other), fillvalue=0)))

    def __mul__(self, other: object) -> Polynomial:
        terms = _terms(other)
        product: list[Any] = [0] * (len(self.coefficients) + len(terms) - 1)
        for i, x in enumerate(self.coefficients):
            for j, y in enumerate(terms):
                product[i + j] += x * y
        return Polynomial(*product)

    __radd__, __rmul__ = __add__, __mul__

    def __sub__(self, other: object) -> Polynomial:
        return self + Polynomial(*_terms(other)) * -1

    def __rsub__(self, other: object) -> Polynomial:
        return self * -1 + other


U = Polynomial(0, 1)
"""The cosine itself."""


def _terms(value: object) -> tuple[Any, ...]:
    """Return the coefficients of a polynomial or of a rational number."""
    if isinstance(value, Polynomial):
        return value.coefficients
    assert isinstance(value, int | Fraction)
    return (value,)


class Tilt(Values, Over[R]):
    """Sines and cosines of an angle from 0 to pi and of half the angle."""

    sin: R
    cos: R
    sin_half: R
    cos_half: R

    def degrees(self, ar: Arithmetic[R]) -> R:
        """Return the angle itself, in degrees."""
        return 360 * ar.atan2(self.sin_half, self.cos_half) / ar.pi


class Cosine(Values):
    """The cosine of an angle from 0 to pi that is given exactly, in degrees or in radians."""

    degrees: Fraction | None
    radians: Fraction | None

    @property
    def rational(self) -> Fraction | None:
        """The value if it is rational (Niven: only at multiples of 60 and 90 degrees) or None."""
        if self.radians is not None:
            return Fraction(1) if self.radians == 0 else None
        known: dict[Fraction | int, int] = {0: 2, 60: 1, 90: 0, 120: -1, 180: -2}
        twice = None if self.degrees is None else known.get(self.degrees)
        return None if twice is None else Fraction(twice, 2)

    def vanishes(self, P: Polynomial) -> bool:
        """Return whether a polynomial is exactly 0 at this cosine."""
        return self._clear_sign(P) is None and self._vanishes(P)

    def fraction(self, P: Polynomial) -> Fraction | None:
        """Return the value of a polynomial if it is a fraction, else None.

        A fraction is its own mean over the conjugates of this cosine.
        """
        coefficients = _trimmed(P)
        if len(coefficients) < 2:
            return coefficients[0] if coefficients else Fraction(0)
        if self.rational is not None:
            return Fraction(P(self.rational))
        n = self._order(len(coefficients) - 1)
        if n is None:
            return None
        from .roots_of_unity import mean_at_roots_of_unity  # start-up: for few tops

        mean = mean_at_roots_of_unity(coefficients, n)
        return mean if self.vanishes(P - mean) else None

    def sign(self, P: Polynomial) -> int:
        """Return the sign of a polynomial, -1, 0 or 1."""
        sign = self._clear_sign(P)
        if sign is not None or self._vanishes(P):
            return sign or 0

        def decision(digits: int) -> int:
            return 1 if self.at(balls(digits), P) > 0 else -1

        return decided("a polynomial in cos(theta0)", decision)

    def _clear_sign(self, P: Polynomial) -> int | None:
        """Return the sign if doubles are sufficient to determine it, else None."""
        try:
            size = sum(abs(float(x)) for x in P.coefficients)
            value = P(math.cos(self._in_radians()), float)
        except OverflowError:
            return None
        if not abs(value) > _CERTAIN * size or size < _SMALL:
            return None
        return 1 if value > 0 else -1

    def _vanishes(self, P: Polynomial) -> bool:
        coefficients = _trimmed(P)
        if not coefficients:
            return True
        if self.rational is not None:
            return not P(self.rational)
        n = self._order(len(coefficients) - 1)
        if n is None:
            return False
        from .roots_of_unity import vanishes_at_root_of_unity  # start-up: for few tops

        return vanishes_at_root_of_unity(coefficients, n)

    def _order(self, degree: int) -> int | None:
        """Return n for k/n turns, or None if no polynomial of a degree has a rational value."""
        n = 0 if self.degrees is None else (self.degrees / 360).denominator
        # phi(n) >= sqrt(n/2): for larger n, the degree of the cosine is too high
        return n if 0 < n <= 8 * degree * degree else None

    def at(self, ar: Balls, P: Polynomial) -> Ball:
        """Return the value of a polynomial in balls."""
        value: Ball = P(self.value(ar), ar.convert)
        return value

    def _in_radians(self) -> float:
        return (
            float(self.radians or 0) if self.degrees is None else math.radians(float(self.degrees))
        )

    def value(self, ar: Arithmetic[R]) -> R:
        """Return the value in an arithmetic."""
        rational = self.rational
        return self.tilt(ar).cos if rational is None else ar.convert(rational)

    def tilt(self, ar: Arithmetic[R]) -> Tilt[R]:
        """Return sines and cosines of the angle and of its half with full *relative* accuracy.

        They are computed from the distances to the nearer pole and to the horizontal.
        """
        if self.degrees is not None:
            degree, upper = ar.pi / 180, self.degrees <= 90
            nearer = ar.convert(self.degrees if upper else 180 - self.degrees) * degree
            level = ar.convert(90 - self.degrees) * degree
        else:
            theta = Fraction(self.radians or 0)
            upper = theta < Fraction(3, 2)
            nearer = ar.convert(theta) if upper else _below_quarters(ar, 2, theta)
            level = _below_quarters(ar, 1, theta)
        small = ar.sin(nearer / 2)
        large = ar.sqrt(1 - small * small)
        return Tilt(2 * small * large, ar.sin(level), *(small, large) if upper else (large, small))


def below_quarters(quarters: int, theta: Fraction, digits: int = 1) -> Fraction:
    """Return quarter turns minus an angle in radians, to `digits` significant digits."""
    of_pi = digits + 20
    while True:
        gap = quarters * Fraction(pi_to(of_pi)) / 2 - theta
        if abs(gap) * 10 ** (of_pi - digits) > 2:
            return gap
        of_pi *= 2


def _below_quarters(ar: Arithmetic[R], quarters: int, theta: Fraction) -> R:
    """Return quarter turns minus an angle in an arithmetic, with full relative accuracy."""
    gap = ar.convert(below_quarters(quarters, theta, 2 - int(ar.magnitude)))
    return ar.widened(gap, lambda: (gap,), lambda gap: gap * ar.eps)


def _trimmed(P: Polynomial) -> list[Fraction]:
    """Return the coefficients without leading zeros."""
    coefficients = [Fraction(x) for x in P.coefficients]
    while coefficients and not coefficients[-1]:
        coefficients.pop()
    return coefficients
