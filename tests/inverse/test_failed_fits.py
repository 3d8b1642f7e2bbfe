"""Wrong and hopeless recordings: `fit` fails, and names the cause."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from engines import wxyz
from lagtop import Top, fit, solve
from noisy_recordings import (
    DEGREE,
    LAB,
    TOP,
    attitude_of,
    axis_of,
    fitted,
    motion_of,
    recorded,
    recording_from,
)
from scipy.spatial.transform import Rotation

from lagrange_cli.inverse.rows import release
from lagrange_cli.inverse.search import best_fit

slow = pytest.mark.slow


@slow
def test_arbitrary_frames_are_found_to_the_noise() -> None:
    """Frames by differences of rows are 0.2 degrees off, three times the noise."""
    top = Top(m=1, A=1, C=0.43, s=1, g=8.6, r0=13, theta0_deg=82, psidot0=-0.8)
    t, rng = np.linspace(0, 13.5, 200), np.random.default_rng(3)
    noise = Rotation.from_rotvec(rng.normal(scale=1e-3, size=(200, 3)))
    space, body = Rotation.random(2, random_state=3)
    seen = wxyz(noise * space * attitude_of(motion_of(top, t)) * body)
    assert "; space is turned by " in fit(t, quaternion=seen).failure()


def test_precession_in_a_column_of_the_spin_is_questioned() -> None:
    t, seen = recorded("theta", "psi", rows=60, noise=0.1, seed=8)
    outcome = fit(t, theta=seen["theta"], phi=seen["psi"])
    question = "if phi were the precession: if it is, name its column psi"
    assert any(question in x for x in outcome.notes)
    released = Top(**LAB, A=4.45e-3, C=2.5e-3, r0=100, theta0_deg=50)
    times, angles = recorded("theta", "psi", top=released, rows=60, noise=0.3, seed=8)
    hints = fit(times, theta=angles["theta"], phi=angles["psi"]).hints
    assert hints == ["phi may be the precession, as in most books: name its column psi"]


@slow
def test_rounded_times_are_named() -> None:
    t, seen = recorded("theta", "psi", rows=80, noise=0.1, seed=8)
    outcome = fitted(np.floor(10 * t), seen)
    assert outcome.hints == ["t has only 10 values in 80 rows: write it with more digits"]
    t, seen = recorded("theta", "psi", "phi", rows=120, noise=0.02, seed=8)
    (shown,) = re.findall("rounded: .* rows are (.*) apart", fitted(np.round(t, 2), seen).failure())
    assert float(shown) == pytest.approx(t[1], rel=1e-3)


@pytest.mark.parametrize(
    ("start", "said"),
    [
        pytest.param(
            {}, "; the nutation is aliased, with 1.25 rows per period: record more", marks=slow
        ),
        ({"psidot0": 1.1, "thetadot0": 1.7, "r0": 73}, "align=up=-z; or the nutation is"),
    ],
)
def test_an_aliased_nutation_is_named_and_so_is_a_frame_that_looks_like_it(
    start: dict[str, float], said: str
) -> None:
    top = TOP.replace(**start)
    t = np.arange(64) * solve(top).T_nutation / 1.25
    exact = motion_of(top, t)
    noise = np.random.default_rng(12).normal(scale=0.003, size=(64, 3))
    assert said in fit(t, axis=axis_of(exact["theta"], exact["psi"]) + noise).failure()


def test_a_burst_of_outliers_is_named() -> None:
    t, seen = recorded("theta", "psi", seed=8)
    seen["psi"][30:33] += np.array([20, 5, -9]) * DEGREE
    failure = fitted(t, seen).failure()
    (off,) = re.findall(r"^psi is (.*) deg off at t = .*, far more than else", failure)
    assert float(off) == pytest.approx(20, abs=1)
    assert failure.endswith(f"; leave out the rows at t = {t[30]:.6g} to {t[32]:.6g}")


def test_marks_that_look_alike_are_named() -> None:
    t, seen = recorded("theta", "psi", "phi", seed=8)
    seen["phi"][::5] += 180 * DEGREE
    assert f"phi is half a turn off in {len(t[::5])} rows" in fitted(t, seen).failure()


def test_a_release_is_seen_beside_missing_cells() -> None:
    rng = np.random.default_rng(13)
    theta = np.concatenate([np.full(40, 1.0), 1 + 0.2 * np.sin(np.arange(1, 61) / 4) ** 2])
    theta += rng.normal(scale=1e-3, size=100)
    theta[[3, 20, 50]] = np.nan
    recording = recording_from(np.arange(100.0), theta=theta)
    assert 40 <= recording.t[release(recording)] <= 43
    t, seen = recorded("theta", "psi", rows=180, seconds=3, seed=13)
    assert release(recording_from(t, **seen)) == 0  # psi' is 0 in the first row


def test_an_impossible_body_fails() -> None:
    """At uneven times, because whole turns per frame are invisible."""
    uneven = np.sort(np.random.default_rng(8).uniform(0, 0.9, 60))
    t, seen = recorded("theta", "phi", "psi", t=uneven - uneven[0], noise=0.1, seed=8)
    outcome = fitted(t, seen | {"phi": np.unwrap(seen["phi"]) / 5})
    said = "C/A = (.*) is impossible: a rigid body has 0 < C/A <= 2"
    (shown,) = re.findall(said, outcome.failure())
    assert float(shown) > 2


def test_an_attitude_whose_spin_is_wrong_fails() -> None:
    """Tilt and precession are right; only the residuals about the axis show it."""
    t, seen = recorded("theta", "phi", "psi", seed=13)
    turns = attitude_of(seen | {"phi": seen["phi"] + 2 * t**2})
    outcome = best_fit(recording_from(t, quaternion=wxyz(turns)), {})
    assert outcome.verdict == "failed"
    assert any("residuals of along" in x for x in outcome.failures())


@pytest.mark.parametrize("kept", [slice(0), slice(-5, None)], ids=["constant", "few numbers"])
def test_a_recording_with_an_odd_column_fails_in_words(kept: slice) -> None:
    """The range of a constant angle is 0; half of the rows may have no number of an angle."""
    t, seen = recorded("theta", "psi", rows=30, seed=8)
    odd = np.full(30, math.nan if seen["psi"][kept].size else 0.5)
    odd[kept] = seen["psi"][kept]
    assert fitted(t, seen | {"psi": odd}).failures()
