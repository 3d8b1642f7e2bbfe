"""The times at which pictures sample a motion, and the facts about it that they use."""

from __future__ import annotations

import ast
import math
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from lagtop import LagtopError, Top, solve
from pictures import NUTATING, REGIMES, regime_motion, sample_motion

from lagrange_cli.arithmetic.types import Array
from lagrange_cli.plot.curves import (
    checked_span,
    phase_times,
    refined,
    sampled_columns,
    span,
    tilt_period,
    turn_span,
)
from lagrange_cli.plot.sphere import axis_path


@pytest.mark.parametrize("path", NUTATING, ids=lambda path: path.stem)
def test_the_path_is_on_the_sphere_and_touches_both_circles(path: Path) -> None:
    scene = sample_motion(path)
    course = axis_path(scene, turn_span(scene))
    tilt = np.arctan2(np.hypot(course.axis[:, 0], course.axis[:, 1]), course.axis[:, 2])
    assert np.abs(np.linalg.norm(course.axis, axis=1) - 1).max() < 1e-15 * 4
    assert tilt.min() == pytest.approx(course.least, abs=1e-14)
    assert tilt.max() == pytest.approx(course.greatest, abs=1e-14)
    assert (np.diff(course.t) > 0).all()


@pytest.mark.parametrize("path", NUTATING, ids=lambda path: path.stem)
def test_the_path_is_smooth(path: Path) -> None:
    """No corner of the polygon is sharp but the cusps: what is drawn is the curve."""
    scene = sample_motion(path)
    course = axis_path(scene, span(scene, 2))
    steps = np.diff(course.axis, axis=0)
    size = np.linalg.norm(steps, axis=1)
    assert size.max() < 0.06
    turn = np.sum(steps[1:] * steps[:-1], axis=1) / (size[1:] * size[:-1])
    T = tilt_period(scene)
    assert T
    away = np.abs(course.t[1:-1] / T - np.round(course.t[1:-1] / T)) > 0.02
    seen = np.minimum(size[1:], size[:-1]) > 2e-3  # smaller ones are not visible
    assert turn[away & seen].min(initial=1.0) > math.cos(math.radians(15))


@pytest.mark.parametrize("sign", [1, -1])
def test_cusps_point_up_and_loops_turn_back(sign: int) -> None:
    cusped = solve(Top(r0=sign * 50.0))
    T = tilt_period(cusped)
    assert T
    course = axis_path(cusped, 2 * T)
    i = int(np.argmin(np.abs(course.t - T)))
    assert course.t[i] == pytest.approx(T, abs=1e-15)
    before, cusp, after = course.axis[i - 1 : i + 2]
    assert before[2] < cusp[2] > after[2]
    into, out = cusp - before, after - cusp
    assert into @ out / np.linalg.norm(into) / np.linalg.norm(out) < -0.99  # it turns on the spot
    looping = solve(Top(r0=sign * 50.0, psidot0=sign * -4.0))
    psi = sampled_columns(looping, T, ["psi"])["psi"] * sign
    assert np.diff(psi).min() < 0 < np.diff(psi).max()


def test_samples_are_even_in_the_amplitude_and_hold_the_turning_points() -> None:
    scene = solve(Top(r0=0.5, theta0_deg=20.0))
    T = tilt_period(scene)
    assert T
    t = phase_times(scene, 2 * T)
    for turning in (0.0, T / 2, T, 1.5 * T, 2 * T):
        assert np.abs(t - turning).min() < 1e-15
    u = scene.table(t, ["u"])["u"]
    assert np.abs(np.diff(u)).max() < 0.08  # evenly spaced times would leave gaps of 0.09 and more
    even = scene.table(np.linspace(0, 2 * T, t.size), ["u"])["u"]
    assert np.abs(np.diff(even)).max() > np.abs(np.diff(u)).max()


@pytest.mark.parametrize("name", REGIMES)
def test_the_tilt_comes_back_after_a_period_if_it_has_one(name: str) -> None:
    scene = regime_motion(name)
    T, tilts = tilt_period(scene), (scene.theta_min_deg, scene.theta_max_deg)
    steady = "sleeping", "hanging", "torque-free", "separatrix", "steady precession"
    assert (T is None) == (name in steady)
    if T is None:
        return
    assert scene.phase is not None
    first = -scene.phase * T
    theta = np.degrees(scene.angles(first + T * np.array([0.0, 0.5, 1.0])).theta)
    assert theta == pytest.approx([tilts[0], tilts[1], tilts[0]], abs=1e-7)


def test_points_are_added_where_a_curve_is_steep_but_not_for_ever() -> None:
    t = np.linspace(0.0, 1.0, 41)

    def leap(t: Array) -> Array:
        return np.where(t < 0.5, 0.0, 1.0)[:, None] * np.ones(2)

    def step(t: Array) -> Array:
        return np.stack([t, np.tanh(6 * (t - 0.5))], axis=1)

    fine = refined(t, step)
    assert set(t) < set(fine)
    assert np.abs(np.diff(step(fine), axis=0) / np.ptp(step(fine), axis=0)).max() <= 0.02
    assert refined(t, leap).size < 16 * t.size


def test_a_span_of_too_many_periods_is_refused() -> None:
    scene = solve(Top())
    assert checked_span(scene, None) is None
    assert checked_span(scene, 429) == 429.0
    for t_max, message in ((0, "t_max must be > 0, got 0"), (430, "t_max must be at most 1000")):
        with pytest.raises(LagtopError, match=message) as error:
            checked_span(scene, t_max)
        assert error.value.key == "t_max"


def test_pictures_ask_a_motion_only_what_everybody_sees() -> None:
    seen = {"solve", "record", "quantity", "regime", "uncertainty"}
    for path in (ROOT / "lagrange_cli" / "plot").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("motion."):
                assert str(node.module).removeprefix("motion.") in seen, path
