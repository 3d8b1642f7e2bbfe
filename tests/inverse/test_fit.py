"""`fit`: tops behind recordings of integrators, of every kind, with noise of a known size."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import fuzz_fits
import numpy as np
import pytest
import recordings
from engines import wxyz
from lagtop import Top, fit, solve
from noisy_recordings import (
    DEGREE,
    TOP,
    TRUTH,
    assert_true,
    attitude_of,
    fitted,
    motion_of,
    recorded,
    recording_from,
)
from scipy.spatial.transform import Rotation

from lagrange_cli.inverse.problem import problem_of
from lagrange_cli.names import ANGLES

slow = pytest.mark.slow


@pytest.mark.parametrize(
    ("names", "known", "note"),
    [
        (("theta", "psi"), {}, ""),
        pytest.param(("theta", "phi"), {}, "", marks=slow),
        pytest.param(("phi", "psi"), {}, "", marks=slow),
        (ANGLES, {}, "psi counts in the other direction: its sign was changed"),
        (("theta",), {"psidot0": 0}, "the sign of b is not determined"),
        (("psi",), {"theta0_deg": 75}, ""),
    ],
)
def test_recorded_angles_give_the_top(
    names: tuple[str, ...], known: dict[str, float], note: str
) -> None:
    rows = 50 if len(names) == 1 or {"theta", "psi"} <= {*names} else 120
    t, seen = recorded(*names, rows=rows, seconds=0.018 * rows, noise=0.2, seed=1)
    if "psi counts" in note:
        seen["psi"] *= -1
    outcome = fitted(t, seen, sigma=0.2 * DEGREE, known=known)
    assert_true(outcome, TRUTH | {"theta0_deg": 75, "psidot0": 0})
    for said in ("psi counts", "the sign of b"):
        assert any(said in x for x in outcome.notes) == (said in note)


@pytest.mark.parametrize("kind", ["axis", "quaternion"])
def test_an_axis_and_an_attitude(kind: str) -> None:
    rng, t = np.random.default_rng(4), np.linspace(0, 1.2, 70)
    noise = Rotation.from_rotvec(rng.normal(scale=0.3 * DEGREE, size=(70, 3)))
    noisy = attitude_of(motion_of(TOP, t)) * noise
    outcome = fitted(t, {kind: wxyz(noisy) if kind == "quaternion" else noisy.apply([0, 0, 1])})
    assert_true(outcome, TRUTH)
    assert [*outcome.residuals] == ["theta", "across", *["along"] * (kind == "quaternion")]


def test_residuals_of_an_attitude_are_a_small_rotation() -> None:
    """Along the meridian, across it, and about the axis: the rotation in the frame of the body."""
    t = np.linspace(0, 1, 20)
    small = np.random.default_rng(24).normal(scale=1e-4, size=(20, 3))
    moved = wxyz(attitude_of(motion_of(TOP, t)) * Rotation.from_rotvec(small))
    state = np.array([[TRUTH["a"], TRUTH["b"], 75 * DEGREE, 0.0, 0.0]])
    zeros = np.array([[0.0], [0.0], [TRUTH["r0"]]])
    problem, x = problem_of(recording_from(t, quaternion=moved), np.ones(3), state, zeros, None)
    theta, across, along = problem.residuals(x[:, np.newaxis])[0, 0]
    assert along == pytest.approx(small[:, 2], abs=1e-7)
    assert np.hypot(theta, across) == pytest.approx(np.hypot(small[:, 0], small[:, 1]), abs=1e-7)


@pytest.mark.parametrize(
    ("names", "noise", "top"),
    [
        pytest.param(
            *(("theta", "phi"), 3e-3, (TRUTH["a"], 17.0, 30.0, math.pi, 6.0, 0.0)), marks=slow
        ),
        (("theta", "psi"), 3e-3, (TRUTH["a"], 17.0, 30.0, 0.0, 6.0, 0.0)),
        (ANGLES, 3e-4, (53.8, 16.3, 11.1, 0.009, 0.0, 0.0)),  # the nutation is 0.1 degrees
    ],
)
def test_a_top_at_the_vertical(names: Sequence[str], noise: float, top: tuple[float, ...]) -> None:
    t, rng = np.linspace(0, 1.5, 150), np.random.default_rng(3)
    exact = fuzz_fits.Top(*top).motion(t)
    seen = {x: np.angle(np.exp(1j * (exact[x] + rng.normal(scale=noise, size=150)))) for x in names}
    truth = dict(zip(("a", "b", "r0"), top, strict=False))
    assert_true(fitted(t, seen | {"theta": np.abs(seen["theta"])}), truth)


@slow
def test_irregular_times_with_two_rows_per_period() -> None:
    t = np.append(0, np.sort(np.random.default_rng(7).uniform(0, 20, 119)))
    top = Top(m=1, s=1, g=164, A=1, C=1.2, r0=-3.6, theta0_deg=66, thetadot0=1.3, psidot0=-2.5)
    seen = recorded(*ANGLES, top=top, t=t, noise=0.1, seed=7)[1]
    assert_true(fitted(t, seen), {"a": 328, "b": -1.2 * 3.6, "r0": -3.6})


def test_the_sample_gives_the_body() -> None:
    rows = np.genfromtxt(recordings.SAMPLES / "recording.csv", delimiter=",", skip_header=3)
    t, (theta, psi, phi) = rows[::4, 0], np.radians(rows[::4, 1:].T)
    outcome = fit(t, theta=theta, psi=psi, phi=phi, known={"m": 1.587, "g": 9.81, "s": 0.04})
    assert_true(outcome, {"A": 3.9032e-3, "C": 1.7458e-3, "r0": 50, "theta0_deg": 41}, least=4)
    assert repr(outcome).startswith(f"fit of {t.size} rows: good\na   ")
    keys = ["T_nutation", "mean_precession_rate", "mean_spin_rate", "theta_max_deg"]
    assert_true(outcome, solve(recordings.TOP).record(keys=keys), least=4)
    for curve in outcome.curves():
        model, seen = np.interp(curve.t, curve.fine_t, curve.curve), np.isfinite(curve.data)
        off = curve.data - curve.residual - model
        assert off[seen] == pytest.approx(0, abs=0.05)
        rms = np.degrees(outcome.residuals[curve.name].rms)
        assert np.sqrt(np.mean(curve.residual[seen] ** 2)) == pytest.approx(rms)
    count = sum(x.y.size for x in outcome.residuals.values())
    assert outcome.dof == count - 8  # a, b, r0, three of the start, two zeros
    assert "11 % below the fit" in outcome.numbers["precession_rate_elementary"].meaning
    for few in (12, 13):  # every row is next to an end
        assert fit(t[:few], theta=theta[:few], psi=psi[:few]).verdict in {"failed", "good"}


@slow
def test_noise_of_many_rows_is_averaged() -> None:
    """A thousand rows find the minimum, all rows refine it: uncertainties fall as 1/sqrt(rows)."""
    few, many = (fitted(*recorded("theta", "psi", rows=x, seed=8)) for x in (150, 2400))
    assert_true(many, TRUTH)
    for key in ("a", "b", "theta0_deg", "T_nutation"):
        assert few.numbers[key].std / many.numbers[key].std == pytest.approx(4, rel=0.15), key


def test_any_unit_of_time() -> None:
    (t, seen), scale = recorded("theta", "psi", seed=8), 1e-9
    one, other = fitted(t, seen), fitted(t / scale, seen)
    assert other.verdict == "good"
    powers = {"a": 2, "b": 1, "theta0_deg": 0, "T_nutation": -1, "T_nutation_elementary": -1}
    powers |= {"mean_precession_rate": 1, "precession_rate_elementary": 1, "psidot0": 1}
    for key, power in powers.items():
        found, std = other.numbers[key][:2]
        assert found == pytest.approx(one.numbers[key].value * scale**power, abs=0.02 * std)


@slow
def test_no_wrong_fit_of_a_random_recording_is_good_and_most_are_right() -> None:
    verdicts = [fuzz_fits.checked(seed, easy=True) for seed in range(3001, 3013)]
    assert all(x.is_right or x.word in {"failed", "refused"} for x in verdicts), verdicts
    assert sum(x.is_right and x.word == "good" for x in verdicts) >= 10
    sizes = np.abs([x for verdict in verdicts for x in verdict.pulls.values() if verdict.is_right])
    assert 0.5 < np.mean(sizes < 1) < 0.85


HARD: list[tuple[int, str, str]] = [
    (1, "axis", "good"),
    (106, "small", "good"),
    (106, "attitude", "good"),
    (106, "pole", "good"),
    (106, "encoder", "good"),
    (1, "smooth", "good"),
    (106, "known", "good"),
    (70101, "", "failed"),  # one phi at a pole would determine all
    (50132, "", "failed"),  # a mirror image has another a
    (70204, "", "good"),  # a mirror image would need a turn per row
    (70117, "", "good"),  # bins hide leaps of psi
    (90130, "", "good"),  # the mirror image is as near, with a turn per row
    (90536, "", "good"),  # the valley of chi^2 is long and bent
    (93495, "", "good, no nutation"),  # a nutation that noise resembles
    (90690, "", "good"),  # C does not show how many turns the spin makes
]


@pytest.mark.parametrize(
    ("seed", "look", "verdict"), [HARD[0], *(pytest.param(*x, marks=slow) for x in HARD[1:])]
)
def test_hard_recordings(seed: int, look: str, verdict: str) -> None:
    result = fuzz_fits.checked(seed, look=look)
    assert result.word == verdict
    assert result.is_right or verdict == "failed"


def test_noise_of_psi_and_phi_may_grow_beside_a_pole() -> None:
    """A tracker sees the axis, whose noise turns psi and phi by large angles near the pole."""
    case, rng = fuzz_fits.drawn(106, look="pole"), np.random.default_rng(1)
    seen: Any = dict(case.arrays)
    turned = rng.normal(scale=case.noise["theta"], size=case.t.size) / np.sin(seen["theta"])
    seen["psi"] = seen["psi"] + turned
    seen["phi"] = seen["phi"] - turned * np.cos(seen["theta"])
    outcome = fit(case.t, **seen)
    assert (outcome.verdict, outcome.recording.kind) == ("good", "attitude")
    pulls = fuzz_fits.pulls(outcome, case, mirrored=False)
    assert all(abs(x) < fuzz_fits.FAR for x in pulls.values()), pulls
