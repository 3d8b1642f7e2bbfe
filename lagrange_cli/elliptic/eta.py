"""Eta(tau) from the quadrature of Aksenov section 3.2, for all real roots and a complex pair.

    (d eta/d tau)^2 = g (delta - eta)(eta - delta*) times the distances of eta from the outer roots

The two outer roots p +- q have these layouts:

- One lies on each side of the band [delta*, delta] (the satellite).
- Both lie on one side, or beside the band as a complex pair (hyperbolic motion).
- One or both are at infinity (parabolic motion; Lagrange's top).
"""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction
from math import prod
from typing import Any, NamedTuple

from flint import arb

from ..arithmetic.enclosures import at_precision, exact
from ..errors import LagtopError, arg
from ..top.inputs import declared
from ..top.ranges import MAX_PERIODS, MAX_TIME, Points, check_reach
from ..top.units import DEGREES, Units
from .arguments import Arguments, ExactComplex
from .functions import Functions, Point
from .modulus import Kind, Modulus, angle
from .tables import Cell, Cells, Rows, numbers, table_rows

ETA_COLUMNS = ("tau", "eta", "etadot", "h1", "theta", "xi_prime")
"""The columns; tau is always included."""
CONSTANTS = """
delta | δ | upper end of the band | | (3.2.1)
delta_star | δ* | lower end of the band | | (3.2.1)
p | p' | middle of the outer roots | | (3.2.1)
q | q' | half the distance between the outer roots | | (3.2.1)
q_imag | q'/i | imaginary part of the outer roots | | (3.2.1)
outer_root | | the finite outer root | |
layout | | outer roots | |
kind | | radicand | |
g | g | -2 α1 c² | 1/time² | (3.2.1)
Constants
m_prime | m' | √(product of distances from δ to outer roots) | | (3.2.3)
m_double_prime | m" | √(product of distances from δ* to outer roots) | | (3.2.3)
k | k | modulus of (3.2.4) | | (3.2.5)
k_imag | k/i | imaginary modulus of (3.2.4) | | (3.2.5)
k1 | k1 | modulus | | (3.2.8)
k1_imag | k1/i | imaginary modulus | | (3.2.8)
k1_prime | k1' | complementary modulus | |
K1 | K1 | complete integral, first kind | | (3.2.8)
sigma1 | σ1 | rate of the argument | 1/time | (3.2.8)
s | s | coefficient of sn | | (3.2.12)
d | d | coefficient of sn in the denominator | | (3.2.12)
gamma | γ | shift | | (3.2.12)
period | T | period of η, 4 K1/σ1 | time | (3.2.10)
tau3 | τ3 | -K1/σ1 | time | (3.2.10)
"""
"""Key, symbol, meaning, unit and equation of each constant; a line without `|` begins a group."""
_FIRST_DIGITS = 32


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
    """Absolute value of the imaginary parts of a complex pair; 0 if all roots are real."""

    def check(self) -> None:
        """Raise LagtopError unless lower <= upper, g > 0 and the band has no real outer root."""
        low, high = float(self.lower), float(self.upper)
        if self.upper < self.lower:
            raise LagtopError(f"delta must be >= {arg('delta_star')} = {low}, got {high}", "delta")
        if self.g <= 0:
            raise LagtopError(f"g must be > 0, got {float(self.g)}", "g")
        for root in () if self.height else self.outer:
            if root in {self.lower, self.upper}:
                wrong = "an outer root at an end of the band makes the period infinite (k1 = 1)"
                raise LagtopError(f"{wrong}, got {float(root)}")
            if self.lower <= root <= self.upper:
                wrong = "the outer roots must lie outside the band from delta* to delta"
                raise LagtopError(f"{wrong}, [{low}, {high}], got {float(root)}")

    @property
    def inputs(self) -> list[Fraction]:
        """All numbers."""
        return [self.lower, self.upper, *self.outer, self.g, self.height]

    @property
    def layout(self) -> str:
        """The layout of the outer roots, in words."""
        if self.height:
            return "complex pair"
        above = sum(root > self.upper for root in self.outer)
        return (
            ("both at infinity",),
            ("one below", "one above"),
            ("both below", "one on each side", "both above"),
        )[len(self.outer)][above]

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
    """The constants of (3.2.3) to (3.2.12) and the complement k1', in balls.

    For a complex pair of roots, k and k1 are divided by i, and k1' is above 1.  The period is that
    of eta, 4 K1/sigma1.
    """

    m1: arb
    """m' (3.2.3)."""
    m2: arb
    """m'' (3.2.3)."""
    k: arb
    k1: arb
    k1_prime: arb
    sigma1: arb
    s: arb
    d: arb
    gamma: arb
    period: arb

    def modulus(self, quadrature: Quadrature) -> Modulus:
        """Return k1, reduced to [0, 1]; if it is imaginary, k/i is the reduced modulus."""
        if quadrature.height:
            return Modulus(self.k, 1 / self.k1_prime, Kind.IMAGINARY, self.k1_prime)
        return Modulus(self.k1, self.k1_prime)


def eta_constants(quadrature: Quadrature) -> EtaConstants:
    """Return the constants in balls, from distances between roots, so that no digits cancel.

    With D = delta - delta*, and the distance R of the outer roots (1 for one root, 0 for none),

        k1 = D R/r^2,  k1' = 2 sqrt(m' m'')/r,  sigma1 = sqrt(g) r/2,
        T = 2 pi/agm(sigma1, sqrt(g m' m''))

    Here r is m' + m'' if fewer than two outer roots are finite, and sqrt((m' + m'')^2 - D^2) for a
    complex pair.  For two real ones it is sqrt(a1 b2) + sqrt(a2 b1), where a1 and a2 are their
    distances from delta, and b1 and b2 those from delta*.
    """
    lower, upper, outer, g, height = quadrature
    distances = ([abs(root - end) for root in outer] for end in (upper, lower))
    m1, m2 = (exact(prod(x, start=Fraction(1)) + height**2).sqrt() for x in distances)
    width, total, product = exact(upper - lower), m1 + m2, exact(g) * m1 * m2
    r, apart = total, Fraction(len(outer))
    if height:
        r, apart = ((total - width) * (total + width)).sqrt(), 2 * height
    elif len(outer) > 1:
        crossed = (exact(abs((outer[i] - lower) * (outer[1 - i] - upper))) for i in (0, 1))
        r, apart = sum((x.sqrt() for x in crossed), arb(0)), abs(outer[0] - outer[1])
    k1, k1_prime = width * exact(apart) / r**2, 2 * (m1 * m2).sqrt() / r
    k, sigma1 = k1 / k1_prime, exact(g).sqrt() * r / 2
    return EtaConstants(
        *(m1, m2, k, k1, k1_prime, sigma1),
        s=(m2 * exact(upper) - m1 * exact(lower)) / total,
        d=(m2 - m1) / total,
        gamma=(m2 * exact(upper) + m1 * exact(lower)) / total,
        period=2 * arb.pi() / sigma1.agm(product.sqrt()),
    )


def eta_rows(
    tau: Points,
    quadrature: Quadrature,
    names: Collection[str] = ("eta",),
    *,
    units: Units = DEGREES,
    digits: int | None = None,
) -> Rows:
    """Return a table of eta, its rate, h1, theta and xi' over tau, with eta = delta* at tau = 0.

    `names` are some of ETA_COLUMNS.  Raises LagtopError as `Quadrature.check` does and, in doubles,
    for times beyond 2^50 periods.
    """
    quadrature.check()
    if digits is None:
        constants = at_precision(_FIRST_DIGITS, lambda: eta_constants(quadrature))
        check_reach("tau", tau, min(MAX_PERIODS * float(constants.period.mid()), MAX_TIME))

    def known() -> tuple[EtaConstants, Functions]:
        found = eta_constants(quadrature)
        return found, Functions(found.modulus(quadrature))

    def columns(x: ExactComplex, known: tuple[EtaConstants, Functions]) -> Cells:
        found: dict[str, Any] = {}
        for name, y in eta_columns(x.real, quadrature, *known).items():
            if name in {"tau", *names}:
                found |= angle(name, y, units) if name == "theta" else {name: y}
        return found

    return table_rows(Arguments(tau).numbers(digits), columns, known, quadrature.inputs, digits)


def eta_columns(
    tau: Fraction, quadrature: Quadrature, c: EtaConstants, functions: Functions
) -> dict[str, Any]:
    """Return ETA_COLUMNS at a time, theta in radians.

    h1 = sigma1 (tau + tau3) (3.2.10),  theta = am(h1, k1) (3.2.9),  xi' = sn(h1, k1) (3.2.11),
    eta = (gamma + s xi')/(1 + d xi') by (3.2.2) and (3.2.12)
    """
    h1 = c.sigma1 * (exact(tau) - c.period / 4)
    am, sn, cn, dn = (z.real for z in functions.jacobi(Point(h1)) if z is not None)
    denominator = 1 + c.d * sn
    eta: Cell = (c.gamma + c.s * sn) / denominator
    rate: Cell = (c.s - c.d * c.gamma) * c.sigma1 * cn * dn / denominator**2
    if quadrature.lower == quadrature.upper:
        eta, rate = quadrature.lower, Fraction(0)
    return dict(zip(ETA_COLUMNS, (tau, eta, rate, h1, am, sn), strict=True))


def eta_record(quadrature: Quadrature, digits: int | None = None) -> dict[str, Any]:
    """Return the roots and constants, correctly rounded to doubles or to `digits` digits.

    They are None if the layout does not have them.  Raises LagtopError as `Quadrature.check` does,
    and for numbers beyond the doubles.
    """
    quadrature.check()
    lower, upper, outer, g, height = quadrature
    roots: dict[str, Cell] = {"delta": upper, "delta_star": lower, "g": g}
    roots |= {"layout": quadrature.layout, "kind": quadrature.kind}
    if len(outer) > 1:
        roots |= {"p": (outer[0] + outer[1]) / 2, "q": height or abs(outer[0] - outer[1]) / 2}
    elif outer:
        roots["outer_root"] = outer[0]

    def compute(_: int) -> Cells:
        c = eta_constants(quadrature)
        found = roots | c._asdict() | {"m_prime": c.m1, "m_double_prime": c.m2}
        found |= {"K1": c.period * c.sigma1 / 4, "tau3": -c.period / 4}
        if height:
            found |= {f"{key}_imag": found.pop(key) for key in ("q", "k", "k1")}
        return {key: found.get(key) for key, *cells in declared(CONSTANTS) if cells}

    return numbers(compute, quadrature.inputs, digits)
