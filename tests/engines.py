"""Engines of our own for the tests of `compare`: Euler's equations, integrated by plain methods.

They share nothing with the program: the state is a quaternion and the angular velocity in the body.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from lagtop import Top
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

Array = np.ndarray[Any, np.dtype[np.float64]]
Numbers = Sequence[float]
Run = tuple[Array, Array]
"""Times, and a state for each."""


def wxyz(turn: Rotation) -> Array:
    """Return rotations as quaternions, the real part first."""
    return np.asarray(turn.as_quat(scalar_first=True))


def product(a: Any, b: Any) -> tuple[float, float, float, float]:
    """Return the product of two quaternions."""
    (w, x, y, z), (W, X, Y, Z) = a, b
    return (
        w * W - x * X - y * Y - z * Z,
        w * X + x * W + y * Z - z * Y,
        w * Y - x * Z + y * W + z * X,
        w * Z + x * Y - y * X + z * W,
    )


class Body(NamedTuple):
    """A top as an engine has it, with the rules that the engine breaks."""

    A: float
    C: float
    torque: float
    tilt: float
    rates: tuple[float, float, float]
    damping: float = 0.0
    clock: float = 1.0
    half: float = 0.5
    """The factor in the rate of the quaternion."""
    rule: str = ""
    """Rates of the body on the left `side`, a `torque` or an `inertia` that does not turn."""

    @classmethod
    def of(cls, top: Top) -> Body:
        """Return the body of a top, at its start."""
        tilt = float(top.inputs(radians=True)["theta0_rad"])
        rates = float(top.thetadot0), float(top.psidot0) * math.sin(tilt), float(top.r0)
        return cls(float(top.A), float(top.C), float(top.m * top.g * top.s), tilt, rates)

    @property
    def state(self) -> Array:
        """The attitude and the rates at the start."""
        (p, q, r), cos, sin = self.rates, math.cos(self.tilt), math.sin(self.tilt)
        rates = [p, cos * q - sin * r, sin * q + cos * r] if self.rule == "inertia" else [p, q, r]
        return np.array([math.cos(self.tilt / 2), math.sin(self.tilt / 2), 0.0, 0.0, *rates])

    @property
    def is_left(self) -> bool:
        """Whether rates are multiplied on the left of the quaternion."""
        return self.rule in {"side", "inertia"}

    def slope(self, state: Numbers | Array) -> list[float]:
        """Return the slope of the state."""
        w, x, y, z, p, q, r = map(float, state)
        up_x, up_y, twist = 2 * (x * z - w * y), 2 * (y * z + w * x), self.C - self.A
        if self.rule == "torque":  # that of the start, in the body
            up_x, up_y = 0.0, math.sin(self.tilt)
        if self.rule == "inertia":  # rates in space
            up_x, up_y = -2 * (x * z + w * y), 2 * (w * x - y * z)
        faster = [self.torque * up_y - twist * q * r, twist * p * r - self.torque * up_x]
        pair = ((0, p, q, r), (w, x, y, z)) if self.is_left else ((w, x, y, z), (0, p, q, r))
        found = [*(self.half * v for v in product(*pair)), *(v / self.A for v in faster), 0.0]
        found[4:] = [v - self.damping * u for v, u in zip(found[4:], (p, q, r), strict=True)]
        return [self.clock * v for v in found]

    def energy(self, states: Array) -> Array:
        """Return kinetic and potential energy."""
        q, (p, s, r) = states[:, :4], states[:, 4:].T
        height = 1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2) / (q**2).sum(axis=1)
        kinetic = (self.A * (p**2 + s**2) + self.C * r**2) / 2
        total: Array = kinetic + self.torque * height
        return total


def _moved(y: Numbers, by: float, slope: Numbers) -> list[float]:
    return [u + by * v for u, v in zip(y, slope, strict=True)]


def rk4_step(e: Body, y: Numbers, h: float) -> list[float]:
    """Return the state after a step of the classical method of Runge and Kutta, of order 4."""
    a = e.slope(y)
    b = e.slope(_moved(y, h / 2, a))
    c = e.slope(_moved(y, h / 2, b))
    d = e.slope(_moved(y, h, c))
    slopes = zip(a, b, c, d, strict=True)
    return _moved(y, h / 6, [i + 2 * j + 2 * k + n for i, j, k, n in slopes])


def euler_step(e: Body, y: Numbers, h: float) -> list[float]:
    """Return the state after a step of Euler's method, of order 1, with a quaternion of norm 1."""
    return unit(_moved(y, h, e.slope(y)))


def semi_implicit(e: Body, y: Numbers, h: float) -> list[float]:
    """Return the state after a step of the rates, and then of the attitude with these."""
    rates = _moved(y[4:], h, e.slope(y)[4:])
    size = math.hypot(*rates) or 1e-300
    half = e.half * e.clock * h * size
    turn = math.cos(half), *(math.sin(half) / size * x for x in rates)
    return [*(product(turn, y[:4]) if e.is_left else product(y[:4], turn)), *rates]


def unit(y: Numbers) -> list[float]:
    """Return a state with a quaternion of norm 1."""
    size = math.hypot(*y[:4])
    return [*(x / size for x in y[:4]), *y[4:]]


def stepped(e: Body, h: float, end: float, step: Callable[..., list[float]], every: int = 1) -> Run:
    """Return every so many states of steps."""
    y = e.state.tolist()
    states = [y]
    for i in range(1, round(end / h) + 1):
        y = step(e, y, h)
        states += [y] * (i % every == 0)
    return np.arange(float(len(states))) * h * every, np.array(states)


def rk4(body: Body, h: float, end: float) -> Run:
    """Return a trajectory by the method of Runge and Kutta."""
    return stepped(body, h, end, rk4_step)


def dop853(body: Body, t: Array, rtol: float = 3e-14, method: str = "DOP853") -> Run:
    """Return a trajectory by DOP853 at its tightest, or by another integrator of SciPy."""
    flow = solve_ivp(
        lambda _, y: body.slope(y), (t[0], t[-1]), body.state, method, t, rtol=rtol, atol=rtol / 30
    )
    return t, flow.y.T
