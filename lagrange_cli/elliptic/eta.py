"""Aksenov section 3.2: eta(tau) from its quadrature, and any other with the same kind of roots.

    (d eta/d tau)^2 = g (delta - eta)(eta - delta*) times the distances of eta from the outer roots

Of the two outer roots p +- q one lies on each side of the band [delta*, delta] (the satellite), or
both on one side (hyperbolic motion), or one is at infinity (parabolic motion; Lagrange's top).  The
roots are exact rationals, so their gaps are; and what is made of the gaps are sums and products of
positive numbers, so that nothing is lost as roots come close to each other.
"""

from __future__ import annotations

from fractions import Fraction
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.correct_digits import require_digits, settle, settled_or_rounded
from ..arithmetic.generic import Arithmetic, Real, many_digits, number, where
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, check_reach
from ..errors import LagtopError
from . import agm
from .jacobi import jacobi
from .modulus import Modulus

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..arithmetic.correct_digits import NumberText
    from ..arithmetic.points import Points
    from ..arithmetic.types import Array


class Quadrature(NamedTuple):
    """The radicand: the band, one or two outer roots, and g, which is -2 alpha1 c^2 in (3.2.1).

    `check` it before use.
    """

    lower: Fraction
    """delta*."""
    upper: Fraction
    """delta."""
    outer: tuple[Fraction, ...]
    g: Fraction = Fraction(1)

    def check(self) -> None:
        """Raise LagtopError unless the motion is periodic: an empty band, an outer root in it."""
        if self.upper < self.lower:
            raise LagtopError(
                f"delta must be >= delta_star = {float(self.lower)}, got {float(self.upper)}"
            )
        if self.g <= 0:
            raise LagtopError(f"g must be > 0, got {float(self.g)}")
        for root in self.outer:
            if self.lower <= root <= self.upper:
                raise LagtopError(
                    "the outer roots must lie outside [delta_star, delta] = "
                    f"[{float(self.lower)}, {float(self.upper)}], got {float(root)}"
                )

    @property
    def layout(self) -> str:
        """Where the outer roots are."""
        above = sum(root > self.upper for root in self.outer)
        if len(self.outer) == 1:
            return "one above" if above else "one below"
        return ("both below", "one on each side", "both above")[above]


class Constants(NamedTuple):
    """The constants of (3.2.3) to (3.2.12) in some arithmetic, and k1' beside k1."""

    m1: Real
    """m' (3.2.3)."""
    m2: Real
    """m'' (3.2.3)."""
    k: Real
    """(3.2.5)."""
    k1: Real
    """(3.2.8)."""
    k1_prime: Real
    sigma1: Real
    """(3.2.8)."""
    s: Real
    """(3.2.12)."""
    d: Real
    """(3.2.12)."""
    gamma: Real
    """(3.2.12)."""
    period: Real
    """In tau: 4 K1/sigma1."""


def constants(ar: Arithmetic, of: Quadrature) -> Constants:
    """The constants in an mpmath context.

    m'^2 and m''^2 are products of the distances of delta and delta* from the outer roots, and
    2 sigma1/sqrt(g) is a sum of square roots of such products, in each layout.
    """
    lower, upper, g = (number(ar, x) for x in (of.lower, of.upper, of.g))
    to_lower = [number(ar, abs(root - of.lower)) for root in of.outer]
    to_upper = [number(ar, abs(root - of.upper)) for root in of.outer]
    apart = number(ar, abs(of.outer[0] - of.outer[-1]) if len(of.outer) > 1 else Fraction(1))
    m1, m2 = ar.sqrt(prod(to_upper)), ar.sqrt(prod(to_lower))
    if len(of.outer) > 1:
        crossed = ar.sqrt(to_lower[0] * to_upper[1]) + ar.sqrt(to_lower[1] * to_upper[0])
    else:
        crossed = m1 + m2
    sigma1 = ar.sqrt(g) * crossed / 2
    k1 = number(ar, of.upper - of.lower) * apart / crossed**2
    k1_prime = 2 * ar.sqrt(m1 * m2) / crossed
    return Constants(
        m1=m1,
        m2=m2,
        k=k1 / k1_prime,
        k1=k1,
        k1_prime=k1_prime,
        sigma1=sigma1,
        s=(m2 * upper - m1 * lower) / (m1 + m2),
        d=(m2 - m1) / (m1 + m2),
        gamma=(m2 * upper + m1 * lower) / (m1 + m2),
        period=2 * ar.pi / agm(ar, sigma1, ar.sqrt(g * m1 * m2)),
    )


def record(of: Quadrature, digits: int | None = None) -> dict[str, Any]:
    """Roots and constants, each the nearest double or to so many significant digits.

    Raises LagtopError as `Quadrature.check` does.
    """
    of.check()
    return settled_or_rounded(lambda ar: _record_in(ar, of), digits)


def _record_in(ar: Arithmetic, of: Quadrature) -> dict[str, Any]:
    c = constants(ar, of)
    first, second = (number(ar, root) for root in (of.outer[0], of.outer[-1]))
    pair_of_roots = len(of.outer) > 1
    return {
        "delta": number(ar, of.upper),
        "delta_star": number(ar, of.lower),
        "p": (first + second) / 2 if pair_of_roots else None,
        "q": abs(first - second) / 2 if pair_of_roots else None,
        "outer_root": None if pair_of_roots else first,
        "g": number(ar, of.g),
        "layout": of.layout,
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

    lower: Real
    upper: Real
    width: Real
    below: list[Real]
    """Distances of the outer roots that lie below, from delta*."""
    above: list[Real]
    """And above, from delta."""
    g: Real


def band(ar: Arithmetic, of: Quadrature) -> Band:
    """The gaps of the exact roots, each rounded once."""
    return Band(
        lower=number(ar, of.lower),
        upper=number(ar, of.upper),
        width=number(ar, of.upper - of.lower),
        below=[number(ar, of.lower - root) for root in of.outer if root < of.lower],
        above=[number(ar, root - of.upper) for root in of.outer if root > of.upper],
        g=number(ar, of.g),
    )


def eta_and_rate(ar: Arithmetic, v: Real, c: Constants, of: Band) -> tuple[Real, Real]:
    """eta and d eta/d tau where v = sigma1 w/2, w the time since a passage of delta*.

    eta - delta* : delta - eta = (sqrt(g) m'' sn v)^2 : (sigma1 cn v dn v)^2, which is (3.2.10) to
    (3.2.12) after a halving of the argument: both distances keep their digits.
    """
    _, sn, cn, dn = jacobi(ar, v, Modulus(c.k1, c.k1_prime, 0 * c.k1))
    up, down = abs(ar.sqrt(of.g) * c.m2 * sn), abs(c.sigma1 * cn * dn)
    larger = where(up < down, down, up)  # so that no square leaves the range
    up, down = (up / larger) ** 2, (down / larger) ** 2
    risen, left = of.width * up / (up + down), of.width * down / (up + down)
    eta = where(risen < left, of.lower + risen, of.upper - left)
    gaps = [gap + risen for gap in of.below] + [gap + left for gap in of.above]
    size = prod(map(ar.sqrt, (of.g, risen, left, *gaps)))
    return eta, where(sn * cn < 0, -size, size)


def rows(of: Quadrature, times: Points, c3: Fraction) -> tuple[list[str], Iterator[Array]]:
    """Header tau, eta, etadot and blocks of rows; eta = delta* at tau = -c3.

    Raises LagtopError as `Quadrature.check` does.
    """
    import numpy as np

    from ..arithmetic.double_double import pair, reduce_phase
    from . import complete_k

    of.check()
    exact = many_digits()
    constants_exact = constants(exact, of)
    rate = pair(1 / constants_exact.period)
    offset = number(exact, c3) / constants_exact.period
    shift = float(offset - exact.nint(offset))
    c, ends = Constants(*map(float, constants_exact)), band(np, of)
    check_reach("tau", times, min(MAX_PERIODS * c.period, MAX_TIME))
    half_period = 2 * complete_k(np, np.float64(c.k1_prime))

    def block(tau: Array) -> Array:
        _, since = reduce_phase(tau, rate, shift)
        return np.stack([tau, *eta_and_rate(np, half_period * (since + shift), c, ends)], axis=1)

    return ["tau", "eta", "etadot"], (block(tau) for tau in times.blocks())


def digit_rows(
    of: Quadrature, times: Points, c3: Fraction, digits: int
) -> tuple[list[str], Iterator[list[NumberText]]]:
    """The same to so many significant digits."""
    of.check()

    def at(tau: Fraction) -> list[NumberText]:
        def compute(ar: Arithmetic) -> dict[str, Real]:
            c, time = constants(ar, of), number(ar, tau + c3)
            require_digits(ar, digits, abs(time / c.period))
            eta, rate = eta_and_rate(ar, c.sigma1 * time / 2, c, band(ar, of))
            return {"tau": number(ar, tau), "eta": eta, "etadot": rate}

        return list(settle(compute, digits).values())

    return ["tau", "eta", "etadot"], (at(tau) for tau in times.decimals())
