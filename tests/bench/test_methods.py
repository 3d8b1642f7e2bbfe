"""Each method against the exact motion, SciPy's rows by equations of their own, the reference."""

from __future__ import annotations

import math
import random
import sys
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from engines import Body
from lagtop import LagtopError, Top, solve
from scipy.integrate import solve_ivp

from lagrange_cli.bench.hard_scenes import NUTATING_KINDS, nutating
from lagrange_cli.bench.measure import measure, task_of
from lagrange_cli.bench.methods import METHODS, Sampled, SlowError, fixed_steps
from lagrange_cli.bench.reference import Reference, rotation_angle
from lagrange_cli.bench.stability import motions
from lagrange_cli.bench.work_precision import bench
from lagrange_cli.solver.tables import ProvedTable

START = {"m": 1.2, "A": 0.03, "C": 0.02, "s": 0.1, "g": 9.81}
START |= {"r0": 40.0, "theta0_deg": 50.0, "thetadot0": -2.0, "psidot0": 3.0}
MOTION = solve(Top(**START))
ERRORS = {
    **{"lagtop": 2e-15, "scipy.special": 1e-13, "Taylor": 1e-13, "DOP853": 1e-11},
    **{"RK45": 1e-5, "LSODA": 1e-8, "Radau": 1e-4, "RK4": 1e-6, "MuJoCo-RK4": 1e-6},
    "MuJoCo-Euler": 3.2,
}
"""The greatest errors (rad) at the tightest settings over three periods."""
PACKAGES = {"Taylor": "heyoka", "MuJoCo-RK4": "mujoco", "MuJoCo-Euler": "mujoco"}


def run(name: str, setting: Any, times: Any, limit: float = 60.0) -> Sampled:
    """Return the run of a method in the scene of this file."""
    pytest.importorskip(PACKAGES.get(name, "numpy"))
    return METHODS[name].prepare(MOTION, setting)(times, limit)


@pytest.mark.parametrize("name", METHODS)
def test_the_tightest_setting_agrees_with_the_reference(name: str) -> None:
    pytest.importorskip(PACKAGES.get(name, "numpy"))
    found = measure(task_of("scene", MOTION, 3, 8), name, METHODS[name].settings[-1], 60.0, 1)
    assert 0 < (found.error_rad or 0) < ERRORS[name]


@pytest.mark.parametrize("name", ["RK4", "MuJoCo-RK4"])
def test_fixed_steps_converge_with_order_4(name: str) -> None:
    task = task_of("scene", MOTION, 2.3, 24)
    pytest.importorskip(PACKAGES.get(name, "numpy"))
    coarse, fine = (measure(task, name, x, runs=1).error_rad or 0.0 for x in (100, 200))
    assert math.log2(coarse / fine) == pytest.approx(4, abs=0.5)


def test_fixed_steps_divide_the_gaps_between_times() -> None:
    times = np.array([0.0, 0.05, 0.15, 0.25001, 1.25001])
    steps = list(fixed_steps(times, 0.1))
    assert [count for count, _ in steps] == [0, 1, 1, 2, 10]
    assert np.cumsum([count * h for count, h in steps]) == pytest.approx(times)
    counts = [count for count, _ in fixed_steps(times, float(MOTION.T_nutation or 0) / 50)]
    assert run("RK4", 50, times)[1] == 4 * sum(counts)


@pytest.mark.parametrize("name", ["DOP853", "Radau", "RK4", "Taylor"])
def test_a_run_that_takes_too_long_is_ended(name: str) -> None:
    with pytest.raises(SlowError):
        run(name, METHODS[name].settings[-1], np.linspace(0, 5000, 10), 0.0)


def test_mujoco_refuses_a_body_without_a_shape() -> None:
    pytest.importorskip("mujoco")
    flat = solve(Top(**START | {"A": 0.0121}))
    with pytest.raises(LagtopError, match="MuJoCo needs"):
        METHODS["MuJoCo-RK4"].prepare(flat, 50)


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "heyoka", None)
    report = bench({"scene": MOTION}, ["lagtop", "Taylor"], count=3)
    remedy = "pip install '.[bench]' in the folder of lagtop"
    assert f"Not compared: Taylor (not installed: {remedy})." in report.conclusions


@pytest.mark.parametrize(
    ("kind", "error"),
    [
        *(("fast-spin", 1e-12), ("slow-spin", 1e-12), ("near-separatrix", 1e-3)),
        *(("near-vertical", 1e-7), ("tiny-tilt-with-rates", 1e-12), ("near-steady", 1e-12)),
        *(("near-hanging", 1e-12), ("extreme-sizes", 1e-12)),
    ],
)
def test_the_closed_form_in_plain_doubles_is_fair(kind: str, error: float) -> None:
    """After 100 periods only the phase is off, but next to the unstable upright position."""
    tasks = [task_of(kind, x, 97.0, 9) for x in motions(kind, 1, 1952)]
    found = max(measure(x, "scipy.special", "double", runs=1).error_rad or 9.0 for x in tasks)
    assert found <= error


@pytest.mark.parametrize("name", ["RK45", "DOP853", "LSODA"])
def test_scipy_runs_as_in_a_plain_call(name: str) -> None:
    body, times = Body.of(MOTION.top), np.linspace(0, 1.5, 30)
    plain = solve_ivp(
        lambda _, y: body.slope(y), (0, 1.5), body.state, name, times, rtol=1e-7, atol=1e-7
    )
    assert run(name, 1e-7, times)[1] == pytest.approx(plain.nfev, rel=0.05)


# The reference in 50 digits, and the definition of error


@pytest.mark.parametrize("kind", [*NUTATING_KINDS, "generic by phidot0"])
def test_attitudes_agree_with_the_reference(kind: str) -> None:
    """Legendre's third integral from the lowest point, and theta functions from the highest."""
    kind, _, spin = kind.partition(" by ")
    scene = nutating(kind, random.Random(2))
    top = Top(**({spin: scene.pop("r0")} if spin else {}), **scene)
    reference = Reference(top)
    t = 3.7 * float(reference.T)
    row = ProvedTable(solve(top), ["quaternion"], 40).row(Fraction(t))
    assert rotation_angle([x.value for x in row], reference.attitude(t)) < 1e-20


def test_the_error_is_the_angle_of_a_rotation() -> None:
    turned = [math.cos(5e-13), 0.0, math.sin(5e-13), 0.0]
    start = tuple(map(mpmath.mpf, (1, 0, 0, 0)))
    assert rotation_angle(turned, start) == pytest.approx(1e-12, rel=1e-12)
    assert rotation_angle([-2 * x for x in turned], start) == pytest.approx(1e-12, rel=1e-12)
    assert rotation_angle([0.0, 1.0, 0.0, 0.0], start) == pytest.approx(math.pi)
    assert rotation_angle([math.nan, 1.0, 0.0, 0.0], start) == math.inf
    assert rotation_angle(start, start) == 0
