"""`fit`: tops behind data that integrators made, with noise of a known size."""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import recordings
from conftest import Lagtop, assert_one_line
from engines import Array, Body, dop853
from lagtop import LagtopError, Top, fit, read_scene, solve
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from lagrange_cli.inverse.advice import evenly_timed, release
from lagrange_cli.inverse.checks import CHANCE, Residuals, chi2_bounds
from lagrange_cli.inverse.decay import decay_of, fit_windows
from lagrange_cli.inverse.known import known_inputs
from lagrange_cli.inverse.measured import Measured, measured
from lagrange_cli.inverse.motions import angles, nutating, states_of
from lagrange_cli.inverse.outcome import Outcome
from lagrange_cli.inverse.problem import Problem
from lagrange_cli.inverse.search import best_fit
from lagrange_cli.recordings.doubts import pivot_of
from lagrange_cli.recordings.recording import recording_of
from lagrange_cli.top.given import gather
from lagrange_cli.top.values import values_of

sys.path.append(str(Path(__file__).parents[1] / "tools"))
DEGREE = math.pi / 180
TOP = Top(m=0.5, A=4.45e-3, C=2.5e-3, s=0.08, g=9.81, r0=52.36, theta0_deg=75)
"""A disc on an axle, released from rest."""
TRUTH = {"a": 2 * 0.5 * 9.81 * 0.08 / 4.45e-3, "b": 2.5e-3 / 4.45e-3 * 52.36, "r0": 52.36}
LAB = {"m": 0.5, "g": 9.81, "s": 0.08}


def recording_from(t: Array, **arrays: Array) -> Measured:
    """Return the measured motion in arrays of radians."""
    return measured(recording_of(t, arrays))


def motion_of(top: Top, t: Array) -> dict[str, Array]:
    """Return the angles of a top at times, by Euler's equations of a quaternion."""
    turns = Rotation.from_quat(dop853(Body.of(top), t)[1][:, :4], scalar_first=True)
    psi, theta, phi = turns.as_euler("ZXZ").T
    return {"theta": theta, "phi": phi, "psi": psi}


def recorded(
    *names: str, top: Top = TOP, rows: int = 50, seconds: float = 0.9, noise: float = 0.3, seed: int
) -> tuple[Array, dict[str, Array]]:
    """Return times and noisy angles, within half a turn but for the tilt."""
    rng, t = np.random.default_rng(seed), np.linspace(0, seconds, rows)
    exact = motion_of(top, t)
    found = {x: exact[x] + rng.normal(scale=noise * DEGREE, size=rows) for x in names}
    return t, {x: y if x == "theta" else np.angle(np.exp(1j * y)) for x, y in found.items()}


def axis_of(theta: Array, psi: Array) -> Array:
    """Return the figure axis, shape (n, 3)."""
    flat = np.sin(theta)
    return np.stack([flat * np.sin(psi), -flat * np.cos(psi), np.cos(theta)], axis=-1)


def fitted(t: Array, seen: Mapping[str, Array], **options: Any) -> Outcome:
    """Return the fit of a recording."""
    arrays: dict[str, Any] = dict(seen)
    return fit(t, **arrays, **options)


def pulls(outcome: Outcome, truth: Mapping[str, float]) -> dict[str, float]:
    """Return how far numbers are from the truth, in standard deviations."""
    found = outcome.numbers
    return {x: (found[x].value - y) / found[x].std for x, y in truth.items() if x in found}


def assert_true(outcome: Outcome, truth: Mapping[str, float], *, least: int = 2) -> None:
    """Check that a fit is good, and that its numbers are right."""
    assert outcome.verdict == "good", outcome.failures()
    off = pulls(outcome, truth)
    assert len(off) >= least
    assert all(abs(x) < 4 for x in off.values()), off


# Many tops at once


@pytest.mark.parametrize("signs", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_tops_of_a_nutation_have_its_period_its_tilts_and_its_rate(signs: tuple[int, int]) -> None:
    one = np.array([0.5]), np.array([1.2]), 0.4, np.array([0.3]), signs
    a, b, beta, rate = (float(x[0]) for x in nutating(*one))
    start = (beta - b * math.cos(0.5)) / math.sin(0.5) ** 2
    t = np.array([0.2, 0.4, 4.0])
    theta, _, psi = angles(states_of(a, b, 0.5, 0.0, start)[np.newaxis], t)[:, 0]
    assert theta == pytest.approx([1.2, 0.5, 0.5], abs=1e-7)
    assert psi[2] / 4 == pytest.approx(rate, rel=1e-9)


# Recordings of every kind


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "names",
    [
        ("theta", "psi"),
        pytest.param(("theta", "phi", "psi"), marks=pytest.mark.slow),
        pytest.param(("theta", "phi"), marks=pytest.mark.slow),
        pytest.param(("phi", "psi"), marks=pytest.mark.slow),
    ],
)
def test_recorded_angles_give_the_top(names: tuple[str, ...], seed: int) -> None:
    rows = 50 if "theta" in names and "psi" in names else 120
    t, seen = recorded(*names, rows=rows, seconds=0.018 * rows, noise=0.2, seed=seed)
    sigma = 0.2 * DEGREE if seed else None
    assert_true(fitted(t, seen, sigma=sigma), TRUTH | {"theta0_deg": 75, "psidot0": 0})


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
    problem = Problem(recording, known_inputs(gather({})), np.ones(3))
    start = TRUTH | {"theta0": 75 * DEGREE}
    x = np.array([[start.get(name, 0.0) for name in problem.names]])
    theta, across, along = problem.residuals(x)[0]
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
    assert "11 % too small" in outcome.numbers["precession_rate_elementary"].meaning


def test_the_recordings_are_what_the_script_writes() -> None:
    for camera in (recordings.SMALL_TOP, recordings.WHEEL):
        assert recordings.text(camera) == (recordings.SAMPLES / camera.name).read_text()


# Known inputs


@pytest.mark.parametrize(
    ("known", "truth"),
    [
        (LAB | {"C": 2.5e-3, "A": 4.45e-3}, {"r0": 52.36, "b": TRUTH["b"]}),
        ({"r0": 52.36, "C": 2.5e-3, "g": 9.81}, {"A": 4.45e-3, "m*s": 0.04}),
        *(
            pytest.param(known, truth, marks=pytest.mark.slow)
            for known, truth in (
                (LAB | {"C": 2.5e-3}, {"r0": 52.36, "A": 4.45e-3}),
                (LAB | {"C": "0.0025(1)", "r0": "52.4(9)"}, {"A": 4.45e-3, "b": TRUTH["b"]}),
                (LAB | {"r0": 52.36}, {"C": 2.5e-3, "A": 4.45e-3}),
            )
        ),
        ({"A": 4.45e-3, "C": 2.5e-3, "r0": 52.36}, {"a": TRUTH["a"], "m*g*s": 0.3924}),
        (LAB | {"A_cm": 4.45e-3 - 0.5 * 0.08**2}, {"b": TRUTH["b"], "C*r0": 2.5e-3 * 52.36}),
        (LAB | {"theta0_deg": 75, "psidot0": 0}, {"A": 4.45e-3, "b": TRUTH["b"]}),
    ],
)
def test_known_inputs_determine_others(known: dict[str, float], truth: dict[str, float]) -> None:
    t, seen = recorded("theta", "psi", seed=8)
    outcome = fitted(t, seen, known=known)
    assert_true(outcome, truth)
    assert known.keys() & outcome.numbers.keys() <= {"C", "r0"}  # if they are improved
    assert not any("is not used" in x for x in outcome.notes)
    product = "only C*r0 can be determined, unless C or r0 is given"
    assert (product in outcome.notes) == ("C*r0" in outcome.numbers)


@pytest.mark.parametrize(
    ("known", "truth"),
    [
        (LAB | {"C": 2.5e-3, "phidot0": 40}, {"A": 4.45e-3, "psidot0": 6}),
        ({"g": 9.81, "C": 2.5e-3, "phidot0": "40"}, {"A": 4.45e-3, "m*s": 0.04}),
    ],
)
def test_a_known_rate_of_spin_is_no_total_spin(known: Any, truth: dict[str, float]) -> None:
    """r0 = phidot0 + psidot0 cos(theta0), and a scene has the motion whatever is not known."""
    top = Top(**LAB, A=4.45e-3, C=2.5e-3, phidot0=40, psidot0=6, theta0_deg=75)
    t, seen = recorded("theta", "psi", "phi", top=top, seed=8)
    nothing: dict[str, Any] = {}
    for some in (known, nothing):
        outcome = fitted(t, seen, known=some)
        spin = {"r0": float(top.r0)} if outcome.numbers.keys() & {"r0"} else {}
        assert_true(outcome, (truth if some else {}) | spin | {"a": solve(top).a}, least=2)
        assert outcome.inputs is not None
        again, exact = solve(Top(**outcome.inputs)), solve(top)
        for key in ("a", "b", "T_nutation", "mean_precession_rate"):
            assert getattr(again, key) == pytest.approx(getattr(exact, key), rel=0.02), key


def test_an_uncertain_input_widens_only_what_depends_on_it() -> None:
    t, seen = recorded("theta", "psi", seed=9)
    sure, unsure = (fitted(t, seen, known=LAB | {"C": c}).numbers for c in (2.5e-3, "0.0025(1)"))
    assert unsure["r0"].std == pytest.approx(52.36 * 0.04, rel=0.01)
    assert "C" not in unsure  # the recording does not improve it
    assert unsure["r0"].own_std == pytest.approx(sure["r0"].std, rel=1e-3)
    for key in ("T_nutation", "mean_precession_rate", "b", "A"):
        assert unsure[key][:2] == pytest.approx(sure[key][:2], rel=1e-4)


@pytest.mark.parametrize(
    "rough",
    [{"C": "0.003(1)"}, {"m": "0.2(2)", "A": 4.44e-3}],
)
def test_a_rough_input_is_improved(rough: dict[str, Any]) -> None:
    """The fit with it begins in phase with the recording, whatever b the rough value implies."""
    t, seen = recorded("theta", "psi", "phi", seed=9)
    found = fitted(t, seen, known=LAB | rough)
    assert_true(found, TRUTH)
    assert found.numbers["b"].std < 0.3


def test_a_prior_lies_between_a_known_input_and_none() -> None:
    """The estimate of A is the mean of prior and data, weighted by their variances."""
    t, seen = recorded("theta", "psi", seed=10)
    value, std, *_ = fitted(t, seen, known=LAB).numbers["A"]
    prior, spread = 4.44e-3, 3 * std
    found = fitted(t, seen, known=LAB | {"A": f"{prior!r} +/- {spread!r}"}).numbers["A"]
    weights = np.array([std**-2, spread**-2])
    assert found.value == pytest.approx(weights @ [value, prior] / weights.sum(), abs=0.02 * std)
    assert found.std == pytest.approx(weights.sum() ** -0.5, rel=0.02)


# Wrong, hopeless and steady recordings


def slowed(time: float, t: Array) -> dict[str, Array]:
    """Return the angles of TOP if friction slows its spin as exp(-t/time), by Euler's equations."""
    half, ratio = TRUTH["a"] / 2, TRUTH["b"] / TRUTH["r0"]

    def slope(now: float, state: Array) -> list[float]:
        theta, rate, _, turn, _ = state
        spin, u, sine = 52.36 * math.exp(-now / time), math.cos(theta), math.sin(theta)
        up = (turn * turn * u - ratio * spin * turn + half) * sine
        around = (ratio * spin - 2 * turn * u) * rate / sine
        return [rate, up, turn, around, spin - turn * u]

    start = [75 * DEGREE, 0.0, 0.0, 0.0, 0.0]
    flow = solve_ivp(slope, (0, t[-1]), start, "DOP853", t, rtol=1e-10, atol=1e-10)
    return {"theta": flow.y[0], "psi": flow.y[2], "phi": flow.y[4]}


@pytest.mark.slow
def test_exchanged_spin_and_precession_are_noticed() -> None:
    t, seen = recorded("theta", "phi", "psi", seed=24)
    sigma = {"theta": DEGREE, "phi": 3 * DEGREE, "psi": 0.1 * DEGREE}  # by the names of the paper
    outcome = fitted(t, seen | {"phi": seen["psi"], "psi": seen["phi"]}, sigma=sigma)
    assert outcome.verdict == "failed"
    assert "phi and psi are exchanged: here phi is the spin and psi the" in outcome.failure()


def test_an_outlier_is_named() -> None:
    t, seen = recorded("theta", "psi", seed=8)
    seen["psi"][30] += 20 * DEGREE
    failure = fitted(t, seen).failure()
    ((off, at),) = re.findall(r"^psi is (.*) deg off at t = (.*), far more than else", failure)
    assert float(off) == pytest.approx(20, abs=1)
    assert float(at) == pytest.approx(t[30], rel=1e-5)
    assert failure.endswith(f"; leave out the rows at t = {at}")


@pytest.mark.parametrize(
    "seed", [106, *(pytest.param(x, marks=pytest.mark.slow) for x in (14, 102, 111, 118, 126))]
)
def test_a_top_that_starts_on_a_pole_is_fitted(seed: int) -> None:
    import fuzz_fits

    assert fuzz_fits.checked(seed, look="pole").fate == "right, good"


def test_a_tilt_that_stays_at_a_pole_is_no_top() -> None:
    t, rng = np.linspace(0, 3, 90), np.random.default_rng(5)
    swing = np.abs(0.02 * np.sin(9 * t)) + np.abs(rng.normal(scale=0.02, size=90))
    assert fit(t, theta=swing, phi=3 * t, psi=2 * np.sin(9 * t)).verdict == "failed"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "verdict"),
    [
        (70101, "failed"),  # one phi at a pole would determine all
        (50132, "failed"),  # a mirror image has another a
        (70204, "good"),  # a mirror image would need a turn per row
        (70117, "good"),  # bins hide leaps of psi
        (90130, "good"),  # the mirror image is as near, with a turn per row
        (90536, "good"),  # the valley of chi^2 is long and bent
        (93495, "good, no nutation"),  # a nutation that noise resembles
        (90690, "good"),  # C does not show how many turns the spin makes
    ],
)
def test_verdicts_near_a_pole_in_a_bent_valley_or_with_another_top(seed: int, verdict: str) -> None:
    import fuzz_fits

    result = fuzz_fits.checked(seed)
    assert result.word == verdict
    assert result.is_right or verdict == "failed"


def test_noise_of_psi_and_phi_may_grow_beside_a_pole() -> None:
    """A tracker sees the axis, whose noise turns psi and phi by large angles near the pole."""
    import fuzz_fits

    case, rng = fuzz_fits.drawn(106, look="pole"), np.random.default_rng(1)
    seen: Any = dict(case.arrays)
    turned = rng.normal(scale=case.noise["theta"], size=case.t.size) / np.sin(seen["theta"])
    seen["psi"] = seen["psi"] + turned
    seen["phi"] = seen["phi"] - turned * np.cos(seen["theta"])
    outcome = fit(case.t, **seen)
    assert (outcome.verdict, outcome.recording.kind) == ("good", "attitude")
    pulls = fuzz_fits.pulls(outcome, case, mirrored=False)
    assert all(abs(x) < fuzz_fits.FAR for x in pulls.values()), pulls


def test_an_oscillation_is_no_noise_that_ends_where_it_does_not_correlate() -> None:
    t, white = np.arange(400.0), np.random.default_rng(1).normal(size=400)
    smooth = np.convolve(white, np.ones(5) / 5, mode="same")
    assert Residuals(t, white).reach <= 2
    assert 4 <= Residuals(t, smooth).reach <= 6
    assert Residuals(t, np.sin(0.9 * t) + white / 10).reach > t.size / 5


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["angles", "quaternion", "axis"])
def test_a_decay_within_each_window_is_named(kind: str) -> None:
    rng, t = np.random.default_rng(12), np.linspace(0, 6, 1441)
    seen = {x: y + rng.normal(scale=0.3 * DEGREE, size=t.size) for x, y in slowed(27, t).items()}
    if kind == "quaternion":
        turns = Rotation.from_euler("ZXZ", np.stack([seen[x] for x in ("psi", "theta", "phi")], 1))
        seen = {kind: turns.as_quat(scalar_first=True)}
    elif kind == "axis":
        seen = {kind: axis_of(seen["theta"], seen["psi"])}
    failure = fitted(t, seen).failure()
    found = re.search(r"the spin decays: (r0|b) falls from (\d+).* to (\d+).*within each", failure)
    assert found, failure
    first = TRUTH["b" if kind == "axis" else "r0"]
    shown = [int(x) for x in found.groups()[1:]]
    assert shown == pytest.approx([first, first * math.exp(-6 / 27)], abs=2)


def test_a_release_is_seen_beside_missing_cells() -> None:
    rng = np.random.default_rng(13)
    theta = np.concatenate([np.full(40, 1.0), 1 + 0.2 * np.sin(np.arange(1, 61) / 4) ** 2])
    theta += rng.normal(scale=1e-3, size=100)
    theta[[3, 20, 50]] = np.nan
    recording = recording_from(np.arange(100.0), theta=theta)
    assert 40 <= recording.t[release(recording)] <= 43
    t, seen = recorded("theta", "psi", rows=180, seconds=3, seed=13)
    moving = recording_from(t, theta=seen["theta"], psi=seen["psi"])
    assert release(moving) == 0  # psi' is 0 in the first row


@pytest.mark.slow
def test_friction_fails_and_windows_give_the_decay() -> None:
    rng, t = np.random.default_rng(11), np.linspace(0, 12, 361)
    seen = {x: y + rng.normal(scale=0.3 * DEGREE, size=361) for x, y in slowed(60, t).items()}
    del seen["phi"]
    outcome = fitted(t, seen)
    assert outcome.verdict == "failed"
    assert "the spin decays: use window=10" in outcome.failure()
    windows = fit_windows(
        recording_from(t, theta=seen["theta"], psi=seen["psi"]),
        12,
        known_inputs(gather(values_of(LAB))),
    )
    assert {x.verdict for x in windows} == {"good"}
    decay = decay_of(windows)
    assert decay is not None
    assert decay.time is not None
    assert abs(decay.time - 60) < 4 * (decay.time_std or 0) < 4
    assert decay.quantity == "b"


def _of_body(seen: Mapping[str, Array]) -> Array:
    """Return quaternions in the order w, x, y, z."""
    turns = Rotation.from_euler("ZXZ", np.stack([seen["psi"], seen["theta"], seen["phi"]], 1))
    return np.asarray(turns.as_quat(scalar_first=True))


def _of_engine(seen: Mapping[str, Array]) -> Array:
    """Return quaternions with y as the figure axis, in a space whose y axis points up."""
    turns = Rotation.from_euler("ZXZ", np.stack([seen["psi"], seen["theta"], seen["phi"]], 1))
    frame = Rotation.from_matrix([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    return np.asarray((frame * turns * frame.inv()).as_quat(scalar_first=True))


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        pytest.param(lambda rng, t: slowed(20, t), "not noise", marks=pytest.mark.slow),
        (
            lambda rng, t: {x: rng.uniform(0.2, 3, t.size) for x in ("theta", "psi")},
            "the tilt varies",
        ),
        (
            lambda rng, t: {
                "axis": axis_of(*[slowed(1e9, t)[x] for x in ("theta", "psi")])[:, ::-1]
            },
            "use align=up=x",
        ),
        (
            lambda rng, t: {
                "axis": axis_of(*[slowed(1e9, t)[x] for x in ("theta", "psi")])[:, [1, 2, 0]]
            },
            "the y axis of the data points up: use align=up=y",
        ),
        pytest.param(
            lambda rng, t: {"quaternion": _of_engine(slowed(1e9, t))},
            "the y axis is the figure axis: use align=up=y,axis=y",
            marks=pytest.mark.slow,
        ),
        (
            lambda rng, t: {"quaternion": np.roll(_of_body(slowed(1e9, t)), -1, axis=1)},
            "the quaternion is xyzw and was read as wxyz: quaternion_order=xyzw",
        ),
        (
            lambda rng, t: {"axis": -axis_of(*[slowed(1e9, t)[x] for x in ("theta", "psi")])},
            "or the marker is opposite to the centre of mass: use align=up=-z",
        ),
    ],
)
def test_recordings_of_no_top_fail(make: Any, reason: str) -> None:
    rng, t = np.random.default_rng(12), np.linspace(0, 3, 150)
    seen = {x: y + rng.normal(scale=0.003, size=y.shape) for x, y in make(rng, t).items()}
    outcome = fitted(t, seen)
    assert outcome.verdict == "failed"
    assert reason in outcome.record()["remark"]


def test_an_impossible_body_fails() -> None:
    """At uneven times, because whole turns per frame are invisible."""
    rng = np.random.default_rng(8)
    t = np.concatenate([[0], np.sort(rng.uniform(0, 0.9, 59))])
    seen = {x: y + rng.normal(scale=2e-3, size=60) for x, y in motion_of(TOP, t).items()}
    outcome = fit(t, theta=seen["theta"], psi=seen["psi"], phi=np.unwrap(seen["phi"]) / 5)
    said = "C/A = (.*) is impossible: a rigid body has 0 < C/A <= 2"
    (shown,) = re.findall(said, outcome.failure())
    assert float(shown) > 2


def test_noise_of_many_rows_is_averaged() -> None:
    """Above some hundred rows bins are fitted: the uncertainty falls as 1/sqrt(rows)."""
    few, many = (fitted(*recorded("theta", "psi", rows=x, seed=8)) for x in (300, 4800))
    assert_true(many, TRUTH)
    for key in ("a", "b", "theta0_deg", "T_nutation"):
        assert few.numbers[key].std / many.numbers[key].std == pytest.approx(4, rel=0.15), key


def test_an_attitude_whose_spin_is_wrong_fails() -> None:
    """Tilt and precession are right; only the residuals about the axis show it."""
    t, seen = recorded("theta", "phi", "psi", seed=13)
    seen["phi"] = seen["phi"] + 0.1 * t**2 * 20
    turns = Rotation.from_euler("ZXZ", np.stack([seen["psi"], seen["theta"], seen["phi"]], axis=1))
    outcome = best_fit(recording_from(t, quaternion=turns.as_quat(scalar_first=True)), {})
    assert outcome.verdict == "failed"
    assert any("residuals of along" in x for x in outcome.failures())


def test_sigma_is_tested_on_both_sides() -> None:
    t, seen = recorded("theta", "psi", seed=14)
    plain = fitted(t, seen)
    sigma = {x: y.rms * (100 / plain.dof) ** 0.5 for x, y in plain.residuals.items()}
    again = fitted(t, seen, sigma=sigma)
    assert again.chi2_dof == pytest.approx(1, rel=1e-3)
    assert again.numbers["b"][:2] == pytest.approx(plain.numbers["b"][:2], rel=1e-3)
    small, large = (fitted(t, seen, sigma=x * 0.3 * DEGREE) for x in (0.5, 2))
    assert re.match("chi2/dof = .*: the rms of (theta|psi) is (1.9|2)", small.failures()[0])
    assert large.verdict == "good"
    assert "the noise is below sigma" in large.remarks[-1]


@pytest.mark.parametrize(("way", "rows"), [(1, 200), (-1, 200), (1, 100)])
def test_a_fast_top_has_mean_rates(way: int, rows: int) -> None:
    """The nutation of 0.02 degrees is invisible; psi may count in either direction.

    A spin of a quarter of a turn per row or more does not show C.
    """
    top = TOP.replace(r0=400)
    t, seen = recorded("theta", "phi", "psi", top=top, rows=rows, seconds=0.5, seed=15)
    outcome = fit(t, theta=seen["theta"], phi=seen["phi"], psi=way * seen["psi"])
    assert outcome.verdict == "good, no nutation"
    assert outcome.inputs is None
    turn = f"only up to whole turns per row, multiples of {2 * math.pi * (rows - 1) / 0.5:.6g}"
    assert any(turn in x for x in outcome.notes)
    exact = solve(top)
    tilt = (exact.theta_min_deg + exact.theta_max_deg) / 2
    truth = {"mean_precession_rate": exact.mean_precession_rate, "r0": 400, "mean_tilt_deg": tilt}
    product = {200: {"C/(m*s*g)": 2.5e-3 / 0.3924}, 100: {"C*r0/(m*s*g)": 1 / 0.3924}}
    truth |= {"b/a": exact.b / exact.a} | product[rows]
    off = pulls(outcome, truth)
    assert off.keys() == truth.keys()
    assert all(abs(x) < 4 for x in off.values()), off
    with pytest.raises(LagtopError, match="a steady precession does not determine a top"):
        outcome.scene("data")


@pytest.mark.parametrize("ratio", [0.05, 0.2, 0.5])
def test_the_term_that_elementary_theory_neglects(ratio: float) -> None:
    """A Omega cos(theta) is in the uncertainty, or exact if A, m, g and s are known."""
    start = {"m": 1, "s": 0.5, "g": 100, "A": 1, "C": ratio, "r0": 30 / ratio, "theta0_deg": 40}
    top = Top(**start, psidot0=solve(Top(**start, psidot0="steady")).steady_rate_slow)
    t, seen = recorded("theta", "phi", "psi", top=top, rows=100, seconds=0.05, noise=0.02, seed=16)
    found = fitted(t, seen).numbers["b/a"]
    assert abs(found.value - 30 / 100) < 2 * found.std < 0.4 * found.value
    known = {"A_cm": 0.75, "m": 1, "g": 100, "s": 0.5}
    exact = fitted(t, seen, known=known).numbers
    assert exact["b/a"].std < 0.02 * found.value
    assert abs(exact["b/a"].value - 30 / 100) < 4 * exact["b/a"].std
    assert abs(exact["C"].value - ratio) < 4 * exact["C"].std


def test_a_tilt_that_swings_or_drifts_is_not_steady() -> None:
    rng, t = np.random.default_rng(17), np.linspace(0, 1, 100)
    psi = 2 * t + rng.normal(scale=0.01, size=100)
    for theta in (1 + 0.1 * t, 1 + 0.05 * np.sin(3 * t), 1 + rng.normal(scale=0.06, size=100)):
        noisy = theta + rng.normal(scale=0.01, size=100)
        outcome = best_fit(recording_from(t, theta=noisy, psi=psi), {})
        assert outcome.verdict == "failed", outcome.record()
    theta, psi = 1 + rng.normal(scale=0.01, size=100), rng.uniform(-3, 3, 100)
    hopeless = best_fit(recording_from(t, theta=theta, psi=psi), {})
    assert any(x.startswith("no motion of a top matches: psi is ") for x in hopeless.failures())
    few = fit(t[:20], theta=theta[:20], psi=2 * t[:20] + theta[:20])
    assert few.failures()[-1].startswith("20 rows are too few to tell nutation from noise")
    assert few.hints == []  # no column is wrong


def test_noise_hardly_ever_fails_a_test() -> None:
    rng, t = np.random.default_rng(18), np.linspace(0, 1, 90)
    faults = [any(Residuals(t, rng.normal(size=90)).faults("x", 4.0, CHANCE)) for _ in range(500)]
    assert sum(faults) <= 8  # 2.7 expected
    wave = Residuals(t, rng.normal(size=90) + 1.5 * np.sin(2 * math.pi * 22.25 * t))
    assert abs(wave.autocorrelation) < 0.2  # four rows per period
    assert next(wave.faults("x", 22.25, CHANCE)).endswith("they drift or oscillate")
    smooth = [np.convolve(rng.normal(size=304), np.ones(5) / 5, "valid") for _ in range(300)]
    faults = [any(Residuals(np.arange(300.0), y).faults("x", 0.05, CHANCE)) for y in smooth]
    assert sum(faults) <= 6
    drift = Residuals(t, rng.normal(size=90) + 3 * t * np.sin(8 * math.pi * t))
    assert any(drift.faults("x", 4.0, CHANCE))
    for dof in (1, 100):
        exact = chi2.ppf([CHANCE / 2, 1 - CHANCE / 2], dof) / dof
        assert chi2_bounds(dof) == pytest.approx(tuple(exact), rel=1e-6)
    low, high = chi2_bounds(100)
    sums = rng.chisquare(100, size=20_000) / 100
    assert np.mean((sums < low) | (sums > high)) == pytest.approx(CHANCE, abs=1.2e-3)


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
    import fuzz_fits

    verdicts = [fuzz_fits.checked(seed, easy=True) for seed in range(3001, 3013)]
    assert all(x.is_right or x.word in {"failed", "refused"} for x in verdicts), verdicts
    assert sum(x.is_right and x.word == "good" for x in verdicts) >= 10
    sizes = np.abs([x for verdict in verdicts for x in verdict.pulls.values() if verdict.is_right])
    assert 0.5 < np.mean(sizes < 1) < 0.85


# Bad data and the command


@pytest.mark.parametrize(
    ("header", "row", "message"),
    [
        ("t,theta,psi", "{t},40,10", "the precession rate is not determined"),
        ("t,p,q,r", "{t},1,2,3", "must have columns for angles, an axis or an attitude"),
        ("t,x,y", "{t},1,2", r"psi alone \(from t, x, y\) does not determine a top: give --theta0"),
        ("t,theta,psi", "0,{t},40,5,1,2", "a comma cannot both separate cells and be the decimal"),
        ("t,phi", "{t},3", "must have theta or psi too: phi alone does not determine a top"),
        (
            "t,theta",
            "{t},40",
            r"theta alone \(from t, theta\) does not determine a top: give --psidot0, 0 if",
        ),
        ("t,psi", "{t},40", r"psi alone \(from t, psi\) does not determine a top: give --theta0"),
        ("t,theta,psi", "0,40,{t}", "t must span"),
        ("t,theta,psi", "{t},240,{t}", "theta must be between 0 and 180 deg"),
        ("t,theta", "", "must have at least one row"),
        ("t,theta,psi", "-{t},,", r"theta is empty \(theta\): remove its columns, or skip"),
        (
            "t,theta,psi",
            "{back},40,10",
            "t must not turn back, got 0 after 4: put each",
        ),
    ],
)
def test_bad_data_get_a_line(
    lagtop: Lagtop, tmp_path: Path, header: str, row: str, message: str
) -> None:
    path = tmp_path / "data.csv"
    rows = [row.format(t=i, back=i % 5) for i in range(20)]
    path.write_text("\n".join([header, *rows, ""]))
    result = lagtop("fit", path)
    assert result.exit_code in {1, 65}
    assert result.stderr.splitlines()[-1].startswith("Error: ")
    assert re.search(message, result.stderr)


SAMPLE = str(recordings.SAMPLES / "recording.csv")


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (f"{SAMPLE} {SAMPLE}", 2, "fit takes one recording, got 2: fit each file alone"),
        (f"{SAMPLE} --sigma -1", 2, "--sigma must be > 0, got -1"),
        (f"{SAMPLE} --sigma theta=1", 2, "--sigma must be given for all of theta, phi, psi"),
        (f"{SAMPLE} --window 1", 2, "--window must be at least 2, got 1"),
        (
            f"{SAMPLE} --window 1e9",
            2,
            "--window must leave 12 rows or more in each window, got 0",
        ),
        (f"{SAMPLE} --window 3 --r0 50", 2, "--r0 is not the same in all windows: leave it out"),
        (f"{SAMPLE} --g 0", 2, "--g must not be 0 in a fit: leave it out"),
        (f"{SAMPLE} --A-cm 1", 2, "--A-cm must be given with m and s, as A = A_cm + m s^2"),
        (f"{SAMPLE} --align up=w", 2, "--align must be one of axis=y, up=y, left"),
    ],
)
def test_bad_commands(lagtop: Lagtop, words: str, code: int, message: str) -> None:
    assert_one_line(lagtop("fit", *words.split()), code, message)


def written(path: Path, recording: tuple[Array, dict[str, Array]]) -> Path:
    """Write a recording of theta and psi in degrees."""
    t, seen = recording
    columns = zip(t, np.degrees(seen["theta"]), np.degrees(seen["psi"]), strict=True)
    lines = ["t,theta,psi", *(f"{x:.5f},{y:.4f},{z:.4f}" for x, y, z in columns), ""]
    path.write_text("\n".join(lines))
    return path


def test_the_command(lagtop: Lagtop, tmp_path: Path) -> None:
    path = written(tmp_path / "data.csv", recorded("theta", "psi", seed=20))
    scene = tmp_path / "top.toml"
    known = "--m 0.5 --g 9.81 --s 0.08 --C 0.0025".split()
    result = lagtop("fit", path, *known, "--sigma", 0.3, "-o", scene)
    assert result.exit_code == 0, result.stderr
    shown = (
        "Verdict: good.",
        "chi2/dof = ",
        "RMS residual (deg): theta 0.",
        "Correlation: a and b ",
        "as given",
    )
    for text in shown:
        assert text in result.stdout
    top = read_scene(scene)
    assert (float(top.A), float(top.r0)) == pytest.approx((4.45e-3, 52.36), rel=0.01)
    assert "# r0 = 52." in scene.read_text()
    lagtop("fit", path, "-o", scene)
    doubtful = re.findall("^(.*) = .*# not determined", scene.read_text(), re.MULTILINE)
    assert doubtful == ["m", "s", "g", "A", "C", "r0"]  # only a and b are
    words = "--m 0.5 --g 9.81 --s 0.08 --A-cm 0.00125 --phidot0 52.36 --psidot0 0".split()
    lagtop("fit", path, *words, "-o", scene)
    assert "# not determined" not in scene.read_text()


def test_the_record_and_the_picture(lagtop: Lagtop, tmp_path: Path) -> None:
    path = written(tmp_path / "data.csv", recorded("theta", "psi", seed=20))
    picture = tmp_path / "fit.svg"
    words = "--m 0.5 --g 9.81 --s 0.08 --C 0.0025 --format json --plot".split()
    record = json.loads(lagtop("fit", path, *words, picture).stdout)
    assert record["verdict"] == "good"
    assert picture.read_text().startswith("<?xml")
    assert "Fit: good" in picture.read_text()
    assert abs(record["r0"] - 52.36) < 4 * record["r0_std"]
    assert record["theta_rms_deg"] == pytest.approx(0.3, rel=0.3)


def test_windows(lagtop: Lagtop, tmp_path: Path) -> None:
    path = written(tmp_path / "one.csv", recorded("theta", "psi", rows=150, seconds=3, seed=23))
    result = lagtop("fit", path, "--window", 3, "--plot", tmp_path / "decay.svg")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines()[-1].startswith("b does not decay: its relative rate is")
    assert "b does not decay" in (tmp_path / "decay.svg").read_text()
    failed = lagtop("fit", path, "--window", 3, "--sigma", 0.1, "--format", "json")
    assert failed.exit_code == 1
    windows = json.loads(failed.stdout)["windows"]
    assert "failed" in {x["verdict"] for x in windows}
    bound = chi2_bounds(windows[0]["dof"], CHANCE / 3)[1]
    assert windows[0]["chi2_dof_high"] == pytest.approx(bound)
    unwritten = lagtop("fit", path, "--sigma", 0.1, "-o", tmp_path / "no.toml")
    assert (unwritten.exit_code, (tmp_path / "no.toml").exists()) == (1, False)


# Hard kinds


@pytest.mark.parametrize(
    "look",
    [
        *("small", "attitude", "axis"),
        *(pytest.param(x, marks=pytest.mark.slow) for x in ("encoder", "smooth", "units", "known")),
    ],
)
def test_hard_recordings_are_fitted(look: str) -> None:
    import fuzz_fits

    results = [fuzz_fits.checked(seed, look=look) for seed in (1, 2)]
    assert all(x.is_right or not x.word.startswith("good") for x in results), results
    assert any(x.word == "good" for x in results), results


@pytest.mark.parametrize(
    ("c", "r0"),
    [("0.00270(10)", "60(1)"), pytest.param("0.0026", "52.36", marks=pytest.mark.slow)],
)
def test_a_known_input_that_contradicts_the_recording_is_named(c: str, r0: str) -> None:
    t, seen = recorded("theta", "psi", seed=8)
    failure = fitted(t, seen, known=LAB | {"C": c, "r0": r0}).failure()
    assert failure.startswith(f"known C = {c} contradicts the recording"), failure
    assert failure.endswith("omit C, or check m, g, s, r0")


@pytest.mark.parametrize(
    ("known", "cause"),
    [
        ({"A": 4.45e-3 - 0.5 * 0.08**2}, "it is about the centre of mass, so give A_cm instead"),
        ({"C": 2.5e-3, "r0": 500.0}, "about 9.55 times as large: check the units, or omit C"),
        ({"C": 2.5e-3, "r0": 52.36, "psidot0": 1.0}, "omit psidot0"),
        ({"theta0_deg": 0.0}, "omit theta0"),
        ({"C": 2.5e-6, "r0": 52.36}, "about 1/1000 of it: check the units, or omit C"),
    ],
)
def test_a_contradiction_says_which_unit_or_moment_it_is(
    known: dict[str, float], cause: str
) -> None:
    t, seen = recorded("theta", "psi", seed=8)
    assert fitted(t, seen, known=LAB | known).failure().endswith(cause)


def test_no_faster_spin_meets_a_known_moment() -> None:
    """Frame numbers instead of seconds make the moments 17,000 times as large."""
    _, seen = recorded("theta", "phi", "psi", rows=120, noise=0.05, seed=8)
    for c in (2.5e-3, "0.00250(5)"):
        failure = fitted(np.arange(120.0), seen, known=LAB | {"C": c}).failure()
        assert failure.startswith("known C = 0.0025")
        assert failure.endswith("omit C, or check m, g, s, the unit of t")


def test_a_filter_is_said_to_make_the_nutation_smaller() -> None:
    t, seen = recorded("theta", "psi", rows=242, noise=0.5, seed=8)
    smooth = {x: np.convolve(np.unwrap(y), np.ones(3) / 3, "valid") for x, y in seen.items()}
    outcome = fitted(t[1:-1], smooth)
    (note,) = [x for x in outcome.remarks if "if a filter smoothed the data, the nutation is" in x]
    share = float(note.rpartition("nutation is ")[2].partition("%")[0]) / 100
    step = 2 * math.pi * float(t[1]) / outcome.numbers["T_nutation"].value
    assert share == pytest.approx(step**2 / 3, rel=0.5)


@pytest.mark.parametrize("meaning", ["radians", "elevation"])
def test_another_meaning_of_angles_is_named(meaning: str) -> None:
    t, seen = recorded("theta", "psi", rows=120, noise=0.1, seed=8)
    if meaning == "radians":  # read as degrees, with precession that has grown
        seen = {x: np.radians(y + 20 * (x == "psi")) for x, y in seen.items()}
    else:
        seen["theta"] = math.pi / 2 - seen["theta"]
    assert meaning in fitted(t, seen).hints[-1]


def test_an_angle_of_few_rows_has_no_windows() -> None:
    t, seen = recorded("theta", "psi", rows=400, seconds=6, noise=0.1, seed=8)
    recording = recording_from(t, theta=seen["theta"], psi=np.where(t < 1, seen["psi"], np.nan))
    with pytest.raises(LagtopError, match="12 rows or more in each window, got 0"):
        recording.windows(12)


def test_rounded_times_are_named() -> None:
    t, seen = recorded("theta", "psi", rows=120, noise=0.1, seed=8)
    outcome = fitted(np.floor(10 * t), seen)
    assert outcome.hints == ["t has only 10 values in 120 rows: write it with more digits"]
    t, seen = recorded("theta", "psi", "phi", rows=120, noise=0.02, seed=8)
    outcome = fitted(np.round(t, 2), seen)
    (shown,) = re.findall("t is rounded: .* rows are (.*) apart", outcome.failure())
    assert float(shown) == pytest.approx(t[1], rel=1e-3)
    kept = np.delete(np.arange(120), [17, 60])
    lost = recording_from(np.round(2 * t, 2)[kept], theta=seen["theta"][kept], psi=t[kept])
    even = evenly_timed(lost)
    assert even is not None
    assert even.t == pytest.approx(2 * t[kept], abs=2e-3)
    assert evenly_timed(recording_from(2 * t, theta=seen["theta"], psi=t)) is None


@pytest.mark.parametrize(
    ("known", "said"),
    [({"C": 2.5e-3}, "from the horizontal"), ({"r0": 52.36, "C": 2.5e-3}, "from the horizontal")],
)
def test_known_inputs_that_are_right_do_not_hide_the_cause(
    known: dict[str, float], said: str
) -> None:
    t, seen = recorded("theta", "phi", "psi", rows=120, noise=0.1, seed=8)
    turned = seen | {"theta": math.pi / 2 - seen["theta"]}
    assert said in fitted(t, turned, known=LAB | known).failure()


def test_precession_in_a_column_of_the_spin_is_questioned() -> None:
    t, seen = recorded("theta", "psi", rows=120, noise=0.1, seed=8)
    outcome = fit(t, theta=seen["theta"], phi=seen["psi"])
    question = "if phi were the precession: if it is, name its column psi"
    assert any(question in x for x in outcome.notes)
    alone = fit(t, theta=seen["theta"], known={"psidot0": 0})
    assert not any(question in x for x in alone.notes)


@pytest.mark.parametrize("known", [{"r0": 600}, {"C": 1.7458e-3}, {"r0": 600, "C": 1.7458e-3}])
def test_a_known_input_decides_the_direction_of_psi(known: dict[str, float]) -> None:
    """At 120 rows per second, written in microseconds; with psi reversed a slower spin fits."""
    top = recordings.TOP.replace(r0=600, theta0_deg=40, psidot0=1.5, thetadot0=4)
    t, seen = recorded(
        "theta", "phi", "psi", top=top, rows=240, seconds=239 / 120, noise=0.05, seed=2
    )
    outcome = fitted(np.round(t, 6), seen, known={"m": 1.587, "g": 9.81, "s": 0.04} | known)
    assert_true(outcome, {"a": solve(top).a, "b": solve(top).b, "A": 3.9032e-3})
    assert not outcome.recording.is_mirrored


def test_a_known_tilt_that_is_wrong_is_questioned() -> None:
    t, seen = recorded("psi", rows=120, noise=0.05, seed=8)
    outcome = fitted(t, seen, known=LAB | {"theta0_deg": 20})
    assert outcome.hints[-1].endswith(": check theta0, columns, units and axes")


def test_known_inputs_that_agree_and_a_nutation_of_a_steady_precession() -> None:
    t, seen = recorded("theta", "psi", seed=8)
    agreeing = fitted(t, seen, known=LAB | {"C": 2.5e-3, "r0": "52.4(1)"})
    assert agreeing.verdict == "good", agreeing.failures()
    assert agreeing.distances["C"] < 3
    assert any("known C = 0.0025 agrees with the recording" in x for x in agreeing.notes)
    wrong = fitted(t, seen, known=LAB | {"C": "0.0027(1)", "r0": 52.36, "psidot0": "steady"})
    assert [x.split(",")[0] for x in wrong.failures()] == [
        "known psidot0 = steady contradicts the recording",
    ]


@pytest.mark.parametrize(
    "scale", [1e-9, *(pytest.param(x, marks=pytest.mark.slow) for x in (1e7, 1e3))]
)
def test_any_unit_of_time(scale: float) -> None:
    t, seen = recorded("theta", "psi", seed=8)
    one, other = fitted(t, seen), fitted(t / scale, seen)
    assert other.verdict == "good"
    assert other.frequency / scale == pytest.approx(one.frequency, rel=1e-6)
    powers = {"a": 2, "b": 1, "theta0_deg": 0, "T_nutation": -1, "T_nutation_elementary": -1}
    powers |= {"mean_precession_rate": 1, "precession_rate_elementary": 1, "psidot0": 1}
    for key, power in powers.items():
        found, std = other.numbers[key][:2]
        assert found == pytest.approx(one.numbers[key].value * scale**power, abs=0.02 * std)
