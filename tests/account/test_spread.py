"""The spread of neighbouring motions, against the reference and random tops; derivatives.

`test_frozen` compares the derivatives of fifteen records; `examples/numbers.txt` has more, by hand.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from lagtop import Top, solve, sweep
from record_reference import reference_record, reference_state
from scenes import EPS, EVERY_KIND, UNIT

from lagrange_cli.account.spread import ColumnSpread, Spread

SCENES: dict[str, dict[str, float]] = {
    "any start": EVERY_KIND["any start"],
    "in radians": UNIT | {"r0": -3, "theta0_rad": 2, "thetadot0": -1.5, "psidot0": 1},
    "near the separatrix": UNIT
    | {"m": 0.5, "r0": 0.75, "theta0_deg": 60, "psidot0": 0.5 + 1e-9, "thetadot0": 0.559016994},
    "near a pole": UNIT | {"r0": 2, "theta0_deg": 90, "psidot0": 2 + 1e-9, "thetadot0": 1},
    "extreme": {"m": 1e20, "A": 1e-9, "C": 1e-10, "s": 1e-9, "g": 1e-8, "psidot0": 1e3},
}
QUICK = [pytest.param(x, marks=() if x == "any start" else pytest.mark.slow) for x in SCENES]


def neighbours(top: Top, name: str, std: float) -> list[dict[str, Any]]:
    """Return the inputs of the tops a standard deviation away, the larger input first."""
    value = Fraction(getattr(top, name))
    return [top.replace(**{name: value + side * Fraction(std)}).as_dict() for side in (1, -1)]


@pytest.mark.parametrize("scene", QUICK)
def test_a_contribution_is_half_the_difference_of_neighbouring_motions(scene: str) -> None:
    top, keys = Top(**SCENES[scene]), ["T_nutation", "theta_max_deg", "mean_spin_rate", "K", "Lz"]
    for name in ("C", "psidot0"):
        std = 1e-12 * float(getattr(top, name))
        spread = Spread(solve(top), {name: std})
        with mpmath.workdps(80):
            more, less = (reference_record(x, root_digits=400) for x in neighbours(top, name, std))
            for key in keys:
                found, half = spread.number(key), float((more[key] - less[key]) / 2)
                assert found is not None
                assert found.contributions[name] == pytest.approx(half, rel=1e-12), key


@pytest.mark.parametrize("scene", [x for x in QUICK if "separatrix" not in str(x)])
def test_columns_are_spread_as_those_of_the_reference(scene: str) -> None:
    top, name = Top(**SCENES[scene]), "C"
    motion, std = solve(top), 1e-11 * SCENES[scene]["C"]
    times = np.array([0.0, 0.3, -1e3]) * motion.T_nutation
    found = ColumnSpread(Spread(motion, {name: std}), ["theta", "phi", "psi"])(times)
    for t, row in zip(times.tolist(), found.T, strict=True):
        more, less = (
            reference_state(x, t, digits=40, root_digits=300)[:3]
            for x in neighbours(top, name, std)
        )
        half = [abs(float(x - y)) / 2 for x, y in zip(more, less, strict=True)]
        size = 1 + abs(t) * abs(motion.mean_spin_rate)
        assert row == pytest.approx(half, rel=0.01, abs=8 * EPS * size)


@pytest.mark.parametrize(
    ("inputs", "stds"),
    [
        ({}, {"r0": 0.5, "theta0_deg": 1.0}),
        ({}, {"thetadot0": 0.5}),  # of second order
        ({"r0": 37.286}, {"r0": 3.0}),  # the longest period
        ({"theta0_deg": 0.15}, {"theta0_deg": 0.1}),  # near the vertical
        (EVERY_KIND["over the top"], {"psidot0": 1e-3}),  # jumps of the mean rates
    ],
)
def test_random_tops_have_the_same_spread_or_the_number_is_named(
    inputs: dict[str, float], stds: dict[str, float]
) -> None:
    motion, rng = solve(Top(**inputs)), np.random.default_rng(1)
    keys = ["T_nutation", "theta_max_deg", "mean_spin_rate", "mean_precession_rate"]
    drawn = {x: getattr(motion.top, x) + std * rng.standard_normal(4000) for x, std in stds.items()}
    results = sweep(**(motion.top.parts.body | motion.top.parts.start | drawn), keys=keys)
    for key in keys:
        found = Spread(motion, stds).number(key)
        assert found is not None
        true = math.sqrt(np.nanmean((results[key] - getattr(motion, key)) ** 2))
        assert found.std == pytest.approx(true, rel=0.05 if found.linear else 0.3), key


def test_next_to_a_pole_the_angles_are_spread_as_elsewhere() -> None:
    """The axis passes within 1e-14 degrees of the pole, and the precession is steep there."""
    body = {"m": 1, "s": 1, "g": 1, "A": 0.721035951228741, "C": 1.0784295503310426}
    start = {"r0": 2.5461170485897657, "psidot0": -2.806564349850683}
    start |= {"thetadot0": 1.222377709272433, "theta0_deg": 110.90809218940831}
    spread = Spread(solve(Top(**body | start)), {"theta0_deg": 0.0016972329552432642})
    columns = ColumnSpread(spread, ["psi", "dpsi"])
    found = np.degrees(columns(np.array([0.28579709769770545])))
    assert found[0] == pytest.approx(8.5e-4, rel=0.01)
    assert [*columns.nonlinear] == ["dpsi"]  # the mean rate jumps at the pole


def test_at_the_end_of_a_range_one_direction_counts() -> None:
    for inputs, stds in (({"theta0_deg": 180}, {"theta0_deg": 0.5}), ({"C": 78064}, {"C": 100.0})):
        [name] = stds
        found = Spread(solve(Top(**inputs)), stds).number(name)
        assert found is not None
        assert (found.std, found.linear) == (stds[name], True)


def test_ratios_beyond_the_doubles() -> None:
    """a = 2mgs/A and b = C r0/A grow with g and with r0."""
    for name, value, std, key in (("g", 1e-318, 1e-3, "a"), ("r0", 1e95, 1e-310, "b")):
        motion = solve(Top(**{name: value}))
        found, unit = Spread(motion, {name: std}).number(key), solve(Top(**{name: 1.0})).number(key)
        assert found is not None
        assert unit is not None
        assert found.std == pytest.approx(unit.value * std, rel=1e-12)


def test_a_root_that_is_0_on_one_side_is_not_fair() -> None:
    """2 sqrt(A m g s max(cos theta0, 0))/C at 90 degrees: half the difference grows as a root."""
    found = Spread(solve(Top(theta0_deg=90)), {"theta0_deg": 0.1}).number("r0_steady_min")
    assert found is not None
    assert not found.linear
