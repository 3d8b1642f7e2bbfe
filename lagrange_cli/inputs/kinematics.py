"""Section 4 b, kinematics: rates of the Euler angles and angular velocity, each from the other.

Both take numbers or arrays that broadcast, angles in radians.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.types import Array
from ..errors import LagtopError


class BodyRates(NamedTuple):
    """The angular velocity along body x, y and z."""

    p: Array
    q: Array
    r: Array


class EulerRates(NamedTuple):
    """The rates of tilt, spin and precession."""

    thetadot: Array
    phidot: Array
    psidot: Array


def body_rates(
    theta: ArrayLike, phi: ArrayLike, *, thetadot: ArrayLike, phidot: ArrayLike, psidot: ArrayLike
) -> BodyRates:
    """Return p, q, r of a top at a tilt and a spin angle, from the rates of its angles (4,1).

    Raises LagtopError for what is not real numbers that broadcast.
    """
    tilt, spin, nutation, own, precession = _together(
        theta=theta, phi=phi, thetadot=thetadot, phidot=phidot, psidot=psidot
    )
    sin, cos, around = np.sin(spin), np.cos(spin), precession * np.sin(tilt)
    return BodyRates(
        p=around * sin + nutation * cos,
        q=around * cos - nutation * sin,
        r=precession * np.cos(tilt) + own,
    )


def euler_rates(
    theta: ArrayLike, phi: ArrayLike, *, p: ArrayLike, q: ArrayLike, r: ArrayLike
) -> EulerRates:
    """Return the rates of the angles from p, q, r at a tilt and a spin angle: (4,1) solved.

    Raises LagtopError for what is not real numbers that broadcast, and for a vertical axis, where
    spin and precession have no rates of their own.
    """
    tilt, spin, x, y, z = _together(theta=theta, phi=phi, p=p, q=q, r=r)
    sin, cos, sine = np.sin(spin), np.cos(spin), np.sin(tilt)
    vertical = (sine == 0) | (abs(tilt) == np.pi)
    if vertical.any():
        raise LagtopError(
            "theta must be off the vertical, where spin and precession have rates of their own, "
            f"got {tilt[vertical].flat[0]}",
            "theta",
        )
    precession = (x * sin + y * cos) / sine
    return EulerRates(x * cos - y * sin, z - precession * np.cos(tilt), precession)


def _together(**values: ArrayLike) -> list[Array]:
    """Return the arguments as arrays of doubles of one shape."""
    try:
        arrays = [np.asarray(value) for value in values.values()]
        if any(x.size and x.dtype.kind not in "iuf" for x in arrays):
            raise TypeError
        return [x.astype(np.float64) for x in np.broadcast_arrays(*arrays)]
    except (TypeError, ValueError):
        shown = ", ".join(f"{name} {repr(value)[:30]}" for name, value in values.items())
        raise LagtopError(f"numbers that broadcast must be given, got {shown}") from None
