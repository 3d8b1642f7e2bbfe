"""Regimes, remarks, and inputs that are refused; `test_digits` checks the numbers."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import pytest
from lagtop import LagtopError, Top, solve
from record_reference import reference_record
from scenes import UNIT

from lagrange_cli.solver.facts import Regime


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
        ({"r0": 1, "theta0_rad": math.pi}, Regime.REGULAR, "cusped"),  # the double is not pi
        *(
            ({"r0": 1e12, "theta0_deg": 40, "psidot0": x}, Regime.REGULAR, path)
            for x, path in ((1e-25, "wavy"), (-1e-40, "looping"))
        ),
    ],
)
def test_regimes(start: dict[str, float], regime: Regime, path: str | None) -> None:
    motion = solve(Top(**(UNIT | start)))
    assert motion.regime is regime
    assert motion.path == path


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"s": -4}, "s must be >= 0, got -4.0"),
        ({"g": -1}, "g must be >= 0"),
        ({"C": 0}, "C must be > 0"),
        ({"theta0_rad": 3.2}, r"theta0_rad must be in \[0, pi rad\], got 3.2"),
        ({"theta0_rad": 1, "theta0_deg": 1}, "leave one out"),
        ({"theta0_deg": 0, "psidot0": 1}, "psidot0 must be 0 if the axis is vertical, got 1"),
        ({"r0": math.inf}, "r0 must be finite, got inf"),
    ],
)
def test_guards(inputs: dict[str, Any], message: str) -> None:
    with pytest.raises(LagtopError, match=message):
        solve(Top(**inputs))


def test_sleeping_says_whether_it_is_stable() -> None:
    """lambda = r0^2/4 here."""
    below = solve(Top(**UNIT, r0=math.nextafter(2, 0), theta0_deg=0))
    above = solve(Top(**UNIT, r0=2, theta0_deg=0))
    assert below.remark == "only phi + psi is defined; unstable (lambda = b^2/2a < 1)"
    assert above.remark == "only phi + psi is defined; stable (lambda = b^2/2a >= 1)"
    hanging = solve(Top(**UNIT, r0=2, theta0_deg=180))
    assert hanging.remark == "only phi - psi is defined; stable"


@pytest.mark.parametrize(("sign", "tilt"), [(1, 1.0), (-1, 30.0), (1, 179.0)])
def test_pseudo_regular_precession_in_numbers(sign: int, tilt: float) -> None:
    """The threshold is (C r0)^2 = 100 A m g s, to the last bit; the numbers are the reference's."""
    unit = UNIT | {"theta0_deg": tilt}
    assert solve(Top(**unit, r0=sign * math.nextafter(10.0, 0.0))).remark is None
    for r0 in (10.0, 400.0):
        numbers = reference_record(Top(**unit, r0=sign * r0).as_dict())
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
            f"pseudo-regular precession: nutates by {float(nods):.3g} deg in {float(period):.3g} "
            f"time; the mean rate is {where} mgs/(C r0) = {float(rate):.3g} rad/time"
        )
