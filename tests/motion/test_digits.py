"""Any number of digits, against the judge in balls and textbook formulas."""

from __future__ import annotations

import json
from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from arb_balls import exact_arb, many_digits
from ball_judge import Judge
from balls.scene import arb_bits
from chrapan_top import record_of, rows_of
from conftest import Lagtop
from flint import arb
from lagtop import Top, solve
from scenes import EVERY_KIND, UNIT


def same(text: Any, true: Any, digits: int) -> bool:
    """Return whether all digits are right, within half a unit of the last one."""
    with mpmath.workdps(2 * digits + 50):
        if not true:
            return float(text) == 0
        return bool(abs(mpmath.mpf(text) / true - 1) <= mpmath.mpf(10) ** (1 - digits) / 2 * 1.0001)


DEEP = ["worked example", "any start", "pendulum", "over the top", "sleeping", "separatrix", "cusp"]
DEEP += ["from the upper pole", "torque-free"]


@pytest.mark.parametrize("wrap", [False, True])
@pytest.mark.parametrize("name", DEEP)
def test_angles_have_the_digits_of_the_judge(name: str, wrap: bool) -> None:
    """Forty digits; the angles of the judge are unwrapped."""
    top = Top(**EVERY_KIND[name])
    judge, times = Judge(top.as_dict()), [0.375, -7.25, 2.0**-40, 1e3, -1e6, 1e12]
    for row in rows_of(
        top, times[:3] if name == "separatrix" else times, 40, wrap=wrap, radians=True
    ):
        with arb_bits(600):
            state, turn = judge.at(Fraction(row[0]), 40), 2 * arb.pi()
            for text, exact in zip(row[1:], state[:3], strict=True):
                away = exact - exact_arb(text)
                if wrap:
                    assert abs(Fraction(text)) < Fraction("3.14159265358979323846264338329")
                    away -= turn * round(float((away / turn).mid()))
                unit = Fraction(10) ** (Decimal(text).adjusted() - 39)
                assert away.contains(0) or abs(away) <= exact_arb(unit) / 2, (row[0], text)


def test_fifty_digits_on_the_command_line(lagtop: Lagtop) -> None:
    shown = lagtop("solve", "--digits", "50", "--format", "json").stdout
    assert '"T_nutation":0.42925012447854773737540375001558009361' in shown
    assert json.loads(shown)["regime"] == "regular"
    table = lagtop("solve", "--digits", "50").stdout
    assert "0.42925012447854773737540375001558009361" in table
    assert "…" not in table


def test_tiny_times_have_all_their_digits() -> None:
    (row,) = rows_of(Top(), [1e-60], 10, radians=True)
    assert same(row[2], mpmath.mpf(1e-60) * 50, 10)  # it starts as r0 t


def test_a_neighbour_of_the_separatrix_is_not_taken_for_it() -> None:
    body = UNIT | {"A": 2, "r0": 0, "theta0_deg": 90}
    for beside in ("1." + "0" * 60 + "1", "0." + "9" * 61):
        top = Top(**body, thetadot0=Fraction(beside))
        assert record_of(top, 5)["regime"] == "no spin"
    assert record_of(Top(**body, thetadot0=Fraction(1)), 5)["regime"] == "separatrix"


@pytest.mark.parametrize("digits", ["0", "1001", "2.5", "many"])
def test_bad_numbers_of_digits(digits: str, lagtop: Lagtop) -> None:
    result = lagtop("solve", "--digits", digits)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith("Error: --digits must be ")


@pytest.mark.parametrize(
    ("start", "t", "digits", "psi"),
    [
        ({"r0": 1e12, "theta0_deg": 40}, 1.0, 1, 1e-12),
        ({"r0": 5, "theta0_deg": 30}, 1e-8, 5, 8.3333333e-25),
        ({"r0": 5, "theta0_deg": 30}, 1e-40, 5, 8.3333333e-121),
    ],
)
def test_small_angles_are_not_taken_for_zero(
    start: dict[str, float], t: float, digits: int, psi: float
) -> None:
    (row,) = rows_of(Top(**(UNIT | start)), [t], digits, radians=True)
    assert float(row[3]) == pytest.approx(psi, rel=10.0 ** (1 - digits))


def test_far_times_do_not_lose_their_phase() -> None:
    top = Top(**UNIT, r0=5, theta0_deg=30)
    (row,) = rows_of(top, [1e63], 10, radians=True, wrap=True)
    assert same(row[1], many_digits(Judge(top.as_dict()).at(1e63).theta), 10)


def test_the_separatrix() -> None:
    top = Top(**(UNIT | {"A": 2}), r0=0, theta0_deg=90, thetadot0=1)
    (row,) = rows_of(top, [0.25], 30, radians=True)
    with mpmath.workdps(50):
        h = mpmath.mpf(0.25) * mpmath.sqrt(0.5) - mpmath.asinh(1)
        assert same(row[1], 2 * mpmath.atan(1 / mpmath.sinh(-h)), 30)


@pytest.mark.parametrize("t", [10, 1000, 10_000, 10**12])
def test_a_tilt_that_falls_to_0_on_the_separatrix_keeps_its_digits(t: int) -> None:
    """A pendulum by the textbook: sin(theta/2) = 1/cosh(sqrt(a/2) t - asinh 1)."""
    motion = solve(Top(m=1, A=1, C=1, s=1, g=2, r0=0, theta0_deg=90, thetadot0=2))
    assert motion.regime == "separatrix"
    ((_, theta, phi, psi),) = rows_of(motion.top, [t], 30, radians=True)
    with mpmath.workdps(60):
        exact = 2 * mpmath.asin(mpmath.sech(mpmath.sqrt(2) * t - mpmath.asinh(1)))
        assert abs(mpmath.mpf(theta) / exact - 1) < 1e-29
        assert abs(mpmath.mpf(phi) / mpmath.pi - 1) < 1e-29
    assert phi == psi
