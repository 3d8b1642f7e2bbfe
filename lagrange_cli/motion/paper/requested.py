"""Keys on request: numbers of a motion that are not part of its record.

Each key is declared with its formula, like the keys of the record.  `quarters` has those of
sections 4 to 7, `worked_example` those of section 8, and `textbook` those of elementary theory.
These modules are imported only when one of their keys is requested.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from inspect import signature

from ...arithmetic.ball import Ball
from ...arithmetic.exact_cosine import Polynomial, U
from ..exact.rational_keys import (
    rational_criterion,
    rational_keys,
    starts_at_u1,
    starts_at_u2,
)
from ..quantity import keys_of
from ..regime import Exact
from .textbook import TEXTBOOK, Textbook, textbook_fractions
from .worked_example import WorkedExample

__all__ = ["REQUESTED", "TEXTBOOK", "Textbook", "WorkedExample", "requested_fractions"]

REQUESTED = keys_of(WorkedExample) | TEXTBOOK
"""The keys on request and their declarations."""


def requested_fractions(exact: Exact) -> dict[str, Fraction]:
    """Return the keys on request whose values are known as fractions."""
    known = rational_keys(exact)
    keys = {"spin_share": 1 - Fraction(exact.top.C) / (2 * Fraction(exact.top.A))}
    keys |= _constants(exact) | textbook_fractions(exact)
    if known.get("u2") == 0:
        keys |= {"u2_criterion": Fraction(0), "u2_twice": Fraction(0)}
    turning = starts_at_u1(exact) or starts_at_u2(exact)
    even = turning and not exact.facts.meets_a_pole
    for angle, rate in (("phi", "mean_spin_rate"), ("psi", "mean_precession_rate")):
        if known.get(rate) == 0:
            keys[f"{angle}_period_deg"] = Fraction(0)
        if known.get(rate) == 0 and even:
            keys[f"{angle}_half_deg"] = Fraction(0)
        if exact.facts.plane:  # a multiple of half turns: 0 if enclosures cannot decide
            keys[f"{angle}_half_deg"] = Fraction(0)
    if exact.facts.at_rest and exact.a:
        total = exact.b * exact.b / exact.a
        product = total * U - 1
        keys |= {"roots_sum": total, "roots_sum_squared": total * total}
        keys |= _fractions(
            exact,
            {
                "roots_product": product,
                "roots_product_fourfold": -4 * product,
                "roots_gap_squared": total * total - 4 * product,
            },
        )
    return keys


_OF_ROOTS: dict[str, Callable[..., Fraction]] = {
    "u2_twice": lambda u2: 2 * u2,
    "u3_twice": lambda u3: 2 * u3,
    "roots_gap": lambda u2, u3: u3 - u2,
    "k_squared": lambda u1, u2, u3: (u1 - u2) / (u3 - u2),
}
"""Formulas of keys whose values are fractions if the roots are, by the names of the roots."""


def fraction_by_roots(
    exact: Exact,
    name: str,
    root: Callable[[str], Fraction | None],
    enclosure: Callable[[str], Ball | None],
) -> Fraction | None:
    """Return a key that follows from the roots of (4,9), if it is a fraction.

    `root` returns a root by its name, or None if the root is not rational; `enclosure` returns a
    ball by its key.
    """
    if name in _BY_U1:
        known = _fraction_by_u1(exact, name, root("u1"))
        by_cubic = known is None and name == "u2_criterion"
        return rational_criterion(exact, enclosure) if by_cubic else known
    formula = _OF_ROOTS.get(name)
    if formula is None:
        return None
    roots = {u: root(u) for u in signature(formula).parameters}
    return None if None in roots.values() else formula(**roots)


_BY_U1 = ("f_slope_u1", "u2_criterion", "discriminant")
"""The keys that are polynomials in the root u1."""


def _fraction_by_u1(exact: Exact, name: str, rational: Fraction | None) -> Fraction | None:
    """Return a key that is a polynomial in the root u1 (4,9), if it is a fraction.

    The root is a `rational` number or a polynomial in the cosine of the start, else the result is
    None.  The cubic is a u^3 - (alpha + b^2) u^2 + (2 beta b - a) u + alpha - beta^2.
    """
    if rational is not None:
        u1 = Polynomial(rational)
    elif starts_at_u1(exact):
        u1 = U
    elif exact.facts.plane and exact.a:
        u1 = exact.alpha * (1 / exact.a)
    else:
        return None
    square = exact.alpha + exact.b * exact.b
    pairs = 2 * exact.b * exact.beta - exact.a
    if name == "f_slope_u1":
        return exact.cosine.fraction((3 * exact.a * u1 - 2 * square) * u1 + pairs)
    criterion = pairs + (exact.a * u1 - square) * u1
    if name == "u2_criterion":
        return exact.cosine.fraction(criterion)
    total = square - exact.a * u1
    return exact.cosine.fraction(total * total - 4 * exact.a * criterion)


def _constants(exact: Exact) -> dict[str, Fraction]:
    """Return the constants of section 4 that are rational."""
    steady = exact.facts.steady
    keys = {"f_slope_u1": Fraction(0)} if steady or exact.facts.regime == "separatrix" else {}
    if exact.psi_rate is None:
        return keys
    alpha, beta = exact.alpha, exact.beta
    half, whole = Fraction(exact.top.A) / 2, Fraction(exact.top.A)
    polynomials: dict[str, Polynomial] = {
        "energy_constant": alpha,
        "energy_without_spin": half * alpha,
        "momentum_constant": beta,
        "Lz": whole * beta,
        "f_upright": -1 * (beta - exact.b) * (beta - exact.b),
        "f_hanging": -1 * (beta + exact.b) * (beta + exact.b),
    }
    wide = exact.energy + exact.b * exact.b - 2 * exact.a * U
    if steady or exact.facts.free:
        polynomials["discriminant"] = wide * wide
    if steady:
        polynomials["u2_criterion"] = U * (wide + exact.a * U)
    return keys | _fractions(exact, polynomials)


def _fractions(exact: Exact, polynomials: dict[str, Polynomial]) -> dict[str, Fraction]:
    """Return the polynomials in cos(theta0) whose values are fractions, with these values."""
    values = {name: exact.cosine.fraction(value) for name, value in polynomials.items()}
    return {name: value for name, value in values.items() if value is not None}
