"""Numbers whose parts cancel: what is exactly 0 is 0, what is nearly 0 has all its digits.

Values in comments and tables are worked out outside the program: exact fractions, published digits,
or ball arithmetic (`ball_judge`).
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import pytest
from lagtop import Top, solve
from scenes import UNIT

HALF_AND_A_HAIR = Fraction(1, 2) + Fraction(1, 10**81)


# Doubles


@pytest.mark.parametrize(
    ("C", "r0"), [(1e-40, 1e40), (1e-45, 1e45), (1e-60, 1e60), (1e-80, 1e80), (1e-60, -1e60)]
)
def test_precession_of_a_tiny_body_that_spins_fast(C: float, r0: float) -> None:
    """Only b = C r0/A moves the axis: psi is that of C = r0 = 1."""
    psi = math.degrees(
        float(solve(Top(**UNIT | {"C": C, "r0": r0, "theta0_deg": 60})).angles(10)[2])
    )
    assert psi == pytest.approx(math.copysign(347.515112335317602, r0), rel=1e-15)


# Any number of digits


@pytest.mark.parametrize(
    ("inputs", "digits", "key", "text"),
    [
        ({"r0": 1, "thetadot0": Fraction(10) ** 20}, 1, "mean_precession_rate", "1.0e-40"),
        ({"r0": 1, "thetadot0": Fraction(10) ** 28}, 1, "mean_precession_rate", "1.0e-56"),
        (
            {"r0": 1, "thetadot0": Fraction(10) ** 28},
            20,
            "T_precession",
            "6.2831853071795864769e+56",
        ),
        ({"psidot0": 1, "r0": HALF_AND_A_HAIR}, 5, "spin_rate_start", "1.0e-81"),
        ({"psidot0": 1, "r0": HALF_AND_A_HAIR}, 60, "spin_rate_start", "1.0e-81"),
        ({"psidot0": 1, "r0": Fraction(1, 2)}, 5, "spin_rate_start", "0.0"),
    ],
)
def test_no_zero_is_false(inputs: dict[str, Any], digits: int, key: str, text: str) -> None:
    motion = solve(Top(**UNIT | {"theta0_deg": 60} | inputs))
    assert motion.record(digits=digits)[key] == text


@pytest.mark.parametrize(
    ("theta0_deg", "thetadot0", "most"),
    [(1e-150, 5e-324, 512), (1e-150, 1e-200, 512), (1e-100, 0, 128), (1e-12, 1e-13, 128)],
)
def test_tiny_tilts_take_few_digits(
    theta0_deg: float, thetadot0: float, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The cost of an upright start is counted in digits, not in seconds."""
    used = []
    motion = solve(Top(**UNIT | {"r0": 2, "theta0_deg": theta0_deg, "thetadot0": thetadot0}))
    kind = motion.kind

    def counted(digits: int) -> Any:
        used.append(digits)
        return kind(digits)

    monkeypatch.setattr(motion, "kind", counted)
    assert motion.T_nutation is not None
    assert max(used) <= most
