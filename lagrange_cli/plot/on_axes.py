"""Pictures on axes of your own, in your own style: a function per kind of picture.

Each takes an `Axes` of matplotlib, or a sequence of as many as its kind has, and makes a new figure
if none is given.  `t_max` is the last time, `radians` the unit of angles, `dark` selects colours
for dark paper.  They raise LagtopError for a time out of range, and if there is nothing to draw.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias, TypedDict, Unpack

from matplotlib.axes import Axes

from ..errors import LagtopError
from ..motion.solve import Motion
from .curves import checked_span
from .kinds import KINDS
from .request import MAP_KEY, PlotRequest, parse_input_range
from .style import chosen_look, points

Places: TypeAlias = Axes | Sequence[Axes] | None


class OverTime(TypedDict, total=False):
    """Options of a picture over time."""

    t_max: float | None
    radians: bool
    dark: bool


def draw_sphere(motion: Motion, ax: Places = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw the path of the figure axis on the unit sphere, and return the axes."""
    return _drawn("sphere", motion, ax, **shown)


def draw_angles(motion: Motion, ax: Places = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw tilt, spin and precession over time on three axes, and return these."""
    return _drawn("angles", motion, ax, **shown)


def draw_remainders(motion: Motion, ax: Places = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw the periodic parts of spin and precession on two axes, and return these."""
    return _drawn("remainders", motion, ax, **shown)


def draw_cubic(motion: Motion, ax: Places = None, *, dark: bool = False) -> list[Axes]:
    """Draw f(u) with its roots and the band of the motion, and return the axes."""
    return _drawn("cubic", motion, ax, dark=dark)


def draw_phase(
    motion: Motion, ax: Places = None, *, radians: bool = False, dark: bool = False
) -> list[Axes]:
    """Draw tilt rate against tilt, and the separatrix, and return the axes."""
    return _drawn("phase", motion, ax, radians=radians, dark=dark)


def draw_map(
    motion: Motion,
    ax: Places = None,
    *,
    key: str = MAP_KEY,
    x: str | None = None,
    y: str | None = None,
    dark: bool = False,
) -> list[Axes]:
    """Draw a key of the record over two inputs, and return the axes.

    Ranges are texts such as `r0=5:120:80`.
    """
    over = [parse_input_range(name, text) if text else None for name, text in (("x", x), ("y", y))]
    return _drawn("map", motion, ax, key=key, x=over[0], y=over[1], dark=dark)


def _drawn(
    name: str,
    motion: Motion,
    ax: Places,
    *,
    t_max: float | None = None,
    dark: bool = False,
    **wanted: Any,
) -> list[Axes]:
    """Draw a kind of picture, and return the axes it is on."""
    kind, request = KINDS[name], PlotRequest(t_max=checked_span(motion, t_max), **wanted)
    axes = _axes_of(ax, kind.axes)
    drawing = kind.drawing(motion, request)
    used = len(drawing.heights)
    drawing.draw(axes[:used], chosen_look(dark))
    axes[0].set_title(drawing.title, pad=points(18))  # above names at the top of the axes
    for empty in axes[used:]:
        empty.set_axis_off()
    return axes


def _axes_of(ax: Places, count: int) -> list[Axes]:
    """Return so many axes: those given, or new ones.  Raises LagtopError for another number."""
    if ax is None:
        from matplotlib import pyplot

        return list(
            pyplot.subplots(count, sharex=True, squeeze=False, layout="constrained")[1].flat
        )
    axes = [ax] if isinstance(ax, Axes) else list(ax)
    if len(axes) != count:
        raise LagtopError(f"ax must be {count} axes, got {len(axes)}", "ax")
    return axes
