"""The table of forms of inputs: each row means the same wherever an input is read."""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import sys
from dataclasses import fields
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Lagtop
from lagtop import Top, find, fit, sensitivities, solve, sweep

from lagrange_cli.bench.reference import Reference
from lagrange_cli.top.forms import Quantities
from lagrange_cli.top.inputs import DECLARED, FORMS, INPUTS, replaced_by

BODY = {"m": 0.5, "A": 4.45e-3, "C": 2.5e-3, "s": 0.08, "g": 9.81}
TOP = Top(**BODY, r0=52.0, theta0_deg=30, psidot0=2.0)
MEASURED = [key for key in FORMS if key in DECLARED]


def in_form(top: Top, key: str) -> dict[str, Any]:
    """Return the inputs of a top, one of them in another form, in doubles."""
    numbers = {name: float(x) for name, x in top.inputs(radians=True).items()}
    constants: Any = {"pi": lambda: math.pi, "sqrt": lambda: math.sqrt}
    known = Quantities(numbers, u0=lambda: math.cos(numbers["theta0_rad"]), **constants)
    return {x: y for x, y in top.given.items() if x != replaced_by(key)} | {key: known[key]}


def test_every_form_is_an_input_of_a_top_and_an_option(lagtop: Lagtop) -> None:
    assert {x.name for x in fields(Top)} == {*INPUTS, "_given"}
    shown = lagtop("solve", "--help").stdout
    assert all(f"--{name.replace('_', '-')} " in shown for name in DECLARED)


@pytest.mark.parametrize("key", MEASURED)
def test_a_form_gives_the_same_motion_everywhere(key: str, tmp_path: Path, lagtop: Lagtop) -> None:
    inputs, keys = in_form(TOP, key), ["A", "r0", "T_nutation", "k"]
    top = Top(**inputs)
    exact = solve(top).record(keys=keys)
    assert exact == pytest.approx(solve(TOP).record(keys=keys), rel=1e-12)
    assert Reference(top).k2 == pytest.approx(exact["k"] ** 2, rel=1e-14)
    assert sensitivities(top, ["k"]).inputs.count(key) == 1
    swept = sweep(keys=keys, **inputs | {key: [inputs[key], 1.01 * inputs[key]]})
    assert [swept[x][0] for x in keys] == pytest.approx([exact[x] for x in keys], rel=1e-11)
    scene, tops = tmp_path / "scene.toml", tmp_path / "tops.csv"
    scene.write_text("".join(f"{x} = {y}\n" for x, y in inputs.items()))
    assert json.loads(lagtop("solve", scene, "--format", "json").stdout)["k"] == exact["k"]
    tops.write_text(f"{','.join(inputs)}\n{','.join(map(str, inputs.values()))}\n")
    assert float(lagtop("sweep", tops, "--keys", "k").stdout.split()[1].strip(",")) == swept["k"][0]
    rows = "\n".join(json.dumps(dict(x)) for x in (inputs, TOP.given))  # both forms
    mixed = lagtop("sweep", "-", "--keys", "k", input=rows).stdout.split()[1:]
    assert [float(x.strip(",")) for x in mixed] == pytest.approx([exact["k"]] * 2, rel=1e-11)
    ends = 0.9 * inputs[key], 1.05 * inputs[key]
    (found,) = find({"k": exact["k"]}, scan=9, **inputs | {key: ends})
    assert getattr(found.top, key) == pytest.approx(inputs[key], rel=1e-9)


@pytest.mark.parametrize("key", MEASURED)
def test_a_form_can_be_asked_for(key: str, lagtop: Lagtop) -> None:
    inputs, name = in_form(TOP, key), replaced_by(key)
    assert solve(Top(**inputs)).record(keys=[key])[key] == inputs[key]
    assert sweep(keys=[key], **inputs)[key] == inputs[key]
    words = [f"--{x.replace('_', '-').removesuffix('-deg')}={y}" for x, y in TOP.given.items()]
    asked = lagtop("solve", *words, "--get", key, "--digits", "900").stdout.strip()
    rest = [x for x in words if not x.startswith(f"--{name}=")]
    flag = f"--{key.replace('_', '-')}={asked}"
    again = lagtop("solve", *rest, flag, "--get", name, "--digits", "890").stdout
    assert Fraction(again) == Fraction(str(TOP.given[name]))


def test_sweeps_ask_for_every_form_as_solve_does() -> None:
    random = np.random.default_rng(3)
    tops: dict[str, Any] = {name: x * random.uniform(0.5, 2, 40) for name, x in BODY.items()}
    tops |= {"C": tops["C"] * random.choice([1, 40], 40)}  # some with C > 2A
    tops |= {"theta0_deg": random.uniform(0, 180, 40), "psidot0": random.normal(size=40) * 5}
    found = sweep(keys=[*MEASURED, "k"], radii=True, phidot0=random.normal(size=40) * 50, **tops)
    assert (tops["C"] > 2 * tops["A"]).any()
    for i in range(40):
        one = solve(Top(phidot0=found["phidot0"][i], **{x: y[i] for x, y in tops.items()}))
        for key, exact in one.record(keys=[*MEASURED, "k"]).items():
            assert abs(found[key][i] - exact) <= found[f"{key}_radius"][i] + np.spacing(abs(exact))


@pytest.mark.parametrize("key", MEASURED)
def test_a_form_is_a_known_input_of_a_fit(key: str) -> None:
    inputs, t = in_form(TOP, key), np.linspace(0, 1, 60)
    noise = np.random.default_rng(1).normal(scale=1e-3, size=(3, 60))
    theta, phi, psi = solve(TOP).angles(t) + noise
    names = {"A": ("m", "g", "s", key), "C": ("m", "A", key)}.get(replaced_by(key), (key,))
    known = {x: inputs[x] for x in names}
    right = fit(t, theta=theta, phi=phi, psi=psi, known=known)
    assert right.verdict == "good"
    wrong = fit(t, theta=theta, phi=phi, psi=psi, known=known | {key: f"{1.3 * inputs[key]}(1)"})
    assert any(f"known {key} = " in x and "contradicts" in x for x in wrong.failures())


@pytest.mark.parametrize("key", [x for x in MEASURED if replaced_by(x) == "r0"])
def test_a_form_is_a_known_input_of_a_steady_fit(key: str) -> None:
    top, t = TOP.replace(psidot0="steady"), np.linspace(0, 2, 150)
    theta, _, psi = solve(top).angles(t)
    value = solve(top).record(keys=[key])[key]
    found = fit(t, theta=theta, psi=psi, known={"m": 0.5, "g": 9.81, "s": 0.08, key: value})
    assert found.verdict == "good, no nutation"
    assert found.numbers["r0"].value == pytest.approx(52.0, abs=3 * found.numbers["r0"].std)


ROW = """spin_frequency | f_φ0 | spin frequency at the start
    | turns of the spin per unit of time at the start | instead of phidot0 | 1/time |
    | phidot0 | 2*pi*spin_frequency | phidot0/(2*pi)
gyradius | k_A | equatorial radius of gyration
    | radius of gyration about the pivot | positive | len | | A | m*gyradius*gyradius | sqrt(A/m)
k_C | k_C | polar radius of gyration
    | radius of gyration about the axis | positive | len | | C | m*k_C*k_C | sqrt(C/m)
turn_period | T_ψ0 | precession period at the start
    | time of one turn at the start | not 0 | time | | psidot0 | 2*pi/turn_period | 2*pi/psidot0
"""
FIELD = "".join(
    f"    {key}: Real | None = None\n"
    for key in ("spin_frequency", "gyradius", "k_C", "turn_period")
)


@pytest.mark.slow
def test_a_further_form_is_one_row_and_one_field(tmp_path: Path) -> None:
    """The tests of all forms pass in a copy of the package with four more."""
    package = shutil.copytree(ROOT / "lagrange_cli", tmp_path / "lagrange_cli")
    (tmp_path / "sample_inputs").mkdir()
    for name, place, more in (("inputs", "theta0 |", ROW), ("top", "    _given: dict", FIELD)):
        text = (file := package / "top" / f"{name}.py").read_text(encoding="utf-8")
        file.write_text(text.replace(place, more + place, 1), encoding="utf-8")
    chosen = "spin_frequency or gyradius or every_form or (of_a_fit and (k_C or turn_period))"
    line = ["pytest", "-q", "-p", "no:cacheprovider", f"--rootdir={ROOT / 'tests'}", __file__]
    ran = subprocess.run(
        [
            sys.executable,
            "-m",
            *line,
            "-k",
            chosen,
        ],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT / "tests")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "11 passed" in ran.stdout, ran.stdout


def test_a_period_with_units_and_an_uncertainty(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "scene.toml"
    body = 'm = "0.5 kg"\nA = "4.45e-3 kg m^2"\nC = "2.5e-3 kg m^2"\ns = "8 cm"\ng = "1 g_0"\n'
    path.write_text(body + 'spin_period = "125.6(4) ms"\n')
    record = json.loads(lagtop("solve", path, "--format", "json").stdout)
    assert record["r0"] == pytest.approx(2 * math.pi / 0.1256, rel=1e-15)
    assert record["r0_std"] == pytest.approx(record["r0"] * 0.4 / 125.6, rel=1e-4)  # not linear
