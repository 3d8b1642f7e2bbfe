"""Pictures of motions: files, films, a page for the browser, and drawings on your own axes.

Each function here draws one kind of picture on your own axes, in your own style.  Pass an `Axes` of
matplotlib, or a sequence with as many axes as the kind has; by default a new figure is made.  The
functions raise LagtopError for a time out of range, if there is nothing to draw, and without
matplotlib.

matplotlib and NumPy are imported when a function is called, because help does not need them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypedDict, Unpack

from .kinds import KINDS, PictureKind, PlotRequest
from .style import DARK, LIGHT, points, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..motion.solve import Motion

    AxesOfUser: TypeAlias = Axes | Sequence[Axes] | None


class DrawingOptions(TypedDict, total=False):
    """Options of drawings; each kind has some of them."""

    t_max: float | None
    """The last time."""
    radians: bool
    """Whether angles are in radians instead of degrees."""
    key: str
    """The key that a map shows."""
    x: str | None
    """Horizontal axis of a map, such as `r0=5:120:80`."""
    y: str | None
    """Vertical axis of a map."""
    dark: bool
    """Whether colours are for dark paper."""


def draw(
    motion: Motion,
    kind: str = "sphere",
    ax: AxesOfUser = None,
    **options: Unpack[DrawingOptions],
) -> list[Axes]:
    """Draw the kind of picture with this name, and return the axes.

    Raises LagtopError for an unknown kind, and TypeError for an option that the kind does not have.

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
    shown: dict[str, Any] = {**options}
    dark = shown.pop("dark", False)
    known = DrawingOptions.__annotations__.keys() & picture.options
    if unknown := [name for name in shown if name not in known]:
        raise TypeError(f"draw_{kind}() got an unexpected keyword argument {unknown[0]!r}")
    require_matplotlib()
    from matplotlib.axes import Axes

    from .curves import checked_span  # start-up

    if "key" in picture.options:
        from .map import parse_input_range  # start-up

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

    title = picture.draw(motion, PlotRequest(look=DARK if dark else LIGHT, **shown), places)
    axes[0].set_title(title, pad=points(18))  # above names at the top of the axes
    return axes


class Drawing(Protocol):
    """A function that draws one kind of picture."""

    def __call__(
        self, motion: Motion, ax: AxesOfUser = None, **options: Unpack[DrawingOptions]
    ) -> list[Axes]:
        """Draw the picture, and return the axes."""


def _drawing(kind: PictureKind) -> Drawing:
    """Return the function that draws a kind on axes of the caller."""

    def function(
        motion: Motion, ax: AxesOfUser = None, **options: Unpack[DrawingOptions]
    ) -> list[Axes]:
        return draw(motion, kind.name, ax, **options)

    own = [name for name in DrawingOptions.__annotations__ if name in (*kind.options, "dark")]
    function.__doc__ = f"Draw {kind.help}; options: {', '.join(own)}."
    function.__name__ = function.__qualname__ = f"draw_{kind.name}"
    return function


draw_sphere, draw_angles, draw_remainders, draw_cubic, draw_phase, draw_map = map(
    _drawing, KINDS.values()
)
