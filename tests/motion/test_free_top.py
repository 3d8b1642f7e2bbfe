"""The top without torque: records of `solve` and of `sweep`, both against closed values."""

from __future__ import annotations

import random

import pytest
from free_top import free_record
from lagtop import Top, solve

BODY: dict[str, float] = {"m": 1, "A": 2, "C": 1.5, "s": 1, "g": 0, "theta0_deg": 40}
STARTS: dict[str, dict[str, float]] = {
    "at rest": {"r0": 3},
    "at rest, other way round": {"r0": -3},
    "at rest, no arm": {"r0": 3, "g": 981, "s": 0},
    "nothing turns": {"r0": 0},
    "beside the vertical": {"r0": -3, "psidot0": 1},
    "beside the vertical, rising": {"r0": 1, "thetadot0": -0.5},
    "round the vertical": {"r0": 1, "psidot0": 2, "thetadot0": 3},
    "round the lower pole": {"r0": 1, "psidot0": -3},
    "round both poles": {"r0": -4, "psidot0": -6, "theta0_deg": 100},
    "no spin": {"r0": 0, "psidot0": 1},
    "sphere": {"A": 1, "C": 1, "r0": 2, "psidot0": 0.5, "thetadot0": 0.25},
}


def random_start(rng: random.Random) -> dict[str, float]:
    """Return a top without torque, with or without rates at the start."""
    A = rng.uniform(0.5, 2)
    rates = {"psidot0": rng.uniform(-3, 3), "thetadot0": rng.choice([0, rng.uniform(-3, 3)])}
    return {
        **{"m": 1, "s": 1, "g": 0, "A": A, "C": A * rng.uniform(0.1, 2)},
        **{"theta0_deg": rng.uniform(5, 175), "r0": rng.uniform(-5, 5)},
        **(rates if rng.random() < 0.8 else {"psidot0": 0, "thetadot0": 0}),
    }


RANDOM = [random_start(random.Random(i)) for i in range(60)]
SCENES = [BODY | start for start in STARTS.values()] + RANDOM
NAMES = [*STARTS, *(f"random {i}" for i in range(len(RANDOM)))]


@pytest.mark.parametrize("scene", SCENES, ids=NAMES)
def test_solve(scene: dict[str, float]) -> None:
    """Every number is the double nearest to the exact one."""
    top = Top(**scene)
    motion = solve(top)
    numbers = {key: getattr(motion, key) for key in free_record(top)}
    truth = {key: x if x is None else float(x) for key, x in free_record(top).items()}
    assert motion.regime.value == "torque-free"
    assert numbers == truth
