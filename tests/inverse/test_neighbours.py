"""Neighbours of a Lagrange top, and faults of rows: templates, names, sizes, and what is unseen."""

from __future__ import annotations

import math
from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from engines import wxyz
from lagtop import Top, fit, solve
from machines import MACHINES, filtered
from noisy_recordings import DEGREE, TOP, attitude_of, fitted, motion_of, recorded, recording_from
from scipy.spatial.transform import Rotation

from lagrange_cli.arithmetic.types import Array
from lagrange_cli.inverse.advice import Advice
from lagrange_cli.inverse.neighbours import Neighbour, machines, misread
from lagrange_cli.inverse.outcome import Outcome
from lagrange_cli.inverse.reasons import Kind
from lagrange_cli.inverse.rows import frequency_of_parts, repeated, with_gap
from lagrange_cli.inverse.search import best_fit
from lagrange_cli.inverse.variations import Variations
from lagrange_cli.names import ANGLES

A, B, R0 = 80.0, 12.0, 20.0
STATE, T = np.array([A, B, 1.1, 0.3, 0.9]), np.arange(180) / 60
MACHINE = Top(m=1, s=1, g=A / 2, A=1, C=B / R0, r0=R0, theta0_deg=math.degrees(1.1)).replace(
    thetadot0=0.3, psidot0=0.9
)

TEMPLATES = {x.words.partition("|")[0]: x.size for x in MACHINES.values() if x.motion}
TEMPLATES |= {"bearing of the tilt": "nodes", "decay": "drag"}


def seen(
    *names: str, rows: int = 120, noise: float = 0.23, seed: int = 4, **sizes: float
) -> tuple[Array, dict[str, Array]]:
    """Return times and noisy angles of a machine, by an integrator."""
    names, t = names or ("theta", "psi"), np.arange(rows) / 60
    return recorded(*names, top=MACHINE, t=t, noise=noise, seed=seed, sizes=sizes)


def alone(t: Array, angles: dict[str, Array]) -> Outcome:
    """Return a fit without the search for advice."""
    one = recording_from(t, **angles)
    return best_fit(one, {}, frequency=frequency_of_parts(one))


def assert_spans(found: Iterable[Neighbour], words: str, expected: Array) -> None:
    """Check that a template holds a change, at its size; in one direction at least."""
    (changes,) = [x.changes for x in found if words in x.name]
    ways = np.stack([x[: len(expected)].ravel() for x in changes], axis=1)
    factors = np.linalg.lstsq(ways, expected.ravel(), rcond=None)[0]
    rest = expected.ravel() - ways @ factors
    assert np.abs(rest).max() < 0.02 * np.abs(expected).max()
    assert np.linalg.norm(factors) == pytest.approx(1, abs=0.02)


@pytest.mark.parametrize(("words", "size"), TEMPLATES.items())
def test_a_template_is_the_change_of_the_motion(words: str, size: str) -> None:
    """Of machines by an integrator."""
    after, before = (motion_of(MACHINE, T, **{size: x}) for x in (1e-4, -1e-4))
    expected = np.stack([after[x] - before[x] for x in ANGLES]) / 2e-4
    assert_spans(machines(Variations(STATE, R0 / B, T)), words, expected)


@pytest.mark.parametrize("words", ["tilted vertical", "misaligned figure axis", "origin beside"])
def test_a_template_of_a_frame_is_a_small_turn(words: str) -> None:
    angles = motion_of(MACHINE, T)
    turns, ends = attitude_of(angles), []
    for x in (1e-5, -1e-5):
        small = Rotation.from_rotvec([x, 0, 0])
        psi, theta, phi = (small * turns if "vert" in words else turns * small).as_euler("ZXZ").T
        if "origin" in words:
            right, ahead, up = turns.apply([0, 0, 1]).T + np.reshape([x, 0, 0], (3, 1))
            theta, psi = np.arctan2(np.hypot(right, ahead), up), np.arctan2(right, -ahead)
        ends.append(np.stack([theta, psi] if "origin" in words else [theta, phi, psi]))
    seen_by: Any = SimpleNamespace(angles=angles, kind="angles", position=angles)
    found = [*misread(Variations(STATE, R0 / B, T), seen_by)]
    if "origin" in words:  # phi is not seen
        found = [x._replace(changes=[y[[0, 2]] for y in x.changes]) for x in found]
    assert_spans(found, words, np.angle(np.exp(1j * (ends[0] - ends[1]))) / 2e-5)


def test_machines_are_named_with_their_sizes() -> None:
    """A body that is not round also if the spin is not recorded."""
    outcome = alone(*seen(rows=180, drag=0.05))
    assert "a decay of the spin by" in outcome.failure()
    shown = outcome.shown["a decay of the spin"]
    assert abs(shown.size - 0.05) < 4 * shown.std
    failure = alone(*seen(rows=180, noise=0.06, beside=0.2)).failure()
    assert "a centre of mass off the axis by " in failure
    assert abs(float(failure.rpartition("if r0 = ")[2].split(";")[0]) - R0) < 1


def test_a_clock_whose_rate_wanders_is_no_lost_row() -> None:
    t = np.arange(120) / 60
    late = t + 0.05 / 3 * (np.sin(3 * t + 1) - np.sin(1))
    angles = recorded("theta", "psi", top=MACHINE, t=late, noise=1.1, seed=4)[1]
    assert alone(t, angles).neighbour.startswith("a clock whose rate wanders by ")


def test_a_jump_is_named_and_reasons_are_in_the_order_of_their_kinds() -> None:
    t, angles = seen(*ANGLES)
    angles["psi"] += 0.1 * (t > 1.2)
    assert "a jump of psi by 5." in fitted(t, angles).failure()
    angles["theta"][30] += 1.0
    kinds = [x.kind for x in alone(t, {x: angles[x] for x in ("theta", "psi")}).failed]
    assert kinds == sorted(kinds)
    assert len(kinds) > 1


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
    top = Top(m=1, s=1, g=60, A=1, C=0.6, r0=50, theta0_deg=1.2 / DEGREE, psidot0=2.2)
    outcome = fitted(
        *recorded(
            "theta",
            "psi",
            top=top,
            rows=120,
            seconds=1.2,
            noise=0.03,
            seed=5,
            sizes={"stand": 0.03},
        )
    )
    assert outcome.verdict == "good"
    found = outcome.numbers["a"]
    off = abs(found.value / 120 - 1)
    assert off > 5 * found.std / 120
    assert off < 3 * outcome.model_errors["a"] + 2 * found.std / 120


def test_rows_that_may_be_lost_are_in_the_model_error() -> None:
    """Two rows of 63 are too few to be sure of."""
    t, angles = seen(rows=65, noise=2.9, seed=3)
    one = fitted(t[:63], {x: np.delete(y, [30, 31]) for x, y in angles.items()})
    a, model = one.numbers["a"], one.model_errors.get("a", 0.0) * A
    assert one.verdict == "failed" or abs(a.value - A) < 5 * a.std + model


@pytest.mark.parametrize(
    ("kind", "rows", "start"),
    [("quaternion", 70, {}), ("axis", 500, {"theta0_deg": 55, "psidot0": 2})],
)
def test_rounding_errors_show_no_neighbour(kind: str, rows: int, start: dict[str, float]) -> None:
    """A motion without noise is not one with a jump of 1e-13 degrees."""
    t = np.linspace(0, 1.2, rows)
    columns = solve(TOP.replace(**start)).table(t, [kind])
    outcome = fitted(t, {kind: np.stack([*columns.values()], axis=1)})
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
    late = {x: filtered(np.unwrap(y), 3, "lag")[24:] for x, y in angles.items()}  # it has settled
    exact = motion_of(MACHINE, t)["theta"][24] / DEGREE
    outcome = fitted(t[24:], late)
    assert outcome.verdict == "good", outcome.failures()
    theta0 = outcome.numbers["theta0_deg"]
    assert 1 < abs(exact - theta0.value) < 3 * theta0.std < 10


def test_a_quaternion_that_is_smoothed_is_named_and_one_of_length_0_is_missing() -> None:
    """Trackers write zeros while they do not see the top."""
    t, angles = seen(*ANGLES, rows=240)
    quaternion: Any = wxyz(attitude_of(angles))
    smooth = np.apply_along_axis(filtered, 0, quaternion[::4], 5, "mean")
    said = fit(t[::4], quaternion=smooth).failure()
    assert said.startswith("the length of the quaternion varies from 0."), said
    quaternion[100:103] = 0
    assert fit(t, quaternion=quaternion).verdict == "good"
