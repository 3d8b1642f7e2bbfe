"""Angles of many tops at once: as exact as those of one, and by arrays wherever that is safe."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from ball_judge import Judge
from exact_scenes import KINDS
from fuzz import inputs_of, period_of, times_of
from hard_scenes import in_doubles
from lagtop import LagtopError, Top, solve, sweep_angles

from lagrange_cli.sweep import angles

RNG = np.random.default_rng(14)
COUNT = 100
AT_REST: dict[str, Any] = {
    "r0": RNG.uniform(-100, 100, COUNT),
    "theta0_deg": RNG.uniform(1, 179, COUNT),
}
MOVING: dict[str, Any] = AT_REST | {
    "psidot0": RNG.uniform(-5, 5, COUNT),
    "thetadot0": RNG.uniform(-5, 5, COUNT),
}
T = np.array([-30.0, -0.1, 0.0, 1e-3, 2.0, 40.0])


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> list[Top]:
    """Collect the tops that are left to `solve`."""
    tops: list[Top] = []

    def solved(top: Top) -> Any:
        tops.append(top)
        return solve(top)

    monkeypatch.setattr(angles, "solve", solved)
    return tops


def top_of(inputs: dict[str, Any], i: int) -> Top:
    return Top(**{name: float(values[i]) for name, values in inputs.items()})


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_hard_scenes_against_balls(kind: str) -> None:
    """Worst of 720 other scenes: 3.7 units, without spin."""
    rng = random.Random(f"many {kind}")
    scenes = [in_doubles(KINDS[kind](rng)) for _ in range(6)]
    judges = []
    for scene in scenes:
        try:
            judges.append((scene, Judge(Top(**scene).as_dict())))
            solve(Top(**scene))
        except LagtopError:
            judges.pop()
    times = [times_of(rng, period_of(judge), 4) for _, judge in judges]
    inputs: dict[str, Any] = inputs_of(judges)
    found: dict[str, Any] = sweep_angles(times, **inputs)
    for i, (_, judge) in enumerate(judges):
        assert found["error"][i] is None
        for j in range(0, len(times[i]), 3):
            computed = (found["theta"][i, j], found["phi"][i, j], found["psi"][i, j])
            assert max(judge.angle_errors(times[i][j], computed)) <= 4


@pytest.mark.parametrize("wrap", [False, True])
@pytest.mark.parametrize("inputs", [AT_REST, MOVING], ids=["at rest", "moving"])
def test_ordinary_tops_are_computed_as_arrays(
    inputs: dict[str, Any], wrap: bool, alone: list[Top]
) -> None:
    found: dict[str, Any] = sweep_angles(T, wrap=wrap, **inputs)
    assert not alone
    assert set(found["error"]) == {None}
    for i in range(0, COUNT, 7):
        for name, exact in solve(top_of(inputs, i)).angles(T, wrap=wrap)._asdict().items():
            away = np.abs(found[name][i] - exact)
            assert (away <= 4e-14 + 4e-16 * np.abs(exact)).all()


def test_far_times_and_hard_tops_are_left_to_solve(alone: list[Top]) -> None:
    period = solve(Top()).T_nutation
    far: dict[str, Any] = sweep_angles([period * 2.0**49], r0=50)
    assert alone == [Top()]
    assert far["phi"][0] == solve(Top()).angles(period * 2.0**49).phi
    hard: dict[str, Any] = {
        "theta0_deg": [0, 180, 30, 30, 0],
        "r0": [9, 9, 0, 50, 9],
        "g": [1, 1, 1, 0, 1],
    }
    more: dict[str, Any] = sweep_angles(T, **hard, thetadot0=[0, 0, 0, 0, 3])
    assert len(alone) == 6
    assert set(more["error"]) == {None}
    assert np.isfinite(more["psi"]).all()


def test_shapes() -> None:
    one: dict[str, Any] = sweep_angles(T, r0=40)
    assert (one["phi"].shape, one["error"].shape) == ((6,), ())
    assert sweep_angles(0.5, r0=[40, 50])["phi"].shape == (2,)
    grid: dict[str, Any] = sweep_angles(T, r0=np.full((2, 3), 40), theta0_deg=[20, 30, 40])
    assert (grid["psi"].shape, grid["error"].shape) == ((2, 3, 6), (2, 3))
    own: dict[str, Any] = sweep_angles(np.array([T, 2 * T]), r0=[40, 50])
    np.testing.assert_array_equal(own["phi"][1], sweep_angles(2 * T, r0=50)["phi"])
    assert sweep_angles([], r0=[40, 50])["phi"].shape == (2, 0)
    assert sweep_angles(T, r0=[])["phi"].shape == (0, 6)


@pytest.mark.parametrize("count", [1, 16384, 16385, 40_000])
def test_long_lists_of_times(count: int) -> None:
    t = np.linspace(0, 5, count)
    found: dict[str, Any] = sweep_angles(t, r0=[40, 200])
    for i, r0 in enumerate((40, 200)):
        np.testing.assert_allclose(found["phi"][i], solve(Top(r0=r0)).angles(t).phi, atol=1e-12)


def test_bad_input() -> None:
    found: dict[str, Any] = sweep_angles([0.0, 1.0], r0=[40, np.nan, 40], m=[1, 1, -1])
    assert found["error"][0] is None
    assert "r0 must be" in found["error"][1]
    assert "m must be" in found["error"][2]
    assert np.isnan(found["theta"][1:]).all()
    times: dict[str, Any] = sweep_angles([0.0, np.inf], r0=[40])
    assert str(times["error"][0]).startswith("t must be finite")
    with pytest.raises(LagtopError, match=r"shape \(2, n\) or \(n,\), got \(3, 4\)"):
        sweep_angles(np.zeros((3, 4)), r0=[1, 2])
    with pytest.raises(LagtopError, match="inputs must be among"):
        sweep_angles(T, speed=3)
