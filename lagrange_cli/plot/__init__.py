"""Pictures of motions: files, films, a page for the browser, and drawings on your own axes.

Each function here draws one kind of picture on your own axes, in your own style.  Pass an `Axes` of
matplotlib, or a sequence with as many axes as the kind has; by default a new figure is made.
`t_max` is the last time, `radians` the unit of angles, `dark` selects colours for dark paper.  The
functions raise LagtopError for a time out of range, if there is nothing to draw, and without
matplotlib.

matplotlib and NumPy are imported when a function is called, because every command loads this file.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict, Unpack

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..motion.solve import Motion
    from .map import InputRange

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
    """Draw tilt, spin and precession over time on three axes, and return the axes."""
    return _drawn("angles", motion, ax, **shown)


def draw_remainders(motion: Motion, ax: Places = None, **shown: Unpack[OverTime]) -> list[Axes]:
    """Draw the periodic parts of spin and precession on two axes, and return the axes."""
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

    `x` and `y` are ranges such as `r0=5:120:80`.
    """
    over = [parse_input_range(name, text) if text else None for name, text in (("x", x), ("y", y))]
    return _drawn("map", motion, ax, key=key, x=over[0], y=over[1], dark=dark)


def parse_input_range(name: str, text: str) -> InputRange:
    """Parse a range without a unit, such as `r0=10:100:40` or `r0=log:1:100:40`.

    `name` is the argument to name in errors.  Raises LagtopError as `parse_axis` and `input_range`.
    """
    from .map import input_range, parse_axis

    known, value = parse_axis(name, text)
    if value.unit:
        from ..errors import LagtopError

        raise LagtopError(f"{name} must have no unit, as the motion has none, got {text!r}", name)
    return input_range(name, known, value.number)


def draw(motion: Motion, kind: str = "sphere", ax: Places = None, **options: Any) -> list[Axes]:
    """Draw the kind of picture with this name, and return the axes.

    The options are those of the function of the kind, such as `draw_sphere`.  Raises LagtopError
    for an unknown kind.

    >>> len(draw(solve(Top()), "angles", t_max=1.0))
    3
    """
    from ..errors import check_type
    from ..inputs.names import check_names
    from ..motion.solve import Motion
    from .kinds import KINDS

    check_type("motion", motion, Motion)
    check_type("kind", kind, str)
    check_names("kind", [kind], KINDS)
    drawn: list[Axes] = globals()[f"draw_{kind}"](motion, ax, **options)
    return drawn


def _drawn(
    name: str,
    motion: Motion,
    ax: Places,
    *,
    t_max: float | None = None,
    dark: bool = False,
    **wanted: Any,
) -> list[Axes]:
    """Draw a kind of picture on the given axes, or on new ones, and return the axes."""
    from .files import require_matplotlib

    require_matplotlib()
    from matplotlib.axes import Axes

    from ..errors import LagtopError
    from .curves import checked_span
    from .kinds import KINDS, PlotRequest
    from .style import chosen_look, points

    kind, request = KINDS[name], PlotRequest(t_max=checked_span(motion, t_max), **wanted)
    if ax is None:
        from matplotlib import pyplot

        places = pyplot.subplots(kind.axes, sharex=True, squeeze=False, layout="constrained")[1]
        axes = list(places.flat)
    else:
        axes = [ax] if isinstance(ax, Axes) else list(ax)
    if len(axes) != kind.axes:
        raise LagtopError(f"ax must be {kind.axes} axes, got {len(axes)}", "ax")
    drawing = kind.drawing(motion, request)
    used = len(drawing.heights)
    drawing.draw(axes[:used], chosen_look(dark))
    axes[0].set_title(drawing.title, pad=points(18))  # above names at the top of the axes
    for empty in axes[used:]:
        empty.set_axis_off()
    return axes
