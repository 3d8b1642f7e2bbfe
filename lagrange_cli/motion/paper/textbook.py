"""Keys on request of the elementary theory: stability, steady precession, fast tops.

The keys depend only on a = 2mgs/A (4,4), b = C r0/A (4,5), the tilt and A/C. They need no solution
of the motion.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from ...arithmetic.exact_cosine import U
from ...arithmetic.numbers import R, absolute
from ...arithmetic.values import Over
from ...inputs.stand_ins import FAST, SLOW, SteadyRates, rational_root
from ..gaps import State
from ..quantity import declared_keys, keys_of
from ..regime import Exact

if TYPE_CHECKING:
    from ...arithmetic.protocol import Arithmetic

_GROUP = "Steady precession and elementary theory"
_number = declared_keys(_GROUP)
_rate = declared_keys(_GROUP, unit="rad/time")


class Textbook(Over[R]):
    """Numbers of the elementary theory for any start; None if a number does not exist."""

    def __init__(self, ar: Arithmetic[R], exact: Exact, start: State[R]) -> None:
        self.ar, self.exact, self.steady = ar, exact, SteadyRates(exact.a, exact.b, exact.cosine)
        self.a, self.b, self.cos = start.a, start.b, start.cos
        with ar.working():
            self.ratio = ar.convert(ratio_of(exact))
        self.upper = exact.cosine.sign(U) >= 0
        """Whether the tilt is at most 90 degrees."""

    stability_factor = _number(
        *("λ", "stability factor C²r0²/(4Amgs)", "b²/2a", "b**2/(2*a)"),
        value=lambda of: of.b * of.b / (2 * of.a),
        exists=lambda of: of.exact.a,
        absent="without torque",
    )
    r0_sleeping = _rate(
        *("r0 sleeping", "least r0 of a stable upright top", "2√(Amgs)/C", "2*sqrt(A*m*g*s)/C"),
        value=lambda of: of.ratio * of.ar.sqrt(2 * of.a),
    )
    steady_rate_slow = _rate(  # the root of smaller size of A cos(theta) w^2 - C r0 w + mgs = 0
        *("Ω slow", "slow steady precession", "ϑ'' = 0"),
        "m*g*s = C*r0*steady_rate_slow - A*cos(theta0)*steady_rate_slow**2",
        value=lambda of: of.steady.rate(of.ar, of.a, of.b, of.cos, SLOW),
        exists=lambda of: of.steady.exists(SLOW),
        absent="if |r0| < r0_steady_min, or if r0 = 0 at 90 degrees",
    )
    steady_rate_fast = _rate(  # the root of larger size, which is infinite at 90 degrees
        *("Ω fast", "fast steady precession", "ϑ'' = 0"),
        "m*g*s = C*r0*steady_rate_fast - A*cos(theta0)*steady_rate_fast**2",
        value=lambda of: of.steady.rate(of.ar, of.a, of.b, of.cos, FAST),
        exists=lambda of: of.steady.exists(FAST),
        absent="if |r0| < r0_steady_min, or at 90 degrees",
    )

    r0_steady_min = _rate(  # 0 from 90 degrees on
        *("r0 steady", "least r0 of steady precession", "2√(Amgs u0)/C"),
        "2*sqrt(A*m*g*s*max(cos(theta0), 0))/C",
        value=lambda of: of.ratio * of.ar.sqrt(2 * of.a * of.cos) if of.upper else 0 * of.a,
    )
    precession_rate_elementary = _rate(
        *("ψ' elementary", "precession of a fast top", "mgs/(C r0)", "m*g*s/(C*r0)"),
        value=lambda of: of.a / (2 * of.b),
        exists=lambda of: of.exact.b,
        absent="if r0 = 0",
    )
    T_nutation_elementary = _number(
        *("T elementary", "nutation of a fast top", "2πA/(C r0)", "2*pi*A/(C*abs(r0))"),
        value=lambda of: 2 * of.ar.pi / absolute(of.b),
        exists=lambda of: of.exact.b,
        unit="time",
        absent="if r0 = 0",
    )


TEXTBOOK = keys_of(Textbook)
"""The keys of this module and their declarations."""
STEADY_KEYS = frozenset({"steady_rate_slow", "steady_rate_fast"})
WITH_RATIO = frozenset({"r0_sleeping", "r0_steady_min"})
"""The keys that have the factor A/C."""


def ratio_of(exact: Exact) -> Fraction:
    """Return A/C."""
    return Fraction(exact.top.A) / Fraction(exact.top.C)


def textbook_fractions(exact: Exact) -> dict[str, Fraction]:
    """Return the keys of this module whose values are known as fractions."""
    a, b, u, ratio = exact.a, exact.b, exact.cosine.rational, ratio_of(exact)
    steady, side = SteadyRates(a, b, exact.cosine), exact.cosine.sign(U)
    sleeping = rational_root(2 * a)
    least = Fraction(0) if side <= 0 or not a else None if u is None else rational_root(2 * a * u)
    known = {
        "stability_factor": b * b / (2 * a) if a else None,
        "r0_sleeping": None if sleeping is None else ratio * sleeping,
        "steady_rate_slow": steady.fraction(SLOW),
        "steady_rate_fast": steady.fraction(FAST),
        "r0_steady_min": None if least is None else ratio * least,
        "precession_rate_elementary": a / (2 * b) if b else None,
    }
    return {name: value for name, value in known.items() if value is not None}
