"""The search for a fit: starts, coordinates, spins that look alike, and when a fit has failed."""

from __future__ import annotations

import math
from collections import Counter
from typing import Any

import fuzz_fits
import numpy as np
import pytest
from engines import Array
from lagtop import LagtopError, Top, fit, solve

from lagrange_cli.fits.harmonics import Signal, slowest_spin, turning_rate
from lagrange_cli.fits.least_squares import Problem
from lagrange_cli.fits.parameters import FIT_QUANTITIES, Coordinates
from lagrange_cli.fits.record import FAILED, Outcome

NOISE = math.radians(0.28925)
MISLED = Top(
    m=1,
    s=1,
    A=1.4479572905666617,
    C=1.50883374013644,
    g=248.15609503051 * 1.4479572905666617 / 2,
    r0=-35.54765969960348,
    theta0_deg=67.99174290939264,
    thetadot0=0.10746950139324198,
    psidot0=-0.7827938537807354,
)
"""A top of which both senses of psi start equally far off."""


def noisy(end: float, rows: int, seed: int) -> tuple[Array, Any]:
    """Return times and noisy angles of the top, by an integrator."""
    t = np.linspace(0, end, rows)
    names = ("theta", "psi", "phi")
    return t, fuzz_fits.noisy(MISLED, t, names, NOISE, np.random.default_rng(seed))


@pytest.mark.slow
def test_both_senses_of_psi_are_tried() -> None:
    """The mirror image came first here; its fit was taken, with r0 = 353 for -35.5."""
    t, angles = noisy(1.1210948238157177, 70, 18)
    found = fit(t, **angles, sigma=math.radians(0.29))
    assert found.verdict == "good"
    assert found.values["r0"] == pytest.approx(float(MISLED.r0), abs=0.2)
    assert found.notes() == []
    found = fit(t, **angles | {"psi": -angles["psi"]})
    assert found.values["r0"] == pytest.approx(float(MISLED.r0), abs=0.2)
    assert found.notes() == ["psi is counted in the other direction: its sign was changed"]


@pytest.mark.slow
def test_spin_and_precession_give_the_tilt_too() -> None:
    t, angles = noisy(2.0, 150, 3)
    del angles["theta"]
    found = fit(t, **angles)
    assert found.verdict == "good"
    motion = solve(MISLED)
    for name, x in (("a", motion.a), ("b", motion.b), ("r0", -35.54765969960348)):
        assert abs(found.values[name] - x) < 4 * found.deviations[name]
        assert found.deviations[name] < 0.05 * abs(x)
    assert "theta_rms_deg" not in found.record()


@pytest.fixture(scope="module")
def mirrored() -> Outcome:
    """Return a good fit of a recording whose psi counts in the other direction."""
    t, angles = noisy(1.5, 60, 5)
    found = fit(t, **angles | {"psi": -angles["psi"]})
    assert found.verdict == "good"
    return found


def test_a_fit_that_is_not_good_takes_no_sense_of_psi_for_a_fact(
    mirrored: Outcome, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Outcome, "warnings", lambda _: ["doubts"])
    said = "psi may be counted in the other direction: this fit changed its sign"
    assert mirrored.notes() == [said]


def test_a_recording_that_two_tops_explain_has_no_good_fit(mirrored: Outcome) -> None:
    rival = dict.fromkeys(FIT_QUANTITIES, 0.0) | {"b": 12.5}
    other = Outcome(mirrored.fit._replace(rival=rival), 0)
    assert other.verdict == FAILED
    said = "another top explains the recording as well: a = 0, b = 12.5, r0 = 0"
    assert other.failures() == [said]


@pytest.mark.parametrize("channel", ["theta", "phi", "psi"])
def test_residuals_beyond_the_noise_of_any_channel_are_a_failure(
    mirrored: Outcome, channel: str
) -> None:
    noise = {**mirrored.fit.noise[0], channel: mirrored.residuals[channel].rms / 2.1}
    (reason,) = Outcome(mirrored.fit._replace(noise=[noise]), 0).failures()
    assert reason.startswith(f"no motion fits the recording: {channel} is 0.")


def test_coordinates_lead_back_to_the_parameters() -> None:
    names = ("a", "b", "theta0", "thetadot0", "psidot0", "r0", "psi_zero")
    by = Coordinates(names)
    values = np.array([210.0, -14.0, 0.9, 0.7, 3.1, -22.0, 1.5])
    at = by.of(values)
    assert by.parameters(at) == pytest.approx(values, rel=1e-14)
    steps = 1e-6 * np.eye(len(names))
    slopes = [(by.parameters(at + x) - by.parameters(at - x)) / 2e-6 for x in steps]
    assert by.slopes(at) == pytest.approx(np.stack(slopes, axis=-1), abs=1e-6)
    spread = 1e-3 * np.eye(len(names))
    linear = by.slopes(at) @ spread @ spread.T @ by.slopes(at).T
    assert by.covariance(at, spread) == pytest.approx(linear, rel=0.02, abs=1e-6)


def test_coordinates_leave_parameters_alone_that_are_tied() -> None:
    by, values = Coordinates(("a", "r0", "theta0")), np.array([1.0, 2.0, 3.0])
    assert not by.apply
    assert (by.of(values) == values).all()
    assert (by.slopes(values) == np.eye(3)).all()


@pytest.mark.parametrize(
    ("r0", "b", "spread", "slowest"),
    [
        (50.0, 20.0, 0.0, 50.0),
        (50.0 + 2 * math.pi * 100, 20.0, 0.0, 50.0),
        (5.0, 20.0, 0.0, 5.0 + 2 * math.pi * 100),  # C/A = 4 is of no rigid body
        (5.0, -3.0, 0.1, 5.0 - 2 * math.pi * 100),
        (5.0, -3.0, 2.0, 5.0),  # b may as well be positive
        (5.0, 1e4, 0.0, 5.0),  # no rate is possible
    ],
)
def test_of_rates_that_look_alike_the_slowest_possible_is_taken(
    r0: float, b: float, spread: float, slowest: float
) -> None:
    assert slowest_spin(r0, b, spread, 0.01) == pytest.approx(slowest)


def test_the_rate_of_an_angle_that_is_known_within_turns() -> None:
    rng = np.random.default_rng(2)
    t = np.sort(rng.choice(np.arange(300), 200, replace=False)) * 0.01
    angle = np.angle(np.exp(1j * (113.0 * t + 0.7 * np.sin(9 * t) + 0.01 * rng.normal(size=200))))
    angle[50:60] = np.nan
    assert turning_rate(t, angle) == pytest.approx(113.0, abs=0.2)


def test_harmonics_have_a_growth_and_a_noise() -> None:
    rng = np.random.default_rng(4)
    t = np.linspace(0, 7, 300)
    y = 3 * t + 0.4 * np.sin(5 * t) + 0.1 * np.cos(10 * t) + 0.01 * rng.normal(size=t.size)
    signal = Signal(t, y, grows=True)
    assert signal.frequency() == pytest.approx(5 / (2 * math.pi), rel=1e-3)
    series = signal.series(5 / (2 * math.pi), fine=True)
    assert series.noise == pytest.approx(0.01, rel=0.15)
    assert series.growth == pytest.approx(3, abs=0.002)


SWING = np.linspace(0, 2, 100)
TILT = 0.7 + 0.1 * np.sin(20 * SWING)
TURNS = {"psi": 3 * SWING + 0.05 * np.sin(20 * SWING), "phi": 40 * SWING}


@pytest.mark.parametrize(
    ("t", "angles", "message"),
    [
        (SWING * 1e200, {"theta": TILT, **TURNS}, "t must span 1e-60 to 1e"),
        (np.where(SWING < 2, SWING, 1.7e308), {"theta": TILT, **TURNS}, "t must span"),
        (
            SWING / 10,
            {"theta": 0.7 + 0.1 * SWING * SWING, "psi": 0 * SWING},
            "must last for a period of the nutation",
        ),
        (
            SWING,
            {"theta": TILT, "phi": np.where(SWING > 0.03, np.nan, 1.0)},
            "phi must have 4 numbers or more, got 2",
        ),
        (
            SWING,
            {
                name: 40 * SWING + np.random.default_rng(i).normal(size=100)
                for i, name in enumerate(TURNS)
            },
            "must have less noise than 30 degrees",
        ),
    ],
)
def test_recordings_that_cannot_be_fitted(t: Array, angles: Any, message: str) -> None:
    with pytest.raises(LagtopError, match=message):
        fit(t, **angles)


@pytest.mark.slow
@pytest.mark.parametrize(
    "angles",
    [
        {"theta": TILT, **TURNS, "psi": np.where(SWING > 1, np.inf, TURNS["psi"])},
        {"theta": TILT, **TURNS, "psi": 1e300 * SWING},
        {"theta": np.pi * (SWING % 1 > 0.5), **TURNS},
        {"theta": TILT, **TURNS, "psi": 0 * SWING},
    ],
)
def test_recordings_of_no_top_have_no_good_fit(angles: Any) -> None:
    """Warnings are errors in tests: none may come from the depth of the search."""
    try:
        fate = fit(SWING, **angles).verdict
    except LagtopError as error:
        fate = str(error)
    assert fate in {FAILED, "data: no motion of a top matches the recording"}


@pytest.mark.slow
def test_uncertainties_reach_three_standard_deviations(monkeypatch: pytest.MonkeyPatch) -> None:
    """First order misses the truth by 15 sigma here: chi^2 is flat along one direction."""
    monkeypatch.setattr(fuzz_fits, "CHANNELS", [("phi", "psi")])
    case = fuzz_fits.drawn(88)
    found = fit(case.t, **case.angles, sigma=case.sigma)
    assert all(abs(x) < fuzz_fits.FAR for x in fuzz_fits.pulls(found, case).values())
    monkeypatch.setattr(Problem, "with_reach", lambda _, solution: solution)
    first_order = fit(case.t, **case.angles, sigma=case.sigma)
    assert max(map(abs, fuzz_fits.pulls(first_order, case).values())) > fuzz_fits.FAR


@pytest.mark.slow
def test_no_wrong_fit_of_a_random_recording_is_called_anything_but_failed() -> None:
    """A sample of `fuzz_fits.py`, other recordings than those that the README counts."""
    found = [fuzz_fits.judged(seed) for seed in range(9001, 9041)]
    fates = Counter((one.is_right, one.word) for one in found)
    assert {word for is_right, word in fates if not is_right} <= {FAILED}
    assert fates[True, "good"] >= 36


@pytest.mark.slow
def test_an_impossible_body_that_leaves_more_than_noise_is_a_failure() -> None:
    """Plain harmonics fit this recording of spin and precession no better, so it was doubtful."""
    one = fuzz_fits.judged(50161)
    assert (one.is_right, one.word) == (False, FAILED)
