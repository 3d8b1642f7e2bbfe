"""Exact tilts, and inputs that are derived from others: A, r0 and the rates of steady precession.

The tilt stays constant if A cos(theta) Omega^2 - C r0 Omega + mgs = 0.  With a = 2mgs/A (4,4) and b
= C r0/A (4,5) this is cos(theta) Omega^2 - b Omega + a/2 = 0.  If phidot0 is given in place of r0 =
phidot0 + Omega cos(theta), it is (1 - C/A) cos(theta) Omega^2 - C/A phidot0 Omega + a/2 = 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from flint import arb, arb_poly, fmpq, fmpq_poly

from ..arithmetic.enclosures import at_precision, equal_digits, exact, root, settled, sign_to
from ..arithmetic.numbers import Real
from ..arithmetic.text import quoted
from ..errors import LagtopError
from .values import STEADY_WORDS

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


def moment(inputs: Mapping[str, Real]) -> Fraction:
    """Return the moment about the pivot, A = A_cm + m s^2, exactly.  Raises LagtopError."""
    A_cm, m, s = (Fraction(inputs[name]) for name in ("A_cm", "m", "s"))
    if A_cm < 0:
        raise LagtopError(f"A_cm must be >= 0, got {float(A_cm)}", "A_cm")
    return A_cm + m * s**2


def spin(inputs: Mapping[str, Real]) -> float:
    """Return the total rate about the axis, r0 = phi' + psi' cos(theta0) (4,1), as a double."""
    phi_rate, psi_rate = Fraction(inputs["phidot0"]), Fraction(inputs["psidot0"])
    tilt = Tilt.of(inputs)

    def ball(_: int) -> arb:
        return exact(phi_rate) + exact(psi_rate) * tilt.sine_and_cosine()[1]

    found = settled("r0", ball, None, equal_digits([phi_rate, psi_rate, tilt.number]))
    assert found is not None
    return float(found.value)


class SteadyRates(NamedTuple):
    """The rates Omega of steady precession at a tilt, lead cos(tilt) Omega^2 - b Omega + a/2 = 0.

    `b` is C r0/A and `lead` 1 or, if phidot0 is given, C phidot0/A and 1 - C/A.
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
        """Whether only the slow rate is finite: at 90 degrees, or for phidot0 if A = C."""
        return not self.sign(0, self.lead)

    def exists(self, word: str) -> bool:
        """Return whether a rate is real and finite."""
        if self.is_linear:
            return word == SLOW and bool(self.b)
        return self.sign(self.b * self.b, -2 * self.a * self.lead) >= 0

    def rate(self, word: str) -> arb:
        """Return an existing rate, at the precision in use.

        With q = b + sgn(b) sqrt(b^2 - 2 a lead cos(tilt)) the fast rate is q/(2 lead cos(tilt)) and
        the slow one a/q.  If b = 0 both have the same size, and the slow one is positive, as in the
        limit of small positive b.
        """
        if not (self.a or self.b):
            return arb(0)
        a, b, lead = exact(self.a), exact(self.b), exact(self.lead) * self.tilt.sine_and_cosine()[1]
        square_root = root(b * b - 2 * a * lead)
        q = b - square_root if self.b < 0 else b + square_root
        return q / (2 * lead) if word == FAST else a / q


def rates_of(top: Any) -> SteadyRates:
    """Return the rates of steady precession of a top; its own precession rate is not used."""
    m, A, C, s, g = (Fraction(top.exact(x)) for x in ("m", "A", "C", "s", "g"))
    spin_rate = Fraction(top.r0 if top.phidot0 is None else top.phidot0)
    lead = Fraction(1) if top.phidot0 is None else 1 - C / A
    tilt = top.exact_tilt
    equal = equal_digits([m, A, C, s, g, spin_rate, tilt.number])
    return SteadyRates(2 * m * g * s / A, C * spin_rate / A, lead, tilt, equal)


def steady_rate_of(top: Any, word: str) -> float:
    """Return the rate of steady precession that a word names as a double.  Raises LagtopError."""
    if word not in STEADY_WORDS:
        wrong = f"psidot0 must be a real number, steady or steady-fast, got {quoted(word)}"
    elif top.thetadot0:
        wrong = f"thetadot0 must be 0 for psidot0 = {word}, got {float(top.thetadot0)}"
    elif top.pole:
        wrong = f"psidot0 must be 0 if the axis is vertical, got {word} "
        wrong += "(a vertical axis cannot precess)"
    else:
        rates = rates_of(top)
        if rates.exists(word):
            found = settled("psidot0", lambda _: rates.rate(word), None, rates.equal)
            assert found is not None
            return float(found.value)
        wrong = f"psidot0 cannot be {word}: {_why_not(top, rates)}"
    raise LagtopError(wrong, wrong.partition(" ")[0])


def _why_not(top: Any, rates: SteadyRates) -> str:
    """Return why a top has no rate of steady precession."""
    given = "r0" if top.phidot0 is None else "phidot0"
    if rates.is_linear:
        where = "" if rates.lead == 0 else "at 90 degrees "
        return where + ("the fast rate is infinite" if rates.b else f"{given} must not be 0")
    cosine = at_precision(40, lambda: float(rates.tilt.sine_and_cosine()[1].mid()))
    size = math.sqrt(2 * float(rates.a * rates.lead) * cosine)
    least, value = float(top.exact("A") / Fraction(top.C)) * size, float(getattr(top, given))
    return f"|{given}| must be at least {least:.6g} at this tilt, got {given} = {value}"
