"""Wrong and hopeless recordings: `fit` fails, and names the cause."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import recordings
from engines import Array
from lagtop import Top, fit, solve
from noisy_recordings import (
    DEGREE,
    LAB,
    TOP,
    TRUTH,
    axis_of,
    fitted,
    motion_of,
    recorded,
    recording_from,
    slowed,
)
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from lagrange_cli.inverse.checks import CHANCE, Residuals, chi2_bounds
from lagrange_cli.inverse.decay import decay_of, fit_windows
from lagrange_cli.inverse.known import known_inputs
from lagrange_cli.inverse.measured import measured
from lagrange_cli.inverse.rows import release
from lagrange_cli.inverse.search import best_fit
from lagrange_cli.recordings.recording import recording_of
from lagrange_cli.top.given import gather
from lagrange_cli.top.values import values_of


@pytest.mark.slow
def test_exchanged_angles_that_fit_nearly_as_well_are_noticed() -> None:
    """Residuals are 1.2 times the noise, and a wrong scale of psi of -21 % would explain them."""
    path = recordings.SAMPLES / "tutorials" / "wheel.csv"
    t, theta, psi, phi = np.genfromtxt(path, delimiter=",", skip_header=3).T
    angles = {"theta": np.radians(theta), "phi": np.radians(psi), "psi": np.radians(phi)}
    outcome = fit(t, **angles, known={"m": 2.04, "s": 0.152, "g": 9.81})
    assert "phi and psi are exchanged: here phi is the spin and psi the" in outcome.failure()


@pytest.mark.slow
def test_arbitrary_frames_are_found_to_the_noise() -> None:
    """Frames by differences of rows are 0.2 degrees off, three times the noise."""
    top = Top(m=1, A=1, C=0.43, s=1, g=8.6, r0=13, theta0_deg=82, psidot0=-0.8)
    t, rng = np.linspace(0, 13.5, 200), np.random.default_rng(3)
    theta, phi, psi = (motion_of(top, t)[x] for x in ("theta", "phi", "psi"))
    turns = Rotation.from_euler("ZXZ", np.stack([psi, theta, phi], axis=-1))
    noise = Rotation.from_rotvec(rng.normal(scale=1e-3, size=(200, 3)))
    space, body = Rotation.random(2, random_state=3)
    seen = (noise * space * turns * body).as_quat(scalar_first=True)
    assert "; space is turned by " in fit(t, quaternion=seen).failure()


def test_an_outlier_is_named() -> None:
    t, seen = recorded("theta", "psi", seed=8)
    seen["psi"][30] += 20 * DEGREE
    failure = fitted(t, seen).failure()
    (off,) = re.findall(r"^psi is (.*) deg off at t = .*, far more than else", failure)
    assert float(off) == pytest.approx(20, abs=1)
    assert failure.endswith(f"; leave out the rows at t = {t[30]:.6g}")


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


@pytest.mark.slow
def test_a_decay_within_each_window_is_named() -> None:
    rng, t = np.random.default_rng(12), np.linspace(0, 6, 721)
    seen = {x: y + rng.normal(scale=0.3 * DEGREE, size=t.size) for x, y in slowed(27, t).items()}
    failure = fitted(t, seen).failure()
    found = re.search(r"the spin decays: (r0|b) falls from (\d+).* to (\d+).*within each", failure)
    assert found, failure
    shown = [int(x) for x in found.groups()[1:]]
    assert shown == pytest.approx([TRUTH["r0"], TRUTH["r0"] * math.exp(-6 / 27)], abs=2)


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
    assert re.search(r"the spin decays: use window=(5|10)$", outcome.failure()), outcome.failure()
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


def _of_body(seen: Mapping[str, Array], frame: Rotation | None = None) -> Array:
    """Return quaternions in the order w, x, y, z, of a body and a space with other axes."""
    turns = Rotation.from_euler("ZXZ", np.stack([seen[x] for x in ("psi", "theta", "phi")], 1))
    turns = turns if frame is None else frame * turns * frame.inv()
    return np.asarray(turns.as_quat(scalar_first=True))


ENGINE = Rotation.from_matrix([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
"""y is the figure axis, and up."""


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda x: {"axis": axis_of(x["theta"], x["psi"])[:, ::-1]}, "use align=up=x"),
        pytest.param(
            lambda x: {"quaternion": np.roll(_of_body(x), -1, axis=1)},
            "the quaternion is xyzw and was read as wxyz: quaternion_order=xyzw",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            lambda x: {"axis": -axis_of(x["theta"], x["psi"])},
            "or the marker is opposite to the centre of mass: use align=up=-z",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            lambda x: {"quaternion": _of_body(x, ENGINE)},
            "the y axis is the figure axis: use align=axis=y,up=y",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_another_frame_is_named(make: Any, reason: str) -> None:
    rng, t = np.random.default_rng(12), np.linspace(0, 1.5, 75)
    seen = make(motion_of(TOP, t))
    outcome = fitted(t, {x: y + rng.normal(scale=0.003, size=y.shape) for x, y in seen.items()})
    assert outcome.verdict == "failed"
    assert reason in outcome.record()["remark"]


@pytest.mark.parametrize(
    ("start", "rows", "way", "said"),
    [
        pytest.param(
            *({}, 1.25, 1, "; the nutation is aliased, with 1.25 rows per period: record more"),
            marks=pytest.mark.slow,
        ),
        ({"psidot0": 1.1, "thetadot0": 1.7, "r0": 73}, 1.25, 1, "align=up=-z; or the nutation is"),
    ],
)
def test_an_aliased_nutation_is_named_and_so_is_a_frame_that_looks_like_it(
    start: dict[str, float], rows: float, way: int, said: str
) -> None:
    top = TOP.replace(**start)
    t = np.arange(64) * solve(top).T_nutation / rows
    exact = motion_of(top, t)
    noise = np.random.default_rng(12).normal(scale=0.003, size=(64, 3))
    failure = fit(t, axis=way * axis_of(exact["theta"], exact["psi"]) + noise).failure()
    assert said in failure


def test_an_impossible_body_fails() -> None:
    """At uneven times, because whole turns per frame are invisible."""
    rng = np.random.default_rng(8)
    t = np.concatenate([[0], np.sort(rng.uniform(0, 0.9, 59))])
    seen = {x: y + rng.normal(scale=2e-3, size=60) for x, y in motion_of(TOP, t).items()}
    outcome = fit(t, theta=seen["theta"], psi=seen["psi"], phi=np.unwrap(seen["phi"]) / 5)
    said = "C/A = (.*) is impossible: a rigid body has 0 < C/A <= 2"
    (shown,) = re.findall(said, outcome.failure())
    assert float(shown) > 2


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
    one = recording_of(t, dict(seen))
    low, high = (best_fit(measured(one, x * DEGREE), {}) for x in (0.15, 0.6))
    assert re.match("chi2/dof = .*: the rms of (theta|psi) is (1.9|2)", low.failures()[0])
    assert high.verdict == "good"
    assert "the noise is below sigma" in high.remarks[-1]


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


def test_angles_in_radians_are_named() -> None:
    """They were read as degrees; the precession has grown."""
    t, seen = recorded("theta", "psi", rows=80, noise=0.1, seed=8)
    degrees = {x: np.radians(y + 20 * (x == "psi")) for x, y in seen.items()}
    assert "radians" in fitted(t, degrees).hints[-1]


@pytest.mark.slow
def test_rounded_times_are_named() -> None:
    t, seen = recorded("theta", "psi", rows=80, noise=0.1, seed=8)
    outcome = fitted(np.floor(10 * t), seen)
    assert outcome.hints == ["t has only 10 values in 80 rows: write it with more digits"]
    t, seen = recorded("theta", "psi", "phi", rows=120, noise=0.02, seed=8)
    (shown,) = re.findall("rounded: .* rows are (.*) apart", fitted(np.round(t, 2), seen).failure())
    assert float(shown) == pytest.approx(t[1], rel=1e-3)


def test_precession_in_a_column_of_the_spin_is_questioned() -> None:
    t, seen = recorded("theta", "psi", rows=60, noise=0.1, seed=8)
    outcome = fit(t, theta=seen["theta"], phi=seen["psi"])
    question = "if phi were the precession: if it is, name its column psi"
    assert any(question in x for x in outcome.notes)
    released = Top(**LAB, A=4.45e-3, C=2.5e-3, r0=100, theta0_deg=50)
    times, angles = recorded("theta", "psi", top=released, rows=60, noise=0.3, seed=8)
    hints = fit(times, theta=angles["theta"], phi=angles["psi"]).hints
    assert hints == ["phi may be the precession, as in most books: name its column psi"]
