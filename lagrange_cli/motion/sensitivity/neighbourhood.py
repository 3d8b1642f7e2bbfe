"""The neighbourhood of a top: its start and its gaps as dual numbers.

The formulas depend on six parameters: a, b, r0, the tilt and the two rates at the start.  An exact
property of the top, such as u1 = u2, need not hold next to it.  `Neighbourhood` names the
parameters along which it fails.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from ...arithmetic.ball import Ball, TooFewDigitsError
from ...arithmetic.balls import balls
from ...arithmetic.duals import Dual, Duals, independent
from ...arithmetic.values import Values
from ...inputs.stand_ins import rates_of
from ..any_start import gaps_from_start, largest_root
from ..gaps import Gaps, State, are_told_apart, state
from ..paper.requested import STEADY_KEYS, WITH_RATIO, Textbook
from ..regime import Exact, Facts, Regime

PARAMETERS = ("a", "b", "r0", "tilt", "theta_rate", "psi_rate")
"""The variables of the partial derivatives; the tilt is in degrees or radians, as given."""


_USUAL = 8
"""Spare digits of a neighbourhood: orders of magnitude by which numbers may be small."""


class Neighbourhood(Values):
    """A top and its neighbours, in dual numbers by `PARAMETERS`."""

    ar: Duals
    facts: Facts
    """Facts of the top with at_rest = False: the formulas for an arbitrary start are used."""
    state: State[Dual]
    """The start; without torque a is a constant 0."""
    gaps: Gaps[Dual]
    moved: State[Dual]
    """The start, with a variable even if it is 0."""
    broken: frozenset[str]
    """The parameters along which the degenerate facts of the top do not hold."""


def neighbourhood(exact: Exact, digits: int) -> Neighbourhood:
    """Return the dual numbers of a top over balls of `digits` digits.

    Raises TooFewDigitsError if they do not separate the roots.
    """
    facts = exact.facts.replace(at_rest=False, cusp=False, drifts=False)
    ar = Duals(balls(digits))
    moved = dual_state(ar, exact)
    begin = moved.replace(a=ar.convert(0)) if facts.free else moved
    gaps = gaps_from_start(ar, begin, facts, dual_root)
    if not are_told_apart(facts, gaps):
        raise TooFewDigitsError
    return Neighbourhood(ar, facts, begin, gaps, moved, frozenset(broken_by(exact)))


def smallness(near: Neighbourhood) -> int:
    """Return the orders of magnitude by which k^2, a gap or a rate is smaller than usual.

    Gaps are distances of cosines, rates are relative to the fastest rate, and zeros do not count.
    """
    start, gaps = near.moved, near.gaps
    rates = [near.ar.plain.sqrt(start.a.value).least]
    rates += [x.value.least for x in (start.b, start.r0, start.theta_rate, start.psi_rate)]
    cosines = [x.value.least for x in (start.above, start.below, *list(gaps)[:7])]
    widths = [(start.a * gaps.u1_u2 / gaps.a_u3_u2).value.least] if gaps.a_u3_u2 else []
    orders = [size.adjusted() for size in (*cosines, *widths) if size]
    orders += [rate.adjusted() - max(rates).adjusted() for rate in rates if rate]
    return int(max(-min(orders) - _USUAL, 0))


def broken_by(exact: Exact) -> Iterable[str]:
    """Yield the parameters along which a degenerate fact of the top does not hold.

    If the precession rate is a function of the other inputs, the motion stays steady along them.
    """
    facts = exact.facts
    if exact.top.steady_word:
        yield "theta_rate"
    elif facts.regime is Regime.SEPARATRIX:
        yield from ("a", "b", "tilt", "theta_rate", "psi_rate")
    elif facts.steady:
        vertical, still = bool(facts.pole), facts.free and facts.at_rest
        yield from ("theta_rate", "psi_rate")
        yield from () if vertical else ("a",)
        yield from () if vertical or still else ("b",)
        yield from () if still and not vertical else ("tilt",)
    else:
        over = (facts.over_bottom and facts.pole != -1) or (facts.upper_root and facts.pole != 1)
        level = not exact.b and not exact.psi_rate  # beta = b = 0 at every tilt
        yield from ("a",) if facts.free else ()
        yield from ("b",) if over else ()
        yield from ("psi_rate",) if facts.pole or over else ()
        yield from ("tilt",) if facts.pole or (over and not level) else ()


def dual_state(ar: Duals, exact: Exact) -> State[Dual]:
    """Return the start of a top with its derivatives by the parameters."""
    plain = state(ar.plain, exact)
    zero = ar.plain.convert(0)
    arc = zero + 1 if exact.top.theta0_rad is not None else ar.plain.pi / 180
    parameters = plain.a, plain.b, plain.r0, zero, plain.theta_rate, plain.psi_rate
    a, b, r0, tilt, theta_rate, psi_rate = independent(parameters)

    def turned(value: Ball, slope: Ball) -> Dual:
        """Return a function of the tilt from its value and slope."""
        return Dual(value) + tilt * Dual(slope * arc)

    cos = turned(plain.cos, -plain.sin)
    if word := exact.top.steady_word:
        rates = rates_of(exact.top)
        double = exact.cosine.vanishes(rates.discriminant)
        none = [ar.plain.nan] * len(PARAMETERS)
        found = Dual(plain.psi_rate, none) if double else rates.rate(ar, a, b, cos, word)
        psi_rate = _with_value(found, plain.psi_rate)
    return State(
        a=a,
        b=b,
        r0=r0,
        sleep=_with_value(b * b / 2 - a, plain.sleep),
        spin_drift=_with_value(r0 - b / 2, plain.spin_drift),
        pole_drift=_with_value(r0 - b, plain.pole_drift),
        sin=turned(plain.sin, plain.cos),
        cos=cos,
        sin_half=turned(plain.sin_half, plain.cos_half / 2),
        cos_half=turned(plain.cos_half, -plain.sin_half / 2),
        below=turned(plain.below, -plain.sin),
        above=turned(plain.above, plain.sin),
        theta_rate=theta_rate,
        psi_rate=psi_rate,
    )


def generic_gaps(near: Neighbourhood) -> Gaps[Dual]:
    """Return the gaps by the formulas of generic tops, with the values of this top."""
    facts = near.facts.replace(over_bottom=False, upper_root=0)
    with near.ar.working():
        gaps = gaps_from_start(near.ar, near.moved, facts, dual_root)
        values = zip(gaps.fields, gaps, near.gaps, strict=True)
        return Gaps(**{name: _with_value(x, y.value) for name, x, y in values})


def dual_root(ar: Duals, c2: Dual, c1: Dual, c0: Dual, above: Dual) -> Dual:
    """Return the largest root of x^3 + c2 x^2 + c1 x + c0 with its derivatives."""
    x = largest_root(ar.plain, c2.value, c1.value, c0.value, above.value)
    return moving_root(ar.convert(1), c2, c1, c0, x)


def moving_root(c3: Dual, c2: Dual, c1: Dual, c0: Dual, x: Ball) -> Dual:
    """Return a simple root of a cubic, from its known value, by the implicit function theorem."""
    cubic = ((c3 * Dual(x) + c2) * Dual(x) + c1) * Dual(x) + c0
    slope = (3 * c3.value * x + 2 * c2.value) * x + c1.value
    return Dual(x, [-partial / slope for partial in cubic.partials or ()])


def textbook_partials(exact: Exact, key: str, digits: int) -> dict[str, Ball] | None:
    """Return the derivatives of a key of elementary theory by a, b, the tilt and A/C.

    Derivatives are NaN if a square root in the formula is 0: the key then has a kink or an infinite
    slope.
    """
    ar = Duals(balls(digits))
    book = Textbook(ar, exact, dual_state(ar, exact))
    with ar.working():
        found: Dual | None = getattr(book, key)
        if found is None:
            return None
        none = [ar.plain.convert(0)] * len(PARAMETERS)
        if key in STEADY_KEYS and exact.cosine.vanishes(book.steady.discriminant):
            found, none = Dual(found.value), [ar.plain.nan] * len(PARAMETERS)
        by_ratio = found.value / book.ratio.value if key in WITH_RATIO else ar.plain.convert(0)
        return dict(zip(PARAMETERS, found.partials or none, strict=True)) | {"A/C": by_ratio}


def by_inputs(exact: Exact) -> dict[str, dict[str, Fraction]]:
    """Return the derivatives of a = 2mgs/A, b = C r0/A, A/C and the start by each input, without 0.

    Only keys of elementary theory depend on A/C, which is not among `PARAMETERS`.
    """
    top = exact.top
    m, A, C, s, g = (Fraction(x) for x in (top.m, top.A, top.C, top.s, top.g))
    a, b, r0 = exact.a, exact.b, exact.r0
    tilt = "theta0_deg" if top.theta0_rad is None else "theta0_rad"
    one = Fraction(1)
    derivatives = {
        "m": {"a": a / m},
        "A": {"a": -a / A, "b": -b / A, "A/C": 1 / C},
        "C": {"b": r0 / A, "A/C": -A / C / C},
        "s": {"a": 2 * m * g / A},
        "g": {"a": 2 * m * s / A},
        "r0": {"b": C / A, "r0": one},
        tilt: {"tilt": one},
        "thetadot0": {"theta_rate": one},
        "psidot0": {"psi_rate": one},
    }
    if top.steady_word:
        del derivatives["psidot0"]
    return {name: {by: x for by, x in row.items() if x} for name, row in derivatives.items()}


def _with_value(x: Dual, value: Ball) -> Dual:
    return Dual(value, x.partials)
