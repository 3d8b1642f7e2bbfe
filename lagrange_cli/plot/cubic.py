"""The pictures `cubic`, f(u) with its roots and the band of the motion, and `phase`.

`phase` shows the nutation in the plane of tilt and tilt rate.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from ..arithmetic.types import Array
from ..motion.solve import Motion
from .curves import PHASES, motion_in_words, sampled_columns, span
from .kinds import Places, PlotRequest
from .style import Look, mark_start, number_from_left_to_right, number_text, points

NEAR = 1.5
"""Greatest distance of the third root above the band, in widths of the band, to be shown."""
NARROWEST = 1e-9
"""Least width of a window, in cosines; in a narrower one the doubles would show as steps."""
TOUCHING = 0.09
"""Share of the window within which the names of two roots would touch."""
POLES = {1: "upright", -1: "hanging"}
"""State of the top at each end of the range of a cosine."""
SEPARATRIX = (
    "separatrix: the path of a top that starts upright with this spin\n"
    "(other starts may cross it, as their momentum about the vertical differs)"
)


class Cubic(NamedTuple):
    """Samples of f(u), (4,9), around its roots."""

    u: Array
    f: Array
    u1: float
    u2: float
    u3: float | None
    """The third root; None without torque and for a vertical axis."""

    @property
    def u3_in_view(self) -> float | None:
        """The third root if it is inside the window, else None."""
        return self.u3 if self.u3 is not None and self.u3 <= self.u[-1] else None

    def heights(self) -> tuple[float, float]:
        """Return the range of f(u) to show: the hump over the band, and about the same depth."""
        hump = float(self.f[self.between(self.u1)].max(initial=0.0))
        most = float(np.abs(self.f).max())
        if hump <= 1e-3 * most:  # none that could be seen
            above = bool(self.f[0] > 0)  # beside an upright top that is unstable
            return (-0.35 * most, 1.1 * most) if above else (-1.1 * most, 0.35 * most)
        depth = -float(self.f[self.between(self.u3_in_view or self.u1)].min(initial=0.0))
        return -min(max(1.3 * depth, 0.6 * hump), 1.4 * hump), 1.3 * hump

    def between(self, last: float) -> NDArray[np.bool_]:
        """Return a mask of the samples between the lowest root and `last`."""
        inside: NDArray[np.bool_] = (self.u >= self.u2) & (self.u <= last)
        return inside


def cubic_curve(motion: Motion) -> Cubic:
    """Return f(u), from its product form, over a window around the band, and u3 if it is near."""
    assert motion.u1 is not None
    assert motion.u2 is not None
    u1, u2, u3 = float(motion.u1), float(motion.u2), motion.u3
    band = u1 - u2
    near = u3 is not None and u3 - u1 <= (NEAR * band if band else 2.0)
    right = u3 if near and u3 is not None else u1
    width = max(right - u2, NARROWEST) if right > u2 else 0.4
    u = np.linspace(u2 - 0.4 * width, right + 0.4 * width, 801)
    f = (u - u1) * (u - u2)
    if u3 is None:  # the roots of a cubic add up to (alpha + b^2)/a
        f *= float(motion.a) * (u + u1 + u2) - (motion.energy_constant + float(motion.b) ** 2)
    else:
        f *= float(motion.a) * (u - u3)
    return Cubic(u, f, u1, u2, u3)


def cubic_picture(motion: Motion, request: PlotRequest, places: Places) -> str:
    """Draw f(u), its roots, and the band in which the motion takes place."""
    cubic, look = cubic_curve(motion), request.look
    (axes,) = places((1.0,))
    axes.set(xlim=(cubic.u[0], cubic.u[-1]), ylim=cubic.heights())
    axes.set_ylabel(f"f(u) ({request.unit('1/time²')})")
    axes.axhline(0.0, color=look.quiet, lw=points(0.9))
    if cubic.u2 < cubic.u1:
        axes.axvspan(cubic.u2, cubic.u1, color=look.faint, zorder=0)
    blue, inside = look.lines[0], cubic.between(cubic.u1)
    axes.fill_between(cubic.u, 0.0, cubic.f, inside, color=blue, alpha=0.3, linewidth=0)
    axes.plot(cubic.u, cubic.f, color=blue)
    _draw_poles(axes, cubic, look)
    _draw_roots(axes, cubic, look)
    number_from_left_to_right(axes)
    return "The cubic f(u) = u̇² (4,9), the motion shaded"


def _draw_poles(axes: Axes, cubic: Cubic, look: Look) -> None:
    """Draw a line at each visible pole, with its name above the picture."""
    for pole, name in POLES.items():
        if cubic.u[0] <= pole <= cubic.u[-1]:
            axes.axvline(pole, color=look.quiet, lw=points(1.0), ls=(0, (4, 3)), zorder=0.5)
            part = (pole - cubic.u[0]) / np.ptp(cubic.u)
            ha = "left" if part < 0.1 else "right" if part > 0.9 else "center"
            how: dict[str, Any] = {"ha": ha, "size": "small", "color": look.quiet}
            how["xycoords"] = axes.get_xaxis_transform()
            axes.annotate(name, (pole, 1.0), (0, 2), textcoords="offset points", **how)


def _draw_roots(axes: Axes, cubic: Cubic, look: Look) -> None:
    """Draw the roots, with names where the curve is out of the way and values below the picture.

    f(u) rises through u2 and u3 and falls through u1.  The upper left of u2, the lower left of u1
    and the lower right of u3 are therefore free.  Names that would touch are joined.
    """
    u1, u2, u3 = cubic.u1, cubic.u2, cubic.u3_in_view
    known = {"u₁ = u₂": u1} if u1 == u2 else {"u₁": u1, "u₂": u2}
    named = known | ({} if u3 is None else {"u₃": u3})
    axes.plot(list(named.values()), [0.0] * len(named), "o", ms=points(7), color=look.ink)
    if u3 is not None and u1 > u2 and u3 - u1 < TOUCHING * np.ptp(cubic.u):
        named = {"u₁, u₃" if u3 > u1 else "u₁ = u₃": u1, "u₂": u2}
    for name, root in named.items():
        ha, x = ("left", points(7)) if name == "u₃" else ("right", points(-7))
        va, y = ("bottom", points(8)) if name.endswith("u₂") else ("top", points(-8))
        how: dict[str, Any] = {"ha": ha, "va": va, "color": look.ink}
        axes.annotate(name, (root, 0.0), (x, y), textcoords="offset points", **how)
    values = [f"{name} = {number_text(root)}" for name, root in known.items()]
    if cubic.u3 is not None:
        values.append(f"u₃ = {number_text(cubic.u3)}" + ", out of sight" * (u3 is None))
    axes.set_xlabel(f"u = cos ϑ\n{',   '.join(values)}", fontsize="small")


class PhasePortrait(NamedTuple):
    """Tilt and tilt rate over a nutation, and on the separatrix of the same body and spin."""

    theta: Array
    rate: Array
    start: tuple[float, float]
    separatrix: tuple[Array, Array]
    """Upper half, from the upright position down; empty above the sleeping threshold."""
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
        return PhasePortrait(theta, rate, start, (np.empty(0), np.empty(0)), why)
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


def phase_picture(motion: Motion, request: PlotRequest, places: Places) -> str:
    """Draw the orbit in the plane of tilt and tilt rate, its start and the separatrix."""
    portrait, factor, look = phase_portrait(motion), request.per_radian, request.look
    (axes,) = places((1.0,))
    axes.set_xlabel(f"tilt ϑ ({request.angle_unit})")
    axes.set_ylabel(f"tilt rate ϑ̇ ({request.unit('rad/time')})")
    axes.axhline(0.0, color=look.quiet, lw=points(0.9))
    axes.plot(portrait.theta * factor, portrait.rate, color=look.lines[0], label="this motion")
    mark_start(axes, portrait.start[0] * factor, portrait.start[1], look)
    theta, rate = portrait.separatrix
    both = np.append(theta, theta[::-1]) * factor, np.append(rate, -rate[::-1])
    dashes = {"lw": points(1.4), "ls": (0, (5, 2))} if theta.size else {"lw": 0.0}
    axes.plot(*both, color=look.ink, label=portrait.why, **dashes)
    axes.margins(0.06)
    number_from_left_to_right(axes)
    return f"Nutation in the phase plane: {motion_in_words(motion)}"
