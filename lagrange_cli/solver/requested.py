"""Further keys: numbers of a motion that are not part of its record.

Each key is declared with its formula, like the keys of the record.  The keys of elementary theory
are here, and those of sections 4 to 8 in `sections`.  Both modules are imported only when one of
their keys is requested.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Generic

from ..arithmetic.numbers import Arithmetic, R, absolute
from ..top.derived import FAST, SLOW, SteadyRates
from .gaps import State
from .kinds import Kind
from .quantity import declared_keys, keys_of, unit_name
from .regime import Exact
from .sections import Sections

_GROUP = "Steady precession and elementary theory"
_number = declared_keys(_GROUP)
_rate = declared_keys(_GROUP, unit="rad/time")


class Textbook(Generic[R]):
    """Numbers of the elementary theory for any start; None if a number does not exist.

    They depend only on a = 2mgs/A (4,4), b = C r0/A (4,5), the tilt and A/C.  They need no
    solution of the motion.
    """

    def __init__(self, ar: Arithmetic[R], exact: Exact, start: State[R]) -> None:
        self.ar, self.exact, self.steady = ar, exact, SteadyRates(exact.a, exact.b, exact.tilt)
        self.a, self.b, self.cos = start.a, start.b, start.cos
        with ar.working():
            self.ratio = ar.convert(ratio_of(exact))
        self.upper = self.steady.sign(0, 1) >= 0
        """Whether the tilt is at most 90 degrees."""

    stability_factor = _number(
        *("λ", "stability factor C²r0²/(4Amgs)", "b²/2a", "b**2/(2*a)"),
        value=lambda of: of.b * of.b / (2 * of.a),
        exists=lambda of: of.exact.a,
        only="if there is a torque",
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
        only="if |r0| >= r0_steady_min, and r0 is not 0 at 90 degrees",
    )
    steady_rate_fast = _rate(  # the root of larger size, which is infinite at 90 degrees
        *("Ω fast", "fast steady precession", "ϑ'' = 0"),
        "m*g*s = C*r0*steady_rate_fast - A*cos(theta0)*steady_rate_fast**2",
        value=lambda of: of.steady.rate(of.ar, of.a, of.b, of.cos, FAST),
        exists=lambda of: of.steady.exists(FAST),
        only="if |r0| >= r0_steady_min and the tilt is not 90 degrees",
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
        only="if r0 is not 0",
    )
    T_nutation_elementary = _number(
        *("T elementary", "nutation of a fast top", "2πA/(C r0)", "2*pi*A/(C*abs(r0))"),
        value=lambda of: 2 * of.ar.pi / absolute(of.b),
        exists=lambda of: of.exact.b,
        unit="time",
        only="if r0 is not 0",
    )


class Requested(Textbook[R], Sections[R]):
    """All keys of one motion on request."""

    def __init__(self, kind: Kind[R], exact: Exact) -> None:
        Textbook.__init__(self, kind.ar, exact, kind.state)
        Sections.__init__(self, kind, exact)


TEXTBOOK = keys_of(Textbook)
"""The keys of elementary theory and their declarations."""
STEADY_KEYS = frozenset({"steady_rate_slow", "steady_rate_fast"})
WITH_RATIO = frozenset({"r0_sleeping", "r0_steady_min"})
"""The keys that have the factor A/C."""
REQUESTED = keys_of(Requested)
"""The further keys and their declarations."""


def ratio_of(exact: Exact) -> Fraction:
    """Return A/C."""
    return Fraction(exact.top.A) / Fraction(exact.top.C)


CHAIN = {
    "Inputs": ["m", "A", "C", "s", "g", "r0", "theta0_deg"],
    "The body": ["a", "spin_share"],
    "The start": ["u1", "b", "roots_sum", "roots_product"],
    "The roots": [
        *("roots_sum_squared", "roots_product_fourfold", "roots_gap_squared", "roots_gap"),
        *("u3_twice", "u2_twice", "u3", "u2"),
    ],
    "Modulus and amplitude": [
        *("k_squared", "modular_angle_deg", "comodular_angle_deg", "amplitude_deg"),
    ],
    "Integrals": ["K", "E", "alpha", "E_amplitude"],
    "Nutation": ["T_nutation", "u_quarter"],
    "Spin and precession": [
        *("mean_spin_rate", "mean_precession_rate", "spin_rate_half", "precession_rate_half"),
        *("T_spin", "T_precession"),
    ],
}
"""Keys by step of section 8, in the order of the paper."""


def derivation_keys(*, radians: bool = False) -> list[str]:
    """Return the keys of the steps of section 8, in the order of the paper."""
    return [unit_name(name, radians=radians) for names in CHAIN.values() for name in names]
