"""The tops next to a top: its start and its gaps as dual numbers, with their partial derivatives.

The formulas know a top by six parameters: a, b, r0, the tilt and the two rates at the start.  What
is exactly so at the top itself, such as u1 = u2, need not be so next to it; `Neighbourhood` says
along which parameters it is not.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Iterable
from decimal import Decimal, DivisionByZero, InvalidOperation
from fractions import Fraction

from ..arithmetic.correct_rounding import precisions
from ..arithmetic.duals import Dual, Duals, independent
from ..arithmetic.values import Values
from ..errors import LagtopError
from .gaps import Gaps, State, are_told_apart, gaps_from_start, largest_root, state
from .regime import Exact, Facts, Regime

PARAMETERS = ("a", "b", "r0", "tilt", "theta_rate", "psi_rate")
"""What the partial derivatives are by; the tilt in degrees or radians, as it was given."""

FIRST_DIGITS, _MOST_DIGITS = 48, 800
_USUAL = 8
"""Orders of magnitude that the digits of the first neighbourhood have to spare."""
_AGREED, _NOISE = Decimal("1e-22"), Decimal("1e-36")
"""How well two precisions agree, of each derivative and beside the largest one and the value."""


class Neighbourhood(Values):
    """A top and those next to it, in dual numbers by `PARAMETERS`."""

    ar: Duals
    facts: Facts
    """What holds at the top, but for the release from rest: formulas for any start are in use."""
    state: State[Dual]
    """The start; without torque a is a constant 0."""
    gaps: Gaps[Dual]
    moved: State[Dual]
    """The start, where a may leave 0, too."""
    broken: frozenset[str]
    """The parameters along which the degenerate facts of the top do not hold."""


def neighbourhood(exact: Exact, first: int = FIRST_DIGITS) -> Neighbourhood:
    """Return the dual numbers of a top, with so many digits that the gaps settle.

    Raises LagtopError where no precision tells the roots apart.
    """
    facts = exact.facts.replace(at_rest=False, cusp=False, drifts=False)
    broken = frozenset(broken_by(exact))
    previous: Neighbourhood | None = None
    for digits in precisions(first):
        ar = Duals(digits)
        with ar.working():
            moved = dual_state(ar, exact)
            begin = moved.replace(a=Dual(Decimal(0))) if facts.free else moved
            try:
                gaps = dual_gaps(ar, begin, facts)
            except (InvalidOperation, DivisionByZero):
                continue
            if not are_told_apart(facts, _values(gaps)):
                continue
            found = Neighbourhood(ar, facts, begin, gaps, moved, broken)
            if facts.steady or (previous is not None and _agree(gaps, previous.gaps)):
                return found
            previous = found
    raise LagtopError("the roots of the cubic cannot be told apart")


def fine_neighbourhood(exact: Exact) -> Neighbourhood:
    """Return the dual numbers of a top with two digits more for each order of its smallness.

    A derivative may be smaller than its number by as many orders, and its noise larger.  Raises
    LagtopError where no precision tells the roots apart.
    """
    near = neighbourhood(exact)
    orders = smallness(near)
    return neighbourhood(exact, min(FIRST_DIGITS + 2 * orders, _MOST_DIGITS)) if orders else near


def smallness(near: Neighbourhood) -> int:
    """Return by how many orders of magnitude k^2, a gap or a rate is smaller than is usual.

    Gaps are those of the cosines, rates are compared with the fastest one; what is 0 is not small.
    """
    start, gaps = near.moved, _values(near.gaps)
    with near.ar.working():
        rates = [start.a.value.sqrt()]
        rates += [abs(x.value) for x in (start.b, start.r0, start.theta_rate, start.psi_rate)]
        fastest = max(rates)
        cosines = start.above.value, start.below.value, *list(gaps)[:7]
        moduli = [start.a.value * gaps.u1_u2 / gaps.a_u3_u2] if gaps.a_u3_u2 else []
        sizes = [*cosines, *moduli, *(rate / fastest for rate in rates if fastest)]
        least: Decimal = min(size for size in sizes if size > 0)
        return max(-least.adjusted() - _USUAL, 0)


def broken_by(exact: Exact) -> Iterable[str]:
    """Yield the parameters along which a degenerate fact of the top does not hold."""
    facts = exact.facts
    if facts.regime is Regime.SEPARATRIX:
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
    arc = Decimal(1) if exact.top.theta0_rad is not None else ar.plain.pi / 180
    parameters = plain.a, plain.b, plain.r0, Decimal(0), plain.theta_rate, plain.psi_rate
    a, b, r0, tilt, theta_rate, psi_rate = independent(parameters)

    def turned(value: Decimal, slope: Decimal) -> Dual:
        """Return a function of the tilt by its value and slope."""
        return Dual(value) + tilt * Dual(slope * arc)

    return State(
        a=a,
        b=b,
        r0=r0,
        sleep=_with_value(b * b / 2 - a, plain.sleep),
        spin_drift=_with_value(r0 - b / 2, plain.spin_drift),
        pole_drift=_with_value(r0 - b, plain.pole_drift),
        sin=turned(plain.sin, plain.cos),
        cos=turned(plain.cos, -plain.sin),
        sin_half=turned(plain.sin_half, plain.cos_half / 2),
        cos_half=turned(plain.cos_half, -plain.sin_half / 2),
        theta_rate=theta_rate,
        psi_rate=psi_rate,
    )


def dual_gaps(ar: Duals, begin: State[Dual], facts: Facts) -> Gaps[Dual]:
    """Return the gaps with their derivatives, those that stay 0 all around as constants."""
    gaps = gaps_from_start(ar, begin, facts, dual_root)
    zeros = {
        "below_u2": facts.over_bottom,
        "above_u1": facts.upper_root == 1,
        "a_u3_above": facts.upper_root == 3,
    }
    return gaps.replace(**{name: Dual(Decimal(0)) for name, zero in zeros.items() if zero})


def generic_gaps(near: Neighbourhood) -> Gaps[Dual]:
    """Return the gaps by the formulas of tops with nothing special, with the values of this top."""
    facts = near.facts.replace(over_bottom=False, upper_root=0)
    with near.ar.working():
        gaps = gaps_from_start(near.ar, near.moved, facts, dual_root)
        values = zip(gaps.fields, gaps, near.gaps, strict=True)
        return Gaps(**{name: _with_value(x, y.value) for name, x, y in values})


def dual_root(ar: Duals, c2: Dual, c1: Dual, c0: Dual, bound: Dual) -> Dual:
    """Return the largest root of a cubic: that of the values, and a last step of Newton's method.

    From a root the step has the value 0 and the derivatives of the implicit function.
    """
    x = largest_root(ar.plain, c2.value, c1.value, c0.value, bound.value)
    root = Dual(x)
    slope = (3 * x + 2 * c2.value) * x + c1.value
    return root - (((root + c2) * root + c1) * root + c0) / Dual(slope)


def by_inputs(exact: Exact) -> dict[str, dict[str, Fraction]]:
    """Return the derivatives of a = 2mgs/A, b = C r0/A and the start by each input, but for 0."""
    top = exact.top
    m, A, C, s, g = (Fraction(x) for x in (top.m, top.A, top.C, top.s, top.g))
    a, b, r0 = exact.a, exact.b, exact.r0
    tilt = "theta0_deg" if top.theta0_rad is None else "theta0_rad"
    one = Fraction(1)
    derivatives = {
        "m": {"a": a / m},
        "A": {"a": -a / A, "b": -b / A},
        "C": {"b": r0 / A},
        "s": {"a": 2 * m * g / A},
        "g": {"a": 2 * m * s / A},
        "r0": {"b": C / A, "r0": one},
        tilt: {"tilt": one},
        "thetadot0": {"theta_rate": one},
        "psidot0": {"psi_rate": one},
    }
    return {name: {by: x for by, x in row.items() if x} for name, row in derivatives.items()}


def _with_value(x: Dual, value: Decimal) -> Dual:
    return Dual(value, x.partials)


def _values(gaps: Gaps[Dual]) -> Gaps[Decimal]:
    return Gaps(*(x.value for x in gaps))


def _agree(gaps: Gaps[Dual], others: Gaps[Dual]) -> bool:
    """Return whether two computations of the same gaps agree in values and derivatives."""
    for x, y in zip(gaps, others, strict=True):
        if abs(x.value - y.value) > _AGREED * abs(x.value):
            return False
        ours, theirs = x.partials or (), y.partials or ()
        noise = _NOISE * max(map(abs, (x.value, *ours)))
        if any(abs(p - q) > _AGREED * abs(p) + noise for p, q in zip(ours, theirs, strict=True)):
            return False
    return True
