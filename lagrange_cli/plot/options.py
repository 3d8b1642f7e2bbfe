"""What a picture shows, and how."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.numbers import angle_unit
from ..arithmetic.types import Array
from ..output.terminal import Progress, silent
from .style import LIGHT, Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Axis(NamedTuple):
    """An input of the top and its values along one axis of a map."""

    name: str
    values: Array
    """Increasing values; a tilt in the unit of angles."""
    logarithmic: bool = False


class MapOptions(NamedTuple):
    """The key and the axes of a map."""

    key: str = "mean_precession_rate"
    x: Axis | None = None
    """Horizontal axis; by default the spin."""
    y: Axis | None = None
    """Vertical axis; by default the tilt."""
    progress: Progress = silent


class Options(NamedTuple):
    """What a picture shows, and how."""

    t_max: float | None = None
    """Last time of the pictures over time; by default each picture chooses its own."""
    radians: bool = False
    """Whether angles are in radians instead of degrees."""
    camera: tuple[float, float] | None = None
    """Azimuth and elevation (radians) of the camera; by default it faces the path."""
    look: Look = LIGHT
    stds: Callable[[Array], Any] | None = None
    """Standard deviations (radians) of tilt, spin and precession at given times: bands."""
    map: MapOptions | None = None
    """The key and the axes of a map."""
    unit: Callable[[str], str] = str
    """Returns the name of a unit such as `rad/time` in the units of the inputs."""

    @property
    def factor(self) -> float:
        """The size of one radian in the unit of angles."""
        return angle_unit(radians=self.radians)[0]

    @property
    def angle(self) -> str:
        """The name of the unit of angles."""
        return angle_unit(radians=self.radians)[1]

    @property
    def time_label(self) -> str:
        """The label of an axis of time."""
        return f"t ({self.unit('time').replace('time', 'input units')})"


def mark_start(ax: Axes, x: Any, y: Any, look: Look, label: str = "start") -> None:
    """Draw a ring with a label at one point."""
    ring: dict[str, Any] = {"mfc": look.paper, "mec": look.ink, "mew": 1.6, "ms": 7, "zorder": 6}
    ax.plot(x, y, "o", ls="none", label=label, **ring)
