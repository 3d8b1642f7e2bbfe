"""Numbers that agree to D digits are equal: exact zeros and ties, and their nearest neighbours.

`examples/numbers.txt` has more, worked out by hand.  A neighbour differs from the exact case by the
last bit of a double or by 1e-100.
"""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from lagtop import Motion, Top, solve
from scenes import UNIT

TINY = Fraction(1, 10**100)
UP = 1 + 2.0**-52
"""The double next to 1."""
Inputs = dict[str, Any]


def of(inputs: Inputs) -> Motion:
    return solve(Top(**UNIT | inputs))


SINE_SQUARED = {30.0: "1/4", 45.0: "1/2", 60.0: "3/4", 90.0: "1", 135.0: "1/2"}


@pytest.mark.parametrize("degrees", SINE_SQUARED)
@pytest.mark.parametrize("square", [0, 4])
def test_a_cusp_on_the_dot(degrees: float, square: int) -> None:
    """beta/b is a root of (4,9) if b v^2 + w (b w - a) (1 - u^2) = 0; here w = 1 and a = 2."""
    sin2 = Fraction(SINE_SQUARED[degrees])
    b = 2 * sin2 / (square + sin2)
    inputs: Inputs = {"r0": b, "theta0_deg": degrees, "psidot0": 1, "thetadot0": math.isqrt(square)}
    motion = of(inputs)
    if motion.facts.minus * motion.facts.spin > 0:  # beta/b is u3: the precession never stops
        assert motion.mean_spin_rate == float(b / 2)
    else:
        assert motion.path == "cusped"
    for tiny in (TINY, -TINY):
        assert of(inputs | {"r0": b + tiny}).path in {"looping", "wavy"}


LEVELS: list[tuple[Inputs, str]] = [
    ({"r0": 0, "theta0_deg": 60}, "u_quarter"),
    ({"r0": 2, "theta0_deg": 60}, "u2"),
    ({"r0": 1, "theta0_deg": 60, "psidot0": 2}, "spin_rate_start"),
    ({"r0": -1, "theta0_deg": 120, "psidot0": 2}, "spin_rate_start"),
    ({"C": 0.5, "r0": -2, "theta0_deg": 60, "psidot0": -2}, "u2"),
]


@pytest.mark.parametrize(("inputs", "key"), LEVELS)
def test_zeros_are_printed_and_near_misses_are_not(inputs: Inputs, key: str) -> None:
    assert of(inputs).record(digits=7, keys=[key]) == {key: "0.0"}
    moved = of(inputs | {"r0": Fraction(inputs["r0"]) + TINY})
    assert 0 < abs(Decimal(moved.record(digits=3, keys=[key])[key])) < Decimal("1e-40")


HALF = {"m": 2, "theta0_deg": 90, "thetadot0": 2}
"""By hand u3 = 2 and u(T/2) = 1/2: one of the rates is 0 then."""


@pytest.mark.parametrize(
    "inputs",
    [
        *(HALF | {"r0": r0, "psidot0": turn} for r0, turn in ((1, 2), (-1, -2), (2, 1))),
        {"A": 0.5, "C": 0.5, "r0": 0.5, "theta0_deg": 120, "psidot0": 3},
    ],
)
def test_next_to_a_rate_of_0_after_half_a_period_is_none(inputs: Inputs) -> None:
    for beside, is_0 in ((Fraction(0), True), (TINY, False)):
        moved = of(inputs | {"thetadot0": Fraction(inputs.get("thetadot0", 0)) + beside})
        record = moved.record(digits=3)
        assert ("0.0" in (record["spin_rate_half"], record["precession_rate_half"])) is is_0


DISC = {"A": 2, "m": 2, "C": 4, "r0": 0.25, "theta0_deg": 135, "psidot0": 4}
"""The drift of a disc, C = 2A, is 0 if beta = b u3."""


def test_next_to_a_mean_rate_of_0_is_a_period() -> None:
    exact = of(DISC).record(digits=30, keys=["mean_spin_rate", "T_spin"])
    assert exact == {"mean_spin_rate": "0.0", "T_spin": None}
    beside = of(DISC | {"r0": 0.25 * UP})
    assert 0 < abs(beside.mean_spin_rate) < 1e-14
    assert beside.T_spin == pytest.approx(2 * math.pi / abs(beside.mean_spin_rate))
