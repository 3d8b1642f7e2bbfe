"""The least squares of one recording: known inputs, parameters and weighted residuals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.input_keys import checked_double
from ..inputs.names import check_names
from ..inputs.rotations import within_half_turn
from ..inputs.top import Top
from .motions import STATE, angles
from .recording import Recording
from .starts import Signal

BODY = ("m", "s", "g", "A", "C", "r0")
_NOT_ZERO = ("m", "s", "g", "A", "C", "r0")
_STEP, _SHORT_STEP = 1e-6, 1e-7
"""Steps of central and of forward differences, over the size of a parameter."""
_LEAST_STEP = 1e-3
_POLE = 1e-9
_ALIASES = np.arange(-3, 4)[:, np.newaxis]
"""Turns per frame that may be added to a spin rate."""
_FAR = 1e3
"""Weighted residual of a motion that does not exist."""


class Known(dict[str, float]):
    """Known inputs by key, theta0 in radians, with the standard deviations of uncertain ones."""

    def __init__(
        self, inputs: Mapping[str, float], stds: Mapping[str, float] = MappingProxyType({})
    ) -> None:
        super().__init__(inputs)
        self.stds = dict(stds)


def known_inputs(given: Mapping[str, Any], stds: Mapping[str, float]) -> Known:
    """Return known inputs from inputs of `Top`, and the standard deviations of some.

    A_cm becomes A = A_cm + m s^2.  Raises LagtopError for an input that a fit cannot use.
    """
    check_names("known", [*given] or ["m"], [*Top.fields, "A_cm", "phidot0"])
    known, spread = {name: checked_double(name, x) for name, x in given.items()}, dict(stds)
    if "phidot0" in known:
        raise LagtopError("phidot0 is no input of a fit: give r0", "phidot0")
    for name in _NOT_ZERO:
        if known.get(name) == 0:
            raise LagtopError(f"{name} must not be 0 in a fit: leave it out", name)
    if "A_cm" in known:
        if not {"m", "s"} <= known.keys():
            raise LagtopError("A_cm must be given with m and s, as A = A_cm + m s^2", "A_cm")
        m, s = known["m"], known["s"]
        known["A"] = known.pop("A_cm") + m * s * s
        parts = [spread.pop("A_cm", 0.0), spread.get("m", 0.0) * s * s]
        if (std := math.hypot(*parts, spread.get("s", 0.0) * 2 * m * s)) > 0:
            spread["A"] = std
    moment = known.get("A", known.get("C", 1.0))
    Top(**{"m": 1.0, "s": 1.0, "g": 1.0, "A": moment, "C": moment, **known})
    for key, unit in (("theta0_deg", math.pi / 180), ("theta0_rad", 1.0)):
        for values in (known, spread):
            if key in values:
                values["theta0"] = values.pop(key) * unit
    return Known(known, spread)


class Problem:
    """The parameters of a recording, and its residuals for many tops at once.

    Parameters are the state, r0 if the spin is recorded, and the zeros of psi and phi.  Known
    inputs replace a, b, r0 and the start as far as they determine them.  A known input that is
    uncertain, and does so, is a parameter with a prior.
    """

    def __init__(self, recording: Recording, known: Known, sigma: Mapping[str, float]) -> None:
        self.recording, self.known, self.sigma = recording, known, dict(sigma)
        weighs = {"m", "g", "s"} <= known.keys()
        self.spins = "phi" in recording.angles or "r0" in known
        self.is_even = (
            recording.angles.keys() == {"theta"} and known.get("psidot0") == 0 and not self.spins
        )
        """Whether the opposite b leaves the same tilt."""
        self.has_torque = weighs and "A" in known
        self.is_tied = self.spins and "C" in known and ("A" in known or weighs)
        used = {"theta0", "thetadot0", "psidot0"} | ({"r0"} if self.spins else set())
        if self.has_torque:
            used |= {"m", "g", "s", "A"}
        if self.is_tied:
            used |= {"C"} | ({"A"} if "A" in known else {"m", "g", "s"})
        self.priors = [x for x in known.stds if x in used]
        motion = [*STATE, *(["r0"] if "phi" in recording.angles else [])]
        fixed = {*known, *["a"] * self.has_torque, *["b"] * self.is_tied}
        self.names = [x for x in motion if x not in fixed]
        self.names += [f"{x}_zero" for x in ("psi", "phi") if x in recording.angles]
        self.names += self.priors

    def values(self, x: Array) -> dict[str, Array]:
        """Return the quantities of the motion from parameters, shape (tops, parameters)."""
        found: dict[str, Any] = {"psi_zero": 0.0, "phi_zero": 0.0, **self.known}
        found |= dict(zip(self.names, x.T, strict=True))
        if self.has_torque:
            found["a"] = 2 * found["m"] * found["g"] * found["s"] / found["A"]
        if self.is_tied:
            inertia = found.get("A")
            if inertia is None:
                inertia = 2 * found["m"] * found["g"] * found["s"] / found["a"]
            found["b"] = found["C"] / inertia * found["r0"]
        found.setdefault("r0", found["b"])
        return {name: np.broadcast_to(value, len(x)) for name, value in found.items()}

    def angles(self, x: Array, t: Array) -> Array:
        """Return theta, phi and psi with the zeros of the recording, shape (3, tops, times)."""
        value = self.values(x)
        states = np.stack([value[name] for name in STATE], axis=-1)
        states, tops = np.unique(states, axis=0, return_inverse=True)
        theta, phi, psi = angles(states, t)[:, tops]
        phi = phi + np.outer(value["r0"] - value["b"], t) + value["phi_zero"][:, np.newaxis]
        return np.stack([theta, phi, psi + value["psi_zero"][:, np.newaxis]])

    def residuals(self, x: Array) -> Array:
        """Return recording minus motion in radians, shape (tops, channels, times)."""
        theta, phi, psi = self.angles(x, self.recording.t)
        seen = self.recording.angles
        if self.recording.kind == "angles":
            motion = {"theta": theta, "phi": phi, "psi": psi}
            found = [within_half_turn(seen[key] - motion[key]) for key in self.recording.channels]
            return np.asarray(np.stack(found, axis=1))
        turned, sine = within_half_turn(seen["psi"] - psi), np.sin(seen["theta"])
        along_meridian = sine * np.cos(theta) * np.cos(turned)
        found = [along_meridian - np.cos(seen["theta"]) * np.sin(theta), sine * np.sin(turned)]
        if self.recording.kind == "attitude":
            found.append(within_half_turn(seen["phi"] - phi + turned * np.cos(theta)))
        return np.stack(found, axis=1)

    def weighted(self, x: Array) -> Array:
        """Return residuals over standard deviations, a row for each top, and priors at the end."""
        sizes = np.array([self.sigma[channel] for channel in self.recording.channels])
        found = (self.residuals(x) / sizes[:, np.newaxis])[:, self.recording.present]
        value = self.values(x)
        priors = [(value[y] - self.known[y]) / self.known.stds[y] for y in self.priors]
        rows: Array = np.nan_to_num(np.column_stack([found, *priors]), nan=_FAR, posinf=_FAR)
        return rows

    def slopes(self, x: Array, *, central: bool = False) -> Array:
        """Return the derivatives of the weighted residuals, by forward or central differences."""
        if not central:
            steps = _SHORT_STEP * np.maximum(np.abs(x), _LEAST_STEP)
            found = self.weighted(np.concatenate([[x], x + np.diag(steps)]))
            return np.asarray((found[1:] - found[0]).T / steps)
        steps = _STEP * np.maximum(np.abs(x), _LEAST_STEP)
        steps = np.where(np.array(self.names) == "a", np.minimum(steps, np.abs(x) / 2), steps)
        found = self.weighted(np.concatenate([x + np.diag(steps), x - np.diag(steps)]))
        return np.asarray((found[: x.size] - found[x.size :]).T / (2 * steps))

    def solve(self, x: Array, steps: int) -> OptimizeResult:
        """Return the least squares from one start."""
        low = [{"a": 1e-30, "theta0": _POLE}.get(name, -np.inf) for name in self.names]
        high = [math.pi - _POLE if name == "theta0" else np.inf for name in self.names]
        return least_squares(
            lambda at: self.weighted(at[np.newaxis])[0],
            np.clip(x, low, high),
            self.slopes,
            bounds=(low, high),
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-11,
            gtol=1e-12,
            max_nfev=steps,
        )

    def parameters_of(self, states: Array, spin: Signal | None) -> Array:
        """Return the parameters of states, with the best zeros and spin rate of each."""
        known, seen, t = self.known, self.recording.angles, self.recording.t
        value: dict[str, Any] = {**known, **dict(zip(STATE, states.T, strict=True))}
        value |= {name: np.full(len(states), known[name]) for name in known.keys() & {*STATE}}
        theta, phi, psi = angles(np.stack([value[x] for x in STATE], axis=-1), t)
        if spin is not None:
            around = t - t.mean()
            shown = np.interp(t, spin.t, spin.y) + spin.rate * t
            r0 = value["b"] + (shown - phi) @ around / (around @ around)
            r0 = np.asarray(known.get("r0", slowest(r0, value["b"], self.recording.frame)))
            value["r0"] = np.broadcast_to(r0, len(states))
            turned = seen["phi"] - phi - np.outer(value["r0"] - value["b"], t)
            value["phi_zero"] = _mean_angle(turned)
        if "psi" in seen:
            value["psi_zero"] = _mean_angle(seen["psi"] - psi, np.sin(theta))
        rows = [np.broadcast_to(value[name], len(states)) for name in self.names]
        return np.stack(rows, axis=-1)


def slowest(r0: Array, b: Array, frame: float) -> Array:
    """Return the slowest of the spin rates that look alike in frames and have 0 < b/r0 <= 2.

    If there is none, the given rates are returned.
    """
    alike = r0 + 2 * math.pi / frame * _ALIASES
    size = np.where((b / alike > 0) & (b / alike <= 2.05), np.abs(alike), np.inf)
    best = alike[np.argmin(size, axis=0), np.arange(np.size(r0))]
    return np.where(np.isfinite(size.min(axis=0)), best, r0)


def _mean_angle(turned: Array, weights: Array | float = 1.0) -> Array:
    found: Array = np.angle(np.nansum(weights * np.exp(1j * turned), axis=1))
    return found
