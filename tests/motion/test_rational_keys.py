"""Keys that are known as fractions, against the formulas in sixty digits."""

from __future__ import annotations

import math
import random
from decimal import Decimal
from fractions import Fraction

import pytest
from exact_scenes import KINDS
from hard_scenes import nutating
from lagtop import LagtopError, Motion, Top, solve
from scenes import UNIT

from lagrange_cli.arithmetic.ball import Ball
from lagrange_cli.motion.exact import rational_keys as rational_keys_module
from lagrange_cli.motion.exact.rational_keys import known_fraction, rational_keys
from lagrange_cli.motion.record import NUMBER_KEYS
from lagrange_cli.motion.regime import exact

SMALL = Decimal("1e-50")
SCALE_KEYS = ("r0", "psidot0", "thetadot0")


def values(motion: Motion) -> dict[str, Ball]:
    """Return the numbers of a motion in some seventy digits, without what it does not have."""
    names = [name for name in NUMBER_KEYS if name not in motion.kind_class.lacks]
    computed = {name: motion.enclosure(name, 72) for name in names}
    return {name: value for name, value in computed.items() if value is not None}


@pytest.mark.parametrize("kind", ["nice numbers", "steady", "over a pole"])
def test_fractions_are_what_the_formulas_give(kind: str) -> None:
    """Each fraction is the number; what cancels to 0 in 50 digits is known to be 0."""
    rng, told, zeros = random.Random(f"fractions of {kind}"), 0, 0
    for _ in range(40):
        scene = KINDS[kind](rng)
        try:
            motion = solve(Top(**scene))
        except LagtopError:
            continue
        known = rational_keys(motion.exact)
        size = 1 + max(abs(Decimal(scene.get(key, 0))) for key in SCALE_KEYS)
        for key, ball in values(motion).items():
            value = ball.middle
            zeros += abs(value) <= SMALL
            if key in known:
                fraction = Decimal(known[key].numerator) / Decimal(known[key].denominator)
                assert abs(value - fraction) <= Decimal("1e-25") * (size + abs(value)), (key, scene)
                told += 1
            elif abs(value) <= SMALL and ball.radius:  # else it is 0 by its formula
                assert motion.fraction(key) == 0, (key, scene)
    assert told > 100
    assert zeros > 5


LEVELS: list[tuple[dict[str, float | Fraction], str]] = [
    ({"r0": 0, "theta0_deg": 60}, "u_quarter"),
    ({"r0": 2, "theta0_deg": 60}, "u2"),
    ({"r0": Fraction(1, 2), "theta0_deg": 90, "g": 0, "thetadot0": 1}, "precession_rate_start"),
    ({"r0": 1, "theta0_deg": 60, "psidot0": 2}, "spin_rate_start"),
    ({"r0": -1, "theta0_deg": 120, "psidot0": 2}, "spin_rate_start"),
]


@pytest.mark.parametrize(("inputs", "key"), LEVELS)
def test_zeros_are_told_and_near_misses_are_not(
    inputs: dict[str, float | Fraction], key: str
) -> None:
    """A spin that differs by 1e-100 is no zero any more, and its digits are there."""
    assert solve(Top(**UNIT | inputs)).fraction(key) == 0
    if key.startswith("precession"):
        return
    moved = solve(Top(**UNIT | inputs | {"r0": Fraction(inputs["r0"]) + Fraction("1e-100")}))
    assert moved.fraction(key) != 0
    assert abs(Decimal(moved.record(digits=3)[key])) > 0


HALF = {"m": 2, "A": 1, "C": 1, "s": 1, "g": 1, "theta0_deg": 90, "thetadot0": 2}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("inputs", "key", "other"),
    [
        ({"r0": 1, "psidot0": 2}, "spin_rate_half", 2.0),
        ({"r0": -1, "psidot0": -2}, "spin_rate_half", -2.0),
        ({"r0": 2, "psidot0": 1}, "precession_rate_half", 2.0),
        ({"A": 2, "C": 2, "g": 2, "r0": 2, "psidot0": 1}, "precession_rate_half", 2.0),
    ],
)
def test_rates_that_vanish_half_a_period_after_a_start_with_rates(
    inputs: dict[str, float], key: str, other: float
) -> None:
    """No number of digits tells the 0: `solve` ended with an error.  By hand u3 = 2, u(T/2) = 1/2.

    A start that is off by 1e-100 has no 0.
    """
    motion = solve(Top(**HALF | inputs))
    keys = ["spin_rate_half", "precession_rate_half"]
    rates = {name: getattr(motion, name) for name in keys}
    assert motion.u3 == 2
    assert rates.pop(key) == 0
    assert [*rates.values()] == [other]
    moved = solve(Top(**HALF | inputs | {"thetadot0": 2 + Fraction("1e-100")}))
    assert moved.fraction(key) is None
    assert abs(Decimal(moved.record(digits=3)[key])) > 0


@pytest.mark.parametrize(
    ("inputs", "u3", "rate"),
    [
        ({"A": 0.5, "C": 0.5, "r0": 0.5, "psidot0": 3}, 1.5, 2.0),
        ({"A": 1, "C": 0.5, "r0": 2, "psidot0": -2}, 1 + math.sqrt(3), -1 - math.sqrt(3)),
    ],
)
def test_the_spin_vanishes_half_a_period_after_a_start_at_120_degrees(
    inputs: dict[str, float], u3: float, rate: float
) -> None:
    """No number of digits shows the 0.  By hand, the cubics (4,9) divided by u - u0.

    They are 4 u^2 - 7 u + 3/2 with the roots 1/4, 3/2, and 2 u^2 - 4 u - 4 with 1 -+ sqrt(3).
    """
    motion = solve(Top(**UNIT | inputs | {"theta0_deg": 120}))
    assert motion.u3 == u3
    assert (motion.spin_rate_half, motion.precession_rate_half) == (0, rate)


@pytest.mark.parametrize(
    ("inputs", "key", "value"),
    [
        ({"r0": 1, "psidot0": 2, "thetadot0": 1}, "precession_rate_half", 1.8660254037844386),
        ({"r0": 2, "psidot0": 1, "thetadot0": 1}, "spin_rate_half", 1.8660254037844386),
    ],
)
def test_a_rate_that_would_vanish_with_another_root_for_u3_does_not(
    inputs: dict[str, float], key: str, value: float
) -> None:
    """Here u1 = 1/2 in the place of u3 makes the rate 0; by hand the rate is 1 + sqrt(3)/2."""
    motion = solve(Top(**HALF | inputs))
    assert motion.u1 == 0.5
    assert motion.fraction(key) is None
    assert getattr(motion, key) == value


def test_a_fraction_next_to_a_rate_is_refused_by_balls_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Euclid's algorithm took 0.5 s for the rates of one top."""
    monkeypatch.setattr(rational_keys_module, "_shared_roots", None)
    rng = random.Random(4)
    for _ in range(9):
        motion = solve(Top(**nutating("near a pole", rng)))
        for key in ("spin_rate_half", "precession_rate_half"):
            motion.fraction(key)


@pytest.mark.parametrize(
    ("tilt", "name"), [(35.48870519889296, "max"), (144.51129480110704, "min")]
)
def test_without_torque_and_spin_the_other_turning_point_is_opposite(
    tilt: float, name: str
) -> None:
    """The tilt there is midway between two doubles, which no number of digits tells."""
    start = {"m": 1, "A": 1.5, "C": 1.5, "s": 0, "g": 1, "r0": 0}
    scene = exact(Top(**start, theta0_deg=tilt, psidot0=-2.9))
    known = known_fraction(scene, f"theta_{name}_deg")
    assert known == 180 - Fraction(tilt)
    proved = solve(scene.top).number(f"theta_{name}_deg")
    assert proved is not None
    assert proved.value == float(known)
    level = solve(Top(**start, theta0_deg=60, psidot0=1))
    assert [level.fraction(key) for key in ("u1", "u2")] == [Fraction(1, 2), Fraction(-1, 2)]


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
    start = {"r0": r0, "psidot0": psi_rate, "thetadot0": "-13/32"}
    given = {name: Fraction(x) for name, x in start.items()}
    top = Top(m=1, A=1, C=Fraction(1, 4), s=1, g=0, theta0_deg=30, **given)
    assert solve(top).record(digits=5, keys=[key]) == {key: printed}


def test_roots_that_are_fractions_may_be_midway() -> None:
    """By hand b^2/a = 1/x - x with x = 1 - 2^-54, and u2 = -x is midway between two doubles."""
    motion = solve(
        Top(
            m=134217727,
            A=207165582859042816,
            C=23,
            s=1566469435607129,
            g=134217729,
            r0=1566469435607129,
            theta0_deg=90,
        )
    )
    assert motion.exact.b**2 / motion.exact.a == 1 / (1 - Fraction(1, 2**54)) - 1 + Fraction(
        1, 2**54
    )
    assert motion.u2 == -1
    # b^2/a = 7/12: the roots are -3/4 and 4/3, and k = 3/5
    record = solve(Top(**UNIT | {"m": 42, "r0": 7, "theta0_deg": 90})).record(digits=1)
    assert [record[key] for key in ("u2", "u3", "k")] == ["-0.8", "1.0", "0.6"]
    # with another r0 by 10^-30 the root is on one side of the tie
    moved = Top(**UNIT | {"m": 42, "theta0_deg": 90}, r0=7 + Fraction(1, 10**30))
    assert solve(moved).record(digits=1)["u2"] == "-0.7"
