"""Measured inputs: the moment about the centre of mass, and the rate of the spin angle."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ..arithmetic.ball import Ball
from ..arithmetic.balls import balls
from ..arithmetic.exact_cosine import Cosine
from ..arithmetic.numbers import Number
from ..arithmetic.rounding import nearest_double, rounding_of, settled
from ..errors import LagtopError
from .input_keys import STANDS_FOR

EXACT_DIGITS = 1100
"""Digits of a fraction that approximates an irrational number: more than any output shows."""


def as_solved(inputs: Mapping[str, Number]) -> dict[str, Number]:
    """Return the inputs of a top, with A computed from A_cm and r0 from phidot0.

    Each result is rounded to the nearest double, unless an input is a fraction.  Raises LagtopError
    for a negative A_cm.
    """
    solved = dict(inputs)
    for measured, formula in (("A_cm", moment), ("phidot0", spin)):
        if measured in inputs:
            solved[STANDS_FOR[measured]] = formula(inputs)
            del solved[measured]
    return solved


def moment(inputs: Mapping[str, Number]) -> Number:
    """Return the moment about the pivot, A = A_cm + m s^2 (Steiner's theorem)."""
    A_cm, m, s = (inputs[name] for name in ("A_cm", "m", "s"))
    if A_cm < 0:
        raise LagtopError(f"A_cm must be >= 0, got {float(A_cm)}", "A_cm")
    exact = Fraction(A_cm) + Fraction(m) * Fraction(s) ** 2
    return exact if is_exact(A_cm, m, s) else _nearest(exact)


def spin(inputs: Mapping[str, Number]) -> Number:
    """Return the total rate about the figure axis, r0 = phi' + psi' cos(theta0) (4,1).

    If the cosine is irrational, the fraction has `EXACT_DIGITS` digits.
    """
    phi_rate, psi_rate = Fraction(inputs["phidot0"]), Fraction(inputs["psidot0"])
    degrees, radians = inputs.get("theta0_deg"), inputs.get("theta0_rad")
    keeps = is_exact(*(x for x in (inputs["phidot0"], inputs["psidot0"], degrees, radians) if x))
    cosine = Cosine(*(None if x is None else Fraction(x) for x in (degrees, radians)))
    if not 0 <= (degrees or 0) <= 180 or not 0 <= (radians or 0) <= 4:
        return inputs["phidot0"]  # `Top` refuses such a tilt
    rational = cosine.rational if psi_rate else Fraction(0)
    if rational is not None:
        exact = phi_rate + psi_rate * rational
        return exact if keeps else _nearest(exact)

    def enclosure(digits: int) -> Ball:
        ar = balls(digits)
        return ar.convert(phi_rate) + ar.convert(psi_rate) * cosine.value(ar)

    if not keeps:
        found = settled("r0", enclosure, nearest_double("r0"))
    else:
        found = settled("r0", enclosure, rounding_of("r0", EXACT_DIGITS), digits=EXACT_DIGITS)
    assert found is not None
    value: Number = found.value if not keeps else Fraction(found.value)
    return value


def is_exact(*inputs: Number) -> bool:
    """Return whether any input is kept as a fraction instead of a double."""
    return any(isinstance(x, Fraction) for x in inputs)


def _nearest(exact: Fraction) -> float:
    """Return a fraction rounded to the nearest double; infinite beyond all doubles."""
    try:
        return float(exact)
    except OverflowError:
        return float("inf") if exact > 0 else float("-inf")
