"""The methods that `bench` and `stability` compare.

A new method is one entry in METHODS: its settings, and a function of a motion and a setting.  That
function makes the set-up, and returns a function that computes the attitudes at increasing times.
Integrators solve Euler's equations for p, q and the quaternion, which are singular nowhere.  Rates
are in the units of the scene, and a tolerance is both the relative and the absolute one.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.rotations import of_angles
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inverse.motions import angles
from ..solver.solve import Motion, solve

TIGHTEST = 3e-14
"""Least relative tolerance that SciPy accepts."""
LOOKS = 20_000
"""Steps of heyoka between two looks at the clock."""


class SlowError(Exception):
    """A run has exceeded its limit of CPU time."""


Sampled = tuple[Sequence[Array] | Array, int | None]
"""The columns theta, phi and psi, or the quaternion w, x, y, z from body to space; and the number
of evaluations of the right-hand side (of Taylor's method, its steps times its order)."""
Sample = Callable[[Array, float], Sampled]
"""A function of increasing times and of a limit of CPU seconds.

It may raise SlowError, or ArithmeticError if the method fails.
"""
Slope = Callable[[float, Any], list[Any]]
"""The derivative of p, q (body axes) and of the quaternion, from time and state."""


class Method(NamedTuple):
    """A way to compute attitudes, with the settings at which `bench` runs it."""

    settings: Sequence[Any]
    prepare: Callable[[Motion, Any], Sample]
    """The set-up.  It may raise ImportError, or LagtopError for a top that the method refuses."""
    has_fixed_steps: bool = False
    """Whether steps have one length, which divides the gaps between the times."""


def problem_of(motion: Motion) -> tuple[Array, Slope]:
    """Return the initial state (p, q, w, x, y, z) and Euler's equations, in doubles."""
    top, a, b, r0 = motion.top, float(motion.a), float(motion.b), float(motion.top.r0)
    sine, _, half_sine, half_cosine = top.exact_tilt.doubles()
    twist, rates = r0 - b, (float(top.thetadot0), float(top.psidot0) * sine)

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

    return np.array([*rates, half_cosine, half_sine, 0.0, 0.0]), slope


def counted(slope: Slope, limit: float) -> tuple[Callable[[float, Array], Array], list[int]]:
    """Return the slope with a limit of CPU seconds, and a list whose element counts its calls."""
    end, calls = time.process_time() + limit, [0]

    def watched(t: float, state: Array) -> Array:
        calls[0] += 1
        if calls[0] % 256 == 0 and time.process_time() > end:
            raise SlowError
        return np.array(slope(t, state.tolist()))

    return watched, calls


def attitudes(columns: Sequence[Array] | Array) -> Array:
    """Return the quaternions, of shape (times, 4), from the columns of a run."""
    return of_angles(*columns) if len(columns) == 3 else np.stack([*columns], axis=1)


def lagtop(motion: Motion, output: str) -> Sample:
    """Return lagtop in doubles: the three angles of `Motion.angles`, or the quaternion."""
    fresh = solve(motion.top)
    fresh.sampler()
    if output == "angles":
        return lambda t, _: (fresh.angles(t), None)
    return lambda t, _: ([*fresh.table(t, ["quaternion"]).values()], None)


def scipy_special(motion: Motion, __: Any) -> Sample:
    """Return the closed form in plain doubles, by SciPy's elliptic functions, as `fit` uses it.

    It subtracts no close numbers.  What it cannot do: next to the unstable upright position the
    rounding of m = k^2, which `ellipj` takes, remains; and errors grow with time.
    """
    (start, _), a, b = problem_of(motion), float(motion.a), float(motion.b)
    state, twist = np.array([[a, b, start[3], start[2], *start[:2]]]), float(motion.top.r0) - b

    def sample(t: Array, _: float) -> Sampled:
        theta, phi, psi = angles(state, t)[:, 0]
        return [theta, phi + twist * t, psi], None

    return sample


def scipy_method(name: str, motion: Motion, tolerance: float) -> Sample:
    """Return a method of SciPy's solve_ivp, with its own interpolation between the steps."""
    from scipy.integrate import solve_ivp

    start, equations = problem_of(motion)

    def sample(t: Array, limit: float) -> Sampled:
        slope, calls = counted(equations, limit)
        with warnings.catch_warnings(action="ignore"):  # a failure is in the message
            flow = solve_ivp(slope, (0.0, t[-1]), start, name, t, rtol=tolerance, atol=tolerance)
        if not flow.success:
            raise ArithmeticError(flow.message)
        return flow.y[2:], calls[0]

    return sample


def fixed_steps(times: Array, longest: float) -> Iterator[tuple[int, float]]:
    """Yield the number and length of equal steps from 0 to the first time, and so on."""
    for gap in np.diff(times, prepend=0.0).tolist():
        count = math.ceil(gap / longest * (1 - 1e-9))
        yield count, gap / max(count, 1)


def rk4(motion: Motion, per_period: int) -> Sample:
    """Return the classical Runge-Kutta method with equal steps between two times."""
    (start, equations), period = problem_of(motion), float(motion.T_nutation or 1)

    def sample(t: Array, limit: float) -> Sampled:
        (f, calls), state, rows = counted(equations, limit), start, []
        for count, h in fixed_steps(t, period / per_period):
            for _ in range(count):
                k1 = f(0.0, state)
                k2 = f(0.0, state + h / 2 * k1)
                k3 = f(0.0, state + h / 2 * k2)
                state = state + h / 6 * (k1 + 2 * (k2 + k3) + f(0.0, state + h * k3))
            rows.append(state[2:])
        return np.array(rows).T, calls[0]

    return sample


def taylor(motion: Motion, tolerance: float) -> Sample:
    """Return heyoka's Taylor method, compiled for this top."""
    import heyoka

    heyoka.llvm_state.clear_memcache()  # so that each set-up compiles
    heyoka.llvm_state.set_diskcache_enabled(False)
    start, slope = problem_of(motion)
    fine = heyoka.taylor_outcome.time_limit, heyoka.taylor_outcome.step_limit
    names = heyoka.make_vars(*"pqwxyz")
    system = list(zip(names, slope(0.0, names), strict=True))
    integrator = heyoka.taylor_adaptive(system, start, tol=tolerance)

    def sample(t: Array, limit: float) -> Sampled:
        end, steps = time.process_time() + limit, 0
        integrator.time, integrator.state[:] = 0.0, start
        rows, rest = [start[None]], t[t > 0]
        while rest.size:
            if time.process_time() > end:
                raise SlowError
            grid = np.concatenate(([integrator.time], rest))
            outcome, _, _, some, _, found = integrator.propagate_grid(grid, max_steps=LOOKS)
            if outcome not in fine:
                raise ArithmeticError(f"heyoka stopped: {outcome}")
            rows.append(np.array(found[1:]))
            rest, steps = rest[len(found) - 1 :], steps + some
        return np.concatenate(rows)[-t.size :, 2:].T, steps * integrator.order

    return sample


def mujoco(scheme: str, motion: Motion, per_period: int) -> Sample:
    """Return a body on a ball joint, by an integrator of MuJoCo with fixed steps.

    Its units are the mass of the top, the nutation period, and the length that makes A = 1.
    """
    import mujoco as engine

    top, period, (start, _) = motion.top, float(motion.T_nutation or 1), problem_of(motion)
    s, C = float(top.s) * math.sqrt(float(top.m) / float(top.A)), float(top.C) / float(top.A)
    g = float(motion.a) / 2 / s * period**2
    if C > 2 * (1 - s * s):
        raise LagtopError("MuJoCo needs C <= 2 (A - m s^2)")
    model = engine.MjModel.from_xml_string(
        f"""<mujoco><compiler balanceinertia="false"/>
          <option integrator="{scheme}" gravity="0 0 {-g!r}"/>
          <worldbody><body><joint type="ball"/>
            <inertial pos="0 0 {s!r}" mass="1" diaginertia="{1 - s * s!r} {1 - s * s!r} {C!r}"/>
          </body></worldbody></mujoco>"""
    )
    data, warned = engine.MjData(model), list[str]()
    engine.set_mju_user_warning(warned.append)  # or else MuJoCo writes a file
    rates = np.array([*start[:2], float(top.r0)]) * period

    def sample(t: Array, limit: float) -> Sampled:
        end, rows = time.process_time() + limit, []
        warned.clear()
        engine.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = start[2:], rates
        for count, h in fixed_steps(t / period, 1 / per_period):
            if count:
                model.opt.timestep = h
                engine.mj_step(model, data, count)
            if warned:
                raise ArithmeticError(warned[0].strip())
            if time.process_time() > end:
                raise SlowError
            rows.append(data.qpos.copy())
        return np.array(rows).T, None

    return sample


METHODS: dict[str, Method] = {
    "lagtop": Method(["angles", "quaternion"], lagtop),
    "scipy.special": Method(["double"], scipy_special),
    "RK45": Method([1e-3, 1e-5, 1e-7, 1e-9], partial(scipy_method, "RK45")),
    "DOP853": Method([1e-4, 1e-7, 1e-10, TIGHTEST], partial(scipy_method, "DOP853")),
    "LSODA": Method([1e-4, 1e-7, 1e-10, 1e-12], partial(scipy_method, "LSODA")),
    "Radau": Method([1e-3, 1e-5, 1e-7], partial(scipy_method, "Radau")),
    "Taylor": Method([1e-5, 1e-8, 1e-12, 1e-16], taylor),
    "RK4": Method([50, 200, 800], rk4, True),
    "MuJoCo-RK4": Method([50, 200, 800], partial(mujoco, "RK4"), True),
    "MuJoCo-Euler": Method([200, 800, 3200], partial(mujoco, "Euler"), True),
}
