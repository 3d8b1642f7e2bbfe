"""`fit`: tops behind recordings of integrators, of every kind, with noise of a known size."""

from __future__ import annotations

import math

import fuzz_fits
import numpy as np
import pytest
import recordings
from engines import Body, dop853
from lagtop import LagtopError, Top, fit, solve
from noisy_recordings import (
    DEGREE,
    TOP,
    TRUTH,
    assert_true,
    axis_of,
    fitted,
    motion_of,
    recorded,
    recording_from,
)
from scipy.spatial.transform import Rotation

from lagrange_cli.inverse.motions import angles, nutating, states_of
from lagrange_cli.inverse.problem import problem_of
from lagrange_cli.recordings.doubts import pivot_of

SLOW = ("small", "attitude", "pole", "encoder", "smooth", "known")


@pytest.mark.parametrize("signs", [(1, 1), (-1, -1)])
def test_tops_of_a_nutation_have_its_period_its_tilts_and_its_rate(signs: tuple[int, int]) -> None:
    one = np.array([0.5]), np.array([1.2]), 0.4, np.array([0.3]), signs
    a, b, beta, rate = (float(x[0]) for x in nutating(*one))
    start = (beta - b * math.cos(0.5)) / math.sin(0.5) ** 2
    t = np.array([0.2, 0.4, 4.0])
    theta, _, psi = angles(states_of(a, b, 0.5, 0.0, start)[np.newaxis], t)[:, 0]
    assert theta == pytest.approx([1.2, 0.5, 0.5], abs=1e-7)
    assert psi[2] / 4 == pytest.approx(rate, rel=1e-9)


@pytest.mark.parametrize(
    "names",
    [
        ("theta", "psi"),
        pytest.param(("theta", "phi"), marks=pytest.mark.slow),
        pytest.param(("phi", "psi"), marks=pytest.mark.slow),
    ],
)
def test_recorded_angles_give_the_top(names: tuple[str, ...]) -> None:
    rows = 50 if "theta" in names and "psi" in names else 120
    t, seen = recorded(*names, rows=rows, seconds=0.018 * rows, noise=0.2, seed=1)
    assert_true(fitted(t, seen, sigma=0.2 * DEGREE), TRUTH | {"theta0_deg": 75, "psidot0": 0})


def test_either_direction_of_psi() -> None:
    t, seen = recorded("theta", "phi", "psi", seed=3)
    outcome = fit(t, theta=seen["theta"], phi=seen["phi"], psi=-seen["psi"])
    assert_true(outcome, TRUTH)
    assert outcome.notes[0] == "psi counts in the other direction: its sign was changed"


@pytest.mark.parametrize("kind", ["axis", "quaternion"])
def test_an_axis_and_an_attitude(kind: str) -> None:
    rng, t = np.random.default_rng(4), np.linspace(0, 1.2, 70)
    turns = Rotation.from_quat(dop853(Body.of(TOP), t)[1][:, :4], scalar_first=True)
    noisy = turns * Rotation.from_rotvec(rng.normal(scale=0.3 * DEGREE, size=(70, 3)))
    values = noisy.as_quat(scalar_first=True) if kind == "quaternion" else noisy.as_matrix()
    outcome = fit(t, **{kind: values if kind == "quaternion" else values[:, :, 2]})
    assert_true(outcome, TRUTH)
    assert [*outcome.residuals] == ["theta", "across", *["along"] * (kind == "quaternion")]


def test_residuals_of_an_attitude_are_a_small_rotation() -> None:
    """Along the meridian, across it, and about the axis: the rotation in the frame of the body."""
    t, exact = np.linspace(0, 1, 20), motion_of(TOP, np.linspace(0, 1, 20))
    turns = Rotation.from_euler("ZXZ", np.stack([exact[x] for x in ("psi", "theta", "phi")], 1))
    small = np.random.default_rng(24).normal(scale=1e-4, size=(20, 3))
    moved = (turns * Rotation.from_rotvec(small)).as_quat(scalar_first=True)
    recording = recording_from(t, quaternion=moved)
    state = np.array([[TRUTH["a"], TRUTH["b"], 75 * DEGREE, 0.0, 0.0]])
    zeros = np.array([[0.0], [0.0], [TRUTH["r0"]]])
    problem, x = problem_of(recording, np.ones(3), state, zeros, None)
    theta, across, along = problem.residuals(x[:, np.newaxis])[0, 0]
    assert along == pytest.approx(small[:, 2], abs=1e-7)
    assert np.hypot(theta, across) == pytest.approx(np.hypot(small[:, 0], small[:, 1]), abs=1e-7)


@pytest.mark.parametrize(
    ("name", "known"),
    [
        ("theta", {"psidot0": 0}),
        ("psi", {"theta0_deg": 75}),
    ],
)
def test_one_angle_and_a_known_start(name: str, known: dict[str, float]) -> None:
    t, seen = recorded(name, seed=5)
    outcome = fitted(t, seen, known=known)
    assert_true(outcome, TRUTH)
    assert any("sign of b is not determined" in x for x in outcome.notes) == (name == "theta")


def test_a_top_next_to_the_vertical() -> None:
    """A nutation of a tenth of a degree about a tilt of half a degree."""
    top = Top(m=1, s=1, g=26.9, A=1, C=1.461, r0=11.14, theta0_deg=0.5)
    t, seen = recorded("theta", "phi", "psi", top=top, seconds=1.5, noise=0.02, seed=6)
    assert_true(fitted(t, seen), {"a": 53.8, "b": 1.461 * 11.14, "r0": 11.14})


@pytest.mark.parametrize(
    ("names", "theta0"),
    [pytest.param(("theta", "phi"), math.pi, marks=pytest.mark.slow), (("theta", "psi"), 0.0)],
)
def test_a_top_that_starts_upright_with_a_rate(names: tuple[str, ...], theta0: float) -> None:
    truth, t = {"a": TRUTH["a"], "b": 17.0, "r0": 30.0}, np.linspace(0, 1.2, 150)
    exact = fuzz_fits.Top(TRUTH["a"], 17.0, 30.0, theta0, 6.0, 0.0).motion(t)
    noise = np.random.default_rng(3).normal(scale=3e-3, size=(2, 150))
    seen = {x: np.angle(np.exp(1j * (exact[x] + y))) for x, y in zip(names, noise, strict=True)}
    seen["theta"] = np.abs(seen["theta"])
    assert_true(fitted(t, seen), truth)


@pytest.mark.slow
def test_irregular_times_with_two_rows_per_period() -> None:
    rng = np.random.default_rng(7)
    t = np.concatenate([[0], np.sort(rng.uniform(0, 20, 119))])
    top = Top(m=1, s=1, g=164, A=1, C=1.2, r0=-3.6, theta0_deg=66, thetadot0=1.3, psidot0=-2.5)
    exact = motion_of(top, t)
    seen = {x: np.angle(np.exp(1j * (exact[x] + rng.normal(scale=2e-3, size=120)))) for x in exact}
    assert_true(fitted(t, seen), {"a": 328, "b": -1.2 * 3.6, "r0": -3.6})


def test_the_sample_gives_the_body() -> None:
    rows = np.genfromtxt(recordings.SAMPLES / "recording.csv", delimiter=",", skip_header=3)
    t, (theta, psi, phi) = rows[::4, 0], np.radians(rows[::4, 1:].T)
    outcome = fit(t, theta=theta, psi=psi, phi=phi, known={"m": 1.587, "g": 9.81, "s": 0.04})
    assert_true(outcome, {"A": 3.9032e-3, "C": 1.7458e-3, "r0": 50, "theta0_deg": 41}, least=4)
    assert repr(outcome).startswith(f"fit of {t.size} rows: good\na   ")
    exact = solve(recordings.TOP)
    keys = ["T_nutation", "mean_precession_rate", "mean_spin_rate", "theta_max_deg"]
    assert_true(outcome, {key: getattr(exact, key) for key in keys}, least=4)
    for curve in outcome.curves():
        model, seen = np.interp(curve.t, curve.fine_t, curve.curve), np.isfinite(curve.data)
        off = curve.data - curve.residual - model
        assert off[seen] == pytest.approx(0, abs=0.05)
        rms = np.degrees(outcome.residuals[curve.name].rms)
        assert np.sqrt(np.mean(curve.residual[seen] ** 2)) == pytest.approx(rms)
    count = sum(x.y.size for x in outcome.residuals.values())
    assert outcome.dof == count - 8  # a, b, r0, three of the start, two zeros
    assert "11 % below the fit" in outcome.numbers["precession_rate_elementary"].meaning


def test_the_recordings_are_what_the_script_writes() -> None:
    for camera in (recordings.SMALL_TOP, recordings.WHEEL):
        assert recordings.text(camera) == (recordings.SAMPLES / camera.name).read_text()


@pytest.mark.slow
def test_noise_of_many_rows_is_averaged() -> None:
    """A thousand rows find the minimum, all rows refine it: uncertainties fall as 1/sqrt(rows)."""
    few, many = (fitted(*recorded("theta", "psi", rows=x, seed=8)) for x in (150, 2400))
    assert_true(many, TRUTH)
    for key in ("a", "b", "theta0_deg", "T_nutation"):
        assert few.numbers[key].std / many.numbers[key].std == pytest.approx(4, rel=0.15), key


@pytest.mark.parametrize("offset", [(0, 0, 0.05), (0.02, 0, 0), (0, 0, 0)])
def test_a_marker_whose_origin_is_not_at_the_pivot(offset: tuple[float, ...]) -> None:
    rng, exact = np.random.default_rng(19), motion_of(TOP, np.linspace(0, 3, 180))
    marker = 0.15 * axis_of(exact["theta"], exact["psi"]) + rng.normal(scale=1e-3, size=(180, 3))
    found = pivot_of(marker + offset)
    if any(offset):
        assert found
        assert (abs(found.at - offset) < 4 * found.std).all()
        assert found.std.max() < 0.005
    else:
        assert found is None


@pytest.mark.slow
def test_no_wrong_fit_of_a_random_recording_is_good_and_most_are_right() -> None:
    verdicts = [fuzz_fits.checked(seed, easy=True) for seed in range(3001, 3013)]
    assert all(x.is_right or x.word in {"failed", "refused"} for x in verdicts), verdicts
    assert sum(x.is_right and x.word == "good" for x in verdicts) >= 10
    sizes = np.abs([x for verdict in verdicts for x in verdict.pulls.values() if verdict.is_right])
    assert 0.5 < np.mean(sizes < 1) < 0.85


@pytest.mark.parametrize("look", ["axis", *(pytest.param(x, marks=pytest.mark.slow) for x in SLOW)])
def test_hard_recordings_are_fitted(look: str) -> None:
    results = [fuzz_fits.checked(seed, look=look) for seed in (1, 106)]
    assert all(x.is_right or not x.word.startswith("good") for x in results), results
    assert any(x.word == "good" for x in results), results


def test_windows_keep_the_time_and_have_rows_of_every_angle() -> None:
    t = 100 + np.arange(60) / 10
    parts = recording_from(t, theta=np.ones(60), psi=t).windows(3)
    assert [(x.name, x.t.size, x.t[0]) for x in parts] == [
        (f"window {i}", 20, 0) for i in (1, 2, 3)
    ]
    assert [x.t_start for x in parts] == pytest.approx([100, 102, 104], abs=0.11)
    assert [x.middle for x in parts] == pytest.approx([100.95, 102.95, 104.95], abs=0.11)
    with pytest.raises(LagtopError, match="12 rows or more in each window, got 0"):
        recording_from(t, theta=np.ones(60), psi=np.where(t < 102, t, np.nan)).windows(3)


def test_arrays_that_are_no_recording_are_refused_by_name() -> None:
    """Arrays come from no file: angles in degrees, and an axis without direction."""
    t = np.linspace(0, 1, 50)
    with pytest.raises(LagtopError, match=r"^the recording: theta must be between 0 and 180 deg"):
        fit(t, theta=np.full(50, 100.0), psi=t)
    with pytest.raises(LagtopError, match=r"^the recording: it must have 12 rows or more"):
        fit(t, axis=np.zeros((50, 3)))


def test_any_unit_of_time() -> None:
    t, seen = recorded("theta", "psi", seed=8)
    scale = 1e-9
    one, other = fitted(t, seen), fitted(t / scale, seen)
    assert other.verdict == "good"
    assert other.frequency / scale == pytest.approx(one.frequency, rel=1e-6)
    powers = {"a": 2, "b": 1, "theta0_deg": 0, "T_nutation": -1, "T_nutation_elementary": -1}
    powers |= {"mean_precession_rate": 1, "precession_rate_elementary": 1, "psidot0": 1}
    for key, power in powers.items():
        found, std = other.numbers[key][:2]
        assert found == pytest.approx(one.numbers[key].value * scale**power, abs=0.02 * std)
