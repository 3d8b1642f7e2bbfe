"""A request for pictures: everything that was asked for beside the kinds of picture."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeVar

if TYPE_CHECKING:
    from ..arithmetic.types import Array

P = TypeVar("P")


class Progress(Protocol):
    """A function that hands on the parts of some long work and may show how far it is."""

    def __call__(self, parts: Iterable[P], count: int, /) -> Iterable[P]:
        """Yield the parts as they are computed; `count` is the size of the whole work."""


def no_progress(parts: Iterable[P], count: int, /) -> Iterable[P]:
    """Return the parts as they are and show nothing."""
    return parts


class InputRange(NamedTuple):
    """An input of the top and the values it takes along one axis of a map."""

    name: str
    values: Array
    """Increasing values; a tilt in degrees."""
    logarithmic: bool = False
    """Whether the values grow by equal factors and not by equal steps."""


class PlotRequest(NamedTuple):
    """What a picture of a motion should show."""

    t_max: float | None = None
    """Last time of the pictures over time; by default each picture takes what suits it."""
    radians: bool = False
    """Whether angles are shown in radians and not in degrees."""
    key: str = "mean_precession_rate"
    """Key of the record that a map shows."""
    x: InputRange | None = None
    """Horizontal axis of a map; by default the spin."""
    y: InputRange | None = None
    """Vertical axis of a map; by default the tilt."""
    unit: Callable[[str], str] = str
    """Names a unit such as `rad/time` in the units of the inputs."""
    progress: Progress = no_progress
    """What may show the progress of a map."""

    def label(self, text: str) -> str:
        """Return a label whose unit stands between brackets, in the units of the inputs."""
        return re.sub(r"\((.*?)\)", lambda inside: f"({self.unit(inside[1])})", text)

    @property
    def angle_unit(self) -> str:
        """The name of the unit of angles, as it stands on an axis."""
        return "rad" if self.radians else "deg"

    @property
    def per_radian(self) -> float:
        """The size of one radian in the unit of angles."""
        return 1.0 if self.radians else 180 / math.pi
