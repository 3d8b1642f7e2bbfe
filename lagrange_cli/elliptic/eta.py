"""Eta(tau) from the quadrature of Aksenov section 3.2, for all real roots and a complex pair.

    (d eta/d tau)^2 = g (delta - eta)(eta - delta*) times the distances of eta from the outer roots

The two outer roots p +- q have these layouts:

- One lies on each side of the band [delta*, delta] (the satellite).
- Both lie on one side, or beside the band as a complex pair (hyperbolic motion).
- One or both are at infinity (parabolic motion; Lagrange's top).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from fractions import Fraction
from math import prod
from typing import Any, NamedTuple

from flint import arb

from ..arithmetic.ball import balls
from ..arithmetic.rounding import FIRST_DIGITS, equal_digits
from ..errors import LagtopError
from ..top.ranges import MAX_PERIODS, MAX_TIME, Points, check_reach
from .enclosures import Value, exact, record
from .functions import Functions, Point
from .modulus import Kind, Modulus
from .tables import TableOfFunctions, nearest

ETA_COLUMNS = ("tau", "eta", "etadot", "h1", "theta", "xi_prime")
"""The columns; tau is always included."""


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

    def check(self) -> None:
        """Raise LagtopError unless lower <= upper, g > 0 and the band has no real outer root."""
        low, high = float(self.lower), float(self.upper)
        if self.upper < self.lower:
            raise LagtopError(f"delta must be >= delta_star = {low}, got {high}", "delta")
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
                    f"[{low}, {high}], got {float(root)}"
                )

    @property
    def inputs(self) -> list[Fraction]:
        """All numbers."""
        return [self.lower, self.upper, *self.outer, self.g, self.height]

    @property
    def is_still(self) -> bool:
        """Whether the band is a double root, so that eta is constant."""
        return self.lower == self.upper

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
        if self.is_still:
            return f"{degree}, the band is a double root: eta is constant"
        if not self.outer:
            return "quadratic, k1 = 0: a harmonic oscillation"
        if len(set(self.outer)) < len(self.outer) and not self.height:
            return "quartic with a double outer root, k1 = 0: circular functions"
        return "quartic, k1 is imaginary" if self.height else degree


class EtaConstants(NamedTuple):
    """The constants of (3.2.3) to (3.2.12) and the complement k1', in balls."""

    m1: arb
    """m' (3.2.3)."""
    m2: arb
    """m'' (3.2.3)."""
    k: arb
    """Modulus k (3.2.5), or k/i for a complex pair of roots."""
    k1: arb
    """Modulus k1 (3.2.8), or k1/i for a complex pair of roots."""
    k1_prime: arb
    """Complement of k1; it is above 1 if k1 is imaginary."""
    sigma1: arb
    """Rate of the argument (3.2.8)."""
    s: arb
    """Amplitude of sn (3.2.12)."""
    d: arb
    """Coefficient of the denominator (3.2.12)."""
    gamma: arb
    """Shift (3.2.12)."""
    period: arb
    """Period of eta, 4 K1/sigma1."""

    def modulus(self, quadrature: Quadrature) -> Modulus:
        """Return k1, reduced to [0, 1]; if it is imaginary, k/i is the reduced modulus."""
        if quadrature.height:
            return Modulus(self.k, 1 / self.k1_prime, Kind.IMAGINARY, self.k1_prime)
        return Modulus(self.k1, self.k1_prime)


def eta_constants(quadrature: Quadrature) -> EtaConstants:
    """Return the constants in balls."""
    lower, upper, outer, g, height = quadrature
    m1, m2 = (exact(square).sqrt() for square in quadrature.squares)
    width, total, product = exact(upper - lower), m1 + m2, exact(g) * m1 * m2
    if height:
        # k^2 is negative in (3.2.5) and above -1
        square = (width**2 - (m1 - m2) ** 2).nonnegative_part() / (4 * m1 * m2)
        k = arb(0) if quadrature.is_still else square.sqrt()
        sigma1 = (exact(g) * (total - width) * (total + width)).sqrt() / 2
        k1_prime = product.sqrt() / sigma1
        k1 = k * k1_prime
    else:
        crossed, apart = total, Fraction(len(outer))
        if len(outer) > 1:
            ways = (exact(abs((outer[i] - lower) * (outer[1 - i] - upper))) for i in (0, 1))
            crossed, apart = sum((way.sqrt() for way in ways), arb(0)), abs(outer[0] - outer[1])
        k1, k1_prime = width * exact(apart) / crossed**2, 2 * (m1 * m2).sqrt() / crossed
        k, sigma1 = k1 / k1_prime, exact(g).sqrt() * crossed / 2
    return EtaConstants(
        *(m1, m2, k, k1, k1_prime, sigma1),
        s=(m2 * exact(upper) - m1 * exact(lower)) / total,
        d=(m2 - m1) / total,
        gamma=(m2 * exact(upper) + m1 * exact(lower)) / total,
        period=2 * arb.pi() / sigma1.agm(product.sqrt()),
    )


class EtaTable(TableOfFunctions):
    """Tables of eta, its rate, h1, theta and xi' over tau, with eta = delta* at tau = 0.

    Raises LagtopError as `Quadrature.check` does and, in doubles, for times beyond 2^50 periods.
    """

    def __init__(
        self,
        points: Points,
        quadrature: Quadrature,
        *,
        names: Collection[str] = ("eta",),
        angle: str = "deg",
    ) -> None:
        """Take the inputs; `names` are some of ETA_COLUMNS, `angle` is the unit, deg or rad."""
        super().__init__()
        self.points, self.count, self.quadrature = points, points.count, quadrature
        self.names, self.angle = {"tau", *names}, angle

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError unless the motion is periodic; see the class for doubles."""
        self.quadrature.check()
        if doubles:
            with balls(FIRST_DIGITS):
                period = float(eta_constants(self.quadrature).period.mid())
            check_reach("tau", self.points, min(MAX_PERIODS * period, MAX_TIME))

    def arguments(self, *, doubles: bool) -> Iterator[Fraction]:
        """Yield the times."""
        times = self.points.decimals()
        return map(nearest, times) if doubles else times

    def inputs(self, x: Fraction) -> Iterable[Fraction]:
        """Return the time and the numbers of the quadrature."""
        return [x, *self.quadrature.inputs]

    def constants(self) -> tuple[EtaConstants, Functions]:
        """Return the constants, and the functions of k1."""
        found = eta_constants(self.quadrature)
        return found, Functions(found.modulus(self.quadrature))

    def columns(self, x: Fraction, constants: tuple[EtaConstants, Functions]) -> dict[str, Value]:
        """Return the columns at a time.

        h1 = sigma1 (tau + tau3) (3.2.10),  theta = am(h1, k1) (3.2.9),  xi' = sn(h1, k1),
        eta = (gamma + s xi')/(1 + d xi') (3.2.11)
        """
        c, functions = constants
        h1 = c.sigma1 * (exact(x) - c.period / 4)
        am, sn, cn, dn = (z.real for z in functions.jacobi(Point(h1)) if z is not None)
        below = 1 + c.d * sn
        eta: Value = (c.gamma + c.s * sn) / below
        rate: Value = (c.s - c.d * c.gamma) * c.sigma1 * cn * dn / below**2
        if self.quadrature.is_still:
            eta, rate = self.quadrature.lower, Fraction(0)
        theta = am if self.angle == "rad" else am * 180 / arb.pi()
        values = dict(zip(ETA_COLUMNS, (x, eta, rate, h1, theta, sn), strict=True))
        found = {name: value for name, value in values.items() if name in self.names}
        return {f"theta_{self.angle}" if x == "theta" else x: y for x, y in found.items()}


def eta_record(quadrature: Quadrature, digits: int | None = None) -> dict[str, Any]:
    """Return the roots and constants, correctly rounded to doubles or to `digits` digits.

    Raises LagtopError as `Quadrature.check` does, and for numbers beyond the doubles.
    """
    quadrature.check()
    most = equal_digits(quadrature.inputs, digits or 0)
    return record(lambda: _constants_by_key(quadrature), digits, most)


def _constants_by_key(quadrature: Quadrature) -> dict[str, Value]:
    """Return the record in balls; None for keys that the layout does not have."""
    c, outer = eta_constants(quadrature), quadrature.outer
    is_pair, is_imaginary = len(outer) > 1, bool(quadrature.height)
    return {
        "delta": quadrature.upper,
        "delta_star": quadrature.lower,
        "p": (outer[0] + outer[-1]) / 2 if is_pair else None,
        "q": abs(outer[0] - outer[1]) / 2 if is_pair and not is_imaginary else None,
        "q_imag": quadrature.height if is_imaginary else None,
        "outer_root": outer[0] if len(outer) == 1 else None,
        "g": quadrature.g,
        "layout": quadrature.layout,
        "kind": quadrature.kind,
        "m_prime": c.m1,
        "m_double_prime": c.m2,
        "k": None if is_imaginary else c.k,
        "k_imag": c.k if is_imaginary else None,
        "k1": None if is_imaginary else c.k1,
        "k1_imag": c.k1 if is_imaginary else None,
        "k1_prime": c.k1_prime,
        "K1": c.period * c.sigma1 / 4,
        "sigma1": c.sigma1,
        "s": c.s,
        "d": c.d,
        "gamma": c.gamma,
        "period": c.period,
        "tau3": -c.period / 4,
    }
