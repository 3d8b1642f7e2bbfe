"""The picture `phase`: the nutation in the plane of tilt and tilt rate, and the separatrix.

Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from ..arithmetic.types import Array
from ..motion.solve import Motion
from .curves import PHASES, motion_in_words, sampled_columns, span
from .kinds import Drawing, PlotRequest
from .style import Look, mark_start, number_from_left_to_right, points

SEPARATRIX = (
    "separatrix: the path of a top that starts upright with this spin\n"
    "(other starts may cross it, as their momentum about the vertical differs)"
)


class PhasePortrait(NamedTuple):
    """Tilt and tilt rate over a nutation, and on the separatrix of the same body and spin."""

    theta: Array
    rate: Array
    start: tuple[float, float]
    separatrix: tuple[Array, Array] | None
    """Upper half, from the upright position down; None above the sleeping threshold."""
    why: str
    """The meaning of the separatrix, or the reason why there is none, in words."""


def phase_portrait(motion: Motion) -> PhasePortrait:
    """Return the orbit and the separatrix in the plane of tilt and tilt rate."""
    _, theta, rate = sampled_columns(motion, span(motion, 1), ["theta", "thetadot"]).values()
    start = float(theta[0]), float(motion.top.thetadot0)
    a, b = float(motion.a), float(motion.b)
    if not b * b < 2 * a:
        reason = "without torque" if a == 0 else f"as C²r₀² = {b * b / (2 * a):.3g} · 4Amgs"
        why = f"no separatrix: the upright top is stable with this spin, {reason}"
        return PhasePortrait(theta, rate, start, None, why)
    return PhasePortrait(theta, rate, start, separatrix_orbit(a, b), SEPARATRIX)


def separatrix_orbit(a: float, b: float) -> tuple[Array, Array]:
    """Return tilt and rate on the orbit that leaves the upright position and returns to it.

    The orbit exists for b^2 < 2a.  With alpha = a and beta = b, (4,9) becomes

        theta'^2 = 2 a sin^2(theta/2) - b^2 tan^2(theta/2).
    """
    lowest = math.acos(b * b / a - 1)
    theta = lowest * np.sin(np.linspace(0.0, math.pi / 2, 4 * PHASES + 1))
    half = theta / 2
    square = 2 * a * np.sin(half) ** 2 - (b * np.tan(half)) ** 2
    rate = np.sqrt(np.maximum(square, 0.0))
    if b:
        rate[-1] = 0.0
    return theta, rate


def phase_drawing(motion: Motion, request: PlotRequest) -> Drawing:
    """Compute the orbit and the separatrix."""
    portrait = phase_portrait(motion)

    def draw(axes: Sequence[Axes], look: Look) -> None:
        """Draw the nutation in the plane of tilt and tilt rate."""
        _draw_portrait(axes[0], portrait, request, look)

    return Drawing(f"Nutation in the phase plane: {motion_in_words(motion)}", draw)


def _draw_portrait(axes: Axes, portrait: PhasePortrait, request: PlotRequest, look: Look) -> None:
    """Draw the orbit, its start and the separatrix."""
    factor = request.per_radian
    axes.set(
        xlabel=f"tilt ϑ ({request.angle_unit})", ylabel=request.label("tilt rate ϑ̇ (rad/time)")
    )
    axes.axhline(0.0, color=look.quiet, lw=points(0.9))
    axes.plot(portrait.theta * factor, portrait.rate, color=look.lines[0], label="this motion")
    mark_start(axes, portrait.start[0] * factor, portrait.start[1], look)
    theta, rate = portrait.separatrix or (np.empty(0), np.empty(0))
    both = np.append(theta, theta[::-1]) * factor, np.append(rate, -rate[::-1])
    dashes = {"lw": points(1.4), "ls": (0, (5, 2))} if theta.size else {"lw": 0.0}
    axes.plot(*both, color=look.ink, label=portrait.why, **dashes)
    axes.margins(0.06)
    number_from_left_to_right(axes)
