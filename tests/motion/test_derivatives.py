"""Derivatives against differences of other formulas in 800 bits (`slopes`), and uncertainties."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from lagtop import LagtopError, Top, sensitivities, solve
from scenes import EPS, EVERY_KIND, UNIT
from slopes import Slopes

from lagrange_cli.motion.derivatives import AngleDerivatives, inputs_of
from lagrange_cli.motion.uncertainty import AngleStds, FirstOrder

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
    top = Top(**(SCENES | DEGENERATE)[scene])
    judge, found, record = Slopes(top), sensitivities(top), solve(top).numbers()
    compared = 0
    for key, row in found.derivatives.items():
        for name, derivative in row.items():
            sides = judge.of_key(name, key)
            if sides is None:
                continue
            if math.isnan(derivative):
                assert scene in DEGENERATE, (key, name, sides)
            else:
                middle = (sides[0] + sides[1]) / 2
                judged = 1e-30 if top.pole else 1e-46  # on an edge differences are one-sided
                slack = EPS * abs(middle) + judged * abs(record[key] or 0)
                slack += 1e-30 if abs(derivative) < 1e-60 else 0  # the step of the judge at a 0
                assert abs(derivative - middle) <= slack, (key, name, derivative, sides)
                curved = 1e-6 * (abs(middle) + abs(record[key] or 0))
                assert abs(sides[0] - sides[1]) <= curved, (key, name, sides)
                compared += 1
    assert compared > (200 if scene in SCENES else 25)


def test_a_kink_has_no_derivative() -> None:
    top = Top(**DEGENERATE["steady"])
    found = sensitivities(top, ["theta_max_deg", "T_nutation"]).derivatives
    assert math.isnan(found["theta_max_deg"]["r0"])
    assert not math.isnan(found["T_nutation"]["r0"])
    behind, ahead = Slopes(top).of_key("r0", "theta_max_deg") or (0, 0)
    assert abs(behind - ahead) > 1


def test_a_parabola_at_0_is_no_kink() -> None:
    """stability_factor is proportional to r0^2; the two steady rates change places at r0 = 0."""
    top = Top(**UNIT | {"r0": 0, "theta0_deg": 120})
    found = sensitivities(top, ["stability_factor", "steady_rate_slow"]).derivatives
    assert found["stability_factor"]["r0"] == 0.0
    assert math.isnan(found["steady_rate_slow"]["r0"])


def test_a_pendulum_that_turns_over_has_derivatives() -> None:
    """The axis passes over both poles, where the judge of the others decides nothing."""
    top = Top(**UNIT | {"r0": 0, "theta0_deg": 160, "thetadot0": 3})
    found = sensitivities(top).derivatives
    ahead, behind = (solve(top.replace(thetadot0=3 + side * 1e-5)).T_nutation for side in (1, -1))
    assert found["T_nutation"]["thetadot0"] == pytest.approx((ahead - behind) / 2e-5, rel=1e-8)
    assert found["theta_max_deg"]["m"] == 0.0
    assert math.isnan(found["mean_spin_rate"]["r0"])


def test_a_top_without_torque_that_stands_still_turns_about_what_moves_it() -> None:
    """With psidot0 the axis moves uniformly on a great circle, sin(theta0) psidot0 per time."""
    found = sensitivities(Top(**UNIT | {"s": 0, "r0": 0, "theta0_deg": 26})).derivatives
    sine = math.sin(math.radians(26))
    assert found["mean_precession_rate"]["psidot0"] == pytest.approx(sine, rel=EPS)
    assert found["mean_spin_rate"]["r0"] == 1.0
    assert found["a"]["s"] == 2.0


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


PLANE: dict[str, dict[str, float]] = {
    "to and fro": {"theta0_deg": 90, "thetadot0": 2**0.5 * (1 - 1e-7)},
    "round": {"theta0_deg": 90, "thetadot0": 2**0.5 * (1 + 1e-7)},
    "from rest": {"theta0_deg": 1e-3},
}


@pytest.mark.parametrize("scene", PLANE)
def test_derivatives_in_a_plane_are_those_of_the_tilt(scene: str) -> None:
    """Spin and precession change by half turns, which no input of the plane moves."""
    top = Top(**UNIT | {"r0": 0} | PLANE[scene])
    period, inputs = solve(top).T_nutation, ["m", "A", "thetadot0"]
    times = np.array([0.3 * period, -1.6 * period, 1e6 * period])
    found, judge = AngleDerivatives(solve(top), inputs).at(times), Slopes(top)
    assert not found[:, 1:].any()
    for t, row in zip(times.tolist(), found[:, 0].T.tolist(), strict=True):
        exact = [sum(judge.of_angle(name, "theta", t) or (math.nan,)) / 2 for name in inputs]
        assert row == pytest.approx(exact, rel=1e-4, abs=1e-6 * (1 + max(map(abs, exact))))


def test_what_does_not_depend_on_an_input_has_the_derivative_0() -> None:
    """After release from rest psi'(T/2) = a/b = 2mgs/(C r0), whatever the tilt and A are."""
    row = sensitivities(Top()).derivatives["precession_rate_half"]
    assert row["theta0_deg"] == row["A"] == 0.0
    assert row["m"] == pytest.approx(solve(Top()).precession_rate_half / Top().m, rel=1e-15)


def test_an_unknown_key_or_input_is_named() -> None:
    with pytest.raises(LagtopError, match="did you mean 'T_nutation'"):
        sensitivities(Top(), ["T_nutatoin"])


ROUGH = {
    "near the separatrix": 1e-3,
    "nearly upright for long": 1e-3,
    "near a pole": 1e-3,
}
"""Scenes whose angles have large derivatives for a short time, and bounds of their errors."""


@pytest.mark.parametrize("scene", quick([*SCENES, "steady", "torque-free", "free and steady"]))
def test_derivatives_of_the_angles_are_right_at_any_time(scene: str) -> None:
    assert worst_error(Top(**(SCENES | DEGENERATE)[scene])) < ROUGH.get(scene, 5e-9)


def worst_error(top: Top) -> float:
    """Return the worst error of a derivative of an angle over the condition number of the angle.

    That is how far the angle moves when each input does, by its own size, and 1 rad; a rate that is
    0 moves by a radian per period.
    """
    motion, inputs = solve(top), inputs_of(top)
    period = motion.T_nutation
    times = [0.3 * period, -1.6 * period, 1e6 * period]
    judge, slopes = Slopes(top), AngleDerivatives(motion, inputs)
    found = slopes.at(np.array(times))
    sizes = [abs(getattr(top, name)) or 1 / period for name in inputs]
    for i, name in enumerate(inputs):
        if slopes.noise[name] * sizes[i] > 1e-9:  # where uncertainties take proved rows too
            found[i] = AngleDerivatives(motion, [name]).in_digits(np.array(times))[0]
    worst = 0.0
    for i, angle in enumerate(("theta", "phi", "psi")):
        exact = [
            [sum(judge.of_angle(name, angle, t) or (math.nan,)) / 2 for name in inputs]
            for t in times
        ]
        errors = np.abs(found[:, i].T - exact) * sizes
        condition = 1.0 + (np.abs(exact) * sizes).sum(axis=1)
        worst = max(worst, float((errors.max(axis=1) / condition).max()))
    return worst


def test_derivatives_of_angles_at_the_start() -> None:
    found = AngleDerivatives(solve(Top(thetadot0=0.5)), ["r0", "theta0_deg"]).at(np.zeros(2))
    assert found[:, :, 0].tolist() == [[0.0, 0.0, 0.0], [math.pi / 180, 0.0, 0.0]]


@pytest.mark.parametrize("scene", ["separatrix", "sleeping", "over the top"])
def test_angles_have_no_derivative_if_the_neighbours_depart_at_once(scene: str) -> None:
    found = AngleDerivatives(solve(Top(**DEGENERATE[scene])), ["thetadot0", "psidot0"])
    assert "thetadot0" in found.missing or scene == "over the top"
    assert scene == "sleeping" or "psidot0" in found.missing
    assert np.isnan(found.at(np.array([0.5]))).any()


@pytest.mark.parametrize("scene", quick(["near the separatrix", "any start"]))
def test_uncertainties_of_angles_are_right_to_the_digits_that_are_printed(scene: str) -> None:
    top = Top(**SCENES[scene])
    motion, stds = solve(top), {"C": 0.01, "theta0_deg": 1e-7}
    times, judge = np.array([0.2, 1.3, 7.7]) * motion.T_nutation, Slopes(top)
    found = AngleStds(motion, stds, list(stds)).at(times)
    for i, angle in enumerate(("theta", "phi", "psi")):
        for j, t in enumerate(times.tolist()):
            by = [sum(judge.of_angle(x, angle, t) or (math.nan,)) / 2 * stds[x] for x in stds]
            assert found[i, j] == pytest.approx(math.hypot(*by), rel=1e-3), (angle, t)


def test_an_uncertainty_of_0_is_0() -> None:
    """At 90 degrees r0_steady_min is 0 for every r0."""
    motion = solve(Top(theta0_deg=90, r0=50))
    assert FirstOrder(motion, {"r0": 2.0}, ["r0"]).std("r0_steady_min") == 0.0
