"""Rows that a recorder repeated or lost, what residuals may be, and the order of reasons."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from lagtop import LagtopError, fit
from noisy_recordings import recording_from

from lagrange_cli.arithmetic.types import Array
from lagrange_cli.inverse.checks import CHANCE, Residuals
from lagrange_cli.inverse.decay import fit_windows
from lagrange_cli.inverse.outcome import Outcome
from lagrange_cli.inverse.reasons import Kind
from lagrange_cli.inverse.rows import likely_gap, repeated, with_gap
from lagrange_cli.names import ANGLES

sys.path.append(str(Path(__file__).parents[1] / "tools"))

from machines import filtered, gimballed

START = np.array([1.1, 0.3, 0.9])


def seen(count: int = 120, seed: int = 4) -> tuple[Array, dict[str, Array]]:
    """Return times and noisy angles of a top, by an integrator."""
    t = np.arange(count) / 60
    rng = np.random.default_rng(seed)
    found = gimballed(80.0, 12.0, 20.0, START, t)
    return t, {x: y + rng.normal(scale=4e-3, size=count) for x, y in found.items() if x != "phi"}


def fitted(t: Array, angles: dict[str, Array]) -> Outcome:
    return fit(t, theta=angles["theta"], psi=angles["psi"])


def test_a_row_that_repeats_another_is_named() -> None:
    t, angles = seen()
    assert repeated(recording_from(t, **angles)) == ""
    rows = np.sort(np.append(np.arange(119), 40))
    doubled = {x: y[rows] for x, y in angles.items()}
    outcome = fitted(t, doubled)
    assert outcome.failure() == f"the row at t = {t[41]:.6g} repeats the row before it"
    assert outcome.failed[0].kind is Kind.ROWS


def test_equal_rows_of_a_coarse_encoder_are_none() -> None:
    t, angles = seen(600)
    coarse = {x: np.round(y / 0.2) * 0.2 for x, y in angles.items()}
    assert (np.diff(coarse["theta"]) == 0).any()
    assert repeated(recording_from(t, **coarse)) == ""


@pytest.mark.parametrize("lost", [1, 3])
def test_lost_rows_are_found(lost: int) -> None:
    """If the rows of a recording are numbered although some are lost."""
    t, angles = seen()
    kept = np.r_[0:60, 60 + lost : 120]
    short = {x: y[kept] for x, y in angles.items()}
    one = recording_from(t[: kept.size], **short)
    row, count = likely_gap(one) or (0, 0)
    assert (abs(row - 60) < 3, count) == (True, lost)
    assert with_gap(one, 60, lost).t == pytest.approx(t[kept])
    failure = fitted(t[: kept.size], short).failure()
    assert failure.startswith(f"{lost} row{'s are' if lost > 1 else ' is'} lost before t = ")


def test_a_filter_explains_smooth_noise_but_no_slow_oscillation() -> None:
    rng, t = np.random.default_rng(7), np.arange(600.0)
    noise = rng.normal(size=600)
    for way in ("mean", "lag", "cubic"):
        assert Residuals(t, filtered(noise, 5, way)).is_smoothed, way
    slow = Residuals(t, noise + np.sin(t / 9))
    assert not slow.is_smoothed
    assert any(slow.faults("x", 1 / 40, CHANCE))


def test_a_late_filter_is_in_the_uncertainty_of_the_first_row() -> None:
    """Noise alone would leave theta0 uncertain by 0.03 degrees; the delay moves it by 2."""
    t, angles = seen(240, seed=9)
    late = {x: filtered(y, 3, "lag")[24:] for x, y in angles.items()}  # the filter has settled
    exact = np.degrees(gimballed(80.0, 12.0, 20.0, START, t)["theta"][24])
    outcome = fitted(t[24:], late)
    assert outcome.verdict == "good", outcome.failures()
    theta0 = outcome.numbers["theta0_deg"]
    assert 1 < abs(exact - theta0.value) < 3 * theta0.std < 10


def test_residuals_as_large_as_the_motion_are_no_fit() -> None:
    t = np.arange(60.0)
    rest = np.random.default_rng(2).normal(scale=0.05, size=60)
    assert Residuals(t, rest, range=0.1).is_large
    assert not Residuals(t, rest, range=0.4).is_large


def test_reasons_are_in_the_order_of_their_kinds() -> None:
    t, angles = seen()
    angles["theta"][30] += 1.0
    outcome = fitted(t, angles | {"psi": angles["psi"] + 0.5 * (t > 1)})
    kinds = [x.kind for x in outcome.failed]
    assert kinds == sorted(kinds)
    assert len(kinds) > 1


def test_one_angle_has_no_windows_and_is_not_told_to_use_them() -> None:
    """Its known start is that of the first window alone."""
    t = np.arange(400) / 100
    psi = gimballed(80.0, 12.0, 20.0, START, t, drag=0.2)["psi"]
    psi = psi + np.random.default_rng(3).normal(scale=5e-3, size=400)
    known = {"theta0": START[0]}
    outcome = fit(t, psi=psi, known=known)
    assert outcome.verdict == "failed"
    assert "window" not in outcome.failure()
    with pytest.raises(LagtopError, match="in all windows: windows need more than psi"):
        fit_windows(recording_from(t, psi=psi), 3, {"theta0": (START[0], 0.0)})


def test_a_known_spin_has_its_uncertainty_in_the_moment() -> None:
    """The spin is not recorded: r0 = 26(2) leaves C uncertain by 8 %, and gets no line itself."""
    t, angles = seen(240)
    known = {"m": 1.0, "g": 10.0, "s": 4.0, "r0": "21.5(2.0)", "C": 0.6}
    outcome = fit(t, theta=angles["theta"], psi=angles["psi"], known=known)
    assert outcome.verdict == "good", outcome.failures()
    (note,) = [x for x in outcome.notes if x.startswith("known ")]
    assert note.startswith("known C = 0.6 agrees")
    assert "C" in outcome.distances
    assert "r0" not in outcome.distances


@pytest.mark.parametrize(
    ("r0", "words"), [(-20.0, "of the opposite sign"), (20 * 30 / np.pi, "9.55 times as large")]
)
def test_the_sign_and_the_unit_of_a_known_spin_are_named(r0: float, words: str) -> None:
    """Also if a faster spin that looks alike in the rows is nearer."""
    t = np.arange(120) / 60
    rng = np.random.default_rng(4)
    found = gimballed(80.0, 12.0, 20.0, START, t)
    theta, phi, psi = (found[x] + rng.normal(scale=4e-3, size=120) for x in ANGLES)
    failure = fit(t, theta=theta, phi=phi, psi=psi, known={"r0": r0}).failure()
    assert failure.startswith(f"known r0 = {r0:.6g} contradicts the recording")
    assert words in failure
