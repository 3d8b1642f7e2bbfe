"""Aksenov section 3.2: eta(tau) from its quadrature, and any other with the same kind of roots.

    (d eta/d tau)^2 = g (delta - eta)(eta - delta*) times the distances of eta from the outer roots

Of the two outer roots p +- q one lies on each side of the band [delta*, delta] (the satellite), or
both on one side or beside it as a complex pair (hyperbolic motion), or one or both are at infinity
(parabolic motion; Lagrange's top).  The
roots are exact rationals, so their gaps are; and what is made of the gaps are sums and products of
positive numbers, so that nothing is lost as roots come close to each other.

In doubles sizes are from 1e-100 to 1e100, and eta is within 4 units of
eps (max(1, |eta|) + |tau d eta/d tau|), tau counted from the nearest passage of delta*.
"""

from __future__ import annotations

from fractions import Fraction
from math import prod
from typing import Any, NamedTuple

from ..arithmetic.protocol import FunctionArithmetic, Value
from .complete import agm
from .modulus import Modulus
from .proved_numbers import ProvedNumbers
from .quadrature import Quadrature


class EtaConstants(NamedTuple):
    """The constants of (3.2.3) to (3.2.12) in some arithmetic, and k1' beside k1."""

    m1: Value
    """m' (3.2.3)."""
    m2: Value
    """m'' (3.2.3)."""
    k: Value
    """Modulus (3.2.5); of a complex pair of roots k/i."""
    k1: Value
    """Modulus (3.2.8); of a complex pair of roots k1/i."""
    k1_prime: Value
    """Complement of k1, which is above 1 where k1 is imaginary."""
    sigma1: Value
    """Rate of the argument (3.2.8)."""
    s: Value
    """Amplitude of sn (3.2.12)."""
    d: Value
    """Coefficient of the denominator (3.2.12)."""
    gamma: Value
    """Shift (3.2.12)."""
    period: Value
    """Period in tau, 4 K1/sigma1."""


def eta_constants(ar: FunctionArithmetic, quadrature: Quadrature) -> EtaConstants:
    """Return the constants in balls, or in an mpmath context.

    m'^2 and m''^2 are products of the distances of delta and delta* from the outer roots, and
    2 sigma1/sqrt(g) is a sum of square roots of such products, in each layout.
    """
    if quadrature.height:
        return _constants_of_pair(ar, quadrature)
    outer = quadrature.outer
    g = ar.convert(quadrature.g)
    to_lower = [ar.convert(abs(root - quadrature.lower)) for root in outer]
    to_upper = [ar.convert(abs(root - quadrature.upper)) for root in outer]
    apart = ar.convert(abs(outer[0] - outer[1]) if len(outer) > 1 else Fraction(len(outer)))
    m1, m2 = ar.sqrt(prod(to_upper)), ar.sqrt(prod(to_lower))
    if len(outer) > 1:
        crossed = ar.sqrt(to_lower[0] * to_upper[1]) + ar.sqrt(to_lower[1] * to_upper[0])
    else:
        crossed = m1 + m2
    sigma1 = ar.sqrt(g) * crossed / 2
    k1 = ar.convert(quadrature.upper - quadrature.lower) * apart / crossed**2
    k1_prime = 2 * ar.sqrt(m1 * m2) / crossed
    return _constants_from(ar, quadrature, (m1, m2), k1 / k1_prime, k1, k1_prime, sigma1)


def _constants_of_pair(ar: FunctionArithmetic, quadrature: Quadrature) -> EtaConstants:
    """Return the constants where the outer roots are p +- i height, so that k and k1 are imaginary.

    m' and m'' are the distances of delta and delta* from these roots.  All that is subtracted in
    kappa^2 = -k^2 = (D^2 - (m' - m'')^2)/(4 m' m''), D = delta - delta*, is exact; and
    kappa' = sqrt((m' + m'' - D)(m' + m'' + D)/(4 m' m'')) is sigma1/sqrt(g m' m'').
    """
    p = quadrature.outer[0]
    above, below = quadrature.upper - p, quadrature.lower - p
    g, width, height = (
        ar.convert(x)
        for x in (quadrature.g, quadrature.upper - quadrature.lower, quadrature.height)
    )
    m1, m2 = (ar.sqrt(ar.convert(square)) for square in quadrature.squares)
    product, crossed = m1 * m2, ar.convert(above * below)
    if above * below > 0:
        rest = ar.convert(above**2 + below**2 + quadrature.height**2)
        between = height**2 * rest / (product + crossed)
    else:
        between = product - crossed
    kappa = width * ar.sqrt((height**2 + between) / (2 * product)) / (m1 + m2)
    excess = _beyond(ar, m1, above, height) + _beyond(ar, m2, -below, height)
    sigma1 = ar.sqrt(g * excess * (m1 + m2 + width)) / 2
    kappa_prime = sigma1 / ar.sqrt(g * product)
    return _constants_from(
        ar, quadrature, (m1, m2), kappa, kappa / kappa_prime, 1 / kappa_prime, sigma1
    )


def _beyond(ar: FunctionArithmetic, distance: Value, part: Fraction, height: Value) -> Value:
    """Return a distance sqrt(part^2 + height^2) less its part, which may be negative."""
    exact = ar.convert(part)
    return height**2 / (distance + exact) if part > 0 else distance - exact


def _constants_from(
    ar: FunctionArithmetic,
    quadrature: Quadrature,
    distances: tuple[Value, Value],
    *moduli_and_rate: Value,
) -> EtaConstants:
    """Return all constants from m', m'', and from k, k1, k1', sigma1."""
    (m1, m2), (k, k1, k1_prime, sigma1) = distances, moduli_and_rate
    lower, upper, g = (ar.convert(x) for x in (quadrature.lower, quadrature.upper, quadrature.g))
    rise, fall = _sum_and_difference(ar, quadrature, m2 * upper, m1 * lower)
    square1, square2 = quadrature.squares
    return EtaConstants(
        m1=m1,
        m2=m2,
        k=k,
        k1=k1,
        k1_prime=k1_prime,
        sigma1=sigma1,
        s=fall / (m1 + m2),
        d=ar.convert(square2 - square1) / (m1 + m2) ** 2,
        gamma=rise / (m1 + m2),
        period=2 * ar.pi / agm(ar, sigma1, ar.sqrt(g * m1 * m2)),
    )


def _sum_and_difference(
    ar: FunctionArithmetic, quadrature: Quadrature, high: Value, low: Value
) -> tuple[Value, Value]:
    """Return m'' delta + m' delta* and m'' delta - m' delta* from the two terms.

    Where they cancel, the difference of their squares is known exactly.
    """
    square1, square2 = quadrature.squares
    difference = ar.convert(square2 * quadrature.upper**2 - square1 * quadrature.lower**2)
    if quadrature.upper * quadrature.lower > 0:
        return high + low, difference / (high + low)
    moves = quadrature.upper or quadrature.lower
    return (difference / (high - low) if moves else high + low), high - low


def record(
    quadrature: Quadrature, digits: int | None = None, c3: Fraction = Fraction(0)
) -> dict[str, Any]:
    """Return roots and constants, each the nearest double or to so many significant digits.

    Raises LagtopError as `Quadrature.check` does and, for doubles, `Quadrature.check_doubles`.
    """
    if digits is not None:
        quadrature.check()
    else:
        quadrature.check_doubles()
    zeros = dict.fromkeys(_zeros_of_record(quadrature), 0)
    return ProvedNumbers(digits).of(lambda ar: _record_in(ar, quadrature, c3), zeros)


def _zeros_of_record(quadrature: Quadrature) -> set[str]:
    """Return the constants that are exactly 0."""
    square1, square2 = quadrature.squares
    upper, lower, outer = quadrature.upper, quadrature.lower, quadrature.outer
    opposite = square2 * upper**2 == square1 * lower**2
    exact = {
        "delta": upper,
        "delta_star": lower,
        "p": sum(outer),
        "q": outer[0] - outer[-1] if outer else 0,
        "outer_root": sum(outer),
        "d": square2 - square1,
        "s": not (opposite and upper * lower >= 0),
        "gamma": not (opposite and upper * lower <= 0),
        "k": (upper - lower) * (outer[0] - outer[1] if len(outer) > 1 else len(outer)),
    }
    if quadrature.height:
        exact["k_imag"] = upper - lower
    zeros = {name for name, x in exact.items() if not x}
    return zeros | {name.replace("k", "k1") for name in zeros & {"k", "k_imag"}}


def _record_in(ar: FunctionArithmetic, quadrature: Quadrature, c3: Fraction) -> dict[str, Any]:
    """Return the record in balls; None for what the layout does not have."""
    c, outer = eta_constants(ar, quadrature), quadrature.outer
    pair_of_roots, imaginary = len(outer) > 1, bool(quadrature.height)
    return {
        "delta": ar.convert(quadrature.upper),
        "delta_star": ar.convert(quadrature.lower),
        "p": ar.convert((outer[0] + outer[-1]) / 2) if pair_of_roots else None,
        "q": ar.convert(abs(outer[0] - outer[1]) / 2) if pair_of_roots and not imaginary else None,
        "q_imag": ar.convert(quadrature.height) if imaginary else None,
        "outer_root": ar.convert(outer[0]) if len(outer) == 1 else None,
        "g": ar.convert(quadrature.g),
        "layout": quadrature.layout,
        "kind": quadrature.kind,
        "m_prime": c.m1,
        "m_double_prime": c.m2,
        "k": None if imaginary else c.k,
        "k_imag": c.k if imaginary else None,
        "k1": None if imaginary else c.k1,
        "k1_imag": c.k1 if imaginary else None,
        "k1_prime": c.k1_prime,
        "K1": c.period * c.sigma1 / 4,
        "sigma1": c.sigma1,
        "s": c.s,
        "d": c.d,
        "gamma": c.gamma,
        "period": c.period,
        "tau3": ar.convert(c3) - c.period / 4,
    }


class Band(NamedTuple):
    """What eta is reckoned from: the ends of the band, and the outer roots by their distances."""

    lower: Value
    """delta*."""
    upper: Value
    """delta."""
    width: Value
    """delta - delta*."""
    below: list[Value]
    """Distances of the outer roots that lie below, from delta*."""
    above: list[Value]
    """Distances of the outer roots that lie above, from delta."""
    g: Value
    """The leading coefficient."""
    pair: tuple[Value, Value, Value] | None = None
    """The numbers delta* - p, delta - p and height of a complex pair p +- i height."""


def band_of(ar: FunctionArithmetic, quadrature: Quadrature) -> Band:
    """Return the gaps of the exact roots, each rounded once."""
    lower, upper, outer, g, height = quadrature
    pair = None
    if height:
        pair = ar.convert(lower - outer[0]), ar.convert(upper - outer[0]), ar.convert(height)
        outer = ()
    return Band(
        lower=ar.convert(lower),
        upper=ar.convert(upper),
        width=ar.convert(upper - lower),
        below=[ar.convert(lower - root) for root in outer if root < lower],
        above=[ar.convert(root - upper) for root in outer if root > upper],
        g=ar.convert(g),
        pair=pair,
    )


def modulus_in_use(c: EtaConstants, band: Band) -> Modulus:
    """Return k1 or, where that is imaginary, kappa = k/i: with k1 = i kappa/kappa'."""
    if band.pair:
        return Modulus(c.k, 1 / c.k1_prime, 0 * c.k)
    return Modulus(c.k1, c.k1_prime, 0 * c.k1)
