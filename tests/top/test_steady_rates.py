"""The words for a rate of steady precession; `solver/test_digits` checks the numbers."""

from __future__ import annotations

import pickle
from fractions import Fraction
from typing import Any

import pytest
from lagtop import LagtopError, Regime, Top, solve
from scenes import UNIT

from lagrange_cli.solver.tables import ProvedTable


@pytest.mark.parametrize("word", ["steady", "steady-fast"])
@pytest.mark.parametrize(
    "inputs", [{"r0": -60.0, "theta0_rad": 0.5}, UNIT | {"r0": 5, "theta0_deg": 40, "g": 0}]
)
def test_the_tilt_of_a_steady_precession_stays_exactly(inputs: Any, word: str) -> None:
    motion = solve(Top(**inputs, psidot0=word))
    assert motion.regime is (Regime.TORQUE_FREE if inputs.get("g") == 0 else Regime.STEADY)
    assert motion.record(digits=30)["psidot0"] == word
    table = ProvedTable(motion, ["theta", "u", "energy", "Lz"], 50, radians=True)
    late, start = ([x.value for x in table.row(Fraction(t))] for t in (10**6, 0))
    assert late == start


def test_the_steady_motion_is_that_of_the_exact_root() -> None:
    """The nearest double is off by half a unit, and that top nutates."""
    word = solve(Top(r0=60, psidot0="steady"))
    double = solve(Top(r0=60, psidot0=float(word.top.psidot0)))
    assert (word.regime, double.regime) == (Regime.STEADY, Regime.REGULAR)
    assert word.k == 0
    assert 0 < double.k < 1e-7
    assert word.top != double.top
    assert pickle.loads(pickle.dumps(word.top)) == word.top == Top(**word.top.as_dict())
    assert "psidot0='steady'" in repr(word.top)
    assert Top(r0=0, g=0, psidot0="steady").psidot0 == 0


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"r0": 50}, r"psidot0 .* steady: \|r0\| must be at least 52.5611 at this tilt, got .* 50"),
        ({"r0": 60, "thetadot0": 1}, "thetadot0 must be 0 for psidot0 = steady, got 1.0"),
        ({"r0": 60, "theta0_deg": 180}, "psidot0 must be 0 if the axis is vertical, got steady"),
        ({"r0": 0, "theta0_deg": 90}, "psidot0 cannot be steady: at 90 degrees r0 must not be 0"),
        ({"psidot0": "steady-fast", "theta0_deg": 90}, "at 90 degrees the fast rate is infinite"),
        ({"psidot0": "fast"}, "psidot0 must be a real number, steady or steady-fast, got 'fast'"),
        ({"r0": "steady"}, "r0 must be a real number, got 'steady'"),
        ({"phidot0": 3}, r"steady: \|phidot0\| must be at least 39.0768 at this tilt, got .* 3.0"),
        ({"phidot0": 0, "theta0_deg": 90}, "at 90 degrees phidot0 must not be 0"),
        ({"phidot0": 3, "A": 17458, "psidot0": "steady-fast"}, "the fast rate is infinite"),
    ],
)
def test_words_that_fit_no_motion_are_refused(inputs: Any, message: str) -> None:
    with pytest.raises(LagtopError, match=message):
        Top(**{"psidot0": "steady", **inputs})
