"""Regimes, remarks, and inputs that are refused; `test_digits` checks the numbers."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import pytest
from ball_reference import BallReference, assert_nearest
from lagtop import LagtopError, Top, solve
from scenes import UNIT

from lagrange_cli.motion.regime import Regime


def test_tilt_in_radians() -> None:
    assert_nearest({"theta0_rad": 0.05})
    assert solve(Top(theta0_rad=math.pi)).theta_max_deg == 180
    assert solve(Top(theta0_rad=math.pi)).regime is Regime.REGULAR  # the double is not pi


def test_one_ulp_across_the_threshold_of_sleeping() -> None:
    """lambda = 1: the formulas change sides, the numbers stay the nearest doubles."""
    for r0 in (math.nextafter(2, 0), math.nextafter(2, 3)):
        assert_nearest(UNIT | {"theta0_deg": 1, "r0": r0})


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_change_of_units(scale: float) -> None:
    """Powers of two in length, mass and time only shift exponents."""
    unit = 2.0 ** round(math.log2(scale))
    plain = solve(Top())
    shifted = solve(
        Top(m=1587 * unit, A=39032 * unit**3, C=17458 * unit**3, s=4 * unit, g=981 * unit)
    )
    assert shifted.T_nutation == plain.T_nutation
    assert shifted.mean_precession_rate == plain.mean_precession_rate


@pytest.mark.parametrize(
    ("start", "regime", "path"),
    [
        ({"r0": 3, "theta0_deg": 60}, Regime.REGULAR, "cusped"),
        ({"r0": 3, "theta0_deg": 60, "psidot0": 0.5}, Regime.REGULAR, "wavy"),
        ({"r0": 3, "theta0_deg": 60, "psidot0": -0.5}, Regime.REGULAR, "looping"),
        ({"r0": -3, "theta0_deg": 60, "psidot0": 0.5}, Regime.REGULAR, "looping"),
        ({"r0": 2, "theta0_deg": 90, "psidot0": 0.5}, Regime.STEADY, None),
        ({"r0": 0, "theta0_deg": 120, "psidot0": math.sqrt(2)}, Regime.NO_SPIN, "wavy"),
        ({"r0": 0, "theta0_deg": 120, "thetadot0": 1}, Regime.NO_SPIN, None),
        (
            {"r0": 1, "g": 0, "theta0_deg": 60, "psidot0": 1, "thetadot0": 1},
            Regime.TORQUE_FREE,
            "wavy",
        ),
        ({"r0": 1, "s": 0, "theta0_deg": 60}, Regime.TORQUE_FREE, None),
        ({"r0": 1, "theta0_deg": 0}, Regime.SLEEPING, None),
        ({"r0": 1, "theta0_deg": 180}, Regime.HANGING, None),
        ({"r0": 1, "theta0_deg": 0, "thetadot0": 1}, Regime.REGULAR, "wavy"),
        ({"r0": 0, "theta0_deg": 180, "thetadot0": math.sqrt(2) ** 2}, Regime.NO_SPIN, None),
        ({"r0": 0, "theta0_deg": 180, "A": 0.5, "thetadot0": math.sqrt(8)}, Regime.NO_SPIN, None),
        ({"r0": 0, "theta0_deg": 90, "A": 2, "thetadot0": 1}, Regime.SEPARATRIX, None),
        ({"r0": 1, "theta0_deg": 60, "psidot0": 2 / 3, "A": 1}, Regime.REGULAR, "wavy"),
    ],
)
def test_regimes(start: dict[str, float], regime: Regime, path: str | None) -> None:
    motion = solve(Top(**(UNIT | start)))
    assert motion.regime is regime
    assert motion.path == path


def test_sleeping_says_whether_it_is_stable() -> None:
    """lambda = r0^2/4 here."""
    below = solve(Top(**UNIT, r0=math.nextafter(2, 0), theta0_deg=0))
    above = solve(Top(**UNIT, r0=2, theta0_deg=0))
    assert below.remark == "only phi + psi is defined; unstable (lambda = b^2/2a < 1)"
    assert above.remark == "only phi + psi is defined; stable (lambda = b^2/2a >= 1)"
    hanging = solve(Top(**UNIT, r0=2, theta0_deg=180))
    assert hanging.remark == "only phi - psi is defined; stable"


def test_rates_keep_their_digits_next_to_the_pole_and_for_tiny_starts() -> None:
    for theta0 in (1e-15, 1e-22, 1e-30, 1e-150):
        motion = solve(Top(**UNIT, r0=3, theta0_deg=theta0, psidot0=1))
        assert (motion.precession_rate_start, motion.path) == (1, "looping")
    for psidot0 in (1e-25, -1e-40):
        motion = solve(Top(**UNIT, r0=1e12, theta0_deg=40, psidot0=psidot0))
        assert motion.precession_rate_start == psidot0
        assert motion.path == ("wavy" if psidot0 > 0 else "looping")
    for kick in (1e-18, 1e-22, 1e-200):
        motion = solve(Top(**UNIT, r0=1, theta0_deg=0, thetadot0=kick))
        assert motion.precession_rate_half == pytest.approx(2, rel=4e-16)


@pytest.mark.parametrize("inputs", [{"theta0_deg": 0}, {"theta0_deg": 180, "thetadot0": 1}])
def test_no_precession_on_the_vertical(inputs: dict[str, float]) -> None:
    with pytest.raises(LagtopError, match="psidot0 must be 0 if the axis is vertical, got 1"):
        solve(Top(**inputs, psidot0=1.0))


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"m": 0}, "m must be > 0, got 0.0"),
        ({"A": -1}, "A must be > 0, got -1.0"),
        ({"C": 0}, "C must be > 0"),
        ({"C": 78065}, r"C must be <= 2 A = 78064.0, got 78065.0 \(no rigid body has more\)"),
        ({"s": -4}, "s must be >= 0, got -4.0"),
        ({"g": -1}, "g must be >= 0"),
        ({"theta0_deg": 180.1}, r"theta0_deg must be in \[0, 180\], got 180.1"),
        ({"theta0_rad": 3.2}, r"theta0_rad must be in \[0, pi rad\], got 3.2"),
        ({"theta0_rad": 1, "theta0_deg": 1}, "leave one out"),
        ({"r0": math.nan}, "r0 must be finite, got nan"),
        ({"r0": math.inf}, "r0 must be finite, got inf"),
        ({"r0": "fast"}, "r0 must be a real number, got 'fast'"),
    ],
)
def test_guards(inputs: dict[str, Any], message: str) -> None:
    with pytest.raises(LagtopError, match=message):
        Top(**inputs)


def test_numbers_out_of_range() -> None:
    with pytest.raises(LagtopError, match=r"m must be within 1e100 in size, got 1e\+300"):
        solve(Top(m=1e300))
    with pytest.raises(LagtopError, match="A must be >= 1e-100, got 1e-200"):
        solve(Top(A=1e-200, C=1e-200))
    with pytest.raises(LagtopError, match=r"T_nutation must be within 1\.8e308 in size"):
        _ = solve(Top(g=5e-324, s=1e-320, r0=0)).T_nutation
    assert solve(Top(g=5e-324, s=1e-320, r0=0)).k_prime < 1


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("tilt", [1.0, 30.0, 90.0, 179.0])
def test_pseudo_regular_precession_in_numbers(sign: int, tilt: float) -> None:
    """The threshold is (C r0)^2 = 100 A m g s, to the last bit; the numbers are the reference's."""
    unit = UNIT | {"theta0_deg": tilt}
    assert solve(Top(**unit, r0=sign * math.nextafter(10.0, 0.0))).remark is None
    for r0 in (10.0, 400.0):
        numbers = BallReference(Top(**unit, r0=sign * r0).as_dict()).numbers()
        u2, mean, period = (numbers[key] for key in ("u2", "mean_precession_rate", "T_nutation"))
        with mpmath.workdps(40):
            nods = mpmath.degrees(mpmath.acos(u2)) - tilt
            rate = mpmath.mpf(sign) / mpmath.mpf(r0)
            parts = int(mpmath.nint((mean / rate - 1) * 10**6))
        where = "within 1 ppm of"
        if parts:
            where = f"{abs(parts)} ppm {'below' if parts < 0 else 'above'}"
        assert abs(parts) < 10_300
        assert 0 < nods < 1.15
        assert solve(Top(**unit, r0=sign * r0)).remark == (
            f"pseudo-regular precession: nutates by {float(nods):.3g} deg in "
            f"{float(period):.3g} time; its mean is {where} mgs/(C r0) = {float(rate):.3g} rad/time"
        )
