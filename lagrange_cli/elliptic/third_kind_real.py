"""Omega and Pi of a real parameter v: y = v/2K, and x = eta/2K is a place in the periods.

Both functions are odd in x and in y and, except for the growth of Pi, periodic.  The formulas are
therefore in |x| and |y| up to 1/2.  The functions 00 and 10 are 01 and 11 of v + K.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any, Self

from ..arithmetic.ball import Ball
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..arithmetic.rounding import pair
from .periods import Periods
from .theta import widened_by


@dataclass(frozen=True)
class ThirdKind:
    """Omega and Pi of one modulus and one parameter, with constants in balls or in doubles.

    For an imaginary parameter both are imaginary, and are returned without the i.
    """

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Omega at x = eta/2K."""
        raise NotImplementedError

    def pi(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi at x = eta/2K; NaN if it has a pole for every eta."""
        raise NotImplementedError

    def rounded(self, **others: Any) -> Self:
        """Return the parameter with its constants in doubles and with `others` replaced."""
        values = {x.name: getattr(self, x.name) for x in fields(self)} | others
        return replace(self, **{name: _in_doubles(x) for name, x in values.items()})


@dataclass(frozen=True)
class ZeroParameter(ThirdKind):
    """The parameter 0, where Omega is 0 and Pi is 0 except at the pole of Z_11."""

    ij: str

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return 0."""
        return 0 * x.rest

    def pi(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return 0, or NaN for the function 11."""
        return (math.nan if self.ij == "11" else 0) * x.rest


def _in_doubles(x: Any) -> Any:
    """Convert a ball or a tuple of balls to doubles; leave other values as they are."""
    if isinstance(x, tuple):
        return tuple(map(float, x))
    return float(x) if isinstance(x, Ball) else x


def _distance(ar: FunctionArithmetic, x: Periods, size: Numeric, low: Numeric) -> Numeric:
    """Return the distance between |x| and |y|, where |y| is size + low."""
    return abs((abs(x.rest) - size) + (ar.where(x.rest < 0, -x.low, x.low) - low))


@dataclass(frozen=True)
class RealCircular(ThirdKind):
    """The parameter for k <= k', where the series run in the nome q."""

    odd: bool
    sign: int
    """Sign of y."""
    growth: Numeric
    """2K Z(|v|), the growth of Pi per period."""
    cosines: tuple[Numeric, ...]
    """Coefficients of the series of P (odd: of A) below."""
    sines: tuple[Numeric, ...]
    """Coefficients of the series of Q (odd: of B) below."""
    weights: tuple[Numeric, ...]
    """Coefficients of both, before they are multiplied by cosines and sines."""
    size: Numeric
    """|y|."""
    left_out: Numeric
    """A bound on the truncation error of each series."""
    low: Numeric = 0.0
    """The part of |y| lost to rounding."""

    @classmethod
    def at(
        cls,
        ar: FunctionArithmetic,
        odd: bool,
        y: Numeric,
        growth: Numeric,
        q: Numeric,
        *,
        terms: int,
    ) -> RealCircular:
        """Return the constants from y and the nome.

        For an even function, theta(x -+ y) = P +- Q, where Q has sines in place of the cosines of

            P = 1 + 2 sum (-1)^h q^(h^2) cos 2 pi h x cos 2 pi h y.

        For an odd function, theta(x -+ y) over 2 q^(1/4) is A -+ B, where B has cos and sin
        exchanged in

            A = sum (-1)^h q^(h(h+1)) sin (2h+1) pi x cos (2h+1) pi y.

        From h = N on, the terms are at most 2 q^(N^2), and each is less than half of the one
        before.
        """
        size, orders = abs(y), range(terms)
        if odd:
            weights = [(-1) ** h * q ** (h * (h + 1)) for h in orders]
            angles = [(2 * h + 1) * ar.pi * size for h in orders]
        else:
            weights = [2 * (-1) ** h * q ** (h * h) for h in orders[1:]]
            angles = [2 * h * ar.pi * size for h in orders[1:]]
        parts = list(zip(weights, angles, strict=True))
        cosines = tuple(weight * ar.cos(angle) for weight, angle in parts)
        sines = tuple(weight * ar.sin(angle) for weight, angle in parts)
        left_out, sign = 4 * q ** (terms * terms), -1 if y < 0 else 1
        return cls(odd, sign, growth, cosines, sines, tuple(weights), size, left_out)

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Omega: artanh Q/P or, for the odd function, -artanh B/A or -artanh A/B.

        Next to its pole, the odd function is log[(A - B)/(A + B)]/2, with A - B from the series at
        |x| - |y|.
        """
        size, side = abs(x.rest), self.sign * ar.sign(x.rest)
        series = list(enumerate(zip(self.cosines, self.sines, strict=True)))
        if not self.odd:
            P = 1 + sum(a * ar.cos(2 * (h + 1) * ar.pi * size) for h, (a, _) in series)
            Q = sum(b * ar.sin(2 * (h + 1) * ar.pi * size) for h, (_, b) in series)
            return side * ar.atanh(self._whole(ar, Q) / self._whole(ar, P))
        A = self._whole(ar, sum(a * ar.sin((2 * h + 1) * ar.pi * size) for h, (a, _) in series))
        B = self._whole(ar, sum(b * ar.cos((2 * h + 1) * ar.pi * size) for h, (_, b) in series))
        near, terms = _distance(ar, x, self.size, self.low), enumerate(self.weights)
        difference = sum(w * ar.sin((2 * h + 1) * ar.pi * near) for h, w in terms)
        close = abs(self._whole(ar, difference))
        pole, less = ar.either(2 * close < A + B), ar.either(A < B)
        ratio = ar.where(less, A, B) / ar.where(less, B, A)
        logarithm = ar.log(ar.where(pole, close / (A + B), 1 + 0 * A)) / 2
        return side * ar.where(pole, logarithm, -ar.atanh(ar.where(pole, 0 * ratio, ratio)))

    def _whole(self, ar: FunctionArithmetic, total: Numeric) -> Numeric:
        """Return a sum, widened by its truncation error."""
        return widened_by(ar, total, self.left_out)

    def pi(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi, from its growth over whole periods and its value within one."""
        return (self.sign * self.growth) * x.turns + (
            (self.sign * self.growth) * x.rest + self.omega(ar, x)
        )

    def rounded(self, **others: Any) -> Self:
        """Return the parameter with its constants in doubles."""
        return super().rounded(low=pair(self.size).low, left_out=0.0, **others)


@dataclass(frozen=True)
class RealHyperbolic(ThirdKind):
    """The parameter for k > k', where the theta functions are sums of Gaussians.

    For a in [0, 1/2], theta(a) = exp(-c (1/2 - a)^2) S(a), where c is the steepness pi K/K'.  The
    sum S is close to 1 unless a is small.  Let a = |x - y|, and let b be x + y or 1 - x - y,
    whichever is at most 1/2.  Then Omega is log[theta(a)/theta(b)]/2.
    """

    odd: bool
    sign: int
    """Sign of y."""
    growth: Numeric
    """2K Z(|v|), the growth of Pi per period."""
    size: Numeric
    """|y|."""
    room: Numeric
    """1 - 2 |y|."""
    steepness: Numeric
    slope: Numeric
    """d log S/da at |y|."""
    tilt: Numeric
    """The sum of slope and steepness, which cancel for small y."""
    terms: int
    low: Numeric = 0.0
    """The part of |y| lost to rounding."""

    @classmethod
    def at(
        cls, ar: FunctionArithmetic, odd: bool, y: Numeric, steepness: Numeric, terms: int
    ) -> RealHyperbolic:
        """Return the constants from y and the steepness."""
        size, c = abs(y), steepness
        rise = total = 0 * y
        for i in range(terms):
            sign = (-1) ** i if odd else 1
            near, far = ar.exp(-c * i * (i + 1 - 2 * size)), ar.exp(-c * (i + 1) * (i + 2 * size))
            image = -1 if odd else 1
            pair = ar.expm1(-2 * c * (2 * i + 1) * size)
            total += sign * near * (-pair if odd else 2 + pair)
            rise += sign * 2 * c * (i * near - image * (i + 1) * far)
        # from i = N on the terms are at most 2 and (4 N + 2) c times exp(-c N^2)
        bell = ar.exp(-c * (terms * terms))
        total = widened_by(ar, total, 4 * bell)
        slope = widened_by(ar, rise, (8 * terms + 4) * c * bell) / total
        room, sign = 1 - 2 * size, -1 if y < 0 else 1
        return cls(odd, sign, c * room + slope, size, room, c, slope, slope + c, terms)

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return -c small (1 - 2 large) + log[S(a)/S(b)]/2; small <= large are |x| and |y|."""
        small, room, apart = self._sorted(ar, x)
        main = -self.steepness * small * room
        return self.sign * ar.sign(x.rest) * (main + self._ratio(ar, small, room, apart))

    def pi(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi, from its growth over whole periods and its value within one."""
        size, c = abs(x.rest), self.steepness
        small, room, apart = self._sorted(ar, x)
        if ar.either(c * self.size > 1):  # the multiples of c have cancelled
            within = size * self.slope + c * ar.where(size < self.size, 0 * apart, apart)
        else:
            within = size * self.tilt - c * small
        within = within + self._ratio(ar, small, room, apart)
        return self.sign * (self.growth * x.turns + ar.sign(x.rest) * within)

    def rounded(self, **others: Any) -> Self:
        """Return the parameter with its constants in doubles, of which fewer terms are needed."""
        return super().rounded(low=pair(self.size).low, terms=4, **others)

    def _sorted(self, ar: FunctionArithmetic, x: Periods) -> tuple[Numeric, Numeric, Numeric]:
        """Return the smaller of |x| and |y|, 1 - 2 times the larger, and their distance."""
        size = abs(x.rest)
        room = (1 - 2 * size) - 2 * ar.where(x.rest < 0, -x.low, x.low)
        less = ar.either(size < self.size)
        apart = _distance(ar, x, self.size, self.low)
        return ar.where(less, size, self.size), ar.where(less, self.room, room), apart

    def _ratio(self, ar: FunctionArithmetic, small: Numeric, room: Numeric, a: Numeric) -> Numeric:
        """Return log[S(a)/S(b)]/2 from S(a) - S(b), which keeps its digits.

        S is a sum of exp(-c i (i + 1 - 2a)) and their images exp(-c (i + 1)(i + 2a)).  For the odd
        function, the signs alternate and the images are subtracted.
        """
        c = self.steepness
        apart = ar.where(ar.either(2 * small < room), 2 * small, room)
        b = a + apart
        difference = total = 0 * a
        for i in range(self.terms):
            sign = (-1) ** i if self.odd else 1
            near, image = ar.exp(-c * i * (i + 1 - 2 * b)), ar.exp(-c * (i + 1) * (i + 2 * a))
            fall, image_fall = ar.expm1(-2 * c * i * apart), ar.expm1(-2 * c * (i + 1) * apart)
            pair = ar.expm1(-2 * c * (2 * i + 1) * b)
            total = total + sign * near * (-pair if self.odd else 2 + pair)
            difference = difference + sign * (
                near * fall + (image if self.odd else -image) * image_fall
            )
        bell = 4 * ar.exp(-c * (self.terms * self.terms))  # truncation error, as in `at`
        quotient = widened_by(ar, difference, bell) / widened_by(ar, total, bell)
        if not self.odd:
            return ar.log1p(quotient) / 2
        pole = ar.either(quotient < -0.5)  # S(a) nearly vanishes
        there = self._odd_sum(ar, ar.where(pole, a, 0 * a + 0.5)) / total
        logarithm = ar.log(ar.where(pole, there, 0 * there + 1))
        return ar.where(pole, logarithm, ar.log1p(ar.where(pole, 0 * quotient, quotient))) / 2

    def _odd_sum(self, ar: FunctionArithmetic, a: Numeric) -> Numeric:
        """Return S(a) of the odd function."""
        c, total = self.steepness, 0 * a
        for i in range(self.terms):
            near = ar.exp(-c * i * (i + 1 - 2 * a))
            total = total - (-1) ** i * near * ar.expm1(-2 * c * (2 * i + 1) * a)
        return widened_by(ar, total, 4 * ar.exp(-c * (self.terms * self.terms)))
