"""Further keys that are formulas of the inputs: the numbers of `solve`, without solving."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import pytest
from exact_scenes import KINDS
from hard_scenes import in_doubles
from lagtop import Top, solve, sweep
from scenes import EPS, EVERY_KIND, UNIT

from lagrange_cli.sweep import records
from lagrange_cli.sweep.elementary import ELEMENTARY
from lagrange_cli.sweep.records import OF_MODULI, column_keys

KEYS = sorted({*ELEMENTARY, *OF_MODULI})


def assert_as_solve(scenes: list[dict[str, Any]]) -> None:
    """Check all such keys of some tops against the correctly rounded numbers, to four eps."""
    tops = [Top(**in_doubles(scene)) for scene in scenes]
    for tilt in ("theta0_deg", "theta0_rad"):
        some = [top for top in tops if getattr(top, tilt) is not None]
        names = ("m", "A", "C", "s", "g", "r0", tilt, "thetadot0", "psidot0")
        inputs: Any = {name: [getattr(top, name) for top in some] for name in names}
        found = sweep(**inputs, keys=[*KEYS, "error"])
        for i, top in enumerate(some):
            if found["error"][i] is not None:
                continue
            motion = solve(top)
            for key in KEYS:
                value, exact = float(found[key][i]), getattr(motion, key)
                if exact is None:
                    assert math.isnan(value), (key, top)
                else:
                    assert abs(value - exact) <= 4 * EPS * abs(exact), (key, value, exact, top)


@pytest.mark.parametrize("count", [2, pytest.param(30, marks=pytest.mark.slow)])
def test_random_tops_of_every_kind(count: int) -> None:
    for kind, make in KINDS.items():
        rng = random.Random(f"elementary {kind}")
        assert_as_solve([make(rng) for _ in range(count)])


def test_exact_zeros_and_numbers_that_do_not_exist() -> None:
    """A level start, no spin, no torque, a disc, momenta that cancel, and below the least spin."""
    level = UNIT | {"theta0_deg": 90}
    assert_as_solve(
        [
            *EVERY_KIND.values(),
            *(level | {"r0": r0} for r0 in (0, 2, -2)),
            *(level | {"r0": 1, "psidot0": -1, "C": 2, "g": g} for g in (0, 1)),
            UNIT | {"theta0_deg": 60, "r0": -1, "psidot0": 2 / 3},
            UNIT | {"theta0_deg": 60, "r0": 1.5, "psidot0": 1},
            UNIT | {"theta0_deg": 30, "r0": 1},
        ]
    )


def test_no_ordinary_top_is_solved_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(records, "solve", None)
    rng = np.random.default_rng(2)
    start: Any = {"r0": rng.uniform(-99, 99, 2000), "theta0_deg": rng.uniform(1, 179, 2000)}
    for rates in (0.0, rng.uniform(-5, 5, 2000)):
        found = sweep(**start, psidot0=rates, keys=[*column_keys(), *KEYS])
        assert not np.isnan(found["stability_factor"]).any()
    turned = sweep(r0=[40.0, 60.0], theta0_rad=1.0, radians=True, keys=["comodular_angle_rad"])
    modular = sweep(r0=[40.0, 60.0], theta0_rad=1.0, radians=True, keys=["modular_angle_rad"])
    total = turned["comodular_angle_rad"] + modular["modular_angle_rad"]
    assert total == pytest.approx(np.full(2, math.pi / 2), rel=1e-15)
