"""The cubic behind the nutation (section 4): its roots u2 <= u1 <= 1 <= u3, as distances.

Let u = u0 + x, where u0 = cos(theta0) is the start.  Every later formula needs only the gaps
between the roots, the poles and the start.  Gaps to the far root have the factor a, so that they
stay finite without torque.  Equation numbers in parentheses are Chrapan's; formulas without a
number extend his to starts that are not at rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Generic, NamedTuple

from ..arithmetic.numbers import R, absolute
from .regime import Exact, Facts

if TYPE_CHECKING:
    from ..arithmetic.ball import Ball, Balls
    from ..arithmetic.numbers import Arithmetic


class State(NamedTuple, Generic[R]):
    """Constants of the motion and the state at t = 0, each rounded once from its exact value."""

    a: R
    """2mgs/A (4,4)."""
    b: R
    """C r0/A (4,5)."""
    r0: R
    sleep: R
    """b^2/2 - a."""
    spin_drift: R
    """r0 - b/2 = r0 (1 - C/2A), the spin rate without the effect of the nutation (6,1)."""
    pole_drift: R
    """r0 - b, the spin rate without the contributions of both poles."""
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
        """theta'^2 + psi'^2 sin^2(theta0) = alpha - a u0 (4,4)."""
        around = self.psi_rate * self.sin
        return self.theta_rate * self.theta_rate + around * around

    @property
    def momentum(self) -> R:
        """psi' sin^2(theta0) = beta - b u0 (4,5)."""
        return self.psi_rate * self.sin * self.sin


class Gaps(NamedTuple, Generic[R]):
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


def state(ar: Balls, exact: Exact) -> State[Ball]:
    """Return the constants and the start of one top in balls."""
    a, b, r0 = exact.a, exact.b, exact.r0
    tilt = exact.tilt.tilt(ar)
    if exact.psi_rate is None:
        from ..arithmetic.ball import Ball
        from ..top.derived import rates_of  # start-up: for few tops

        rates, word = rates_of(exact.top), str(exact.top.steady_word)
        psi_rate = Ball(rates.rate(word))
    else:
        psi_rate = ar.convert(exact.psi_rate)
    return State(
        a=ar.convert(a),
        b=ar.convert(b),
        r0=ar.convert(r0),
        sleep=ar.convert(b * b / 2 - a),
        spin_drift=ar.convert(r0 - b / 2),
        pole_drift=ar.convert(r0 - b),
        sin=tilt.sin,
        cos=tilt.cos,
        sin_half=tilt.sin_half,
        cos_half=tilt.cos_half,
        below=2 * tilt.cos_half * tilt.cos_half,
        above=2 * tilt.sin_half * tilt.sin_half,
        theta_rate=ar.convert(exact.theta_rate),
        psi_rate=psi_rate,
    )


def gaps_from_rest(ar: Arithmetic[R], start: State[R]) -> Gaps[R]:
    """Return the gaps after release from rest, (4,11)-(4,18) times a; no digits cancel.

    Let S, Q = sin^2, cos^2 of theta0/2 and b^2 = 2 a lambda.  Then `a (u3 - u1) (u1 - u2) = 4 a S
    Q`, `a (u3 - 1) (1 - u2) = 2 b^2 S` and `a (u3 + 1) (1 + u2) = 2 b^2 Q`.  In each pair the
    larger factor is a sum of positive terms, and the smaller factor is the quotient.
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


def zero_gaps(facts: Facts) -> set[str]:
    """Return the names of the gaps that are exactly 0, except after release from rest."""
    touches = facts.regime == "separatrix"
    upright = touches or facts.upper_root == 1
    zeros = {
        "u1_u2": facts.steady,
        "above_u1": upright,
        "below_u2": facts.over_bottom,
        "a_u3_u1": touches,
        "a_u3_above": touches or facts.upper_root == 3,
        "momentum_u1": upright or facts.cusp,
        "momentum_u2": facts.over_bottom,
        "beta_plus_b": facts.over_bottom,
        "beta_minus_b": touches or facts.upper_root,
    }
    return {name for name, is_zero in zeros.items() if is_zero}


def are_told_apart(facts: Facts, gaps: Gaps[Any]) -> bool:
    """Return whether every gap that is not exactly 0 is proved positive."""
    positive = {"u1_u2", "above_u1", "below_u2", "a_u3_u1", "a_u3_above"} - zero_gaps(facts)
    return facts.steady or all(getattr(gaps, name) > 0 for name in positive)
