"""The picture `remainders`: spin and precession less their mean growth."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import SubFigure

from ..arithmetic.types import Array
from ..errors import NothingToDrawError
from ..motion.regime import Regime
from ..motion.solve import Motion
from .angles import finish_time_axes
from .curves import phase_times, refined, span
from .motion_facts import nutation_period
from .request import PlotRequest
from .style import Look, head, points

TITLE = "Spin and precession less their mean growth, (6,4), (7,4)"


class Remainders(NamedTuple):
    """Periodic parts (radians) of spin (6,4) and precession (7,4) over time."""

    t: Array
    spin: Array
    precession: Array


def remainder_curves(motion: Motion, t_max: float) -> Remainders:
    """Return the periodic parts from 0 to t_max.

    Raises NothingToDrawError where the tilt has no period, so that both are 0 or undefined.
    """
    if nutation_period(motion) is None or motion.mean_precession_rate is None:
        reason = "never comes back" if motion.regime is Regime.SEPARATRIX else "stays as it is"
        raise NothingToDrawError(f"no remainders: the tilt {reason} ({motion.regime.value})")

    def remainders(t: Array) -> Array:
        waves = motion.table(t, ["dphi", "dpsi"])
        return np.stack([waves["dphi"], waves["dpsi"]], axis=1)

    t = refined(phase_times(motion, t_max), remainders)
    return Remainders(t, *remainders(t).T)


def draw(panel: SubFigure, motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw what is left of spin and precession when their mean growth is taken off."""
    curves = _wanted_curves(motion, request)  # before the axes: an empty picture has none
    axes = panel.subplots(2, sharex=True)
    head(panel, TITLE)
    _draw_curves(axes, curves, motion, request, look)
    panel.align_ylabels(axes)


def draw_on(places: Sequence[Axes], motion: Motion, request: PlotRequest, look: Look) -> None:
    """Draw the picture on two axes, which share the time."""
    curves = _wanted_curves(motion, request)
    places[0].set_title(TITLE)
    _draw_curves(places, curves, motion, request, look)


def _wanted_curves(motion: Motion, request: PlotRequest) -> Remainders:
    return remainder_curves(motion, request.t_max or span(motion, 2))


def _draw_curves(
    axes: Sequence[Axes], curves: Remainders, motion: Motion, request: PlotRequest, look: Look
) -> None:
    rows = ("Δφ", curves.spin), ("Δψ", curves.precession)
    for ax, (symbol, remainder), colour in zip(axes, rows, look.lines[1:], strict=True):
        ax.axhline(0.0, color=look.quiet, lw=points(0.9))
        ax.plot(curves.t, remainder * request.per_radian, color=colour)
        ax.set_ylabel(f"{symbol} ({request.angle_unit})")
    finish_time_axes(axes, motion, curves.t, request)
