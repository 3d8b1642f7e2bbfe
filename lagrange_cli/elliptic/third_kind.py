"""The Omega and Pi functions of Chrapan's sections 2 and 3, which are integrals of the third kind.

    Omega_ij(eta, v) = log[Theta_ij(eta - v)/Theta_ij(eta + v)]/2,   Pi_ij = eta Z_ij(v) + Omega_ij

The logarithm would lose digits if both theta functions nearly agree, and so would Pi if eta Z and
Omega cancel.  So the constants of the modulus and the parameter v are computed once, in many
digits.  The functions of eta are arranged so that nothing cancels.  Theta(eta -+ v) is split into P
+- Q, and the growth of Pi over a period is one constant.

Parameters in many digits and in doubles obey the same formulas, over balls and over arrays.

The classes below are for an imaginary parameter i alpha, |alpha| < K'.  Both functions are divided
by i, so that they are real.  Omega is the phase of theta(x - i y), continuous in x = eta/2K, where
y = alpha/2K.  The phase of the odd function grows by half a turn per period.  For alpha > 0 it is
-pi/2 at x = 0, as in (2,5).  Both functions are odd in alpha, so y > 0 below."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
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
from .theta import in_periods, series_for, widened_by, zeta_at
from .third_kind_real import RealCircular, RealHyperbolic, ThirdKind, ZeroParameter


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
        return ZeroParameter(ij)
    terms = 3 + int(math.sqrt(negligible(ar) / math.pi))
    odd = ij[0] == "1"
    if imaginary:
        y = size * series.rate
        if series.circular:
            return ImaginaryCircular.at(ar, ij, y, series.q, terms)
        return ImaginaryHyperbolic.at(ar, ij, y, series.steepness, terms)
    y = in_periods(ar, size, series).rest
    if ij[1] == "0":
        y = Periods(0, y).half_further(ar).rest
    if series.circular:
        zeta = zeta_at(ar, f"{ij[0]}1", Periods(0, abs(y)), series) / series.rate
        return RealCircular.at(ar, odd, y, zeta, series.q, terms=terms)
    return RealHyperbolic.at(ar, odd, y, series.steepness, terms)


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
        make = partial(third_kind, ij=ij, imaginary=bool(imag))

        def rounded(digits: int) -> ThirdKind:
            exact, size = balls(digits), float(imag or real)
            many = in_many_digits(exact, given)
            return make(exact, size=exact.convert(size), modulus=many).rounded()

        if ar.is_array:
            kind = decided("the constants of the parameter", rounded)
        else:
            kind = make(ar, size=imag or real, modulus=given)
        value = getattr(kind, name)(ar, in_periods(ar, eta, series_for(ar, given)))
        return ar.mpc(0 * value, value) if imag else value

    eta, v = place
    if not ar.is_array:
        eta, v = ar.convert(eta), ar.convert(v)
    return each_alone(ar, function, eta, v, *modulus)


@dataclass(frozen=True)
class ImaginaryCircular(ThirdKind):
    """The parameter for k <= k', where the series run in the nome q."""

    odd: bool
    shifted: bool
    """Whether the series are evaluated at x + 1/2."""
    sign: int
    """Sign of alpha."""
    zeta: Numeric
    """2K Z(i |alpha|)/i."""
    growth: Numeric
    """Growth of Pi per period: zeta, with half a turn for the odd function."""
    floor: Numeric
    """theta01(i y) for the even function; it vanishes with K' - alpha."""
    heights: tuple[Numeric, ...]
    """Coefficients that contain cosh."""
    slants: tuple[Numeric, ...]
    """Coefficients that contain sinh."""
    left_out: Numeric
    """A bound on the truncation error of each series."""

    @classmethod
    def at(
        cls, ar: FunctionArithmetic, ij: str, y: Numeric, q: Numeric, terms: int
    ) -> ImaginaryCircular:
        """Return the constants from y = alpha/2K and the nome.

        As 2 pi |y| <= log(1/q), the terms of the sums from h = N on are at most 4 q^(N(N-1)).  The
        terms of the slopes are at most (2 N + 1) pi times as large.  Each term is less than half of
        the one before.
        """
        odd, shifted, size = ij[0] == "1", ij[1] == "0", abs(y)
        orders = range(terms) if odd else range(1, terms)
        rates = [(2 * h + odd) * ar.pi for h in orders]
        if odd:
            weights = [(-1) ** h * q ** (h * (h + 1)) / ar.cosh(ar.pi * size) for h in orders]
        else:
            weights = [2 * (-1) ** h * q ** (h * h) for h in orders]
        heights = [w * ar.cosh(rate * size) for w, rate in zip(weights, rates, strict=True)]
        slants = [w * ar.sinh(rate * size) for w, rate in zip(weights, rates, strict=True)]
        signs = [(-1) ** h if shifted else 1 for h in orders]  # of the function half a period on
        left_out = 8 * q ** (terms * (terms - 1))
        value, slope = (slants, heights) if ij == "11" else (heights, slants)
        total = sum(map(mul, signs, value), 0 if odd else ar.convert(1))
        rising = sum(map(mul, map(mul, signs, slope), rates))
        zeta = -widened_by(ar, rising, 4 * (2 * terms + 1) * left_out)
        zeta = zeta / widened_by(ar, total, left_out)
        floor = widened_by(ar, 1 + sum(heights), left_out)
        if not odd:
            heights = [-2 * height for height in heights]
        growth, sign = zeta + ar.pi if odd else zeta, -1 if y < 0 else 1
        parts = tuple(heights), tuple(slants), 2 * left_out
        return cls(odd, shifted, sign, zeta, growth, floor, *parts)

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return the phase of the theta function."""
        half_turns, within = self._phase(ar, x)
        return self.sign * (ar.pi * half_turns + within)

    def pi(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi, from its growth over whole periods and its value within one."""
        half_turns, within = self._phase(ar, x)
        if self.odd:
            within = within + ar.pi * (half_turns - x.turns)
        return self.sign * (self.growth * x.turns + (self.zeta * x.rest + within))

    def _phase(self, ar: FunctionArithmetic, x: Periods) -> tuple[Numeric, Numeric]:
        """Return the whole half turns of the phase, and the rest."""
        turns, rest, _ = x.half_further(ar) if self.shifted else x
        series = list(enumerate(zip(self.heights, self.slants, strict=True)))
        if self.odd:
            across = sum(a * ar.sin((2 * h + 1) * ar.pi * rest) for h, (a, _) in series)
            along = sum(b * ar.cos((2 * h + 1) * ar.pi * rest) for h, (_, b) in series)
            return turns, self._angle(ar, across, along) - ar.pi / 2
        along = self.floor + sum(a * ar.sin((h + 1) * ar.pi * rest) ** 2 for h, (a, _) in series)
        across = sum(b * ar.sin(2 * (h + 1) * ar.pi * rest) for h, (_, b) in series)
        return 0 * turns, self._angle(ar, across, along)

    def _angle(self, ar: FunctionArithmetic, across: Numeric, along: Numeric) -> Numeric:
        """Return the angle of two sums, widened by their truncation errors."""
        return ar.atan2(*(widened_by(ar, x, self.left_out) for x in (across, along)))

    def rounded(self, **others: Any) -> Self:
        """Return the parameter with its constants in doubles."""
        return super().rounded(left_out=0.0, **others)


@dataclass(frozen=True)
class ImaginaryHyperbolic(ThirdKind):
    """The parameter for k > k', where the theta functions are sums of Gaussians.

        theta(x - i y) = exp(2 i c x y) times the sum over n > 0 of exp(-c n^2) f(2 c n (x - i y))

    The function f is cosh or sinh, and n runs over half-integers or, for 00 and 10, over integers.
    The steepness is c = pi K/K'.
    """

    ij: str
    sign: int
    """Sign of alpha."""
    steepness: Numeric
    turn: Numeric
    """2 c y = pi |alpha|/K', less than pi."""
    slope: Numeric
    """Z of the sum alone: 2K Z(i |alpha|)/i + 2 c y."""
    growth: Numeric
    """Growth of Pi per period: 2K Z(i |alpha|)/i, with half a turn for the odd function."""
    cosines: tuple[Numeric, ...]
    """cos 2 c n y."""
    sines: tuple[Numeric, ...]
    """sin 2 c n y."""

    @classmethod
    def at(
        cls, ar: FunctionArithmetic, ij: str, y: Numeric, steepness: Numeric, terms: int
    ) -> ImaginaryHyperbolic:
        """Return the constants from y = alpha/2K and the steepness."""
        c, half_turn = steepness, steepness * abs(y)
        orders = [ar.convert(2 * i + 1 if ij[1] == "1" else 2 * i) / 2 for i in range(terms)]
        signs = [(-1) ** i if ij[0] == "1" else 1 for i in range(terms)]
        cosines = tuple(ar.cos(2 * n * half_turn) for n in orders)
        sines = tuple(ar.sin(2 * n * half_turn) for n in orders)
        first = orders[0] ** 2
        bells = [ar.exp(-c * (n * n - first)) for n in orders]
        if ij[1] == "0":
            bells[0] /= 2  # it is its own image
        parts = list(zip(map(mul, signs, bells), orders, cosines, sines, strict=True))
        if ij == "11":
            rise = -sum(weight * 2 * c * n * cosine for weight, n, cosine, _ in parts)
            total = sum(weight * sine for weight, _, _, sine in parts)
        else:
            rise = sum(weight * 2 * c * n * sine for weight, n, _, sine in parts)
            total = sum(weight * cosine for weight, _, cosine, _ in parts)
        # from i = N on the terms are at most exp(-c N^2) and 2 c (N + 1) times that
        bell = 2 * ar.exp(-c * (terms * terms))
        rise = widened_by(ar, rise, 2 * c * (terms + 1) * bell)
        slope, turn = rise / widened_by(ar, total, bell), 2 * half_turn
        growth = slope - turn + ar.pi if ij[0] == "1" else slope - turn
        return cls(ij, -1 if y < 0 else 1, c, turn, slope, growth, cosines, sines)

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return the phase of the theta function."""
        half_turns = ar.pi * x.turns if self.ij[0] == "1" else 0 * x.turns
        return self.sign * (half_turns + (self.turn * x.rest + self._phase(ar, x.rest)))

    def pi(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi, from its growth over whole periods and its value within one."""
        within = self.slope * x.rest + self._phase(ar, x.rest)
        return self.sign * (self.growth * x.turns + within)

    def _phase(self, ar: FunctionArithmetic, rest: Numeric) -> Numeric:
        """Return the phase of the sum alone, within a period."""
        c, size, half = self.steepness, abs(rest), self.ij[1] == "1"
        plus = minus = 0 * size, 0 * size
        for i, (cosine, sine) in enumerate(zip(self.cosines, self.sines, strict=True)):
            sign = (-1) ** i if self.ij[0] == "1" else 1
            bell = sign * ar.exp(-c * i * (i + (1 if half else 0) - 2 * size))
            image = ar.expm1(-2 * c * (2 * i + 1 if half else 2 * i) * size)
            both = bell * (2 + image) if i or half else 1 + 0 * size
            plus = plus[0] + both * cosine, plus[1] + both * sine
            minus = minus[0] - bell * image * cosine, minus[1] - bell * image * sine
        terms = len(self.cosines)  # from i = N on they are at most 2 exp(-c N(N - 1))
        bell = 4 * ar.exp(-c * (terms * (terms - 1)))
        if self.ij != "11":
            across, along = widened_by(ar, minus[1], bell), widened_by(ar, plus[0], bell)
            return -ar.sign(rest) * ar.atan2(across, along)
        across, along = widened_by(ar, plus[1], bell), widened_by(ar, minus[0], bell)
        turned = ar.atan2(across, along)
        return ar.where(rest < 0, turned - ar.pi, -turned)

    def rounded(self, **others: Any) -> Self:
        """Return the parameter with its constants in doubles, of which fewer are needed."""
        few = {"cosines": self.cosines[:5], "sines": self.sines[:5]}
        return super().rounded(**few, **others)
