"""The top as engines take it: moments about the mass centre, in units that suit any engine.

The unit of mass is m, that of length makes A = 1, and that of time makes the rates of the size of
1.  So no engine sees numbers that are very large or small, whatever units the scene has.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ...inputs.top import Top
from ..integrators import scaled_top
from ..method import NotApplicableError


class Body(NamedTuple):
    """A top of mass 1 and moment 1 across the axis, about the pivot, at its start."""

    central: float
    """Moment across the axis about the mass centre: A - m s^2."""
    C: float
    s: float
    g: float
    attitude: tuple[float, float, float, float]
    """Quaternion w, x, y, z from body to space."""
    rates: tuple[float, float, float]
    """Angular velocity along body x, y, z."""
    period: float
    """Nutation period."""

    def steps(self, gap: float, per_period: float) -> int:
        """Return how many equal steps go into a gap, none longer than the wanted part of a period.

        Such a gap, of a whole number of steps, may be off by rounding.
        """
        return math.ceil(gap / self.period * per_period * (1 - 1e-9))


def scaled_body(top: Top, period: float) -> tuple[Body, float]:
    """Return the body of a top with this nutation period, and its units of time per unit of time.

    Raises NotApplicableError where no masses have such moments: engines refuse them.
    """
    p, mass, A = scaled_top(top), float(top.m), float(top.A)
    s, C = float(top.s) * math.sqrt(mass / A), float(top.C) / A
    central = 1 - s * s
    if central <= 0 or C > 2 * central * (1 + 1e-12):
        raise NotApplicableError("engines refuse a body with C > 2(A - m s^2)")
    half = p.theta0 / 2
    body = Body(
        central=max(central, C / 2),
        C=C,
        s=s,
        g=p.a / (2 * s),
        attitude=(math.cos(half), math.sin(half), 0.0, 0.0),
        rates=(p.theta_rate, p.psi_rate * math.sin(p.theta0), p.r0),
        period=period * p.clock,
    )
    return body, p.clock
