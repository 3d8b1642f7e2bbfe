"""Inputs that others are derived from: A_cm and phidot0 as measured, and steady precession."""

from __future__ import annotations

import json
import pickle
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import Lagtop
from lagtop import Regime, Top, solve, sweep
from scenes import UNIT

from lagrange_cli.solver.tables import ProvedTable
from lagrange_cli.top.units import Units


def test_parallel_axes_are_exact_and_rounded_once() -> None:
    rng = np.random.default_rng(1)
    columns: dict[str, Any] = {"m": rng.uniform(0.1, 10, 200), "s": rng.uniform(0, 3, 200)}
    columns |= {"A_cm": 10 ** rng.uniform(-4, 2, 200), "C": np.full(200, 1e-5), "g": np.ones(200)}
    columns["s"][:50] = 0
    bodies = [dict(zip(columns, x, strict=True)) for x in zip(*columns.values(), strict=True)]
    exact = [Fraction(x["A_cm"]) + Fraction(x["m"]) * Fraction(x["s"]) ** 2 for x in bodies]
    assert [Top(**body).A for body in bodies] == list(map(float, exact))
    assert sweep(keys=["A"], **columns)["A"].tolist() == list(map(float, exact))


@pytest.mark.parametrize("unit", ["theta0_deg", "theta0_rad"])
def test_the_rate_of_phi_gives_the_nearest_total_rate(unit: str) -> None:
    """Rates of phi that cancel the precession are among them."""
    rng = np.random.default_rng(2)
    tilts = np.r_[1e-9, 30, 60, 90, 90.00000001, 120, 179.9, rng.uniform(0, 180, 93)]
    columns = {unit: tilts if unit == "theta0_deg" else tilts / 60, "psidot0": np.zeros(100)}
    columns["psidot0"][::3] = rng.uniform(-9, 9, 34)
    columns["phidot0"] = rng.uniform(-30, 30, 100)
    cancel = columns["psidot0"] * np.cos(np.radians(tilts) if unit == "theta0_deg" else tilts / 60)
    columns["phidot0"][::2] = -cancel[::2]
    starts = [dict(zip(columns, x, strict=True)) for x in zip(*columns.values(), strict=True)]
    exact = []
    with mpmath.workdps(60):
        for tilt, precession, spin in zip(*(x.tolist() for x in columns.values()), strict=True):
            cos = mpmath.cos(tilt * mpmath.pi / 180 if unit == "theta0_deg" else tilt)
            total = spin + mpmath.mpf(precession) * cos
            exact.append(float(total) if abs(total) > 1e-50 else 0.0)
    assert [Top(**inputs).r0 for inputs in starts] == exact
    assert sweep(keys=["r0"], **columns)["r0"].tolist() == exact
    start = solve(Top(**starts[1])).spin_rate_start
    assert start == pytest.approx(starts[1]["phidot0"], rel=1e-15)


def test_options_take_the_place_of_the_other_in_a_scene(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "scene.toml"
    path.write_text("m = 2\nA_cm = 3\nC = 1\ns = 4\ng = 9.81\nphidot0 = 5\n")
    asked = ["solve", path, "--format", "json"]
    inputs = json.loads(lagtop(*asked).stdout)
    assert (inputs["A"], inputs["r0"]) == (35.0, 5.0)
    assert json.loads(lagtop(*asked, "--s", "1").stdout)["A"] == 5
    assert json.loads(lagtop(*asked, "--A", "9", "--r0", "-1").stdout)["A"] == 9
    rows = lagtop("sweep", "-", "--keys", "r0", input="r0,phidot0\n1,2\n")
    assert (rows.exit_code, "phidot0 and r0 are both given" in rows.stdout) == (1, True)


# Words for a rate of steady precession; solver/test_digits checks the numbers


@pytest.mark.parametrize("word", ["steady", "steady-fast"])
@pytest.mark.parametrize(
    "inputs", [{"r0": -60.0, "theta0_rad": 0.5}, UNIT | {"r0": 5, "theta0_deg": 40, "g": 0}]
)
def test_the_tilt_of_a_steady_precession_stays_exactly(inputs: Any, word: str) -> None:
    motion = solve(Top(**inputs, psidot0=word))
    assert motion.regime is (Regime.TORQUE_FREE if inputs.get("g") == 0 else Regime.STEADY)
    assert motion.record(digits=30)["psidot0"] == word
    table = ProvedTable(motion, ["theta", "u", "energy", "Lz"], 50, units=Units(radians=True))
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
