"""Pictures on axes of your own, in your own style: a function per kind of picture.

Each takes an `Axes` of matplotlib, or a sequence of as many as its kind has, and makes a new figure
where none is given.  `t_max` is the last time, `radians` the unit of angles, `dark` says that the
paper is.  They raise LagtopError for a time out of range, and where there is nothing to draw.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias, TypedDict, Unpack

from matplotlib.axes import Axes

from ..errors import LagtopError
from ..motion.solve import Motion
from .curves import checked_span
from .key_map import parse_input_range
from .kinds import KINDS
from .request import PlotRequest
from .style import chosen_look

Places: TypeAlias = Axes | Sequence[Axes] | None


class OverTime(TypedDict, total=False):
    """What can be asked of a picture over time."""

    t_max: float | None
    radians: bool
    dark: bool


def draw_sphere(motion: Motion, ax: Places = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw the path of the figure axis on the unit sphere, and return the axes.

    A colour bar for the time takes the last of their collections.
    """
    return _drawn("sphere", motion, ax, **shown)


def draw_angles(motion: Motion, ax: Places = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw tilt, spin and precession over time on three axes, and return these."""
    return _drawn("angles", motion, ax, **shown)


def draw_remainders(motion: Motion, ax: Places = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw spin and precession less their mean growth on two axes, and return these."""
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
    key: str = "mean_precession_rate",
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
    places = _places(ax, kind.axes)
    kind.draw_on(places, motion, request, chosen_look(dark))
    return places


def _places(ax: Places, count: int) -> list[Axes]:
    """Return so many axes: those given, or new ones.  Raises LagtopError for another number."""
    if ax is None:
        from matplotlib import pyplot

        return list(
            pyplot.subplots(count, sharex=True, squeeze=False, layout="constrained")[1].flat
        )
    places = [ax] if isinstance(ax, Axes) else list(ax)
    if len(places) != count:
        raise LagtopError(f"ax must be {count} axes, got {len(places)}", "ax")
    return places
