"""The motion of a top at the times of a recording: angles, residuals, and derived numbers.

The constants a and b and the initial state determine a motion.  The body has A = C = 1, so that its
spin rate is b.  The spin of a body with another rate r0 is phi + (r0 - b) t, as phi' = r0 - psi'
cos(theta) (4,8).  Directions of the axis are compared in the tangent plane of the sphere, along the
meridian and across it.  The attitude also has the rotation about the axis.

The numbers that follow from a motion, such as periods, mean rates and turning points, have the
exact derivatives of the record.  The elementary formulas of fast tops are added for comparison.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.names import ANGLES
from ..inputs.rotations import within_half_turn
from ..inputs.top import Top
from ..motion.derivatives import AngleDerivatives, sensitivities
from ..motion.record import KEYS, requested_keys
from ..motion.solve import solve
from .angles import sweep_angles
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
_SPIN = "mean_spin_rate"
_STANDS_FOR = {
    "T_nutation_elementary": "T_nutation",
    "precession_rate_elementary": "mean_precession_rate",
}
"""The exact numbers that elementary formulas stand for."""
_DERIVED = [
    *f"T_nutation T_precession mean_precession_rate {_SPIN} theta_min_deg theta_max_deg".split(),
    *("stability_factor", *_STANDS_FOR),
]
"""Keys of the record that are derived."""
_BY = {"a": ("g", 0.5), "b": ("r0", 1.0), "theta0": ("theta0_rad", 1.0)}
"""The inputs of a top with A = C = m = s = 1 that stand for a, b and theta0, and their slopes."""


def motion_angles(states: Array, t: Array) -> Array:
    """Return theta, phi and psi, shape (3, tops, times).

    `states` are of shape (tops, 5), in the order of STATE; `t` is one row of times for all tops, or
    a row for each.  Raises LagtopError for an invalid state.
    """
    angles, errors = sweep_angles(t, inputs_of(*states.T))
    if wrong := [error for error in errors if error]:
        raise LagtopError(str(wrong[0]))
    return angles


def angles_and_slopes(state: Array, t: Array) -> tuple[Array, Array]:
    """Return the angles of a top at times, and their derivatives by its state.

    Angles are of shape (3, times), derivatives of shape (3, times, 5); derivatives that do not
    exist are NaN.  Raises LagtopError for an invalid state.
    """
    inputs = ["g", "r0", "theta0_rad", "thetadot0", "psidot0"]
    motion = solve(Top(**inputs_of(*state.tolist())))
    slopes = np.moveaxis(AngleDerivatives(motion, inputs).at(t), 0, -1)
    return np.array(motion.angles(t)), slopes * [0.5, 1.0, 1.0, 1.0, 1.0]


def as_recorded(angles: Array, values: Mapping[str, Any], t: Array) -> Array:
    """Return angles of a motion, shape (3, times), with the spin rate and zeros of a recording.

    The map is linear: pass derivatives of the angles, and of the values, for those of the result.
    """
    theta, phi, psi = angles
    spin = (values["r0"] - values["b"]) * t
    return np.stack([theta, phi + spin + values["phi_zero"], psi + values["psi_zero"]])


def inputs_of(a: Any, b: Any, theta: Any, nutation: Any, precession: Any) -> dict[str, Any]:
    """Return the inputs of `Top` for one state, or for many."""
    start = {"theta0_rad": theta, "thetadot0": nutation, "psidot0": precession}
    return {"m": 1.0, "A": 1.0, "C": 1.0, "s": 1.0, "g": a / 2, "r0": b, **start}


def std_of(gradient: Array, covariance: Array, others: float = 0.0) -> float:
    """Return the standard deviation of a number from its derivatives by uncertain quantities.

    `others` is a variance that has other causes.
    """
    change = np.where(np.diag(covariance) > 0, gradient, 0.0)
    return math.sqrt(max(float(change @ covariance @ change) + others, 0.0))


class DerivedNumber(NamedTuple):
    """A number that follows from the fitted motion."""

    key: str
    value: float
    std: float
    meaning: str
    exact: str
    """The key of the exact number that an elementary formula approximates, or empty."""
    off: float | None
    """Distance from the exact number, over the standard deviation of this difference."""


def derived_numbers(
    values: Mapping[str, float], covariance: Array, *, spins: bool
) -> Iterator[DerivedNumber]:
    """Yield the numbers that follow from values of a, b and the start, and of r0 if it is known.

    The covariance is in the order of the values.  The result omits keys that the motion
    does not have, and numbers without a derivative by an uncertain value.
    """
    top = Top(**inputs_of(*(values[name] for name in STATE)))
    motion, slopes = solve(top), sensitivities(top, _DERIVED).derivatives
    declared, found = KEYS | requested_keys(), {}
    for key in _DERIVED:
        if key not in slopes or (key == _SPIN and not spins):
            continue
        by = [_BY.get(name, (name, 1.0)) for name in STATE]
        slope = {name: slopes[key][x] * n for name, (x, n) in zip(STATE, by, strict=True)}
        value = float(getattr(motion, key))
        if key == _SPIN:  # the top has r0 = b: the spin of the body grows by (r0 - b) t more
            value += values["r0"] - values["b"]
            slope |= {"r0": 1.0, "b": slope["b"] - 1}
        gradient = np.array([slope.get(name, 0.0) for name in values])
        found[key] = value, gradient
        exact, off, std = _STANDS_FOR.get(key, ""), None, std_of(gradient, covariance)
        if exact in found:
            exact_value, exact_gradient = found[exact]
            spread = std_of(gradient - exact_gradient, covariance)
            off = (value - exact_value) / spread if spread > 0 else None
        if not math.isnan(std):
            yield DerivedNumber(key, value, std, declared[key].meaning, exact, off)


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
    rows = [ANGLES.index(channel) for channel in recording.channels]
    left = [recording.angles[ANGLES[i]] - angles[i] for i in rows]
    values = [within_half_turn(x) if i else x for i, x in zip(rows, left, strict=True)]
    slopes = np.broadcast_to((0 - np.eye(3)[rows])[:, np.newaxis], (len(rows), left[0].size, 3))
    return Residuals(np.stack(values), slopes)


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
