"""Columns of `lagtop table` with rational values, which may be ties or exact zeros.

Rational values occur at the start, in the constants of the motion and in steady motions.  For some
tops, such as a sphere or a disc, further columns are 0 or constant at all times.
"""

from __future__ import annotations

from fractions import Fraction

from ...arithmetic.exact_cosine import Cosine, U
from ..regime import Exact
from .rational_keys import known_fraction

_RATES = {
    "phi": ("mean_spin_rate", "spin_rate_start"),
    "psi": ("mean_precession_rate", "precession_rate_start"),
}
"""The keys of the rates of both angles: the mean rate and the rate at the start."""


def known_column(
    exact: Exact, name: str, t: Fraction, *, radians: bool = False, wrap: bool = False
) -> Fraction | None:
    """Return a column at a time if it is known as a fraction, else None.

    Angles are in degrees or `radians`.
    """
    facts = exact.facts
    if name == "r":
        return exact.r0
    known = None if exact.psi_rate is None else _of_all_times(exact, name)
    if known is not None:
        return known
    if facts.steady and name in _RATES:
        rate = known_fraction(exact, _RATES[name][0])
        return rate * t if rate is not None and (not rate or (radians and not wrap)) else None
    if t and facts.free and facts.plane and not facts.steady:
        return _of_a_great_circle(exact, name, t, radians=radians)
    turns = exact.psi_rate != 0 and known_fraction(exact, "mean_spin_rate") != 0
    if t and (not facts.steady or (name in {"p", "q"} and turns)):
        return None
    return _at_start(exact, name, radians=radians)


def _of_all_times(exact: Exact, name: str) -> Fraction | None:
    """Return a constant of the motion, or a column that is constant for some tops.

    For example, p and q are constant for a sphere without torque.
    """
    facts, psi = exact.facts, exact.psi_rate
    if name in {"energy", "Lz"}:  # (4,2) and (4,3)
        A, C = Fraction(exact.top.A), Fraction(exact.top.C)
        energy = A / 2 * exact.alpha + C * exact.r0 * exact.r0 / 2
        return exact.cosine.fraction(energy if name == "energy" else A * exact.beta)
    if name == "axis_x":
        return Fraction(0) if facts.plane else None
    if name in {"quaternion_y", "quaternion_z"}:
        return Fraction(0) if _stands(exact, 1 if name == "quaternion_z" else -1) else None
    if name not in {"p", "q"}:
        return None
    if facts.free and exact.r0 == exact.b:  # the angular velocity is constant in the body
        return _at_start(exact, name, radians=False)
    # A disc, C = 2A, has p'' = -(r0^2 - a u/2) p, and q'' likewise: a rate that starts at 0
    # with the derivative 0 stays 0.  Without spin this holds for any top.
    balanced = not exact.theta_rate and 2 * exact.r0 * psi == exact.a
    at_rest = not psi and not exact.r0 * exact.theta_rate
    zero = exact.b == 2 * exact.r0 and (balanced if name == "p" else at_rest)
    return Fraction(0) if zero else None


def _stands(exact: Exact, sign: int) -> bool:
    """Return whether psi + sign phi leaps by whole turns only, at a pole, or not at all."""
    facts, psi = exact.facts, exact.psi_rate
    if facts.steady:
        return exact.cosine.vanishes(sign * exact.r0 + psi - sign * psi * U)
    passes = facts.over_bottom if sign > 0 else facts.over_top
    return passes and exact.r0 == exact.b


def _of_a_great_circle(exact: Exact, name: str, t: Fraction, *, radians: bool) -> Fraction | None:
    """Return a column of an axis that moves uniformly round a great circle through both poles."""
    rate = exact.theta_rate
    tilt = Fraction(0) if exact.facts.pole > 0 else exact.cosine.radians
    if tilt is None or abs(angle := tilt + rate * t) > 3:  # about half a turn, or beyond
        return None
    if name == "theta":
        return abs(angle) if radians else None
    return (rate if angle > 0 else -rate) if name == "thetadot" else None


def _at_start(exact: Exact, name: str, *, radians: bool) -> Fraction | None:
    """Return a column at t = 0."""
    cosine, facts = exact.cosine, exact.facts
    known = {
        "theta": cosine.radians if radians else cosine.degrees,
        "u": cosine.rational,
        "axis_z": cosine.rational,
        "thetadot": exact.theta_rate,
        "p": exact.theta_rate,
    }
    if name in {"q", "moment"}:
        factor = exact.psi_rate if name == "q" else Fraction(exact.top.A) * exact.a / 2
        sine = Fraction(0) if factor == 0 else _sine(cosine)
        return None if sine is None or factor is None else sine * factor
    if name not in {"phidot", "psidot"}:
        return known.get(name)
    if facts.pole and not facts.steady:  # the axis leaves the pole
        return exact.r0 - exact.b / 2 if name == "phidot" else facts.pole * exact.b / 2
    mean, start = _RATES[name.removesuffix("dot")]
    return known_fraction(exact, mean if facts.steady else start)


def _sine(cosine: Cosine) -> Fraction | None:
    """Return the sine of the tilt if it is rational, else None."""
    if cosine.degrees is None:
        return Fraction(0) if cosine.radians == 0 else None
    return Cosine(abs(90 - cosine.degrees), None).rational
