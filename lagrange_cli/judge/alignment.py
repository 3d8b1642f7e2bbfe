"""Frames and clocks of others, brought to ours: `--align`."""

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

AXES = ("x", "y", "z", "-x", "-y", "-z")
WORDS = {
    "axis=y": "the figure axis is the body's y axis (or x, -x, -y, -z)",
    "up=y": "up is the y axis of space (or x, -x, -y, -z)",
    "start": "spin and precession count from the first row",
    "body": "one rotation of the body's frame, taken from the first row",
    "space": "one rotation of the frame of space, taken from the first row",
    "time": "the first row is at the time 0",
}
"""The words that can be given, with their meanings."""
_NEAR_POLE = 1e-9


class Alignment(NamedTuple):
    """What is done to a trajectory before it is judged."""

    axis: str = "z"
    up: str = "z"
    start: bool = False
    body: bool = False
    space: bool = False
    time: bool = False

    @property
    def hides_frames(self) -> bool:
        """Whether the first row is brought to the exact attitude, whatever it is."""
        return self.body or self.space


def alignment(words: Sequence[str]) -> Alignment:
    """Return the alignment of some words.  Raises LagtopError for one that is not known."""
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


class Frames(NamedTuple):
    """Constant rotations and shifts that bring a trajectory to our frames."""

    space: Array
    body: Array
    time: float = 0.0
    phi: float = 0.0
    psi: float = 0.0

    def aligned(self, seen: Seen) -> Seen:
        """Return the trajectory in our frames."""
        shifts = {"phi": self.phi, "psi": self.psi}
        angles = {key: value - shifts.get(key, 0.0) for key, value in seen.angles.items()}
        turned = seen.turned(self.space, self.body)
        return replace(turned, t=seen.t - self.time, angles=angles)


def frames_of(alignment: Alignment, motion: Motion, first: Seen) -> Frames:
    """Return the frames of a trajectory from its first row.

    Raises LagtopError where what is given of the attitude does not have the frames.
    """
    if first.quaternion is None:
        _check(alignment, first)
    frames = Frames(
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
    wanted = np.array([exact[f"quaternion_{part}"][0] for part in "wxyz"])
    given = seen.quaternion[0] / np.linalg.norm(seen.quaternion[0])
    if alignment.body:
        turn = rotations.product(rotations.conjugate(wanted), given)
        return frames._replace(body=rotations.product(turn, frames.body))
    turn = rotations.product(wanted, rotations.conjugate(given))
    return frames._replace(space=rotations.product(turn, frames.space))


def _check(alignment: Alignment, first: Seen) -> None:
    lacks_space = first.axis is None and first.space_rates is None
    if alignment.hides_frames or alignment.axis != "z" or (alignment.up != "z" and lacks_space):
        raise LagtopError("align needs the whole attitude for axis, up, body and space", "align")


def _counted_from(frames: Frames, seen: Seen, exact: dict[str, float]) -> Frames:
    """Return the frames turned about the vertical and about the figure axis to fit a row."""
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
