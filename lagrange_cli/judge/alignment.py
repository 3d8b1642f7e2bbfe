"""Conversion of other frames and clocks to those of lagtop: `--align`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..arithmetic.text import quoted
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs import rotations
from ..inputs.names import ANGLES
from ..inputs.seen import Seen
from ..motion.solve import Motion
from .deviations import quaternion_of

AXES = ("x", "y", "z", "-x", "-y", "-z")
WORDS = {
    "axis=y": "the figure axis is the body's y axis (or x, -x, -y, -z)",
    "up=y": "up is the y axis of space (or x, -x, -y, -z)",
    "start": "spin and precession are 0 in the first row",
    "body": "a constant rotation of the body's frame, taken from the first row",
    "space": "a constant rotation of the frame of space, taken from the first row",
    "time": "the first row is at time 0",
}
"""The words of `--align`, with their meanings."""
_NEAR_POLE = 1e-9


class Alignment(NamedTuple):
    """Changes of a trajectory before it is compared."""

    axis: str = "z"
    up: str = "z"
    start: bool = False
    body: bool = False
    space: bool = False
    time: bool = False

    @property
    def hides_frames(self) -> bool:
        """Whether the first row is always rotated to the exact attitude."""
        return self.body or self.space


def alignment(words: Sequence[str]) -> Alignment:
    """Return the alignment of some words.  Raises LagtopError for an unknown word."""
    if isinstance(words, str):
        raise LagtopError(f"align must be a list of words, got {quoted(words)}", "align")
    found: dict[str, str | bool] = {}
    for word in words:
        key, is_axis, axis = str(word).partition("=")
        known = axis in AXES if is_axis else key in {"start", "body", "space", "time"}
        if not known or (is_axis and key not in {"axis", "up"}):
            raise LagtopError(
                f"align must be among {', '.join(WORDS)}, got {quoted(word)}", "align"
            )
        found[key] = axis if is_axis else True
    chosen = Alignment(**found)  # type: ignore[arg-type]
    if chosen.start + chosen.body + chosen.space > 1:
        raise LagtopError("align takes one of start, body and space, not two of them", "align")
    return chosen


class FrameChange(NamedTuple):
    """Constant rotations and shifts that convert a trajectory to the frames of lagtop."""

    space: Array
    body: Array
    time: float = 0.0
    phi: float = 0.0
    psi: float = 0.0

    def aligned(self, seen: Seen) -> Seen:
        """Return the trajectory in the frames of lagtop."""
        shifts = {"phi": self.phi, "psi": self.psi}
        angles = {key: value - shifts.get(key, 0.0) for key, value in seen.angles.items()}
        turned = seen.turned(self.space, self.body)
        return replace(turned, t=seen.t - self.time, angles=angles)


def frames_of(alignment: Alignment, motion: Motion, first: Seen) -> FrameChange:
    """Return the frames of a trajectory from its first row.

    Raises LagtopError if the attitude is not complete enough for the alignment.
    """
    if first.quaternion is None:
        _check(alignment, first)
    frames = FrameChange(
        rotations.to_z(alignment.up),
        rotations.to_z(alignment.axis),
        float(first.t[0]) if alignment.time else 0.0,
    )
    if not (alignment.start or alignment.hides_frames):
        return frames
    seen = frames.aligned(first)
    exact = motion.table(seen.t, [*ANGLES, "quaternion"], wrap=True)
    if alignment.start:
        return _counted_from(frames, seen, {x: float(y[0]) for x, y in exact.items()})
    assert seen.quaternion is not None
    (wanted,) = quaternion_of(exact)
    given = seen.quaternion[0] / np.linalg.norm(seen.quaternion[0])
    if alignment.body:
        turn = rotations.product(rotations.conjugate(wanted), given)
        return frames._replace(body=rotations.product(turn, frames.body))
    turn = rotations.product(wanted, rotations.conjugate(given))
    return frames._replace(space=rotations.product(turn, frames.space))


def _check(alignment: Alignment, first: Seen) -> None:
    words = [x for x in ("body", "space") if getattr(alignment, x)]
    words += [f"axis={alignment.axis}"] if alignment.axis != "z" else []
    if words:
        raise LagtopError(f"align {words[0]} needs the whole attitude: leave it out", "align")
    if alignment.up != "z" and first.axis is None and first.space_rates is None:
        raise LagtopError(
            f"align up={alignment.up} needs the axis or the whole attitude: leave it out", "align"
        )


def _counted_from(frames: FrameChange, seen: Seen, exact: dict[str, float]) -> FrameChange:
    """Return frames rotated about the vertical and about the figure axis to match a row."""
    if seen.quaternion is not None:
        angles = {key: float(x[0]) for key, x in rotations.angles_of(seen.quaternion).items()}
        w, x, y, z = seen.quaternion[0].tolist()
        twice_sum, twice_difference = 2 * math.atan2(z, w), 2 * math.atan2(y, x)
        if exact["theta"] < _NEAR_POLE:
            angles |= {"psi": exact["psi"], "phi": twice_sum - exact["psi"]}
        if exact["theta"] > math.pi - _NEAR_POLE:
            angles |= {"psi": exact["psi"], "phi": exact["psi"] - twice_difference}
    elif seen.axis is not None:
        angles = {"psi": float(rotations.angles_of_axis(seen.axis)["psi"][0])}
    else:
        angles = {key: float(x[0]) for key, x in seen.angles.items()}
    phi, psi = (angles.get(key, exact[key]) - exact[key] for key in ("phi", "psi"))
    return frames._replace(
        space=rotations.product(rotations.about_z(-psi), frames.space),
        body=rotations.product(rotations.about_z(phi), frames.body),
        phi=phi,
        psi=psi,
    )
