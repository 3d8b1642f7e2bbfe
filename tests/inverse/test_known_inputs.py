"""`fit` with known inputs: they determine others, widen their uncertainties, and may contradict."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import recordings
from lagtop import Top, solve
from noisy_recordings import LAB, TRUTH, assert_true, fitted, recorded


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
    t, seen = recorded("theta", "psi", seed=8)
    outcome = fitted(t, seen, known=known)
    assert_true(outcome, truth)
    assert known.keys() & outcome.numbers.keys() <= {"C", "r0"}  # if they are improved
    assert not any("is not used" in x for x in outcome.notes)
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


@pytest.mark.parametrize(
    ("s", "is_possible"), [(0.08, True), (8.0, False), ("8 +/- 4", True)], ids=str
)
def test_a_moment_below_that_of_a_point_mass_is_noted(s: Any, is_possible: bool) -> None:
    """A grows as s, and m s^2 as its square: s in cm makes A = 0.445 less than m s^2 = 32."""
    t, seen = recorded("theta", "psi", seed=8)
    notes = fitted(t, seen, known=LAB | {"s": s}).notes
    wrong = "A is impossible: a rigid body needs A > m s^2 = 32: check the values and units of m, s"
    assert any(x.startswith(wrong) for x in notes) != is_possible


def test_an_uncertain_input_widens_only_what_depends_on_it() -> None:
    t, seen = recorded("theta", "psi", seed=9)
    sure, unsure = (fitted(t, seen, known=LAB | {"C": c}).numbers for c in (2.5e-3, "0.0025(1)"))
    assert unsure["r0"].std == pytest.approx(52.36 * 0.04, rel=0.01)
    assert "C" not in unsure  # the recording does not improve it
    assert unsure["r0"].own_std == pytest.approx(sure["r0"].std, rel=1e-3)
    for key in ("T_nutation", "mean_precession_rate", "b", "A"):
        assert unsure[key][:2] == pytest.approx(sure[key][:2], rel=1e-4)


def test_a_rough_input_is_improved() -> None:
    """The fit with it begins in phase with the recording, whatever b the rough value implies."""
    t, seen = recorded("theta", "psi", "phi", seed=9)
    found = fitted(t, seen, known=LAB | {"C": "0.003(1)"})
    assert_true(found, TRUTH)
    assert found.numbers["b"].std < 0.3


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


def test_a_prior_lies_between_a_known_input_and_none() -> None:
    """The estimate of A is the mean of prior and data, weighted by their variances."""
    t, seen = recorded("theta", "psi", seed=10)
    value, std, *_ = fitted(t, seen, known=LAB).numbers["A"]
    prior, spread = 4.44e-3, 3 * std
    found = fitted(t, seen, known=LAB | {"A": f"{prior!r} +/- {spread!r}"}).numbers["A"]
    weights = np.array([std**-2, spread**-2])
    assert found.value == pytest.approx(weights @ [value, prior] / weights.sum(), abs=0.02 * std)
    assert found.std == pytest.approx(weights.sum() ** -0.5, rel=0.02)


@pytest.mark.parametrize(
    ("known", "cause"),
    [
        ({"C": "0.00270(10)", "r0": "60(1)"}, "omit C, or check m, g, s, r0"),
        ({"A": 4.45e-3 - 0.5 * 0.08**2}, "it is about the centre of mass, so give A_cm instead"),
        ({"C": 2.5e-3, "r0": 500.0}, "about 9.55 times as large: check the units, or omit C"),
        ({"C": 2.5e-3, "r0": 52.36, "psidot0": 1.0}, "omit psidot0"),
        ({"theta0_deg": 0.0}, "omit theta0"),
        ({"C": 2.5e-4, "r0": 52.36}, "about 1/10 of it: check the units, or omit C"),
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
    failure = fitted(np.arange(120.0), seen, known=LAB | {"C": "0.00250(5)"}).failure()
    assert failure.startswith("known C = 0.0025")
    assert failure.endswith("omit C, or check m, g, s, the unit of t")


@pytest.mark.slow
def test_known_inputs_that_are_right_do_not_hide_the_cause() -> None:
    t, seen = recorded("theta", "phi", "psi", rows=80, noise=0.1, seed=8)
    turned = seen | {"theta": math.pi / 2 - seen["theta"]}
    known = LAB | {"r0": 52.36, "C": 2.5e-3}
    assert "from the horizontal" in fitted(t, turned, known=known).failure()


_OF_A_SPIN = pytest.param({"r0": 600}, marks=pytest.mark.slow)


@pytest.mark.parametrize("known", [_OF_A_SPIN, {"C": 1.7458e-3}])
def test_a_known_input_decides_the_direction_of_psi(known: dict[str, float]) -> None:
    """At 120 rows per second, written in microseconds; with psi reversed a slower spin fits."""
    top = recordings.TOP.replace(r0=600, theta0_deg=40, psidot0=1.5, thetadot0=4)
    t, seen = recorded(
        "theta", "phi", "psi", top=top, rows=240, seconds=239 / 120, noise=0.05, seed=2
    )
    outcome = fitted(np.round(t, 6), seen, known={"m": 1.587, "g": 9.81, "s": 0.04} | known)
    assert_true(outcome, {"a": solve(top).a, "b": solve(top).b, "A": 3.9032e-3})
    assert not outcome.recording.is_mirrored


@pytest.mark.slow
def test_a_known_tilt_that_is_wrong_is_questioned() -> None:
    t, seen = recorded("psi", rows=60, noise=0.05, seed=8)
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
    "wrong", [{"A": 1.3 * 4.45e-3}, {"A": 4.45e-3, "m": 0.4}, {"A": 4.45e-3, "C": 3e-3}]
)
def test_a_wrong_body_is_named_and_no_machine(wrong: dict[str, float]) -> None:
    """What a machine would change is computed for the motion, not for the wrong body."""
    top = Top(**LAB, A=4.45e-3, C=2.5e-3, r0=52, theta0_deg=30, psidot0=2)
    t, seen = recorded("theta", "phi", "psi", top=top, seed=1)
    outcome = fitted(t, seen, known=LAB | wrong)
    name = "C" if "C" in wrong else "A"
    assert [x[:9] for x in outcome.failures()] == [f"known {name} ="]
    assert outcome.inputs is not None
    found, exact = solve(Top(**outcome.inputs)), solve(top)
    assert (found.a, found.b) == pytest.approx((exact.a, exact.b), rel=0.02)
    assert outcome.inputs["r0"] == pytest.approx(52, rel=0.01)


def test_the_unit_of_a_known_spin_is_named() -> None:
    """Also if a faster spin that looks alike in the rows is nearer."""
    t, seen = recorded("theta", "phi", "psi", seed=4)
    failure = fitted(t, seen, known={"r0": 52.36 * 30 / math.pi}).failure()
    assert failure.startswith("known r0 = 500.001 contradicts the recording")
    assert "9.55 times as large" in failure
