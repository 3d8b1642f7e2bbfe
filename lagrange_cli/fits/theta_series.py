"""The theta series of the attitude as polynomials: coefficients in many digits, then doubles.

X = `cos(theta/2) exp(i (psi + phi)/2)` is proportional to theta2(x - i s+ y+), and Y =
`sin(theta/2) exp(i (psi - phi)/2)` to theta1(x - i s- y-).  Here x = pi t/T is counted from a
passage of u1.  If K <= K', the series use the nome q.  Otherwise Jacobi's imaginary transformation
gives series in q' = exp(-pi K/K').  The nome in use is at most exp(-pi), so that four terms are
enough for doubles.  The phase is counted from the nearer of u1 and u2.  Arguments therefore stay
away from the end of their branch and cannot jump.

S is sin x or sinh x, C is cos x or cosh x, and s is S^2.  The functions cos 2nx, cos(2n+1)x,
sin(2n+1)x and sin 2nx are 1, C, S and S C times a polynomial in s.  One recurrence gives all four
families.  The hyperbolic families are the same with -s.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

from ..arithmetic.ball import Balls
from ..arithmetic.numbers import Arithmetic, polynomial
from ..elliptic.complete import cosine_and_sine, hyperbolic_cosine_and_sine, nome
from ..motion.spin_precession import Nutating

Coefficients = list[Any]
"""Coefficients of a polynomial in s, the lowest power first."""

Family = tuple[tuple[int, ...], tuple[int, ...]]
"""The first two of a family of polynomials in s, which determine the others."""
COS_ODD, SIN_ODD = ((1,), (1, -4)), ((1,), (3, -4))
COS_EVEN, SIN_EVEN = ((1,), (1, -2)), ((0,), (2,))

TERMS = 4
"""Terms of the series that are enough for doubles."""


class Component(NamedTuple):
    """X or Y about one turning point.

    The real and imaginary parts are C P(s) and S Q(s), or P(s) and S C Q(s) if `even`.
    """

    real: Coefficients
    imag: Coefficients
    even: bool = False

    def at(self, S: Any, C: Any) -> tuple[Any, Any]:
        """Return the real and the imaginary part."""
        s = S * S
        P, Q = polynomial(self.real, s), polynomial(self.imag, s)
        return (P, S * C * Q) if self.even else (C * P, S * Q)


Components = tuple[Component, Component]
"""The series theta2 and theta1 of X or Y."""


class Frame(NamedTuple):
    """X, Y and S C `rate` = theta1(2x) about one turning point."""

    x: Component
    y: Component
    rate: Coefficients

    def mapped(
        self, part: Callable[[Coefficients], Any], rate: Callable[[Coefficients], Any]
    ) -> Frame:
        """Return the frame with other coefficients of X and Y, and of the rate."""
        x, y = (Component(part(c.real), part(c.imag), c.even) for c in self[:2])
        return Frame(x, y, rate(self.rate))


class SquaredRatio(NamedTuple):
    """A number eta from 0 to K', as sn^2(eta, k') and cn^2(eta, k') up to a common factor."""

    s2: Any
    c2: Any


class ThetaConstants(NamedTuple):
    """The constants of a nutating top in its series."""

    quarter: Any
    """K."""
    quarter_prime: Any
    """K'; None without torque, as it is then infinite."""
    m: Any
    """k^2."""
    k: Any
    k_prime: Any
    plus: SquaredRatio
    """The parameter of X, 2K y+/pi."""
    minus: SquaredRatio
    """The parameter of Y, 2K y-/pi."""
    x_size: Any
    """|X| at u1, which is cos(theta_min/2)."""
    y_size: Any
    """|Y| at u2, sin(theta_max/2), times sqrt(k'), the ratio of theta3 at u2 and at u1."""
    sign_plus: Any
    sign_minus: Any
    nutation: Any
    """-du/dt over the phase x near a passage of u1; None if it is not needed."""


class Series(NamedTuple):
    """The series about u1 and about u2, in the caller's precision; a step is half a period."""

    hyperbolic: bool
    frames: list[Frame]
    scale: Any
    """Argument of the functions per step of the phase."""
    slopes: tuple[Any, Any]
    """Slopes per step that are added to arg X and arg Y to make them periodic."""


def theta_series(ar: Any, c: ThetaConstants, terms: int = TERMS) -> Series:
    """Return the series in the smaller nome."""
    hyperbolic = c.quarter_prime is not None and ar.either(c.quarter > c.quarter_prime)
    return (hyperbolic_series if hyperbolic else circular_series)(ar, c, terms)


def circular_series(ar: Arithmetic[Any], c: ThetaConstants, terms: int = TERMS) -> Series:
    """Return the series in q, whose arguments change by +-pi over a period."""
    weights = _weights(ar, nome(ar, m=c.m, k_prime=c.k_prime), 2, terms)
    plus, minus = (
        hyperbolic_cosine_and_sine(ar, m=c.m, k_prime=c.k_prime, s2=place.s2, c2=place.c2)
        for place in (c.plus, c.minus)
    )
    x = _circular_components(weights, plus, c.x_size, c.sign_plus)
    y = _circular_components(weights, minus, c.y_size, c.sign_minus)
    quarter_turn = ar.pi / 2
    return Series(
        hyperbolic=False,
        frames=_frames(x, y, _rate(weights, 1, c.nutation)),
        scale=quarter_turn,
        slopes=(-c.sign_plus * quarter_turn, -c.sign_minus * quarter_turn),
    )


def hyperbolic_series(ar: Arithmetic[Any], c: ThetaConstants, terms: int = TERMS) -> Series:
    """Return the series in q'; Jacobi's transformation adds a linear exponent of its own."""
    ratio: Any = c.quarter / c.quarter_prime
    mc = c.k_prime * c.k_prime
    q = nome(ar, m=mc, k_prime=c.k)
    plus, minus = (
        cosine_and_sine(ar, m=mc, k_prime=c.k, s2=place.s2, c2=place.c2)
        for place in (c.plus, c.minus)
    )
    even = [(2 if n else 1) * weight for n, weight in enumerate(_weights(ar, q, 1, terms))]
    odd = [2 * ar.sqrt(ar.sqrt(q)) * weight for weight in _weights(ar, q, 2, terms)]
    x = _hyperbolic_components(even, odd, plus, c.sign_plus, c.x_size)
    y = _hyperbolic_components(even, odd, minus, c.sign_minus, c.y_size)
    return Series(
        hyperbolic=True,
        frames=_frames(x, y, _rate(odd, -1, c.nutation and c.nutation / ratio)),
        scale=ar.pi / 2 * ratio,
        slopes=(-c.sign_plus * ar.atan2(*plus), -c.sign_minus * ar.atan2(*minus)),
    )


def _frames(x: Components, y: Components, rate: Coefficients) -> list[Frame]:
    """Return the series about u1 and u2: half a period turns theta2 into theta1 and back."""
    return [Frame(x[0], y[1], rate), Frame(x[1], y[0], [-coefficient for coefficient in rate])]


def _circular_components(
    weights: list[Any], first: tuple[Any, Any], size: Any, sign: Any
) -> Components:
    """Return theta2 and theta1 of x - i sign y, turned so that each is real at x = 0.

    `first` are cosh y and sinh y.
    """
    odd = multiples(first, doubled(*first, -1), -1, len(weights))
    cosh, sinh = ([w * x for w, x in zip(weights, part, strict=True)] for part in odd)
    unit = size / sum(cosh)
    return (
        Component(summed(COS_ODD, 1, unit, cosh), summed(SIN_ODD, 1, sign * unit, sinh)),
        Component(
            summed(COS_ODD, 1, unit, alternated(sinh)),
            summed(SIN_ODD, 1, sign * unit, alternated(cosh)),
        ),
    )


def _weights(ar: Arithmetic[Any], q: Any, first: int, terms: int) -> list[Any]:
    """Return q^(n^2) or, for a first exponent of 2, q^(n(n+1)): weights of theta3 and theta2.

    The truncation error of N terms in a nome q <= 1/20 is added to the first two weights, which
    multiply constants.  In circular series |y| <= log(1/q)/2.  In hyperbolic series |z| <= 3
    log(1/q)/8, because no phase exceeds 3/4.  For x >= 0, `|sin jx| <= j |sin x|`, `sinh jx <= j
    e^((j-1) x) sinh x` and `cosh jx <= e^((j-1) x) cosh x`.  A term over the constant that its
    weight multiplies is therefore at most 2 (2n+1)^2 q^(n(n-1)).  From n = 1 on, each bound is less
    than half of the one before.  The sum of all terms from n = N on is thus at most 4 (2N+1)^2
    times the last weight.
    """
    weights, power = [0 * q + 1], q if first == 1 else q * q
    for _ in range(terms - 1):
        weights.append(weights[-1] * power)
        power = power * q * q
    if isinstance(ar, Balls):
        rest = 4 * (2 * terms + 1) * (2 * terms + 1) * weights[-1]
        weights[:2] = [ar.between(weight - rest, weight + rest) for weight in weights[:2]]
    return weights


def _hyperbolic_components(
    even: list[Any],
    odd: list[Any],
    first: tuple[Any, Any],
    sign: Any,
    size: Any,
) -> Components:
    """Return theta2 and theta1 after Jacobi's transformation: theta4 and theta1 of v + i h.

    `first` are cos v and sin v.
    """
    zero = 0 * first[0]
    step, none = doubled(*first, 1), (1 + zero, zero)
    (cos_even, sin_even), (cos_odd, sin_odd) = (
        [alternated([w * x for w, x in zip(weights, part, strict=True)]) for part in functions]
        for weights, functions in (
            (even, multiples(none, step, 1, len(even))),
            (odd, multiples(first, step, 1, len(odd))),
        )
    )
    unit = size / sum(cos_even)
    return (
        Component(
            summed(COS_EVEN, -1, unit, cos_even), summed(SIN_EVEN, -1, -sign * unit, sin_even), True
        ),
        Component(summed(COS_ODD, -1, unit, sin_odd), summed(SIN_ODD, -1, sign * unit, cos_odd)),
    )


def _rate(weights: list[Any], curvature: int, nutation: Any) -> Coefficients:
    """Return theta1(2x) over S C, scaled such that theta1(2x) begins with nutation * x."""
    if nutation is None:
        return []
    terms = [0 * nutation] * (2 * len(weights))
    terms[1::2] = alternated(weights)
    unit = nutation / sum(2 * n * term for n, term in enumerate(terms))
    return summed(SIN_EVEN, curvature, unit, terms)


def summed(family: Family, curvature: int, unit: Any, weights: list[Any]) -> Coefficients:
    """Return a weighted sum of the polynomials of a family, times a unit.

    The curvature is 1 for circular functions, -1 for hyperbolic ones.
    """
    total: Coefficients = [0 * unit] * len(weights)
    for weight, coefficients in zip(weights, _polynomials(family, len(weights)), strict=True):
        for i, coefficient in enumerate(coefficients):
            total[i] += weight * coefficient
    return [unit * x if i % 2 == 0 else curvature * unit * x for i, x in enumerate(total)]


@lru_cache(maxsize=64)
def _polynomials(family: Family, count: int) -> list[list[int]]:
    """Return the first polynomials in s of a family, P(n+1) = (2 - 4 s) P(n) - P(n-1)."""
    found = [list(polynomial) for polynomial in family]
    while len(found) < count:
        before, last = found[-2:]
        twice, shifted = [2 * c for c in last] + [0], [0] + [4 * c for c in last]
        padded = before + [0] * (len(twice) - len(before))
        found.append([a - b - c for a, b, c in zip(twice, shifted, padded, strict=True)])
    return found[:count]


def alternated(terms: list[Any]) -> list[Any]:
    """Return terms with every second sign changed, starting with the second."""
    return [-term if n % 2 else term for n, term in enumerate(terms)]


def doubled(cos: Any, sin: Any, curvature: int) -> tuple[Any, Any]:
    """Return cosine and sine of twice an angle; hyperbolic functions for a curvature of -1."""
    return 1 - 2 * curvature * sin * sin, 2 * sin * cos


def multiples(
    first: tuple[Any, Any], step: tuple[Any, Any], curvature: int, count: int
) -> tuple[list[Any], list[Any]]:
    """Return cosines and sines of first, first + step, first + 2 step ..., from those of both.

    A common factor of all sines, or of all cosines, keeps its digits.
    """
    cosines, sines = [first[0]], [first[1]]
    for _ in range(count - 1):
        c, s = cosines[-1], sines[-1]
        cosines.append(c * step[0] - curvature * s * step[1])
        sines.append(s * step[0] + c * step[1])
    return cosines, sines


def theta_constants(motion: Nutating[Any], *, rates: bool = False) -> ThetaConstants:
    """Return the constants of the theta series of a nutating top.

    The parameter of X, with modulus k', has `sn^2 = (1 + u2)/(1 + u1)` and `cn^2 = (u1 - u2)/(1 +
    u1)`.  The parameter of Y has `sn^2 = (1 - u1)(u3 - u2)/((u3 - u1)(1 - u2))` and `cn^2 = (u3 -
    1)(u1 - u2)/((u3 - u1)(1 - u2))`.
    """
    ar, gaps, facts = motion.ar, motion.gaps, motion.facts
    with ar.working():
        squares = motion.K * motion.K * motion.k_prime * motion.k_prime
        return ThetaConstants(
            quarter=motion.K,
            quarter_prime=motion.K_prime,
            m=motion.m,
            k=motion.k,
            k_prime=motion.k_prime,
            plus=SquaredRatio(gaps.below_u2, gaps.u1_u2),
            minus=SquaredRatio(gaps.above_u1 * gaps.a_u3_u2, gaps.a_u3_above * gaps.u1_u2),
            x_size=ar.sqrt(gaps.below_u1 / 2),
            y_size=ar.sqrt(motion.k_prime * gaps.above_u2 / 2),
            sign_plus=facts.sign_plus,
            sign_minus=facts.sign_minus,
            nutation=8 * squares * gaps.u1_u2 / (ar.pi * motion.T_nutation) if rates else None,
        )
