"""Eta(tau) from the quadrature of Aksenov section 3.2, for all real roots and a complex pair.

    (d eta/d tau)^2 = g (delta - eta)(eta - delta*) times the distances of eta from the outer roots

The two outer roots p +- q have these layouts:

- One lies on each side of the band [delta*, delta] (the satellite).
- Both lie on one side, or beside the band as a complex pair (hyperbolic motion).
- One or both are at infinity (parabolic motion; Lagrange's top).

The roots are exact rationals, and so are their gaps.  All constants are sums and products of
positive functions of the gaps, so that no digits are lost as roots approach each other.

In doubles, sizes are from 1e-100 to 1e100.  The error of eta is at most 4 units of eps (max(1,
|eta|) + |tau d eta/d tau|).  Here tau is counted from the nearest passage of delta*.
"""

from __future__ import annotations

from fractions import Fraction
from math import prod
from typing import NamedTuple

from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..errors import LagtopError
from .complete import agm
from .modulus import Modulus

LEAST, MOST = Fraction("1e-100"), Fraction("1e100")
"""Sizes of roots, gaps and g in doubles."""


class Quadrature(NamedTuple):
    """The radicand: the band, up to two outer roots, and g, which is -2 alpha1 c^2 in (3.2.1).

    Call `check` before use.
    """

    lower: Fraction
    """delta*."""
    upper: Fraction
    """delta."""
    outer: tuple[Fraction, ...]
    """The finite outer roots, in any order; the real parts of a complex pair."""
    g: Fraction = Fraction(1)
    """Absolute value of the leading coefficient."""
    height: Fraction = Fraction(0)
    """Absolute value of the imaginary parts of a complex pair."""

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError unless lower <= upper, g > 0 and the band has no real outer root.

        In doubles, sizes outside 1e-100 to 1e100 raise it, too.
        """
        if self.upper < self.lower:
            raise LagtopError(
                f"delta must be >= delta_star = {float(self.lower)}, got {float(self.upper)}",
                "delta",
            )
        if self.g <= 0:
            raise LagtopError(f"g must be > 0, got {float(self.g)}", "g")
        for root in () if self.height else self.outer:
            if root in {self.lower, self.upper}:
                raise LagtopError(
                    "an outer root at an end of the band makes the period infinite (k1 = 1), "
                    f"got {float(root)}"
                )
            if self.lower <= root <= self.upper:
                raise LagtopError(
                    "the outer roots must lie outside the band from delta* to delta, "
                    f"[{float(self.lower)}, {float(self.upper)}], got {float(root)}"
                )

        if doubles:
            self._check_sizes()

    def _check_sizes(self) -> None:
        """Raise LagtopError for sizes outside 1e-100 to 1e100."""
        gaps = [abs(end - root) for root in self.outer for end in (self.lower, self.upper)]
        sizes = {
            "delta": [self.upper],
            "delta_star": [self.lower],
            "g": [self.g],
            "delta - delta_star": [self.upper - self.lower],
            "the gap to an outer root": [] if self.height else gaps,
            "q": [self.height],
            "p": self.outer[:1] if self.height else [],
        }
        for name, values in sizes.items():
            for value in values:
                if value and not LEAST <= abs(value) <= MOST:
                    raise LagtopError(
                        f"{name} must be from 1e-100 to 1e100 in size, got {float(value)} "
                        "(or give --digits)",
                        name,
                    )

    @property
    def squares(self) -> tuple[Fraction, Fraction]:
        """Squares of m' and m'' (3.2.3), exactly."""
        to_upper = prod((abs(root - self.upper) for root in self.outer), start=Fraction(1))
        to_lower = prod((abs(root - self.lower) for root in self.outer), start=Fraction(1))
        return to_upper + self.height**2, to_lower + self.height**2

    @property
    def layout(self) -> str:
        """The layout of the outer roots, in words."""
        if self.height:
            return "complex pair"
        if not self.outer:
            return "both at infinity"
        above = sum(root > self.upper for root in self.outer)
        if len(self.outer) == 1:
            return "one above" if above else "one below"
        return ("both below", "one on each side", "both above")[above]

    @property
    def kind(self) -> str:
        """The degree of the radicand and its degeneracy, if any, in words."""
        degree = ("quadratic", "cubic", "quartic")[len(self.outer)]
        if self.lower == self.upper:
            return f"{degree}, the band is a double root: eta is constant"
        if not self.outer:
            return "quadratic, k1 = 0: a harmonic oscillation"
        if len(set(self.outer)) < len(self.outer) and not self.height:
            return "quartic with a double outer root, k1 = 0: circular functions"
        return "quartic, k1 is imaginary" if self.height else degree


class EtaConstants(NamedTuple):
    """The constants of (3.2.3) to (3.2.12) and the complement k1', in some arithmetic."""

    m1: Numeric
    """m' (3.2.3)."""
    m2: Numeric
    """m'' (3.2.3)."""
    k: Numeric
    """Modulus k (3.2.5), or k/i for a complex pair of roots."""
    k1: Numeric
    """Modulus k1 (3.2.8), or k1/i for a complex pair of roots."""
    k1_prime: Numeric
    """Complement of k1; it is above 1 if k1 is imaginary."""
    sigma1: Numeric
    """Rate of the argument (3.2.8)."""
    s: Numeric
    """Amplitude of sn (3.2.12)."""
    d: Numeric
    """Coefficient of the denominator (3.2.12)."""
    gamma: Numeric
    """Shift (3.2.12)."""
    period: Numeric
    """Period in tau, 4 K1/sigma1."""


def eta_constants(ar: FunctionArithmetic, quadrature: Quadrature) -> EtaConstants:
    """Return the constants in balls, or in an mpmath context."""
    found = _of_pair(ar, quadrature) if quadrature.height else _of_real_roots(ar, quadrature)
    m1, m2, sigma1 = found["m1"], found["m2"], found["sigma1"]
    lower, upper, g = (ar.convert(x) for x in (quadrature.lower, quadrature.upper, quadrature.g))
    rise, fall = _sum_and_difference(ar, quadrature, m2 * upper, m1 * lower)
    square1, square2 = quadrature.squares
    return EtaConstants(
        **found,
        s=fall / (m1 + m2),
        d=ar.convert(square2 - square1) / (m1 + m2) ** 2,
        gamma=rise / (m1 + m2),
        period=2 * ar.pi / agm(ar, sigma1, ar.sqrt(g * m1 * m2)),
    )


def _of_real_roots(ar: FunctionArithmetic, quadrature: Quadrature) -> dict[str, Numeric]:
    """Return m', m'', the moduli and sigma1 for real outer roots.

    The squares m'^2 and m''^2 are products of the distances of delta and delta* from the outer
    roots.  In each layout, 2 sigma1/sqrt(g) is a sum of square roots of such products.
    """
    lower, upper, outer, g, _ = quadrature
    to_lower = [ar.convert(abs(root - lower)) for root in outer]
    to_upper = [ar.convert(abs(root - upper)) for root in outer]
    m1, m2 = ar.sqrt(prod(to_upper)), ar.sqrt(prod(to_lower))
    crossed, apart = m1 + m2, Fraction(len(outer))
    if len(outer) > 1:
        crossed = ar.sqrt(to_lower[0] * to_upper[1]) + ar.sqrt(to_lower[1] * to_upper[0])
        apart = abs(outer[0] - outer[1])
    k1 = ar.convert(upper - lower) * ar.convert(apart) / crossed**2
    k1_prime, sigma1 = 2 * ar.sqrt(m1 * m2) / crossed, ar.sqrt(ar.convert(g)) * crossed / 2
    moduli = {"k": k1 / k1_prime, "k1": k1, "k1_prime": k1_prime}
    return {"m1": m1, "m2": m2, "sigma1": sigma1, **moduli}


def _of_pair(ar: FunctionArithmetic, quadrature: Quadrature) -> dict[str, Numeric]:
    """Return m', m'', the moduli and sigma1 for outer roots p +- i height.

    The moduli k and k1 are imaginary, and m' and m'' are the distances of delta and delta* from
    these roots.  With D = delta - delta*,

        kappa^2 = -k^2 = (D^2 - (m' - m'')^2)/(4 m' m''),
        kappa' = sqrt((m' + m'' - D)(m' + m'' + D)/(4 m' m'')) = sigma1/sqrt(g m' m'').

    All numbers that are subtracted in kappa^2 are exact.
    """
    lower, upper, (p, *_) = quadrature.lower, quadrature.upper, quadrature.outer
    above, below = upper - p, lower - p
    g, width, height = (ar.convert(x) for x in (quadrature.g, upper - lower, quadrature.height))
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
    moduli = {"k": kappa, "k1": kappa / kappa_prime, "k1_prime": 1 / kappa_prime}
    return {"m1": m1, "m2": m2, "sigma1": sigma1, **moduli}


def _beyond(ar: FunctionArithmetic, distance: Numeric, part: Fraction, height: Numeric) -> Numeric:
    """Return distance - part, where distance = sqrt(part^2 + height^2); part may be negative."""
    exact = ar.convert(part)
    return height**2 / (distance + exact) if part > 0 else distance - exact


def _sum_and_difference(
    ar: FunctionArithmetic, quadrature: Quadrature, high: Numeric, low: Numeric
) -> tuple[Numeric, Numeric]:
    """Return m'' delta + m' delta* and m'' delta - m' delta* from the two terms.

    If the terms cancel, the exact difference of their squares gives the result.
    """
    square1, square2 = quadrature.squares
    difference = ar.convert(square2 * quadrature.upper**2 - square1 * quadrature.lower**2)
    if quadrature.upper * quadrature.lower > 0:
        return high + low, difference / (high + low)
    moves = quadrature.upper or quadrature.lower
    return (difference / (high - low) if moves else high + low), high - low


def modulus_in_use(c: EtaConstants, quadrature: Quadrature) -> Modulus:
    """Return k1 or, if it is imaginary, kappa = k/i, for which k1 = i kappa/kappa'."""
    if quadrature.height:
        return Modulus(c.k, 1 / c.k1_prime, 0 * c.k)
    return Modulus(c.k1, c.k1_prime, 0 * c.k1)
