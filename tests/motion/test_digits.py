"""Any number of digits, against the paper's formulas and the many-digit reference."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import mpmath
import oracle
import pytest
from chrapan_top import record_of, rows_of
from conftest import Lagtop
from scenes import UNIT

from lagrange_cli import LagtopError, Top, solve
from lagrange_cli.bench.reference import Reference


def same(text: Any, true: Any, digits: int) -> bool:
    """Return whether all digits are right, within half a unit of the last one."""
    with mpmath.workdps(2 * digits + 50):
        if not true:
            return float(text) == 0
        return bool(abs(mpmath.mpf(text) / true - 1) <= mpmath.mpf(10) ** (1 - digits) / 2 * 1.0001)


@pytest.mark.parametrize("digits", [1, 20, 50, 200])
def test_the_worked_example(digits: int) -> None:
    record = solve(Top()).record(digits=digits)
    for key, true in oracle.constants(oracle.Scene(), dps=digits + 30).items():
        assert same(record[key], true, digits) or abs(true) < 1e-60, key


def test_fifty_digits_on_the_command_line(lagtop: Lagtop) -> None:
    shown = lagtop("solve", "--digits", "50", "--format", "json").stdout
    assert '"T_nutation":0.42925012447854773737540375001558009361' in shown
    assert json.loads(shown)["regime"] == "regular"
    table = lagtop("solve", "--digits", "50").stdout
    assert "0.42925012447854773737540375001558009361" in table
    assert "…" not in table


def test_inputs_are_decimals() -> None:
    """50.1 is no double."""
    record = record_of(Top(r0=Fraction("50.1"), theta0_deg=Fraction("30.1")), 40)
    exact = oracle.constants(oracle.Scene(r0="50.1", theta0_deg="30.1"), dps=60)
    assert same(record["T_nutation"], exact["T_nutation"], 40)
    assert record["r0"] == "50.1"


def test_a_general_start() -> None:
    start = {"psidot0": -3.0, "thetadot0": 0.5}
    record, reference = record_of(Top(**start), 60), Reference(Top(**start), 100)
    for key, true in reference.record().items():
        assert record[key] == true or same(record[key], true, 60), key


@pytest.mark.parametrize("start", [{}, {"psidot0": 3.0}, {"r0": 20.0, "thetadot0": -2.0}])
def test_angles(start: dict[str, float]) -> None:
    times = [-7.25, 0.0, 2.0**-40, 0.125, 1e6]
    rows = rows_of(Top(**start), times, 40, radians=True)
    reference = Reference(Top(**start), 100)
    for t, row in zip(times, rows, strict=True):
        assert float(row[0]) == t
        for text, true in zip(row[1:], reference.at(t)[:3], strict=True):
            assert same(text, true, 40) or not t


def test_tiny_times_have_all_their_digits() -> None:
    (row,) = rows_of(Top(), [1e-60], 10, radians=True)
    assert same(row[2], mpmath.mpf(1e-60) * 50, 10)  # it starts as r0 t


def test_a_neighbour_of_the_separatrix_is_not_taken_for_it() -> None:
    body = UNIT | {"A": 2, "r0": 0, "theta0_deg": 90}
    for beside in ("1." + "0" * 60 + "1", "0." + "9" * 61):
        top = Top(**body, thetadot0=Fraction(beside))
        assert record_of(top, 5)["regime"] == "no spin"
    assert record_of(Top(**body, thetadot0=Fraction(1)), 5)["regime"] == "separatrix"


@pytest.mark.slow
@pytest.mark.parametrize(
    "start",
    [
        {"theta0_deg": 0, "r0": 1},
        {"theta0_deg": 180, "r0": 1},
        {"g": 0, "r0": 1, "theta0_deg": 20, "psidot0": 1},
        {"r0": 0, "theta0_deg": 20},
        {"r0": 2, "theta0_deg": 90, "psidot0": 0.5},
        {"r0": 0, "A": 2, "theta0_deg": 90, "thetadot0": 1},
        {"r0": 1, "theta0_deg": 0, "thetadot0": 1},
        {"r0": 1, "theta0_deg": 50, "thetadot0": 1},
    ],
)
def test_regimes_settle(start: dict[str, float]) -> None:
    """Angles and greatest tilt in 20 digits: the motion of u = cos theta, integrated by Taylor."""
    top = Top(**(UNIT | start))
    rows = rows_of(top, [0.0, 0.5, 2.0], 22, radians=True)
    theta_max = record_of(top, 30, radians=True)["theta_max_rad"]
    with mpmath.workdps(30):
        true = integrated(top)
        for row in rows:
            t, theta, phi, psi = map(mpmath.mpf, row)
            u, _, true_psi, true_phi = true(t)
            assert abs(mpmath.cos(theta) - u) < 1e-20
            if abs(mpmath.cos(theta)) == 1:  # the angles are one there
                true_psi, true_phi = mpmath.mpf(0), mpmath.mpf(top.r0) * t
            half_turn = mpmath.pi if top.r0 == 0 else 0  # in a plane, over the lower pole
            jump = half_turn * mpmath.nint((psi - true_psi) / mpmath.pi)
            assert abs(psi - true_psi - jump) < 1e-20
            assert abs(phi - true_phi - jump) < 1e-20
        greatest, f = mpmath.mpf(theta_max), cubic(top)
        stays = abs(greatest - mpmath.mpf(rows[0][1])) < 1e-20
        assert abs(f(mpmath.cos(greatest))) < 1e-28
        assert stays or f(mpmath.cos(greatest) + mpmath.mpf(10) ** -6) > 0
        assert all(mpmath.mpf(row[1]) < greatest + mpmath.mpf(10) ** -20 for row in rows)


def cubic(top: Top) -> Callable[[Any], Any]:
    """Return f(u) of (4,9) for any start, in the working precision."""
    alpha, a, beta, b = integrals(top)
    return lambda u: (1 - u**2) * (alpha - a * u) - (beta - b * u) ** 2


def integrals(top: Top) -> tuple[Any, Any, Any, Any]:
    """Return alpha, a, beta and b of (4,4) and (4,5) for any start."""
    m, A, C, s, g, r0, tilt, nutation, precession = (mpmath.mpf(x) for x in top.inputs().values())
    theta = mpmath.radians(tilt)
    u, sine = mpmath.cospi(tilt / 180), mpmath.sinpi(tilt / 180)
    a, b = 2 * m * g * s / A, C * r0 / A
    assert abs(mpmath.cos(theta) - u) < 1e-28
    alpha = nutation**2 + (precession * sine) ** 2 + a * u
    return alpha, a, precession * sine**2 + b * u, b


def integrated(top: Top) -> Callable[[Any], Any]:
    """Return u, its rate, psi and phi at a time, from u'' = f'(u)/2 and (4,7), (4,8)."""
    alpha, a, beta, b = integrals(top)

    def precession(u: Any) -> Any:
        """Return (4,7), reduced where the axis meets a pole."""
        if beta == b:
            return b / (1 + u)
        return -b / (1 - u) if beta == -b else (beta - b * u) / (1 - u**2)

    def slope(_: Any, state: list[Any]) -> list[Any]:
        """Return the rates of the state."""
        u, rate, *_ = state
        curve = -u * (alpha - a * u) - a * (1 - u**2) / 2 + b * (beta - b * u)
        turning = precession(u)
        return [rate, curve, turning, top.r0 - u * turning]

    tilt = mpmath.mpf(top.theta0_deg)
    start = mpmath.cospi(tilt / 180), -mpmath.sinpi(tilt / 180) * top.thetadot0
    flow: Callable[[Any], Any] = mpmath.odefun(slope, 0, [*start, mpmath.mpf(0), mpmath.mpf(0)])
    return flow


def test_wrapped_far_away() -> None:
    (row,) = rows_of(Top(), [1e12], 30, wrap=True)
    assert -180 < float(row[2]) <= 180
    exact = Reference(Top(), 100).at(1e12)
    with mpmath.workdps(100):
        turns = (mpmath.mpf(row[3]) - mpmath.degrees(exact.psi)) / 360
        assert abs(turns - mpmath.nint(turns)) < mpmath.mpf(10) ** -28


@pytest.mark.parametrize("digits", ["0", "1001", "2.5", "many"])
def test_bad_numbers_of_digits(digits: str, lagtop: Lagtop) -> None:
    result = lagtop("solve", "--digits", digits)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith("Error: --digits must be ")


def test_a_vertical_start_is_refused_here_too() -> None:
    with pytest.raises(LagtopError, match="psidot0 must be 0"):
        record_of(Top(theta0_deg=0, psidot0=1.0), 20)


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
    exact = Reference(top, 160).at(1e63)
    (row,) = rows_of(top, [1e63], 10, radians=True, wrap=True)
    assert same(row[1], exact.theta, 10)


def test_the_separatrix() -> None:
    top = Top(**(UNIT | {"A": 2}), r0=0, theta0_deg=90, thetadot0=1)
    (row,) = rows_of(top, [0.25], 30, radians=True)
    with mpmath.workdps(50):
        h = mpmath.mpf(0.25) * mpmath.sqrt(0.5) - mpmath.asinh(1)
        assert same(row[1], 2 * mpmath.atan(1 / mpmath.sinh(-h)), 30)
    spinning = Top(**(UNIT | {"C": 0.5}), r0=-2, theta0_deg=90, thetadot0=1, psidot0=-1)
    (row,) = rows_of(spinning, [0.7], 20, radians=True)
    angles = solve(spinning).angles(0.7)
    assert list(map(float, row[1:])) == pytest.approx(list(map(float, angles)), rel=1e-15)


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
