"""Neighbours of a Lagrange top, and faults of rows: templates, names, sizes, and what is unseen."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from lagtop import fit, solve
from machines import filtered, gimballed, unlike
from noisy_recordings import DEGREE, TOP, axis_of, fitted, recording_from
from scipy.spatial.transform import Rotation

from lagrange_cli.arithmetic.types import Array
from lagrange_cli.inverse.advice import Advice
from lagrange_cli.inverse.neighbours import machines
from lagrange_cli.inverse.outcome import Outcome
from lagrange_cli.inverse.reasons import Kind
from lagrange_cli.inverse.rows import frequency_of_parts, repeated, with_gap
from lagrange_cli.inverse.search import best_fit
from lagrange_cli.inverse.variations import Variations
from lagrange_cli.names import ANGLES

START = np.array([1.1, 0.3, 0.9])
A, B, R0 = 80.0, 12.0, 20.0
BOTH = ("theta", "psi")


def seen(
    *names: str, rows: int = 120, noise: float = 4e-3, seed: int = 4, **sizes: float
) -> tuple[Array, dict[str, Array]]:
    """Return times and noisy angles of a machine, by an integrator."""
    t, rng = np.arange(rows) / 60, np.random.default_rng(seed)
    move = unlike if sizes.keys() & {"moments", "beside"} else gimballed
    found = move(A, B, R0, START, t, **sizes)
    return t, {x: found[x] + rng.normal(scale=noise, size=rows) for x in names or BOTH}


def alone(t: Array, angles: dict[str, Array]) -> Outcome:
    """Return a fit without the search for advice."""
    one = recording_from(t, **angles)
    return best_fit(one, {}, frequency=frequency_of_parts(one))


@pytest.mark.parametrize(
    ("words", "size"),
    [
        ("stand", "stand"),
        ("yoke", "yoke"),
        ("decay", "drag"),
        ("vertical bearing", "vertical"),
        ("bearing of the tilt", "nodes"),
        ("second torque", "magnet"),
        ("off the axis", "beside"),
        ("moments", "moments"),
    ],
)
def test_a_template_is_the_change_of_the_motion(words: str, size: str) -> None:
    """Of machines by an integrator; in one direction at least."""
    sizes: list[dict[str, Any]] = [{size: 1e-4}, {size: -1e-4}]
    ends = [seen(*ANGLES, rows=180, noise=0.0, **x)[1] for x in sizes]
    expected = np.stack([ends[0][x] - ends[1][x] for x in ANGLES]) / 2e-4
    motion = Variations(np.array([A, B, *START]), R0 / B, np.arange(180) / 60)
    (changes,) = [x.changes for x in machines(motion) if words in x.name]
    ways = np.stack([x.ravel() for x in changes], axis=1)
    factors = np.linalg.lstsq(ways, expected.ravel(), rcond=None)[0]
    rest = expected.ravel() - ways @ factors
    assert np.abs(rest).max() < 0.02 * np.abs(expected).max()
    assert np.linalg.norm(factors) == pytest.approx(1, abs=0.02)


def test_a_decay_is_named_with_its_size() -> None:
    outcome = alone(*seen(rows=180, drag=0.05))
    assert "a decay of the spin by" in outcome.failure()
    shown = outcome.shown["a decay of the spin"]
    assert abs(shown.size - 0.05) < 4 * shown.std


def test_a_clock_whose_rate_wanders_is_no_lost_row() -> None:
    t = np.arange(120) / 60
    exact = gimballed(A, B, R0, START, t + 0.05 / 3 * (np.sin(3 * t + 1) - np.sin(1)))
    rng = np.random.default_rng(4)
    found = alone(t, {x: exact[x] + rng.normal(scale=0.02, size=120) for x in BOTH}).neighbour
    assert found.startswith("a clock whose rate wanders by "), found


def test_a_body_that_is_not_round_is_named_with_a_spin_that_is_not_seen() -> None:
    failure = alone(*seen(rows=180, noise=1e-3, beside=0.2)).failure()
    assert "a centre of mass off the axis by " in failure
    assert abs(float(failure.rpartition("if r0 = ")[2].split(";")[0]) - R0) < 1


def test_a_jump_is_named() -> None:
    t, angles = seen(*ANGLES)
    jumped: dict[str, Any] = angles | {"psi": angles["psi"] + 0.1 * (t > 1.2)}
    assert "a jump of psi by 5." in fit(t, **jumped).failure()


def test_an_honest_top_is_good_and_has_model_errors() -> None:
    outcome = fitted(*seen(*ANGLES))
    assert (outcome.verdict, outcome.neighbour) == ("good", "")
    record = outcome.record()
    assert record["untested"].startswith("1 % each of ")
    assert 0.1 < record["a_model_percent"] < 3
    outcome = fitted(*seen(), known={"m": 1, "g": 10, "s": 4, "r0": R0})
    assert outcome.model_errors["A"] == outcome.model_errors["a"]


def test_a_model_error_holds_a_stand_that_is_not_seen() -> None:
    """The error of a small nutation in a stand of 3 % of A is three times that of 1 %."""
    t = np.linspace(0, 1.2, 120)
    a, b, start = 120.0, 30.0, np.array([1.2, 0.0, 2.2])
    exact = gimballed(a, b, 50, start, t, stand=0.03)
    noise = np.random.default_rng(5).normal(scale=5e-4, size=(2, t.size))
    outcome = fit(t, theta=exact["theta"] + noise[0], psi=exact["psi"] + noise[1])
    assert outcome.verdict == "good"
    found = outcome.numbers["a"]
    off = abs(found.value / a - 1)
    assert off > 5 * found.std / a
    assert off < 3 * outcome.model_errors["a"] + 2 * found.std / a


def test_rows_that_may_be_lost_are_in_the_model_error() -> None:
    """Two rows of 63 are too few to be sure of."""
    t, angles = seen(rows=65, noise=0.05, seed=3)
    one = fitted(t[:63], {x: np.delete(y, [30, 31]) for x, y in angles.items()})
    off = abs(one.numbers["a"].value - A)
    model = one.model_errors.get("a", 0.0) * A
    assert one.verdict == "failed" or off < 5 * one.numbers["a"].std + model


@pytest.mark.parametrize(
    ("kind", "rows", "tilt", "rate"), [("quaternion", 70, 75, 0), ("axis", 500, 55, 2)]
)
def test_rounding_errors_show_no_neighbour(kind: str, rows: int, tilt: float, rate: float) -> None:
    """A motion without noise is not one with a jump of 1e-13 degrees."""
    t = np.linspace(0, 1.2, rows)
    theta, phi, psi = solve(TOP.replace(theta0_deg=tilt, psidot0=rate)).angles(t)
    turns = Rotation.from_euler("ZXZ", np.stack([psi, theta, phi], axis=1))
    found = {"quaternion": turns.as_quat(scalar_first=True), "axis": axis_of(theta, psi)}
    outcome = fitted(t, {kind: found[kind]})
    assert outcome.verdict == "good", outcome.failures()
    assert outcome.model_errors


def test_rows_that_repeat_another_are_named_but_not_those_of_a_coarse_encoder() -> None:
    t, angles = seen()
    assert repeated(recording_from(t, **angles)) == ""
    rows = np.sort(np.append(np.arange(119), 40))
    outcome = fitted(t, {x: y[rows] for x, y in angles.items()})
    assert outcome.failure() == f"the row at t = {t[41]:.6g} repeats the row before it"
    assert outcome.failed[0].kind is Kind.ROWS
    t, angles = seen(rows=600)
    coarse = {x: np.round(y / 0.2) * 0.2 for x, y in angles.items()}
    assert (np.diff(coarse["theta"]) == 0).any()
    assert repeated(recording_from(t, **coarse)) == ""


@pytest.mark.parametrize("lost", [1, pytest.param(3, marks=pytest.mark.slow)])
def test_lost_rows_are_found(lost: int) -> None:
    """If the rows of a recording are numbered although some are lost."""
    t, angles = seen()
    kept = np.r_[0:60, 60 + lost : 120]
    one = recording_from(t[: kept.size], **{x: y[kept] for x, y in angles.items()})
    assert with_gap(one, 60, lost).t == pytest.approx(t[kept])
    outcome = best_fit(one, {})
    assert Advice(one, {}, outcome).lost_rows() == (60, lost)
    said = f"{lost} row{'s are' if lost > 1 else ' is'} lost before t = {t[60]:.6g}"
    found = [outcome.failure(), *Advice(one, {}, outcome).gap()]
    assert any(x.startswith(said) for x in found), found


def test_a_late_filter_is_in_the_uncertainty_of_the_first_row() -> None:
    """Noise alone would leave theta0 uncertain by 0.03 degrees; the delay moves it by 2."""
    t, angles = seen(rows=240, seed=9)
    late = {x: filtered(y, 3, "lag")[24:] for x, y in angles.items()}  # the filter has settled
    exact = gimballed(A, B, R0, START, t)["theta"][24] / DEGREE
    outcome = fitted(t[24:], late)
    assert outcome.verdict == "good", outcome.failures()
    theta0 = outcome.numbers["theta0_deg"]
    assert 1 < abs(exact - theta0.value) < 3 * theta0.std < 10


def test_a_quaternion_whose_components_are_smoothed_is_named() -> None:
    t, angles = seen(*ANGLES, rows=240)
    turns = Rotation.from_euler("ZXZ", np.stack([angles[x] for x in ("psi", "theta", "phi")], 1))
    parts = turns.as_quat(scalar_first=True)[::4]
    said = fit(t[::4], quaternion=np.apply_along_axis(filtered, 0, parts, 5, "mean")).failure()
    assert said.startswith("the length of the quaternion varies from 0."), said


def test_a_quaternion_of_length_0_is_a_missing_number() -> None:
    """Trackers write it while they do not see the top."""
    t, angles = seen(*ANGLES, rows=240)
    turns = Rotation.from_euler("ZXZ", np.stack([angles[x] for x in ("psi", "theta", "phi")], 1))
    quaternion = turns.as_quat(scalar_first=True)
    quaternion[100:103] = 0
    assert fit(t, quaternion=quaternion).verdict == "good"


def test_reasons_are_in_the_order_of_their_kinds() -> None:
    t, angles = seen()
    angles["theta"][30] += 1.0
    outcome = alone(t, angles | {"psi": angles["psi"] + 0.5 * (t > 1)})
    kinds = [x.kind for x in outcome.failed]
    assert kinds == sorted(kinds)
    assert len(kinds) > 1
