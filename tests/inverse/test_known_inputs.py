"""`fit` with known inputs: they determine others, widen their uncertainties, and may contradict."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import recordings
from lagtop import Top, solve
from noisy_recordings import LAB, TRUTH, assert_true, fitted, recorded

from lagrange_cli.names import ANGLES


@pytest.mark.parametrize(
    ("known", "truth"),
    [
        (LAB | {"C": 2.5e-3, "A": 4.45e-3}, {"r0": 52.36, "b": TRUTH["b"]}),
        ({"r0": 52.36, "C": 2.5e-3, "g": 9.81}, {"A": 4.45e-3, "m*s": 0.04}),
        (LAB | {"C": "0.0025(1)", "r0": "52.4(9)"}, {"A": 4.45e-3, "b": TRUTH["b"]}),
        ({"A": 4.45e-3, "C": 2.5e-3, "r0": 52.36}, {"a": TRUTH["a"], "m*g*s": 0.3924}),
        (LAB | {"A_cm": 4.45e-3 - 0.5 * 0.08**2}, {"b": TRUTH["b"], "C*r0": 2.5e-3 * 52.36}),
        (LAB | {"theta0_deg": 75, "psidot0": 0}, {"A": 4.45e-3, "b": TRUTH["b"]}),
    ],
)
def test_known_inputs_determine_others(known: dict[str, float], truth: dict[str, float]) -> None:
    outcome = fitted(*recorded("theta", "psi", seed=8), known=known)
    assert_true(outcome, truth)
    assert known.keys() & outcome.numbers.keys() <= {"C", "r0"}  # if they are improved
    assert not any("is not used" in x for x in outcome.notes)
    assert all(x < 3 for x in outcome.distances.values())
    agreeing = [x for x in outcome.notes if "agrees with the recording" in x]
    assert len(agreeing) == len(outcome.distances)
    product = "only C*r0 can be determined, unless C or r0 is given"
    assert (product in outcome.notes) == ("C*r0" in outcome.numbers)


def test_a_known_rate_of_spin_is_no_total_spin() -> None:
    """r0 = phidot0 + psidot0 cos(theta0), and a scene has the motion whatever is not known."""
    top = Top(**LAB, A=4.45e-3, C=2.5e-3, phidot0=40, psidot0=6, theta0_deg=75)
    t, seen = recorded("theta", "psi", "phi", top=top, seed=8)
    nothing: dict[str, Any] = {}
    for known in (LAB | {"C": 2.5e-3, "phidot0": 40}, nothing):
        outcome = fitted(t, seen, known=known)
        truth = {"A": 4.45e-3, "psidot0": 6, "r0": float(top.r0), "a": solve(top).a}
        assert_true(outcome, truth)
        assert outcome.inputs is not None
        again, exact = solve(Top(**outcome.inputs)), solve(top)
        for key in ("a", "b", "T_nutation", "mean_precession_rate"):
            assert getattr(again, key) == pytest.approx(getattr(exact, key), rel=0.02), key


def test_a_moment_below_that_of_a_point_mass_is_noted() -> None:
    """A grows as s, and m s^2 as its square: s in cm makes A = 0.445 less than m s^2 = 32."""
    wrong = "A is impossible: a rigid body needs A > m s^2 = 32: check the values and units of m, s"
    for s, is_possible in (("8 +/- 4", True), (8.0, False)):
        outcome = fitted(*recorded("theta", "psi", seed=8), known=LAB | {"s": s})
        assert any(x.startswith(wrong) for x in outcome.notes) != is_possible


def test_an_uncertain_input_widens_only_what_depends_on_it() -> None:
    t, seen = recorded("theta", "psi", seed=9)
    sure, unsure = (fitted(t, seen, known=LAB | {"C": c}).numbers for c in (2.5e-3, "0.0025(1)"))
    assert unsure["r0"].std == pytest.approx(52.36 * 0.04, rel=0.01)
    assert "C" not in unsure  # the recording does not improve it
    assert unsure["r0"].own_std == pytest.approx(sure["r0"].std, rel=1e-3)
    for key in ("T_nutation", "mean_precession_rate", "b", "A"):
        assert unsure[key][:2] == pytest.approx(sure[key][:2], rel=1e-4)


def test_a_known_spin_that_is_not_recorded_keeps_its_uncertainty() -> None:
    """Without phi nothing is said of r0, and C = b A/r0 is as uncertain; a known C improves r0."""
    t, seen = recorded("theta", "psi", seed=9)
    alone = fitted(t, seen, known=LAB | {"r0": "56(4)"})
    assert not any(x.startswith("known r0") for x in alone.notes)
    assert alone.numbers["C"].std == pytest.approx(alone.numbers["C"].value * 4 / 56, rel=0.05)
    both = fitted(t, seen, known=LAB | {"r0": "56(4)", "C": "0.00250(3)"})
    assert both.distances.keys() == {"C"}
    assert both.distances["C"] == pytest.approx(0.9, abs=0.2)
    assert_true(both, {"r0": 52.36, "C": 2.5e-3})


def test_a_prior_is_weighted_and_a_rough_one_improved() -> None:
    """The estimate of A is the mean of prior and data, weighted by their variances."""
    t, seen = recorded("theta", "psi", seed=10)
    value, std, *_ = fitted(t, seen, known=LAB).numbers["A"]
    prior, spread = 4.44e-3, 3 * std
    found = fitted(t, seen, known=LAB | {"A": f"{prior!r} +/- {spread!r}"}).numbers["A"]
    weights = np.array([std**-2, spread**-2])
    assert found.value == pytest.approx(weights @ [value, prior] / weights.sum(), abs=0.02 * std)
    assert found.std == pytest.approx(weights.sum() ** -0.5, rel=0.02)
    # a fit with a rough value begins in phase with the recording, whatever b that implies
    rough = fitted(*recorded(*ANGLES, seed=9), known=LAB | {"C": "0.003(1)"})
    assert_true(rough, TRUTH)
    assert rough.numbers["b"].std < 0.3


@pytest.mark.parametrize(
    "known", [pytest.param({"r0": 600}, marks=pytest.mark.slow), {"C": 1.7458e-3}]
)
def test_a_known_input_decides_the_direction_of_psi(known: dict[str, float]) -> None:
    """At 120 rows per second, written in microseconds; with psi reversed a slower spin fits."""
    top = recordings.TOP.replace(r0=600, theta0_deg=40, psidot0=1.5, thetadot0=4)
    t, seen = recorded(*ANGLES, top=top, rows=240, seconds=239 / 120, noise=0.05, seed=2)
    outcome = fitted(np.round(t, 6), seen, known={"m": 1.587, "g": 9.81, "s": 0.04} | known)
    assert_true(outcome, {"a": solve(top).a, "b": solve(top).b, "A": 3.9032e-3})
    assert not outcome.recording.is_mirrored


@pytest.mark.parametrize(
    "wrong", [{"A": 1.3 * 4.45e-3}, {"A": 4.45e-3, "m": 0.4}, {"A": 4.45e-3, "C": 3e-3}]
)
def test_a_wrong_body_is_named_and_no_machine(wrong: dict[str, float]) -> None:
    """What a machine would change is computed for the motion, not for the wrong body."""
    top = Top(**LAB, A=4.45e-3, C=2.5e-3, r0=52, theta0_deg=30, psidot0=2)
    outcome = fitted(*recorded(*ANGLES, top=top, seed=1), known=LAB | wrong)
    name = "C" if "C" in wrong else "A"
    assert [x[:9] for x in outcome.failures()] == [f"known {name} ="]
    assert outcome.inputs is not None
    found, exact = solve(Top(**outcome.inputs)), solve(top)
    assert (found.a, found.b) == pytest.approx((exact.a, exact.b), rel=0.02)
    assert outcome.inputs["r0"] == pytest.approx(52, rel=0.01)
