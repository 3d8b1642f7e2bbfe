"""The cubic behind the nutation (section 4): its roots u2 <= u1 <= 1 <= u3, as distances.

With u = u0 + x, counted from the start u0 = cos(theta0), every later formula needs only the gaps
between the roots, the poles and the start.  Gaps to the far root carry the factor a, so that they
stay finite without torque.  Equation numbers in parentheses are Chrapan's; what is without number
continues him to starts that are not at rest.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..arithmetic.numbers import R, absolute
from ..arithmetic.values import Over, Values
from .cubic_roots import two_roots
from .regime import Exact, Facts

if TYPE_CHECKING:
    from ..arithmetic.protocol import Arithmetic

FindRoot = Callable[..., R]
"""A function of an arithmetic, c2, c1, c0 and a number above: see `gaps_from_start`."""


class State(Values, Over[R]):
    """Constants of the motion and the state at t = 0, each rounded once from its exact value."""

    a: R
    """2mgs/A (4,4)."""
    b: R
    """C r0/A (4,5)."""
    r0: R
    sleep: R
    """b^2/2 - a."""
    spin_drift: R
    """r0 - b/2 = r0 (1 - C/2A), the spin rate less what the nutation does to it (6,1)."""
    pole_drift: R
    """r0 - b, the spin rate less what both poles do to it."""
    sin: R
    cos: R
    sin_half: R
    cos_half: R
    below: R
    """1 + cos(theta0)."""
    above: R
    """1 - cos(theta0)."""
    theta_rate: R
    psi_rate: R

    @property
    def energy(self) -> R:
        """theta'^2 + psi'^2 sin^2(theta0), of which alpha - a u0 consists (4,4)."""
        around = self.psi_rate * self.sin
        return self.theta_rate * self.theta_rate + around * around

    @property
    def momentum(self) -> R:
        """psi' sin^2(theta0), which is beta - b u0 (4,5)."""
        return self.psi_rate * self.sin * self.sin


class Gaps(Values, Over[R]):
    """Distances between roots, poles and start, and beta - b u (4,7) at the roots and the poles."""

    u1_u: R
    u_u2: R
    u1_u2: R
    below_u1: R
    """1 + u1."""
    below_u2: R
    """1 + u2."""
    above_u1: R
    """1 - u1."""
    above_u2: R
    """1 - u2."""
    a_u3_u: R
    """a (u3 - u0)."""
    a_u3_u1: R
    a_u3_u2: R
    a_u3_above: R
    """a (u3 - 1)."""
    a_below_u3: R
    """a (1 + u3)."""
    momentum_u1: R
    """beta - b u1."""
    momentum_u2: R
    """beta - b u2."""
    beta_plus_b: R
    beta_minus_b: R


def state(ar: Arithmetic[R], exact: Exact) -> State[R]:
    """Return constants and start of one top in an arithmetic."""
    a, b, r0 = exact.a, exact.b, exact.r0
    tilt = exact.cosine.tilt(ar)
    below, cos, above = (
        2 * tilt.cos_half * tilt.cos_half,
        tilt.cos,
        2 * tilt.sin_half * tilt.sin_half,
    )
    u = exact.cosine.rational
    if u is not None:
        below, cos, above = ar.convert(1 + u), ar.convert(u), ar.convert(1 - u)
    return State(
        a=ar.convert(a),
        b=ar.convert(b),
        r0=ar.convert(r0),
        sleep=ar.convert(b * b / 2 - a),
        spin_drift=ar.convert(r0 - b / 2),
        pole_drift=ar.convert(r0 - b),
        sin=tilt.sin,
        cos=cos,
        sin_half=tilt.sin_half,
        cos_half=tilt.cos_half,
        below=below,
        above=above,
        theta_rate=ar.convert(exact.theta_rate),
        psi_rate=ar.convert(exact.psi_rate),
    )


def gaps_of(
    ar: Arithmetic[R], facts: Facts, state: State[R], find_root: FindRoot[R] | None = None
) -> Gaps[R]:
    """Return the gaps of any top; `find_root` gives the largest root of a cubic.

    A release from rest and a steady motion do without it.
    """
    if released(facts):
        return gaps_from_rest(ar, state)
    return gaps_from_start(ar, state, facts, find_root)


def released(facts: Facts) -> bool:
    """Return whether a top starts at rest and falls, so that nothing cancels in its gaps."""
    return facts.at_rest and not (facts.steady or facts.regime == "separatrix")


def gaps_from_rest(ar: Arithmetic[R], start: State[R]) -> Gaps[R]:
    """Return the gaps after release from rest, (4,11)-(4,18) times a; nothing cancels.

    With S, Q = sin^2, cos^2 of theta0/2 and b^2 = 2 a lambda:  a (u3 - u1) (u1 - u2) = 4 a S Q,
    a (u3 - 1) (1 - u2) = 2 b^2 S,  a (u3 + 1) (1 + u2) = 2 b^2 Q; in each pair the larger factor is
    a sum of positive terms and the smaller one the quotient.
    """
    a, b, sleep, above, below = start.a, start.b, start.sleep, start.above, start.below
    zero = 0 * start.cos
    x = ar.where(above <= below, sleep + a * above, b * b / 2 + a - a * below)
    a_sin = a * start.sin
    rho = ar.sqrt(x * x + a_sin * a_sin)
    larger = rho + absolute(x)
    upward = x >= 0
    larger_1 = rho + absolute(sleep)
    smaller_1 = b * b * (above / larger_1)
    fast = sleep >= 0
    u1_u2 = ar.where(upward, start.sin * (a_sin / larger), larger / a)
    a_below_u3 = b * b / 2 + a + rho
    a_u3_u1 = ar.where(upward, larger, a_sin * (a_sin / larger))
    return Gaps(
        u1_u=zero,
        u_u2=u1_u2,
        u1_u2=u1_u2,
        below_u1=below,
        below_u2=b * b * below / a_below_u3,
        above_u1=above,
        above_u2=ar.where(fast, smaller_1, larger_1 / a),
        a_u3_u=a_u3_u1,
        a_u3_u1=a_u3_u1,
        a_u3_u2=2 * rho,
        a_u3_above=ar.where(fast, larger_1, a * smaller_1),
        a_below_u3=a_below_u3,
        momentum_u1=zero,
        momentum_u2=b * u1_u2,
        beta_plus_b=b * below,
        beta_minus_b=-b * above,
    )


def gaps_from_start(
    ar: Arithmetic[R], start: State[R], facts: Facts, find_root: FindRoot[R] | None
) -> Gaps[R]:
    """Return the gaps of any start: the cubic (4,9) is a x^3 + c2 x^2 + c1 x + c0 in x = u - u0.

    D = a (u3 - u0) is its largest root times a; the other two solve a quadratic equation whose
    discriminant is a sum of positive terms.  A gap that is exactly 0 is put in as 0.  `find_root`
    gives the largest root of x^3 + c2 x^2 + c1 x + c0 from c2, c1, c0 and a number above it.
    """
    a, b, u0, above, below = start.a, start.b, start.cos, start.above, start.below
    zero = 0 * u0
    momentum, (c0, c1, c2) = start.momentum, cubic(start)
    a_c0 = a * c0
    separatrix = facts.regime == "separatrix"
    if separatrix or facts.upper_root == 3:
        D = a * above
    elif facts.steady:
        D = -c2
    else:
        assert find_root is not None
        D = find_root(ar, c2, a * c1, a * a_c0, start.energy + b * b + 2 * a)
    if facts.steady:
        x1, x2 = zero, zero
    elif separatrix:
        x1, x2 = above, -c0 / (D * above)
    else:
        x1, x2 = two_roots(ar, (c1 + a_c0 / D) / D, -c0 / D)
    x1 = above if facts.upper_root == 1 else x1
    x2 = -below if facts.over_bottom else x2
    return Gaps(
        u1_u=x1,
        u_u2=-x2,
        u1_u2=x1 - x2,
        below_u1=below + x1,
        below_u2=zero if facts.over_bottom else below + x2,
        above_u1=zero if separatrix or facts.upper_root == 1 else above - x1,
        above_u2=above - x2,
        a_u3_u=D,
        a_u3_u1=zero if separatrix else D - a * x1,
        a_u3_u2=D - a * x2,
        a_u3_above=zero if separatrix or facts.upper_root == 3 else D - a * above,
        a_below_u3=D + a * below,
        momentum_u1=zero
        if facts.cusp or facts.upper_root == 1 or separatrix
        else momentum - b * x1,
        momentum_u2=zero if facts.over_bottom else momentum - b * x2,
        beta_plus_b=zero if facts.over_bottom else below * (start.psi_rate * above + b),
        beta_minus_b=zero
        if facts.upper_root or separatrix
        else above * (start.psi_rate * below - b),
    )


def cubic(start: State[R]) -> tuple[R, R, R]:
    """Return c0, c1, c2 of the cubic (4,9) in x = u - u0, which is a x^3 + c2 x^2 + c1 x + c0."""
    a, b, u0, energy = start.a, start.b, start.cos, start.energy
    along = start.sin * start.theta_rate
    c1 = 2 * b * start.momentum - a * start.sin * start.sin - 2 * u0 * energy
    return along * along, c1, 2 * a * u0 - energy - b * b


def are_told_apart(facts: Facts, gaps: Gaps[Any]) -> bool:
    """Return whether every gap that is not exactly 0 has come out positive."""
    touches = facts.regime == "separatrix"
    zeros = {
        "u1_u2": facts.steady,
        "above_u1": facts.upper_root == 1 or touches,
        "below_u2": facts.over_bottom,
        "a_u3_u1": touches,
        "a_u3_above": facts.upper_root == 3 or touches,
    }
    return facts.steady or all(zero or getattr(gaps, name) > 0 for name, zero in zeros.items())
