"""Columns of `lagtop table` with rational values, which may be ties or exact zeros.

Rational values occur at the start, in the constants of the motion and in steady motions.  For some
tops, such as a sphere or a disc, further columns are 0 or constant at all times.
"""

from __future__ import annotations

from fractions import Fraction

from ...arithmetic.exact_cosine import Cosine, U
from ..regime import Exact
from .rational_keys import known_fraction

_MEANS = {"phi_rate": "mean_spin_rate", "psi_rate": "mean_precession_rate"}


def known_column(
    exact: Exact, method: str, t: Fraction, *, radians: bool = False, wrap: bool = False
) -> Fraction | None:
    """Return a column at a time if it is known as a fraction, else None.

    `method` is its method of `table.Sample`.  Angles are in degrees or `radians`.
    """
    if method == "r":
        return exact.r0
    if exact.psi_rate is not None:
        if method in {"energy", "vertical_momentum"}:
            return _conserved(exact, method)
        known = _of_some_tops(exact, method)
        if known is not None:
            return known
    if exact.facts.steady:
        return _of_steady(exact, method, t, radians=radians, wrap=wrap)
    if exact.facts.free and exact.facts.plane:
        return _of_a_great_circle(exact, method, t, radians=radians)
    return None if t else _at_start(exact, method, radians=radians)


def _conserved(exact: Exact, method: str) -> Fraction | None:
    """Return the energy (4,2) or the vertical momentum (4,3), polynomials in cos(theta0)."""
    A, C = Fraction(exact.top.A), Fraction(exact.top.C)
    if method == "energy":
        return exact.cosine.fraction(A / 2 * exact.alpha + C * exact.r0 * exact.r0 / 2)
    return exact.cosine.fraction(A * exact.beta)


def _of_some_tops(exact: Exact, method: str) -> Fraction | None:
    """Return a column that is the same at all times for tops such as a sphere or a disc."""
    facts, psi = exact.facts, exact.psi_rate
    if method == "axis_x":
        return Fraction(0) if facts.plane else None
    if method in {"quaternion_y", "quaternion_z"}:
        return Fraction(0) if _stands(exact, 1 if method == "quaternion_z" else -1) else None
    if method not in {"p", "q"}:
        return None
    if facts.free and exact.r0 == exact.b:  # the angular velocity is constant in the body
        return _at_start(exact, method, radians=False)
    # A disc, C = 2A, has p'' = -(r0^2 - a u/2) p, and q'' likewise: a rate that starts at 0
    # with the derivative 0 stays 0.  Without spin this holds for any top.
    balanced = not exact.theta_rate and 2 * exact.r0 * psi == exact.a
    at_rest = not psi and not exact.r0 * exact.theta_rate
    zero = exact.b == 2 * exact.r0 and (balanced if method == "p" else at_rest)
    return Fraction(0) if zero else None


def _stands(exact: Exact, sign: int) -> bool:
    """Return whether psi + sign phi leaps by whole turns only, at a pole, or not at all."""
    facts, psi = exact.facts, exact.psi_rate
    if facts.steady:
        return exact.cosine.vanishes(sign * exact.r0 + psi - sign * psi * U)
    passes = facts.over_bottom if sign > 0 else facts.over_top
    return passes and exact.r0 == exact.b


def _of_a_great_circle(exact: Exact, method: str, t: Fraction, *, radians: bool) -> Fraction | None:
    """Return a column of an axis that moves uniformly round a great circle through both poles."""
    rate = exact.theta_rate
    tilt = Fraction(0) if exact.facts.pole > 0 else exact.cosine.radians
    if not t or tilt is None:
        return None if t else _at_start(exact, method, radians=radians)
    angle = tilt + rate * t
    if abs(angle) > 3:  # about half a turn, or beyond
        return None
    if method == "theta":
        return abs(angle) if radians else None
    return (rate if angle > 0 else -rate) if method == "nutation_rate" else None


def _of_steady(
    exact: Exact, method: str, t: Fraction, *, radians: bool, wrap: bool
) -> Fraction | None:
    """Return a column of a motion at constant tilt."""
    if method in {"phi", "psi"}:
        rate = known_fraction(exact, _MEANS[f"{method}_rate"])
        known = rate is not None and (not rate or (radians and not wrap))
        return rate * t if rate is not None and known else None
    if method in {"p", "q"}:
        stays = not (t and exact.psi_rate != 0) or known_fraction(exact, "mean_spin_rate") == 0
        return _at_start(exact, method, radians=radians) if stays else None
    if method in {"phi_rate", "psi_rate"}:
        return known_fraction(exact, _MEANS[method])
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
        factor = exact.psi_rate if method == "q" else Fraction(exact.top.A) * exact.a / 2
        sine = Fraction(0) if factor == 0 else _sine(cosine)
        return None if sine is None or factor is None else sine * factor
    if method in {"phi_rate", "psi_rate"}:
        key = {"phi_rate": "spin_rate_start", "psi_rate": "precession_rate_start"}[method]
        pole, half = exact.facts.pole, exact.b / 2
        leaving = exact.r0 - half if method == "phi_rate" else pole * half
        return leaving if pole else known_fraction(exact, key)
    return None


def _sine(cosine: Cosine) -> Fraction | None:
    """Return the sine of the tilt if it is rational, else None."""
    if cosine.degrees is None:
        return Fraction(0) if cosine.radians == 0 else None
    return Cosine(abs(90 - cosine.degrees), None).rational
