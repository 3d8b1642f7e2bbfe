"""Proved columns over time: the judge in balls has formulas of its own, by Legendre's integrals."""

from __future__ import annotations

import json
import sys
from fractions import Fraction
from typing import Any

import pytest
from ball_judge import Judge
from conftest import Lagtop, assert_one_line
from scenes import EVERY_KIND as SCENES
from scenes import UNIT

from lagrange_cli import LagtopError, Top, solve
from lagrange_cli.arithmetic.balls import Ball, balls
from lagrange_cli.arithmetic.proved_rounding import about, decided, proved
from lagrange_cli.motion.certified import certified, rounding
from lagrange_cli.motion.certified_table import CertifiedTable
from lagrange_cli.motion.digits import rows_in_digits

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
    judge, table = Judge(top.as_dict()), CertifiedTable(certified(top), COLUMNS, radians=True)
    for t in TIMES[:3] if name == "separatrix" else TIMES:
        for found, exact in zip(table.row(Fraction(t)), state_of(judge, t), strict=True):
            with balls(400).working():
                away = abs(exact - balls(400).convert(found.value).arb)
                radius = balls(400).convert(Fraction(found.radius)).arb
                assert not away > radius, (t, found)
                assert radius <= abs(exact) * 2.0**-52 or exact.contains(0), (t, found)


@pytest.mark.parametrize("wrap", [False, True])
@pytest.mark.parametrize("name", ["worked example", "pendulum", "over the top", "sleeping"])
def test_digits_are_those_of_the_program(name: str, wrap: bool) -> None:
    top, times = Top(**SCENES[name]), [Fraction(t) for t in [0, *TIMES[:4]]]
    table = CertifiedTable(certified(top), ("t", "theta", "phi", "psi"), 30, wrap=wrap)
    assert [[x.value for x in table.row(t)] for t in times] == rows_in_digits(
        solve(top), times, 30, wrap=wrap
    )


def test_rates_are_those_of_the_judge() -> None:
    scene = UNIT | {"r0": 2, "theta0_deg": 70, "thetadot0": 0.75, "psidot0": 0.5}
    columns = ["phidot", "psidot", "u", "axis", "quaternion"]
    table = CertifiedTable(certified(Top(**scene)), columns)
    state = Judge(scene).at(0.375)
    phidot, psidot, u, *rest = (x.value for x in table.row(Fraction(3, 8)))
    axis, (w, x, y, z) = rest[:3], rest[3:]
    assert phidot == float(state.phi_rate.mid())
    assert psidot == float(state.psi_rate.mid())
    assert u == pytest.approx(float(state.theta.cos().mid()), abs=1e-16)
    turned = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]
    assert axis == pytest.approx(turned, abs=4e-16)
    waves = CertifiedTable(certified(Top(**scene)), ["dphi", "dpsi"], radians=True)
    remainders = Judge(scene)._raised(
        lambda motion: motion.remainders(Fraction(3, 8)), lambda _: True, 200
    )
    assert [x.value for x in waves.row(Fraction(3, 8))] == [float(x.mid()) for x in remainders[:2]]


def test_a_tie_is_said_and_not_guessed() -> None:
    """Ask for one digit of sqrt(2)^2 5/4, which is 2.5 and whose ball always holds that."""

    def two_and_a_half(bits: int) -> Ball:
        ar = balls(bits)
        with ar.working():
            root = ar.sqrt(2)
            return 5 * root * root / 4

    with pytest.raises(LagtopError, match="x cannot be told from 0 or a tie with 20000 bits"):
        proved("x", two_and_a_half, rounding("x", 1), digits=1)
    known = proved("x", two_and_a_half, rounding("x", 1), digits=1, exactly=lambda: Fraction(5, 2))
    assert known == about(rounding("x", 1)(Fraction(5, 2)), Fraction(5, 2))
    assert proved("x", two_and_a_half, rounding("x", None)) is not None
    with pytest.raises(LagtopError, match="which side"):
        decided("which side", lambda bits: bool(two_and_a_half(bits) * 2 > 5))


def test_commands_write_radii(lagtop: Lagtop) -> None:
    solved = json.loads(lagtop("solve", "--certify", "--format", "json").stdout)
    assert 0 < solved["T_nutation_radius"] < 2.8e-17
    assert list(solved).index("m_radius") == list(solved).index("remark") + 1
    plain = json.loads(lagtop("solve", "--format", "json").stdout)
    assert {key: solved[key] for key in plain} == plain
    assert lagtop("solve", "--certify").stdout == lagtop("solve").stdout
    assert (
        lagtop("solve", "--certify", "--get", "u2,path").stdout == "0.27695194556122277\ncusped\n"
    )
    row = json.loads(
        lagtop("table", "--certify", "--t-min", 1e9, "--n", 1, "--format", "json").stdout
    )
    assert list(row[0])[3:6] == ["psi_deg", "t_radius", "theta_deg_radius"]
    assert 0 < row[0]["phi_deg_radius"] <= row[0]["phi_deg"] * 2.0**-52
    drawn = lagtop("table", "--certify", "--n", 3, "--format", "table").stdout
    assert "radius" not in drawn
    derived = lagtop("solve", "--certify", "--derivation", "--format", "json").stdout
    assert 0 < json.loads(derived)["E_amplitude_radius"] < 1e-15


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("table --certify --columns t,energy", "columns to certify must be among t, theta, phi,"),
        ("table --certify --format npy", "--format npy holds doubles: with --certify take csv,"),
        ("table --certify --tops x.csv", "--tops and --certify exclude each other"),
        ("solve --certify --r0 nan", "--r0 must be a finite decimal number"),
    ],
)
def test_bad_input_is_one_line(lagtop: Lagtop, options: str, message: str) -> None:
    assert_one_line(lagtop(*options.split()), 2, message)


@pytest.mark.parametrize("command", ["solve", "table"])
def test_without_the_package_there_is_a_remedy(
    command: str, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [x for x in sys.modules if x.startswith("lagrange_cli.motion.certified")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delitem(sys.modules, "lagrange_cli.arithmetic.balls")
    monkeypatch.setitem(sys.modules, "flint", None)
    monkeypatch.setattr("lagrange_cli.motion.solve.solve", None)  # nothing is computed before
    result = lagtop(command, "--certify")
    assert_one_line(result, 69, "proved digits need python-flint: pip install 'lagtop[certify]'")
