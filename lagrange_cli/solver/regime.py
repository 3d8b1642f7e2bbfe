"""Determine the kind of motion of a scene once, from the signs of polynomials in u = cos(theta0).

The coefficients are fractions.  In each degenerate motion such a polynomial is 0 to D digits (see
`arithmetic.rounding`).  No later code compares a computed gap with a threshold.  Equation numbers
are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

from ..arithmetic.angle import Angle
from ..arithmetic.rounding import equal_digits
from ..errors import LagtopError, check_type
from ..top.top import Top
from .facts import FAST, Regime

B = TypeVar("B", bound=Any)
"""A bool, or an array of bools."""


class Facts(NamedTuple):
    """Properties of a motion that are decided before any computation: bools, or arrays of bools."""

    regime: Regime
    """The regime, the same for a whole array."""
    at_rest: bool
    """Release from rest in nutation and precession, the case of the paper."""
    steady: bool
    """The tilt does not change."""
    free: bool
    """No torque."""
    spins: bool
    """r0 is not 0."""
    pole: int = 0
    """1 if the axis starts upright, -1 if it hangs, else 0."""
    upper_root: int = 0
    """The number of the root of the cubic that is exactly 1: 1, 3, or 0 for none."""
    over_bottom: bool = False
    """u2 is exactly -1."""
    cusp: bool = False
    """The precession stops at u1."""
    drifts: bool = False
    """beta = b u3: the mean spin rate is the drift r0 - b/2 alone."""
    sign_plus: Any = 1
    """Sign of beta + b; 1 if it is 0, as the limit is the same from both sides."""
    sign_minus: Any = 1
    """Sign of beta - b; 1 if it is 0."""
    stable: Any = True
    """b^2 >= 2a: an upright top stays upright."""
    fast: bool = False
    """The precession is pseudo-regular: released from rest, with (C r0)^2 >= 100 A m g s."""

    @property
    def falls(self) -> bool:
        """The top starts at rest and nutates, so that no digits cancel in its gaps."""
        return self.at_rest and not (self.steady or self.regime is Regime.SEPARATRIX)

    @property
    def meets_a_pole(self) -> bool:
        """The axis passes over a pole, or starts there and nutates."""
        return self.over_bottom or self.upper_root == 1

    @property
    def plane(self) -> bool:
        """The axis moves in a vertical plane, over the lower pole: beta = b = 0."""
        return self.over_bottom and not self.spins


class Exact(NamedTuple):
    """A scene in exact arithmetic: the constants of (4,4) and (4,5), the start, and the facts."""

    top: Top
    a: Fraction
    """2mgs/A (4,4)."""
    b: Fraction
    """C r0/A (4,5)."""
    r0: Fraction
    theta_rate: Fraction
    psi_rate: Fraction | None
    """The precession rate; None for a steady precession that is given by its word."""
    tilt: Angle
    equal: int
    """D: two numbers that agree to D digits are equal."""
    facts: Facts


def exact(top: Top) -> Exact:
    """Return a top in fractions, with the facts of its motion.

    Raises LagtopError for an impossible start: precession on the vertical.
    """
    check_type("top", top, Top)
    given = [top.exact(x) for x in ("m", "A", "C", "s", "g")]
    m, A, C, s, g = given
    r0, theta_rate, psi_rate = (Fraction(x) for x in (top.r0, top.thetadot0, top.psidot0))
    a, b, tilt = 2 * m * g * s / A, C * r0 / A, top.angle
    equal = equal_digits([*given, r0, theta_rate, psi_rate, *(x for x in tilt if x is not None)])
    if top.steady_word:
        regime = Regime.STEADY if a else Regime.TORQUE_FREE
        facts = Facts(regime, at_rest=False, steady=True, free=not a, spins=bool(b))
        return Exact(top, a, b, r0, theta_rate, None, tilt, equal, facts)
    if top.pole and psi_rate:
        raise LagtopError(
            f"psidot0 must be 0 if the axis is vertical, got {float(psi_rate)} "
            "(a vertical axis cannot precess; count the rate as spin)",
            "psidot0",
        )

    def sign(*coefficients: Fraction) -> int:
        return tilt.sign(*coefficients, most=equal)

    facts = _facts(top.pole, a, b, (theta_rate, psi_rate), sign)
    return Exact(top, a, b, r0, theta_rate, psi_rate, tilt, equal, facts)


def _facts(
    pole: int,
    a: Fraction,
    b: Fraction,
    rates: tuple[Fraction, Fraction],
    sign: Callable[..., int],
) -> Facts:
    """Determine the facts, each from the `sign` of a polynomial in u = cos(theta0)."""
    theta_rate, psi_rate = rates
    at_rest, vertical = not theta_rate and not psi_rate, bool(pole) and not theta_rate
    # beta - b = (1 - u) (psi' (1 + u) - b) and beta + b = (1 + u) (psi' (1 - u) + b) (4,5)
    minus = 0 if pole == 1 else sign(psi_rate - b, psi_rate)
    plus = 0 if pole == -1 else sign(psi_rate + b, -psi_rate)
    # if beta = b, 1 is a root, and alpha - a = theta'^2 - (1 - u) (a - psi' b) says which
    slope = a - psi_rate * b
    over = 0 if minus else sign(theta_rate * theta_rate - slope, slope)
    # without nutation rate, u''/sin^2(theta0) is this polynomial
    falls = sign(2 * b * psi_rate - a, -2 * psi_rate * psi_rate) if not theta_rate else 1
    steady = vertical or not falls
    separatrix = not minus and not over and bool(a) and not vertical
    upper_root = 0
    if not minus and not vertical and not separatrix:
        upper_root = 3 if over < 0 else int(not steady)
    # beta/b is a root: b theta'^2 + psi' (b psi' - a) (1 - u^2); it is u1 if it is less than 1,
    # and u3 if it is more
    stands = psi_rate * (b * psi_rate - a)
    is_root = bool(minus * b) and not sign(stands + b * theta_rate * theta_rate, 0, -stands)
    named = regimes(
        upright=vertical and pole > 0,
        hanging=vertical and pole < 0,
        free=not a,
        separatrix=separatrix,
        steady=steady,
        no_spin=not b,
    )
    regime = next(regime for regime, holds in named if holds)
    return Facts(
        regime=regime,
        at_rest=at_rest,
        steady=steady,
        free=not a,
        spins=bool(b),
        pole=pole,
        upper_root=upper_root,
        over_bottom=not plus and not steady,
        cusp=is_root and minus * b < 0,
        drifts=is_root and minus * b > 0,
        sign_plus=plus or 1,
        sign_minus=minus or 1,
        stable=b * b >= 2 * a,
        fast=at_rest and regime is Regime.REGULAR and b * b >= FAST * a,
    )


def regimes(
    *, upright: B, hanging: B, free: B, separatrix: B, steady: B, no_spin: B
) -> Iterator[tuple[Regime, B]]:
    """Yield each regime with its condition; only the first true condition stays true.

    The conditions are bools, or masks of an array of tops.
    """
    none: B = upright ^ upright
    left = none ^ True
    for regime, condition in (
        (Regime.SLEEPING, upright),
        (Regime.HANGING, hanging),
        (Regime.TORQUE_FREE, free),
        (Regime.SEPARATRIX, separatrix),
        (Regime.STEADY, steady),
        (Regime.NO_SPIN, no_spin),
        (Regime.REGULAR, left),
    ):
        holds = left & condition
        left = left ^ holds
        yield regime, holds
