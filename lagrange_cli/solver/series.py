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

COS_ODD, SIN_ODD, COS_EVEN, SIN_EVEN = ([1], [1, -4]), ([1], [3, -4]), ([1], [1, -2]), ([0], [2])
"""The first two polynomials of cos (2n+1)x, sin (2n+1)x, cos 2nx and sin 2nx, over C, S or S C.

The next ones are P(n+1) = (2 - 4 s) P(n) - P(n-1).
"""
TERMS = 4
"""Terms of the series that are enough for doubles."""
_BITS = 85
"""Bits to which a constant is known before it is rounded to a double."""
_NEGLIGIBLE = 2.0**-60
"""Largest size of an omitted term, over the first term."""
_SIZE = 16
"""Binary exponent of the largest coefficient about a turning point."""


class Frame(NamedTuple):
    """The series about one turning point: coefficients of polynomials, the lowest power first."""

    at_u1: bool
    parts: list[list[float]]
    """Re X, Im X, Re Y, Im Y, with any common factor."""
    rate: list[float]
    """S C times this is 2 (|X|^2 + |Y|^2) |X| |Y| times the nutation rate."""


def near(x: arb) -> float:
    """Return the double next to a number; raise TooFewDigitsError unless 85 bits are known."""
    if not (x.is_zero() or x.rel_accuracy_bits() >= _BITS):
        raise TooFewDigitsError
    return float(x.mid()) + 0.0  # no -0


def theta_series(of: Nutation) -> tuple[list[Frame], arb, list[arb]]:
    """Return the series of a nutating top about u1 and about u2, in the smaller nome.

    They are followed by the argument of the functions per half period, and by the slopes per half
    period that are added to arg X and arg Y to make them periodic.  Raises TooFewDigitsError if a
    coefficient is not known well enough to be rounded to a double.
    """
    pi, hyperbolic = arb.pi(), of.hyperbolic
    stretch = 1 / of.ratio if hyperbolic and of.ratio is not None else arb(1)
    nome = arb(0) if of.ratio is None else (-pi * (stretch if hyperbolic else of.ratio)).exp()
    x, y = (_polynomials(side, nome, hyperbolic) for side in of.sides)
    # N^2 sin(theta) theta', N = |X|^2 + |Y|^2, is theta1(2x) times a number.  N is 1 at u1, so the
    # slope is -u'' there.
    weights = [arb(0), arb(1), arb(0), -(nome**2), arb(0), nome**6, arb(0), -(nome**12)]
    at_0 = sum(2 * n * w for n, w in enumerate(weights))
    unit = of.period * of.acceleration / (pi * stretch) / at_0
    rate = unit * _summed(SIN_EVEN, weights, hyperbolic)
    scale = pi / 2 * stretch
    most = scale.exp() / 4 if hyperbolic else arb(0.5)
    frames = [_frame(True, x[:2] + y[2:], rate, most), _frame(False, x[2:] + y[:2], -rate, most)]
    turns = [arb(0.5) - (side.place if hyperbolic else 0) for side in of.sides]
    slopes = [-side.sign * pi * turn for side, turn in zip(of.sides, turns, strict=True)]
    return frames, scale, slopes


def _polynomials(side: Side, nome: arb, hyperbolic: bool) -> list[arb_poly]:
    """Return real and imaginary part of X or Y about its own turning point, and the other one."""
    angles = [side.place * k for k in range(2 * TERMS)]  # multiples of y
    both = [arb.sin_cos_pi(x) if hyperbolic else (arb.pi() * x).sinh_cosh() for x in angles]
    sines, cosines = zip(*both, strict=True)
    signs, w = [1, -1, 1, -1], [nome ** (n * (n + 1)) for n in range(TERMS)]
    own = (COS_ODD, w, cosines[1::2]), (SIN_ODD, w, sines[1::2])
    if hyperbolic:
        w = [2 * root(root(nome)) * x for x in w]
        even = [arb(1), *(2 * signs[n] * nome ** (n * n) for n in range(1, TERMS))]
        own = (COS_EVEN, even, cosines[::2]), (SIN_EVEN, [-x for x in even], sines[::2])
    w = [sign * x for sign, x in zip(signs, w, strict=True)]
    rows = *own, (COS_ODD, w, sines[1::2]), (SIN_ODD, w, cosines[1::2])
    products = [[x * y for x, y in zip(*row, strict=True)] for _, *row in rows]
    unit = side.size / sum(products[0])
    sums = [
        _summed(row[0], weights, hyperbolic) for row, weights in zip(rows, products, strict=True)
    ]
    return [x * unit * (side.sign if i % 2 else 1) for i, x in enumerate(sums)]


def _summed(first: Sequence[list[int]], weights: Sequence[arb], hyperbolic: bool) -> arb_poly:
    """Return a weighted sum of polynomials; hyperbolic ones have -s for s."""
    s = arb_poly([0, -1 if hyperbolic else 1])
    before, now = (arb_poly(x)(s) for x in first)
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
        large = [n for n, size in enumerate(sizes) if size > sizes[0] * _NEGLIGIBLE]
        return [near(x) for x in terms[: max([1, *large]) + 1]]

    return Frame(at_u1, [kept(part, factor) for part in parts], kept(rate, factor**4))
