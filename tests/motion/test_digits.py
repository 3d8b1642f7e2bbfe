"""Any number of digits, against the judge in balls and textbook formulas."""

from __future__ import annotations

import json
from decimal import Decimal
from fractions import Fraction

import mpmath
import pytest
from arb_balls import exact_arb
from ball_judge import Judge
from balls.scene import arb_bits
from chrapan_top import rows_of
from conftest import Lagtop
from flint import arb
from lagtop import Top, solve
from scenes import EVERY_KIND, UNIT

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
