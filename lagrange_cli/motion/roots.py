"""The cubic behind the nutation: its coefficients, its roots and the gaps between them.

Everything later is a formula in the gaps, and each gap is computed so that it keeps its relative
accuracy.  Equation numbers in parentheses are those of Chrapan (1952).
"""

# Annotations are evaluated here: as texts, the named tuples would compile each at start-up.

from fractions import Fraction
from typing import NamedTuple

from ..arithmetic.generic import Arithmetic, Real, number, where
from ..inputs.top import Tilt, Top


class Invariants(NamedTuple):
    """Ratios of the inputs, each rounded once from its exact value."""

    a: Real
    """2mgs/A (4,4)."""
    b: Real
    """C r0/A (4,5)."""
    lam: Real
    """lambda = b^2/2a = (u3 + u2)/2 (4,11); the upright top sleeps stably where it is >= 1."""
    lam_minus_1: Real
    drift: Real
    """r0 - b/2 = r0 (1 - C/2A), the spin rate less what the nutation does to it (6,1)."""
    rate_half: Real | None
    """2mgs/(C r0) = a/b, the precession rate at T/2 after release from rest; None without spin."""


class Roots(NamedTuple):
    """Roots u2 <= u1 <= 1 <= u3 of the cubic (4,9), and the gaps between them and the poles +-1."""

    u1: Real
    u2: Real
    u3: Real | None
    """None without torque, where it is infinite."""
    u1_u2: Real
    u3_u1: Real
    """Without torque, this and every other gap to u3 is 1, so that their ratios are right."""
    u3_u2: Real
    below_u1: Real
    """1 + u1."""
    below_u2: Real
    """1 + u2."""
    below_u3: Real
    """1 + u3."""
    above_u1: Real
    """1 - u1."""
    above_u2: Real
    """1 - u2."""
    u3_above: Real
    """u3 - 1."""


def invariants(ar: Arithmetic, top: Top) -> Invariants:
    """(4,4), (4,5) and their combinations, formed as exact fractions and rounded once."""
    m, A, C, s, g, r0 = (Fraction(x) for x in (top.m, top.A, top.C, top.s, top.g, top.r0))
    torque = m * g * s
    lam = C * C * r0 * r0 / (4 * A * torque) if torque else Fraction(0)
    exact = Invariants(
        a=2 * torque / A,
        b=C * r0 / A,
        lam=lam,
        lam_minus_1=lam - 1,
        drift=r0 * (1 - C / (2 * A)),
        rate_half=2 * torque / (C * r0) if r0 else None,
    )
    return Invariants(*(None if x is None else number(ar, x) for x in exact))


def roots_from_rest(ar: Arithmetic, lam: Real, lam_minus_1: Real, tilt: Tilt) -> Roots:
    """Roots of (4,9) for release from rest, from (4,11)-(4,18) without a cancelling difference.

    With S, Q = sin^2, cos^2 of theta0/2:  (u3 - u1)(u1 - u2) = 4 S Q,
    (u3 - 1)(1 - u2) = 4 lam S,  (u3 + 1)(1 + u2) = 4 lam Q; in each pair the larger factor is a sum
    of positive terms and the smaller one the quotient.
    """
    S, Q = tilt.sin_half * tilt.sin_half, tilt.cos_half * tilt.cos_half
    x = where(S <= Q, lam_minus_1 + 2 * S, (lam + 1) - 2 * Q)
    rho = ar.hypot(x, tilt.sin)
    larger = rho + abs(x)
    smaller = tilt.sin * (tilt.sin / larger)
    larger_1 = rho + abs(lam_minus_1)
    smaller_1 = 4 * lam * S / larger_1
    fast = lam_minus_1 >= 0
    above_u2 = where(fast, smaller_1, larger_1)
    u3_above = where(fast, larger_1, smaller_1)
    below_u3 = lam + 1 + rho
    below_u2 = 4 * lam * Q / below_u3
    return Roots(
        u1=tilt.cos,
        u2=where(above_u2 < below_u2, 1 - above_u2, below_u2 - 1),
        u3=where(fast, lam + rho, 1 + u3_above),
        u1_u2=where(x >= 0, smaller, larger),
        u3_u1=where(x >= 0, larger, smaller),
        u3_u2=2 * rho,
        below_u1=2 * Q,
        below_u2=below_u2,
        below_u3=below_u3,
        above_u1=2 * S,
        above_u2=above_u2,
        u3_above=u3_above,
    )
