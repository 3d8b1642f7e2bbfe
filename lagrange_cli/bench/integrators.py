"""Numerical integration of Euler's equations: two forms of them, and the methods of others.

Another method of scipy is one entry in SCIPY; another form of the equations one in FORMS.  Time is
scaled by the rates of the top, so that a tolerance means the same in any units.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.numbers import DOUBLES
from ..arithmetic.types import Array
from ..inputs.rotations import angles_of
from ..inputs.top import Top
from .method import AngleFunction, FailedError, Method, NotApplicableError, SampledAngles

TIGHTEST = 3e-14
"""Least relative tolerance that scipy takes."""

STEPS_PER_SECOND = 100_000
"""Steps that count as a second of heyoka, which no clock can interrupt between its steps."""

Slope = Callable[[float, Sequence[Any]], Sequence[Any]]


class ScaledTop(NamedTuple):
    """A top in units of time in which its rates are of the size of 1."""

    a: float
    b: float
    r0: float
    theta0: float
    theta_rate: float
    psi_rate: float
    clock: float
    """Rate that has become 1."""


def scaled_top(top: Top) -> ScaledTop:
    """Return the problem of a top."""
    a = 2 * float(top.m) * float(top.g) * float(top.s) / float(top.A)
    b, theta0 = float(top.C) * float(top.r0) / float(top.A), top.tilt(DOUBLES)
    theta_rate, psi_rate = float(top.thetadot0), float(top.psidot0)
    clock = math.sqrt(a) + abs(b) + abs(theta_rate) + abs(psi_rate)
    return ScaledTop(
        a=a / clock / clock,
        b=b / clock,
        r0=float(top.r0) / clock,
        theta0=2 * math.atan2(theta0.sin_half, theta0.cos_half),
        theta_rate=theta_rate / clock,
        psi_rate=psi_rate / clock,
        clock=clock,
    )


class Form(NamedTuple):
    """Variables to integrate in: their start, their slope, and the angles from them."""

    start: Callable[[ScaledTop], Sequence[float]]
    slope: Callable[[ScaledTop, Any], Slope]
    """Right-hand side in an arithmetic with sin and cos: `math`, or heyoka's expressions."""
    angles: Callable[[Array], SampledAngles]
    """Angles from an array with a row for each variable."""
    whole_turns: bool


def _euler_start(p: ScaledTop) -> Sequence[float]:
    if not math.sin(p.theta0):
        raise NotApplicableError("Euler angles are singular on the vertical")
    return p.theta0, p.theta_rate, 0.0, 0.0


def _euler_slope(p: ScaledTop, ar: Any) -> Slope:
    """Return the slope of theta, its rate, phi and psi, by the constant momenta of (4,7), (4,8)."""
    beta = p.psi_rate * math.sin(p.theta0) ** 2 + p.b * math.cos(p.theta0)

    def slope(_: float, state: Sequence[Any]) -> Sequence[Any]:
        theta, theta_rate, _, _ = state
        sin, cos = ar.sin(theta), ar.cos(theta)
        rate = (beta - p.b * cos) / (sin * sin)
        return theta_rate, sin * (rate * (rate * cos - p.b) + p.a / 2), p.r0 - rate * cos, rate

    return slope


def _quaternion_start(p: ScaledTop) -> Sequence[float]:
    q = p.psi_rate * math.sin(p.theta0)
    return p.theta_rate, q, math.cos(p.theta0 / 2), math.sin(p.theta0 / 2), 0.0, 0.0


def _quaternion_slope(p: ScaledTop, _: Any) -> Slope:
    """Return the slope of p, q (body) and the quaternion (body to space): nothing is singular."""
    twist = p.r0 - p.b

    def slope(_: float, state: Sequence[Any]) -> Sequence[Any]:
        x, y, e0, e1, e2, e3 = state
        return (
            twist * y + p.a * (e2 * e3 + e0 * e1),
            -twist * x - p.a * (e1 * e3 - e0 * e2),
            (-e1 * x - e2 * y - e3 * p.r0) / 2,
            (e0 * x + e2 * p.r0 - e3 * y) / 2,
            (e0 * y + e3 * x - e1 * p.r0) / 2,
            (e0 * p.r0 + e1 * y - e2 * x) / 2,
        )

    return slope


def quaternion_angles(rows: Array) -> SampledAngles:
    """Return the angles, turns aside, of quaternions w, x, y, z, a row for each."""
    return [*angles_of(rows).values()]


FORMS = {
    "euler": Form(_euler_start, _euler_slope, lambda rows: (rows[0], rows[2], rows[3]), True),
    "quaternion": Form(
        _quaternion_start, _quaternion_slope, lambda rows: quaternion_angles(rows[2:].T), False
    ),
}


class Limit:
    """A clock that ends a run after some seconds."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.end = seconds, time.perf_counter() + seconds

    def check(self) -> None:
        """Raise FailedError when the seconds are over."""
        if time.perf_counter() > self.end:
            raise self.error()

    def error(self) -> FailedError:
        """Return what is said of a run that took longer."""
        return FailedError(f"took more than {self.seconds:g} s")


def scipy_method(name: str, form: Form, top: Top, rtol: float, limit: float = 5.0) -> AngleFunction:
    """Return a method of scipy's solve_ivp, with its own interpolation between the steps."""
    from scipy.integrate import solve_ivp

    scene = scaled_top(top)
    start, formula = form.start(scene), form.slope(scene, math)

    def sample(t: Array) -> SampledAngles:
        watch, times = Limit(limit), t * scene.clock

        def slope(now: float, state: Array) -> Sequence[float]:
            watch.check()
            return formula(now, state.tolist())

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what goes wrong is seen in the outcome
            try:
                flow = solve_ivp(
                    slope, (0.0, times[-1]), start, name, t_eval=times, rtol=rtol, atol=rtol
                )
            except ArithmeticError as error:
                raise FailedError(f"stopped: {error}") from None
        if not flow.success:
            raise FailedError(f"stopped: {flow.message}")
        return form.angles(flow.y)

    return sample


def _forget_compiled_code(state: Any) -> None:
    """Clear heyoka's cache of compiled code and leave it off, so that set-up times compare."""
    state.clear_memcache()
    if hasattr(state, "set_diskcache_enabled"):
        state.set_diskcache_enabled(False)


def heyoka_method(form: Form, top: Top, tol: float, limit: float = 5.0) -> AngleFunction:
    """Return Taylor's method, compiled for this top; the set-up includes the compilation."""
    import heyoka

    _forget_compiled_code(heyoka.llvm_state)
    scene = scaled_top(top)
    start = np.array(form.start(scene))
    variables = heyoka.make_vars(*(f"x{i}" for i in range(start.size)))
    system = list(zip(variables, form.slope(scene, heyoka)(0.0, variables), strict=True))
    integrator = heyoka.taylor_adaptive(system, start, tol=tol)

    def sample(t: Array) -> SampledAngles:
        integrator.time, integrator.state[:] = 0.0, start
        grid = np.concatenate(([0.0], t[t != 0] * scene.clock))
        steps = int(limit * STEPS_PER_SECOND)
        outcome, *_, rows = integrator.propagate_grid(grid, max_steps=steps)
        if outcome == heyoka.taylor_outcome.step_limit:
            raise FailedError(f"took more than {steps} steps")
        if outcome != heyoka.taylor_outcome.time_limit:
            raise FailedError(f"stopped: {outcome}")
        return form.angles(rows.T[:, -t.size :])

    return sample


SCIPY: dict[str, list[float]] = {
    "RK45": [1e-3, 1e-5, 1e-7, 1e-9],
    "DOP853": [1e-4, 1e-7, 1e-10, TIGHTEST],
    "LSODA": [1e-4, 1e-7, 1e-10, 1e-12],
    "Radau": [1e-3, 1e-5, 1e-7],
}
TAYLOR = [1e-5, 1e-8, 1e-12, 1e-16]


def integrators(limit: float) -> dict[str, Method]:
    """Return each method in each form by name; a run may take `limit` seconds."""
    table = {}
    for shape, form in FORMS.items():
        for name, tolerances in SCIPY.items():
            prepare = partial(scipy_method, name, form, limit=limit)
            table[f"{name}-{shape}"] = Method(
                tolerances, prepare, "scipy.integrate", whole_turns=form.whole_turns
            )
        prepare = partial(heyoka_method, form, limit=limit)
        table[f"Taylor-{shape}"] = Method(TAYLOR, prepare, "heyoka", whole_turns=form.whole_turns)
    return table
