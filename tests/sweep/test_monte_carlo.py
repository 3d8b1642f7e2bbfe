"""Monte Carlo against first order where both hold, and where first order does not hold."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from lagtop import LagtopError, Top, solve, sweep
from scenes import UNIT

from lagrange_cli.inputs.value import Stds
from lagrange_cli.motion.record import NUMBER_KEYS
from lagrange_cli.motion.uncertainty import FirstOrder
from lagrange_cli.sweep.monte_carlo import (
    FAILS,
    HOLDS,
    OPEN,
    Propagated,
    first_order_holds,
    propagate,
)


def outcome(
    inputs: dict[str, float], stds: dict[str, float], keys: list[str], samples: int = 20_000
) -> Propagated:
    """Return what becomes of samples of a top, of which some keys are looked at."""
    top = Top(**inputs)
    uncertain, motion = FirstOrder(solve(top), Stds(stds), inputs), solve(top)
    numbers = {key: (getattr(motion, key), uncertain.std(key)) for key in keys}
    given = {name: float(x) for name, x in top.as_dict().items() if x is not None}
    return propagate(given, Stds(stds), numbers, samples=samples, seed=1)


def test_samples_and_first_order_agree_where_both_hold() -> None:
    keys = ["T_nutation", "theta_max_deg", "mean_spin_rate", "mean_precession_rate", "u2"]
    found = outcome({}, {"m": 20, "r0": 0.5, "theta0_deg": 0.3}, keys)
    assert found.regimes == {"regular": 1.0}
    for spread in found.spreads:
        assert spread.first_order_std is not None
        assert spread.sampled_std == pytest.approx(spread.first_order_std, rel=0.03), spread.key
        assert spread.q84 - spread.q16 == pytest.approx(2 * spread.first_order_std, rel=0.05), (
            spread.key
        )
        assert spread.first_order in {HOLDS, OPEN}, spread.key


def test_first_order_fails_at_the_separatrix_and_at_the_threshold_of_sleeping() -> None:
    near = UNIT | {"m": 0.5, "r0": 0.75, "theta0_deg": 60, "psidot0": 0.5, "thetadot0": 0.559}
    stds = {"thetadot0": 0.01, "psidot0": 0.005}
    found = outcome(near, stds, ["T_nutation", "mean_precession_rate"])
    assert [spread.first_order for spread in found.spreads] == [FAILS, FAILS]
    threshold = UNIT | {"r0": 2, "theta0_deg": 0.01}
    found = outcome(threshold, {"r0": 0.05}, ["theta_max_deg", "T_nutation"])
    assert FAILS in {spread.first_order for spread in found.spreads}
    asleep = UNIT | {"r0": 2.0, "theta0_deg": 0}
    found = outcome(asleep, {"r0": 0.1}, ["mean_spin_rate"])
    assert found.regimes.keys() == {"sleeping, stable", "sleeping, unstable"}
    assert found.regimes["sleeping, stable"] == pytest.approx(0.5, abs=0.02)
    assert found.spreads[0].first_order in {HOLDS, OPEN}


_BODY = ("m", "A", "C", "s", "g")
_RATES = ("r0", "thetadot0", "psidot0")
REGIMES: dict[str, tuple[dict[str, float], tuple[str, ...]]] = {
    "regular": ({"thetadot0": 0.6, "psidot0": 0.7}, (*_BODY, "theta0_deg", *_RATES)),
    "no spin": ({"r0": 0, "psidot0": 0.7, "thetadot0": 0.4}, (*_BODY, "theta0_deg", *_RATES[1:])),
    "torque-free": (
        {"g": 0, "thetadot0": 0.6, "psidot0": 0.7},
        ("A", "C", "theta0_deg", *_RATES),
    ),
    "steady precession": ({"r0": 1.5, "theta0_deg": 60, "psidot0": 2}, (*_BODY, *_RATES[::2])),
    "separatrix": (
        {"m": 3.25, "r0": -2.25, "theta0_deg": 60, "thetadot0": -1.25, "psidot0": -1.5},
        (*_BODY, *_RATES),
    ),
    "sleeping": ({"r0": 3, "theta0_deg": 0}, (*_BODY, "r0")),
    "hanging": ({"r0": 3, "theta0_deg": 180}, (*_BODY, "r0")),
}
"""A top of each regime, and the inputs that are drawn: those that leave it, but for two regimes."""


@pytest.mark.parametrize("regime", REGIMES)
def test_numbers_correlate_with_inputs_by_the_signs_of_the_derivatives(regime: str) -> None:
    """Correlations of 6000 samples were at most 0.037 off, which is three standard errors."""
    rng = np.random.default_rng(len(regime))
    own, names = REGIMES[regime]
    fixed = regime in {"steady precession", "separatrix"}
    by_solve = regime in {"torque-free", "separatrix"}  # which takes longer
    rounds, samples = 1 if fixed or by_solve else 3, 600 if by_solve else 6000
    noise = 5 / samples**0.5
    compared = 0
    for _ in range(rounds):
        free = {"r0": rng.uniform(0.5, 3), "theta0_deg": rng.uniform(30, 150)}
        free |= {"C": rng.uniform(0.2, 1), "s": rng.uniform(0.5, 1.5)}
        inputs: dict[str, Any] = UNIT | ({} if fixed else free) | own
        stds = Stds({x: 1e-6 * abs(inputs[x]) for x in names})
        uncertain = FirstOrder(solve(Top(**inputs)), stds, inputs)
        motion = uncertain.motion
        assert motion.regime == regime
        record = motion.numbers()
        drawn = {x: rng.normal(inputs[x], std, samples) for x, std in uncertain.stds.items()}
        wholes = {key: uncertain.std(key) or 0.0 for key in NUMBER_KEYS if uncertain.has(key)}
        moved = [key for key, std in wholes.items() if std > 1e-12 * (1 + abs(record[key] or 0))]
        found = sweep(keys=moved, **inputs | drawn)
        for key in moved:
            whole = wholes[key]
            slopes = {line.input: line.sensitivity for line in uncertain.budget(key, inputs)}
            for name, std in uncertain.stds.items():
                slope = slopes[name]
                correlation = np.corrcoef(np.asarray(found[key], float), drawn[name])[0, 1]
                assert correlation == pytest.approx(slope * std / whole, abs=noise), (key, name)
                if abs(correlation) > noise:
                    assert np.sign(correlation) == np.sign(slope), (key, name)
                    compared += 1
    assert compared > 10


def test_samples_that_are_no_top_are_counted() -> None:
    found = outcome(UNIT | {"r0": 3, "s": 0.001}, {"s": 0.001}, ["T_nutation"], samples=2000)
    assert found.regimes["no top"] == pytest.approx(0.16, abs=0.03)
    assert found.spreads[0].first_order == FAILS


def test_a_tilt_beyond_a_pole_is_that_on_its_other_side() -> None:
    found = outcome(UNIT | {"r0": 3, "theta0_deg": 179}, {"theta0_deg": 5}, ["theta_max_deg"], 2000)
    assert found.regimes == {"regular": 1.0}
    assert 170 < found.spreads[0].q2_5 < found.spreads[0].q97_5 < 180


def test_the_verdict_knows_its_own_noise() -> None:
    normal = np.sort(np.random.default_rng(1).normal(0.0, 1.0, 100_000))
    assert first_order_holds(normal, 0.0, 1.0) == HOLDS
    assert first_order_holds(normal[::1000], 0.0, 0.99) == OPEN
    assert first_order_holds(normal, 0.6, 1.0) == FAILS
    assert first_order_holds(np.zeros(100), 0.0, 0.0) == HOLDS
    with pytest.raises(LagtopError, match=r"samples must be in \[100, 1000000\]"):
        propagate({}, Stds({}), {}, samples=3)
