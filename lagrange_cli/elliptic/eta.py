"""Aksenov section 3.2: eta(tau) from its quadrature, and any other with the same kind of roots.

    (d eta/d tau)^2 = g (delta - eta)(eta - delta*) times the distances of eta from the outer roots

Of the two outer roots p +- q one lies on each side of the band [delta*, delta] (the satellite), or
both on one side (hyperbolic motion), or one is at infinity (parabolic motion; Lagrange's top).  The
roots are exact rationals, so their gaps are; and what is made of the gaps are sums and products of
positive numbers, so that nothing is lost as roots come close to each other.

In doubles sizes are from 1e-100 to 1e100, and eta is within 4 units of
eps (max(1, |eta|) + |tau d eta/d tau|), tau counted from the nearest passage of delta*.
"""

from __future__ import annotations

from fractions import Fraction
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.doubles import DOUBLES
from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Value
from .complete import agm
from .jacobi import jacobi
from .modulus import Modulus
from .proved_digits import require_digits, settled_or_rounded, settled_texts
from .quadrature import Quadrature

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..arithmetic.points import Points
    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array


class EtaConstants(NamedTuple):
    """The constants of (3.2.3) to (3.2.12) in some arithmetic, and k1' beside k1."""

    m1: Value
    """m' (3.2.3)."""
    m2: Value
    """m'' (3.2.3)."""
    k: Value
    """Modulus (3.2.5)."""
    k1: Value
    """Modulus (3.2.8)."""
    k1_prime: Value
    """Complement of k1."""
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
    """Return the constants in an mpmath context.

    m'^2 and m''^2 are products of the distances of delta and delta* from the outer roots, and
    2 sigma1/sqrt(g) is a sum of square roots of such products, in each layout.
    """
    outer = quadrature.outer
    lower, upper, g = (ar.convert(x) for x in (quadrature.lower, quadrature.upper, quadrature.g))
    to_lower = [ar.convert(abs(root - quadrature.lower)) for root in outer]
    to_upper = [ar.convert(abs(root - quadrature.upper)) for root in outer]
    apart = ar.convert(abs(outer[0] - outer[-1]) if len(outer) > 1 else Fraction(1))
    m1, m2 = ar.sqrt(prod(to_upper)), ar.sqrt(prod(to_lower))
    if len(outer) > 1:
        crossed = ar.sqrt(to_lower[0] * to_upper[1]) + ar.sqrt(to_lower[1] * to_upper[0])
    else:
        crossed = m1 + m2
    sigma1 = ar.sqrt(g) * crossed / 2
    k1 = ar.convert(quadrature.upper - quadrature.lower) * apart / crossed**2
    k1_prime = 2 * ar.sqrt(m1 * m2) / crossed
    rise, fall = _sum_and_difference(ar, quadrature, m2 * upper, m1 * lower)
    square1, square2 = quadrature.squares
    return EtaConstants(
        m1=m1,
        m2=m2,
        k=k1 / k1_prime,
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
    return (difference / (high - low) if high - low else high + low), high - low


def record(quadrature: Quadrature, digits: int | None = None) -> dict[str, Any]:
    """Return roots and constants, each the nearest double or to so many significant digits.

    Raises LagtopError as `Quadrature.check` does and, for doubles, `Quadrature.check_doubles`.
    """
    if digits is not None:
        quadrature.check()
    else:
        quadrature.check_doubles()
    zeros = _zeros_of_record(quadrature)
    return settled_or_rounded(lambda ar: _record_in(ar, quadrature), digits, zeros)


def _zeros_of_record(quadrature: Quadrature) -> set[str]:
    """Return the constants that are exactly 0."""
    square1, square2 = quadrature.squares
    upper, lower, outer = quadrature.upper, quadrature.lower, quadrature.outer
    opposite = square2 * upper**2 == square1 * lower**2
    exact = {
        "delta": upper,
        "delta_star": lower,
        "p": outer[0] + outer[-1],
        "q": outer[0] - outer[-1],
        "outer_root": outer[0],
        "d": square2 - square1,
        "s": not (opposite and upper * lower >= 0),
        "gamma": not (opposite and upper * lower <= 0),
        "k": (upper - lower) * (outer[0] - outer[-1] if len(outer) > 1 else 1),
    }
    return {name for name, x in exact.items() if not x} | ({"k1"} if not exact["k"] else set())


def _record_in(ar: FunctionArithmetic, quadrature: Quadrature) -> dict[str, Any]:
    """Return the record in an mpmath context; None for what the layout does not have."""
    c, outer = eta_constants(ar, quadrature), quadrature.outer
    pair_of_roots = len(outer) > 1
    return {
        "delta": ar.convert(quadrature.upper),
        "delta_star": ar.convert(quadrature.lower),
        "p": ar.convert((outer[0] + outer[-1]) / 2) if pair_of_roots else None,
        "q": ar.convert(abs(outer[0] - outer[-1]) / 2) if pair_of_roots else None,
        "outer_root": None if pair_of_roots else ar.convert(outer[0]),
        "g": ar.convert(quadrature.g),
        "layout": quadrature.layout,
        "m_prime": c.m1,
        "m_double_prime": c.m2,
        "k": c.k,
        "k1": c.k1,
        "k1_prime": c.k1_prime,
        "K1": c.period * c.sigma1 / 4,
        "sigma1": c.sigma1,
        "s": c.s,
        "d": c.d,
        "gamma": c.gamma,
        "period": c.period,
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


def band_of(ar: FunctionArithmetic, quadrature: Quadrature) -> Band:
    """Return the gaps of the exact roots, each rounded once."""
    lower, upper, outer, g = quadrature
    return Band(
        lower=ar.convert(lower),
        upper=ar.convert(upper),
        width=ar.convert(upper - lower),
        below=[ar.convert(lower - root) for root in outer if root < lower],
        above=[ar.convert(root - upper) for root in outer if root > upper],
        g=ar.convert(g),
    )


def eta_and_rate(
    ar: FunctionArithmetic, v: Value, c: EtaConstants, band: Band
) -> tuple[Value, Value]:
    """Return eta and d eta/d tau where v = sigma1 w/2, w the time since a passage of delta*.

    eta - delta* : delta - eta = (sqrt(g) m'' sn v)^2 : (sigma1 cn v dn v)^2, which is (3.2.10) to
    (3.2.12) after a halving of the argument: both distances keep their digits.
    """
    _, sn, cn, dn = jacobi(ar, v, Modulus(c.k1, c.k1_prime, 0 * c.k1))
    up, down = abs(ar.sqrt(band.g) * c.m2 * sn), abs(c.sigma1 * cn * dn)
    larger = ar.where(up < down, down, up)  # so that no square leaves the range
    up, down = (up / larger) ** 2, (down / larger) ** 2
    risen, left = band.width * up / (up + down), band.width * down / (up + down)
    eta = ar.where(risen < left, band.lower + risen, band.upper - left)
    gaps = [gap + risen for gap in band.below] + [gap + left for gap in band.above]
    size = prod(map(ar.sqrt, (band.g, risen, left, *gaps)))
    return eta, ar.where(sn * cn < 0, -size, size)


def rows(quadrature: Quadrature, times: Points, c3: Fraction) -> tuple[list[str], Iterator[Array]]:
    """Return the header tau, eta, etadot and blocks of rows; eta = delta* at tau = -c3.

    Raises LagtopError as `Quadrature.check_doubles` does, and for times beyond 2^50 periods.
    """
    import numpy as np

    from ..arithmetic.double_double import pair, reduce_phase
    from .complete import complete_k

    quadrature.check_doubles()
    exact = ManyDigits()
    exactly = eta_constants(exact, quadrature)
    rate = pair(1 / exactly.period)
    offset = exact.convert(c3) / exactly.period
    shift = float(offset - exact.nint(offset))
    c, band = EtaConstants(*map(float, exactly)), band_of(ARRAYS, quadrature)
    check_reach("tau", times, min(MAX_PERIODS * c.period, MAX_TIME))
    half_period = 2 * complete_k(DOUBLES, float(c.k1_prime))

    def block(tau: Array) -> Array:
        with np.errstate(all="ignore"):  # squares of small numbers may leave the doubles
            _, since = reduce_phase(tau, rate, shift)
            eta, etadot = eta_and_rate(ARRAYS, half_period * (since + shift), c, band)
        return np.stack([tau, eta, etadot], axis=1) + 0.0  # no -0

    return ["tau", "eta", "etadot"], (block(tau) for tau in times.blocks())


def digit_rows(
    quadrature: Quadrature, times: Points, c3: Fraction, digits: int
) -> tuple[list[str], Iterator[list[NumberText]]]:
    """Return the header tau, eta, etadot and rows to so many significant digits.

    Raises LagtopError as `Quadrature.check` does.
    """
    quadrature.check()
    still = quadrature.lower == quadrature.upper

    def at(tau: Fraction) -> list[NumberText]:
        def compute(ar: ManyDigits) -> dict[str, Value]:
            c, time = eta_constants(ar, quadrature), ar.convert(tau + c3)
            require_digits(ar, digits, abs(time / c.period))
            eta, rate = eta_and_rate(ar, c.sigma1 * time / 2, c, band_of(ar, quadrature))
            return {"tau": ar.convert(tau), "eta": eta, "etadot": rate}

        at_start = still or tau + c3 == 0
        zero = {"tau": tau == 0, "eta": at_start and not quadrature.lower, "etadot": at_start}
        known = [name for name, is_zero in zero.items() if is_zero]
        return list(settled_texts(compute, digits, known).values())

    return ["tau", "eta", "etadot"], (at(tau) for tau in times.decimals())
