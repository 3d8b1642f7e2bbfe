"""`fit` of recordings without a nutation that can be seen: mean rates of steady precessions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from engines import Array
from lagtop import LagtopError, Top, fit, solve
from noisy_recordings import LAB, TOP, fitted, pulls, recorded, recording_from

from lagrange_cli.inverse.search import best_fit
from lagrange_cli.names import ANGLES


def fast(r0: float = 400, rows: int = 200) -> tuple[Array, dict[str, Array]]:
    """Return a recording whose nutation, of 0.02 degrees for r0 = 400, is invisible."""
    return recorded(*ANGLES, top=TOP.replace(r0=r0), rows=rows, seconds=0.5, seed=15)


@pytest.mark.parametrize(("way", "rows"), [(1, 200), (-1, 200), (1, 100)])
def test_a_fast_top_has_mean_rates(way: int, rows: int) -> None:
    """psi may count in either direction; a spin of a quarter of a turn per row does not show C."""
    t, seen = fast(rows=rows)
    outcome = fitted(t, seen | {"psi": way * seen["psi"]})
    assert outcome.verdict == "good, no nutation"
    assert outcome.inputs is None
    turn = f"only up to whole turns per row, multiples of {2 * math.pi * (rows - 1) / 0.5:.6g}"
    assert any(turn in x for x in outcome.notes)
    exact = solve(TOP.replace(r0=400))
    tilt = (exact.theta_min_deg + exact.theta_max_deg) / 2
    truth = {"mean_precession_rate": exact.mean_precession_rate, "r0": 400, "mean_tilt_deg": tilt}
    product = {200: {"C/(m*s*g)": 2.5e-3 / 0.3924}, 100: {"C*r0/(m*s*g)": 1 / 0.3924}}
    truth |= {"b/a": exact.b / exact.a} | product[rows]
    off = pulls(outcome, truth)
    assert off.keys() == truth.keys()
    assert all(abs(x) < 4 for x in off.values()), off
    with pytest.raises(LagtopError, match="a steady precession does not determine a top"):
        outcome.scene("data")


def test_means_of_a_steady_precession() -> None:
    rng, t = np.random.default_rng(6), np.linspace(0, 4, 200)
    theta, psi, phi = (x + rng.normal(scale=0.01, size=200) for x in (0 * t + 1, 2 * t, 15 * t))
    outcome = fit(t, theta=theta, psi=psi, phi=phi)
    assert outcome.verdict == "good, no nutation"
    rate, mean = 0.01 * math.sqrt(12 / 200) / 4, 0.01 / math.sqrt(200)
    r0 = math.hypot(rate, rate * math.cos(1), 2 * math.sin(1) * mean)
    truth = {"mean_tilt_deg": (math.degrees(1), math.degrees(mean))}
    truth |= {"mean_precession_rate": (2, rate), "mean_spin_rate": (15, rate)}
    truth |= {"r0": (15 + 2 * math.cos(1), r0)}
    for key, (value, std) in truth.items():
        found = outcome.numbers[key]
        assert found.std == pytest.approx(std, rel=0.2), key
        assert abs(found.value - value) < 4 * std, key


@pytest.mark.parametrize("ratio", [0.05, 0.2, 0.5])
def test_the_term_that_elementary_theory_neglects(ratio: float) -> None:
    """A Omega cos(theta) is in the uncertainty, or exact if A, m, g and s are known."""
    start = {"m": 1, "s": 0.5, "g": 100, "A": 1, "C": ratio, "r0": 30 / ratio, "theta0_deg": 40}
    top = Top(**start, psidot0=solve(Top(**start, psidot0="steady")).steady_rate_slow)
    t, seen = recorded(*ANGLES, top=top, rows=100, seconds=0.05, noise=0.02, seed=16)
    found = fitted(t, seen).numbers["b/a"]
    assert abs(found.value - 30 / 100) < 2 * found.std < 0.4 * found.value
    known = {"A_cm": 0.75, "m": 1, "g": 100, "s": 0.5}
    exact = fitted(t, seen, known=known).numbers
    assert exact["b/a"].std < 0.02 * found.value
    assert abs(exact["b/a"].value - 30 / 100) < 4 * exact["b/a"].std
    assert abs(exact["C"].value - ratio) < 4 * exact["C"].std


@pytest.mark.parametrize(
    ("known", "said"),
    [
        ({"r0": "401(2)"}, ""),
        ({"spin_period": "0.015712(2)"}, ""),  # phi' = r0 - psi' cos(theta) is 399.9
        ({"spin_period": 2 * math.pi / 372}, "omit spin_period"),
        ({"r0": 3819.7}, "9.55 times as large: check the units"),
        ({"r0": -400}, "of the opposite sign: check the sign"),
    ],
)
def test_a_known_spin_is_compared_with_the_visible_one(known: dict[str, Any], said: str) -> None:
    """Whole turns per row, 2501 rad/s, are invisible."""
    t, seen = fast()
    outcome = fitted(t, seen, known=known)
    (name,) = known
    assert outcome.verdict == ("failed" if said else "good, no nutation")
    assert (outcome.distances[name] < 3) == (not said)
    assert said in "; ".join(outcome.failures())


@pytest.mark.parametrize("r0", [400, 1500, -1500])
def test_a_known_moment_selects_the_spin(r0: float) -> None:
    """Whole turns per row, 1244 rad/s, are invisible, but C r0 = 2mgs b/a is not."""
    t, seen = fast(r0, 100)
    found = fitted(t, seen, known=LAB | {"C": 2.5e-3})
    assert abs(found.numbers["r0"].value - r0) < 4 * found.numbers["r0"].std < 0.2
    assert found.distances["C"] < 3
    unsure = fitted(t, seen, known=LAB | {"C": "0.0025(5)"})
    assert any(x.startswith("known C is not used") for x in unsure.notes) == (abs(r0) > 622)


def test_a_known_moment_that_no_number_contradicts_is_not_compared() -> None:
    """Without m, g and s, C follows from the known C itself; with all of them, b/a is no news."""
    t, seen = fast()
    for C in (2.4e-3, 2.5e-3):
        outcome = fitted(t, seen, known={"A": 4.45e-3, "C": C})
        assert outcome.verdict == "good, no nutation"
        assert (outcome.distances, "b/a" in outcome.numbers) == ({}, True)
    del seen["phi"]
    outcome = fitted(t, seen, known=LAB | {"A": 4.45e-3, "C": 2.5e-3, "r0": 400})
    assert ([*outcome.distances], "b/a" in outcome.numbers) == (["C"], False)


@pytest.mark.slow
def test_a_toy_that_turns_faster_than_its_frames() -> None:
    """At 1.6 turns per frame, b/a allows for any C/A and either direction of psi."""
    body = {"m": 0.1, "s": 0.04, "g": 9.81}
    top = Top(**body, A=4e-4, C=8e-5, r0=300, theta0_deg=60, psidot0="steady")
    t, seen = recorded(*ANGLES, top=top, rows=300, seconds=10, noise=0.5, seed=6)
    outcome = fitted(t, seen, known=body)
    assert outcome.verdict == "good, no nutation"
    ratio, product = (outcome.numbers[x] for x in ("b/a", "C*r0"))
    assert 8e-5 * 300 / (2 * 0.1 * 0.04 * 9.81) == pytest.approx(ratio.value, abs=2 * ratio.std)
    assert product.value - 2 * product.std < 8e-5 * 300 < product.value + 2 * product.std
    share = 0.829 / (78.65 * 0.05)  # of A Omega cos(theta) if psi counts the other way, C = A/20
    widest = share / (2 - share) / 1.75
    assert ratio.std / ratio.value == pytest.approx(widest, rel=0.05)
    found = fitted(t, seen, known=body | {"C": 8e-5}).numbers["r0"]
    assert abs(found.value - 300) < 4 * found.std < 0.2


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
    swing = np.abs(0.02 * np.sin(9 * t)) + np.abs(rng.normal(scale=0.02, size=100))
    assert fit(t, theta=swing, phi=9 * t, psi=2 * np.sin(27 * t)).verdict == "failed"  # at a pole
    still = fit(t, theta=np.full(100, 0.7), psi=np.full(100, 0.2))
    assert "the precession rate is not determined" in still.failure()
