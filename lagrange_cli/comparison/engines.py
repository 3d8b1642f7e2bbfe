"""Engines that move no top: their equations are integrated with the given inputs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ..arithmetic.types import Array
from ..solver.solve import Motion
from .differences import ExactMotion

_MOST_SLOPES = 20_000
"""Evaluations after which an engine explains nothing: its top moves too fast for the rows."""
_ENGINES = {
    "the inertia does not turn with the body": (-1, -1),
    "rates of the body are multiplied on the left of the quaternion": (1, -1),
    "the torque does not turn with the body": (0, 1),
}
"""By name: the axes of the torque and of the rates, 1 in the body, -1 in space, 0 at the start."""


def engines(motion: Motion) -> Iterator[tuple[str, ExactMotion]]:
    """Yield the name of each engine with its motion."""
    for name, axes in _ENGINES.items():
        yield name, _Engine(motion, *axes)


class _Engine(ExactMotion):
    def __init__(self, motion: Motion, weight: int, hand: int) -> None:
        super().__init__(motion)
        self.weight, self.hand = weight, hand

    def computed(self, t: Array) -> tuple[Array, Array]:
        """Return attitudes and rates at increasing times; NaN if they take too long."""
        from scipy.integrate import solve_ivp  # start-up

        top, weight, hand = self.motion.top, self.weight, self.hand
        count = iter(range(_MOST_SLOPES))
        A, C, torque = float(top.A), float(top.C), float(top.m) * float(top.g) * float(top.s)
        tilt = float(top.inputs(radians=True)["theta0_rad"])
        sine, cosine = math.sin(tilt), math.cos(tilt)
        first = [float(top.thetadot0), float(top.psidot0) * sine, float(top.r0)]
        if weight < 0:
            first[1:] = cosine * first[1] - sine * first[2], sine * first[1] + cosine * first[2]

        def slope(_: float, state: Array) -> Sequence[float]:
            if next(count, None) is None:
                return [math.nan] * len(state)  # ends the integration
            w, x, y, z, p, q, r = state.tolist()
            up_x, up_y = 2 * (weight * x * z - w * y), 2 * (weight * y * z + w * x)
            if not weight:
                up_x, up_y = 0.0, sine
            twist = (C - A) * r
            rates = [(torque * up_y - twist * q) / A, (twist * p - torque * up_x) / A, 0.0]
            cross = [hand * (y * r - z * q), hand * (z * p - x * r), hand * (x * q - y * p)]
            turn = (w * u + v for u, v in zip((p, q, r), cross, strict=True))
            return [-(x * p + y * q + z * r) / 2, *(v / 2 for v in turn), *rates]

        state = [math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0, *first]
        flow = solve_ivp(slope, (0.0, t[-1]), state, "DOP853", t, rtol=1e-6, atol=1e-8)
        found = flow.y.T if flow.success else np.full((t.size, 7), np.nan)
        return found[:, :4], found[:, 4:]
