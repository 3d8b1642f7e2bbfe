"""Engines of our own for the tests of `compare`: Euler's equations, integrated by plain methods.

They share nothing with the program: the state is a quaternion and the angular velocity in the body.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from lagtop import Top
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

Array = np.ndarray[Any, np.dtype[np.float64]]


def wxyz(turn: Rotation) -> Array:
    """Return rotations as quaternions, the real part first."""
    return np.asarray(turn.as_quat(scalar_first=True))


class Body(NamedTuple):
    """A top as an engine has it; gravity may point anywhere along z."""

    A: float
    C: float
    torque: float
    state: Array

    @classmethod
    def of(cls, top: Top, g: float | None = None) -> Body:
        """Return the body of a top, at its start."""
        tilt = float(top.inputs(radians=True)["theta0_rad"])
        rates = [top.thetadot0, top.psidot0 * np.sin(tilt), top.r0]
        state = np.array([np.cos(tilt / 2), np.sin(tilt / 2), 0, 0, *rates])
        return cls(
            float(top.A), float(top.C), float(top.m * (top.g if g is None else g) * top.s), state
        )

    def slope(self, state: Array) -> Array:
        """Return the slope of the state."""
        w, x, y, z, p, q, r = state
        up_x, up_y = 2 * (x * z - w * y), 2 * (y * z + w * x)
        twist = (self.C - self.A) * r
        turn = [-x * p - y * q - z * r, w * p + y * r - z * q]
        turn += [w * q + z * p - x * r, w * r + x * q - y * p]
        speed_up = [self.torque * up_y - twist * q, twist * p - self.torque * up_x]
        return np.array([*(part / 2 for part in turn), *(part / self.A for part in speed_up), 0.0])

    def energy(self, states: Array) -> Array:
        """Return kinetic and potential energy."""
        q, (p, s, r) = states[:, :4], states[:, 4:].T
        height = 1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2) / (q**2).sum(axis=1)
        kinetic = (self.A * (p**2 + s**2) + self.C * r**2) / 2
        total: Array = kinetic + self.torque * height
        return total


Run = tuple[Array, Array]
"""Times, and a state for each."""


def rk4(body: Body, h: float, end: float) -> Run:
    """Return a trajectory by the classical method of Runge and Kutta, of order 4."""

    def step(y: Array) -> Array:
        a = body.slope(y)
        b = body.slope(y + h / 2 * a)
        c = body.slope(y + h / 2 * b)
        return y + h / 6 * (a + 2 * b + 2 * c + body.slope(y + h * c))

    return _stepped(body, h, end, step)


def euler(body: Body, h: float, end: float) -> Run:
    """Return a trajectory by Euler's method, of order 1, with quaternions of norm 1."""

    def step(y: Array) -> Array:
        y = y + h * body.slope(y)
        return np.concatenate([y[:4] / np.linalg.norm(y[:4]), y[4:]])

    return _stepped(body, h, end, step)


def dop853(body: Body, t: Array, rtol: float = 3e-14, method: str = "DOP853") -> Run:
    """Return a trajectory by DOP853 at its tightest, or by another integrator of SciPy."""
    flow = solve_ivp(
        lambda _, y: body.slope(y), (t[0], t[-1]), body.state, method, t, rtol=rtol, atol=rtol / 30
    )
    return t, flow.y.T


def _stepped(body: Body, h: float, end: float, step: Callable[[Array], Array]) -> Run:
    states = [body.state]
    for _ in range(round(end / h)):
        states.append(step(states[-1]))
    return np.arange(float(len(states))) * h, np.array(states)
