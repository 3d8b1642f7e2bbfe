"""Pictures of motions: files, films, a page for the browser, and drawings on your own axes.

matplotlib and NumPy are imported when a function is called, because help does not need them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from .style import DARK, LIGHT, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..inverse.outcome import Outcome
    from ..solver.solve import Motion

KINDS = {
    "sphere": "the path of the figure axis on the unit sphere, coloured by time",
    "angles": "tilt, precession, and the periodic part of the spin",
    "cubic": "f(u), its roots, and the band of the motion",
    "phase": "nutation rate against tilt, and the separatrix",
    "map": "a key of the record over two inputs",
}
"""The kinds of picture, and what each shows."""
SHEET = {"all": ("sphere", "angles", "cubic", "phase")}
"""The name and the kinds of the sheet."""
CAPTION = "r0", "T_nutation", "mean_precession_rate"
"""The keys below the picture of one scene."""


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
    """Draw a kind of picture on axes, or on a new figure, and return the axes.

    `ax` is one Axes, or three for `angles`.  `t_max` is the last time.  A `map` shows a `key` of
    the record over `x` and `y`, each a pair of an input and an array of its values.

    Raises LagtopError for an unknown kind, a time out of range, or if there is nothing to draw, and
    UnavailableError without matplotlib.

    >>> len(draw(solve(Top()), "angles", t_max=1.0))
    3
    """
    from ..errors import LagtopError, check_type  # start-up
    from ..names import check_names  # start-up
    from ..solver.solve import Motion  # start-up
    from ..top.units import Units  # start-up

    check_type("motion", motion, Motion)
    check_type("kind", kind, str)
    check_names("kind", [kind], KINDS)
    if kind != "map" and (key or x or y):
        raise LagtopError(f"key, x and y need the kind map, got {kind}")
    require_matplotlib()
    from matplotlib.axes import Axes

    from .pictures import PICTURES, Options, add_time_bar

    picture, count, _ = PICTURES[kind]
    if ax is None:
        ax = list(new_figure().subplots(count, sharex=True, squeeze=False).flat)
    axes = [ax] if isinstance(ax, Axes) else list(ax)
    if len(axes) != count:
        raise LagtopError(f"ax must be {count} axes, got {len(axes)}", "ax")
    look = DARK if dark else LIGHT
    options = Options(t_max, Units(radians), look=look, key=key, x=x, y=y)
    axes[0].set_title(picture(motion, axes, options), pad=18)
    if kind == "sphere":
        add_time_bar(axes, options.time_label)
    return axes


def draw_outcome(outcome: Outcome, figure: Figure | None = None) -> Figure:
    """Draw data, motion and residuals of a fit, on a figure or a new one, and return the figure.

    Angles are in degrees, or in radians if the fit has them.  Raises UnavailableError without
    matplotlib.

    >>> t = np.linspace(0, 2, 100)
    >>> theta, phi, psi = solve(Top()).angles(t)
    >>> len(draw_outcome(fit(t, theta=theta, psi=psi)).axes)
    4
    """
    figure = figure or new_figure()
    from .reports import draw_fit

    return draw_fit(outcome, figure)


def new_figure() -> Figure:
    """Return a new figure of pyplot, which a notebook shows.  Raises UnavailableError."""
    require_matplotlib()
    from matplotlib import pyplot

    return pyplot.figure(layout="constrained")
