"""Neighbours of a Lagrange top: their templates, their sizes, and what they change unseen."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from lagtop import fit, solve
from noisy_recordings import TOP, axis_of, fitted
from scipy.spatial.transform import Rotation

from lagrange_cli.arithmetic.types import Array
from lagrange_cli.inverse.neighbours import machines
from lagrange_cli.inverse.variations import Variations

sys.path.append(str(Path(__file__).parents[1] / "tools"))

from machines import gimballed, unlike

START = np.array([1.1, 0.3, 0.9])
A, B, R0 = 80.0, 12.0, 20.0


def stacked(seen: dict[str, Array]) -> Array:
    return np.stack([seen[x] for x in ("theta", "phi", "psi")])


@pytest.mark.parametrize(
    ("words", "size", "sign"),
    [
        ("stand", "stand", 1),
        ("yoke", "yoke", 1),
        ("decay", "drag", 1),
        ("vertical bearing", "vertical", 1),
        ("bearing of the tilt", "nodes", 1),
        ("second torque", "magnet", 1),
        ("off the axis", "beside", 1),
        ("moments", "moments", 1),
    ],
)
def test_a_template_is_the_change_of_the_motion(words: str, size: str, sign: int) -> None:
    """Of machines by an integrator; in one direction at least."""
    t = np.linspace(0, 3, 600)
    move = unlike if size in {"moments", "beside"} else gimballed
    ends = [stacked(move(A, B, R0, START, t, **{size: x})) for x in (1e-4, -1e-4)]
    expected = (ends[0] - ends[1]) / 2e-4
    motion = Variations(np.array([A, B, *START]), R0 / B, t)
    (changes,) = [x.changes for x in machines(motion) if words in x.name]
    ways = np.stack([x.ravel() for x in changes], axis=1)
    factors = np.linalg.lstsq(ways, expected.ravel(), rcond=None)[0]
    rest = expected.ravel() - ways @ factors
    assert np.abs(rest).max() < 0.02 * np.abs(expected).max()
    assert np.linalg.norm(factors) == pytest.approx(1, abs=0.02)


def noisy(**sizes: float) -> tuple[Array, Array]:
    t = np.linspace(0, 3, 300)
    noise = np.random.default_rng(3).normal(scale=3e-3, size=(3, t.size))
    return t, stacked(gimballed(A, B, R0, START, t, **sizes)) + noise


def test_a_decay_is_named_with_its_size() -> None:
    t, (theta, _, psi) = noisy(drag=0.05)
    outcome = fit(t, theta=theta, psi=psi)
    assert outcome.verdict == "failed"
    assert "a decay of the spin by" in outcome.failure()
    assert outcome.neighbours is not None
    shown = outcome.neighbours.shown[0]
    assert abs(shown.size - 0.05) < 4 * shown.std


def test_an_honest_top_is_good_and_has_model_errors() -> None:
    t, (theta, phi, psi) = noisy()
    outcome = fit(t, theta=theta, phi=phi, psi=psi)
    assert (outcome.verdict, outcome.neighbour) == ("good", "")
    record = outcome.record()
    assert record["untested"].startswith("1 % each of ")
    assert 0.1 < record["a_model_percent"] < 3
    outcome = fit(t, theta=theta, psi=psi, known={"m": 1, "g": 10, "s": 4, "r0": R0})
    assert outcome.model_errors["A"] == outcome.model_errors["a"]


def test_a_model_error_holds_a_stand_that_is_not_seen() -> None:
    """The error of a small nutation in a stand of 3 % of A is three times that of 1 %."""
    t = np.linspace(0, 1.2, 120)
    a, b, start = 120.0, 30.0, np.array([1.2, 0.0, 2.2])
    seen = gimballed(a, b, 50, start, t, stand=0.03)
    noise = np.random.default_rng(5).normal(scale=5e-4, size=(2, t.size))
    outcome = fit(t, theta=seen["theta"] + noise[0], psi=seen["psi"] + noise[1])
    assert outcome.verdict == "good"
    found = outcome.numbers["a"]
    off = abs(found.value / a - 1)
    assert off > 5 * found.std / a
    assert off < 3 * outcome.model_errors["a"] + 2 * found.std / a


def test_a_body_that_is_not_round_is_named_with_a_spin_that_is_not_seen() -> None:
    t = np.linspace(0, 3, 300)
    noise = np.random.default_rng(3).normal(scale=1e-3, size=(2, t.size))
    seen = unlike(A, B, R0, START, t, beside=0.2)
    outcome = fit(t, theta=seen["theta"] + noise[0], psi=seen["psi"] + noise[1])
    assert "a centre of mass off the axis by " in outcome.failure()
    spin = float(outcome.failure().rpartition("if r0 = ")[2].split(";")[0])
    assert abs(spin - R0) < 1


def test_rows_that_may_be_lost_are_in_the_model_error() -> None:
    """Two rows of 63 are too few to be sure of."""
    t = np.arange(63) / 60
    seen = gimballed(A, B, R0, START, np.arange(65) / 60)
    noise = np.random.default_rng(3).normal(scale=0.05, size=(2, 65))
    kept = np.delete(np.arange(65), [30, 31])
    one = fit(t, theta=(seen["theta"] + noise[0])[kept], psi=(seen["psi"] + noise[1])[kept])
    off = abs(one.numbers["a"].value - A)
    model = one.model_errors.get("a", 0.0) * A
    assert one.verdict == "failed" or off < 5 * one.numbers["a"].std + model


def test_a_jump_is_named() -> None:
    t, (theta, phi, psi) = noisy()
    outcome = fit(t, theta=theta, phi=phi, psi=np.where(t > 1.2, psi + 0.1, psi))
    assert "a jump of psi by 5." in outcome.failure()


@pytest.mark.parametrize(
    ("kind", "rows", "tilt", "rate"), [("quaternion", 70, 75, 0), ("axis", 500, 55, 2)]
)
def test_rounding_errors_show_no_neighbour(kind: str, rows: int, tilt: float, rate: float) -> None:
    """A motion without noise is not one with a jump of 1e-13 degrees."""
    t = np.linspace(0, 1.2, rows)
    theta, phi, psi = solve(TOP.replace(theta0_deg=tilt, psidot0=rate)).angles(t)
    turns = Rotation.from_euler("ZXZ", np.stack([psi, theta, phi], axis=1))
    seen = {"quaternion": turns.as_quat(scalar_first=True), "axis": axis_of(theta, psi)}
    outcome = fitted(t, {kind: seen[kind]})
    assert outcome.verdict == "good", outcome.failures()
    assert outcome.model_errors
