"""Numerical integration of Euler's equations, in two forms and by methods of other packages.

Another method is one entry in WAYS; another form of the equations is one in FORMS.
Angles are in radians and rates in the units of the scene; tolerances apply to these numbers.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from itertools import count
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.numbers import DOUBLES
from ..arithmetic.types import Array
from ..inputs.rotations import angles_of
from ..inputs.top import Top
from ..motion.solve import solve
from .method import (
    AngleFunction,
    Drift,
    FailedError,
    Method,
    NotApplicableError,
    Run,
    Work,
)

TIGHTEST = 3e-14
"""Least relative tolerance that scipy accepts."""

STEPS_PER_SECOND = 100_000
"""Steps that count as a second of heyoka, which cannot be interrupted by a clock."""

Slope = Callable[[float, Sequence[Any]], Sequence[Any]]


class TopProblem(NamedTuple):
    """Constants and start of a top."""

    a: float
    b: float
    r0: float
    theta0: float
    theta_rate: float
    psi_rate: float

    @property
    def sizes(self) -> tuple[float, float]:
        """The sums of the terms of energy and vertical momentum at the start, over A."""
        sin, cos = math.sin(self.theta0), math.cos(self.theta0)
        swing = self.theta_rate**2 + (self.psi_rate * sin) ** 2 + self.a * (1 + abs(cos))
        return (swing + abs(self.b * self.r0)) / 2, abs(self.psi_rate) * sin**2 + 2 * abs(self.b)


def problem_of(top: Top) -> TopProblem:
    """Return the problem of a top, in the units of its scene."""
    tilt = top.tilt(DOUBLES)
    return TopProblem(
        a=2 * float(top.m) * float(top.g) * float(top.s) / float(top.A),
        b=float(top.C) * float(top.r0) / float(top.A),
        r0=float(top.r0),
        theta0=2 * math.atan2(tilt.sin_half, tilt.cos_half),
        theta_rate=float(top.thetadot0),
        psi_rate=float(top.psidot0),
    )


class Form(NamedTuple):
    """Variables of an integration: their start, their slope, and the angles from them."""

    start: Callable[[TopProblem], Sequence[float]]
    slope: Callable[[TopProblem, Any], Slope]
    """Right-hand side in an arithmetic with sin and cos: `math`, or heyoka's expressions."""
    angles: Callable[[Array], Sequence[Any]]
    """Angles from an array with a row for each variable."""
    whole_turns: bool
    drift: Callable[[TopProblem, Array], Drift] = lambda *_: (None, None)

    def run(self, p: TopProblem, rows: Array, *work: int) -> Run:
        """Return the run with these rows, one for each variable of the form."""
        drift = self.drift(p, rows) if np.isfinite(rows).all() else (None, None)
        return Run(self.angles(rows), Work(*work), drift)


def _euler_start(p: TopProblem) -> Sequence[float]:
    if not math.sin(p.theta0):
        raise NotApplicableError("Euler angles are singular on the vertical")
    return p.theta0, p.theta_rate, 0.0, 0.0


def _euler_slope(p: TopProblem, ar: Any) -> Slope:
    """Return the slope of theta, its rate, phi and psi, by the constant momenta of (4,7), (4,8)."""
    beta = p.psi_rate * math.sin(p.theta0) ** 2 + p.b * math.cos(p.theta0)

    def slope(_: float, state: Sequence[Any]) -> Sequence[Any]:
        theta, theta_rate, _, _ = state
        sin, cos = ar.sin(theta), ar.cos(theta)
        rate = (beta - p.b * cos) / (sin * sin)
        return theta_rate, sin * (rate * (rate * cos - p.b) + p.a / 2), p.r0 - rate * cos, rate

    return slope


def _quaternion_start(p: TopProblem) -> Sequence[float]:
    q = p.psi_rate * math.sin(p.theta0)
    return p.theta_rate, q, math.cos(p.theta0 / 2), math.sin(p.theta0 / 2), 0.0, 0.0


def _quaternion_slope(p: TopProblem, _: Any) -> Slope:
    """Return the slope of p, q (body) and the quaternion (body to space); it is never singular."""
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


def _quaternion_drift(p: TopProblem, rows: Array) -> Drift:
    """Return the greatest changes of energy and Lz, from p, q and the quaternion."""
    whole = np.column_stack([_quaternion_start(p), rows])
    x, y, e0, e1, e2, e3 = whole
    cosine = e0 * e0 + e3 * e3 - e1 * e1 - e2 * e2
    swing = (x * x + y * y) / 2
    sideways = 2 * (x * (e1 * e3 - e0 * e2) + y * (e2 * e3 + e0 * e1))
    energy, Lz = swing + p.a / 2 * cosine, p.b * cosine + sideways
    changes = np.max(np.abs([energy - energy[0], Lz - Lz[0]]), axis=1) / p.sizes
    return float(changes[0]), float(changes[1])


FORMS = {
    "euler": Form(_euler_start, _euler_slope, lambda rows: (rows[0], rows[2], rows[3]), True),
    "quaternion": Form(
        _quaternion_start,
        _quaternion_slope,
        lambda rows: [*angles_of(rows[2:].T).values()],
        False,
        _quaternion_drift,
    ),
}


Limits = tuple[float, float]
"""Limits of a run: seconds, and evaluations of the right-hand side."""


def watched(slope: Slope, limits: Limits) -> Callable[[float, Array], Sequence[float]]:
    """Return a slope for arrays that raises FailedError if a run exceeds its limits."""
    seconds, most = limits
    end, counts = time.perf_counter() + seconds, count(1)

    def counted(now: float, state: Array) -> Sequence[float]:
        if next(counts) > most:
            raise FailedError(f"took more than {most:.0e} evaluations")
        if time.perf_counter() > end:
            raise FailedError(f"took more than {seconds:g} s")
        return slope(now, state.tolist())

    return counted


def scipy_method(name: str, form: Form, top: Top, rtol: float, *, limits: Limits) -> AngleFunction:
    """Return a method of scipy's solve_ivp, with its own interpolation between the steps."""
    from scipy.integrate import solve_ivp

    problem = problem_of(top)
    start, slope = form.start(problem), form.slope(problem, math)

    def run(t: Array) -> Run:
        f = watched(slope, limits)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the outcome shows failures
            try:
                flow = solve_ivp(
                    f, (0.0, t[-1]), start, name, dense_output=True, rtol=rtol, atol=rtol
                )
            except ArithmeticError as error:
                raise FailedError(f"stopped: {error}") from None
        if not flow.success:
            raise FailedError(f"stopped: {flow.message}")
        return form.run(problem, flow.sol(t), int(flow.nfev), flow.t.size - 1, int(flow.njev))

    return run


def rk4_method(form: Form, top: Top, per_period: int, *, limits: Limits) -> AngleFunction:
    """Return the classical Runge-Kutta method with a number of equal steps per nutation period.

    The gap between two times is divided into a whole number of steps, so that each time is hit.
    """
    problem, period = problem_of(top), float(solve(top).T_nutation or 1)
    start, slope = np.array(form.start(problem)), form.slope(problem, math)

    def run(t: Array) -> Run:
        limited = watched(slope, limits)

        def f(state: Array) -> Array:
            return np.array(limited(0.0, state))

        state, now, rows, steps = start, 0.0, [], 0
        for end in t.tolist():
            some = math.ceil(abs(end - now) / period * per_period * (1 - 1e-9))
            h = (end - now) / max(some, 1)
            for _ in range(some):
                k1 = f(state)
                k2 = f(state + h / 2 * k1)
                k3 = f(state + h / 2 * k2)
                state = state + h / 6 * (k1 + 2 * (k2 + k3) + f(state + h * k3))
            now, steps = end, steps + some
            rows.append(state)
        return form.run(problem, np.array(rows).T, 4 * steps, steps, 0)

    return run


def heyoka_method(form: Form, top: Top, tol: float, *, limits: Limits) -> AngleFunction:
    """Return Taylor's method, compiled for this top; the set-up includes the compilation."""
    import heyoka

    heyoka.llvm_state.clear_memcache()  # compiled code, so that set-up times are comparable
    if hasattr(heyoka.llvm_state, "set_diskcache_enabled"):
        heyoka.llvm_state.set_diskcache_enabled(False)
    problem = problem_of(top)
    start = np.array(form.start(problem))
    variables = heyoka.make_vars(*(f"x{i}" for i in range(start.size)))
    system = list(zip(variables, form.slope(problem, heyoka)(0.0, variables), strict=True))
    integrator = heyoka.taylor_adaptive(system, start, tol=tol)
    seconds, evaluations = limits
    most = int(min(seconds * STEPS_PER_SECOND, evaluations / integrator.order))

    def run(t: Array) -> Run:
        integrator.time, integrator.state[:] = 0.0, start
        grid = np.concatenate(([0.0], t[t != 0]))
        outcome, _, _, steps, _, rows = integrator.propagate_grid(grid, max_steps=most)
        if outcome == heyoka.taylor_outcome.step_limit:
            raise FailedError(f"took more than {most} steps")
        if outcome != heyoka.taylor_outcome.time_limit:
            raise FailedError(f"stopped: {outcome}")
        return form.run(problem, rows.T[:, -t.size :], steps * integrator.order, steps, 0)

    return run


_SCIPY = "scipy.integrate"
WAYS: dict[str, tuple[Sequence[float], Any, str]] = {
    "RK45": ([1e-3, 1e-5, 1e-7, 1e-9], partial(scipy_method, "RK45"), _SCIPY),
    "DOP853": ([1e-4, 1e-7, 1e-10, TIGHTEST], partial(scipy_method, "DOP853"), _SCIPY),
    "LSODA": ([1e-4, 1e-7, 1e-10, 1e-12], partial(scipy_method, "LSODA"), _SCIPY),
    "Radau": ([1e-3, 1e-5, 1e-7], partial(scipy_method, "Radau"), _SCIPY),
    "RK4": ([50, 200, 800], rk4_method, ""),
    "Taylor": ([1e-5, 1e-8, 1e-12, 1e-16], heyoka_method, "heyoka"),
}
"""Settings, set-up and package of each method."""


def integrators(seconds: float, evaluations: float = math.inf) -> dict[str, Method]:
    """Return each method in each form by name, with limits on seconds and evaluations of a run."""
    limits = seconds, evaluations
    return {
        f"{name}-{shape}": Method(
            settings, partial(way, form, limits=limits), package, whole_turns=form.whole_turns
        )
        for shape, form in FORMS.items()
        for name, (settings, way, package) in WAYS.items()
    }
