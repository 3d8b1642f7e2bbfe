"""Units: what they mean, that conversion is exact, that all inputs have them or none."""

from __future__ import annotations

import json
import math
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import pytest
from conftest import Lagtop, assert_one_line
from lagtop import LagtopError, Top, read_scene

from lagrange_cli.inputs.given import gather
from lagrange_cli.inputs.units import CGS, SYSTEMS, UNITS, factor_of, unit_by_pint, unit_of_text
from lagrange_cli.inputs.value import Value, parse_value

PAPER = "--m 1587g --A 39032g*cm^2 --C 17458g*cm^2 --s 4cm --g 981cm/s^2".split()
BODY = {"m": "350g", "A": "8.5e-4 kg m²", "C": "4000 g*cm^2", "s": "3cm", "g": "9.81 m/s^2"}
WORDS = [word for name, text in BODY.items() for word in (f"--{name}", text)]


def read(inputs: dict[str, str]) -> dict[str, Value]:
    """Return inputs as they are read from their texts."""
    return {name: parse_value(text) for name, text in inputs.items()}


@pytest.mark.parametrize(
    ("key", "text", "size"),
    [
        ("m", "1 lb", Fraction(45359237, 100000)),
        ("m", "1 slug", Fraction(45359237, 10**5) * Fraction(980665, 10**5) / Fraction("0.3048")),
        ("s", "1 in", Fraction(254, 10000)),
        ("A", "1 lb*in^2", Fraction(45359237, 100000) * Fraction(254, 10000) ** 2),
        ("A", "1 N·m·s²", Fraction(1000)),
        ("A_cm", "1 kg m^2", Fraction(1000)),
        ("g", "1 g_0", Fraction(980665, 100000)),
        ("g", "1 m/s/s", Fraction(1)),
        ("g", "1 ft s⁻²", Fraction(3048, 10000)),
        ("r0", "1 rad/s", Fraction(1)),
        ("r0", "1/s", Fraction(1)),
        ("r0", "1 1/min", Fraction(1, 60)),
        ("t_max", "1 ms", Fraction(1, 1000)),
    ],
)
def test_definitions_are_exact(key: str, text: str, size: Fraction) -> None:
    assert factor_of(key, parse_value(text)) == size


@pytest.mark.parametrize(
    ("unit", "turns"),
    [("rpm", "1/60"), ("turn/s", "1"), ("rev/min", "1/60"), ("deg/s", "1/360"), ("°/s", "1/360")],
)
def test_turns_have_pi_in_all_digits(unit: str, turns: str) -> None:
    found = unit_of_text(unit)
    assert (found.rational, found.power_of_pi) == (2 * Fraction(turns), 1)
    with mpmath.workdps(1150):
        factor = factor_of("r0", Value(Fraction(1), unit))
        size = mpmath.mpf(factor.numerator) / factor.denominator
        exact = 2 * mpmath.pi * mpmath.mpf(Fraction(turns).numerator) / Fraction(turns).denominator
        assert abs(size - exact) < mpmath.mpf(10) ** -1098


PRODUCTS = """
kg*m^2, kg·m**2, g*cm^2, lb*in^2, oz*in**2, N*m*s^2, N·m·s^2, m/s^2, m/s/s, ft*s^-2, cm/s**2,
in/min/s, rad/s, deg/s, °/s, turn/min, rev/h, mrad/ms, arcmin/s, 1/s, 1/min, rad/rad*s^-1,
deg*rad/turn, 1/ms^1, rpm*min/s, mg/kg, g*s/h, kg*km/lb, rpm*deg^-1*turn, kg m^2, kg m ^ 2,
N m s ** 2, ft s^-2, 1 / s, m / s s, rad / min, s/s/s, s*s^-2, rpm*s/min
"""


@pytest.mark.parametrize("text", [*UNITS, *map(str.strip, PRODUCTS.split(","))])
def test_common_units_are_those_of_pint(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    exact = unit_by_pint(text)
    monkeypatch.setitem(sys.modules, "pint", None)
    monkeypatch.setattr("lagrange_cli.inputs.units.unit_by_pint", None)
    assert unit_of_text(text) == exact


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("30deg", "theta0_deg", Fraction(30)),
        ("0.5 rad", "theta0_rad", Fraction(1, 2)),
        ("250mrad", "theta0_rad", Fraction(1, 4)),
        ("90 arcmin", "theta0_deg", Fraction(3, 2)),
        ("0.25turn", "theta0_deg", Fraction(90)),
        ("50 gon", "theta0_deg", Fraction(45)),
    ],
)
def test_a_tilt_stays_exact_in_degrees_or_in_radians(text: str, key: str, value: Fraction) -> None:
    found = gather(read({"theta0": text}))
    assert (found.inputs, found.system) == ({key: value}, None)


def test_inputs_are_the_nearest_doubles_in_either_system() -> None:
    inputs = read(BODY | {"r0": "12000 rpm", "psidot0": "30 deg/s", "theta0": "60deg"})
    si, cgs = gather(inputs), gather(inputs, system="cgs")
    assert si.system == SYSTEMS["si"]
    assert cgs.system == CGS
    assert si.top() == Top(
        m=0.35, A=8.5e-4, C=4e-4, s=0.03, g=9.81, r0=1256.6370614359173, theta0_deg=60,
        psidot0=0.5235987755982989,
    )  # fmt: skip
    assert cgs.top() == si.top().replace(m=350, A=8500, C=4000, s=3, g=981)
    assert gather(
        read({"m": "0.1 oz", "A": "1e9g m²", "C": "1e9 g m²", "s": "1m", "g": "1g_0"})
    ).top(exact=True).m == Fraction(45359237, 16 * 10**9)


def test_the_worked_example_in_si(solved: Any, lagtop: Lagtop) -> None:
    plain, si = solved("--r0", 50), solved(*PAPER, "--r0", "50rad/s")
    sizes = {"m": 1e3, "A": 1e7, "C": 1e7, "s": 1e2, "g": 1e2}
    for key, value in plain.items():
        if isinstance(value, float):
            assert si[key] * sizes.get(key, 1) == pytest.approx(value, rel=1e-13), key
    assert lagtop("solve", *PAPER, "--format", "csv").stdout.startswith("m,A,C,s,g,r0,")


def test_units_are_named_in_tables_and_remarks(lagtop: Lagtop) -> None:
    shown = lagtop("solve", *WORDS, "--r0", "200turn/s").stdout
    assert "kg m²" in shown
    assert "rad/s" in shown
    assert "time" not in shown
    plain = lagtop("solve").stdout
    assert "mass len²" in plain
    words = ["table", *WORDS, "--t-max", "1ms", "--n", "2"]
    table = lagtop(*words, "--format", "table", "--columns", "t,r,Lz")
    assert all(unit in table.stdout for unit in ("t [s]", "r [rad/s]", "Lz [kg m²/s]"))
    rows = lagtop(*words).stdout.splitlines()
    assert rows[0] == "t,theta_deg,phi_deg,psi_deg"
    assert rows[2].startswith("0.001,")


def test_digits_go_on_as_far_as_one_likes(lagtop: Lagtop) -> None:
    ask = ["solve", *WORDS, "--r0", "12000 rpm", "--digits", "200", "--get"]
    with mpmath.workdps(210):
        assert lagtop(*ask, "r0").stdout == mpmath.nstr(400 * mpmath.pi, 200) + "\n"
    assert lagtop(*ask, "A").stdout == "0.00085\n"


def test_scenes_and_options_go_together(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "scene.toml"
    path.write_text("".join(f'{name} = "{text}"\n' for name, text in BODY.items()))
    with path.open("a") as file:
        file.write('r0 = "480rpm"\ntheta0 = "0.5 rad"\n')
    top = read_scene(str(path))
    assert (top.m, top.r0, top.theta0_rad) == (0.35, 50.26548245743669, 0.5)
    assert lagtop("solve", path, "--s", "1in", "--get", "s").stdout == "0.0254\n"
    assert lagtop("solve", path, "--psidot0", "0", "--theta0", "20", "--get", "m").exit_code == 0
    bare = lagtop("solve", path, "--r0", "50")
    assert_one_line(bare, 2, "--r0 must have a unit such as '50 rad/s' or 480rpm, as m has")
    other = lagtop("solve", "sample_inputs/fast-gyroscope.toml", "--r0", "50rpm")
    assert_one_line(other, 65, "sample_inputs/fast-gyroscope.toml, line 2: m must have a unit")
    path.write_text('theta0_deg = "0.5 rad"\n')
    assert_one_line(lagtop("solve", path), 65, f"{path}, line 1: theta0_deg must be called theta0")
    path.write_text('m = "350 s"\n')
    assert_one_line(lagtop("solve", path), 65, f"{path}, line 1: m must have a unit as in 350g")


@pytest.mark.slow
def test_a_fit_names_units(lagtop: Lagtop) -> None:
    known = ["sample_inputs/recording.csv", "--m", "1.587kg", "--g", "9.81m/s^2"]
    shown = lagtop("fit", *known).stdout
    words = ("from t = 3.25 s", "m = 1.587 kg", "a [1/s²]", "s/A [1/(kg m)]", "theta0_deg  ")
    assert all(word in shown for word in words)
    units = json.loads(lagtop("fit", *known, "--format", "json").stdout)["units"]
    assert (units["g"], units["s/A"], units["psi_zero_deg"]) == ("m/s²", "1/(kg m)", "deg")
    plain = lagtop("fit", known[0], "--m", "1.587", "--format", "json").stdout
    assert "units" not in json.loads(plain)


def test_remarks_name_units_wherever_they_stand(lagtop: Lagtop) -> None:
    fast = [*PAPER, "--r0", "900rad/s"]
    bare = lagtop("solve", *fast, "--get", "remark").stdout
    assert "0.0156 s;" in bare
    assert "0.396 rad/s" in bare
    assert bare.strip() in lagtop("solve", *fast, "--format", "json").stdout
    assert "0.0156 time;" in lagtop("solve", "--r0", "900", "--get", "remark").stdout


@pytest.mark.slow
@pytest.mark.parametrize("command", ["sweep --r0 12000rpm", "find --r0 1e4:2e4rpm b=591.3586"])
def test_remarks_in_files_name_units(command: str, lagtop: Lagtop) -> None:
    body = "--m 350g --A 8.5e-4kg*m^2 --C 4e-4kg*m^2 --s 3cm --g 1g_0 --keys remark --format json"
    [row] = json.loads(lagtop(*command.split(), *body.split()).stdout)
    assert row["remark"].startswith("pseudo-regular precession: nutates by 0.0199 deg in 0.0106 s;")
    assert row["remark"].endswith(" rad/s")


def test_remarks_beside_pictures_name_units(lagtop: Lagtop, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    path = tmp_path / "page.svg"
    kinds = ["angles", "cubic"]
    assert lagtop("plot", *kinds, *PAPER, "--r0", "900rad/s", "-o", path).exit_code == 0
    text = path.read_text(encoding="utf-8")
    assert "0.0156 s;" in text
    assert "time;" not in text


def test_what_is_missing_of_a_body_is_typed_with_units(lagtop: Lagtop) -> None:
    said = lagtop("solve", "--m", "350g", "--r0", "9rpm", "--get", "A")
    assert said.stdout == "0.0039032\n"
    assert said.stderr.endswith(
        ": --A '39032 g*cm^2' --C '17458 g*cm^2' --s '4 cm' --g '981 cm/s^2'\n"
    )


def test_moments_about_the_mass_centre_and_rates_of_phi(lagtop: Lagtop) -> None:
    body = "--m 350g --A-cm 5350g*cm^2 --C 4000g*cm^2 --s 30mm --g 1g_0".split()
    assert lagtop("solve", *body, "--get", "A").stdout == "0.00085\n"
    found = lagtop("solve", *body, "--phidot0", "10turn/s", "--get", "r0").stdout
    assert float(found) == 20 * math.pi


ONCE = "must have its unit once, at the end, as in"


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("sweep --r0 60rpm:80rpm:3", f"{ONCE} '60:80:3 rpm', got"),
        ("sweep --r0 60rpm,80rpm", f"{ONCE} '60:80:3 rpm', got"),
        ("find K=2 --r0 60rpm:80rpm", f"{ONCE} '60:80 rpm', got"),
        ("sweep --r0 1e3:2e3", "must be a range [log:]start:stop:count, got '1e3:2e3'"),
    ],
)
def test_a_range_has_one_unit(line: str, message: str, lagtop: Lagtop) -> None:
    assert_one_line(lagtop(*line.split()), 2, f"--r0 {message}")


def test_sweeps(tmp_path: Path, lagtop: Lagtop) -> None:
    keys = ["--keys", "m,r0,error"]
    grid = lagtop("sweep", *WORDS[2:], "--m", "1,2 lb", "--r0", "log:60:6000:2 rpm", *keys)
    assert grid.stdout.splitlines()[1:] == [
        f"{m},{r0}," for m in (0.45359237, 0.90718474) for r0 in (2 * math.pi, 200 * math.pi)
    ]
    even = lagtop("sweep", "--r0", "60:180:3 rpm", "--keys", "r0").stdout.split()[1:]
    assert even == [str(2 * turns * math.pi) for turns in (1, 2, 3)]
    path = tmp_path / "tops.csv"
    path.write_text("id,m [g],theta0 [mrad],r0 [rpm]\na,350,500,480\nb,5O,500,480\n")
    rows = lagtop("sweep", path, *WORDS[2:], "--keys", "m,r0,theta0_deg,theta_min_deg", "--rad")
    assert rows.exit_code == 2
    rows = lagtop("sweep", path, *WORDS[2:], "--keys", "m,r0,theta0_rad", "--rad")
    assert rows.stdout.splitlines()[1] == "a,0.35,50.26548245743669,0.5,"
    assert "line 3: m must be a finite decimal number, got '5O'" in rows.stdout


@pytest.mark.parametrize("unit", ["/gauss", "gauss^-1", "statC^-1*cm", "/biot"])
def test_units_with_fractional_powers_are_refused(unit: str, lagtop: Lagtop) -> None:
    """A gauss is g^(1/2) cm^(-1/2) s^(-1): cut down to whole powers it would be a frequency."""
    refused = lagtop("table", "--t-max", f"2 {unit}", "--n", 2)
    said = f"--t-max must have a unit as in 2s, got the unit '{unit}' (not one of mass, length"
    assert_one_line(refused, 2, said)


@pytest.mark.parametrize(
    ("header", "options", "message"),
    [
        ("m,r0 [rpm]", WORDS, "standard input, heading m: m must have a unit such as 350g, as"),
        ("m [g],r0", WORDS, "standard input, heading r0: r0 must have a unit"),
        ("m [g]", ["--r0", "50"], "--r0 must have a unit"),
        ("m [rpm]", WORDS, "standard input, heading m [rpm]: m must have a unit as in 350g"),
        ("m [g],m", WORDS, "standard input must name each column once"),
        ("theta0", [], "standard input: the column theta0 must be spelt theta0_deg"),
        ('{"R0": 1}', [], "standard input: the column R0 must be spelt r0"),
        ('{"theta0_Deg": 1}', [], "standard input: the column theta0_Deg must be spelt theta0_deg"),
        ("theta0_deg [rad]", [], "standard input: the column theta0_deg must be called theta0 [r"),
        ('{"m": 1}', WORDS, "standard input, heading m: m must have a unit such as 350g"),
    ],
)
def test_wrong_headings(header: str, options: list[str], message: str, lagtop: Lagtop) -> None:
    options = [word for word in options if word not in {"--m", "350g"}]
    result = lagtop("sweep", "-", *options, input=f"{header}\n")
    of_the_file = message.startswith("standard input") and "JSON" not in message
    assert_one_line(result, 65 if of_the_file else 2, message)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--m 350s", "--m must have a unit as in 350g, got the unit 's'"),
        ("--m 350x", "--m must have a unit as in 350g, got the unit 'x' (no such unit)"),
        ("--m 9kg^99999999", "--m must have a unit as in 350g, got the unit 'kg^99999999'"),
        ("--m 9kg**9**9**9", "--m must have a unit"),
        ("--m 9(kg)", "--m must be a number, or an uncertain one as 1587(2)"),
        ("--m 9g;import", "--m must have a unit"),
        ("--m 1e400g", "--m must be at most 1.8e308"),
        ("--m nang", "--m must be a finite decimal number, got 'nang'"),
        ("--r0 50Hz", "--r0 must have a unit as in '50 rad/s' or 480rpm, got the unit 'Hz'"),
        ("--r0 50cps", "--r0 must have a unit"),
        ("--g 9.81g", "--g must have a unit as in '9.81 m/s^2', got the unit 'g'"),
        ("--A 1kg*m^2*turn", "--A must have a unit"),
        ("--s 4degC", "--s must have a unit as in 4cm"),
        ("--theta0 1m", "--theta0 must have a unit as in 30deg or 0.5rad, got the unit 'm'"),
        ("--theta0 1ppm", "--theta0 must have a unit"),
        ("--m 350g --r0 50", "--r0 must have a unit such as '50 rad/s' or 480rpm, as m has"),
        ("--r0 60rpm:80rpm:3", "--r0 must be a finite decimal number"),
        # common mistakes, with a hint
        ("--r0 480RPM", "got the unit 'RPM' (no such unit; did you mean rpm?)"),
        ("--m 1.8Kg", "got the unit 'Kg' (no such unit; did you mean kg?)"),
        ("--A 0.1kg*M2", "did you mean kg*m^2?"),
        ("--A 0.1kg*m2", "did you mean kg*m^2?"),
        ("--m 1800gr", "got the unit 'gr' (grain or gram? write grain or g)"),
        ("--r0 3Hz", "'Hz' (turns or radians per second? write rpm, turn/s or rad/s)"),
        ("--m 1kg --g 9.81", "--g must have a unit such as '9.81 m/s^2', as m has, got none"),
        ("--m 1kg --C 2", "--C must have a unit such as '2 kg*m^2', as m has, got none"),
    ],
)  # fmt: skip
def test_bad_units(options: str, message: str, lagtop: Lagtop) -> None:
    result = lagtop("solve", *options.split())
    assert_one_line(result, 2, message if message.startswith("--") else "--")
    assert message in result.stderr


def test_times_with_units_ask_for_units_of_all(lagtop: Lagtop) -> None:
    ask = ["table", "--n", "2", "--columns", "t"]
    assert lagtop(*ask, "--t-max", "2min").stdout == "t\n0.0\n120.0\n"
    assert lagtop(*ask, *PAPER, "--t-max", "2").stdout == "t\n0.0\n2.0\n"
    assert_one_line(lagtop(*ask, "--r0", "3", "--t-max", "2s"), 2, "--r0 must have a unit")
    assert_one_line(lagtop(*ask, "--t-max", "2m"), 2, "--t-max must have a unit as in 2s")


def test_without_pint_the_remedy_is_named(monkeypatch: Any, lagtop: Lagtop) -> None:
    from lagrange_cli.inputs import units

    monkeypatch.setitem(sys.modules, "pint", None)
    unit_by_pint.cache_clear()
    monkeypatch.setattr(units, "_registry", units._registry.__wrapped__)
    assert lagtop("solve", *WORDS, "--r0", "480rpm", "--get", "m").stdout == "0.35\n"
    said = "--m must be a finite decimal number (units need pint: pip install 'lagtop[units]')"
    assert_one_line(lagtop("solve", "--m", "1slug"), 69, said)
    with pytest.raises(LagtopError, match="need pint"):
        gather(read({"theta0": "3gon"}))
    unit_by_pint.cache_clear()


def test_uncertainties_convert_with_the_unit(tmp_path: Path, lagtop: Lagtop, solved: Any) -> None:
    rest = ["--C", "4000g*cm^2", "--s", "3cm", "--g", "9.81m/s^2"]
    found = solved("--m", "350(2) g", "--A-cm", "5350 ± 1 % g*cm^2", *rest, "--theta0", "30(1)deg")
    assert (found["m"], found["m_std"], found["theta0_deg_std"]) == (0.35, 0.002, 1.0)
    slopes = 5.35e-6, 0.03**2 * 0.002  # of A by A_cm and by m
    assert found["A_std"] == pytest.approx(math.hypot(*slopes), rel=1e-12)
    path = tmp_path / "scene.toml"
    path.write_text('m = "350(2) g"\nA_cm = "5350+/-1% g*cm^2"\ntheta0 = "30(1) deg"\n')
    assert solved(path, *rest) == found
    assert lagtop("sweep", path, "--keys", "m").stdout == "m,m_std\n0.35,0.002\n"
    path.write_text('r0 = "50(1)"\n')
    assert solved(path)["r0_std"] == 1
    path.write_text('theta0 = "30(1)"\n')
    assert solved(path)["theta0_deg_std"] == 1
    path.write_text('theta0 = "30"\n')
    assert_one_line(lagtop("solve", path), 65, f"{path}, line 1: theta0 must have a unit between")


def test_a_tilt_between_quotes_means_degrees_as_an_option_does(
    lagtop: Lagtop, tmp_path: Path
) -> None:
    scene = tmp_path / "tilt.toml"
    scene.write_text('theta0 = "90(1)"\n')
    keys = ("--get", "theta0_deg,theta0_deg_std,T_nutation_std")
    by_option = lagtop("solve", "--theta0", "90(1)", *keys)
    assert lagtop("solve", scene, *keys).stdout == by_option.stdout
    assert by_option.stdout.startswith("90.0\n1.0\n")
