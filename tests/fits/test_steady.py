"""Recordings of one angle, and of fast tops whose nutation is below the noise; by an integrator."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import fuzz_fits
import numpy as np
import pytest
from conftest import Lagtop, assert_one_line
from engines import Array
from lagtop import LagtopError, Top, fit, solve
from test_fit import written

NOISE = math.radians(0.5)
BODY = {"m": 1.587, "A": 3.9032e-3, "s": 0.04, "g": 9.81}
FAST = Top(**BODY, C=1.7458e-3, r0=800, theta0_deg=60)
"""A top that nutates between 60 and 60.12 degrees; stability factor 200."""
T = np.linspace(0, 5, 600)


def noisy(top: Top, t: Array, names: tuple[str, ...], seed: int) -> dict[str, Any]:
    """Return wrapped angles of a top with noise, by an integrator."""
    return fuzz_fits.noisy(top, t, names, NOISE, np.random.default_rng(seed))


@pytest.mark.slow
@pytest.mark.parametrize("names", [("theta", "psi"), ("psi",), ("theta", "phi", "psi")])
def test_a_fast_top_has_the_ratio_of_b_and_a_only(names: tuple[str, ...]) -> None:
    """The elementary theory is too small by cos(theta)/(4 lambda)."""
    motion = solve(FAST)
    known = {} if "theta" in names else {"theta0_deg": 60}
    found = fit(T, **noisy(FAST, T, names, 1), sigma=NOISE, known=known)
    ratio, stability = motion.b / motion.a, motion.b**2 / (2 * motion.a)
    elementary = ratio * (1 - 0.5 / (4 * stability))
    assert abs(found.values["b/a"] - elementary) < 4 * found.deviations["b/a"]
    assert not {"a", "b", "a_std"} & found.record().keys()
    assert found.notes()[0].startswith("the nutation is below the noise: a and b are known only")
    with pytest.raises(LagtopError, match="a scene needs a and b"):
        found.inputs()
    assert np.abs(found.angles(T)["psi"][-1] - motion.angles(T).psi[-1]) < 0.05


@pytest.mark.slow
def test_known_inputs_of_a_fast_top_give_the_others() -> None:
    angles = noisy(FAST, T, ("theta", "psi"), 2)
    one = fit(T, **angles, known={**BODY, "r0": 800.0})
    assert abs(one.values["b"] - solve(FAST).b) < 4 * one.deviations["b"]
    assert abs(one.record()["C"] - 1.7458e-3) < 4 * one.record()["C_std"]
    other = fit(T, **angles).record()
    assert other["C*r0/(m*s*g)"] == pytest.approx(1.7458e-3 * 800 / (1.587 * 0.04 * 9.81), rel=4e-3)


@pytest.mark.slow
@pytest.mark.parametrize("sigma", [None, NOISE])
def test_deviations_of_a_steady_precession_cover_the_truth(sigma: float | None) -> None:
    """Straight lines with noise: 300 pulls have the standard deviation 1 within 0.13 (3 sigma)."""
    rng, t, pulls = np.random.default_rng(3), np.linspace(0, 4, 40), []
    for _ in range(100):
        lines = {"theta": 0.7 + 0 * t, "psi": 1.0 - 3 * t, "phi": 9.0 * t}
        angles: dict[str, Any] = {
            name: x + rng.normal(scale=NOISE, size=t.size) for name, x in lines.items()
        }
        found = fit(t, **angles, sigma=sigma)
        truth = {"theta0": 0.7, "psidot0": -3.0, "r0": 9 - 3 * math.cos(0.7)}
        pulls += [(found.values[x] - y) / found.deviations[x] for x, y in truth.items()]
    assert np.std(pulls) == pytest.approx(1, abs=0.13)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 9])
def test_the_precession_alone_with_a_known_tilt(seed: int) -> None:
    """Fifteen random tops of fifteen were found, the farthest 2.1 of its sigma off."""
    rng = np.random.default_rng(seed)
    top = fuzz_fits.any_top(rng)
    t = np.linspace(0, 3 * fuzz_fits.period_of(top)[0], 200)
    known = {"theta0_deg": float(top.theta0_deg or 0)}
    found, motion = fit(t, **noisy(top, t, ("psi",), seed), known=known), solve(top)
    assert found.verdict == "good"
    assert abs(found.values["a"] - motion.a) < 4 * found.deviations["a"]
    assert abs(found.values["b"] - motion.b) < 4 * found.deviations["b"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("names", "known", "message"),
    [
        (("psi",), {}, "has neither theta nor phi, and psi does not determine the tilt: fix"),
        (("phi",), {"theta0_deg": 60}, "phi alone does not determine a top"),
        (("theta",), {"r0": 800.0}, "has neither psi nor phi, and theta does not determine"),
        (("theta",), {"psidot0": 0.0}, "theta must nutate beyond its noise"),
        (("theta", "phi"), {}, "theta must nutate beyond its noise"),
    ],
)
def test_angles_that_are_too_little(names: tuple[str, ...], known: Any, message: str) -> None:
    with pytest.raises(LagtopError, match=message):
        fit(T, **noisy(FAST, T, names, 4), known=known)


@pytest.mark.slow
def test_the_report_on_a_fast_top(lagtop: Lagtop, tmp_path: Path) -> None:
    angles = noisy(FAST, T, ("theta", "psi"), 5)
    path = written(tmp_path / "fast.csv", "t,theta,psi", [T, *map(np.degrees, angles.values())])
    shown = lagtop("fit", path, "--sigma", 0.5, "--plot", tmp_path / "fast.svg")
    assert shown.exit_code == 0, shown.stderr
    assert "C r0/2mgs, by the elementary theory" in shown.stdout
    assert "the nutation is below the noise" in shown.stdout
    assert (tmp_path / "fast.svg").exists()
    refused = lagtop("fit", path, "-o", tmp_path / "fast.toml")
    assert_one_line(
        refused, 2, "a scene needs a and b, and this recording determines b/a only: use a"
    )
