"""The words for a rate of steady precession, `steady` and `steady-fast`."""

from __future__ import annotations

import math
import pickle
from fractions import Fraction
from typing import Any

import pytest
from lagtop import LagtopError, Regime, Top, solve
from scenes import UNIT

from lagrange_cli.solver.columns import COLUMNS
from lagrange_cli.solver.keys import all_keys
from lagrange_cli.solver.tables import ProvedTable

DIGITS = 50
WORDS = {"steady": "steady_rate_slow", "steady-fast": "steady_rate_fast"}


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize(
    "inputs",
    [
        {"r0": 60.0, "theta0_deg": 30.0},
        {"r0": -60.0, "theta0_rad": 0.5},
        {"r0": 3, "theta0_deg": 120, **UNIT},
        {"r0": 0.5, "theta0_deg": 100, **UNIT},
        {"r0": 5, "theta0_deg": 40, **UNIT, "g": 0},
    ],
)
def test_the_tilt_of_a_steady_precession_stays_exactly(inputs: Any, word: str) -> None:
    top = Top(**inputs, psidot0=word)
    motion = solve(top)
    rate = getattr(solve(Top(**inputs)), WORDS[word])
    assert motion.regime is (Regime.TORQUE_FREE if inputs.get("g") == 0 else Regime.STEADY)
    assert (motion.mean_precession_rate, float(top.psidot0)) == (rate, rate)
    assert motion.theta_min_deg == motion.theta_max_deg
    a, b, cos = motion.a or 0, motion.b or 0, math.cos(math.radians(motion.theta_min_deg or 0))
    assert cos * rate**2 + a / 2 == pytest.approx(b * rate, rel=1e-12)
    record = motion.record(keys=all_keys(), digits=30, radii=True)
    assert record["psidot0"] == word
    assert len(record["mean_precession_rate"].replace("-", "").replace(".", "").lstrip("0")) <= 30
    table = ProvedTable(motion, list(COLUMNS), DIGITS, radians=True)
    late, start = ([x.value for x in table.row(Fraction(t))] for t in (10**6, 0))
    same = [i for i, name in enumerate(table.header) if name in {"theta_rad", "u", "energy", "Lz"}]
    assert [late[i] for i in same] == [start[i] for i in same]


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
