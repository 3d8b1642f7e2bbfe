"""Proved numbers: they agree with the judge in balls, which has formulas of its own."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from ball_judge import Judge
from scenes import UNIT

from lagrange_cli import LagtopError, Top, solve
from lagrange_cli.arithmetic.balls import balls
from lagrange_cli.motion.certified import certified
from lagrange_cli.motion.record import NUMBER_KEYS, requested_keys

SCENES: dict[str, dict[str, Any]] = {
    "worked example": {},
    "fast": {"r0": 2000.0},
    "slow": UNIT | {"r0": 0.5, "theta0_deg": 130},
    "any start": UNIT | {"r0": 2, "theta0_deg": 70, "thetadot0": 0.75, "psidot0": 0.5},
    "looping": UNIT | {"r0": -3, "theta0_deg": 110, "thetadot0": 1.5, "psidot0": 1},
    "starts lowest": UNIT | {"r0": 3, "theta0_deg": 40, "psidot0": 2},
    "radians": UNIT | {"r0": 3, "theta0_rad": 0.7, "psidot0": 2},
    "over the top": UNIT | {"theta0_deg": 120, "psidot0": 1, "r0": 0.5, "thetadot0": 2.5},
    "over the bottom": UNIT | {"theta0_deg": 60, "psidot0": -2, "r0": 1, "thetadot0": 0.7},
    "pendulum": UNIT | {"theta0_deg": 60, "r0": 0},
    "whirling": UNIT | {"theta0_deg": 60, "r0": 0, "thetadot0": -3},
    "from the upper pole": UNIT | {"theta0_deg": 0, "r0": 1, "thetadot0": 1},
    "from the lower pole": UNIT | {"theta0_deg": 180, "r0": 1, "thetadot0": -1},
    "cusp": UNIT | {"theta0_deg": 60, "r0": 2, "psidot0": 0.5, "thetadot0": 0.75},
    "separatrix": UNIT | {"theta0_deg": 60, "psidot0": 1, "r0": 1.5, "thetadot0": 0.5},
    "next to it": UNIT | {"theta0_deg": 60, "psidot0": 1, "r0": 1.5, "thetadot0": 0.5 + 1e-13},
    "steady": UNIT | {"theta0_deg": 60, "psidot0": 1, "r0": 1.5},
    "nearly steady": UNIT | {"theta0_deg": 60, "psidot0": 1, "r0": 1.5 + 1e-12},
    "sleeping": UNIT | {"theta0_deg": 0, "r0": 3},
    "hanging": UNIT | {"theta0_deg": 180, "r0": 3},
    "torque-free": UNIT | {"theta0_deg": 50, "g": 0, "r0": 2, "psidot0": 1, "thetadot0": 1},
    "torque-free at rest": UNIT | {"theta0_deg": 50, "g": 0, "r0": 2},
    "idle": UNIT | {"theta0_deg": 50, "g": 0, "r0": 0},
    "k = k'": UNIT | {"theta0_deg": 60, "r0": 2**0.5},
}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_the_record_is_that_of_the_program_and_of_the_judge(scene: dict[str, Any]) -> None:
    top = Top(**scene)
    proved, plain, judge = certified(top).record(), solve(top).record(), Judge(top.as_dict())
    assert {key: proved[key] for key in plain} == plain
    for key in NUMBER_KEYS:
        exact = judge.record.get(key)
        assert (proved[key] is None) == (exact is None) == (proved[f"{key}_radius"] is None), key
        if exact is not None:
            with balls(400).working():
                away = abs(exact - balls(400).convert(proved[key]).arb)
                radius = balls(400).convert(Fraction(proved[f"{key}_radius"])).arb
                assert not away > radius, key
                assert radius <= abs(exact) * 2.0**-52 or away.contains(0), key


@pytest.mark.parametrize("name", ["worked example", "any start", "over the top", "torque-free"])
def test_numbers_on_request(name: str) -> None:
    top = Top(**SCENES[name])
    motion, proved = solve(top), certified(top)
    for key in requested_keys():
        found = proved.number(key)
        assert (None if found is None else found.value) == getattr(motion, key), key


@pytest.mark.parametrize("digits", [1, 20, 150])
@pytest.mark.parametrize("name", ["worked example", "any start", "separatrix", "radians"])
def test_digits_are_those_of_the_program(digits: int, name: str) -> None:
    top = Top(**SCENES[name])
    plain, proved = solve(top).digits(digits), certified(top).record(digits)
    assert {key: proved[key] for key in plain} == plain
    for key in ("T_nutation", "u2"):
        if plain[key] is not None:
            size, radius = abs(Fraction(proved[key])), Fraction(proved[f"{key}_radius"])
            assert 0 < radius <= size * Fraction(10) ** (1 - digits)


def test_radians_and_inputs_have_radii() -> None:
    record = certified(Top(theta0_deg=30.0)).record(radians=True)
    assert record["theta0_rad"] == 0.5235987755982989
    assert 0 < float(record["theta0_rad_radius"]) < 1.2e-16
    assert record["m_radius"] == "0.0"
    assert list(record)[-1] == "precession_rate_half_radius"
    rounded = certified(Top(m=Fraction("1587.25"))).record(4)
    assert (rounded["m"], rounded["m_radius"]) == ("1587.0", "0.26")
    some = certified(Top()).record(keys=["T_nutation", "regime"])
    assert list(some) == ["regime", "T_nutation", "T_nutation_radius"]


def test_a_number_beyond_doubles_is_said() -> None:
    with pytest.raises(LagtopError, match=r"within 1\.8e308"):
        certified(Top(m=1e100, s=1e100, g=1e100, A=1e-80, C=1e-80)).record()
