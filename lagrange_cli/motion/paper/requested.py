"""Keys on request: numbers of a motion that are not part of its record.

Each key is declared with its formula, like the keys of the record.  The keys of elementary theory
are here, and those of sections 4 to 8 in `sections`.  Both modules are imported only when one of
their keys is requested.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from inspect import signature
from typing import TYPE_CHECKING

from ...arithmetic.exact_cosine import Polynomial, U
from ...arithmetic.numbers import R, absolute
from ...arithmetic.values import Over
from ...inputs.stand_ins import FAST, SLOW, SteadyRates, rational_root
from ..exact.rational_keys import keys_by_u1, rational_keys, starts_at_u1, starts_at_u2
from ..gaps import State
from ..kinds import Kind
from ..quantity import declared_keys, keys_of, unit_name
from ..regime import Exact
from .sections import Sections

if TYPE_CHECKING:
    from ...arithmetic.protocol import Arithmetic

_GROUP = "Steady precession and elementary theory"
_number = declared_keys(_GROUP)
_rate = declared_keys(_GROUP, unit="rad/time")


class Textbook(Over[R]):
    """Numbers of the elementary theory for any start; None if a number does not exist.

    They depend only on a = 2mgs/A (4,4), b = C r0/A (4,5), the tilt and A/C.  They need no
    solution of the motion.
    """

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
"""The keys on request and their declarations."""


def ratio_of(exact: Exact) -> Fraction:
    """Return A/C."""
    return Fraction(exact.top.A) / Fraction(exact.top.C)


def _textbook_fractions(exact: Exact) -> dict[str, Fraction | None]:
    """Return the keys of elementary theory as fractions, or None if a value is not known as one."""
    a, b, u, ratio = exact.a, exact.b, exact.cosine.rational, ratio_of(exact)
    steady, side = SteadyRates(a, b, exact.cosine), exact.cosine.sign(U)
    sleeping = rational_root(2 * a)
    least = Fraction(0) if side <= 0 or not a else None if u is None else rational_root(2 * a * u)
    return {
        "stability_factor": b * b / (2 * a) if a else None,
        "r0_sleeping": None if sleeping is None else ratio * sleeping,
        "steady_rate_slow": steady.fraction(SLOW),
        "steady_rate_fast": steady.fraction(FAST),
        "r0_steady_min": None if least is None else ratio * least,
        "precession_rate_elementary": a / (2 * b) if b else None,
    }


def _known_fractions(exact: Exact) -> dict[str, Fraction]:
    """Return the keys on request whose values are known as fractions."""
    known, facts, zero = rational_keys(exact), exact.facts, Fraction(0)
    keys = _textbook_fractions(exact)
    keys["spin_share"] = 1 - Fraction(exact.top.C) / (2 * Fraction(exact.top.A))
    if facts.steady or facts.regime == "separatrix":
        keys["f_slope_u1"] = zero
    even = (starts_at_u1(exact) or starts_at_u2(exact)) and not facts.meets_a_pole
    for angle, rate in (("phi", "mean_spin_rate"), ("psi", "mean_precession_rate")):
        if known.get(rate) == 0:
            keys[f"{angle}_period_deg"] = zero
        # in a plane this is a multiple of half turns, so 0 if enclosures cannot round it
        if facts.plane or (even and known.get(rate) == 0):
            keys[f"{angle}_half_deg"] = zero
    keys |= {name: exact.cosine.fraction(P) for name, P in _polynomials(exact).items()}
    return {name: value for name, value in keys.items() if value is not None}


def _polynomials(exact: Exact) -> dict[str, Polynomial]:
    """Return the keys that are polynomials in cos(theta0)."""
    if exact.psi_rate is None:
        return {}
    a, b, alpha, beta, A = exact.a, exact.b, exact.alpha, exact.beta, Fraction(exact.top.A)
    keys = {
        "energy_constant": alpha,
        "energy_without_spin": A / 2 * alpha,
        "momentum_constant": beta,
        "Lz": A * beta,
        "f_upright": -1 * (beta - b) * (beta - b),
        "f_hanging": -1 * (beta + b) * (beta + b),
    }
    if exact.facts.at_rest and a:
        total = b * b / a
        product = total * U - 1
        keys |= {
            "roots_sum": Polynomial(total),
            "roots_sum_squared": Polynomial(total * total),
            "roots_product": product,
            "roots_product_fourfold": -4 * product,
            "roots_gap_squared": total * total - 4 * product,
        }
    return keys


_OF_ROOTS: dict[str, Callable[..., Fraction]] = {
    "u2_twice": lambda u2: 2 * u2,
    "u3_twice": lambda u3: 2 * u3,
    "roots_gap": lambda u2, u3: u3 - u2,
    "k_squared": lambda u1, u2, u3: (u1 - u2) / (u3 - u2),
}
"""Formulas of keys whose values are fractions if the roots are, by the names of the roots."""


def requested_fraction(
    exact: Exact, name: str, root: Callable[[str], Fraction | None]
) -> Fraction | None:
    """Return a key on request if it is known as a fraction.

    `root` returns a root of (4,9) by its name, or None if the root is not rational.
    """
    known = _known_fractions(exact).get(name)
    if known is not None:
        return known
    if name in {"f_slope_u1", "u2_criterion", "discriminant"}:
        return _fraction_by_u1(exact, name, root)
    formula = _OF_ROOTS.get(name)
    if formula is None:
        return None
    roots = {u: root(u) for u in signature(formula).parameters}
    return None if None in roots.values() else formula(**roots)


def _fraction_by_u1(
    exact: Exact, name: str, root: Callable[[str], Fraction | None]
) -> Fraction | None:
    """Return a key that is a polynomial in the root u1 (4,9), if it is a fraction.

    The root must be a fraction or a polynomial in the cosine of the start.  The discriminant does
    not depend on it without torque.
    """
    facts, rational = exact.facts, root("u1")
    if exact.psi_rate is None:
        return None
    if name == "u2_criterion" and root("u2") == 0:
        return Fraction(0)
    if rational is not None:
        u1 = Polynomial(rational)
    elif starts_at_u1(exact) or facts.steady or (facts.free and name == "discriminant"):
        u1 = U
    elif facts.plane and exact.a:
        u1 = exact.alpha * (1 / exact.a)
    else:
        return None
    return exact.cosine.fraction(keys_by_u1(exact, u1)[name])


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
