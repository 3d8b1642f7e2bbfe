"""Pictures of motions: files, films, a page for the browser, and drawings on your own axes.

matplotlib and NumPy are imported when a function is called, because help does not need them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..motion.solve import Motion

KINDS = "sphere", "angles", "cubic", "phase", "map"
"""The kinds of picture."""
SHEET = "all"
"""The name of the sheet, which holds sphere, angles, cubic and phase."""


def draw(
    motion: Motion,
    kind: str = "sphere",
    ax: Axes | Sequence[Axes] | None = None,
    *,
    t_max: float | None = None,
    radians: bool = False,
    dark: bool = False,
    key: str | None = None,
    x: tuple[str, Any] | None = None,
    y: tuple[str, Any] | None = None,
) -> list[Axes]:
    """Draw a kind of picture on axes, or on those of a new figure, and return the axes.

    `ax` is one Axes, or three for `angles`.  `t_max` is the last time.  A `map` shows a `key` of
    the record over `x` and `y`, each a pair of an input and an array of its values.

    Raises LagtopError for an unknown kind, a time out of range, or if there is nothing to draw, and
    UnavailableError without matplotlib.

    >>> len(draw(solve(Top()), "angles", t_max=1.0))
    3
    """
    from ..errors import LagtopError, check_type  # start-up
    from ..inputs.names import check_names  # start-up
    from ..motion.solve import Motion  # start-up
    from .style import DARK, LIGHT, require_matplotlib  # start-up

    check_type("motion", motion, Motion)
    check_type("kind", kind, str)
    check_names("kind", [kind], KINDS)
    if kind != "map" and (key or x or y):
        raise LagtopError(f"key, x and y need the kind map, got {kind}")
    require_matplotlib()
    import numpy as np
    from matplotlib import pyplot
    from matplotlib.axes import Axes

    from .curves import checked_span
    from .map import checked_axis
    from .options import MapOptions, Options
    from .pictures import PICTURES

    picture, axes = PICTURES[kind], [ax] if isinstance(ax, Axes) else list(ax or [])
    if ax is None:
        grid = pyplot.subplots(picture.axes, sharex=True, squeeze=False, layout="constrained")[1]
        axes = list(grid.flat)
    if len(axes) != picture.axes:
        raise LagtopError(f"ax must be {picture.axes} axes, got {len(axes)}", "ax")
    ends = [
        pair and checked_axis(name, pair[0], np.asarray(pair[1], float))
        for name, pair in (("x", x), ("y", y))
    ]
    chart = MapOptions(key or MapOptions().key, ends[0], ends[1])
    span = checked_span(motion, t_max)
    options = Options(span, radians, look=DARK if dark else LIGHT, map=chart)
    axes[0].set_title(picture.draw(motion, axes, options), pad=18)
    return axes
