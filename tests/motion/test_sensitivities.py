"""Exact derivatives against those of the judge, which are differences in 800 bits (`slopes`)."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from lagtop import LagtopError, Top, angle_sensitivities, sensitivities, solve
from scenes import EPS, EVERY_KIND, UNIT
from slopes import Slopes

SCENES: dict[str, dict[str, float]] = {
    **{x: EVERY_KIND[x] for x in ("worked example", "slow", "any start", "starts lowest")},
    "from rest, fast": UNIT | {"r0": -900, "theta0_deg": 40},
    "from rest, tiny tilt": UNIT | {"r0": 2, "theta0_deg": 1e-9},
    "in radians": UNIT | {"r0": -3, "theta0_rad": 2, "thetadot0": -1.5, "psidot0": 1},
    "nearly steady": UNIT | {"r0": 1.5, "theta0_deg": 60, "psidot0": 2 + 1e-13},
    "nearly at rest": {"thetadot0": 1e-12, "psidot0": -1e-12},
    "near the separatrix": UNIT
    | {"m": 0.5, "r0": 0.75, "theta0_deg": 60, "psidot0": 0.5 + 1e-9, "thetadot0": 0.559016994},
    "near a pole": UNIT | {"r0": 2, "theta0_deg": 90, "psidot0": 2 + 1e-9, "thetadot0": 1},
    "extreme": {"m": 1e20, "A": 1e-9, "C": 1e-10, "s": 1e-9, "g": 1e-8, "psidot0": 1e3},
    "very fast": {"r0": 1e18, "thetadot0": 1e3},
    "very slow": {"r0": 1e-12, "thetadot0": 1e-9, "psidot0": 1e-9},
    "hardly tilted": {"theta0_deg": 1e-12, "thetadot0": 1e-11, "psidot0": 1},
    "nearly upright for long": UNIT
    | {"r0": 0, "theta0_deg": 90, "thetadot0": 2**0.5, "psidot0": 1e-9},
    "threshold of sleeping": UNIT | {"r0": 2, "theta0_deg": 1e-6},
    "spherical pendulum": UNIT | {"r0": 0, "theta0_deg": 70, "psidot0": 0.5},
    "cancelling": UNIT | {"C": 5e-6, "r0": 2, "theta0_deg": 130, "thetadot0": 2.2e9},
}
DEGENERATE: dict[str, dict[str, float]] = {
    **{x: EVERY_KIND[x] for x in ("sleeping", "hanging")},
    "torque-free": UNIT
    | {"C": 0.5, "g": 0, "r0": 3, "theta0_deg": 50, "psidot0": 1, "thetadot0": 0.5},
    "steady": UNIT | {"r0": 1.5, "theta0_deg": 60, "psidot0": 2},
    "plane pendulum": UNIT | {"r0": 0, "theta0_deg": 70},
    "over the top": UNIT | {"r0": 3, "theta0_deg": 90, "psidot0": 3, "thetadot0": 2},
    "over the bottom": UNIT | {"r0": -3, "theta0_deg": 90, "psidot0": 3, "thetadot0": 2},
    "from the top": UNIT | {"r0": 3, "theta0_deg": 0, "thetadot0": 2},
    "separatrix": UNIT
    | {"m": 3.25, "r0": -2.25, "theta0_deg": 60, "thetadot0": -1.25, "psidot0": -1.5},
    "free and steady": UNIT | {"C": 0.5, "g": 0, "r0": 3, "theta0_deg": 50},
}


QUICK = ["any start", "steady"]


def quick(scenes: Iterable[str]) -> list[Any]:
    """Return scenes as parameters, slow but for some."""
    marks = {scene: () if scene in QUICK else pytest.mark.slow for scene in scenes}
    return [pytest.param(scene, marks=mark) for scene, mark in marks.items()]


@pytest.mark.parametrize("scene", quick([*SCENES, *DEGENERATE]))
def test_derivatives_of_the_record_are_right_to_the_last_bit(scene: str) -> None:
    """All of 60 000 in hard scenes were the nearest double; where there is none there is a kink."""
    top = Top(**(SCENES | DEGENERATE)[scene])
    judge, found, record = Slopes(top), sensitivities(top), solve(top).numbers()
    compared = 0
    for key, row in found.derivatives.items():
        for name, derivative in row.items():
            sides = judge.of_key(name, key)
            if math.isnan(derivative):
                assert key in found.reasons
                assert sides is None or scene in DEGENERATE, (key, name, sides)
            elif sides is not None:
                middle = (sides[0] + sides[1]) / 2
                judged = 1e-30 if top.pole else 1e-46  # on an edge differences are one-sided
                slack = EPS * abs(middle) + judged * abs(record[key] or 0)
                assert abs(derivative - middle) <= slack, (key, name, derivative, sides)
                curved = 1e-6 * (abs(middle) + abs(record[key] or 0))
                assert abs(sides[0] - sides[1]) <= curved, (key, name, sides)
                compared += 1
    assert compared > (200 if scene in SCENES else 25)


def test_what_has_a_kink_says_so() -> None:
    top = Top(**DEGENERATE["steady"])
    found = sensitivities(top, ["theta_max_deg", "T_nutation"])
    assert math.isnan(found.derivatives["theta_max_deg"]["r0"])
    assert found.reasons == {
        "theta_max_deg": "theta_max_deg has a kink: next to a steady precession the axis nutates"
    }
    behind, ahead = Slopes(top).of_key("r0", "theta_max_deg") or (0, 0)
    assert abs(behind - ahead) > 1


def test_a_pendulum_that_turns_over_has_derivatives() -> None:
    """The axis passes over both poles, where the judge of the others decides nothing."""
    top = Top(**UNIT | {"r0": 0, "theta0_deg": 160, "thetadot0": 3})
    found = sensitivities(top).derivatives
    ahead, behind = (solve(top.replace(thetadot0=3 + side * 1e-5)).T_nutation for side in (1, -1))
    assert found["T_nutation"]["thetadot0"] == pytest.approx((ahead - behind) / 2e-5, rel=1e-8)
    assert found["theta_max_deg"]["m"] == 0.0
    assert math.isnan(found["mean_spin_rate"]["r0"])


def test_a_top_without_torque_that_stands_still_has_no_means() -> None:
    """Whatever is given to it turns it over both poles."""
    found = sensitivities(Top(**UNIT | {"s": 0, "r0": 0, "theta0_deg": 26}))
    assert math.isnan(found.derivatives["mean_precession_rate"]["psidot0"])
    assert found.derivatives["mean_spin_rate"]["r0"] == 1.0
    assert found.derivatives["a"]["s"] == 2.0


def test_without_torque_and_spin_over_the_poles_the_means_have_no_derivatives() -> None:
    top = Top(**UNIT | {"g": 0, "r0": 0, "theta0_deg": 0, "thetadot0": 2})
    found = sensitivities(top).derivatives
    assert math.isnan(found["mean_spin_rate"]["r0"])
    assert found["T_nutation"]["thetadot0"] == -math.pi / 2  # T = 2 pi/theta'


@pytest.mark.parametrize("tilt", [0, 180])
@pytest.mark.parametrize("r0", [0, 3])
def test_without_torque_on_the_vertical_a_depends_on_gravity(tilt: float, r0: float) -> None:
    top = Top(**UNIT | {"C": 0.5, "g": 0, "r0": r0, "theta0_deg": tilt})
    assert sensitivities(top, ["a"]).derivatives["a"]["g"] == 2.0


@pytest.mark.parametrize(
    "start",
    [
        {"r0": 3, "theta0_deg": 0, "thetadot0": 2},
        {"r0": 3, "theta0_deg": 180, "thetadot0": 2},
        {"r0": -3, "theta0_deg": 90, "thetadot0": 1, "psidot0": 3},
        {"r0": 0, "theta0_deg": 31, "thetadot0": 2},
    ],
)
def test_without_torque_over_a_pole_angles_have_derivatives_but_by_it(
    start: dict[str, float],
) -> None:
    """Angles of such a top ended in a division by zero."""
    top = Top(**UNIT | {"g": 0} | start)
    found, judge = angle_sensitivities(top, [0.5], ["g", "thetadot0"]), Slopes(top)
    for angle in ("theta", "phi", "psi"):
        by_g, by_rate = getattr(found, angle)[0]
        assert math.isnan(by_g)
        sides = judge.of_angle("thetadot0", angle, 0.5) or (math.nan, math.nan)
        assert by_rate == pytest.approx(sum(sides) / 2, abs=1e-12)


PLANE: dict[str, dict[str, float]] = {
    "to and fro": {"theta0_deg": 90, "thetadot0": 2**0.5 * (1 - 1e-13)},
    "round": {"theta0_deg": 90, "thetadot0": 2**0.5 * (1 + 1e-13)},
    "from the bottom": {"theta0_deg": 180, "thetadot0": 2 * (1 - 1e-13)},
    "round from the bottom": {"theta0_deg": 180, "thetadot0": 2 * (1 + 1e-13)},
    "from rest": {"theta0_deg": 1e-6},
}


@pytest.mark.parametrize("scene", PLANE)
def test_derivatives_in_a_plane_are_those_of_the_tilt(scene: str) -> None:
    """Spin and precession leap, and no input of the plane moves them: it was noise, up to 64."""
    top = Top(**UNIT | {"r0": 0} | PLANE[scene])
    period = solve(top).T_nutation
    times, inputs = [0.3 * period, -1.6 * period, 1e6 * period], ["m", "A", "thetadot0"]
    found, judge = angle_sensitivities(top, times, inputs), Slopes(top)
    assert not found.phi.any()
    assert not found.psi.any()
    for t, row in zip(times, found.theta.tolist(), strict=True):
        exact = [sum(judge.of_angle(name, "theta", t) or (math.nan,)) / 2 for name in inputs]
        size = 1 + max(map(abs, exact))
        assert max(abs(x - y) for x, y in zip(row, exact, strict=True)) < 1e-12 * size


def test_what_does_not_depend_on_an_input_has_the_derivative_0() -> None:
    """After release from rest psi'(T/2) = a/b = 2mgs/(C r0), whatever the tilt and A are."""
    row = sensitivities(Top()).derivatives["precession_rate_half"]
    assert row["theta0_deg"] == row["A"] == 0.0
    assert row["m"] == pytest.approx(solve(Top()).precession_rate_half / Top().m, rel=1e-15)


def test_an_unknown_key_or_input_is_named() -> None:
    with pytest.raises(LagtopError, match="did you mean 'T_nutation'"):
        sensitivities(Top(), ["T_nutatoin"])
    with pytest.raises(LagtopError, match="inputs must be among m, A, C"):
        angle_sensitivities(Top(), [0.0], ["theta0_rad"])
    with pytest.raises(LagtopError, match="t must be finite"):
        angle_sensitivities(Top(), [0.0, math.nan])


@pytest.mark.parametrize("scene", quick([*SCENES, "steady", "torque-free", "free and steady"]))
def test_derivatives_of_the_angles_are_right_at_any_time(scene: str) -> None:
    """The worst seen is 4e-14, of the extreme scene."""
    assert worst_error(Top(**(SCENES | DEGENERATE)[scene])) < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("stratum", range(5))
def test_derivatives_of_the_angles_of_hard_tops_are_right(stratum: int) -> None:
    """The worst seen at 2600 times is 2e-13; by series alone it would be 1e-7."""
    rng = random.Random(stratum)
    for _ in range(8):
        top = Top(**UNIT | hard_start(rng, stratum))
        assert worst_error(top) < 1e-12, top


def hard_start(rng: random.Random, stratum: int) -> dict[str, float]:
    """Return inputs next to the separatrix, the sleeping threshold or a pole, or of any size."""

    def size(low: float, high: float) -> float:
        return math.exp(rng.uniform(low, high) * math.log(10))

    side = rng.choice([-1, 1])
    if stratum == 0:
        rate = math.sqrt(2) * (1 + side * size(-14, -3))
        return {"r0": size(-12, -1), "theta0_deg": 90, "thetadot0": rate, "psidot0": size(-12, -1)}
    if stratum == 1:
        return {"r0": 2 * (1 + side * size(-14, -2)), "theta0_deg": size(-7, 0)}
    if stratum == 2:
        rates = {"thetadot0": size(-6, 3), "psidot0": size(-6, 3)}
        return {"r0": size(-6, 9), "theta0_deg": size(-6, 2.2)} | rates
    if stratum == 3:
        rates = {"thetadot0": rng.uniform(0.1, 3), "psidot0": 2 + side * size(-14, -1)}
        return {"r0": 2, "theta0_deg": 90} | rates
    rates = {"thetadot0": size(-3, 6), "psidot0": size(-3, 3)}
    return {"C": size(-8, 0), "r0": size(-3, 6), "theta0_deg": rng.uniform(1, 179)} | rates


def worst_error(top: Top) -> float:
    """Return the worst error of a derivative of an angle over the condition number of the angle.

    That is how far the angle moves when each input does, by its own size, and 1 rad; a rate that is
    0 moves by a radian per period.
    """
    period = solve(top).T_nutation
    times = [0.3 * period, -1.6 * period, 1e6 * period]
    judge, found = Slopes(top), angle_sensitivities(top, times)
    sizes = [abs(getattr(top, name)) or 1 / period for name in found.inputs]
    worst = 0.0
    for angle in ("theta", "phi", "psi"):
        exact = [
            [sum(judge.of_angle(name, angle, t) or (math.nan,)) / 2 for name in found.inputs]
            for t in times
        ]
        errors = np.abs(getattr(found, angle) - exact) * sizes
        condition = 1.0 + (np.abs(exact) * sizes).sum(axis=1)
        worst = max(worst, float((errors.max(axis=1) / condition).max()))
    return worst


def test_angles_come_with_their_derivatives_in_the_shape_of_the_times() -> None:
    top = Top(thetadot0=0.5)
    times = np.array([[0.0, 0.25], [-1.5, 3.0]])
    found = angle_sensitivities(top, times, ["r0", "m"])
    assert found.inputs == ("r0", "m")
    assert found.theta.shape == found.phi.shape == found.psi.shape == (2, 2, 2)
    for ours, theirs in zip(found.angles, solve(top).angles(times), strict=True):
        assert np.allclose(ours, theirs, rtol=1e-15, atol=1e-15)
    assert not found.psi[0, 0].any()
