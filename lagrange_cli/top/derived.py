"""Exact tilts, and inputs that are derived from others: A, r0 and the rates of steady precession.

The tilt stays constant if A cos(theta) Omega^2 - C r0 Omega + mgs = 0.  With a = 2mgs/A (4,4) and b
= C r0/A (4,5) this is cos(theta) Omega^2 - b Omega + a/2 = 0.  A form of r0 may contain the rate of
precession: for r0 = constant + share Omega cos(theta), such as phidot0 + Omega cos(theta), it is
(1 - share C/A) cos(theta) Omega^2 - C/A constant Omega + a/2 = 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from flint import arb, arb_poly, fmpq, fmpq_poly

from ..arithmetic.enclosures import (
    at_precision,
    equal_digits,
    exact,
    root,
    settled,
    sign,
    sign_to,
)
from ..arithmetic.numbers import Real
from ..arithmetic.text import quoted
from ..errors import LagtopError
from .forms import Quantities
from .inputs import STEADY_WORDS
from .units import pi_of_inputs

SLOW, FAST = STEADY_WORDS


class Tilt(NamedTuple):
    """A tilt that is given exactly, in degrees or in radians."""

    degrees: Fraction | None
    radians: Fraction | None

    @classmethod
    def of(cls, inputs: Mapping[str, Any]) -> Tilt:
        """Return the tilt of inputs by key; the missing unit is absent or None."""
        given = (inputs.get(name) for name in ("theta0_deg", "theta0_rad"))
        return cls(*(None if x is None else Fraction(x) for x in given))

    @property
    def pole(self) -> int:
        """1 for an upright axis, -1 for a hanging one, else 0."""
        return int(not self.number) - int(self.degrees == 180)

    @property
    def number(self) -> Fraction:
        """The number that was given."""
        return (self.radians if self.degrees is None else self.degrees) or Fraction(0)

    def angle(self) -> arb:
        """Return the angle in radians, at the precision in use."""
        return exact(self.number) if self.degrees is None else exact(self.number / 180) * arb.pi()

    def sine_and_cosine(self) -> tuple[arb, arb]:
        """Return the sine and the cosine, at the precision in use; rational values are exact."""
        if self.degrees is None:
            found: tuple[arb, arb] = exact(self.number).sin_cos()
        else:
            turns = self.number / 180
            found = arb.sin_cos_pi_fmpq(fmpq(turns.numerator, turns.denominator))
        return found

    def doubles(self) -> tuple[float, ...]:
        """Return sine and cosine of the tilt and of half the tilt, as doubles."""
        tilts = self, Tilt(*(x and x / 2 for x in self))
        found = at_precision(40, lambda: [x for tilt in tilts for x in tilt.sine_and_cosine()])
        return tuple(float(x.mid()) for x in found)

    def sign(self, polynomial: fmpq_poly, equal: int) -> int:
        """Return the sign of a polynomial in the cosine; 0 if `equal` digits leave it open."""
        cosine = self.sine_and_cosine()[1] if polynomial.degree() > 0 else arb(0)
        if cosine.is_exact():
            value = polynomial(cosine.fmpq())
            return int(value > 0) - int(value < 0)
        return sign_to(lambda _: arb_poly(polynomial)(self.sine_and_cosine()[1]), equal)


def rational(x: Fraction | float) -> fmpq:
    """Return a number as a fraction of FLINT, whose polynomials take it."""
    return fmpq(*x.as_integer_ratio())


def exact_inputs(given: Mapping[str, Any]) -> Quantities:
    """Return the inputs that were given as numbers, and in any other form, as exact fractions.

    An input that depends on the cosine of the tilt has none.
    """
    numbers = {name: Fraction(x) for name, x in given.items() if not isinstance(x, str)}
    return Quantities(numbers, pi=pi_of_inputs)


class Spin(NamedTuple):
    """The total rate about the axis, r0 = constant + share psi' cos(theta0) (4,1), exactly."""

    constant: Fraction
    share: Fraction

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Spin:
        """Return the rate that was given in any form, which is linear in psi' cos(theta0)."""
        if "r0" in given:
            return cls(Fraction(given["r0"]), Fraction(0))
        numbers = exact_inputs(given) | {"psidot0": 1}
        at_0, at_1 = (Quantities(numbers | {"u0": x}, pi=pi_of_inputs)["r0"] for x in (0, 1))
        return cls(at_0, at_1 - at_0)

    def ball(self, precession: arb, tilt: Tilt) -> arb:
        """Return r0, at the precision in use."""
        return exact(self.constant) + exact(self.share) * precession * tilt.sine_and_cosine()[1]

    def nearest(self, precession: Real, tilt: Tilt) -> float:
        """Return r0 as a double."""
        turn = Fraction(precession)
        equal = equal_digits([self.constant, turn, tilt.number])
        found = settled("r0", lambda _: self.ball(exact(turn), tilt), None, equal)
        assert found is not None
        return float(found.value)


class SteadyRates(NamedTuple):
    """The rates Omega of steady precession at a tilt, lead cos(tilt) Omega^2 - b Omega + a/2 = 0.

    For r0 = constant + share Omega cos(tilt), b is C/A times the constant, and lead 1 - share C/A.
    """

    a: Fraction
    b: Fraction
    lead: Fraction
    tilt: Tilt
    equal: int
    """D: two numbers that agree to D digits are equal."""

    def sign(self, *coefficients: Fraction | int) -> int:
        """Return the sign of a polynomial in the cosine of the tilt, the constant first."""
        return self.tilt.sign(fmpq_poly([rational(x) for x in coefficients]), self.equal)

    @property
    def is_linear(self) -> bool:
        """Whether only the slow rate is finite: at 90 degrees, or if the lead is 0."""
        return not self.sign(0, self.lead)

    def exists(self, word: str) -> bool:
        """Return whether a rate is real and finite."""
        if self.is_linear:
            return word == SLOW and bool(self.b)
        return self.sign(self.b * self.b, -2 * self.a * self.lead) >= 0

    def rate(self, word: str) -> arb:
        """Return an existing rate, at the precision in use."""
        lead = exact(self.lead) * self.tilt.sine_and_cosine()[1]
        return steady_roots(exact(self.a), exact(self.b), lead, sign(exact(self.b)))[word == FAST]


def steady_roots(a: arb, b: arb, lead: arb, sign_of_b: int) -> tuple[arb, arb]:
    """Return the slow and the fast rate Omega, lead Omega^2 - b Omega + a/2 = 0.

    With q = b + sgn(b) sqrt(b^2 - 2 a lead) the slow rate is a/q and the fast one q/(2 lead).  If b
    = 0 both have the same size, and the slow one is positive, as in the limit of small positive b.
    """
    if a.is_zero() and not sign_of_b:
        return arb(0), arb(0)
    square_root = root(b * b - 2 * a * lead)
    q = b - square_root if sign_of_b < 0 else b + square_root
    return a / q, q / (2 * lead)


def rates_of(given: Mapping[str, Any]) -> SteadyRates:
    """Return the rates of steady precession of a top; its own precession rate is not used."""
    inputs, spin, tilt = exact_inputs(given), Spin.of(given), Tilt.of(given)
    m, A, C, s, g = (inputs[name] for name in ("m", "A", "C", "s", "g"))
    equal = equal_digits([m, A, C, s, g, spin.constant, tilt.number])
    return SteadyRates(
        2 * m * g * s / A, C * spin.constant / A, 1 - spin.share * C / A, tilt, equal
    )


def steady_rate_of(given: Mapping[str, Any], word: str) -> float:
    """Return the rate of steady precession that a word names as a double.  Raises LagtopError."""
    tilt = Tilt.of(given)
    if word not in STEADY_WORDS:
        wrong = f"psidot0 must be a real number, steady or steady-fast, got {quoted(word)}"
    elif given["thetadot0"]:
        wrong = f"thetadot0 must be 0 for psidot0 = {word}, got {float(given['thetadot0'])}"
    elif tilt.pole:
        wrong = f"psidot0 must be 0 if the axis is vertical, got {word} "
        wrong += "(a vertical axis cannot precess)"
    else:
        rates = rates_of(given)
        if rates.exists(word):
            found = settled("psidot0", lambda _: rates.rate(word), None, rates.equal)
            assert found is not None
            return float(found.value)
        wrong = f"psidot0 cannot be {word}: {_why_not(given, rates)}"
    raise LagtopError(wrong, wrong.partition(" ")[0])


def _why_not(given: Mapping[str, Any], rates: SteadyRates) -> str:
    """Return why a top has no rate of steady precession."""
    inputs = exact_inputs(given)
    name = inputs.form_of("r0")
    if rates.is_linear:
        where = "" if rates.lead == 0 else "at 90 degrees "
        return where + ("the fast rate is infinite" if rates.b else f"{name} must not be 0")
    cosine = at_precision(40, lambda: float(rates.tilt.sine_and_cosine()[1].mid()))
    size = math.sqrt(2 * float(rates.a * rates.lead) * cosine)
    least, value = float(inputs["A"] / inputs["C"]) * size, float(inputs[name])
    return f"|{name}| must be at least {least:.6g} at this tilt, got {name} = {value}"
