"""The facts of a motion: its regime and its passages over the poles, decided before any number.

Each fact is the sign of a polynomial in u = cos(theta0) with rational coefficients.  Only the kinds
of motion that differ in a sign have different formulas, so no formula compares numbers with a
threshold.  Equation numbers are Chrapan's; alpha and beta are the constants of (4,4) and (4,5).
"""

from __future__ import annotations

from enum import StrEnum
from fractions import Fraction
from typing import NamedTuple

from flint import arb, fmpq, fmpq_poly

from ..arithmetic.enclosures import equal_digits, sign_to
from ..errors import LagtopError, check_type
from ..top.derived import SLOW, Spin, Tilt, exact_inputs, rates_of, rational
from ..top.inputs import DECLARED, FORMS
from ..top.top import Top


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
_U = fmpq_poly([0, 1])
"""The cosine of the tilt at the start, in polynomials."""


class Facts(NamedTuple):
    """A top in exact numbers, the signs that decide its motion, and what they mean in words."""

    top: Top
    inputs: dict[str, Fraction]
    """The rational inputs among m, A, C, s, g, r0, thetadot0 and psidot0, and forms of them."""
    tilt: Tilt
    equal: int
    """D: two numbers that agree to D digits are equal."""
    a: Fraction
    """2mgs/A (4,4)."""
    b: fmpq_poly
    """C r0/A (4,5), linear in u if r0 is derived from phi'; unused if psidot0 is a word."""
    r0: Spin
    """The total spin rate, linear in psi' if it is derived from phi'."""
    spin: int
    """The sign of r0."""
    pole: int
    """1 if the axis starts upright, -1 if it hangs, else 0."""
    minus: int = 1
    """The sign of beta - b, the momentum at the upper pole.  If 0, 1 is a root of the cubic."""
    plus: int = 1
    """The sign of beta + b, the momentum at the lower pole.  If 0, -1 is a root of the cubic."""
    acceleration: int = 0
    """The sign of theta'' at a start without nutation rate: 1 at u1, -1 at u2, 0 if the tilt stays.

    It is the sign of -u''.
    """
    over: int = 1
    """The sign of alpha - a, if beta = b: the root 1 is u1 if it is 1, u3 if -1, and both if 0."""

    @property
    def released(self) -> bool:
        """Release from rest in nutation and precession, the case of the paper."""
        return self.top.is_released

    @property
    def turning(self) -> int:
        """1 for a start at u1, -1 at u2, 0 between."""
        return self.pole or (0 if self.inputs["thetadot0"] else self.acceleration)

    @property
    def steady(self) -> bool:
        """The tilt does not change."""
        return not (self.inputs["thetadot0"] or self.acceleration)

    @property
    def vertical(self) -> bool:
        """The axis stays on the vertical."""
        return bool(self.pole) and self.steady

    @property
    def separatrix(self) -> bool:
        """The axis rises to the vertical in infinite time: u1 = u3 = 1."""
        return bool(self.a) and not (self.minus or self.over or self.vertical)

    @property
    def nutates(self) -> bool:
        """The tilt oscillates between u1 and u2."""
        return not (self.steady or self.separatrix)

    @property
    def over_top(self) -> bool:
        """The axis passes over the upper pole: u1 = 1."""
        return self.nutates and not self.minus and self.over >= 0

    @property
    def over_bottom(self) -> bool:
        """The axis passes over the lower pole: u2 = -1."""
        return not (self.plus or self.steady)

    @property
    def plane(self) -> bool:
        """The axis moves in a vertical plane, over the lower pole: beta = b = 0."""
        return self.over_bottom and not self.spin

    @property
    def off_poles(self) -> bool:
        """The axis does not pass over a pole."""
        return not (self.over_top or self.over_bottom)

    @property
    def half_off_pole(self) -> bool:
        """The axis is not vertical half a period after the start."""
        return not (self.over_bottom if self.turning > 0 else self.over_top and self.turning < 0)

    @property
    def moves(self) -> bool:
        """The torque, the spin or a rate is not 0."""
        turns = self.top.psidot0 and not self.pole
        return bool(self.a or self.spin or turns or not self.steady)

    @property
    def stable(self) -> bool:
        """An upright top stays upright: lambda = b^2/2a >= 1."""
        return self.sign(self.b * self.b - rational(2 * self.a)) >= 0

    @property
    def fast(self) -> bool:
        """The precession is pseudo-regular: released from rest, with (C r0)^2 >= 100 A m g s."""
        if not self.released or self.regime is not Regime.REGULAR:
            return False
        return self.sign(self.b * self.b - rational(FAST * self.a)) >= 0

    @property
    def regime(self) -> Regime:
        """The kind of motion."""
        if self.vertical:
            return Regime.SLEEPING if self.pole > 0 else Regime.HANGING
        if not self.a:
            return Regime.TORQUE_FREE
        if self.separatrix:
            return Regime.SEPARATRIX
        if self.steady:
            return Regime.STEADY
        return Regime.REGULAR if self.spin else Regime.NO_SPIN

    def sign(self, polynomial: fmpq_poly) -> int:
        """Return the sign of a polynomial in u; 0 if D digits leave it open."""
        return self.tilt.sign(polynomial, self.equal)

    def has_steady_rate(self, word: str) -> bool:
        """Return whether the slow or the fast rate of steady precession exists for r0."""
        level = not self.sign(_U)
        if level:
            return word == SLOW and bool(self.spin)
        if self.top.steady_word:
            return True
        return self.sign(self.b * self.b - rational(2 * self.a) * _U) >= 0


def facts_of(top: Top) -> Facts:
    """Return a top in exact numbers, with the facts of its motion.

    Raises LagtopError for an impossible start: precession on the vertical.
    """
    check_type("top", top, Top)
    names = ["m", "A", "C", "s", "g", "thetadot0", *["psidot0"] * (not top.steady_word)]
    names += [name for name in top.given if name in DECLARED and name in FORMS]
    exact = exact_inputs(top.given)
    inputs, spin = {name: exact[name] for name in names}, top.exact_spin
    m, A, C, s, g = (inputs[name] for name in ("m", "A", "C", "s", "g"))
    a, precession = 2 * m * g * s / A, inputs.get("psidot0", Fraction(0))
    r0 = fmpq_poly([rational(spin.constant), rational(spin.share * precession)])
    tilt = top.exact_tilt
    equal = equal_digits([*inputs.values(), spin.constant, tilt.number])
    if not spin.share:
        inputs["r0"] = spin.constant
    facts = Facts(top, inputs, tilt, equal, a, rational(C / A) * r0, spin, 0, tilt.pole)
    if top.steady_word:
        return facts._replace(spin=_spin_of_a_word(facts))
    if tilt.pole and precession:
        raise LagtopError(
            f"psidot0 must be 0 if the axis is vertical, got {float(precession)} "
            "(a vertical axis cannot precess; count the rate as spin)",
            "psidot0",
        )
    return _decided(facts, rational(precession), rational(inputs["thetadot0"]))


def _decided(facts: Facts, precession: fmpq, nutation: fmpq) -> Facts:
    """Return facts with their signs, from the rates of precession and nutation."""
    a, b, pole, sign = rational(facts.a), facts.b, facts.pole, facts.sign
    # beta - b = (1 - u) (psi' (1 + u) - b) and beta + b = (1 + u) (psi' (1 - u) + b) (4,5)
    minus = 0 if pole > 0 else sign(precession * (1 + _U) - b)
    plus = 0 if pole < 0 else sign(precession * (1 - _U) + b)
    # alpha - a = theta'^2 - (1 - u) (a - psi' b) if beta = b, that is, b = psi' (1 + u)
    at_1 = nutation**2 - (1 - _U) * (a - precession * b)
    over = 1 if minus or (pole and not nutation) else sign(at_1)
    # u'' = -(1 - u^2) (a - 2 b psi' + 2 psi'^2 u)/2 if theta' = 0
    slope = a - 2 * precession * b + 2 * precession**2 * _U
    acceleration = 1 if nutation else 0 if pole else sign(slope)
    return facts._replace(
        spin=sign(b), minus=minus, plus=plus, over=over, acceleration=acceleration
    )


def _spin_of_a_word(facts: Facts) -> int:
    """Return the sign of r0 if psidot0 is given by its word."""
    rates = rates_of(facts.top.given)

    def r0(_: int) -> arb:
        return facts.r0.ball(rates.rate(str(facts.top.steady_word)), facts.tilt)

    return sign_to(r0, facts.equal) if facts.r0.share else facts.sign(facts.b)
