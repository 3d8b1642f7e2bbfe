"""Omega and Pi of one parameter, in series in the nome q (for k <= k').

The parameter is v = 2Ky or, if it is imaginary, v = 2iKy; x = eta/2K is a place in the periods.
Both functions are odd in y, so y > 0 below.  For a real parameter they are odd in x as well and,
except for the growth of Pi, periodic.  The formulas are therefore in |x| and |y| up to 1/2.  The
functions 00 and 10 are 01 and 11 of v + K.

For an imaginary parameter, |y| < K'/2K, both functions are divided by i, so that they are real.
Omega is the phase of theta(x - i y), continuous in x.  The phase of the odd function grows by half
a turn per period.  For y > 0 it is -pi/2 at x = 0, as in (2,5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from operator import mul
from typing import Any, Self

from ..arithmetic.ball import Ball
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..arithmetic.rounding import pair
from .periods import Periods
from .theta import widened_by


@dataclass(frozen=True, kw_only=True)
class ThirdKind:
    """Omega and Pi of one modulus and one parameter, with constants in balls or in doubles."""

    sign: int
    """Sign of y."""
    growth: Numeric
    """Growth of Pi per period: 2K Z(v), with half a turn for the odd function of an imaginary v."""

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Omega at x = eta/2K."""
        raise NotImplementedError

    def pi_within(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi for y > 0, without its growth over whole periods."""
        raise NotImplementedError

    def pi(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi at x = eta/2K; NaN if it has a pole for every eta."""
        return self.sign * (self.growth * x.turns + self.pi_within(ar, x))

    def rounded(self, **others: Any) -> Self:
        """Return the parameter with its constants in doubles and with `others` replaced."""
        values = {x.name: getattr(self, x.name) for x in fields(self)} | others
        return replace(self, **{name: _in_doubles(x) for name, x in values.items()})


def _in_doubles(x: Any) -> Any:
    """Convert a ball or a tuple of balls to doubles; leave other values as they are."""
    if isinstance(x, tuple):
        return tuple(map(float, x))
    return float(x) if isinstance(x, Ball) else x


@dataclass(frozen=True, kw_only=True)
class ZeroParameter(ThirdKind):
    """The parameter 0, where Omega is 0, and Pi is 0 or, at the pole of Z_11, NaN."""

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return 0."""
        return 0 * x.rest

    pi_within = omega


@dataclass(frozen=True, kw_only=True)
class RealParameter(ThirdKind):
    """A real parameter."""

    odd: bool
    size: Numeric
    """|y|."""
    low: Numeric = 0.0
    """The part of |y| lost to rounding."""

    def distance(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return the distance between |x| and |y|, which keeps its digits."""
        return abs((abs(x.rest) - self.size) + (ar.where(x.rest < 0, -x.low, x.low) - self.low))

    def rounded(self, **others: Any) -> Self:
        """Return the parameter with its constants in doubles."""
        return super().rounded(low=pair(self.size).low, **others)


@dataclass(frozen=True, kw_only=True)
class Circular(ThirdKind):
    """The parameter for k <= k', where the series run in the nome q."""

    odd: bool
    heights: tuple[Numeric, ...]
    """Coefficients that contain cos 2 pi n y or, for an imaginary parameter, cosh 2 pi n y."""
    slants: tuple[Numeric, ...]
    """Coefficients that contain the sines."""
    left_out: Numeric
    """A bound on the truncation error of each series."""

    def sum_of(
        self,
        ar: FunctionArithmetic,
        wave: Callable[[Numeric], Numeric],
        coefficients: tuple[Numeric, ...],
        x: Numeric,
    ) -> Numeric:
        """Return the sum of coefficients times waves of 2 pi n x, widened by its truncation error.

        The order n is h + 1/2 for the odd function and h + 1 for the even one, for h = 0, 1...
        """
        first = 1 if self.odd else 2
        terms = (c * wave((2 * h + first) * ar.pi * x) for h, c in enumerate(coefficients))
        return widened_by(ar, sum(terms), self.left_out)


def circular(
    ar: FunctionArithmetic, ij: str, y: Numeric, q: Numeric, terms: int, *, imaginary: bool
) -> Circular:
    """Return the parameter from y and the nome, with 01 or 11 as `ij` if it is real.

    For an even function, theta(x -+ y) = P +- Q, where Q has sines in place of the cosines of

        P = 1 + 2 sum (-1)^h q^(h^2) cos 2 pi h x cos 2 pi h y.

    For an odd function, theta(x -+ y) over 2 q^(1/4) is A -+ B, where B has cos and sin exchanged
    in

        A = sum (-1)^h q^(h(h+1)) sin (2h+1) pi x cos (2h+1) pi y.

    For an imaginary parameter, the functions of y are hyperbolic, and A and B are divided by
    cosh pi y.  As 2 pi |y| <= log(1/q), the terms of the sums from h = N on are at most 4
    q^(N(N-1)).  The terms of the slopes are at most (2 N + 1) pi times as large.  Each term is less
    than half of the one before.
    """
    odd, shifted, size = ij[0] == "1", ij[1] == "0", abs(y)
    even_wave, odd_wave = (ar.cosh, ar.sinh) if imaginary else (ar.cos, ar.sin)
    orders = range(terms) if odd else range(1, terms)
    rates = [(2 * h + odd) * ar.pi for h in orders]
    if odd:
        scale = ar.cosh(ar.pi * size) if imaginary else 1
        weights = [(-1) ** h * q ** (h * (h + 1)) / scale for h in orders]
    else:
        weights = [2 * (-1) ** h * q ** (h * h) for h in orders]
    heights = tuple(w * even_wave(rate * size) for w, rate in zip(weights, rates, strict=True))
    slants = tuple(w * odd_wave(rate * size) for w, rate in zip(weights, rates, strict=True))
    left_out = 8 * q ** (terms * (terms - 1))
    signs = [(-1) ** h if shifted else 1 for h in orders]  # of the function half a period on
    value, slope = (slants, heights) if ij == "11" else (heights, slants)
    total = widened_by(ar, sum(map(mul, signs, value), 0 if odd else ar.convert(1)), left_out)
    rising = sum(map(mul, map(mul, signs, slope), rates))
    rising = widened_by(ar, rising, 4 * (2 * terms + 1) * left_out)
    zeta = (rising if odd and not imaginary else -rising) / total
    sign = -1 if y < 0 else 1
    common = {"odd": odd, "sign": sign, "slants": slants, "left_out": 2 * left_out}
    if not imaginary:
        return RealCircular(
            growth=zeta, heights=heights, weights=tuple(weights), size=size, **common
        )
    growth, floor = zeta + ar.pi if odd else zeta, widened_by(ar, 1 + sum(heights), left_out)
    if not odd:
        heights = tuple(-2 * height for height in heights)
    return ImaginaryCircular(
        growth=growth, heights=heights, shifted=shifted, zeta=zeta, floor=floor, **common
    )


@dataclass(frozen=True, kw_only=True)
class RealCircular(RealParameter, Circular):
    """A real parameter for k <= k'."""

    weights: tuple[Numeric, ...]
    """Coefficients before they are multiplied by cosines and sines."""

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Omega: artanh Q/P or, for the odd function, -artanh B/A or -artanh A/B.

        Next to its pole, the odd function is log[(A - B)/(A + B)]/2, with A - B from the series at
        |x| - |y|.
        """
        size, side = abs(x.rest), self.sign * ar.sign(x.rest)
        if not self.odd:
            P = 1 + self.sum_of(ar, ar.cos, self.heights, size)
            return side * ar.atanh(self.sum_of(ar, ar.sin, self.slants, size) / P)
        A = self.sum_of(ar, ar.sin, self.heights, size)
        B = self.sum_of(ar, ar.cos, self.slants, size)
        close = abs(self.sum_of(ar, ar.sin, self.weights, self.distance(ar, x)))
        pole, less = ar.either(2 * close < A + B), ar.either(A < B)
        ratio = ar.where(less, A, B) / ar.where(less, B, A)
        logarithm = ar.log(ar.where(pole, close / (A + B), 1 + 0 * A)) / 2
        return side * ar.where(pole, logarithm, -ar.atanh(ar.where(pole, 0 * ratio, ratio)))

    def pi_within(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi for y > 0, without its growth over whole periods."""
        return self.growth * x.rest + self.sign * self.omega(ar, x)


@dataclass(frozen=True, kw_only=True)
class ImaginaryCircular(Circular):
    """An imaginary parameter for k <= k'."""

    shifted: bool
    """Whether the series are evaluated at x + 1/2."""
    zeta: Numeric
    """2K Z(i |alpha|)/i."""
    floor: Numeric
    """theta01(i y) for the even function; it vanishes with K' - alpha."""

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return the phase of the theta function."""
        half_turns, within = self._phase(ar, x)
        return self.sign * (ar.pi * half_turns + within)

    def pi_within(self, ar: FunctionArithmetic, x: Periods) -> Numeric:
        """Return Pi for y > 0, without its growth over whole periods."""
        half_turns, within = self._phase(ar, x)
        if self.odd:
            within = within + ar.pi * (half_turns - x.turns)
        return self.zeta * x.rest + within

    def _phase(self, ar: FunctionArithmetic, x: Periods) -> tuple[Numeric, Numeric]:
        """Return the whole half turns of the phase, and the rest."""
        turns, rest, _ = x.half_further(ar) if self.shifted else x
        if self.odd:
            across = self.sum_of(ar, ar.sin, self.heights, rest)
            return turns, ar.atan2(across, self.sum_of(ar, ar.cos, self.slants, rest)) - ar.pi / 2
        rise = self.sum_of(ar, lambda angle: ar.sin(angle / 2) ** 2, self.heights, rest)
        across = self.sum_of(ar, ar.sin, self.slants, rest)
        return 0 * turns, ar.atan2(across, self.floor + rise)
