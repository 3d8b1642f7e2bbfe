"""Bodies as they are measured: A about the mass centre, and the rate of phi in place of r0."""

from __future__ import annotations

import json
import random
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import Lagtop, assert_one_line
from lagtop import LagtopError, Top, solve, sweep

TILTS = (0.0, 1e-9, 30.0, 60.0, 90.0, 90.00000001, 120.0, 179.9)


def mp_spin(inputs: dict[str, Any]) -> Any:
    """Return phi' + psi' cos(theta0) in 60 digits."""
    with mpmath.workdps(60):
        if "theta0_rad" in inputs:
            tilt = mpmath.mpf(inputs["theta0_rad"])
        else:
            tilt = mpmath.mpf(inputs["theta0_deg"]) * mpmath.pi / 180
        total = mpmath.mpf(inputs["phidot0"]) + mpmath.mpf(inputs["psidot0"]) * mpmath.cos(tilt)
        return total if abs(total) > 1e-50 else mpmath.mpf(0)


def random_body(rng: random.Random) -> dict[str, float]:
    """Return a body with a moment about its mass centre."""
    return {
        "m": rng.uniform(0.1, 10),
        "A_cm": 10 ** rng.uniform(-4, 2),
        "C": 1e-5,
        "s": rng.choice([0.0, rng.uniform(0, 3)]),
        "g": 9.81,
    }


def test_parallel_axes_are_exact_and_rounded_once() -> None:
    rng = random.Random(1)
    bodies = [random_body(rng) for _ in range(200)]
    tops = [Top(**body) for body in bodies]
    for body, top in zip(bodies, tops, strict=True):
        exact = Fraction(body["A_cm"]) + Fraction(body["m"]) * Fraction(body["s"]) ** 2
        assert top.A == float(exact)
    arrays: dict[str, Any] = {name: np.array([body[name] for body in bodies]) for name in bodies[0]}
    assert sweep(keys=["A"], **arrays)["A"].tolist() == [top.A for top in tops]


def start(rng: random.Random) -> dict[str, float]:
    """Return a start with a rate of phi, now and then one that cancels the precession."""
    inputs: dict[str, float] = {"psidot0": rng.choice([0.0, rng.uniform(-9, 9)])}
    if rng.random() < 0.5:
        inputs["theta0_deg"] = rng.choice([*TILTS[1:], rng.uniform(0, 180)])
    else:
        inputs["theta0_rad"] = rng.uniform(0, 3)
    inputs["phidot0"] = rng.uniform(-30, 30)
    if rng.random() < 0.3:
        inputs["phidot0"] -= float(mp_spin(inputs))
    return inputs


def test_the_rate_of_phi_gives_the_nearest_total_rate() -> None:
    rng = random.Random(2)
    starts = [start(rng) for _ in range(200)]
    tops = [Top(**inputs) for inputs in starts]
    assert [top.r0 for top in tops] == [float(mp_spin(inputs)) for inputs in starts]
    for unit in ("theta0_deg", "theta0_rad"):
        some = [inputs for inputs in starts if unit in inputs]
        arrays: dict[str, Any] = {name: np.array([x[name] for x in some]) for name in some[0]}
        assert sweep(keys=["r0"], **arrays)["r0"].tolist() == [Top(**x).r0 for x in some]
    motion = solve(tops[0])
    assert motion.spin_rate_start == pytest.approx(starts[0]["phidot0"], rel=1e-15)


def test_what_is_rational_is_exact() -> None:
    assert Top(phidot0=-1, psidot0=2, theta0_deg=60).r0 == 0
    assert solve(Top(phidot0=-1, psidot0=2, theta0_deg=60)).regime == "no spin"
    thirds = Top(phidot0=Fraction(1, 3), psidot0=Fraction(1, 7), theta0_deg=120)
    assert thirds.r0 == Fraction(11, 42)
    assert Top(phidot0=0.1).r0 == 0.1
    found = sweep(keys=["r0"], phidot0=[-1.0, 1.0], psidot0=2.0, theta0_deg=[60, 120])
    assert found["r0"].tolist() == [0.0, 0.0]


def test_digits_are_those_of_the_decimals(lagtop: Lagtop) -> None:
    body = ["--m", "0.35", "--A-cm", "5.35e-4", "--C", "4e-4", "--s", "0.03", "--g", "9.81"]
    ask = ["solve", *body, "--digits", "30", "--get"]
    assert lagtop(*ask, "A").stdout == "0.00085\n"
    rates = ["--phidot0", "0.1", "--psidot0", "0.3", "--theta0", "40"]
    with mpmath.workdps(80):
        exact = mpmath.mpf("0.1") + mpmath.mpf("0.3") * mpmath.cos(2 * mpmath.pi / 9)
        shown = mpmath.nstr(exact, 60, strip_zeros=False)
    assert lagtop("solve", *rates, "--digits", "60", "--get", "r0").stdout == f"{shown}\n"
    given = lagtop("solve", *rates, "--digits", "60", "--get", "spin_rate_start").stdout
    assert given == "0.1\n"


def test_one_of_each_pair(tmp_path: Path, lagtop: Lagtop) -> None:
    whole = ["--m", "1", "--C", "1", "--s", "1", "--g", "1"]
    both = lagtop("solve", "--A", "1", "--A-cm", "2", *whole)
    assert_one_line(both, 2, "--A-cm and A are both given")
    with pytest.raises(LagtopError, match="A_cm and A are both given"):
        sweep(A=1, A_cm=1, m=1, C=1, s=1, g=1)
    path = tmp_path / "scene.toml"
    path.write_text("phidot0 = 1\nr0 = 2\n")
    assert_one_line(lagtop("solve", path), 65, f"{path}, line 1: phidot0 and r0 are both given")
    rows = lagtop("sweep", "-", "--keys", "r0", input="r0,phidot0\n1,2\n")
    assert rows.exit_code == 1
    assert "phidot0 and r0 are both given" in rows.stdout


def test_options_take_the_place_of_the_other_in_a_scene(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "scene.toml"
    path.write_text("m = 2\nA_cm = 3\nC = 1\ns = 4\ng = 9.81\nphidot0 = 5\n")
    asked = ["solve", path, "--format", "json"]
    inputs = json.loads(lagtop(*asked).stdout)
    assert (inputs["A"], inputs["r0"]) == (35.0, 5.0)
    assert json.loads(lagtop(*asked, "--s", "1").stdout)["A"] == 5
    assert json.loads(lagtop(*asked, "--A", "9", "--r0", "-1").stdout)["A"] == 9
