"""The theta series of the attitude as polynomials: coefficients in many digits, then doubles.

X = cos(theta/2) exp(i (psi + phi)/2) goes as theta2(x - i s+ y+) and
Y = sin(theta/2) exp(i (psi - phi)/2) as theta1(x - i s- y-), with x = pi t/T counted from a passage
of u1.  While K <= K' the series run in the nome q, about u1 only; beyond, Jacobi's imaginary
transformation gives series in q' = exp(-pi K/K'), about u1 and about u2.  The nome in use is at
most exp(-pi), so four terms are enough for doubles.

sin and cos of multiples of x are polynomials in s = sin^2 x (times S = sin x, C = cos x or S C),
all four families by one recurrence; sinh and cosh are the same with s -> -sinh^2.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from .elliptic import Arithmetic, Real

TERMS = 4

Polynomial = list[Any]
"""Coefficients in s, the lowest power first."""

_COS_ODD, _SIN_ODD, _COS_EVEN, _SIN_EVEN = (
    ([1], [1, -4]),
    ([1], [3, -4]),
    ([1], [1, -2]),
    ([0], [2]),
)


class Component(NamedTuple):
    """X or Y about one turning point.

    Real and imaginary part are C P(s) and S Q(s), or P(s) and S C Q(s) where `even`.
    """

    real: Polynomial
    imag: Polynomial
    even: bool = False


class Frame(NamedTuple):
    """X, Y and S C `rate` = theta1(2x) about one turning point."""

    x: Component
    y: Component
    rate: Polynomial


class Constants(NamedTuple):
    """What the series need to know of a nutating top, in an mpmath context."""

    period: Real
    quarter: Real
    """K."""
    quarter_prime: Real
    """K'; None where it is infinite (no torque)."""
    eta_plus: Real
    """2K y+/pi, the parameter of X."""
    eta_minus: Real
    """2K y-/pi, the parameter of Y."""
    x_size: Real
    """|X| at u1, which is cos(theta_min/2)."""
    y_size: Real
    """|Y| at u2, sin(theta_max/2), times sqrt(k') as theta3(x)/theta3(0) shrinks on the way."""
    spin: Real
    """Advance of the spin over a period."""
    precession: Real
    """Advance of the precession over a period."""
    sign_plus: int
    sign_minus: int
    offset: Real
    """Periods since the nearest passage of u1, at t = 0."""
    rises: int
    """Sign of the nutation rate at t = 0; +1 where it is 0."""
    nutation: Real
    """-du/dt near a passage of u1 is `nutation` times the phase x."""


class Series(NamedTuple):
    """The series about one turning point (circular) or two (hyperbolic), in the caller's digits."""

    hyperbolic: bool
    frames: list[Frame]
    scale: Real
    """Argument of the functions per step of the phase."""
    slope_x: Real
    """Linear growth of arg X within a step."""
    slope_y: Real


def theta_series(ar: Arithmetic, c: Constants) -> Series:
    """Series in the smaller nome."""
    hyperbolic = c.quarter_prime is not None and c.quarter > c.quarter_prime
    return (_hyperbolic_series if hyperbolic else _circular_series)(ar, c)


def _circular_series(ar: Arithmetic, c: Constants) -> Series:
    """A step is a period; the series wind by +-pi in it, the rest of the advance is linear."""
    q = ar.exp(-ar.pi * c.quarter_prime / c.quarter) if c.quarter_prime else ar.mpf(0)
    weights = [q ** (n * (n + 1)) for n in range(TERMS)]
    y_plus, y_minus = (ar.pi * eta / (2 * c.quarter) for eta in (c.eta_plus, c.eta_minus))
    x, _ = _circular_components(ar, weights, y_plus, c.x_size, c.sign_plus)
    _, y = _circular_components(ar, weights, y_minus, c.y_size, c.sign_minus)
    return Series(
        hyperbolic=False,
        frames=[Frame(x, y, _rate(weights, 1, c.nutation))],
        scale=+ar.pi,
        slope_x=(c.precession + c.spin) / 2 - c.sign_plus * ar.pi,
        slope_y=(c.precession - c.spin) / 2 - c.sign_minus * ar.pi,
    )


def _hyperbolic_series(ar: Arithmetic, c: Constants) -> Series:
    """A step is half a period; the transformation adds a linear exponent of its own."""
    ratio: Real = c.quarter / c.quarter_prime
    q = ar.exp(-ar.pi * ratio)
    v_plus, v_minus = (ar.pi * eta / (2 * c.quarter_prime) for eta in (c.eta_plus, c.eta_minus))
    x = _hyperbolic_components(ar, q, v_plus, c.x_size, c.sign_plus)
    y = _hyperbolic_components(ar, q, v_minus, c.y_size, c.sign_minus)
    rate = _rate([q ** (n * (n + 1)) for n in range(TERMS)], -1, c.nutation / ratio)
    backwards = [-coefficient for coefficient in rate]
    return Series(
        hyperbolic=True,
        frames=[Frame(x[0], y[1], rate), Frame(x[1], y[0], backwards)],
        scale=ar.pi / 2 * ratio,
        slope_x=(c.precession + c.spin) / 4 + c.sign_plus * (v_plus - ar.pi / 2),
        slope_y=(c.precession - c.spin) / 4 + c.sign_minus * (v_minus - ar.pi / 2),
    )


def _circular_components(
    ar: Arithmetic, weights: list[Real], y: Real, size: Real, sign: int
) -> tuple[Component, Component]:
    """theta2(x - i sign y) and theta1(x - i sign y), turned so that each is real at x = 0."""
    cosh = [w * ar.cosh((2 * n + 1) * y) for n, w in enumerate(weights)]
    sinh = [w * ar.sinh((2 * n + 1) * y) for n, w in enumerate(weights)]
    unit = size / sum(cosh)
    return (
        Component(_sum(_COS_ODD, 1, unit, cosh), _sum(_SIN_ODD, 1, sign * unit, sinh)),
        Component(
            _sum(_COS_ODD, 1, unit, _alternate(sinh)),
            _sum(_SIN_ODD, 1, sign * unit, _alternate(cosh)),
        ),
    )


def _hyperbolic_components(
    ar: Arithmetic, q: Real, v: Real, size: Real, sign: int
) -> tuple[Component, Component]:
    """The same two functions after Jacobi's transformation: theta4 and theta1 of v + i h."""
    even = [(2 if n else 1) * q ** (n * n) for n in range(TERMS)]
    odd = [2 * ar.sqrt(ar.sqrt(q)) * q ** (n * (n + 1)) for n in range(TERMS)]
    cos_even = _alternate([w * ar.cos(2 * n * v) for n, w in enumerate(even)])
    sin_even = _alternate([w * ar.sin(2 * n * v) for n, w in enumerate(even)])
    cos_odd = _alternate([w * ar.cos((2 * n + 1) * v) for n, w in enumerate(odd)])
    sin_odd = _alternate([w * ar.sin((2 * n + 1) * v) for n, w in enumerate(odd)])
    unit = size / sum(cos_even)
    return (
        Component(
            _sum(_COS_EVEN, -1, unit, cos_even), _sum(_SIN_EVEN, -1, -sign * unit, sin_even), True
        ),
        Component(_sum(_COS_ODD, -1, unit, sin_odd), _sum(_SIN_ODD, -1, sign * unit, cos_odd)),
    )


def _rate(weights: list[Real], curvature: int, nutation: Real) -> Polynomial:
    """theta1(2x) over S C, so scaled that it goes as nutation * x at first."""
    terms = [0 * nutation] * (2 * len(weights))
    terms[1::2] = _alternate(weights)
    unit = nutation / sum(2 * n * term for n, term in enumerate(terms))
    return _sum(_SIN_EVEN, curvature, unit, terms)


def _alternate(terms: list[Real]) -> list[Real]:
    return [-term if n % 2 else term for n, term in enumerate(terms)]


def _sum(
    family: tuple[list[int], list[int]], curvature: int, unit: Real, weights: list[Real]
) -> Polynomial:
    """Weighted sum of a family, P(n+1) = (2 - 4 s) P(n) - P(n-1)."""
    total: Polynomial = [0 * unit] * len(weights)
    power, following = family
    for weight in weights:
        for i, coefficient in enumerate(power):
            total[i] += unit * weight * coefficient * curvature**i
        power, following = following, _next(power, following)
    return total


def _next(previous: list[int], current: list[int]) -> list[int]:
    doubled, shifted = [2 * c for c in current] + [0], [0] + [4 * c for c in current]
    padded = previous + [0] * (len(doubled) - len(previous))
    return [a - b - c for a, b, c in zip(doubled, shifted, padded, strict=True)]
