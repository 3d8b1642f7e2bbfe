"""Columns of `lagtop table` whose value is rational: there ties are possible, and exact zeros.

Such are the constants of the motion, all that stands still in a steady motion, and the start.
"""

from __future__ import annotations

from fractions import Fraction

from ..arithmetic.exact_cosine import Cosine, U
from .rational_keys import known_fraction
from .regime import Exact


def known_column(
    exact: Exact, method: str, t: Fraction, *, radians: bool = False, wrap: bool = False
) -> Fraction | None:
    """Return a column at a time, by its method of `sample.Sample`, where it is known as a fraction.

    Angles are in degrees or `radians`.
    """
    if method == "r":
        return exact.r0
    if method in {"energy", "vertical_momentum"}:
        return _conserved(exact, method)
    if exact.facts.steady:
        return _of_steady(exact, method, t, radians=radians, wrap=wrap)
    return None if t else _at_start(exact, method, radians=radians)


def _conserved(exact: Exact, method: str) -> Fraction | None:
    """Return the energy (4,2) or the vertical momentum (4,3), polynomials in cos(theta0)."""
    A, C = Fraction(exact.top.A), Fraction(exact.top.C)
    psi, r0, sin2 = exact.psi_rate, exact.r0, 1 - U * U
    if method == "energy":
        swing = exact.theta_rate**2 + psi * psi * sin2
        return exact.cosine.fraction(A / 2 * swing + C * r0 * r0 / 2 + A * exact.a / 2 * U)
    return exact.cosine.fraction(A * psi * sin2 + C * r0 * U)


def _of_steady(
    exact: Exact, method: str, t: Fraction, *, radians: bool, wrap: bool
) -> Fraction | None:
    """Return a column of a motion at constant tilt."""
    if method in {"phi", "psi"}:
        key = {"phi": "mean_spin_rate", "psi": "mean_precession_rate"}[method]
        rate = None if wrap or not radians else known_fraction(exact, key)
        return None if rate is None else rate * t
    if method in {"p", "q"}:
        return None if exact.psi_rate else Fraction(0)
    if method == "phi_rate":
        return known_fraction(exact, "mean_spin_rate")
    return _at_start(exact, method, radians=radians)


def _at_start(exact: Exact, method: str, *, radians: bool) -> Fraction | None:
    """Return a column at t = 0."""
    cosine = exact.cosine
    if method == "theta":
        return cosine.radians if radians else cosine.degrees
    if method == "cosine":
        return cosine.rational
    if method in {"nutation_rate", "p"}:
        return exact.theta_rate
    if method in {"q", "moment"}:
        sine = _sine(cosine)
        torque = Fraction(exact.top.A) * exact.a / 2
        return None if sine is None else sine * (exact.psi_rate if method == "q" else torque)
    if method in {"phi_rate", "psi_rate"} and not exact.facts.pole:
        key = {"phi_rate": "spin_rate_start", "psi_rate": "precession_rate_start"}[method]
        return known_fraction(exact, key)
    return None


def _sine(cosine: Cosine) -> Fraction | None:
    """Return the sine of the tilt where it is rational."""
    if cosine.degrees is None:
        return Fraction(0) if cosine.radians == 0 else None
    return Cosine(abs(90 - cosine.degrees), None).rational
