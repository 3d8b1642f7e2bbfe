"""Engines that move no top: their equations are integrated with the given inputs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.types import Array
from ..solver.solve import Motion
from .differences import ExactMotion

_Z = np.array([0.0, 0.0, 1.0])
_MOST_SLOPES = 20_000
"""Evaluations after which an engine explains nothing: its top moves too fast for the rows."""
_ENGINES = {
    "the inertia does not turn with the body": ("space", "space"),
    "rates of the body are multiplied on the left of the quaternion": ("body", "space"),
    "the torque does not turn with the body": ("fixed", "body"),
}
"""By name: the axes of the torque, and those of the rates that turn the body."""


def engines(motion: Motion) -> Iterator[tuple[str, ExactMotion]]:
    """Yield the name of each engine with its motion."""
    for name, axes in _ENGINES.items():
        yield name, _Engine(motion, *axes)


class _Engine(ExactMotion):
    def __init__(self, motion: Motion, weight: str, turn: str) -> None:
        super().__init__(motion)
        self.weight, self.turn, top = weight, turn, motion.top
        self.torque = float(top.m) * float(top.g) * float(top.s)
        self.moments = float(top.A), float(top.C)
        tilt = np.asarray(float(top.inputs(radians=True)["theta0_rad"]))
        self.first = rotations.of_angles(tilt, 0 * tilt, 0 * tilt)
        self.fixed = rotations.rotated(rotations.conjugate(self.first), _Z).tolist()
        rates = np.array([top.thetadot0, float(top.psidot0) * math.sin(tilt), top.r0], float)
        self.rates = rotations.rotated(self.first, rates) if weight == "space" else rates

    def computed(self, t: Array) -> tuple[Array, Array]:
        """Return attitudes and rates at increasing times; NaN if they take too long."""
        from scipy.integrate import solve_ivp  # start-up

        count = iter(range(_MOST_SLOPES))
        A, C = self.moments
        hand, side = (-1.0 if x == "space" else 1.0 for x in (self.weight, self.turn))

        def slope(_: float, state: Array) -> Sequence[float]:
            if next(count, None) is None:
                return [math.nan] * len(state)  # ends the integration
            w, x, y, z, p, q, r = state.tolist()
            up_x, up_y = 2 * (x * z - hand * w * y), 2 * (y * z + hand * w * x)
            if self.weight == "fixed":
                up_x, up_y = self.fixed[:2]
            push, twist = hand * self.torque, (C - A) * r
            turn = [side * (y * r - z * q), side * (z * p - x * r), side * (x * q - y * p)]
            turn = [w * p + turn[0], w * q + turn[1], w * r + turn[2]]
            rates = [(push * up_y - twist * q) / A, (twist * p - push * up_x) / A, 0.0]
            return [-(x * p + y * q + z * r) / 2, *(v / 2 for v in turn), *rates]

        state = np.concatenate([self.first, self.rates])
        flow = solve_ivp(slope, (0.0, t[-1]), state, "DOP853", t, rtol=1e-6, atol=1e-8)
        found = flow.y.T if flow.success else np.full((t.size, 7), np.nan)
        return found[:, :4], found[:, 4:]
