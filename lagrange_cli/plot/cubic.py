"""The picture `cubic`: f(u), its roots, and the band in which the motion takes place.

Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from ..arithmetic.types import Array
from ..motion.solve import Motion
from .kinds import Drawing, PlotRequest
from .style import Look, number_from_left_to_right, number_text, points

NEAR = 1.5
"""Greatest distance of the third root above the band, in widths of the band, to be shown."""
NARROWEST = 1e-9
"""Least width of a window, in cosines; in a narrower one the doubles would show as steps."""
TOUCHING = 0.09
"""Share of the window within which the names of two roots would touch."""
POLES = {1: "upright", -1: "hanging"}
"""State of the top at each end of the range of a cosine."""


class Cubic(NamedTuple):
    """Samples of f(u), (4,9), around its roots."""

    u: Array
    f: Array
    u1: float
    u2: float
    u3: float | None
    """The third root; None without torque."""

    @property
    def u3_in_view(self) -> float | None:
        """The third root if it is inside the window, else None."""
        return self.u3 if self.u3 is not None and self.u3 <= self.u[-1] else None

    def heights(self) -> tuple[float, float]:
        """Return the range of f(u) to show: the hump over the band, and about the same depth."""
        hump = float(self.f[self._within(self.u1)].max(initial=0.0))
        most = float(np.abs(self.f).max())
        if hump <= 1e-3 * most:  # none that could be seen
            return -1.1 * most, 0.35 * most
        depth = -float(self.f[self._within(self.u3_in_view or self.u1)].min(initial=0.0))
        return -min(max(1.3 * depth, 0.6 * hump), 1.4 * hump), 1.3 * hump

    def _within(self, last: float) -> NDArray[np.bool_]:
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
    if u3 is None:
        f *= -(motion.energy_constant + float(motion.b) ** 2)
    else:
        f *= float(motion.a) * (u - u3)
    return Cubic(u, f, u1, u2, u3)


def cubic_drawing(motion: Motion, request: PlotRequest) -> Drawing:
    """Compute the cubic."""
    cubic = cubic_curve(motion)

    def draw(axes: Sequence[Axes], look: Look) -> None:
        """Draw f(u), its roots, and the band in which the motion takes place."""
        axes[0].set_ylabel(request.label("f(u) (1/time²)"))
        _draw_curve(axes[0], cubic, look)
        _draw_poles(axes[0], cubic, look)
        _draw_roots(axes[0], cubic, look)
        number_from_left_to_right(axes[0])

    return Drawing("The cubic f(u) = u̇² (4,9), the motion shaded", draw)


def _draw_curve(axes: Axes, cubic: Cubic, look: Look) -> None:
    """Draw f(u) and the band."""
    axes.set(xlim=(cubic.u[0], cubic.u[-1]), ylim=cubic.heights())
    axes.axhline(0.0, color=look.quiet, lw=points(0.9))
    if cubic.u2 < cubic.u1:
        axes.axvspan(cubic.u2, cubic.u1, color=look.faint, zorder=0)
    inside = (cubic.u >= cubic.u2) & (cubic.u <= cubic.u1)
    axes.fill_between(
        cubic.u, 0.0, cubic.f, where=inside, color=look.lines[0], alpha=0.3, linewidth=0
    )
    axes.plot(cubic.u, cubic.f, color=look.lines[0])


def _draw_poles(axes: Axes, cubic: Cubic, look: Look) -> None:
    """Draw a line at each visible pole, with its name above the picture."""
    for pole, name in POLES.items():
        if cubic.u[0] <= pole <= cubic.u[-1]:
            axes.axvline(pole, color=look.quiet, lw=points(1.0), ls=(0, (4, 3)), zorder=0.5)
            part = (pole - cubic.u[0]) / np.ptp(cubic.u)
            axes.annotate(
                *(name, (pole, 1.0), (0, 2)),
                xycoords=axes.get_xaxis_transform(),
                textcoords="offset points",
                ha="left" if part < 0.1 else "right" if part > 0.9 else "center",
                size="small",
                color=look.quiet,
            )


def _draw_roots(axes: Axes, cubic: Cubic, look: Look) -> None:
    """Draw the roots, with names where the curve is out of the way and values below the picture."""
    known = {"u₁": cubic.u1, "u₂": cubic.u2}
    if cubic.u1 == cubic.u2:
        known = {"u₁ = u₂": cubic.u1}
    seen = known | ({"u₃": cubic.u3_in_view} if cubic.u3_in_view is not None else {})
    axes.plot(list(seen.values()), [0.0] * len(seen), "o", ms=points(7), color=look.ink)
    for name, root, (right, above) in _named(seen, float(np.ptp(cubic.u))):
        axes.annotate(
            *(name, (root, 0.0), (points(7 if right else -7), points(8 if above else -8))),
            textcoords="offset points",
            ha="left" if right else "right",
            va="bottom" if above else "top",
            color=look.ink,
        )
    values = [f"{name} = {number_text(root)}" for name, root in known.items()]
    if cubic.u3 is not None:
        beyond = "" if cubic.u3_in_view is not None else ", out of sight"
        values.append(f"u₃ = {number_text(cubic.u3)}{beyond}")
    axes.set_xlabel(f"u = cos ϑ\n{',   '.join(values)}", fontsize="small")


def _named(
    roots: Mapping[str, float], window: float
) -> Iterator[tuple[str, float, tuple[bool, bool]]]:
    """Yield each name, its root, and whether it goes to the right and above the axis.

    f(u) rises through u2 and u3 and falls through u1.  The upper left of u2, the lower left of u1
    and the lower right of u3 are therefore free.  Names that would touch are joined.
    """
    free = {"u₁": (False, False), "u₂": (False, True), "u₃": (True, False)}
    together = {"u₁", "u₃"} <= set(roots) and roots["u₃"] - roots["u₁"] < TOUCHING * window
    for name, root in roots.items():
        if name == "u₁" and together:
            yield "u₁, u₃" if roots["u₃"] > root else "u₁ = u₃", root, free[name]
        elif name != "u₃" or not together:
            yield name, root, free.get(name, (False, True))
