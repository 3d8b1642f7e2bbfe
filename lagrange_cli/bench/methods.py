"""The methods that `bench` and `stability` compare.

A new method is one entry in METHODS: its settings, and a function of a top and a setting.  That
function makes the set-up, and returns a function that computes the attitudes at increasing times.
Integrators solve Euler's equations for p, q and the quaternion, which are singular nowhere.  Rates
are in the units of the scene, and a tolerance is both the relative and the absolute one.
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
from ..errors import LagtopError
from ..inputs.top import Top
from ..motion.solve import Motion, solve

TIGHTEST = 3e-14
"""Least relative tolerance that SciPy accepts."""
LOOKS = 20_000
"""Steps of heyoka between two looks at the clock."""


class SlowError(Exception):
    """A run has exceeded its limit of CPU time."""


class Run(NamedTuple):
    """The output of a run, and its work."""

    output: Any
    """The numbers that the method computes, which are all that is timed."""
    evaluations: int | None = None
    """Evaluations of the right-hand side; of Taylor's method, its steps times its order."""
    to_attitudes: Callable[[Any], Array] = np.asarray
    """Convert the output to quaternions w, x, y, z from body to space, of shape (times, 4)."""


Sample = Callable[[Array, float], Run]
"""A function of increasing times and of a limit of CPU seconds.

It may raise SlowError, or ArithmeticError if the method fails.
"""


class Method(NamedTuple):
    """A way to compute attitudes, with the settings at which `bench` runs it."""

    settings: Sequence[Any]
    prepare: Callable[[Motion, Any], Sample]
    """The set-up.  It may raise ImportError, or LagtopError for a top that the method refuses."""
    package: str = ""
    """The package to install, if lagtop does not require it."""
    has_fixed_steps: bool = False
    """Whether steps have one length, which divides the gaps between the times."""


class Problem(NamedTuple):
    """Euler's equations of a top, for p, q (body axes) and the quaternion."""

    start: Array
    slope: Callable[[float, Sequence[Any]], list[Any]]


def problem_of(top: Top) -> Problem:
    """Return the initial state (p, q, w, x, y, z) and its derivative, in doubles."""
    a = 2 * float(top.m) * float(top.g) * float(top.s) / float(top.A)
    r0 = float(top.r0)
    twist = r0 - float(top.C) * r0 / float(top.A)
    tilt = top.tilt(DOUBLES)
    sin, cos_half, sin_half = tilt.sin, tilt.cos_half, tilt.sin_half
    start = [float(top.thetadot0), float(top.psidot0) * sin, cos_half, sin_half, 0.0, 0.0]

    def slope(_: float, state: Sequence[Any]) -> list[Any]:
        p, q, w, x, y, z = state
        return [
            twist * q + a * (y * z + w * x),
            -twist * p - a * (x * z - w * y),
            (-x * p - y * q - z * r0) / 2,
            (w * p + y * r0 - z * q) / 2,
            (w * q + z * p - x * r0) / 2,
            (w * r0 + x * q - y * p) / 2,
        ]

    return Problem(np.array(start), slope)


def counted(
    problem: Problem, limit: float
) -> tuple[Callable[[float, Array], list[float]], list[int]]:
    """Return the slope with a limit of CPU seconds, and a list whose element counts its calls."""
    end, calls = time.process_time() + limit, [0]

    def slope(t: float, state: Array) -> list[float]:
        calls[0] += 1
        if calls[0] % 256 == 0 and time.process_time() > end:
            raise SlowError
        return problem.slope(t, state.tolist())

    return slope, calls


def quaternions(halves: Sequence[Array]) -> Array:
    """Return the attitudes, of shape (times, 4), from theta/2, (psi + phi)/2 and (psi - phi)/2."""
    half, plus, minus = halves
    cos, sin = np.cos(half), np.sin(half)
    parts = [cos * np.cos(plus), sin * np.cos(minus), sin * np.sin(minus), cos * np.sin(plus)]
    return np.stack(parts, axis=1)


def lagtop(motion: Motion, output: str) -> Sample:
    """Return lagtop in doubles: the three angles of `Motion.angles`, or the quaternion."""
    fresh = solve(motion.top)
    fresh.sampler()
    names = [f"quaternion_{part}" for part in "wxyz"]

    def quaternion(t: Array, _: float) -> Run:
        return Run(fresh.table(t, names), None, lambda x: np.stack(list(x.values()), axis=1))

    def angles(t: Array, _: float) -> Run:
        return Run(fresh.angles(t), None, of_angles)

    def of_angles(angles: Any) -> Array:
        theta, phi, psi = angles
        return quaternions([theta / 2, (psi + phi) / 2, (psi - phi) / 2])

    return {"angles": angles, "quaternion": quaternion}[output]


def closed_form_in_doubles(motion: Motion, _: Any) -> Sample:
    """Return Legendre's integrals in plain doubles, as a user of SciPy would write them.

    The roots are those of NumPy for the cubic (4,9).  With sn^2 counted from u1 and
    n = k^2 (1 +- u3)/(1 +- u1):

        1/(1 +- u) = 1/(1 +- u3) + (1/(1 +- u1) - 1/(1 +- u3))/(1 - n sn^2).
    """
    from scipy import special

    top = motion.top
    a = 2 * float(top.m) * float(top.g) * float(top.s) / float(top.A)
    r0, psi_rate, theta_rate = float(top.r0), float(top.psidot0), float(top.thetadot0)
    b, u0 = float(top.C) * r0 / float(top.A), float(top.tilt(DOUBLES).cos)
    beta = psi_rate * (1 - u0 * u0) + b * u0
    alpha = theta_rate**2 + psi_rate**2 * (1 - u0 * u0) + a * u0
    cubic = [a, -(alpha + b * b), 2 * b * beta - a, alpha - beta * beta]
    u2, u1, u3 = np.sort(np.roots(cubic).real)
    m = (u1 - u2) / (u3 - u2)
    K, speed = special.ellipk(m), math.sqrt(a * (u3 - u2)) / 2

    def third(sign: int, w: Array) -> Array:
        at_u1, at_u3 = 1 + sign * u1, 1 + sign * u3
        n = m * at_u3 / at_u1
        turns = np.rint(w / (2 * K))
        sn, cn, dn, _ = special.ellipj(w - turns * 2 * K, m)
        whole = K + n / 3 * special.elliprj(0.0, 1 - m, 1.0, 1 - n)
        part = special.elliprf(cn * cn, dn * dn, 1.0)
        part += n / 3 * sn * sn * special.elliprj(cn * cn, dn * dn, 1.0, 1 - n * sn * sn)
        integral: Array = w / at_u3 + (1 / at_u1 - 1 / at_u3) * (2 * turns * whole + sn * part)
        return integral / speed

    def halves(w: Array) -> tuple[Array, Array]:
        return (beta + b) / 2 * third(1, w), (beta - b) / 2 * third(-1, w)

    start = 0.0
    if theta_rate or abs(u0 - u2) < abs(u0 - u1):
        sn2 = (u1 - u0) * (u3 - u2) / ((u3 - u0) * (u1 - u2))
        start = float(special.ellipkinc(math.asin(math.sqrt(min(max(sn2, 0), 1))), m))
        start = math.copysign(start, theta_rate)
    first = halves(np.array(start))

    def sample(t: Array, _: float) -> Run:
        w = start + speed * t
        plus, minus = (now - then for now, then in zip(halves(w), first, strict=True))
        drift = (r0 - b) / 2 * t
        sn, _, dn, _ = special.ellipj(w - np.rint(w / (2 * K)) * 2 * K, m)
        half = np.arccos(np.clip(u1 - (u1 - u2) * (1 - m) * (sn / dn) ** 2, -1, 1)) / 2  # (4,20)
        return Run([half, plus + drift, minus - drift], None, quaternions)

    return sample


def scipy_method(name: str, motion: Motion, tolerance: float) -> Sample:
    """Return a method of SciPy's solve_ivp, with its own interpolation between the steps."""
    from scipy.integrate import solve_ivp

    problem = problem_of(motion.top)

    def sample(t: Array, limit: float) -> Run:
        slope, calls = counted(problem, limit)
        with warnings.catch_warnings(action="ignore"):  # a failure is in the message
            span = 0.0, float(t[-1])
            flow = solve_ivp(
                slope, span, problem.start, name, t_eval=t, rtol=tolerance, atol=tolerance
            )
        if not flow.success:
            raise ArithmeticError(flow.message)
        return Run(flow.y[2:], calls[0], np.transpose)

    return sample


def rk4(motion: Motion, per_period: int) -> Sample:
    """Return the classical Runge-Kutta method with equal steps between two times."""
    problem, period = problem_of(motion.top), float(motion.T_nutation or 1)

    def sample(t: Array, limit: float) -> Run:
        slope, calls = counted(problem, limit)

        def f(state: Array) -> Array:
            return np.array(slope(0.0, state))

        state, now, rows = problem.start, 0.0, []
        for end in t.tolist():
            count = steps_between(now, end, period / per_period)
            h = (end - now) / max(count, 1)
            for _ in range(count):
                k1 = f(state)
                k2 = f(state + h / 2 * k1)
                k3 = f(state + h / 2 * k2)
                state = state + h / 6 * (k1 + 2 * (k2 + k3) + f(state + h * k3))
            now = end
            rows.append(state[2:])
        return Run(np.array(rows), calls[0])

    return sample


def steps_between(start: float, end: float, longest: float) -> int:
    """Return the least number of equal steps between two times that are not too long."""
    return math.ceil((end - start) / longest * (1 - 1e-9))


def taylor(motion: Motion, tolerance: float) -> Sample:
    """Return heyoka's Taylor method, compiled for this top."""
    import heyoka

    heyoka.llvm_state.clear_memcache()  # so that each set-up compiles
    heyoka.llvm_state.set_diskcache_enabled(False)
    problem = problem_of(motion.top)
    names = heyoka.make_vars(*"pqwxyz")
    system = list(zip(names, problem.slope(0.0, names), strict=True))
    integrator = heyoka.taylor_adaptive(system, problem.start, tol=tolerance)

    def sample(t: Array, limit: float) -> Run:
        end = time.process_time() + limit
        integrator.time, integrator.state[:] = 0.0, problem.start
        rows, rest, steps = [np.empty((0, 6))], t, 0
        if t[0] == 0:
            rows, rest = [problem.start[None]], t[1:]
        while rest.size:
            grid = np.concatenate(([integrator.time], rest))
            outcome, _, _, some, _, found = integrator.propagate_grid(grid, max_steps=LOOKS)
            rows.append(np.array(found[1:]))
            rest, steps = rest[len(found) - 1 :], steps + some
            if outcome not in (heyoka.taylor_outcome.time_limit, heyoka.taylor_outcome.step_limit):
                raise ArithmeticError(f"heyoka stopped: {outcome}")
            if rest.size and time.process_time() > end:
                raise SlowError
        return Run(np.concatenate(rows)[:, 2:], steps * integrator.order)

    return sample


def mujoco(scheme: str, motion: Motion, per_period: int) -> Sample:
    """Return a body on a ball joint, by an integrator of MuJoCo with fixed steps.

    Its units are the mass of the top, the nutation period, and the length that makes A = 1.
    """
    import mujoco as engine

    top, problem, period = motion.top, problem_of(motion.top), float(motion.T_nutation or 1)
    m, A, C = float(top.m), float(top.A), float(top.C) / float(top.A)
    s = float(top.s) * math.sqrt(m / A)
    g = m * float(top.g) * float(top.s) / A / s * period**2
    if C > 2 * (1 - s * s):
        raise LagtopError("MuJoCo needs C <= 2 (A - m s^2)")
    model = engine.MjModel.from_xml_string(
        f"""<mujoco>
          <compiler balanceinertia="false"/>
          <option integrator="{scheme}" gravity="0 0 {-g!r}"/>
          <worldbody><body>
            <joint type="ball" damping="0"/>
            <inertial pos="0 0 {s!r}" mass="1" diaginertia="{1 - s * s!r} {1 - s * s!r} {C!r}"/>
          </body></worldbody>
        </mujoco>"""
    )
    data, warned = engine.MjData(model), list[str]()
    engine.set_mju_user_warning(warned.append)  # or else MuJoCo writes a file
    rates = np.array([*problem.start[:2], float(top.r0)]) * period

    def sample(t: Array, limit: float) -> Run:
        end = time.process_time() + limit
        warned.clear()
        engine.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = problem.start[2:], rates
        rows, now = np.empty((t.size, 4)), 0.0
        for row, then in zip(rows, (t / period).tolist(), strict=True):
            count = steps_between(now, then, 1 / per_period)
            if count:
                model.opt.timestep = (then - now) / count
                engine.mj_step(model, data, count)
            if warned:
                raise ArithmeticError(warned[0].strip())
            if time.process_time() > end:
                raise SlowError
            row[:], now = data.qpos, then
        return Run(rows)

    return sample


METHODS: dict[str, Method] = {
    "lagtop": Method(["angles", "quaternion"], lagtop),
    "scipy.special": Method(["double"], closed_form_in_doubles),
    "RK45": Method([1e-3, 1e-5, 1e-7, 1e-9], partial(scipy_method, "RK45")),
    "DOP853": Method([1e-4, 1e-7, 1e-10, TIGHTEST], partial(scipy_method, "DOP853")),
    "LSODA": Method([1e-4, 1e-7, 1e-10, 1e-12], partial(scipy_method, "LSODA")),
    "Radau": Method([1e-3, 1e-5, 1e-7], partial(scipy_method, "Radau")),
    "Taylor": Method([1e-5, 1e-8, 1e-12, 1e-16], taylor, "heyoka"),
    "RK4": Method([50, 200, 800], rk4, has_fixed_steps=True),
    "MuJoCo-RK4": Method([50, 200, 800], partial(mujoco, "RK4"), "mujoco", has_fixed_steps=True),
    "MuJoCo-Euler": Method(
        [200, 800, 3200], partial(mujoco, "Euler"), "mujoco", has_fixed_steps=True
    ),
}
