"""`find`: inputs that give target values, checked by a reference in mpmath and dense sweeps."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Lagtop
from lagtop import MixedBodyWarning, Top, find, solve, sweep
from record_reference import reference_record


@pytest.mark.parametrize(
    ("targets", "unknowns", "count"),
    [
        ({"T_precession": 2.0}, {"r0": "10:200"}, 1),
        ({"T_nutation": 0.45}, {"r0": "10:200"}, 2),
        ({"theta_max_deg": 90.0}, {"r0": "log:10:200"}, 1),
        pytest.param(
            {"T_precession": 0.8, "T_nutation": 0.43},
            {"r0": "10:200", "theta0_deg": "5:150"},
            2,
            marks=pytest.mark.slow,
        ),
        (
            {"mean_precession_rate": 7, "T_nutation": 0.5, "theta_max_deg": 70},
            {"m": 1587, "s": 4, "C": 17458, "g": 981, "r0": "30:70", "A": "3e4:6e4"}
            | {"theta0_deg": "10:50"},
            1,
        ),
    ],
)
def test_solutions_have_the_target_values(
    targets: dict[str, float], unknowns: dict[str, Any], count: int
) -> None:
    found = find(targets, **unknowns)
    assert len(found) == count
    for motion in found:
        exact = reference_record(motion.top.as_dict())
        assert {key: float(exact[key]) for key in targets} == pytest.approx(targets, rel=1e-13)
        assert [getattr(motion, key) for key in targets] == pytest.approx(
            [*targets.values()], rel=1e-13
        )


@pytest.mark.parametrize("seed", range(6))
def test_all_roots_of_a_dense_sweep_are_found_and_no_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    key = ["T_nutation", "mean_precession_rate", "theta_max_deg"][seed % 3]
    known: Any = {"theta0_deg": rng.uniform(10, 160), "psidot0": rng.normal()}
    r0 = np.linspace(-80, 80, 20_001)
    numbers = np.asarray(sweep(keys=[key], r0=r0, **known)[key], float)
    target = float(numbers[rng.integers(r0.size)])
    off = numbers - target
    passed = np.flatnonzero(off[:-1] * off[1:] <= 0)
    leaps = np.abs(np.diff(numbers)) > 50 * np.median(np.abs(np.diff(numbers)))
    roots = sorted({*np.round(r0[passed[~leaps[passed]]], 1).tolist()})
    found = sorted({round(float(x.top.r0), 1) for x in find({key: target}, r0=(-80, 80), **known)})
    assert len(found) >= 1
    assert found == pytest.approx(roots, abs=0.11)


def test_a_pair_of_roots_between_two_points_is_found() -> None:
    """The greatest period is 0.452509: a millionth more is nowhere, a millionth less twice."""
    most = max(solve(Top(r0=r0)).T_nutation or 0 for r0 in np.linspace(37.1, 37.4, 61))
    assert find({"T_nutation": most * (1 + 1e-6)}, r0=(10, 200)) == []
    assert len(find({"T_nutation": most * (1 - 1e-6)}, r0=(10, 200))) == 2
    assert len(find({"T_nutation": 0.4525}, r0=(10, 200), scan=7)) == 2


STEADY_BODY: dict[str, Any] = {"m": 1, "g": 9.81, "s": 0.2, "A": 2 / 3, "C": 1}


@pytest.mark.parametrize(
    ("word", "goal", "known", "count"),
    [
        ("steady", 0.5, {"r0": 1}, 1),
        ("steady-fast", 0.5, {"r0": 1}, 0),
        ("steady-fast", -2, {"r0": 1}, 1),
        ("steady", 2.5, {"phidot0": 3}, 1),
    ],
)
def test_steady_tops(word: str, goal: float, known: dict[str, Any], count: int) -> None:
    """The rate x solves A cos(theta) x^2 - C r0 x + m g s = 0, and Lz = A x sin^2 + C r0 cos."""
    ranges: Any = {"theta0_deg": (91 if "r0" in known else 20, 179), "scan": 100}
    found = find({"Lz": goal}, **STEADY_BODY, psidot0=word, **ranges, **known)
    assert len(found) == count
    for motion in found:
        x, u = motion.mean_precession_rate, math.cos(math.radians(motion.top.theta0_deg or 0))
        r0 = known["r0"] if "r0" in known else known["phidot0"] + x * u
        assert 2 / 3 * u * x * x - r0 * x + 9.81 * 0.2 == pytest.approx(0, abs=1e-12)
        assert 2 / 3 * x * (1 - u * u) + r0 * u == pytest.approx(goal)
        assert motion.regime == "steady precession"


@pytest.mark.parametrize("word", ["cusped", "looping", "wavy"])
def test_borders_of_a_path(word: str) -> None:
    """The path has cusps if the precession rate is 0 at the upper turning point, u = beta/b."""
    known: Any = {"thetadot0": 1.0, "r0": 50}
    found = find([f"path={word}"], psidot0=(-3, 1), **known)
    assert len(found) == 1
    at = float(found[0].top.psidot0)
    sides = [solve(Top(psidot0=x, **known)).path for x in (at - 1e-9, at + 1e-9)]
    assert sides == ["looping", "wavy"]
    b = float(found[0].b)
    u0 = math.cos(math.radians(30))
    beta = at * (1 - u0**2) + b * u0
    energy = 1 + at * at * (1 - u0**2) + float(found[0].a) * u0
    assert energy - float(found[0].a) * beta / b == pytest.approx(0, abs=1e-11 * energy)
    assert word == "cusped" or found[0].path == word


def test_a_leap_is_no_root() -> None:
    """The mean spin leaps by a turn per period where the axis starts to pass round a pole."""
    found = find({"mean_spin_rate": 46}, psidot0=(-40, 40), scan=400)
    assert [x.mean_spin_rate for x in found] == pytest.approx([46], rel=1e-13)
    (behind,) = find({"mean_precession_rate": -11.5}, r0=(-60, 60), theta0_deg=120, scan=400)
    exact = reference_record(behind.top.as_dict())["mean_precession_rate"]
    assert float(exact) == pytest.approx(-11.5)


def test_a_warning_names_the_defaults_of_the_body() -> None:
    with pytest.warns(MixedBodyWarning, match="A, C, s and g default to the worked") as said:
        find(["T_nutation=0.45"], m=1600, r0="10:60", scan=20)
    assert [x.filename for x in said] == [__file__]


def test_the_command_writes_records(lagtop: Lagtop, tmp_path: Path) -> None:
    options = ("find", "--r0", "10:60", "T_nutation=0.45", "--scan", 300)
    result = lagtop(*options)
    rows = list(csv.DictReader(io.StringIO(result.stdout)))
    assert list(rows[0]) == [*solve(Top()).record()]
    assert [float(row["T_nutation"]) for row in rows] == pytest.approx([0.45, 0.45], rel=1e-15)
    assert "2 found; scanned r0 from 10 to 60 at 300 values" in result.stderr
    scene = tmp_path / "lab.toml"
    scene.write_text("theta0_deg = 30\nr0 = 7\n")
    same = lagtop("find", scene, *options[1:])
    assert same.stdout == result.stdout


def test_a_double_root_of_two_unknowns_is_printed(lagtop: Lagtop) -> None:
    conditions = "mean_precession_rate=6.08576336536358", "T_nutation=0.2598223966598593"
    how = "--r0=10:120", "--psidot0=-6:6", "--theta0", "57.65125255876922", "--keys", "r0,psidot0"
    result = lagtop("find", *how, "--scan", "20", *conditions)
    (r0, psidot0), *others = [map(float, x.split(",")) for x in result.stdout.splitlines()[1:]]
    assert (r0, psidot0) == pytest.approx((59.9463, 0), abs=1e-4)
    assert not others
    assert "two solutions coincide at r0 = 59.9463" in result.stderr
