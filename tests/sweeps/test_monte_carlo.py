"""Monte Carlo against first order where both hold, and where first order does not hold."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import UNIT

from lagrange_cli import LagtopError, Top, solve
from lagrange_cli.motion.uncertainty import FirstOrder
from lagrange_cli.sweeps.monte_carlo import (
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
    uncertain, motion = FirstOrder(top, stds, inputs), solve(top)
    numbers = {key: (getattr(motion, key), uncertain.std(key)) for key in keys}
    given = {name: float(x) for name, x in top.as_dict().items() if x is not None}
    return propagate(given, stds, numbers, samples=samples, seed=1)


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
        propagate({}, {}, {}, samples=3)
