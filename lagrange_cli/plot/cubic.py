"""The picture `cubic`: f(u), its roots, and the band in which the motion takes place.

Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import SubFigure

from ..arithmetic.types import Array
from ..motion.solve import Motion
from .motion_facts import start_of
from .request import PlotRequest
from .style import Look


class Cubic(NamedTuple):
    """f(u) of (4,9) about its roots."""

    u: Array
    f: Array
    u1: float
    u2: float
    u3: float | None
    """The third root; None without torque."""

    @property
    def u3_in_view(self) -> float | None:
        """The third root where it is within the window, else None."""
        return self.u3 if self.u3 is not None and self.u3 <= self.u[-1] else None

    def heights(self) -> tuple[float, float]:
        """Return the range of f(u) to show: the hump over the band, and as much below it."""
        last = self.u1 if self.u3_in_view is None else self.u3_in_view
        inside = (self.u >= self.u2) & (self.u <= last)
        most = float(np.abs(self.f[inside]).max(initial=0.0)) or float(np.abs(self.f).max())
        return -1.3 * most, 1.3 * most


def cubic_curve(motion: Motion) -> Cubic:
    """Return f(u), from its product form, over a window about the band, and u3 if it is near."""
    assert motion.u1 is not None
    assert motion.u2 is not None
    u1, u2, u3 = float(motion.u1), float(motion.u2), motion.u3
    band = u1 - u2
    near = u3 is not None and u3 - u1 <= max(4.0 * band, 0.0 if band else 2.0)
    right = u3 if near and u3 is not None else u1
    width = right - u2 or 0.4
    u = np.linspace(u2 - 0.5 * width, right + 0.5 * width, 801)
    f = (u - u1) * (u - u2)
    if u3 is None:
        start = start_of(motion)
        f *= -(start.alpha + start.b**2)
    else:
        f *= float(motion.a) * (u - u3)
    return Cubic(u, f, u1, u2, u3)


def draw(panel: SubFigure, motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw f(u), its roots, and the band in which the motion takes place."""
    draw_on([panel.subplots()], motion, request, look)


def draw_on(places: Sequence[Axes], motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw the picture on one axes."""
    cubic, (axes,) = cubic_curve(motion), places
    axes.set_title("The cubic f(u) = u̇² (4,9), the motion shaded")
    axes.set(xlabel="u = cos ϑ", ylabel=request.label("f(u) (1/time²)"))
    axes.set(xlim=(cubic.u[0], cubic.u[-1]), ylim=cubic.heights())
    axes.axhline(0.0, color=look.quiet, lw=0.9)
    if cubic.u2 < cubic.u1:
        axes.axvspan(cubic.u2, cubic.u1, color=look.faint, zorder=0)
    inside = (cubic.u >= cubic.u2) & (cubic.u <= cubic.u1)
    axes.fill_between(
        cubic.u, 0.0, cubic.f, where=inside, color=look.lines[0], alpha=0.3, linewidth=0
    )
    axes.plot(cubic.u, cubic.f, color=look.lines[0])
    for pole in (-1, 1):
        if cubic.u[0] <= pole <= cubic.u[-1]:
            axes.axvline(pole, color=look.quiet, lw=1.0, ls=(0, (4, 3)))
    _draw_roots(axes, cubic, look)
    axes.ticklabel_format(axis="x", useOffset=False)
    axes.locator_params(axis="x", nbins=6)


def _draw_roots(axes: Axes, cubic: Cubic, look: Look) -> None:
    """Draw the roots, labelled where the curve leaves room, and an arrow to a u3 out of view."""
    double = cubic.u1 == cubic.u2
    roots = [("u₁ = u₂", cubic.u1, "right", 8)]
    if not double:
        roots = [("u₁", cubic.u1, "right", -18), ("u₂", cubic.u2, "right", 8)]
    if cubic.u3_in_view is not None:
        roots.append(("u₃", cubic.u3_in_view, "left", -18))
    elif cubic.u3 is not None:
        text = f"u₃ = {cubic.u3:.6g} →"
        corner = axes.transAxes
        axes.text(0.99, 0.93, text, transform=corner, ha="right", size="small", color=look.lines[1])
    for name, root, side, height in roots:
        axes.annotate(
            f"{name} = {root:.7g}".replace("-", "−"),
            (root, 0.0),
            (-8 if side == "right" else 8, height),
            textcoords="offset points",
            ha=side,
            size="small",
            color=look.lines[1],
        )
    axes.plot([root[1] for root in roots], [0.0] * len(roots), "o", ms=7, color=look.lines[1])
