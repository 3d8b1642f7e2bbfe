"""The options of a reading: how `fit` and `compare` understand a file or arrays."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple, TypedDict

import numpy as np

from ..arithmetic.text import quoted
from ..errors import LagtopError, arg
from ..top.inputs import checked_double
from ..top.units import DEGREES, Units

OPTION_OF = {"quaternion": "quaternion_order", "euler": "euler_sequence", "rates": "rates_frame"}
"""The option for the convention of a quantity."""


class Alignment(NamedTuple):
    """Changes of a recording before it is used."""

    axis: str = "z"
    up: str = "z"
    left: bool = False
    """Both frames are left-handed; the figure axis is then the axis of `up`, unless given."""
    conjugate: bool = False
    """The attitude is given from space to body."""
    start: bool = False
    """Spin and precession are 0 in the first row (compare only)."""
    time: bool = False
    """The first row is at time 0."""

    @classmethod
    def of(cls, words: str | Sequence[str]) -> Alignment:
        """Return the alignment of some words, or of a text in which commas separate them.

        Raises LagtopError for an unknown word.
        """
        found: dict[str, Any] = {}
        for word in filter(None, words.split(",")) if isinstance(words, str) else words:
            if not re.fullmatch("(axis|up)=-?[xyz]|left|conjugate|start|time", str(word).strip()):
                wanted = "one of axis=y, up=y, left, conjugate, start, time"
                raise LagtopError(f"align must be {wanted}, got {quoted(word)}", "align")
            key, _, axis = str(word).strip().partition("=")
            found[key] = axis or True
        if "left" in found:
            found.setdefault("axis", found.get("up", "z"))
        return cls(**found)

    def __str__(self) -> str:
        words = [f"axis={self.axis}"] * self.has_axis + [f"up={self.up}"] * (self.up != "z")
        words += [x for x in self._fields[2:] if getattr(self, x)]
        return ",".join(words) or "up=z"

    @property
    def frame(self) -> tuple[str, str, bool, bool]:
        """The frames of the attitude."""
        return self[:4]

    @property
    def has_axis(self) -> bool:
        """Whether the figure axis is another one than usual in such a frame."""
        return self.axis != (self.up if self.left else "z")


class Reading(NamedTuple):
    """How a recording is read: the options of `fit` and `compare`, on the command line too."""

    columns: Sequence[str] | None = None
    """The names of all columns of a file from the left."""
    quaternion_order: str = "wxyz"
    euler_sequence: str = "xyz"
    """Axes in SciPy's notation: lower case for space, upper case for the body."""
    rates_frame: str = "body"
    """Frame of the angular velocity, `body` or `space`."""
    align: Alignment = Alignment()
    decimal: str = ""
    """The decimal mark of a file, empty if its first rows decide."""
    dt: float | None = None
    """The time between two rows, or between two frames if the times count them."""
    t_min: float = -np.inf
    t_max: float = np.inf
    """The first and the last time, as the file counts them."""
    units: Units = DEGREES
    """The units of angles whose columns have none."""

    @classmethod
    def of(
        cls, *, align: str | Sequence[str] = (), fps: float | None = None, **given: Any
    ) -> Reading:
        """Return the options after checks; `fps` is 1/dt.  Raises LagtopError for a bad one."""
        found = cls(align=Alignment.of(align), **given)
        if fps is not None:
            if found.dt is not None:
                raise LagtopError(f"fps cannot be used with {arg('dt')}: give one", "fps")
            found = found._replace(dt=1 / _positive("fps", fps))
        elif found.dt is not None:
            _positive("dt", found.dt)
        axes = r"(?!.*(.)\1)([xyz]{3}|[XYZ]{3})"  # neighbours differ
        for key, pattern, wanted in (
            ("quaternion_order", "wxyz|xyzw", "wxyz or xyzw"),
            ("rates_frame", "body|space", "body or space"),
            ("euler_sequence", axes, "three axes, such as xyz (space) or XYZ (body)"),
        ):
            if not re.fullmatch(pattern, str(got := getattr(found, key))):
                raise LagtopError(f"{key} must be {wanted}, got {quoted(got)}", key)
        if not checked_double("t_min", found.t_min) < checked_double("t_max", found.t_max):
            ends = f"{found.t_min:g} and {found.t_max:g}"
            raise LagtopError(f"t_min must be < {arg('t_max')}, got {ends}", "t_min")
        return found


class Options(TypedDict, total=False):
    """The options of `fit` and `compare` in Python, where angles are in radians."""

    quaternion_order: str
    euler_sequence: str
    rates_frame: str
    align: str | Sequence[str]
    dt: float | None
    fps: float | None
    t_min: float
    t_max: float


def _positive(name: str, value: Any) -> float:
    """Return a number > 0.  Raises LagtopError."""
    if not 0 < (number := checked_double(name, value)) < np.inf:
        raise LagtopError(f"{name} must be > 0, got {number:g}", name)
    return number
