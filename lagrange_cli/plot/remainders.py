"""The picture `remainders`: the periodic parts of spin and precession."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes

from ..errors import NothingToDrawError
from ..motion.regime import Regime
from ..motion.solve import Motion
from .angles import finish_time_axes
from .curves import sampled_columns, span
from .kinds import Drawing
from .motion_facts import tilt_period
from .request import PlotRequest
from .style import Look, points


def drawing(motion: Motion, request: PlotRequest) -> Drawing:
    """Compute the periodic parts of spin (6,4) and precession (7,4).

    Raises NothingToDrawError if the tilt has no period, so that both are 0 or undefined.
    """
    if tilt_period(motion) is None or motion.mean_precession_rate is None:
        reason = "never comes back" if motion.regime is Regime.SEPARATRIX else "stays as it is"
        raise NothingToDrawError(f"no remainders: the tilt {reason} ({motion.regime.value})")
    t, *parts = sampled_columns(motion, request.t_max or span(motion, 2), ["dphi", "dpsi"]).values()

    def draw(axes: Sequence[Axes], look: Look) -> None:
        """Draw each periodic part about 0."""
        for ax, symbol, part, colour in zip(axes, "φψ", parts, look.lines[1:], strict=True):
            ax.axhline(0.0, color=look.quiet, lw=points(0.9))
            ax.plot(t, part * request.per_radian, color=colour)
            ax.set_ylabel(f"Δ{symbol} ({request.angle_unit})")
        finish_time_axes(axes, motion, t, request)

    return Drawing("Periodic parts of spin and precession, (6,4), (7,4)", draw, (1.0, 1.0))
