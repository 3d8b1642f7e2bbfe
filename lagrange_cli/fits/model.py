"""The angles of a top at the times of a recording, and their derivatives by its constants.

A motion is told by a, b and its start; the body is that of A = C = 1, so that its spin rate is b.
The spin of a body with another rate r0 is phi + (r0 - b) t, as phi' = r0 - psi' cos(theta) (4,8).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.names import ANGLES
from ..inputs.top import Top
from ..motion.regime import exact
from ..motion.sensitivity.angle_sensitivities import AngleDerivatives
from ..motion.sensitivity.neighbourhood import PARAMETERS
from ..sweeps.angles import sweep_angles

STATE = ("a", "b", "theta0", "thetadot0", "psidot0")
"""What tells a motion: constants (4,4) and (4,5), and the start in radians."""
_NEAREST = 1e-9
"""Least distance of a start from the vertical, where psi has no meaning."""


def angles_of(states: Array, t: Array) -> Array:
    """Return theta, phi and psi, shape (3, tops, times).

    `states` are of shape (tops, 5), in the order of STATE; `t` is one row of times for all, or a
    row for each.  Raises LagtopError where a state is no top.
    """
    found = sweep_angles(t, **_inputs(*states.T))
    if wrong := [error for error in found["error"] if error]:
        raise LagtopError(str(wrong[0]))
    return np.stack([found[name] for name in ANGLES])


def angles_and_slopes(state: Array, t: Array) -> tuple[Array, Array]:
    """Return the angles of a top at times, and their exact derivatives by its state.

    Angles are of shape (3, times), derivatives of shape (3, times, 5); those that do not exist are
    NaN.  Raises LagtopError where the state is no top.
    """
    top = Top(**_inputs(*state.tolist()))
    with ARRAYS.working():
        angles, partials = AngleDerivatives(exact(top)).at(t)
    by = dict(zip(PARAMETERS, np.moveaxis(partials, 1, 0), strict=True))
    slopes = [by["a"], by["b"] + by["r0"], by["tilt"], by["theta_rate"], by["psi_rate"]]
    return angles, np.stack(slopes, axis=-1)


def _inputs(a: Any, b: Any, theta: Any, nutation: Any, precession: Any) -> dict[str, Any]:
    """Return the inputs of `Top` of a state, or of many."""
    start = {"theta0_rad": theta, "thetadot0": nutation, "psidot0": precession}
    return {"m": 1.0, "A": 1.0, "C": 1.0, "s": 1.0, "g": a / 2, "r0": b, **start}


def kept_off_the_vertical(theta: float) -> float:
    """Return a tilt that is neither upright nor hanging."""
    return float(np.clip(theta, _NEAREST, np.pi - _NEAREST))
