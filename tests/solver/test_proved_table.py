"""Proved columns that are rational, and radii in the commands; `test_columns` checks the others."""

from __future__ import annotations

import json
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from conftest import Lagtop
from lagtop import Top, solve
from record_reference import reference_state
from scenes import EVERY_KIND, UNIT

from lagrange_cli.solver.tables import ProvedTable

TENTH = Fraction(1, 10)
STANDS = {"m": Fraction(1, 9), "C": 1.5, "r0": Fraction(1, 3), "theta0_deg": 60}
STANDS |= {"psidot0": Fraction(2, 3)}
"""A steady precession whose spin rate is 0."""
ROUND = {"r0": 0, "theta0_deg": 31, "thetadot0": 9}
"""A pendulum that turns over."""
FREE = {"g": 0, "r0": 0, "theta0_deg": 90, "psidot0": 2.5}


TIED = {"m": 5, "theta0_deg": 30, "r0": 2.5, "psidot0": 0.25, "thetadot0": 0.75}
FREE_RISE = {"g": 0, "r0": 3, "theta0_deg": 31, "thetadot0": 2.5}
FROM_POLE = {"r0": 3 * TENTH, "thetadot0": 5}
SPINLESS = {"g": 0, "r0": 0, "theta0_deg": 0}


@pytest.mark.parametrize(
    ("inputs", "t", "columns", "expected"),
    [
        # at all times: discs, spheres, planes
        ({"C": 2, "r0": 3, "theta0_deg": 31}, "7/3", "q", "0.0"),
        ({"C": 2, "r0": 6 * TENTH, "theta0_deg": 31, "psidot0": Fraction(5, 3)}, 7, "p", "0.0"),
        ({"r0": 0.625, "theta0_deg": 90, "psidot0": -0.625}, "7/3", "quaternion_z", "0.0"),
        (
            {"r0": 0.625, "theta0_deg": 90, "psidot0": 0.625, "thetadot0": 5},
            *("-2/5", "quaternion_y", "0.0"),
        ),
        (
            {"m": 3.25, "r0": -2.25, "theta0_deg": 60, "thetadot0": -1.25, "psidot0": -1.5},
            *("7/3", "quaternion_y", "0.0"),
        ),
        (ROUND, "7/3", "q axis_x quaternion_y quaternion_z", "0.0 0.0 0.0 0.0"),
        (
            {"m": 0.5, "C": 0.25, "r0": -3, "theta0_deg": 120, "psidot0": 2},
            *("-2/5", "quaternion_z", "0.0"),
        ),
        (FREE_RISE, "7/3", "p q", "2.0 0.0"),
        (FREE, "7/3", "p q", "0.0 2.0"),
        (
            {"g": 0, "theta0_deg": 60, "r0": 2.5},
            *(7, "u thetadot psidot phidot p q moment energy Lz"),
            "0.5 0.0 0.0 2.0 0.0 0.0 0.0 3.0 1.0",
        ),
        # at some times
        (TIED, 0, "thetadot psidot p q r moment", "0.8 0.2 0.8 0.1 2.0 2.0"),
        ({"r0": 3, "theta0_deg": 31}, 0, "q", "0.0"),
        (FROM_POLE | {"theta0_deg": 0}, 0, "phidot psidot", "0.2 0.2"),
        (FROM_POLE | {"theta0_deg": 180}, 0, "psidot", "-0.2"),
        (SPINLESS | {"thetadot0": 25 * TENTH}, 1, "theta", "2.0"),
        (SPINLESS | {"thetadot0": 15 * TENTH}, -1, "thetadot", "-2.0"),
        ({"g": 0, "r0": 0, "theta0_rad": 0.5, "thetadot0": -1.25}, 0.6, "theta", "0.2"),
        (ROUND, 0.01, "dphi", "0.0"),
        ({"r0": 0.25, "theta0_deg": 30, "m": 0.1, "A": 0.5}, 0, "phidot", "0.2"),
        ({"m": 0.125, "r0": 0.5, "theta0_deg": 90, "psidot0": 0.25}, 0, "q", "0.2"),
        (STANDS, 7, "phi p", "0.0 0.0"),
    ],
)
def test_rational_columns(
    inputs: dict[str, Any], t: float | str, columns: str, expected: str
) -> None:
    """Ties among them, which are rounded to even: 0.15 and 2.5 in one digit."""
    table = ProvedTable(solve(Top(**UNIT | inputs)), columns.split(), 1, radians=True)
    assert [x.value for x in table.row(Fraction(str(t)))] == expected.split()


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
    assert list(row[0])[3:6] == ["psi_deg", "t_radius", "theta_deg_radius"]
    assert 0 < row[0]["phi_deg_radius"] <= row[0]["phi_deg"] * 2.0**-52


def test_the_separatrix_is_decided_at_once_at_any_time(lagtop: Lagtop) -> None:
    """The tilt falls as exp(-t), below the exponents of decimals; what stays finite is printed."""
    top = "--m 1 --A 1 --C 1 --s 1 --g 1 --r0 0 --theta0 60 --thetadot0 1".split()
    args = [*top, "--t-min", "1e20", "--t-max", "1e20", "--n", "1", "--digits", "20"]
    refused = lagtop("table", *args, "--format", "csv", "--columns", "theta")
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "the size of a value is not between 1e-990000000000000000 and" in refused.stderr
    shown = lagtop("table", *args, "--format", "csv", "--columns", "phi,psi,axis_z,quaternion_w")
    assert shown.stdout.splitlines()[1:] == ["180.0,180.0,1.0,-1.0"]


def test_what_time_alone_makes_small_is_not_zero() -> None:
    """On the separatrix the nutation rate falls as exp(-rate t), here by 2,800 digits."""
    motion = solve(Top(**EVERY_KIND["separatrix"]))
    assert motion.regime == "separatrix"
    (found,) = ProvedTable(motion, ["thetadot"], 10).row(Fraction(10_000))
    exact = reference_state(motion.top.as_dict(), 10_000).thetadot
    assert abs(mpmath.mpf(found.value) / exact - 1) < 1e-9
