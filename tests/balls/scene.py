"""The formulas of the reference in ball arithmetic, at one precision, by Arb (python-flint).

Every result is a ball that is proved to hold the exact value.  The formulas are this module's own:
the cubic of (4,9) with the roots that are known exactly split off, Legendre's integrals of the
first and the third kind about the lowest point by Arb's own routines, and sn, cn, dn from Arb's
theta functions.  Nothing is imported from the program that is checked.

    f(u) = (1 - u^2)(alpha - a u) - (beta - b u)^2 = 0 at u2 <= u1 <= 1 <= u3
    u = u2 + (u1 - u2) sn^2 w,    w = w0 + sqrt(a (u3 - u2)) t/2
    (psi +- phi)/2 = +-(r0 - b) t/2 + (beta +- b)/2 * integral of dt/(1 +- u)

The inputs are rational, so that every degenerate motion is decided exactly: the cosine of a
rational number of degrees is rational at 0, 60, 90, 120 and 180 only (Niven), that of a rational
number of radians at 0 only (Lindemann), and each condition is of the first degree in the cosine.
A precision that leaves something open raises `Undecided`, and the next one is tried.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

import mpmath
from flint import arb, ctx, fmpq

Number = Fraction | float | int | str

_COSINES = {0: Fraction(1), 60: Fraction(1, 2), 90: Fraction(0), 120: Fraction(-1, 2)}
_COSINES[180] = Fraction(-1)


class Undecided(Exception):
    """A question that this precision leaves open."""


class Scene(NamedTuple):
    """The exact inputs of a top; the tilt in degrees, or in radians."""

    a: Fraction
    b: Fraction
    r0: Fraction
    degrees: Fraction | None
    radians: Fraction | None
    theta_rate: Fraction
    psi_rate: Fraction

    @property
    def cosine(self) -> Fraction | None:
        """The cosine of the tilt where it is rational."""
        if self.degrees is None:
            return Fraction(1) if self.radians == 0 else None
        return _COSINES.get(int(self.degrees)) if self.degrees.denominator == 1 else None

    def vanishes(self, constant: Fraction, slope: Fraction) -> bool:
        """Return whether constant + slope cos(theta0) is exactly 0."""
        if self.cosine is None:
            return constant == 0 and slope == 0
        return constant + slope * self.cosine == 0


def scene_from(inputs: Mapping[str, Number | None]) -> Scene:
    """Return the scene of inputs under the program's names, which count as exact numbers."""
    known = {key: Fraction(value) for key, value in inputs.items() if value is not None}
    m, A, C, s, g = (known[key] for key in "mACsg")
    return Scene(
        a=2 * m * g * s / A,
        b=C * known["r0"] / A,
        r0=known["r0"],
        degrees=known.get("theta0_deg"),
        radians=known.get("theta0_rad"),
        theta_rate=known.get("thetadot0", Fraction(0)),
        psi_rate=known.get("psidot0", Fraction(0)),
    )


class Facts(NamedTuple):
    """The exact facts of a scene."""

    pole: int
    """1 where the axis starts upright, -1 where it hangs, else 0."""
    over_top: bool
    """Whether beta = b, so that 1 is a root."""
    over_bottom: bool
    steady: bool
    separatrix: bool

    @property
    def vertical(self) -> bool:
        """Whether the axis stays on the vertical."""
        return self.steady and self.pole != 0


def facts_of(scene: Scene) -> Facts:
    """Return what is exactly true of a scene."""
    a, b, turn, rise = scene.a, scene.b, scene.psi_rate, scene.theta_rate
    pole = int(scene.cosine) if scene.cosine in (1, -1) else 0
    over_top = pole == 1 or scene.vanishes(turn - b, turn)
    fits = scene.vanishes(rise**2 + turn * b - a, a - turn * b)
    balanced = scene.vanishes(2 * b * turn - a, -2 * turn**2)
    return Facts(
        pole=pole,
        over_top=over_top,
        over_bottom=pole == -1 or scene.vanishes(turn + b, -turn),
        steady=rise == 0 and (pole != 0 or balanced),
        separatrix=pole == 0 and over_top and a > 0 and fits,
    )


def middle(ball: arb) -> Fraction:
    mantissa, exponent = ball.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def rational(value: Fraction) -> fmpq:
    return fmpq(value.numerator, value.denominator)


def exact_arb(value: Decimal | Fraction | float | str) -> arb:
    """Return an exact number in Arb."""
    return arb(rational(Fraction(value)))


def many_digits(ball: arb) -> Any:
    """Return the middle of a ball as a number of mpmath, to 60 digits."""
    with mpmath.workdps(60):
        return mpmath.mpf(ball.mid().str(60, radius=False))


@contextmanager
def arb_bits(bits: int) -> Iterator[None]:
    """Set the precision of Arb, in bits, within a block."""
    before, ctx.prec = ctx.prec, bits
    try:
        yield
    finally:
        ctx.prec = before
