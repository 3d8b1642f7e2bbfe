"""Numbers and angles with any digits against the reference, zeros, radii, the range of doubles."""

from __future__ import annotations

import json
import math
import sys
from decimal import Decimal
from fractions import Fraction
from itertools import cycle
from random import Random
from typing import Any

import mpmath
import pytest
from conftest import Lagtop
from lagtop import LagtopError, Motion, Top, solve, sweep
from record_reference import State, reference_record, reference_state
from scenes import EVERY_KIND, UNIT

from lagrange_cli.bench.hard_scenes import KINDS
from lagrange_cli.errors import OutOfRangeError, OutOfRangeWarning
from lagrange_cli.solver.keys import NUMBERS, all_keys
from lagrange_cli.solver.record import record_in_range
from lagrange_cli.solver.tables import ProvedTable
from lagrange_cli.top.units import Units

HALF_AND_A_HAIR = Fraction(1, 2) + Fraction(1, 10**81)
WORDS = ("steady", "steady-fast")
SMALLEST, LARGEST = 5e-324, sys.float_info.max
SUBNORMAL = mpmath.mpf("1e-323")
"""The radius of a number below the normal doubles."""
DERIVED: dict[str, dict[str, Any]] = {
    "decimals": {"r0": Fraction("50.1"), "theta0_deg": Fraction("30.1"), "psidot0": -3},
    "phidot0": UNIT | {"phidot0": 1, "psidot0": 2, "theta0_deg": 40},
    "A_cm": {"m": 3, "A_cm": 0.1, "C": 1, "s": 0.7, "g": 1, "r0": 2, "theta0_deg": 40},
    **{
        f"{word} {inputs}": inputs | {"psidot0": word}
        for word in WORDS
        for inputs in (
            *({"r0": 60.0}, {"r0": -60.0, "theta0_rad": 0.5}, UNIT | {"r0": 3, "theta0_deg": 120}),
            *(UNIT | {"r0": 0.5, "theta0_deg": 100}, UNIT | {"r0": 5, "theta0_deg": 40, "g": 0}),
        )
    },
    **{
        f"{word}, phidot0": UNIT | {"C": 0.5, "phidot0": -5, "theta0_deg": 70, "psidot0": word}
        for word in WORDS
    },
    # steady rates that coincide, nearly coincide, and differ in sign only
    "steady rates, tie": UNIT | {"r0": -3, "theta0_deg": 60, "g": 4.5},
    "steady rates, near": UNIT | {"r0": math.nextafter(3**0.25 * 2**0.5, 9), "theta0_deg": 30},
    "steady rates, signs": UNIT | {"r0": 0, "theta0_deg": 120, "A": 2},
    # numbers far below their parts, such as a spin rate of 1e-81
    **{
        f"not 0 at {rates}": UNIT | {"theta0_deg": 60} | rates
        for rates in (
            *({"r0": 1, "thetadot0": 10**20}, {"r0": 1, "thetadot0": 10**28}),
            *({"psidot0": 1, "r0": Fraction(1, 2)}, {"psidot0": 1, "r0": HALF_AND_A_HAIR}),
        )
    },
}
DEEP = {"near hanging", "any spin"}
"""Kinds that take the reference seconds, for thousands of digits: `tools/fuzz.py` has them."""
RANDOM = {kind: make(Random(f"record {kind}")) for kind, make in KINDS.items() if kind not in DEEP}
SCENES = EVERY_KIND | RANDOM | DERIVED
HAIR, TINY, HUGE = mpmath.mpf("1e-9"), mpmath.mpf("1e-90"), mpmath.mpf("1e500")
"""Relative error of the reference, its noise where a number is 0, and a period of such noise."""


def assert_correct(motion: Motion, digits: int, root_digits: int, kept: int) -> None:
    """Check that all numbers and radii of a motion, in doubles and in digits, are the reference's.

    A number exists in both or in neither.  One beyond the doubles exists in digits only.
    """
    exact_record = reference_record(motion.top.as_dict(), digits=kept, root_digits=root_digits)
    record, _ = record_in_range(motion, radii=True, keys=all_keys())
    many = motion.record(digits=digits, radii=True, keys=list(NUMBERS))
    with mpmath.workdps(450):
        for key in NUMBERS:
            true, value, text = exact_record.get(key), record[key], many[key]
            if text is None and key.startswith("T_") and (true or 0) > HUGE:
                true = None
            known = f"{key} is {text}, or absent in record_reference.py: add it there if it is new"
            assert (text is None) == (true is None) == (many[f"{key}_radius"] is None), known
            assert (value is None) == (record[f"{key}_radius"] is None), key
            assert value is not None or not true or not SMALLEST < abs(true) < LARGEST, known
            for found, last in ((record, value), (many, text)):
                if found[key] is None or true is None:
                    continue
                away, radius = abs(true - mpmath.mpf(last)), mpmath.mpf(found[f"{key}_radius"])
                size = Decimal(last).adjusted() + 1 - digits
                unit = mpmath.mpf(math.ulp(last) if found is record else mpmath.mpf(10) ** size)
                slack = unit * HAIR if mpmath.mpf(last) else TINY
                assert away <= unit / 2 + slack, (key, digits, last)
                assert away <= radius + slack, (key, radius)
                assert radius <= max(unit, SUBNORMAL) or not value, (key, radius)
                assert str(last) != "-0.0", key


@pytest.mark.parametrize(("name", "digits"), [*zip(SCENES, cycle([30, 1, 20, 60]))])
def test_every_number_is_rounded_correctly_and_its_radius_holds(name: str, digits: int) -> None:
    assert_correct(solve(Top(**SCENES[name])), digits, 1_000, 120 + digits)


# Parts that cancel


@pytest.mark.parametrize(
    ("inputs", "t"),
    [
        ({"r0": 1e12, "theta0_deg": 40}, 1),
        *(({"r0": 5, "theta0_deg": 30}, Fraction(1, 10**n)) for n in (8, 40)),
        # on the separatrix tilt and nutation rate fall to 0, in the second case by 2,800 digits
        *(({"m": 2, "r0": 0, "theta0_deg": 90, "thetadot0": 2}, t) for t in (10, 10_000, 10**12)),
        (EVERY_KIND["separatrix"], 10_000),
    ],
)
def test_small_angles_and_rates_keep_their_digits(inputs: dict[str, Any], t: Any) -> None:
    motion = solve(Top(**UNIT | inputs))
    found = ProvedTable(motion, State._fields[:4], 30, units=Units(radians=True)).row(Fraction(t))
    with mpmath.workdps(120):
        for number, true in zip(found, reference_state(motion.top.as_dict(), t, 300), strict=False):
            assert abs(mpmath.mpf(number.value) - true) <= abs(true) * mpmath.mpf("1e-29")


# Beyond the range of doubles

SCENE: dict[str, float] = {"r0": 2e-307, "theta0_deg": 30}
"""Almost a pendulum: it passes so close to the lower pole that it precesses there at 1e309."""
BEYOND = ["spin_rate_half", "precession_rate_half"]


def test_a_number_beyond_doubles_spoils_only_itself() -> None:
    motion, pendulum = solve(Top(**SCENE)), solve(Top(r0=0))
    with pytest.warns(OutOfRangeWarning, match=r"spin_rate_half .*; precession_rate_half"):
        record = motion.record()
    assert [key for key, value in record.items() if value is None] == [*BEYOND, "remark"]
    assert (record["T_nutation"], record["u2"]) == (pendulum.T_nutation, -1)
    assert motion.record(digits=20)["spin_rate_half"].startswith("3.56")
    for key in BEYOND:
        with pytest.raises(OutOfRangeError, match=f"^{key} must be within 1.8e308"):
            getattr(motion, key)
        with pytest.raises(LagtopError, match=f"^{key} must be within 1.8e308"):
            motion.record(keys=["T_nutation", key])
    found = sweep(keys=["T_nutation", *BEYOND, "error"], r0=[SCENE["r0"], 5.0], theta0_deg=30)
    assert all(math.isnan(found[key][0]) and not math.isnan(found[key][1]) for key in BEYOND)
    assert found["T_nutation"][0] == motion.T_nutation
    assert str(found["error"][0]).startswith("spin_rate_half must be within 1.8e308")
    assert found["error"][1] is None


@pytest.mark.parametrize(("fmt", "none"), [("json", "null"), ("csv", ",,")])
def test_a_command_warns_of_numbers_beyond_doubles(lagtop: Lagtop, fmt: str, none: str) -> None:
    result = lagtop("solve", "--r0", "2e-307", "--format", fmt)
    assert none in result.stdout
    assert result.stderr.startswith("Warning: spin_rate_half must be within 1.8e308")
    assert result.stderr.count("\n") == 1
    assert lagtop("solve", "--r0", "2e-307", "--get", "T_nutation").stderr == ""


# Radii


def test_radians_and_inputs_have_radii() -> None:
    record = solve(Top(theta0_deg=30.0)).record(radians=True, radii=True)
    assert record["theta0_rad"] == 0.5235987755982989
    assert 0 < float(record["theta0_rad_radius"]) < 1.2e-16
    assert record["m_radius"] == "0.0"
    rounded = solve(Top(m=Fraction("1587.25"))).record(digits=4, radii=True)
    assert (rounded["m"], rounded["m_radius"]) == ("1587.0", "0.26")
    some = solve(Top()).record(keys=["T_nutation", "regime"], radii=True)
    assert list(some) == ["regime", "T_nutation", "T_nutation_radius"]


def test_commands_write_radii(lagtop: Lagtop) -> None:
    solved = json.loads(lagtop("solve", "--certify", "--format", "json").stdout)
    assert 0 < solved["T_nutation_radius"] < 2.8e-17
    assert list(solved).index("m_radius") == list(solved).index("remark") + 1
    plain = json.loads(lagtop("solve", "--format", "json").stdout)
    assert {key: solved[key] for key in plain} == plain
    texts = {"regime", "path", "remark", "summary"}
    assert solved.keys() - plain.keys() == {f"{key}_radius" for key in plain.keys() - texts}
    assert str(solved["T_nutation_radius"]) in lagtop("solve", "--certify").stdout
    row = json.loads(
        lagtop("table", "--certify", "--t-min", 1e9, "--n", 1, "--format", "json").stdout
    )
    assert list(row[0])[3:6] == ["psi_deg", "theta_deg_radius", "phi_deg_radius"]
    assert 0 < row[0]["phi_deg_radius"] <= row[0]["phi_deg"] * 2.0**-52
