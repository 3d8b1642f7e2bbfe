"""Engines that move no top, integrated with the given inputs."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.types import Array
from ..top.top import Top

_Z = np.array([0.0, 0.0, 1.0])
_MOST = 40.0
"""The angle in radians by which the spin turns in the rows that are compared."""
_MOST_SLOPES = 20_000
"""Evaluations after which an engine explains nothing: its top moves too fast for the rows."""
ENGINES = {
    "the inertia does not turn with the body": ("space", "space"),
    "rates of the body are multiplied on the left of the quaternion": ("body", "space"),
    "the torque does not turn with the body": ("fixed", "body"),
}
"""By name: the axes of the torque, and those of the rates that turn the body."""


def engine_errors(top: Top, t: Array, seen: Array) -> Iterator[tuple[str, float, float]]:
    """Yield each engine with its error in radians and that of the right engine, on the first rows.

    `seen` are attitudes of shape (n, 4) at increasing times.
    """
    from scipy.integrate import solve_ivp  # start-up

    few = max(8, int(np.searchsorted(t - t[0], _MOST / max(abs(float(top.r0)), 1e-300))))
    t, seen = t[:few] - t[0], seen[:few]
    A, C, torque = float(top.A), float(top.C), float(top.m) * float(top.g) * float(top.s)
    inputs = top.inputs(radians=True)
    tilt = float(inputs["theta0_rad"])
    across = float(top.thetadot0), float(top.psidot0) * np.sin(tilt)
    first = rotations.of_angles(np.asarray(tilt), np.asarray(0.0), np.asarray(0.0))
    rates, moments = np.array([*across, float(top.r0)]), np.array([A, A, C])
    fixed = rotations.rotated(rotations.conjugate(first), _Z)

    def error(weight: str, turn: str) -> float:
        count = iter(range(_MOST_SLOPES))

        def slope(_: float, state: Array) -> Array:
            if next(count, None) is None:
                return np.full_like(state, np.nan)  # ends the integration
            q, w = state[:4], state[4:]
            up, axis = rotations.rotated(rotations.conjugate(q), _Z), _Z
            if weight == "space":
                up, axis = _Z, rotations.axis_of(q)
            push = torque * np.cross(fixed if weight == "fixed" else up, axis)
            pure = np.append(0.0, w)
            pair = (pure, q) if turn == "space" else (q, pure)
            return np.concatenate(
                [rotations.product(*pair) / 2, (push - np.cross(w, moments * w)) / moments]
            )

        start = rotations.rotated(first, rates) if weight == "space" else rates
        state = np.concatenate([first, start])
        flow = solve_ivp(slope, (0.0, t[-1]), state, "DOP853", t, rtol=1e-6, atol=1e-8)
        if not flow.success:
            return math.inf
        return float(np.nanmax(rotations.angle_between(flow.y[:4].T, seen[: flow.y.shape[1]])))

    right = error("body", "body")
    for name, rules in ENGINES.items() if right < math.inf else ():
        yield name, error(*rules), right
