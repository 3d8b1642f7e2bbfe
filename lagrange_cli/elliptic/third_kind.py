"""The Omega and Pi functions of Chrapan's sections 2 and 3, which are integrals of the third kind.

    Omega_ij(eta, v) = log[Theta_ij(eta - v)/Theta_ij(eta + v)]/2,   Pi_ij = eta Z_ij(v) + Omega_ij

The logarithm would lose digits if both theta functions nearly agree, and so would Pi if eta Z and
Omega cancel.  So the constants of the modulus and the parameter v are computed once, in many
digits.  The functions of eta are arranged so that nothing cancels.

The conventions and the series for k <= k' are in `third_kind_series`.  The classes below are for
k > k', where theta functions are sums of Gaussians with the steepness c = pi K/K'.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from operator import mul
from typing import Any, Self

from ..arithmetic.balls import balls
from ..arithmetic.numbers import in_arithmetic
from ..arithmetic.protocol import ComplexArithmetic, FunctionArithmetic, Numeric
from ..arithmetic.rounding import decided
from ..errors import LagtopError
from .complete import complete_k
from .modulus import Modulus, in_many_digits
from .periods import Complex, Periods, each_alone, negligible
from .theta import in_periods, series_for, widened_by
from .third_kind_series import RealParameter, ThirdKind, ZeroParameter, circular


def third_kind(
    ar: FunctionArithmetic, ij: str, size: Numeric, modulus: Modulus, *, imaginary: bool
) -> ThirdKind:
    """Return Omega_ij and Pi_ij of a parameter, with constants in balls or an mpmath context.

    The parameter is `size`, or i times `size` if `imaginary`.  Raises LagtopError for k = 1, and
    for an imaginary parameter whose size is K' or more.
    """
    if imaginary and modulus.k and abs(size) >= (limit := complete_k(ar, modulus.k)):
        most, got = (float(getattr(x, "middle", x)) for x in (limit, size))
        raise LagtopError(
            f"param must be smaller than K' = {most:.6g} in size if it is imaginary, "
            f"got {got:.6g}i",
            "param",
        )
    series = series_for(ar, modulus)
    if not size:
        return ZeroParameter(sign=1, growth=math.nan if ij == "11" else 0)
    terms = 3 + int(math.sqrt(negligible(ar) / math.pi))
    if imaginary:
        y = size * series.rate
    else:
        place = in_periods(ar, size, series)
        y = (place if ij[1] == "1" else Periods(0, place.rest).half_further(ar)).rest
        ij = f"{ij[0]}1"
    if series.circular:
        return circular(ar, ij, y, series.q, terms, imaginary=imaginary)
    make = ImaginaryHyperbolic.at if imaginary else RealHyperbolic.at
    return make(ar, ij, y, series.steepness, terms)


@in_arithmetic
def omega(ar: ComplexArithmetic, ij: str, eta: Numeric, v: Complex, modulus: Modulus) -> Complex:
    """Return Omega_ij(eta, v) of section 2, for real eta.

    - For real v, return the real part.
    - For imaginary v = i alpha, |alpha| < K', return i times a phase that is continuous in eta.  If
      `ij` is 11 and alpha > 0, the phase is -pi/2 at eta = 0, as in (2,5).

    Arrays are evaluated for one pair of modulus and parameter at a time.  Raises LagtopError for
    other v and for k = 1.
    """
    return _evaluate(ar, "omega", ij, (eta, v), modulus)


@in_arithmetic
def pi_function(
    ar: ComplexArithmetic, ij: str, eta: Numeric, v: Complex, modulus: Modulus
) -> Complex:
    """Return Pi_ij(eta, v) = eta Z_ij(v) + Omega_ij(eta, v), (3,1) and (3,2), as `omega` does."""
    return _evaluate(ar, "pi", ij, (eta, v), modulus)


def _evaluate(
    ar: Any, name: str, ij: str, place: tuple[Numeric, Complex], modulus: Modulus
) -> Complex:
    """Return Omega or Pi of numbers of a context, or of arrays that broadcast."""

    def function(eta: Numeric, v: Complex, *parts: Numeric) -> Complex:
        given, real, imag = Modulus(*parts), ar.re(v), ar.im(v)
        if imag and real:
            raise LagtopError("param must be real or imaginary", "param")

        def rounded(digits: int) -> ThirdKind:
            exact = balls(digits)
            size, many = exact.convert(float(imag or real)), in_many_digits(exact, given)
            return third_kind(exact, ij, size, many, imaginary=bool(imag)).rounded()

        if ar.is_array:
            kind = decided("the constants of the parameter", rounded)
        else:
            kind = third_kind(ar, ij, imag or real, given, imaginary=bool(imag))
        value = getattr(kind, name)(ar, in_periods(ar, eta, series_for(ar, given)))
        return ar.mpc(0 * value, value) if imag else value

    places = place if ar.is_array else map(ar.convert, place)
    return each_alone(ar, function, *places, *modulus)


@dataclass(frozen=True, kw_only=True)
class ImaginaryHyperbolic(ThirdKind):
    """An imaginary parameter for k > k'.

        theta(x - i y) = exp(2 i c x y) times the sum over n > 0 of exp(-c n^2) f(2 c n (x - i y))

    The function f is cosh or sinh, and n runs over half-integers or, for 00 and 10, over integers.
    """

    ij: str
    steepness: Numeric
    turn: Numeric
    """2 c y = pi |alpha|/K', less than pi."""
    slope: Numeric
    """Z of the sum alone: 2K Z(i |alpha|)/i + 2 c y."""
    even: tuple[Numeric, ...]
    """cos 2 c n y; sin 2 c n y for the function 11."""
    odd: tuple[Numeric, ...]
    """sin 2 c n y; cos 2 c n y for the function 11."""

    @classmethod
    def at(
        cls, ar: FunctionArithmetic, ij: str, y: Numeric, steepness: Numeric, terms: int
    ) -> ImaginaryHyperbolic:
        """Return the constants from y = alpha/2K and the steepness."""
        c, turn = steepness, 2 * steepness * abs(y)
        orders = [ar.convert(2 * i + 1 if ij[1] == "1" else 2 * i) / 2 for i in range(terms)]
        signs = [(-1) ** i if ij[0] == "1" else 1 for i in range(terms)]
        cosines, sines = (tuple(wave(n * turn) for n in orders) for wave in (ar.cos, ar.sin))
        even, odd = (sines, cosines) if ij == "11" else (cosines, sines)
        bells = [ar.exp(-c * (n * n - orders[0] ** 2)) for n in orders]
        if ij[1] == "0":
            bells[0] /= 2  # it is its own image
        weights = list(map(mul, signs, bells))
        rise = 2 * c * sum(map(mul, weights, map(mul, orders, odd))) * (-1 if ij == "11" else 1)
        # from i = N on the terms are at most exp(-c N^2) and 2 c (N + 1) times that
        bell = 2 * ar.exp(-c * (terms * terms))
        total = widened_by(ar, sum(map(mul, weights, even)), bell)
        slope = widened_by(ar, rise, 2 * c * (terms + 1) * bell) / total
        growth, sign = slope - turn + ar.pi if ij[0] == "1" else slope - turn, -1 if y < 0 else 1
        known = {"sign": sign, "growth": growth, "steepness": c, "turn": turn, "slope": slope}
        return cls(ij=ij, even=even, odd=odd, **known)

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return the phase of the theta function."""
        half_turns = ar.pi * x.turns if self.ij[0] == "1" else 0 * x.turns
        return self.sign * (half_turns + (self.turn * x.rest + self._phase(ar, x.rest)))

    def pi_within(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi for y > 0, without its growth over whole periods."""
        return self.slope * x.rest + self._phase(ar, x.rest)

    def _phase(self, ar: FunctionArithmetic, rest: Numeric) -> Numeric:
        """Return the phase of the sum alone, within a period."""
        c, size, half = self.steepness, abs(rest), self.ij[1] == "1"
        total = apart = 0 * size
        for i, (along, across) in enumerate(zip(self.even, self.odd, strict=True)):
            sign = (-1) ** i if self.ij[0] == "1" else 1
            bell = sign * ar.exp(-c * i * (i + half - 2 * size))
            image = ar.expm1(-2 * c * (2 * i + half) * size)
            both = bell * (2 + image) if i or half else 1 + 0 * size
            total, apart = total + both * along, apart - bell * image * across
        terms = len(self.even)  # from i = N on they are at most 2 exp(-c N(N - 1))
        left_out = 4 * ar.exp(-c * (terms * (terms - 1)))
        total, apart = widened_by(ar, total, left_out), widened_by(ar, apart, left_out)
        if self.ij != "11":
            return -ar.sign(rest) * ar.atan2(apart, total)
        turned = ar.atan2(total, apart)
        return ar.where(rest < 0, turned - ar.pi, -turned)

    def rounded(self, **others: Any) -> Self:
        """Return the parameter with its constants in doubles, of which fewer are needed."""
        return super().rounded(even=self.even[:5], odd=self.odd[:5], **others)


@dataclass(frozen=True, kw_only=True)
class RealHyperbolic(RealParameter):
    """A real parameter for k > k'.

    For a in [0, 1/2], theta(a) = exp(-c (1/2 - a)^2) S(a).  The sum S is close to 1 unless a is
    small.  Let a = |x - y|, and let b be x + y or 1 - x - y, whichever is at most 1/2.  Then Omega
    is log[theta(a)/theta(b)]/2.
    """

    room: Numeric
    """1 - 2 |y|."""
    steepness: Numeric
    slope: Numeric
    """d log S/da at |y|."""
    tilt: Numeric
    """The sum of slope and steepness, which cancel for small y."""
    terms: int

    @classmethod
    def at(
        cls, ar: FunctionArithmetic, ij: str, y: Numeric, steepness: Numeric, terms: int
    ) -> RealHyperbolic:
        """Return the constants from y and the steepness."""
        odd, size, c, rise = ij[0] == "1", abs(y), steepness, 0 * y
        nears = _nears(ar, c, size, terms)
        for i, near in enumerate(nears):
            sign, far = (-1) ** i if odd else 1, ar.exp(-c * (i + 1) * (i + 2 * size))
            rise += sign * 2 * c * (i * near - (-1 if odd else 1) * (i + 1) * far)
        # from i = N on the terms are at most (4 N + 2) c times exp(-c N^2)
        rise = widened_by(ar, rise, (8 * terms + 4) * c * ar.exp(-c * (terms * terms)))
        slope, room = rise / _sum(ar, c, size, nears, odd=odd), 1 - 2 * size
        growth, sign = c * room + slope, -1 if y < 0 else 1
        known = {"sign": sign, "growth": growth, "steepness": c, "slope": slope, "tilt": slope + c}
        return cls(odd=odd, size=size, room=room, terms=terms, **known)

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return -c small (1 - 2 large) + log[S(a)/S(b)]/2; small <= large are |x| and |y|."""
        small, room, apart = self._sorted(ar, x)
        within = -self.steepness * small * room + self._ratio(ar, small, room, apart)
        return self.sign * ar.sign(x.rest) * within

    def pi_within(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi for y > 0, without its growth over whole periods."""
        size, c = abs(x.rest), self.steepness
        small, room, apart = self._sorted(ar, x)
        if ar.either(c * self.size > 1):  # the multiples of c have cancelled
            within = size * self.slope + c * ar.where(size < self.size, 0 * apart, apart)
        else:
            within = size * self.tilt - c * small
        return ar.sign(x.rest) * (within + self._ratio(ar, small, room, apart))

    def rounded(self, **others: Any) -> Self:
        """Return the parameter with its constants in doubles, of which fewer terms are needed."""
        return super().rounded(terms=4, **others)

    def _sorted(self, ar: FunctionArithmetic, x: Periods) -> tuple[Numeric, Numeric, Numeric]:
        """Return the smaller of |x| and |y|, 1 - 2 times the larger, and their distance."""
        size = abs(x.rest)
        room = (1 - 2 * size) - 2 * ar.where(x.rest < 0, -x.low, x.low)
        less = ar.either(size < self.size)
        small = ar.where(less, size, self.size)
        return small, ar.where(less, self.room, room), self.distance(ar, x)

    def _ratio(self, ar: FunctionArithmetic, small: Numeric, room: Numeric, a: Numeric) -> Numeric:
        """Return log[S(a)/S(b)]/2 from S(a) - S(b), which keeps its digits."""
        c = self.steepness
        apart = ar.where(ar.either(2 * small < room), 2 * small, room)
        b, difference = a + apart, 0 * a
        nears = _nears(ar, c, b, self.terms)
        for i, near in enumerate(nears):
            sign, image = (-1) ** i if self.odd else 1, ar.exp(-c * (i + 1) * (i + 2 * a))
            fall, image_fall = ar.expm1(-2 * c * i * apart), ar.expm1(-2 * c * (i + 1) * apart)
            difference = difference + sign * (
                near * fall + (image if self.odd else -image) * image_fall
            )
        total = _sum(ar, c, b, nears, odd=self.odd)
        left_out = 4 * ar.exp(-c * (self.terms * self.terms))  # as in `_sum`
        quotient = widened_by(ar, difference, left_out) / total
        if not self.odd:
            return ar.log1p(quotient) / 2
        pole = ar.either(quotient < -0.5)  # S(a) nearly vanishes
        there = ar.where(pole, a, 0 * a + 0.5)
        there = _sum(ar, c, there, _nears(ar, c, there, self.terms), odd=True) / total
        logarithm = ar.log(ar.where(pole, there, 0 * there + 1))
        return ar.where(pole, logarithm, ar.log1p(ar.where(pole, 0 * quotient, quotient))) / 2


def _nears(ar: FunctionArithmetic, c: Numeric, a: Numeric, terms: int) -> list[Numeric]:
    """Return the terms exp(-c i (i + 1 - 2a)) of S(a)."""
    return [ar.exp(-c * i * (i + 1 - 2 * a)) for i in range(terms)]


def _sum(
    ar: FunctionArithmetic, c: Numeric, a: Numeric, nears: list[Numeric], *, odd: bool
) -> Numeric:
    """Return S(a), the sum of the terms `nears` and of their images exp(-c (i + 1)(i + 2a)).

    For the odd function, the signs alternate and the images are subtracted.  From i = N on, the
    terms are at most 2 exp(-c N^2).
    """
    total, terms = 0 * a, len(nears)
    for i, near in enumerate(nears):
        image = ar.expm1(-2 * c * (2 * i + 1) * a)
        total = total + ((-1) ** i if odd else 1) * near * (-image if odd else 2 + image)
    return widened_by(ar, total, 4 * ar.exp(-c * (terms * terms)))
