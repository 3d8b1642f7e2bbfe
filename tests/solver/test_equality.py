"""Numbers that agree to D digits are equal: exact zeros and ties, and their nearest neighbours.

Values are worked out by hand.  A neighbour differs from the exact case by the last bit of a double
or by 1e-100.
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


SQRT3 = math.sqrt(3)
REGIMES: list[tuple[Inputs, str, Inputs]] = [
    # steady: a = 2 b w - 2 w^2 u
    ({"m": 2.5, "r0": 3, "theta0_deg": 60, "psidot0": 1}, "steady precession", {"psidot0": UP}),
    ({"m": 3, "r0": 3, "theta0_deg": 90, "psidot0": 1}, "steady precession", {"psidot0": UP}),
    ({"m": 3.5, "r0": 3, "theta0_deg": 120, "psidot0": 1}, "steady precession", {"r0": 3 * UP}),
    # separatrix: b = w (1 + u) and v^2 = (1 - u) (a - w b), a = 2
    ({"r0": 1, "theta0_deg": 90, "psidot0": 1, "thetadot0": 1}, "separatrix", {"r0": UP}),
    ({"r0": 0, "theta0_deg": 60, "thetadot0": 1}, "separatrix", {"thetadot0": UP}),
    ({"r0": 0, "theta0_deg": 180, "thetadot0": 2}, "separatrix", {"thetadot0": 2 * UP}),
    ({"r0": 2, "theta0_deg": 0}, "sleeping", {"theta0_deg": 1e-150}),
    ({"r0": 2, "theta0_deg": 180}, "hanging", {"thetadot0": 5e-324}),
    ({"g": 0, "r0": 2, "theta0_deg": 72}, "torque-free", {"g": 5e-324}),
    ({"r0": 0, "theta0_deg": 36}, "no spin", {"r0": 5e-324}),
]


@pytest.mark.parametrize(("inputs", "regime", "change"), REGIMES)
def test_a_regime_holds_on_the_dot_only(inputs: Inputs, regime: str, change: Inputs) -> None:
    assert of(inputs).regime == regime
    assert of(inputs | change).regime != regime


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


HALF = {"m": 2, "A": 1, "C": 1, "s": 1, "g": 1, "theta0_deg": 90, "thetadot0": 2}
"""By hand u3 = 2 and u(T/2) = 1/2."""
DISC = {"A": 2, "m": 2, "C": 4, "r0": 0.25, "theta0_deg": 135, "psidot0": 4}
"""The drift of a disc, C = 2A, is 0 if beta = b u3."""
HALVES = "u3 spin_rate_half precession_rate_half"
EXACT: list[tuple[Inputs, str, tuple[float | None, ...]]] = [
    *((inputs, key, (0,)) for inputs, key in LEVELS),
    (HALF | {"r0": 1, "psidot0": 2}, HALVES, (2, 0, 2)),
    (HALF | {"r0": -1, "psidot0": -2}, HALVES, (2, 0, -2)),
    (HALF | {"r0": 2, "psidot0": 1}, HALVES, (2, 2, 0)),
    (HALF | {"A": 2, "C": 2, "g": 2, "r0": 2, "psidot0": 1}, HALVES, (2, 2, 0)),
    # (4,9) over u - u0 is 4 u^2 - 7 u + 3/2 with the roots 1/4, 3/2
    (
        {"A": 0.5, "C": 0.5, "r0": 0.5, "theta0_deg": 120, "psidot0": 3},
        *(HALVES, (1.5, 0, 2)),
    ),
    # and 2 u^2 - 4 u - 4 with 1 -+ sqrt(3)
    (
        {"C": 0.5, "r0": 2, "theta0_deg": 120, "psidot0": -2},
        *(HALVES, (1 + SQRT3, 0, -1 - SQRT3)),
    ),
    # u1 = 1/2 in the place of u3 would make the rate 0; it is 1 + sqrt(3)/2
    (
        HALF | {"r0": 1, "psidot0": 2, "thetadot0": 1},
        *("u1 precession_rate_half", (0.5, 1.8660254037844386)),
    ),
    (HALF | {"r0": 2, "psidot0": 1, "thetadot0": 1}, "spin_rate_half", (1.8660254037844386,)),
    # a mean rate of 0 has no period; without torque half turns cancel
    (DISC, "mean_spin_rate T_spin", (0, None)),
    (
        {"r0": 1, "theta0_deg": 90, "g": 0, "thetadot0": 1},
        *("mean_precession_rate T_precession", (0, None)),
    ),
    # ties, rounded to the even double
    # r0 - psidot0 cos 120 = 2^53 + 1 is midway: the even neighbour
    ({"r0": 2.0**53, "theta0_deg": 120, "psidot0": 2.0}, "spin_rate_start", (2.0**53,)),
    ({"r0": 2.0**53 + 2, "theta0_deg": 120, "psidot0": 2.0}, "spin_rate_start", (2.0**53 + 4,)),
    # 90 - theta0/2
    ({"r0": 0, "theta0_deg": 53 + 2.0**-47}, "modular_angle_deg", (63.5,)),
    ({"r0": 0, "theta0_deg": 53 + 3 * 2.0**-47}, "modular_angle_deg", (63.5 - 2.0**-46,)),
    # without torque and spin the other turning point is opposite, at 180 - theta0
    (
        {"g": 0, "r0": 0, "theta0_deg": 35.48870519889296, "psidot0": -2.9},
        *("theta_max_deg", (float(180 - Fraction(35.48870519889296)),)),
    ),
    # b^2/a = 1/x - x with x = 1 - 2^-54, and u2 = -x
    (
        {"m": 134217727, "A": 207165582859042816, "C": 23, "s": 1566469435607129}
        | {"g": 134217729, "r0": 1566469435607129, "theta0_deg": 90},
        *("u2", (-1.0,)),
    ),
]


@pytest.mark.parametrize(("inputs", "keys", "values"), EXACT)
def test_numbers_that_are_exact_by_hand(
    inputs: Inputs, keys: str, values: tuple[float | None, ...]
) -> None:
    motion = of(inputs)
    assert tuple(getattr(motion, key) for key in keys.split()) == values


@pytest.mark.parametrize("inputs", [inputs for inputs, keys, _ in EXACT if keys == HALVES])
def test_next_to_a_rate_of_0_after_half_a_period_is_none(inputs: Inputs) -> None:
    moved = of(inputs | {"thetadot0": Fraction(inputs.get("thetadot0", 0)) + TINY})
    record = moved.record(digits=3)
    assert "0.0" not in (record["spin_rate_half"], record["precession_rate_half"])


def test_next_to_a_mean_rate_of_0_is_a_period() -> None:
    exact = of(DISC).record(digits=30, keys=["mean_spin_rate", "T_spin"])
    assert exact == {"mean_spin_rate": "0.0", "T_spin": None}
    beside = of(DISC | {"r0": 0.25 * UP})
    assert 0 < abs(beside.mean_spin_rate) < 1e-14
    assert beside.T_spin == pytest.approx(2 * math.pi / abs(beside.mean_spin_rate))


def test_a_number_midway_between_two_decimals_is_rounded_to_even() -> None:
    """b^2/a = 7/12: the roots are -3/4 and 4/3, and k = 3/5."""
    inputs = {"m": 42, "r0": 7, "theta0_deg": 90}
    record = of(inputs).record(digits=1)
    assert [record[key] for key in ("u2", "u3", "k")] == ["-0.8", "1.0", "0.6"]
    moved = of(inputs | {"r0": 7 + Fraction(1, 10**30)})
    assert moved.record(digits=1)["u2"] == "-0.7"


@pytest.mark.parametrize(
    ("psi_rate", "r0", "key", "printed"),
    [
        ("-13/16", "13/16", "mean_spin_rate", "1.2188"),  # 13/16 - 13/64 + 39/64
        ("-13/16", "-13/16", "mean_precession_rate", "-0.60938"),  # -39/64
        ("13/16", "13/16", "mean_precession_rate", "0.60938"),
        ("13/16", "-13/16", "mean_spin_rate", "-1.2188"),
    ],
)
def test_mean_rates_without_torque_may_be_midway(
    psi_rate: str, r0: str, key: str, printed: str
) -> None:
    """By hand the angular momentum over A has the size 39/64; cos 30 degrees is not rational."""
    given = {"r0": r0, "psidot0": psi_rate, "thetadot0": "-13/32"}
    top = Top(
        m=1,
        A=1,
        C=Fraction(1, 4),
        s=1,
        g=0,
        theta0_deg=30,
        **{name: Fraction(x) for name, x in given.items()},
    )
    assert solve(top).record(digits=5, keys=[key]) == {key: printed}
