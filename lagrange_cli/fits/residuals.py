"""What is left of a recording when a motion is taken from it, and how that changes with the motion.

The direction of the axis is compared in the plane that touches the sphere at the direction of the
motion: along its meridian and across it.  The attitude has the turn about the axis too.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..inputs.names import ANGLES
from ..inputs.rotations import within_half_turn
from .recording import Recording


class Residuals(NamedTuple):
    """Differences by channel, recording less motion, in radians; NaN where a cell is missing."""

    values: Array
    """Shape (channels, times)."""
    slopes: Array
    """Derivatives by theta, phi and psi of the motion, shape (channels, times, 3)."""


def residuals(recording: Recording, angles: Array) -> Residuals:
    """Return what is left when angles of a motion, shape (3, times), are taken from a recording."""
    if recording.kind == "angles":
        return _of_angles(recording, angles)
    theta, phi, psi = angles
    seen, turned = recording.angles["theta"], recording.angles["psi"] - psi
    sine, cosine = np.sin(seen), np.cos(seen)
    sine_m, cosine_m = np.sin(theta), np.cos(theta)
    values = [
        sine * cosine_m * np.cos(turned) - cosine * sine_m,
        sine * np.sin(turned),
    ]
    none = np.zeros_like(theta)
    slopes = [
        [
            -sine * sine_m * np.cos(turned) - cosine * cosine_m,
            none,
            sine * cosine_m * np.sin(turned),
        ],
        [none, none, -sine * np.cos(turned)],
    ]
    if recording.kind == "attitude":
        across = within_half_turn(turned)
        values.append(within_half_turn(recording.angles["phi"] - phi + across * cosine_m))
        slopes.append([-across * sine_m, none - 1, -cosine_m])
    return Residuals(np.stack(values), np.moveaxis(np.array(slopes), 1, -1))


def _of_angles(recording: Recording, angles: Array) -> Residuals:
    """Return what is left of angles that have columns of their own."""
    values, slopes = [], []
    for channel in recording.channels:
        i = ANGLES.index(channel)
        left = recording.angles[channel] - angles[i]
        values.append(left if channel == "theta" else within_half_turn(left))
        slope = np.zeros((left.size, 3))
        slope[:, i] = -1.0
        slopes.append(slope)
    return Residuals(np.stack(values), np.stack(slopes))
