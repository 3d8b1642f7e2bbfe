"""Proved columns over time: the judge in balls has formulas of its own, by Legendre's integrals."""

from __future__ import annotations

import json
import sys
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from arb_balls import exact_arb
from ball_judge import Judge
from balls.scene import arb_bits
from conftest import Lagtop, assert_one_line
from flint import arb
from scenes import EVERY_KIND as SCENES
from scenes import UNIT

from lagrange_cli import Top, solve
from lagrange_cli.arithmetic.rounding import rounding_of
from lagrange_cli.motion.exact.rational_columns import known_column
from lagrange_cli.motion.over_time.columns import chosen_columns, column_names
from lagrange_cli.motion.over_time.proved_table import ProvedTable

TIMES = [0.375, -7.25, 1e3, -1e6, 1e12]
COLUMNS = ["theta", "phi", "psi", "quaternion"]
QUICK = ("worked example", "any start", "over the bottom", "steady")


def scenes() -> list[Any]:
    slow = pytest.mark.slow
    return [pytest.param(x, id=x, marks=() if x in QUICK else slow) for x in SCENES]


def state_of(judge: Judge, t: float) -> list[Any]:
    state = judge.at(t)
    return [*state[:3], *state.quaternion]


@pytest.mark.parametrize("name", scenes())
def test_angles_and_attitude_are_those_of_the_judge(name: str) -> None:
    """Unwrapped turns among them, up to 1e12 units of time away."""
    top = Top(**SCENES[name])
    judge, table = Judge(top.as_dict()), ProvedTable(solve(top), COLUMNS, radians=True)
    for t in TIMES[:3] if name == "separatrix" else TIMES:
        for found, exact in zip(table.row(Fraction(t)), state_of(judge, t), strict=True):
            with arb_bits(400):
                away = abs(exact - exact_arb(found.value))
                radius = exact_arb(found.radius)
                assert not away > radius, (t, found)
                assert radius <= abs(exact) * 2.0**-52 or exact.contains(0), (t, found)


@pytest.mark.parametrize("name", ["worked example", "pendulum", "over the top", "sleeping"])
def test_wrapped_angles_differ_by_whole_turns(name: str) -> None:
    """Angles in (-pi, pi], to thirty digits: the judge's angles are unwrapped."""
    top, times = Top(**SCENES[name]), [Fraction(t) for t in TIMES[:4]]
    judge, turn = Judge(top.as_dict()), 2 * arb.pi()
    table = ProvedTable(solve(top), ("phi", "psi"), 30, wrap=True, radians=True)
    with arb_bits(200):
        for t in times:
            state = judge.at(t)
            for found, exact in zip(table.row(t), (state.phi, state.psi), strict=True):
                assert abs(Fraction(found.value)) < Fraction("3.14159265358979323846264338329")
                turns = (exact - exact_arb(found.value)) / turn
                assert abs(turns - round(float(turns.mid()))) < 1e-8, (t, found)


def test_rates_are_those_of_the_judge() -> None:
    scene = UNIT | {"r0": 2, "theta0_deg": 70, "thetadot0": 0.75, "psidot0": 0.5}
    columns = ["phidot", "psidot", "u", "axis", "quaternion"]
    table = ProvedTable(solve(Top(**scene)), columns)
    state = Judge(scene).at(0.375)
    phidot, psidot, u, *rest = (x.value for x in table.row(Fraction(3, 8)))
    axis, (w, x, y, z) = rest[:3], rest[3:]
    assert phidot == float(state.phi_rate.mid())
    assert psidot == float(state.psi_rate.mid())
    assert u == pytest.approx(float(state.theta.cos().mid()), abs=1e-16)
    turned = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]
    assert axis == pytest.approx(turned, abs=4e-16)
    waves = ProvedTable(solve(Top(**scene)), ["dphi", "dpsi"], radians=True)
    remainders = Judge(scene)._raised(
        lambda motion: motion.remainders(Fraction(3, 8)), lambda _: True, 200
    )
    assert [x.value for x in waves.row(Fraction(3, 8))] == [float(x.mid()) for x in remainders[:2]]


RATES = ["thetadot", "p", "q", "r", "moment", "energy", "Lz"]


def rates_of(judge: Judge, scene: dict[str, Any], t: float, bits: int = 300) -> list[arb]:
    """Return the columns RATES by the judge's angles and rates, the tilt growing where it grows."""
    state, later = judge.at(t), judge.at(Fraction(t) + Fraction(1, 2**40))
    top = Top(**scene)
    m, A, C, s, g, r0 = (arb(float(x)) for x in (top.m, top.A, top.C, top.s, top.g, top.r0))
    sin, cos = state.theta.sin(), state.theta.cos()
    grows = 1 if later.theta > state.theta else -1
    thetadot, across = grows * abs(state.theta_rate), state.psi_rate * sin
    sin_phi, cos_phi = state.phi.sin(), state.phi.cos()
    weight = m * g * s
    return [
        thetadot,
        across * sin_phi + thetadot * cos_phi,
        across * cos_phi - thetadot * sin_phi,
        r0,
        weight * sin,
        A * (thetadot**2 + across**2) / 2 + C * r0**2 / 2 + weight * cos,
        A * across * sin + C * r0 * cos,
    ]


@pytest.mark.parametrize("name", SCENES)
def test_rates_moment_and_what_is_conserved_are_those_of_the_judge(name: str) -> None:
    """The judge's numbers are enclosures too: the two have to meet, and ours says the double."""
    scene = SCENES[name]
    judge, table = Judge(Top(**scene).as_dict()), ProvedTable(solve(Top(**scene)), RATES)
    for t in (0.375, -7.25):
        with arb_bits(300):
            for found, exact in zip(table.row(Fraction(t)), rates_of(judge, scene, t), strict=True):
                ours = arb(found.value, exact_arb(found.radius))
                assert ours.overlaps(exact), (t, found, exact)
                assert exact.rad() < 1e-15 * (1 + abs(exact)), (t, found, exact)
                assert float(found.radius) <= abs(found.value) * 2.0**-52, (t, found)


@pytest.mark.parametrize("name", ["any start", "radians"])
def test_angular_velocity_is_that_of_the_turning_quaternion(name: str) -> None:
    """(0, p, q, r) = 2 conj(Q) Q', by central differences in 60 digits."""
    table = ProvedTable(solve(Top(**SCENES[name])), ["quaternion", "p", "q", "r"], 60)
    step, t = Fraction(1, 10**12), Fraction(-3, 8)
    with mpmath.workdps(60):
        before, now, after = (
            [mpmath.mpf(x.value) for x in table.row(t + i * step)] for i in (-1, 0, 1)
        )
        w, x, y, z = now[:4]
        dw, dx, dy, dz = ((after[i] - before[i]) / (2 * mpmath.mpf(10) ** -12) for i in range(4))
        turning = (
            2 * (w * dx - x * dw - y * dz + z * dy),
            2 * (w * dy + x * dz - y * dw - z * dx),
            2 * (w * dz - x * dy + y * dx - z * dw),
        )
        size = 1 + max(map(abs, now))
        for found, other in zip(now[4:], turning, strict=True):
            assert abs(found - other) < 1e-18 * size**3, name


@pytest.mark.parametrize("method", ["start", "steady"])
def test_what_is_rational_is_known(method: str) -> None:
    """Ties, which are rounded to even, and zeros: no ball decides them."""
    scene = UNIT | {"m": 5, "theta0_deg": 30, "r0": 2.5, "psidot0": 0.25, "thetadot0": 0.75}
    columns = ["theta", "thetadot", "psidot", "p", "q", "r", "moment"]
    expected = ["30.0", "0.8", "0.2", "0.8", "0.1", "2.0", "2.0"]
    if method == "steady":
        scene = UNIT | {"g": 0, "theta0_deg": 60, "r0": 2.5}
        columns = ["u", "thetadot", "psidot", "phidot", "p", "q", "moment", "energy", "Lz"]
        expected = ["0.5", "0.0", "0.0", "2.0", "0.0", "0.0", "0.0", "3.0", "1.0"]
    t = Fraction(0 if method == "start" else 7)
    table = ProvedTable(solve(Top(**scene)), columns, 1)
    assert [x.value for x in table.row(t)] == expected


ZERO, TENTH = Fraction(0), Fraction(1, 10)
ALWAYS: dict[str, tuple[dict[str, float | Fraction], dict[str, Fraction]]] = {
    "disc from rest": ({"C": 2, "r0": 3, "theta0_deg": 31}, {"q": ZERO}),
    "disc with p = 0": (
        {"C": 2, "r0": 6 * TENTH, "theta0_deg": 31, "psidot0": Fraction(5, 3)},
        {"p": ZERO},
    ),
    "sphere over the bottom": (
        {"r0": 0.625, "theta0_deg": 90, "psidot0": -0.625},
        {"quaternion_z": ZERO},
    ),
    "sphere over the top": (
        {"r0": 0.625, "theta0_deg": 90, "psidot0": 0.625, "thetadot0": 5},
        {"quaternion_y": ZERO},
    ),
    "separatrix of a sphere": (
        {"m": 3.25, "r0": -2.25, "theta0_deg": 60, "thetadot0": -1.25, "psidot0": -1.5},
        {"quaternion_y": ZERO},
    ),
    "plane, round and round": (
        {"r0": 0, "theta0_deg": 31, "thetadot0": 9},
        dict.fromkeys(("q", "axis_x", "quaternion_y", "quaternion_z"), ZERO),
    ),
    "steady, psi + phi stands": (
        {"m": 0.5, "C": 0.25, "r0": -3, "theta0_deg": 120, "psidot0": 2},
        {"quaternion_z": ZERO},
    ),
    "free sphere": (
        {"g": 0, "r0": 3, "theta0_deg": 31, "thetadot0": 25 * TENTH},
        {"p": 25 * TENTH, "q": ZERO},
    ),
    "free turn about the vertical": (
        {"g": 0, "r0": 0, "theta0_deg": 90, "psidot0": 2.5},
        {"p": ZERO, "q": 25 * TENTH},
    ),
}


STANDS = {"m": Fraction(1, 9), "C": 1.5, "r0": Fraction(1, 3), "theta0_deg": 60}
STANDS |= {"psidot0": Fraction(2, 3)}
"""A steady precession whose spin rate is 0."""


@pytest.mark.parametrize("name", ALWAYS)
def test_what_is_the_same_at_all_times_is_known(name: str) -> None:
    """Spheres, discs and planes; the judge has the same numbers."""
    inputs, expected = ALWAYS[name]
    top = Top(**UNIT | inputs)
    judge, motion = Judge(top.as_dict()), solve(top)
    for t in (Fraction(7, 3), Fraction(-2, 5)):
        for digits in (1, 17):
            row = ProvedTable(motion, list(expected), digits).row(t)
            assert [x.value for x in row] == [
                rounding_of(column, digits)(value) for column, value in expected.items()
            ]
        state = judge.at(t)
        sin, cos = state.phi.sin(), state.phi.cos()
        across = state.psi_rate * state.theta.sin()
        judged = {
            "p": across * sin + state.theta_rate * cos,
            "q": across * cos - state.theta_rate * sin,
            "axis_x": state.theta.sin() * state.psi.sin(),
        }
        judged |= {f"quaternion_{x}": y for x, y in zip("wxyz", state.quaternion, strict=True)}
        for column, value in expected.items():
            assert judged[column].contains(float(value)), column
            assert judged[column].rad() < 1e-14, column


@pytest.mark.parametrize("name", [*SCENES, *ALWAYS])
def test_what_is_known_is_in_the_balls(name: str) -> None:
    inputs = SCENES[name] if name in SCENES else UNIT | ALWAYS[name][0]
    motion = solve(Top(**inputs))
    table = ProvedTable(motion, ["theta"])
    names = {part.name for name in column_names() for part in chosen_columns([name])}
    for t in (Fraction(0), Fraction(7, 3)):
        sample = table.sample(t, 60)
        for column in names - {"t"}:
            known = known_column(motion.exact, column, t, radians=True)
            if known is not None:
                away = getattr(sample, column) - sample.t.ar.convert(known)
                assert away.middle.copy_abs() <= away.radius, (column, t)


@pytest.mark.parametrize("tilt", [0, 180])
@pytest.mark.parametrize("C", [0.5, 1])
def test_on_the_vertical_all_of_the_rotation_is_spin(tilt: float, C: float) -> None:
    """The rates are those of the angles: phidot was r0 - b/2 and psidot b/2."""
    top = Top(**UNIT | {"C": C, "r0": 3, "theta0_deg": tilt})
    columns = ["phi", "psi", "phidot", "psidot", "p", "q", "energy", "Lz"]
    spin = 3 * (1 if tilt == 0 else -1) * C
    expected = [7.5, 0, 3, 0, 0, 0, 4.5 * C + (1 if tilt == 0 else -1), spin]
    proved_row = ProvedTable(solve(top), columns, radians=True).row(Fraction(5, 2))
    assert [x.value for x in proved_row] == expected
    assert [float(x) for x in solve(top).table(2.5, columns).values()] == expected


@pytest.mark.parametrize(
    ("inputs", "t", "column", "expected"),
    [
        ({"r0": 3, "theta0_deg": 31}, 0, "q", "0.0"),
        ({"r0": 3 * TENTH, "theta0_deg": 0, "thetadot0": 5}, 0, "phidot", "0.2"),
        ({"r0": 3 * TENTH, "theta0_deg": 0, "thetadot0": 5}, 0, "psidot", "0.2"),
        ({"r0": 3 * TENTH, "theta0_deg": 180, "thetadot0": 5}, 0, "psidot", "-0.2"),
        ({"g": 0, "r0": 0, "theta0_deg": 0, "thetadot0": 25 * TENTH}, 1, "theta", "2.0"),
        ({"g": 0, "r0": 0, "theta0_deg": 0, "thetadot0": 15 * TENTH}, -1, "thetadot", "-2.0"),
        ({"g": 0, "r0": 0, "theta0_rad": 0.5, "thetadot0": -1.25}, 0.6, "theta", "0.2"),
        ({"r0": 0, "theta0_deg": 31, "thetadot0": 9}, 0.01, "dphi", "0.0"),
        ({"r0": 0.25, "theta0_deg": 30, "m": 0.1, "A": 0.5}, 0, "phidot", "0.2"),
        ({"m": 0.125, "r0": 0.5, "theta0_deg": 90, "psidot0": 0.25}, 0, "q", "0.2"),
        (STANDS, 7, "phi", "0.0"),
        (STANDS, 7, "p", "0.0"),
    ],
)
def test_what_is_rational_for_some_tops_is_known(
    inputs: dict[str, Any], t: float, column: str, expected: str
) -> None:
    """Ties among them: 0.15 and 2.5 in one digit."""
    table = ProvedTable(solve(Top(**UNIT | inputs)), [column], 1, radians=True)
    assert table.row(Fraction(str(t)))[0].value == expected


def test_commands_write_radii(lagtop: Lagtop) -> None:
    solved = json.loads(lagtop("solve", "--certify", "--format", "json").stdout)
    assert 0 < solved["T_nutation_radius"] < 2.8e-17
    assert list(solved).index("m_radius") == list(solved).index("remark") + 1
    plain = json.loads(lagtop("solve", "--format", "json").stdout)
    assert {key: solved[key] for key in plain} == plain
    assert str(solved["T_nutation_radius"]) in lagtop("solve", "--certify").stdout
    bare = lagtop("solve", "--certify", "--get", "u2,path").stdout
    assert bare == f"0.27695194556122277\n{solved['u2_radius']}\ncusped\n"
    row = json.loads(
        lagtop("table", "--certify", "--t-min", 1e9, "--n", 1, "--format", "json").stdout
    )
    assert list(row[0])[3:6] == ["psi_deg", "t_radius", "theta_deg_radius"]
    assert 0 < row[0]["phi_deg_radius"] <= row[0]["phi_deg"] * 2.0**-52
    drawn = lagtop("table", "--certify", "--n", 3, "--format", "table").stdout
    assert "theta_deg_radius" in drawn
    derived = lagtop("solve", "--certify", "--derivation", "--format", "json").stdout
    assert 0 < json.loads(derived)["E_amplitude_radius"] < 1e-15


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("table --certify --columns t,e", "--columns must be among t, theta, phi,"),
        ("table --certify --format npy", "--format npy holds doubles: with --certify use csv,"),
        ("table --certify --tops x.csv", "use --tops or --certify, not both"),
        ("solve --certify --r0 nan", "--r0 must be a finite decimal number"),
    ],
)
def test_bad_input_is_one_line(lagtop: Lagtop, options: str, message: str) -> None:
    assert_one_line(lagtop(*options.split()), 2, message)


def test_radii_need_no_package(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    """Proof is by the standard library alone."""
    monkeypatch.setitem(sys.modules, "flint", None)
    for command in ("solve", "table"):
        assert lagtop(command, "--certify").exit_code == 0


def test_the_separatrix_is_decided_at_once_at_any_time(lagtop: Lagtop) -> None:
    """The tilt falls as exp(-t), below the exponents of decimals; what stays finite is printed."""
    top = "--m 1 --A 1 --C 1 --s 1 --g 1 --r0 0 --theta0 60 --thetadot0 1".split()
    args = [*top, "--t-min", "1e20", "--t-max", "1e20", "--n", "1", "--digits", "20"]
    refused = lagtop("table", *args, "--format", "csv", "--columns", "theta")
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "theta at t = 1e+20 is below 1e-300000000000000000 in size, too small" in refused.stderr
    shown = lagtop("table", *args, "--format", "csv", "--columns", "phi,psi,axis_z,quaternion_w")
    assert shown.stdout.splitlines()[1:] == ["180.0,180.0,1.0,-1.0"]
