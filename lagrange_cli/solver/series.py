"""The theta series of the attitude as polynomials with coefficients in doubles.

With y = pi `place`, x = pi z counted from a turning point, s the `sign` and q the nome, the own
turning point of X or Y and the other one have the series

    theta2(x - i s y)     = sum w cos (2n+1)(x - i s y),          w = q^(n(n+1))
    i s theta1(x - i s y) = i s sum (-1)^n w sin (2n+1)(x - i s y)

apart from 2 q^(1/4).  If K > K', Jacobi's imaginary transformation gives series in the nome q' =
exp(-pi K/K') and in the argument x K/K':

    theta4(s y + i x) = 1 + 2 sum (-1)^n q'^(n^2) cos 2n (s y + i x)
    theta1(s y + i x) = 2 q'^(1/4) sum (-1)^n w sin (2n+1)(s y + i x)

apart from a common factor with an argument proportional to x.  The nome in use is at most exp(-pi),
so that four terms are enough for doubles.

Cosines and sines of multiples of x are polynomials in s = sin^2 x.  Circular series leave out the
factor cos x, so that the real part of X or Y is P(s) and its imaginary part is S Q(s) with S = tan
x.  Hyperbolic series have S = sinh x, C = cosh x and s = S^2.  About the own turning point their
parts are P(s) and S C Q(s), about the other one C P(s) and S Q(s).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from flint import arb, arb_poly

from ..arithmetic.enclosures import TooFewDigitsError, root
from .attitude import Nutation, Side

Family = tuple[list[int], list[int]]
"""The first two polynomials in s, over C, S or S C; P(n+1) = (2 - 4 s) P(n) - P(n-1)."""
COS_ODD: Family = [1], [1, -4]
"""cos (2n+1)x"""
SIN_ODD: Family = [1], [3, -4]
"""sin (2n+1)x"""
COS_EVEN: Family = [1], [1, -2]
"""cos 2nx"""
SIN_EVEN: Family = [0], [2]
"""sin 2nx"""

TERMS = 4
"""Terms of the series that are enough for doubles."""
_BITS = 85
"""Bits to which a constant is known before it is rounded to a double."""
_NEGLIGIBLE = 2.0**-60
"""Size of a term that is left out, over that of the first one."""
_SIZE = 16
"""Binary exponent of the largest coefficient about a turning point."""


class Frame(NamedTuple):
    """The series about one turning point: coefficients of polynomials, the lowest power first."""

    at_u1: bool
    parts: tuple[list[float], ...]
    """Re X, Im X, Re Y, Im Y, with any common factor."""
    rate: list[float]
    """S C times this is 2 (|X|^2 + |Y|^2) |X| |Y| times the nutation rate."""


class Series(NamedTuple):
    """The series of a motion."""

    frames: tuple[Frame, Frame]
    """The series about u1 and about u2."""
    scale: arb
    """Argument of the functions per half period."""
    slopes: tuple[arb, arb]
    """Slopes per half period that are added to arg X and arg Y to make them periodic."""


def near(x: arb) -> float:
    """Return the double next to a number; raise TooFewDigitsError unless 85 bits are known."""
    if not (x.is_zero() or x.rel_accuracy_bits() >= _BITS):
        raise TooFewDigitsError
    return float(x.mid()) + 0.0  # no -0


def theta_series(of: Nutation) -> Series:
    """Return the series of a nutating top in the smaller nome.

    Raises TooFewDigitsError if a coefficient is not known well enough to be rounded to a double.
    """
    pi, stretch = arb.pi(), 1 / of.ratio if of.hyperbolic and of.ratio is not None else arb(1)
    nome = arb(0) if of.ratio is None else (-pi * (stretch if of.hyperbolic else of.ratio)).exp()
    x, y = (_polynomials(side, nome, of.hyperbolic) for side in of.sides)
    # theta1(2x), with the slope of sin(theta) theta' at u1, where |X|^2 + |Y|^2 is 1
    weights = [arb(0), arb(1), arb(0), -(nome**2), arb(0), nome**6, arb(0), -(nome**12)]
    unit = of.period * of.bend / (pi * stretch) / sum(2 * n * w for n, w in enumerate(weights))
    rate = unit * _summed(SIN_EVEN, weights, of.hyperbolic)
    scale = pi / 2 * stretch
    most = scale.exp() / 4 if of.hyperbolic else arb(0.5)
    frames = (
        _frame(True, (*x[:2], *y[2:]), rate, most),
        _frame(False, (*x[2:], *y[:2]), -rate, most),
    )
    turns = [arb(0.5) - (side.place if of.hyperbolic else 0) for side in of.sides]
    x_slope, y_slope = (-s.sign * pi * turn for s, turn in zip(of.sides, turns, strict=True))
    return Series(frames, scale, (x_slope, y_slope))


def _polynomials(side: Side, nome: arb, hyperbolic: bool) -> list[arb_poly]:
    """Return real and imaginary part of X or Y about its own turning point, and the other one."""

    def multiples(first: int) -> tuple[list[arb], list[arb]]:
        """Return sines and cosines, or hyperbolic ones, of every second multiple of y."""
        places = [side.place * (2 * n + first) for n in range(TERMS)]
        both = [arb.sin_cos_pi(x) if hyperbolic else (arb.pi() * x).sinh_cosh() for x in places]
        return [sine for sine, _ in both], [cosine for _, cosine in both]

    signs, odd = [(-1) ** n for n in range(TERMS)], [nome ** (n * (n + 1)) for n in range(TERMS)]
    sine, cosine = multiples(1)
    own = (COS_ODD, odd, cosine), (SIN_ODD, odd, sine)
    if hyperbolic:
        odd = [2 * root(root(nome)) * x for x in odd]
        even = [2 * sign * nome ** (n * n) for n, sign in enumerate(signs)]
        even[0] = arb(1)
        sine_even, cosine_even = multiples(0)
        own = (COS_EVEN, even, cosine_even), (SIN_EVEN, [-x for x in even], sine_even)
    odd = [sign * x for sign, x in zip(signs, odd, strict=True)]
    rows = [
        (family, [w * x for w, x in zip(ws, xs, strict=True)])
        for family, ws, xs in (*own, (COS_ODD, odd, sine), (SIN_ODD, odd, cosine))
    ]
    unit = side.size / sum(rows[0][1])
    factors = (unit, side.sign * unit) * 2
    return [x * _summed(*row, hyperbolic) for x, row in zip(factors, rows, strict=True)]


def _summed(family: Family, weights: Sequence[arb], hyperbolic: bool) -> arb_poly:
    """Return a weighted sum of the polynomials of a family; hyperbolic ones have -s for s."""
    s = arb_poly([0, -1 if hyperbolic else 1])
    before, now = (arb_poly(first)(s) for first in family)
    total = weights[0] * before
    for weight in weights[1:]:
        total += weight * now
        before, now = now, (2 - 4 * s) * now - before
    return total


def _frame(at_u1: bool, parts: Sequence[arb_poly], rate: arb_poly, most: arb) -> Frame:
    """Return series in doubles, without negligible terms; `most` is the largest value of s.

    X and Y may have any common factor; here it makes their largest coefficient about 2^16.
    """
    factor = arb(2) ** (_SIZE - math.frexp(max(abs(float(part[0].mid())) for part in parts))[1])

    def kept(series: arb_poly, factor: arb) -> list[float]:
        terms = [series[n] * factor for n in range(2 * TERMS)]
        sizes = [abs(float((x * most**n).mid())) for n, x in enumerate(terms)]
        last = max((n for n, size in enumerate(sizes) if size > sizes[0] * _NEGLIGIBLE), default=0)
        return [near(x) for x in terms[: max(last, 1) + 1]]

    return Frame(at_u1, tuple(kept(part, factor) for part in parts), kept(rate, factor**4))
