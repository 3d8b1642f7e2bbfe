"""Steady precession and elementary theory: values of further keys."""

from __future__ import annotations

import math
from typing import Any

import pytest
from lagtop import Top, solve
from scenes import UNIT


@pytest.mark.parametrize(
    ("inputs", "wanted"),
    [
        ({"r0": 2, "theta0_deg": 90}, {"steady_rate_slow": 0.5, "steady_rate_fast": None}),
        ({"r0": 2, "theta0_deg": 90}, {"r0_steady_min": 0, "r0_sleeping": 2}),
        ({"r0": -2, "theta0_deg": 90}, {"steady_rate_slow": -0.5, "steady_rate_fast": None}),
        ({"r0": -3, "theta0_deg": 60, "g": 4.5}, {"steady_rate_slow": -3, "steady_rate_fast": -3}),
        ({"r0": -5, "theta0_deg": 0, "g": 4}, {"steady_rate_slow": -1, "steady_rate_fast": -4}),
        ({"r0": 0, "theta0_deg": 90}, {"steady_rate_slow": None, "steady_rate_fast": None}),
        ({"r0": 0, "theta0_deg": 120, "A": 2}, {"steady_rate_slow": 1, "steady_rate_fast": -1}),
        ({"r0": 0, "theta0_deg": 60}, {"steady_rate_slow": None, "r0_steady_min": math.sqrt(2)}),
        ({"r0": 0}, {"stability_factor": 0, "precession_rate_elementary": None}),
        ({"r0": 0}, {"T_nutation_elementary": None, "r0_sleeping": 2}),
        ({"r0": 3, "g": 0}, {"stability_factor": None, "r0_sleeping": 0, "steady_rate_slow": 0}),
        ({"r0": 3, "g": 0, "theta0_deg": 60}, {"steady_rate_fast": 6, "r0_steady_min": 0}),
        ({"r0": 2, "theta0_deg": 0}, {"steady_rate_slow": 1, "steady_rate_fast": 1}),
        ({"r0": 2, "theta0_deg": 150}, {"r0_steady_min": 0, "stability_factor": 1}),
    ],
)
def test_exact_values_of_degenerate_tops(inputs: Any, wanted: dict[str, float | None]) -> None:
    motion = solve(Top(**{**UNIT, "theta0_deg": 30, **inputs}))
    assert {key: getattr(motion, key) for key in wanted} == wanted


def test_next_to_a_double_root_both_rates_are_told_apart() -> None:
    """One ulp above the least spin they differ in the eighth digit; one below there are none."""
    least = solve(Top(**UNIT, r0=5, theta0_deg=30)).r0_steady_min
    above, below = (
        solve(Top(**UNIT, r0=math.nextafter(least, up), theta0_deg=30)) for up in (9, 0)
    )
    assert 1e-8 < above.steady_rate_fast / above.steady_rate_slow - 1 < 1e-7
    assert below.steady_rate_slow is below.steady_rate_fast is None
