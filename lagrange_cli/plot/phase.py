"""The cubic f(u), and the orbit of the nutation in the phase plane, as numbers.

Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..motion.make_sampler import solution_of
from ..motion.solve import Motion
from .curves import PHASES, phase_times, refined, sample, span


class Cubic(NamedTuple):
    """f(u) of (4,9) about its roots, and u at the start.  u3 is None without torque, and out of
    view where it is far."""

    u: Array
    f: Array
    u1: float
    u2: float
    u3: float | None
    start: float

    def heights(self) -> tuple[float, float]:
        """What of f(u) to show: its hump over the band, and as much below it."""
        near = self.u3 is not None and self.u3 <= self.u[-1]
        last = self.u3 if near and self.u3 is not None else self.u1
        inside = (self.u >= self.u2) & (self.u <= last)
        most = float(np.abs(self.f[inside]).max(initial=0.0)) or float(np.abs(self.f).max())
        return -1.3 * most, 1.3 * most


def cubic_curve(motion: Motion) -> Cubic:
    """f(u) from its product form, over a window about the band u2 ... u1, and u3 if it is near."""
    solution = solution_of(motion.top)
    begin, roots = solution.start, solution.roots
    u1, u2 = float(roots.u1), float(roots.u2)
    u3 = None if roots.u3 is None else float(roots.u3)
    band = float(roots.u1_u2)
    near = u3 is not None and u3 - u1 <= max(4.0 * band, 0.0 if band else 2.0)
    right = u3 if near and u3 is not None else u1
    width = right - u2 or 0.4
    u = np.linspace(u2 - 0.5 * width, right + 0.5 * width, 801)
    f = (u - u1) * (u - u2)
    if u3 is None:
        f *= -float(begin.alpha + begin.b**2)
    else:
        f *= float(begin.a) * (u - u3)
    return Cubic(u, f, u1, u2, u3, float(begin.u))


class PhasePortrait(NamedTuple):
    """Tilt and its rate over a nutation, and on the separatrix of the same body and spin."""

    theta: Array
    rate: Array
    start: tuple[float, float]
    separatrix: tuple[Array, Array] | None
    """Upper half, from the upright position down; None above the sleeping threshold."""
    why: str
    """In words, what the separatrix is, or why there is none."""


def phase_portrait(motion: Motion) -> PhasePortrait:
    """The orbit and the separatrix in the plane of tilt and tilt rate."""

    def orbit(t: Array) -> Array:
        swing = sample(motion, t)
        return np.stack([swing.attitude.theta(), swing.theta_rate], axis=1)

    theta, rate = orbit(refined(phase_times(motion, span(motion, 1)), orbit)).T
    begin = solution_of(motion.top).start
    a, b = float(begin.a), float(begin.b)
    start = float(theta[0]), float(motion.top.thetadot0)
    if not b * b < 2 * a:
        why = "no torque" if a == 0 else f"λ = {b * b / (2 * a):.3g} ≥ 1"
        why = f"no separatrix: upright it is stable, {why}"
        return PhasePortrait(theta, rate, start, None, why)
    return PhasePortrait(
        theta, rate, start, separatrix(a, b), "separatrix: upright (β = b), same spin"
    )


def separatrix(a: float, b: float) -> tuple[Array, Array]:
    """The orbit that leaves the upright position and comes back to it (b^2 < 2a): tilt and rate.

    With alpha = a and beta = b in (4,9): theta'^2 = 2 a sin^2(theta/2) - b^2 tan^2(theta/2).
    """
    lowest = math.acos(b * b / a - 1)
    theta = lowest * np.sin(np.linspace(0.0, math.pi / 2, 4 * PHASES + 1))
    half = theta / 2
    square = 2 * a * np.sin(half) ** 2 - (b * np.tan(half)) ** 2
    rate = np.sqrt(np.maximum(square, 0.0))
    if b:
        rate[-1] = 0.0
    return theta, rate
