"""Units: what they mean, that conversion is exact, that all inputs have them or none."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import pint
import pytest
from conftest import Lagtop
from lagtop import Top, read_scene

from lagrange_cli.top.given import gather
from lagrange_cli.top.units import UNITS, conversion, unit_of_text
from lagrange_cli.top.values import Value, parse_value

PAPER = "--m 1587g --A 39032g*cm^2 --C 17458g*cm^2 --s 4cm --g 981cm/s^2".split()
BODY = {"m": "350g", "A": "8.5e-4 kg m²", "C": "4000 g*cm^2", "s": "3cm", "g": "9.81 m/s^2"}
WORDS = [word for name, text in BODY.items() for word in (f"--{name}", text)]


def read(inputs: dict[str, str]) -> dict[str, Value]:
    """Return inputs as they are read from their texts."""
    return {name: parse_value(name, text) for name, text in inputs.items()}


@pytest.mark.parametrize(
    ("unit", "turns"),
    [("rpm", "1/60"), ("turn/s", "1"), ("rev/min", "1/60"), ("deg/s", "1/360"), ("°/s", "1/360")],
)
def test_turns_have_pi_in_all_digits(unit: str, turns: str) -> None:
    with mpmath.workdps(1150):
        factor, _ = conversion("r0", unit)
        size = mpmath.mpf(factor.numerator) / factor.denominator
        exact = 2 * mpmath.pi * mpmath.mpf(Fraction(turns).numerator) / Fraction(turns).denominator
        assert abs(size - exact) < mpmath.mpf(10) ** -1098


REGISTRY: Any = pint.UnitRegistry(non_int_type=Fraction)


@pytest.mark.parametrize("text", [*UNITS, "kg*m^2", "oz*in**2", "N*m*s^2", "turn/min", "1 / ms"])
def test_units_have_the_dimensions_and_sizes_of_pint(text: str) -> None:
    known = REGISTRY.parse_units(text.replace("rev", "turn")) * Fraction(1)
    exact, found = known.to_base_units(), unit_of_text(text)
    size = found.size * Fraction(math.pi) ** found.power_of_pi
    assert float(size) == pytest.approx(float(exact.magnitude), rel=1e-14)
    powers = {str(x): y for x, y in exact.unit_items()}
    named = [powers.get(x, 0) for x in ("kilogram", "meter", "second", "radian")]
    assert list(found.dimensions) == named


def test_a_tilt_stays_exact_in_degrees_or_in_radians() -> None:
    for text, inputs in (("0.25turn", {"theta0_deg": 90}), ("0.5 rad", {"theta0_rad": 0.5})):
        found = gather(read({"theta0": text}))
        assert (found.inputs, found.si) == (inputs, False)


def test_inputs_are_the_nearest_doubles_in_si() -> None:
    found = gather(read(BODY | {"r0": "12000 rpm", "psidot0": "30 deg/s", "theta0": "60deg"}))
    assert found.top() == Top(
        m=0.35, A=8.5e-4, C=4e-4, s=0.03, g=9.81, r0=1256.6370614359173, theta0_deg=60,
        psidot0=0.5235987755982989,
    )  # fmt: skip
    ounce = read({"m": "0.1 oz", "A": "1e9g m²", "C": "1e9 g m²", "s": "1m", "g": "1g_0"})
    assert gather(ounce).top(exact=True).m == Fraction(45359237, 16 * 10**9)


def test_the_worked_example_in_si(solved: Any) -> None:
    plain, si = solved("--r0", 50), solved(*PAPER, "--r0", "50rad/s")
    sizes = {"m": 1e3, "A": 1e7, "C": 1e7, "s": 1e2, "g": 1e2}
    for key, value in plain.items():
        if isinstance(value, float):
            assert si[key] * sizes.get(key, 1) == pytest.approx(value, rel=1e-13), key
    units = si["units"]
    named = [units[key] for key in ("A", "mean_spin_rate", "theta_max_deg")]
    assert named == ["kg m²", "rad/s", "deg"]


def test_units_are_named_in_tables_and_remarks(lagtop: Lagtop) -> None:
    shown = lagtop("solve", *WORDS, "--r0", "200turn/s").stdout
    assert "kg m²" in shown
    assert "rad/s" in shown
    assert "time" not in shown
    words = ["table", *WORDS, "--t-max", "1ms", "--n", "2"]
    table = lagtop(*words, "--format", "table", "--columns", "t,r,Lz")
    assert all(unit in table.stdout for unit in ("t [s]", "r [rad/s]", "Lz [kg m²/s]"))
    assert "0.0156 s;" in lagtop("solve", *PAPER, "--r0", "900rad/s", "--get", "remark").stdout
    assert "0.0156 time;" in lagtop("solve", "--r0", "900", "--get", "remark").stdout


def test_scenes_and_options_go_together(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "scene.toml"
    path.write_text("".join(f'{name} = "{text}"\n' for name, text in BODY.items()), "utf-8")
    with path.open("a") as file:
        file.write('r0 = "480rpm"\ntheta0 = "0.5 rad"\n')
    top = read_scene(str(path))
    assert (top.m, top.r0, top.theta0_rad) == (0.35, 50.26548245743669, 0.5)
    assert lagtop("solve", path, "--s", "1in", "--get", "s").stdout == "0.0254\n"
    assert lagtop("solve", path, "--psidot0", "0", "--theta0", "20", "--get", "m").exit_code == 0


def test_uncertainties_convert_with_the_unit(tmp_path: Path, lagtop: Lagtop, solved: Any) -> None:
    rest = ["--C", "4000g*cm^2", "--s", "3cm", "--g", "9.81m/s^2"]
    found = solved("--m", "350(2) g", "--A-cm", "5350 ± 1 % g*cm^2", *rest, "--theta0", "30(1)deg")
    assert (found["m"], found["m_std"], found["theta0_deg_std"]) == (0.35, 0.002, 1.0)
    slopes = 5.35e-6, 0.03**2 * 0.002  # of A by A_cm and by m
    assert found["A_std"] == pytest.approx(math.hypot(*slopes), rel=1e-12)
    path = tmp_path / "scene.toml"
    path.write_text('m = "350(2) g"\nA_cm = "5350+/-1% g*cm^2"\ntheta0 = "30(1) deg"\n')
    assert solved(path, *rest) == found
    path.write_text('r0 = "50(1)"\ntheta0 = "30(1)"\n')  # degrees, as by the option
    found = solved(path)
    assert (found["r0_std"], found["theta0_deg_std"]) == (1, 1)
