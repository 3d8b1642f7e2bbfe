"""Signs and zeros of polynomials in the cosine of a given angle, decided exactly.

The inputs of a scene are rational numbers, so most questions about its motion ("is the precession
steady?", "does the axis meet the pole?") ask for the sign of a polynomial with rational
coefficients at u = cos(theta0).  A sign that is not 0 shows itself in enough digits; a zero has to
be proved.  The cosine of an angle of k/n turns is algebraic of known degree: the polynomial
vanishes there just if the cyclotomic polynomial of n divides it.  The cosine of any other angle in
radians is transcendental (Lindemann), so that only the zero polynomial vanishes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache, reduce
from typing import TYPE_CHECKING, Any

from .ball import Ball
from .balls import Balls, balls
from .decimals import pi_to
from .numbers import R
from .rounding import decided
from .values import Over, Values

if TYPE_CHECKING:
    from .protocol import Arithmetic

_CERTAIN = 1e-12
"""More than the rounding of a value whose coefficients have the sum 1 in size."""
_SMALL = 1e-250
"""Below this sum of coefficients some of them may have left the range of doubles."""


class Polynomial:
    """A polynomial with rational coefficients, the lowest power first."""

    __slots__ = ("coefficients",)

    def __init__(self, *coefficients: Fraction | int) -> None:
        self.coefficients = coefficients

    def __add__(self, other: object) -> Polynomial:
        """Return the sum with a polynomial or a rational number."""
        p, q = self.coefficients, _polynomial(other).coefficients
        if len(p) < len(q):
            p, q = q, p
        return Polynomial(*(x + y for x, y in zip(p, q, strict=False)), *p[len(q) :])

    def __mul__(self, other: object) -> Polynomial:
        """Return the product with a polynomial or a rational number."""
        p, q = self.coefficients, _polynomial(other).coefficients
        product: list[Fraction | int] = [0] * (len(p) + len(q) - 1)
        for i, x in enumerate(p):
            for j, y in enumerate(q):
                product[i + j] += x * y
        return Polynomial(*product)

    def __rmul__(self, other: object) -> Polynomial:
        """Return the product with a rational number."""
        return self * other

    def __sub__(self, other: object) -> Polynomial:
        """Return the difference from a polynomial or a rational number."""
        return self + _polynomial(other) * -1

    def __rsub__(self, other: object) -> Polynomial:
        """Return the difference of a rational number and the polynomial."""
        return _polynomial(other) - self

    def __radd__(self, other: object) -> Polynomial:
        """Return the sum with a rational number."""
        return self + other


U = Polynomial(0, 1)
"""The cosine itself."""


def _polynomial(value: object) -> Polynomial:
    if isinstance(value, Polynomial):
        return value
    assert isinstance(value, int | Fraction)
    return Polynomial(value)


class Tilt(Values, Over[R]):
    """Sines and cosines of an angle from 0 to pi and of its half."""

    sin: R
    cos: R
    sin_half: R
    cos_half: R

    def degrees(self, ar: Arithmetic[R]) -> R:
        """Return the angle itself, in degrees."""
        return 360 * ar.atan2(self.sin_half, self.cos_half) / ar.pi


class Cosine(Values):
    """The cosine of an angle from 0 to pi that is given exactly, in degrees or else in radians."""

    degrees: Fraction | None
    radians: Fraction | None

    @property
    def rational(self) -> Fraction | None:
        """The value, where it is rational (Niven: at multiples of 60 and 90 degrees only)."""
        if self.radians is not None:
            return Fraction(1) if self.radians == 0 else None
        known: dict[Fraction | int, int] = {0: 2, 60: 1, 90: 0, 120: -1, 180: -2}
        twice = None if self.degrees is None else known.get(self.degrees)
        return None if twice is None else Fraction(twice, 2)

    def vanishes(self, polynomial: Polynomial) -> bool:
        """Return whether a polynomial is exactly 0 here."""
        return self._clear_sign(polynomial) is None and self._vanishes(polynomial)

    def fraction(self, polynomial: Polynomial) -> Fraction | None:
        """Return a polynomial here where it is known as a fraction: 0, a constant, or of one."""
        constant, *others = polynomial.coefficients
        if not any(others):
            return Fraction(constant)
        if self.rational is not None:
            return Fraction(value_at([Fraction(x) for x in polynomial.coefficients], self.rational))
        return Fraction(0) if self.vanishes(polynomial) else None

    def sign(self, polynomial: Polynomial) -> int:
        """Return the sign of a polynomial, -1, 0 or 1."""
        sign = self._clear_sign(polynomial)
        if sign is None:
            sign = 0 if self._vanishes(polynomial) else self._sign_in_balls(polynomial)
        return sign

    def _clear_sign(self, polynomial: Polynomial) -> int | None:
        """Return the sign where doubles are enough to see it."""
        try:
            coefficients = [float(x) for x in polynomial.coefficients]
            size = sum(map(abs, coefficients))
            value = value_at(coefficients, math.cos(self._in_radians()))
        except OverflowError:
            return None
        if not abs(value) > _CERTAIN * size or size < _SMALL:
            return None
        return 1 if value > 0 else -1

    def _vanishes(self, polynomial: Polynomial) -> bool:
        coefficients = [Fraction(x) for x in polynomial.coefficients]
        while coefficients and not coefficients[-1]:
            coefficients.pop()
        if not coefficients:
            return True
        rational = self.rational
        if rational is not None:
            return not value_at(coefficients, rational)
        if self.degrees is None or len(coefficients) == 1:
            return False
        n, degree = (self.degrees / 360).denominator, len(coefficients) - 1
        if n > 8 * degree * degree:  # phi(n) >= sqrt(n/2): its degree is too high
            return False
        return not any(x != 0 for x in _remainder(_in_roots_of_unity(coefficients), cyclotomic(n)))

    def _sign_in_balls(self, polynomial: Polynomial) -> int:
        def sign(digits: int) -> int:
            return 1 if self.at(balls(digits), polynomial) > 0 else -1

        return decided("a polynomial in cos(theta0)", sign)

    def at(self, ar: Balls, polynomial: Polynomial) -> Ball:
        """Return the value of a polynomial in balls."""
        value: Ball = value_at(
            [ar.convert(Fraction(x)) for x in polynomial.coefficients], self.value(ar)
        )
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
        """Return sines and cosines of the angle and its half with full *relative* accuracy.

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
    """Return so many quarter turns less an angle in radians, to so many significant digits."""
    of_pi = digits + 20
    while True:
        gap = quarters * Fraction(pi_to(of_pi)) / 2 - theta
        if abs(gap) * 10 ** (of_pi - digits) > 2:
            return gap
        of_pi *= 2


def _below_quarters(ar: Arithmetic[R], quarters: int, theta: Fraction) -> R:
    """Return the same in an arithmetic, with full relative accuracy."""
    gap = ar.convert(below_quarters(quarters, theta, 2 - int(ar.magnitude)))
    return ar.widened(gap, lambda: (gap,), lambda gap: gap * ar.eps)


def value_at(coefficients: Sequence[Any], x: Any) -> Any:
    """Return the polynomial with these coefficients, the lowest power first, at x."""
    return reduce(lambda value, coefficient: value * x + coefficient, reversed(coefficients))


def _in_roots_of_unity(coefficients: Sequence[Fraction]) -> list[Fraction]:
    """Return z^d P((z + 1/z)/2) for a polynomial P of degree d."""
    degree = len(coefficients) - 1
    half, total, power = Polynomial(Fraction(1, 2), 0, Fraction(1, 2)), Polynomial(0), Polynomial(1)
    for j, coefficient in enumerate(coefficients):
        shift = Polynomial(*[0] * (degree - j), coefficient)
        total, power = total + power * shift, power * half
    return [Fraction(x) for x in total.coefficients]


@lru_cache(maxsize=256)
def cyclotomic(n: int) -> tuple[Fraction, ...]:
    """Return the cyclotomic polynomial of n, the lowest power first: x^n - 1 over those of the
    proper divisors of n."""
    quotient = [Fraction(-1)] + [Fraction(0)] * (n - 1) + [Fraction(1)]
    for divisor in range(1, n):
        if n % divisor == 0:
            quotient = _divided(quotient, cyclotomic(divisor))[0]
    return tuple(quotient)


def _remainder(dividend: Sequence[Fraction], divisor: Sequence[Fraction]) -> list[Fraction]:
    return _divided(dividend, divisor)[1]


def _divided(
    dividend: Sequence[Fraction], divisor: Sequence[Fraction]
) -> tuple[list[Fraction], list[Fraction]]:
    """Return quotient and remainder by a polynomial whose leading coefficient is 1."""
    rest, size = list(dividend), len(divisor) - 1
    quotient = [Fraction(0)] * max(len(rest) - size, 1)
    for i in range(len(rest) - 1, size - 1, -1):
        quotient[i - size] = factor = rest[i]
        if factor:
            for j, coefficient in enumerate(divisor):
                rest[i - size + j] -= factor * coefficient
    return quotient, rest[:size]
