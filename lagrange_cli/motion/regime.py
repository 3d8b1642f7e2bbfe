"""Determine the kind of motion of a scene once, exactly, in fractions.

In each degenerate motion a polynomial in u = cos(theta0) with rational coefficients vanishes.  No
later code compares a computed gap with a threshold.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum
from fractions import Fraction
from typing import Any, TypeVar

from ..arithmetic.exact_cosine import Cosine, Polynomial, U
from ..arithmetic.values import Values
from ..errors import LagtopError, check_type
from ..inputs.top import Top

B = TypeVar("B", bound=Any)
"""A bool, or an array of bools."""


class Regime(StrEnum):
    """Kind of motion; each member compares equal to its text.

    >>> solve(Top(theta0_deg=0)).regime == "sleeping"
    True
    """

    REGULAR = "regular"
    STEADY = "steady precession"
    SEPARATRIX = "separatrix"
    SLEEPING = "sleeping"
    HANGING = "hanging"
    TORQUE_FREE = "torque-free"
    NO_SPIN = "no spin"


FAST = 50
"""Least b^2/a of a pseudo-regular precession, that is, (C r0)^2 = 100 A m g s.

Above it, at any tilt, the axis nutates by at most 1.15 degrees.  The mean precession rate is then
within 1.03 % of the elementary rate.
"""


class Facts(Values):
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
    def over_top(self) -> bool:
        """The axis reaches the upper pole or, on the separatrix, tends to it: beta = b."""
        return bool(self.upper_root) or self.regime is Regime.SEPARATRIX

    @property
    def meets_a_pole(self) -> bool:
        """The axis passes over a pole, or starts there and nutates."""
        return self.over_bottom or self.upper_root == 1

    @property
    def plane(self) -> bool:
        """The axis moves in a vertical plane, over the lower pole: beta = b = 0."""
        return self.over_bottom and not self.spins


class Exact(Values):
    """A scene in exact arithmetic: the constants of (4,4) and (4,5), the start, and the facts."""

    top: Top
    a: Fraction
    """2mgs/A (4,4)."""
    b: Fraction
    """C r0/A (4,5)."""
    r0: Fraction
    theta_rate: Fraction
    psi_rate: Any
    """The precession rate as a fraction; None for an irrational rate of steady precession."""
    cosine: Cosine
    facts: Facts

    @property
    def energy(self) -> Polynomial:
        """theta'^2 + psi'^2 sin^2(theta0) = alpha - a u0 (4,4), as a polynomial in u0."""
        return self.momentum * Polynomial(self.psi_rate) + self.theta_rate**2

    @property
    def momentum(self) -> Polynomial:
        """psi' sin^2(theta0) = beta - b u0 (4,5), as a polynomial in u0."""
        return Polynomial(self.psi_rate, 0, -self.psi_rate)

    @property
    def alpha(self) -> Polynomial:
        """The constant alpha (4,4), as a polynomial in u0."""
        return self.energy + self.a * U

    @property
    def beta(self) -> Polynomial:
        """The constant beta (4,5), as a polynomial in u0."""
        return self.momentum + self.b * U

    @property
    def fall(self) -> Polynomial:
        """u''/sin^2(theta0) as a polynomial in u0, for a start without nutation rate."""
        return _fall(self.a, self.b, self.psi_rate)


def _fall(a: Fraction, b: Fraction, psi_rate: Fraction) -> Polynomial:
    return Polynomial(2 * b * psi_rate - a, -2 * psi_rate * psi_rate)


def exact(top: Top) -> Exact:
    """Return a top in fractions, with the facts of its motion.

    Raises LagtopError for an impossible start: precession on the vertical.
    """
    check_type("top", top, Top)
    m, A, C, s, g, r0, theta_rate = (
        Fraction(x) for x in (top.m, top.A, top.C, top.s, top.g, top.r0, top.thetadot0)
    )
    a, b = 2 * m * g * s / A, C * r0 / A
    degrees, radians = (
        None if x is None else Fraction(x) for x in (top.theta0_deg, top.theta0_rad)
    )
    cosine = Cosine(degrees, radians)
    if top.steady_word:
        from ..inputs.stand_ins import rates_of  # start-up: for few tops

        psi_rate = rates_of(top).fraction(str(top.steady_word))
    else:
        psi_rate = Fraction(top.psidot0)
    if psi_rate is None:
        regime = Regime.STEADY if a else Regime.TORQUE_FREE
        facts = Facts(regime, at_rest=False, steady=True, free=not a, spins=bool(b))
    else:
        if top.pole and psi_rate:
            raise LagtopError(
                f"psidot0 must be 0 if the axis is vertical, got {float(psi_rate)} "
                "(a vertical axis cannot precess; count the rate as spin)",
                "psidot0",
            )
        facts = _facts(top.pole, a, b, (theta_rate, psi_rate), cosine)
    return Exact(top, a, b, r0, theta_rate, psi_rate, cosine, facts)


def _facts(
    pole: int, a: Fraction, b: Fraction, rates: tuple[Fraction, Fraction], cosine: Cosine
) -> Facts:
    """Determine the facts, each from the sign of a polynomial in u = cos(theta0)."""
    theta_rate, psi_rate = rates
    at_rest, vertical = not theta_rate and not psi_rate, bool(pole) and not theta_rate
    # beta - b = (1 - u) (psi' (1 + u) - b) and beta + b = (1 + u) (psi' (1 - u) + b) (4,5)
    minus = 0 if pole == 1 else cosine.sign(Polynomial(psi_rate - b, psi_rate))
    plus = 0 if pole == -1 else cosine.sign(Polynomial(psi_rate + b, -psi_rate))
    # if beta = b, 1 is a root, and alpha - a = theta'^2 - (1 - u) (a - psi' b) says which
    slope = a - psi_rate * b
    over = 0 if minus else cosine.sign(Polynomial(theta_rate * theta_rate - slope, slope))
    steady = not theta_rate and (vertical or cosine.vanishes(_fall(a, b, psi_rate)))
    separatrix = not minus and not over and bool(a) and not vertical
    upper_root = 0
    if not minus and not vertical and not separatrix:
        upper_root = 3 if over < 0 else int(not steady)
    # beta/b is a root: b theta'^2 + psi' (b psi' - a) (1 - u^2); it is u1 if it is less than 1,
    # and u3 if it is more
    stands = psi_rate * (b * psi_rate - a)
    is_root = bool(minus * b) and cosine.vanishes(
        Polynomial(stands + b * theta_rate * theta_rate, 0, -stands)
    )
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
