"""Derivatives against differences of the reference's numbers, and uncertainties.

`test_frozen` compares all derivatives of fifteen records.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from lagtop import LagtopError, Top, sensitivities, solve
from record_reference import exact, reference_record, reference_state
from scenes import EPS, EVERY_KIND, UNIT

from lagrange_cli.solver.angle_stds import AngleStds
from lagrange_cli.solver.derivatives import inputs_of
from lagrange_cli.solver.uncertainty import FirstOrder

SCENES: dict[str, dict[str, float]] = {
    "any start": EVERY_KIND["any start"],
    "steady": UNIT | {"r0": 1.5, "theta0_deg": 60, "psidot0": 2},
    "in radians": UNIT | {"r0": -3, "theta0_rad": 2, "thetadot0": -1.5, "psidot0": 1},
    "nearly steady": UNIT | {"r0": 1.5, "theta0_deg": 60, "psidot0": 2 + 1e-13},
    "near the separatrix": UNIT
    | {"m": 0.5, "r0": 0.75, "theta0_deg": 60, "psidot0": 0.5 + 1e-9, "thetadot0": 0.559016994},
    "near a pole": UNIT | {"r0": 2, "theta0_deg": 90, "psidot0": 2 + 1e-9, "thetadot0": 1},
    "tiny tilt": UNIT | {"r0": 2, "theta0_deg": 1e-9},
    "extreme": {"m": 1e20, "A": 1e-9, "C": 1e-10, "s": 1e-9, "g": 1e-8, "psidot0": 1e3},
    "very fast": {"r0": 1e18, "thetadot0": 1e3},
    "cancelling": UNIT | {"C": 5e-6, "r0": 2, "theta0_deg": 130, "thetadot0": 2.2e9},
    "torque-free": UNIT
    | {"C": 0.5, "g": 0, "r0": 3, "theta0_deg": 50, "psidot0": 1, "thetadot0": 0.5},
    "free and steady": UNIT | {"C": 0.5, "g": 0, "r0": 3, "theta0_deg": 50},
}
QUICK = [pytest.param(x, marks=() if x == "any start" else pytest.mark.slow) for x in SCENES]


def slopes(
    top: Top, name: str, values: Callable[[dict[str, Any]], Sequence[Any]], step: Fraction
) -> list[float]:
    """Return the difference quotients of numbers by an input, one-sided on an edge."""
    x, found = Fraction(getattr(top, name)), []
    with mpmath.workdps(120):
        for place in (x - step * (abs(x) or 1), x + step * (abs(x) or 1), x):
            try:
                inputs = top.replace(**{name: place}).as_dict()
            except LagtopError:
                continue
            found.append((exact(place), values(inputs)))
            if len(found) == 2:
                break
        (before, first), (after, last) = found
        return [float((y - x) / (after - before)) for x, y in zip(first, last, strict=True)]


def angle_slopes(top: Top, name: str, t: float) -> list[float]:
    """Return the derivatives of tilt, spin and precession at a time."""

    def values(inputs: dict[str, Any]) -> Sequence[Any]:
        return reference_state(inputs, t, digits=80, root_digits=300)[:3]

    return slopes(top, name, values, Fraction(1, 10**36))


def test_derivatives_of_a_record_in_radians() -> None:
    top, keys = Top(**SCENES["in radians"]), ["T_nutation", "theta_max_deg", "mean_spin_rate", "K"]

    def values(inputs: dict[str, Any]) -> Sequence[Any]:
        record = reference_record(inputs, root_digits=400)
        return [record[key] for key in keys]

    found = sensitivities(top, keys).derivatives
    for name in ("theta0_rad", "psidot0"):
        by = [found[key][name] for key in keys]
        assert by == pytest.approx(slopes(top, name, values, Fraction(1, 10**9)), rel=1e-8)


def test_derivatives_are_by_the_inputs_that_were_given() -> None:
    top = Top(m=2, A_cm=3, C=1, s=0.5, g=1, phidot0=4, psidot0=1.5, theta0_deg=50)
    inputs = "m A_cm C s g phidot0 theta0_deg thetadot0 psidot0"
    assert sensitivities(top, ["a"]).inputs == tuple(inputs.split())


def test_a_kink_has_no_derivative() -> None:
    found = sensitivities(Top(**SCENES["steady"]), ["theta_max_deg", "T_nutation"]).derivatives
    assert math.isnan(found["theta_max_deg"]["r0"])
    assert not math.isnan(found["T_nutation"]["r0"])


def test_a_parabola_at_0_is_no_kink() -> None:
    """stability_factor is proportional to r0^2; the two steady rates change places at r0 = 0."""
    top = Top(**UNIT | {"r0": 0, "theta0_deg": 120})
    found = sensitivities(top, ["stability_factor", "steady_rate_slow"]).derivatives
    assert found["stability_factor"]["r0"] == 0.0
    assert math.isnan(found["steady_rate_slow"]["r0"])


SINE = math.sin(math.radians(26))
EXACT: list[tuple[dict[str, float], str, str, float]] = [
    # with psidot0 the axis moves uniformly on a great circle, sin(theta0) psidot0 per time
    ({"s": 0, "r0": 0, "theta0_deg": 26}, "mean_precession_rate", "psidot0", SINE),
    ({"s": 0, "r0": 0, "theta0_deg": 26}, "mean_spin_rate", "r0", 1.0),
    ({"s": 0, "r0": 0, "theta0_deg": 26}, "a", "s", 2.0),
    # without torque over the poles T = 2 pi/theta'
    (
        {"g": 0, "r0": 0, "theta0_deg": 0, "thetadot0": 2},
        *("T_nutation", "thetadot0", -math.pi / 2),
    ),
    ({"g": 0, "r0": 0, "theta0_deg": 0, "thetadot0": 2}, "mean_spin_rate", "r0", math.nan),
    ({"g": 0, "r0": 3, "theta0_deg": 0}, "a", "g", 2.0),
    ({"g": 0, "r0": 0, "theta0_deg": 180}, "a", "g", 2.0),
    # a pendulum that turns over passes over both poles
    ({"r0": 0, "theta0_deg": 160, "thetadot0": 3}, "theta_max_deg", "m", 0.0),
    ({"r0": 0, "theta0_deg": 160, "thetadot0": 3}, "mean_spin_rate", "r0", math.nan),
    # after release from rest psi'(T/2) = a/b = 2mgs/(C r0), whatever the tilt and A are
    ({"r0": 2, "theta0_deg": 40}, "precession_rate_half", "theta0_deg", 0.0),
    ({"r0": 2, "theta0_deg": 40}, "precession_rate_half", "A", 0.0),
    ({"r0": 2, "theta0_deg": 40}, "precession_rate_half", "m", 1.0),
]


@pytest.mark.parametrize(("inputs", "key", "name", "value"), EXACT)
def test_derivatives_by_hand(inputs: dict[str, float], key: str, name: str, value: float) -> None:
    found = sensitivities(Top(**UNIT | inputs), [key]).derivatives[key][name]
    assert found == pytest.approx(value, rel=EPS, abs=0, nan_ok=True)


@pytest.mark.parametrize("excess", [-1e-7, 1e-7])
def test_derivatives_in_a_plane_are_those_of_the_tilt(excess: float) -> None:
    """Spin and precession change by half turns, which no input of the plane moves."""
    top = Top(**UNIT | {"r0": 0, "theta0_deg": 90, "thetadot0": 2**0.5 * (1 + excess)})
    period, inputs = solve(top).T_nutation, ["m", "A", "thetadot0"]
    times = np.array([0.3 * period, -1.6 * period, 1e6 * period])
    found = AngleStds(solve(top), dict.fromkeys(inputs, 1.0)).slopes(times)
    assert not found[:, 1:].any()
    for t, row in zip(times.tolist(), found[:, 0].T.tolist(), strict=True):
        true = [angle_slopes(top, name, t)[0] for name in inputs]
        assert row == pytest.approx(true, rel=1e-4, abs=1e-6 * (1 + max(map(abs, true))))


@pytest.mark.parametrize("scene", QUICK)
def test_derivatives_of_the_angles_are_right_at_any_time(scene: str) -> None:
    """Errors are over the condition number of the angle.

    That is how far the angle moves if each input does, by its own size, and 1 rad; a rate that is
    0 moves by a radian per period.
    """
    top = Top(**SCENES[scene])
    motion, inputs = solve(top), inputs_of(top)
    period = motion.T_nutation
    times = np.array([0.3 * period, -1e6 * period])
    stds = AngleStds(motion, dict.fromkeys(inputs, 1.0))
    found = stds.slopes(times)
    sizes = [abs(getattr(top, name)) or 1 / period for name in inputs]
    for i, name in enumerate(inputs):
        if stds.noise[name] * sizes[i] > 1e-9:  # where uncertainties take proved rows too
            found[i] = AngleStds(motion, {name: 1.0}).proved_slopes(times)[0]
    most = 1e-3 if scene in ("near the separatrix", "near a pole") else 5e-9
    true = np.array([[angle_slopes(top, name, t) for t in times.tolist()] for name in inputs])
    true, across = true.transpose(0, 2, 1), np.array(sizes)[:, None, None]
    errors, condition = (
        np.abs(found[:, :3] - true) * across,
        1.0 + (np.abs(true) * across).sum(axis=0),
    )
    assert (errors / condition).max() < most


def test_derivatives_of_angles_at_the_start() -> None:
    found = AngleStds(solve(Top(thetadot0=0.5)), {"r0": 1, "theta0_deg": 1}).slopes(np.zeros(2))
    assert found[:, :3, 0].tolist() == [[0.0, 0.0, 0.0], [math.pi / 180, 0.0, 0.0]]


@pytest.mark.parametrize("scene", ["separatrix", "sleeping", "over the top"])
def test_angles_have_no_derivative_if_the_neighbours_depart_at_once(scene: str) -> None:
    found = AngleStds(solve(Top(**EVERY_KIND[scene])), {"thetadot0": 1, "psidot0": 1})
    assert "thetadot0" in found.missing or scene == "over the top"
    assert scene == "sleeping" or "psidot0" in found.missing
    assert np.isnan(found.slopes(np.array([0.5]))).any()


@pytest.mark.parametrize(
    "scene", ["any start", pytest.param("near the separatrix", marks=pytest.mark.slow)]
)
def test_uncertainties_of_angles_are_right_to_the_digits_that_are_printed(scene: str) -> None:
    top = Top(**SCENES[scene])
    motion, stds = solve(top), {"C": 0.01, "theta0_deg": 1e-7}
    times = np.array([0.2, 1.3, 7.7]) * motion.T_nutation
    found: Any = AngleStds(motion, stds).at(times)
    for j, t in enumerate(times.tolist()):
        by = [np.array(angle_slopes(top, x, t)) * stds[x] for x in stds]
        assert found[:3, j] == pytest.approx(np.sqrt(np.square(by).sum(axis=0)), rel=1e-3), t


def test_an_uncertainty_of_0_is_0() -> None:
    """At 90 degrees r0_steady_min is 0 for every r0."""
    motion = solve(Top(theta0_deg=90, r0=50))
    assert FirstOrder(motion, {"r0": 2.0}).std("r0_steady_min") == 0.0


EDGE = {"m": 1, "A": 1, "C": 1, "s": 1, "g": 1, "r0": 1.5, "psidot0": 1, "theta0_deg": 60}


@pytest.mark.parametrize("fall", [1e-50, 1e-70, 1e-90])
def test_the_step_is_smaller_than_the_distance_of_a_degenerate_motion(fall: float) -> None:
    """Without nutation rate the precession is steady, and the derivative does not exist."""
    found = sensitivities(Top(**EDGE, thetadot0=fall), ["theta_max_deg", "k"]).derivatives
    assert found["theta_max_deg"]["r0"] == pytest.approx(-49.6196005879, rel=1e-11)
    k = solve(Top(**EDGE, thetadot0=fall)).k
    assert found["k"]["thetadot0"] == pytest.approx(k / fall / 2, rel=1e-9)


@pytest.mark.parametrize("inputs", [{"g": 1e-160}, {"r0": 1e-200}])
def test_a_derivative_beyond_the_doubles_is_refused(inputs: dict[str, float]) -> None:
    with pytest.raises(LagtopError, match=r"the derivative of .* must be within 1.8e308 in size"):
        sensitivities(Top(**EDGE | {"psidot0": 0, "theta0_deg": 30} | inputs))
