"""Pictures of motions: files, films, a page for the browser, and drawings on your own axes.

Each function here draws one kind of picture on your own axes, in your own style.  Pass an `Axes` of
matplotlib, or a sequence with as many axes as the kind has; by default a new figure is made.
`t_max` is the last time, `radians` the unit of angles, `dark` selects colours for dark paper.  The
functions raise LagtopError for a time out of range, if there is nothing to draw, and without
matplotlib.

matplotlib and NumPy are imported when a function is called, because help does not need them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict, Unpack

from .files import require_matplotlib
from .kinds import KINDS, MAP_KEY, PlotRequest
from .style import chosen_look, points

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..motion.solve import Motion

    AxesOfUser: TypeAlias = Axes | Sequence[Axes] | None


class OverTime(TypedDict, total=False):
    """Options of a picture over time."""

    t_max: float | None
    radians: bool
    dark: bool


def draw_sphere(motion: Motion, ax: AxesOfUser = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw the path of the figure axis on the unit sphere, and return the axes."""
    return draw(motion, "sphere", ax, **shown)


def draw_angles(motion: Motion, ax: AxesOfUser = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw tilt, spin and precession over time on three axes, and return the axes."""
    return draw(motion, "angles", ax, **shown)


def draw_remainders(motion: Motion, ax: AxesOfUser = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw the periodic parts of spin and precession on two axes, and return the axes."""
    return draw(motion, "remainders", ax, **shown)


def draw_cubic(motion: Motion, ax: AxesOfUser = None, *, dark: bool = False) -> list[Axes]:
    """Draw f(u) with its roots and the band of the motion, and return the axes."""
    return draw(motion, "cubic", ax, dark=dark)


def draw_phase(
    motion: Motion, ax: AxesOfUser = None, *, radians: bool = False, dark: bool = False
) -> list[Axes]:
    """Draw tilt rate against tilt, and the separatrix, and return the axes."""
    return draw(motion, "phase", ax, radians=radians, dark=dark)


def draw_map(
    motion: Motion,
    ax: AxesOfUser = None,
    *,
    key: str = MAP_KEY,
    x: str | None = None,
    y: str | None = None,
    dark: bool = False,
) -> list[Axes]:
    """Draw a key of the record over two inputs, and return the axes.

    `x` and `y` are ranges such as `r0=5:120:80`.
    """
    return draw(motion, "map", ax, key=key, x=x, y=y, dark=dark)


def draw(
    motion: Motion, kind: str = "sphere", ax: AxesOfUser = None, *, dark: bool = False, **shown: Any
) -> list[Axes]:
    """Draw the kind of picture with this name, and return the axes.

    The options are those of the function of the kind, such as `draw_sphere`.  Raises LagtopError
    for an unknown kind, and TypeError for an option that the kind does not have.

    >>> len(draw(solve(Top()), "angles", t_max=1.0))
    3
    """
    from ..errors import LagtopError, check_type  # start-up
    from ..inputs.names import check_names  # start-up
    from ..motion.solve import Motion  # start-up

    check_type("motion", motion, Motion)
    check_type("kind", kind, str)
    check_names("kind", [kind], KINDS)
    picture = KINDS[kind]
    if unknown := [name for name in shown if name not in picture.options]:
        raise TypeError(f"draw_{kind}() got an unexpected keyword argument {unknown[0]!r}")
    require_matplotlib()
    from matplotlib.axes import Axes

    from .curves import checked_span  # start-up

    if "key" in picture.options:
        from .map_axes import parse_input_range  # start-up

        ranges = {name: shown.get(name) for name in ("x", "y")}
        shown |= {name: parse_input_range(name, text) for name, text in ranges.items() if text}
    if "t_max" in shown:
        shown["t_max"] = checked_span(motion, shown["t_max"])
    if ax is None:
        from matplotlib import pyplot

        grid = pyplot.subplots(picture.axes, sharex=True, squeeze=False, layout="constrained")[1]
        axes: list[Axes] = list(grid.flat)
    else:
        axes = [ax] if isinstance(ax, Axes) else list(ax)
    if len(axes) != picture.axes:
        raise LagtopError(f"ax must be {picture.axes} axes, got {len(axes)}", "ax")

    def places(heights: Sequence[float]) -> list[Axes]:
        """Return one axes for each height, and hide the others."""
        for empty in axes[len(heights) :]:
            empty.set_axis_off()
        return axes[: len(heights)]

    title = picture.draw(motion, PlotRequest(look=chosen_look(dark), **shown), places)
    axes[0].set_title(title, pad=points(18))  # above names at the top of the axes
    return axes
