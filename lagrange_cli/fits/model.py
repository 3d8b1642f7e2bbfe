"""The angles of a top at the times of a recording, their derivatives, and residuals.

The constants a and b and the initial state determine a motion.  The body has A = C = 1, so that its
spin rate is b.  The spin of a body with another rate r0 is phi + (r0 - b) t, as phi' = r0 - psi'
cos(theta) (4,8).  Directions of the axis are compared in the tangent plane of the sphere, along the
meridian and across it.  The attitude also has the rotation about the axis.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.names import ANGLES
from ..inputs.rotations import within_half_turn
from ..inputs.top import Top
from ..motion.regime import exact
from ..motion.sensitivity.angle_sensitivities import AngleDerivatives
from ..motion.sensitivity.neighbourhood import PARAMETERS
from ..sweeps.angles import sweep_angles
from .recording import Recording

MEANINGS = {
    "a": "2mgs/A (4,4)",
    "b": "C r0/A (4,5)",
    "b/a": "C r0/2mgs, by the elementary theory",
    "r0": "total spin rate",
    "theta0": "tilt in the first row",
    "thetadot0": "nutation rate in the first row",
    "psidot0": "precession rate in the first row",
    "psi_zero": "psi of the data in the first row",
    "phi_zero": "phi of the data in the first row",
}
_DEVIATIONS = 3.0
"""Bound of the autocorrelation of noise, in standard deviations 1/sqrt(n)."""
_ROUNDING = 1e-11
"""Residuals of data without noise, in radians."""
_BEYOND = 0.00135
"""Probability beyond each bound of chi^2, as for three standard deviations."""
STATE = ("a", "b", "theta0", "thetadot0", "psidot0")
"""The state of a motion: the constants (4,4) and (4,5), and the start in radians."""


def motion_angles(states: Array, t: Array) -> Array:
    """Return theta, phi and psi, shape (3, tops, times).

    `states` are of shape (tops, 5), in the order of STATE; `t` is one row of times for all tops, or
    a row for each.  Raises LagtopError for an invalid state.
    """
    found = sweep_angles(t, **inputs_of(*states.T))
    if wrong := [error for error in found["error"] if error]:
        raise LagtopError(str(wrong[0]))
    return np.stack([found[name] for name in ANGLES])


def angles_and_slopes(state: Array, t: Array) -> tuple[Array, Array]:
    """Return the angles of a top at times, and their exact derivatives by its state.

    Angles are of shape (3, times), derivatives of shape (3, times, 5); derivatives that do not
    exist are NaN.  Raises LagtopError for an invalid state.
    """
    top = Top(**inputs_of(*state.tolist()))
    with ARRAYS.working():
        angles, partials = AngleDerivatives(exact(top)).at(t)
    by = dict(zip(PARAMETERS, np.moveaxis(partials, 1, 0), strict=True))
    slopes = [by["a"], by["b"] + by["r0"], by["tilt"], by["theta_rate"], by["psi_rate"]]
    return angles, np.stack(slopes, axis=-1)


def inputs_of(a: Any, b: Any, theta: Any, nutation: Any, precession: Any) -> dict[str, Any]:
    """Return the inputs of `Top` for one state, or for many."""
    start = {"theta0_rad": theta, "thetadot0": nutation, "psidot0": precession}
    return {"m": 1.0, "A": 1.0, "C": 1.0, "s": 1.0, "g": a / 2, "r0": b, **start}


class Residuals(NamedTuple):
    """Differences by channel, recording minus motion, in radians; NaN if a cell is missing."""

    values: Array
    """Shape (channels, times)."""
    slopes: Array
    """Derivatives by theta, phi and psi of the motion, shape (channels, times, 3)."""


def residuals(recording: Recording, angles: Array) -> Residuals:
    """Return the residuals: a recording minus the angles of a motion, shape (3, times)."""
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
    """Return the residuals of angles that have columns of their own."""
    values, slopes = [], []
    for channel in recording.channels:
        i = ANGLES.index(channel)
        left = recording.angles[channel] - angles[i]
        values.append(left if channel == "theta" else within_half_turn(left))
        slope = np.zeros((left.size, 3))
        slope[:, i] = -1.0
        slopes.append(slope)
    return Residuals(np.stack(values), np.stack(slopes))


class Residual(NamedTuple):
    """The residuals of one channel."""

    rows: int
    rms: float
    """Root of the mean square, in radians."""
    lag1: float
    """Correlation of each residual with the next one."""

    @property
    def is_noise(self) -> bool:
        """Whether the correlation is within three standard deviations of 0, or due to rounding."""
        return self.rms < _ROUNDING or abs(self.lag1) <= _DEVIATIONS / math.sqrt(max(self.rows, 1))


def residual_of(values: Array) -> Residual:
    """Return the size and the correlation of the residuals of one channel; NaN is missing."""
    known = values[np.isfinite(values)]
    total = float(np.sum(known * known))
    if not total:
        return Residual(known.size, 0.0, 0.0)
    return Residual(
        known.size, math.sqrt(total / known.size), float(np.sum(known[1:] * known[:-1])) / total
    )


def chi2_bounds(dof: int) -> tuple[float, float]:
    """Return the bounds that chi^2/dof exceeds by chance once in 370 times."""
    from scipy.special import gammaincinv

    half = dof / 2
    low, high = (float(gammaincinv(half, p)) / half for p in (_BEYOND, 1 - _BEYOND))
    return low, high
